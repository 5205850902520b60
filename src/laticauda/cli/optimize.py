"""`laticauda optimize`: the best gaits, fins or numbers of links, or the front between speed and power."""

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli import vary
from laticauda.cli.flags import Number, Switch, Text, Whole, Words, default
from laticauda.cli.groups import (
    Coefficients,
    EnvironmentFlags,
    GaitFlags,
    ModelFlags,
    RobotFlags,
    WaterChanges,
    radians,
)
from laticauda.cli.progress import trials_bar
from laticauda.cli.swim import COMPILING, DURATION
from laticauda.cli.tables import aligned, number, read_in

if TYPE_CHECKING:
    from laticauda.scenarios import Scenario
    from laticauda.simulate import Parameter
    from laticauda.studies import Front, Optimization

FOLDER = "optimum"
VARY = ("amplitude-deg=10:50", "frequency-deg-s=50:150", "phase-shift-deg=10:60")
BOTH = "speed-power"
OBJECTIVES = (BOTH, "forward-velocity", "steady-velocity", "mechanical-power", "mean-power", "cost-of-transport")
OTHER_GAIT = {"lateral_undulation": "eel_like", "eel_like": "lateral_undulation"}
N_SHOWN = 8
SHOWN = ("forward_velocity", "mechanical_power", "cost_of_transport")


@dataclass(frozen=True, kw_only=True)
class SearchFlags:
    """What may change, and what is to be great or small; all else is fixed by the options below."""

    vary: Annotated[
        tuple[Words, ...],
        tyro.conf.UseAppendAction,
        tyro.conf.arg(metavar="NAME=LOW:HIGH ..."),
        default(" ".join(VARY)),
    ] = ()
    """The range of a number of robot, gait or water, with the unit in the name."""
    objective: Annotated[Words, tyro.conf.arg(metavar="NAME ..."), default(BOTH)] = ()
    """One or two of forward-velocity, steady-velocity (great), mechanical-power, mean-power, cost-of-transport (small).
    Two give the front between them; speed-power stands for forward-velocity mechanical-power."""
    budget: Annotated[Whole, default("4000")] = None
    """How many points to try; a greater one goes on where a smaller one ended."""
    population: Annotated[Whole, default("100 for two objectives, 40 for one")] = None
    """Points in a generation."""
    seed: Annotated[Whole, default("0")] = None
    """Of everything random; another one takes another way."""
    joint_rate_limit_deg_s: Annotated[Number, default("none")] = None
    """Largest rate that a gait may ask of a joint; its angle stays within the joint's limit in any case [deg/s]."""
    least_velocity: Annotated[Number, default("none")] = None
    """Least forward velocity that will do: without one the cheapest gait hardly moves [m/s]."""
    both_gaits: Switch = False
    """Optimize both of the paper's gaits, each in a folder of its own, and draw both in one figure."""
    names: Switch = False
    """Print the names of what can be varied, and end."""


@dataclass(frozen=True, kw_only=True)
class WorkFlags:
    """How it is done."""

    duration: Annotated[Number, default(f"{DURATION:g}")] = None
    """Of every trial [s]."""
    threads: Annotated[Whole, default("one per core")] = None
    """How many trials run at once."""


@dataclass(frozen=True, kw_only=True)
class ResultFlags:
    """What becomes of it."""

    output: Annotated[Text, tyro.conf.arg(metavar="DIR"), default(FOLDER)] = None
    """The folder of the results; an optimization that was stopped goes on there when the same command is run again."""
    json: Switch = False
    """Print one JSON object in SI units instead of the table."""


