"""`laticauda sweep` and `laticauda optimize`: many trials of one scenario, in a folder where a stopped command resumes.

Sweeps run thousands to millions of trials; optimizations search for the best gaits, fins or numbers
of links, or for the front between speed and power.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from laticauda import studies
from laticauda.cli import vary
from laticauda.cli.command import Outcome, stored_trials
from laticauda.cli.flags import File, Folder, Picture, Words
from laticauda.cli.scene import warn_of_compiling
from laticauda.cli.tables import read_in
from laticauda.cli.vary import Known, Study
from laticauda.models.simulate.numbers import list_parameters
from laticauda.scenarios import Scenario
from laticauda.show import figures
from laticauda.studies.cluster import connected
from laticauda.studies.optimization import Limits
from laticauda.studies.sampling import Points
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

N_BEST, N_SHOWN = 5, 8
SHOWN_OF_BEST = ("forward_velocity", "mean_power", "cost_of_transport", "utilization")
SHOWN_OF_FRONT = ("forward_velocity", "mechanical_power", "cost_of_transport", "utilization")
BOTH = "speed-power"
OBJECTIVES = (
    BOTH,
    "forward-velocity",
    "steady-velocity",
    "mechanical-power",
    "mean-power",
    "cost-of-transport",
)
RANGES = ("amplitude-deg=10:50", "frequency-deg-s=50:150", "phase-shift-deg=10:60")


@value_class
class SweepCommand(Study):
    """Run a trial at every point of a grid, a list or a set of samples, and print the best.

    For example: laticauda sweep --robot mamba --gait lateral-undulation --vary
    amplitude-deg=10:50:20 frequency-deg-s=50:150:20 normal-drag=1,1.75 --output sweep

    The results are one xarray Dataset in sweep/results.zarr. After a stop or a kill, the same
    command resumes.
    """

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "LOW:HIGH:COUNT or VALUE,VALUE,... of a parameter of robot, gait or water, with the unit in its name: "
        "amplitude-deg=10:50:100. Every combination is a trial",
        default=(),
    )
    samples: int | None = quantity(
        "", "Number of points, spread evenly over NAME=LOW:HIGH", ge=1, default=None
    )
    seed: int | None = quantity(
        "", "Seed of the samples; another seed gives other points", ge=0, default=None
    )
    list: File = option(
        "Take the points from this CSV file instead; its first line has the names", default=None
    )
    scheduler: str | None = option(
        "Run on a Dask cluster: its scheduler, such as tcp://host:8786", default=None
    )
    output: Folder = option(
        "Folder of results, where the same command resumes after a stop", default="sweep"
    )
    plot: Picture = option(
        "Plot speed and cost of transport over the parameters (.png, .pdf, .svg)", default=None
    )
    best: Literal[
        "forward-velocity",
        "steady-velocity",
        "mechanical-power",
        "net-power",
        "mean-power",
        "cost-of-transport",
    ] = option(
        "Figure by which the best points in the table are ranked", default="forward-velocity"
    )

    def studied(self, scenario: Scenario, known: Known) -> Outcome:
        """Run all trials that are not stored yet."""
        try:
            sweep = studies.Sweep(scenario=scenario, points=self._points(known))
        except BadArgument as error:
            if self.list is None or error.name == "list":
                raise
            where = "" if error.name in ("vary", "points") else f" `{error.name}`"
            raise BadArgument("list", f"of {self.list}{where} {error.rule}") from error
        with stored_trials(self.output) as show, connected(self.scheduler) as client:
            if client is None:
                warn_of_compiling(scenario.environment, scenario.model)
            studies.run_sweep(
                sweep, self.output, progress=show, client=client, threads=self.threads
            )
        n_trials, n_failed = sweep.n_trials, studies.count_failed(self.output)
        if self.plot is not None:
            figures.save_figure(figures.sweep_sheet(studies.open_sweep(self.output)), self.plot)
        status = f"All {n_trials} trials reached their end."
        if n_failed:
            status = f"{n_failed} of {n_trials} trials blew up; a smaller `dt` may help."
        figure = self.best.replace("-", "_")
        points = studies.best_points(self.output, figure, N_BEST)
        facts: dict[str, Any] = {
            "status": status,
            "n_trials": n_trials,
            "n_failed": n_failed,
            "best_in": figure,
            "best": points,
            "output": self.output,
            **vary.shared_facts(scenario),
        }
        table = vary.points_table(scenario, sweep.points.names, [*SHOWN_OF_BEST, figure], points)
        title = f"{status} The best in {figure.replace('_', ' ')}:"
        text = f"{title}\n\n{table}\n\nAll results: {self.output}/results.zarr (xarray.open_zarr)"
        return Outcome(facts=facts, text=text, succeeded=n_failed < n_trials)

    def _points(self, known: Known) -> Points:
        """Return the requested points."""
        words = [word for group in self.vary for word in group]
        if self.seed is not None and self.samples is None:
            raise BadArgument(
                "seed", "must be given with --samples only: a grid and a list are not random"
            )
        if self.list is not None:
            if words or self.samples is not None:
                raise BadArgument("list", "must not be given together with --vary or --samples")
            return vary.read_rows(self.list, known)
        if not words:
            raise BadArgument(
                "vary", f"must be given, or --list: {vary.FORM}; --names lists what can be varied"
            )
        if self.samples is None:
            return vary.parse_grid(words, known)
        ranges = vary.parse_ranges(words, known, vary.SAMPLES_FORM)
        return studies.Samples(ranges=ranges, n_points=self.samples, seed=self.seed or 0)


@value_class
class Optimize(Study):
    """Search for the best gait, fin or number of links, or for the front between speed and power.

    For example: laticauda optimize --robot mamba --gait lateral-undulation --vary
    amplitude-deg=10:50 frequency-deg-s=50:150 phase-shift-deg=10:60 --objective speed-power --seed
    1 --output optimum

    Writes front.csv, front.nc and, for two objectives, the figure front.png. After a stop or a
    kill, the same command resumes.
    """

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "NAME=LOW:HIGH: range of a parameter of robot, gait or water, with the unit in its name; if omitted, "
        f"{' '.join(RANGES)}",
        default=(),
    )
    objective: Words = option(
        "One or two of forward-velocity, steady-velocity (maximized), mechanical-power, mean-power, "
        "cost-of-transport (minimized). Two give the front between them; "
        "speed-power is short for forward-velocity mechanical-power",
        default=(BOTH,),
    )
    budget: int = quantity(
        "", "Number of points to try; a larger budget continues a smaller one", ge=1, default=4000
    )
    population: int | None = quantity(
        "", "Points per generation; if omitted, 100, or 40 for one objective", ge=1, default=None
    )
    seed: int = quantity(
        "", "Seed of all random numbers; another seed searches differently", ge=0, default=0
    )
    limits: Limits = option("Limits that gaits must observe", default=Limits())
    output: Folder = option(
        "Folder of results, where a stopped search resumes when run again", default="optimum"
    )

    def studied(self, scenario: Scenario, known: Known) -> Outcome:
        """Search, and write the front."""
        from laticauda.show.reports.front import write_front_figure

        folder = Path(self.output)
        front = self._front(scenario, folder)
        front.write_csv(folder / "front.csv")
        front.write_netcdf(folder / "front.nc")
        pictures = write_front_figure([front], folder)
        text = [_text(front, folder)]
        if pictures:
            text.append(f"Figure: {', '.join(map(str, pictures))}")
        return Outcome(
            facts=_facts(front, folder, pictures), text="\n\n".join(text), succeeded=len(front) > 0
        )

    def _front(self, scenario: Scenario, folder: Path) -> studies.Front:
        """Do the remaining work."""
        names = [
            check_choice("objective", word.replace("_", "-"), OBJECTIVES) for word in self.objective
        ]
        words = [word for group in self.vary for word in group] or RANGES
        sought = studies.Optimization(
            scenario=scenario,
            bounds=vary.parse_ranges(words, list_parameters(scenario), vary.RANGE_FORM),
            objectives=studies.SPEED_POWER
            if names == [BOTH]
            else [name.replace("-", "_") for name in names],
            **vars(self.limits),
        )
        warn_of_compiling(scenario.environment, scenario.model)
        how = {name: getattr(self, name) for name in ("budget", "population", "seed", "threads")}
        with stored_trials(folder) as show:
            return studies.optimize(sought, folder, progress=show, **how)


def _facts(front: studies.Front, folder: Path, pictures: Sequence[Path]) -> dict[str, Any]:
    """Return what was run and some points of a front, in SI units."""
    return {
        "status": _status(front),
        "objectives": list(front.optimization.objectives),
        "n_trials": front.n_trials,
        "n_infeasible": front.n_infeasible,
        "seed": front.seed,
        "output": str(folder),
        **vary.shared_facts(front.optimization.scenario),
        "files": [str(folder / name) for name in ("front.csv", "front.nc")]
        + [str(path) for path in pictures],
        "n_points": len(front),
        "at_bounds": front.at_bounds(),
        "points": [front.point(i) for i in front.spread(N_SHOWN)],
    }


def _text(front: studies.Front, folder: Path) -> str:
    """Return some points of a front as a table, and the location of the files."""
    sought, parts = front.optimization, [_status(front)]
    if len(front):
        points = [front.point(i) for i in front.spread(N_SHOWN)]
        parts.append(
            vary.points_table(
                sought.scenario, sought.names, [*sought.objectives, *SHOWN_OF_FRONT], points
            )
        )
    parts += filter(None, ["\n".join(_at_bounds(front))])
    return "\n\n".join([*parts, f"All points: {folder}/front.csv, {folder}/front.nc"])


def _at_bounds(front: studies.Front) -> list[str]:
    """Return a sentence for each parameter that lies at an end of its range."""
    known, found = list_parameters(front.optimization.scenario), list[str]()
    for row in front.at_bounds():
        parameter = known[row["name"]]
        at = "" if len(front) == 1 else f" at {row['n_points']} of the {len(front)} points"
        text = f"{vary.spell_parameter(parameter)} is {' '.join(read_in(row['value'], parameter.unit)).strip()}{at}"
        found.append(
            f"{text}, the {row['end']} of its range: the best may be beyond it; widen it with --vary."
        )
    return found


def _status(front: studies.Front) -> str:
    sought = front.optimization
    words = " against ".join(name.replace("_", " ") for name in sought.objectives)
    tried = f"{front.n_trials} points tried"
    if front.n_infeasible:
        tried += f", {front.n_infeasible} of them not feasible"
    what = f"{sought.scenario.gait.kind.replace('_', '-')}, robot {sought.scenario.robot.name}, {words}: {tried}"
    if not len(front):
        return (
            f"{what}; none is feasible: gaits exceed the limits of joints or actuators (--beyond-actuators), or "
            "runs blow up (a smaller --dt may help), are too slow, or are too short for the objective."
        )
    return (
        f"{what}, {len(front)} on the front."
        if len(sought.objectives) > 1
        else f"{what}; the best is:"
    )
