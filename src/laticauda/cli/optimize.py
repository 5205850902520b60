"""`laticauda optimize`: the best gaits, fins or numbers of links, or the front between speed and power."""

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli import vary
from laticauda.cli.flags import Folder, Words, read
from laticauda.cli.progress import trials_bar
from laticauda.cli.scene import Names, named, warn_of_compiling
from laticauda.cli.sweep import facts
from laticauda.cli.tables import aligned, number, read_in
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import Parameter, parameters

if TYPE_CHECKING:
    from laticauda.studies import Front, Optimization

BOTH = "speed-power"
OBJECTIVES = (BOTH, "forward-velocity", "steady-velocity", "mechanical-power", "mean-power", "cost-of-transport")
N_SHOWN = 8
SHOWN = ("forward_velocity", "mechanical_power", "cost_of_transport")


@value
class Search:
    """What may change, and what is to be great or small; all else is fixed by the options below."""

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "NAME=LOW:HIGH, the range of a number of robot, gait or water, with the unit in the name; if left out "
        "amplitude-deg=10:50 frequency-deg-s=50:150 phase-shift-deg=10:60",
        default=(),
    )
    objective: Words = option(
        "One or two of forward-velocity, steady-velocity (great), mechanical-power, mean-power, cost-of-transport "
        "(small). Two give the front between them; speed-power stands for forward-velocity mechanical-power",
        default=(BOTH,),
    )
    budget: int = quantity(
        "", "How many points to try; a greater one goes on where a smaller one ended", ge=1, default=4000
    )
    population: int | None = quantity(
        "", "Points in a generation; 100 for two objectives and 40 for one if left out", ge=1, default=None
    )
    seed: int = quantity("", "Of everything random; another one takes another way", ge=0, default=0)
    joint_rate_limit: float | None = quantity(
        "rad/s",
        "Largest rate that a gait may ask of a joint; its angle stays within the joint's limit in any case",
        gt=0.0,
        default=None,
    )
    least_velocity: float | None = quantity(
        "m/s",
        "Least forward velocity that will do: without one the cheapest gait hardly moves",
        gt=0.0,
        default=None,
    )
    both_gaits: bool = option(
        "Optimize both of the paper's gaits, each in a folder of its own, and draw both in one figure", default=False
    )
    names: bool = option("Print the names of what can be varied, and end", default=False)
    threads: int | None = quantity("", "How many trials run at once; one per core if left out", ge=1, default=None)

    @property
    def words(self) -> list[str]:
        """The ranges, as they are typed."""
        words = [word for group in self.vary for word in group]
        return words or ["amplitude-deg=10:50", "frequency-deg-s=50:150", "phase-shift-deg=10:60"]


@value
class Results:
    """What becomes of it."""

    output: Folder = option(
        "The folder of the results; an optimization that was stopped goes on there when the same command is run again",
        default="optimum",
    )
    json: bool = option("Print one JSON object in SI units instead of the table", default=False)


@value
class Optimize:
    """Search for the best gait, fin or number of links, or for the front between speed and power.

    For example: laticauda optimize --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50
    frequency-deg-s=50:150 phase-shift-deg=10:60 --objective speed-power --seed 1 --output optimum

    Writes front.csv, front.nc and, for two objectives, the figure front.png. Stopped or killed, the same command goes
    on.
    """

    search: Search = option("What may change, and what is to be great or small", default=Search())
    names: Names = option("What swims, how and where, by name", default=Names())
    scenario: Scenario = option("What the names stand for; every number can be changed")
    before: Any = option("What the names stand for, before single numbers were changed", default=None)
    result: Results = option("What becomes of it", default=Results())
    other: Any = option("The scenario of the other gait, for --both-gaits", default=None)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "Optimize":
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        names = Names.read(words, prog)
        chosen = cls._read(names, words, prog)
        if not chosen.search.both_gaits:
            return chosen
        others = {"lateral-undulation": "eel-like", "eel-like": "lateral-undulation"}
        if names.gait not in others:
            raise BadArgument("both_gaits", "must not be given with the gait custom: they are the paper's two")
        again = cls._read(replace(names, gait=others[names.gait]), words, prog)
        return replace(chosen, other=named(again.scenario, again.before))

    @classmethod
    def _read(cls, names: Names, words: Sequence[str], prog: str) -> "Optimize":
        found, _ = names.scenario(words)
        return read(cls, words, prog, cls(names=names, scenario=found, before=found))

    def __call__(self) -> int:
        """Run, print, and return the exit status."""
        scenario = named(self.scenario, self.before)
        if self.search.names:
            print(vary.listed(parameters(scenario)))
            return 0
        from laticauda.reports.front import write_front, write_front_figure

        scenarios = [scenario] if self.other is None else [scenario, self.other]
        folder = Path(self.result.output)
        folders = [folder / one.gait.kind for one in scenarios] if self.other is not None else [folder]
        fronts: list[Front] = []
        for one, place in zip(map(self._optimization, scenarios), folders, strict=True):
            front = self._run(one, place)
            if front is None:
                return 130
            write_front(front, place)
            fronts.append(front)
        pictures = write_front_figure(fronts, folder)
        show = _as_json if self.result.json else _as_text
        print(show(fronts, folders, pictures))
        return 0 if all(len(front) for front in fronts) else 1

    def _optimization(self, scenario: Scenario) -> "Optimization":
        """What is asked for."""
        from laticauda.studies import SPEED_POWER, Optimization

        wanted = self.search.objective
        return Optimization(
            scenario=scenario,
            bounds=vary.ranges(self.search.words, parameters(scenario), vary.RANGE_FORM),
            objectives=SPEED_POWER if wanted == (BOTH,) else tuple(_objective(name) for name in wanted),
            joint_rate_limit=self.search.joint_rate_limit,
            least_velocity=self.search.least_velocity,
        )

    def _run(self, sought: "Optimization", folder: Path) -> "Front | None":
        """Do the work that is left; None if the user stopped it."""
        from laticauda.studies import optimize

        warn_of_compiling(sought.scenario)
        bar, reached = trials_bar(), [0, 0]

        def show(done: int, total: int) -> None:
            reached[:] = done, total
            bar(done, total)

        how = {name: getattr(self.search, name) for name in ("budget", "population", "seed", "threads")}
        try:
            return optimize(sought, folder, progress=show, **how)
        except KeyboardInterrupt:
            print(
                f"laticauda: stopped; {reached[0]} of {reached[1]} trials are stored in {folder}. Run the same command "
                "again to go on.",
                file=sys.stderr,
            )
            return None


