"""`laticauda optimize`: the best gaits, fins or numbers of links, or the front between speed and power."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import tyro

from laticauda.cli import vary
from laticauda.cli.command import Outcome
from laticauda.cli.flags import Folder, Words
from laticauda.cli.progress import stored_trials
from laticauda.cli.scene import Names, warn_of_compiling
from laticauda.cli.vary import Known, Study
from laticauda.errors import BadArgument, one_of
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import parameters
from laticauda.studies import SPEED_POWER, Front, Optimization, optimize

BOTH = "speed-power"
OBJECTIVES = (BOTH, "forward-velocity", "steady-velocity", "mechanical-power", "mean-power", "cost-of-transport")
RANGES = ("amplitude-deg=10:50", "frequency-deg-s=50:150", "phase-shift-deg=10:60")
N_SHOWN = 8
SHOWN = ("forward_velocity", "mechanical_power", "cost_of_transport", "utilization")


@value
class Optimize(Study):
    """Search for the best gait, fin or number of links, or for the front between speed and power.

    For example: laticauda optimize --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50
    frequency-deg-s=50:150 phase-shift-deg=10:60 --objective speed-power --seed 1 --output optimum

    Writes front.csv, front.nc and, for two objectives, the figure front.png. Stopped or killed, the same command goes
    on.
    """

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "NAME=LOW:HIGH, the range of a number of robot, gait or water, with the unit in the name; if left out "
        f"{' '.join(RANGES)}",
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
        "m/s", "Least forward velocity that will do: without one the cheapest gait hardly moves", gt=0.0, default=None
    )
    beyond_actuators: bool = option(
        "Count gaits too for which joints' actuators have too little torque or speed, or whose links overlap",
        default=False,
    )
    both_gaits: bool = option(
        "Optimize both of the paper's gaits, each in a folder of its own, and draw both in one figure", default=False
    )
    output: Folder = option(
        "The folder of the results; an optimization that was stopped goes on there when the same command is run again",
        default="optimum",
    )
    other: Any = option("The scenario of the other gait, for --both-gaits", default=None)

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "Optimize":
        """The command that was typed; see `OfScenario.read`."""
        names = Names.read(words, prog)
        chosen = cls.of(names, words, prog)
        if not chosen.both_gaits:
            return chosen
        others = {"lateral-undulation": "eel-like", "eel-like": "lateral-undulation"}
        if names.gait not in others:
            raise BadArgument("both_gaits", "must not be given with the gait custom: they are the paper's two")
        return replace(chosen, other=cls.of(replace(names, gait=others[names.gait]), words, prog).chosen)

    def studied(self, scenario: Scenario, known: Known) -> Outcome:
        """Search, and write the fronts."""
        from laticauda.reports.front import write_front, write_front_figure

        folder = Path(self.output)
        places = {folder: scenario}
        if self.other is not None:
            places = {folder / one.gait.kind: one for one in (scenario, self.other)}
        fronts: dict[Path, Front] = {}
        for place, one in places.items():
            fronts[place] = self._front(one, place)
            write_front(fronts[place], place)
        pictures = write_front_figure([*fronts.values()], folder)
        facts = [_facts(front, place, pictures) for place, front in fronts.items()]
        text = [_text(front, place) for place, front in fronts.items()]
        if pictures:
            text.append(f"Figure: {', '.join(map(str, pictures))}")
        return Outcome(
            facts=facts[0] if self.other is None else {"gaits": facts},
            text="\n\n".join(text),
            succeeded=all(map(len, fronts.values())),
        )

    def _front(self, scenario: Scenario, folder: Path) -> Front:
        """Do the work that is left."""
        names = [one_of("objective", word.replace("_", "-"), OBJECTIVES) for word in self.objective]
        words = [word for group in self.vary for word in group] or RANGES
        sought = Optimization(
            scenario=scenario,
            bounds=vary.ranges(words, parameters(scenario), vary.RANGE_FORM),
            objectives=SPEED_POWER if names == [BOTH] else [name.replace("-", "_") for name in names],
            joint_rate_limit=self.joint_rate_limit,
            least_velocity=self.least_velocity,
            beyond_actuators=self.beyond_actuators,
        )
        warn_of_compiling(scenario.environment, scenario.model)
        how = {name: getattr(self, name) for name in ("budget", "population", "seed", "threads")}
        with stored_trials(folder) as show:
            return optimize(sought, folder, progress=show, **how)


def _facts(front: Front, folder: Path, pictures: Sequence[Path]) -> dict[str, Any]:
    """What was run, and some points of a front, in SI units."""
    return {
        "status": _status(front),
        "objectives": list(front.optimization.objectives),
        "n_trials": front.n_trials,
        "n_infeasible": front.n_infeasible,
        "seed": front.seed,
        "output": str(folder),
        **vary.shared_facts(front.optimization.scenario),
        "files": [str(folder / name) for name in ("front.csv", "front.nc")] + [str(path) for path in pictures],
        "n_points": len(front),
        "points": [vary.point_facts(front.point(i)) for i in front.spread(N_SHOWN)],
    }


def _text(front: Front, folder: Path) -> str:
    """Some points of a front as a table, and where the files are."""
    sought, parts = front.optimization, [_status(front)]
    if len(front):
        points = [front.point(i) for i in front.spread(N_SHOWN)]
        parts.append(vary.points_table(sought.scenario, sought.names, [*sought.objectives, *SHOWN], points))
    return "\n\n".join([*parts, f"All points: {folder}/front.csv, {folder}/front.nc"])


def _status(front: Front) -> str:
    sought = front.optimization
    words = " against ".join(name.replace("_", " ") for name in sought.objectives)
    tried = f"{front.n_trials} points tried"
    if front.n_infeasible:
        tried += f", {front.n_infeasible} of them not feasible"
    what = f"{sought.scenario.gait.kind.replace('_', '-')}, robot {sought.scenario.robot.name}, {words}: {tried}"
    if not len(front):
        return (
            f"{what}; none is left: gaits beyond the joints' limits or what their actuators have (--beyond-actuators), "
            "runs that blew up (a smaller --dt may help), that are too slow, or too short for the objective."
        )
    return f"{what}, {len(front)} on the front." if len(sought.objectives) > 1 else f"{what}; the best is:"