@dataclass(frozen=True, kw_only=True)
class Optimize:
    """Search for the best gait, fin or number of links, or for the front between speed and power.

    For example: laticauda optimize --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50
    frequency-deg-s=50:150 phase-shift-deg=10:60 --objective speed-power --seed 1 --output optimum

    Writes front.csv, front.nc and, for two objectives, the figure front.png. Stopped or killed, the same command goes
    on.
    """

    search: SearchFlags = field(default_factory=SearchFlags)
    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    environment: EnvironmentFlags = field(default_factory=EnvironmentFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = field(default_factory=ModelFlags)
    work: WorkFlags = field(default_factory=WorkFlags)
    result: ResultFlags = field(default_factory=ResultFlags)

    def __call__(self) -> int:
        """Run, print, and return the exit status."""
        scenario = self._scenario(self.gait)
        if self.search.names:
            from laticauda.simulate import parameters

            print(vary.listed(parameters(scenario)))
            return 0
        from laticauda.reports.front import write_front, write_front_figure

        wanted = self._optimizations(scenario)
        folder = Path(FOLDER if self.result.output is None else self.result.output)
        folders = [folder / one.scenario.gait.kind for one in wanted] if self.search.both_gaits else [folder]
        fronts: list[Front] = []
        for one, place in zip(wanted, folders, strict=True):
            front = self._run(one, place)
            if front is None:
                return 130
            write_front(front, place)
            fronts.append(front)
        pictures = write_front_figure(fronts, folder)
        show = _as_json if self.result.json else _as_text
        print(show(fronts, folders, pictures))
        return 0 if all(len(front) for front in fronts) else 1

    def _scenario(self, flags: GaitFlags) -> "Scenario":
        """What all trials share."""
        from laticauda.scenarios import scenario

        gait = flags.chosen()
        environment, _ = self.environment.chosen(gait, self.coefficients)
        settings: dict[str, Any] = self.environment.model_settings(self.model)
        duration = DURATION if self.work.duration is None else self.work.duration
        robot = self.environment.equipped(self.robot.chosen(), gait)
        return scenario(robot, gait, duration, environment=environment, **settings)

    def _optimizations(self, scenario: "Scenario") -> "list[Optimization]":
        """What is asked for; one more for the paper's other gait if that is."""
        from laticauda.simulate import parameters
        from laticauda.studies import SPEED_POWER, Optimization

        scenarios = [scenario]
        if self.search.both_gaits:
            if scenario.gait.kind not in OTHER_GAIT:
                raise ValueError("`both_gaits` must not be given with the gait custom: they are the paper's two.")
            scenarios.append(self._scenario(replace(self.gait, gait=OTHER_GAIT[scenario.gait.kind])))
        wanted = self.search.objective or (BOTH,)
        objectives = SPEED_POWER if wanted == (BOTH,) else tuple(_objective(name) for name in wanted)
        limit = self.search.joint_rate_limit_deg_s
        words = [word for group in self.search.vary for word in group] or list(VARY)
        return [
            Optimization(
                scenario=one,
                bounds=vary.ranges(words, parameters(one), vary.RANGE_FORM),
                objectives=objectives,
                joint_rate_limit=None if limit is None else radians(limit, 0.0),
                least_velocity=self.search.least_velocity,
            )
            for one in scenarios
        ]

    def _run(self, optimization: "Optimization", folder: Path) -> "Front | None":
        """Do the work that is left; None if the user stopped it."""
        from laticauda.simulate import needs_compiling
        from laticauda.studies import optimize

        if needs_compiling(optimization.scenario.environment):
            print(COMPILING, file=sys.stderr, flush=True)
        how: dict[str, Any] = {name: getattr(self.search, name) for name in ("budget", "population", "seed")}
        bar, reached = trials_bar(), [0, 0]

        def show(done: int, total: int) -> None:
            reached[:] = done, total
            bar(done, total)

        try:
            return optimize(
                optimization,
                folder,
                progress=show,
                threads=self.work.threads,
                **{name: value for name, value in how.items() if value is not None},
            )
        except KeyboardInterrupt:
            print(
                f"laticauda: stopped; {reached[0]} of {reached[1]} trials are stored in {folder}. Run the same command "
                "again to go on.",
                file=sys.stderr,
            )
            return None
        except ValueError as error:
            raise ValueError(str(error).replace("`folder`", "--output")) from error


def _objective(word: str) -> str:
    from laticauda.errors import one_of

    return one_of("objective", word.replace("_", "-"), OBJECTIVES).replace("-", "_")


def _as_json(fronts: "Sequence[Front]", folders: Sequence[Path], pictures: Sequence[Path]) -> str:
    """What was run, and some points of every front, in SI units."""
    from laticauda.studies.trials import attributes_of

    found = [
        {
            "status": _status(front),
            "objectives": list(front.optimization.objectives),
            "n_trials": front.n_trials,
            "n_infeasible": front.n_infeasible,
            "seed": front.seed,
            "output": str(folder),
            **attributes_of(front.optimization.scenario),
            "files": [str(folder / name) for name in ("front.csv", "front.nc")] + [str(path) for path in pictures],
            "n_points": len(front),
            "points": [_point(front, i) for i in front.spread(N_SHOWN)],
        }
        for front, folder in zip(fronts, folders, strict=True)
    ]
    for one in found:
        one["version"] = one.pop("laticauda")
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
    from laticauda.simulate import parameters
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
    optimization, swims = front.optimization, front.optimization.scenario
    words = " against ".join(name.replace("_", " ") for name in optimization.objectives)
    tried = f"{front.n_trials} points tried"
    if front.n_infeasible:
        tried += f", {front.n_infeasible} of them not feasible"
    what = f"{swims.gait.kind.replace('_', '-')}, robot {swims.robot.name}, {words}: {tried}"
    if not len(front):
        return (
            f"{what}; none is left: gaits beyond the joints' limits, runs that blew up (a smaller --dt may help), that "
            "are too slow, or too short for the objective."
        )
    return f"{what}, {len(front)} on the front." if len(optimization.objectives) > 1 else f"{what}; the best is:"