def _objective(word: str) -> str:
    from laticauda.errors import one_of

    return one_of("objective", word.replace("_", "-"), OBJECTIVES).replace("-", "_")


def _as_json(fronts: "Sequence[Front]", folders: Sequence[Path], pictures: Sequence[Path]) -> str:
    """What was run, and some points of every front, in SI units."""
    found = [
        {
            "status": _status(front),
            "objectives": list(front.optimization.objectives),
            "n_trials": front.n_trials,
            "n_infeasible": front.n_infeasible,
            "seed": front.seed,
            "output": str(folder),
            **facts(front.optimization.scenario),
            "files": [str(folder / name) for name in ("front.csv", "front.nc")] + [str(path) for path in pictures],
            "n_points": len(front),
            "points": [_point(front, i) for i in front.spread(N_SHOWN)],
        }
        for front, folder in zip(fronts, folders, strict=True)
    ]
    return json.dumps(found[0] if len(found) == 1 else {"gaits": found}, indent=2, allow_nan=False)


def _point(front: "Front", i: int) -> dict[str, float | None]:
    figures = {name: float(column[i]) for name, column in front.figures.items() if name != "succeeded"}
    point = dict(zip(front.optimization.names, front.values[i].tolist(), strict=True)) | figures
    return {name: value if value == value else None for name, value in point.items()}


def _as_text(fronts: "Sequence[Front]", folders: Sequence[Path], pictures: Sequence[Path]) -> str:
    """Some points of every front as tables, and where the files are."""
    parts: list[str] = []
    for front, folder in zip(fronts, folders, strict=True):
        parts.append(_status(front))
        if len(front):
            parts.append(_table(front))
        parts.append(f"All points: {folder}/front.csv, {folder}/front.nc")
    if pictures:
        parts.append(f"Figure: {', '.join(map(str, pictures))}")
    return "\n\n".join(parts)


def _table(front: "Front") -> str:
    from laticauda.studies.trials import QUANTITIES

    known = parameters(front.optimization.scenario)
    columns: list[Parameter] = [known[name] for name in front.optimization.names]
    figures = list(dict.fromkeys([*front.optimization.objectives, *SHOWN]))
    head = [vary.spelled(parameter) for parameter in columns]
    head += [f"{name.replace('_', ' ')} [{QUANTITIES[name][0].replace('1', '-')}]" for name in figures]
    rows = [head]
    for i in front.spread(N_SHOWN):
        cells = [read_in(float(front.values[i, k]), parameter.unit)[0] for k, parameter in enumerate(columns)]
        rows.append(cells + [number(float(front.figures[name][i])) for name in figures])
    return aligned(rows, right=range(len(head)))


def _status(front: "Front") -> str:
    sought = front.optimization
    words = " against ".join(name.replace("_", " ") for name in sought.objectives)
    tried = f"{front.n_trials} points tried"
    if front.n_infeasible:
        tried += f", {front.n_infeasible} of them not feasible"
    what = f"{sought.scenario.gait.kind.replace('_', '-')}, robot {sought.scenario.robot.name}, {words}: {tried}"
    if not len(front):
        return (
            f"{what}; none is left: gaits beyond the joints' limits, runs that blew up (a smaller --dt may help), that "
            "are too slow, or too short for the objective."
        )
    return f"{what}, {len(front)} on the front." if len(sought.objectives) > 1 else f"{what}; the best is:"
