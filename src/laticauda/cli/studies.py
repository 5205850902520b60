"""`laticauda sweep` and `laticauda optimize`: many trials of one scenario, in a folder where a stopped command resumes.

Sweeps run thousands to millions of trials; optimizations search for the best gaits, fins or numbers
of links, or for the front between speed and power.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import tyro

from laticauda import studies
from laticauda.cli.command import Outcome
from laticauda.cli.design_report import Design, describe_refusals, describe_start
from laticauda.cli.flags import File, Folder, PictureOutput, Words
from laticauda.cli.progress import stored_trials
from laticauda.cli.scene import warn_of_compiling
from laticauda.cli.shared_options import (
    check_way_of_running,
    merge_option,
    scheduler_option,
    share_option,
)
from laticauda.cli.tables import format_figure
from laticauda.cli.vary import (
    FORM,
    RANGE_FORM,
    SAMPLES_FORM,
    Parameters,
    Study,
    format_points,
    parse_grid,
    parse_ranges,
    read_rows,
    shared_facts,
    spell_parameter,
)
from laticauda.models.simulate import connected
from laticauda.models.simulate.numbers import list_parameters
from laticauda.robot import with_servos
from laticauda.scenarios import Scenario
from laticauda.show import figures
from laticauda.studies import (
    Limits,
    Merged,
    Points,
    Share,
    describe_limits,
    parse_share,
    scenarios_at,
)
from laticauda.trials import LOAD_FIGURES
from laticauda.trials.feasibility import CAN_DO
from laticauda.values import BadArgument, check_choice, option, quantity, value_class

N_BEST = 5
"""Number of points of a sweep that are printed."""
N_SHOWN = 8
"""Number of points of a front that are printed."""
SHOWN_OF_BEST = ("forward_velocity", "mean_power", "cost_of_transport", "utilization")
SHOWN_OF_FRONT = ("forward_velocity", "mechanical_power", "cost_of_transport", "utilization")
SHOWN_OF_LOADS = ("peak_bending_moment", "peak_shear_force", "peak_axial_force")
SPEED_AND_POWER = "speed-power"
IN_MOVING_WATER = "The water moves: speeds and costs of transport are ranked through the water."
OBJECTIVES = (
    SPEED_AND_POWER,
    "forward-velocity",
    "steady-velocity",
    "speed-through-water",
    "steady-speed-through-water",
    "mechanical-power",
    "mean-power",
    "cost-of-transport",
    *(name.replace("_", "-") for name in LOAD_FIGURES),
)
RANGES = ("amplitude-deg=10:50", "frequency-deg-s=50:150", "phase-shift-deg=10:60")


@value_class
class Sweep(Study):
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
    list: File = option(  # its option is --list, so it hides the builtin in this class
        "Take the points from this CSV file instead; its first line has the names", default=None
    )
    loads: bool = option(
        "Also store bending moment, shear and axial force in the joints: peak and rms, as --best names them",
        default=False,
    )
    scheduler: str | None = scheduler_option()
    share: str | None = share_option("folder", "--output")
    merge: bool = merge_option("--output")
    output: Folder = option(
        "Folder of results, where the same command resumes after a stop", default="sweep"
    )
    plot: PictureOutput = option(
        "Plot speed and cost of transport over the parameters (.png, .pdf, .svg)", default=None
    )
    best: Literal[
        "forward-velocity",
        "steady-velocity",
        "speed-through-water",
        "steady-speed-through-water",
        "mechanical-power",
        "net-power",
        "mean-power",
        "cost-of-transport",
        "peak-bending-moment",
        "rms-bending-moment",
        "peak-shear-force",
        "rms-shear-force",
        "peak-axial-force",
        "rms-axial-force",
    ] = option(
        "Figure by which the best points in the table are ranked; where the water moves, a speed is that through it",
        default="forward-velocity",
    )

    def run_study(self, scenario: Scenario, parameters: Parameters) -> Outcome:
        """Run all trials that are not stored yet."""
        self._check_way_of_running()
        sweep = self._make_sweep(scenario, parameters)
        if self.share is not None:
            return self._run_share(sweep, parse_share(self.share))
        if self.merge:
            merged = self._merge(sweep)
            if merged.n_done < sweep.n_trials:
                return _report_unfinished(sweep, merged, self.output)
        else:
            self._run(sweep, share=None)
        if self.plot is not None:
            sheet = figures.sweep_sheet(
                studies.open_sweep(self.output), lambda points: _name_limits(scenario, points)
            )
            figures.save_figure(sheet, self.plot)
        return self._report(scenario, sweep)

    def _check_way_of_running(self) -> None:
        """Refuse options that contradict each other."""
        check_way_of_running(self.share, self.scheduler, merge=self.merge)
        if self.share is not None and self.plot is not None:
            raise BadArgument("plot", "must not be given with --share, but with --merge")

    def _run(self, sweep: studies.Sweep, share: Share | None) -> str:
        """Run all trials of the sweep, or of a share, that are not stored yet; return their folder."""
        scenario = sweep.scenario
        folder = self.output
        if share is not None:
            folder = str(share.folder(self.output))
        with stored_trials(folder) as show, connected(self.scheduler) as client:
            if client is None:
                warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
            studies.run_sweep(
                sweep, self.output, progress=show, client=client, threads=self.threads, share=share
            )
        return folder

    def _run_share(self, sweep: studies.Sweep, share: Share) -> Outcome:
        """Run a share, and report how many of its trials failed."""
        folder = self._run(sweep, share)
        n_done = studies.open_sweep(folder).n_finished
        n_failed = studies.count_failed(folder)
        status = f"Share {self.share}: {n_done} of {sweep.n_trials} trials are in {folder}."
        if n_failed:
            status += f" {n_failed} of them blew up; a smaller `dt` may help."
        facts: dict[str, Any] = {
            "status": status,
            "n_trials": sweep.n_trials,
            "n_done": n_done,
            "n_failed": n_failed,
            "output": folder,
            **shared_facts(sweep.scenario),
        }
        text = f"{status}\nWhen all shares are done: the same command with --merge for --share."
        return Outcome(facts=facts, text=text, succeeded=n_done == 0 or n_failed < n_done)

    def _merge(self, sweep: studies.Sweep) -> Merged:
        with stored_trials(self.output) as show:
            return studies.merge_shares(sweep, self.output, progress=show)

    def _make_sweep(self, scenario: Scenario, parameters: Parameters) -> studies.Sweep:
        """Return the requested sweep; errors about points of a list name the file."""
        try:
            return studies.Sweep(
                scenario=scenario,
                points=self._points(parameters),
                loads=self.loads or self._best_figure in LOAD_FIGURES,
            )
        except BadArgument as error:
            if self.list is None or error.name == "list":
                raise
            position = f"of {self.list}"
            if error.name not in ("vary", "points"):
                position += f" `{error.name}`"
            raise BadArgument("list", f"{position} {error.rule}") from error

    @property
    def _best_figure(self) -> str:
        """Name of the figure by which points are ranked."""
        return self.best.replace("-", "_")

    def _report(self, scenario: Scenario, sweep: studies.Sweep) -> Outcome:
        """Report how many trials failed, and the best points."""
        n_trials = sweep.n_trials
        n_failed = studies.count_failed(self.output)
        status = f"All {n_trials} trials reached their end."
        if n_failed:
            status = f"{n_failed} of {n_trials} trials blew up; a smaller `dt` may help."
        varied = sweep.points.names
        figure = studies.swum_figure(self._best_figure, scenario, varied)
        if studies.moves_water(scenario, varied):
            status += f" {IN_MOVING_WATER}"
        n_infeasible = studies.count_infeasible(self.output)
        points = studies.best_points(self.output, figure, N_BEST, feasible_first=True)
        limits = [_name_limits_beyond(scenario, sweep.points.names, point) for point in points]
        facts: dict[str, Any] = {
            "status": status,
            "n_trials": n_trials,
            "n_failed": n_failed,
            "n_infeasible": n_infeasible,
            "best_in": figure,
            "best": [
                {**point, "beyond": limit} for point, limit in zip(points, limits, strict=True)
            ],
            "output": self.output,
            **shared_facts(scenario),
        }
        columns: dict[str, Sequence[str]] = {}
        if any(limits):
            columns["beyond the limit of"] = [limit or "-" for limit in limits]
        figures_shown = [*SHOWN_OF_BEST, figure]
        if sweep.loads:
            figures_shown += SHOWN_OF_LOADS
        table = format_points(scenario, sweep.points.names, figures_shown, points, columns)
        title = f"{status} The best in {figure.replace('_', ' ')}:"
        if n_infeasible:
            n_feasible = n_trials - n_failed - n_infeasible
            possible = f"The robot can do {n_feasible} of them; the others come last."
            if n_feasible == 0:
                possible = "The robot can do none of them."
            title = f"{status} {possible} The best in {figure.replace('_', ' ')}:"
        text = f"{title}\n\n{table}\n\nAll results: {self.output}/results.zarr (xarray.open_zarr)"
        return Outcome(facts=facts, text=text, succeeded=n_failed < n_trials)

    def _points(self, parameters: Parameters) -> Points:
        """Return the requested points."""
        typed = list(chain.from_iterable(self.vary))
        if self.seed is not None and self.samples is None:
            rule = "must be given with --samples only: a grid and a list are not random"
            raise BadArgument("seed", rule)
        if self.list is not None:
            if typed or self.samples is not None:
                raise BadArgument("list", "must not be given together with --vary or --samples")
            return read_rows(self.list, parameters)
        if not typed:
            rule = f"must be given, or --list: {FORM}; --names lists what can be varied"
            raise BadArgument("vary", rule)
        if self.samples is None:
            return parse_grid(typed, parameters)
        ranges = parse_ranges(typed, parameters, SAMPLES_FORM)
        return studies.Samples(ranges=ranges, n_points=self.samples, seed=self.seed or 0)


def _report_unfinished(sweep: studies.Sweep, merged: Merged, output: str) -> Outcome:
    """Report which shares are missing in a folder that they were merged in."""
    missing = ", ".join(str(share) for share in merged.unfinished)
    status = (
        f"{merged.n_done} of {sweep.n_trials} trials are in {output}: "
        f"not finished yet are the shares {missing}."
    )
    facts: dict[str, Any] = {
        "status": status,
        "n_trials": sweep.n_trials,
        "n_done": merged.n_done,
        "unfinished": [asdict(share) for share in merged.unfinished],
        "output": output,
        **shared_facts(sweep.scenario),
    }
    advice = "Run them, and merge again; or run the same command without --merge, which does the rest here."
    return Outcome(facts=facts, text=f"{status}\n{advice}", succeeded=False)


@value_class
class Optimize(Study):
    """Search for the best gait, fin or body, or for the front between speed and power.

    For example: laticauda optimize --robot mamba --gait lateral-undulation --vary
    amplitude-deg=10:50 frequency-deg-s=50:150 phase-shift-deg=10:60 --objective speed-power --budget
    400 --seed 1 --output optimum

    Writes front.csv, front.nc and, for two objectives, the figure front.png; for one objective and
    numbers of the robot also robot.toml, scenario.toml and the drawing design.png. After a stop or
    a kill, the same command resumes.
    """

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "NAME=LOW:HIGH: range of a parameter of robot, gait or water, with the unit in its name; if omitted, "
        f"{' '.join(RANGES)}",
        default=(),
    )
    objective: Words = option(
        "One or two of forward-velocity, steady-velocity (maximized; where the water moves, through it), "
        "mechanical-power, mean-power, cost-of-transport, or peak- or rms- with bending-moment, shear-force or "
        "axial-force in a joint (minimized). Two give the front between them; "
        "speed-power is short for forward-velocity mechanical-power",
        default=(SPEED_AND_POWER,),
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
    servo: str | None = option(
        "Servo of all joints, a preset such as xw540-t140 or a TOML file; if omitted, the robot's own",
        default=None,
    )
    method: studies.Method = option(
        "How points are chosen; auto follows slopes where there are some", default="auto"
    )
    scheduler: str | None = scheduler_option()
    limits: Limits = option("Limits that gaits must observe", default=Limits())
    output: Folder = option(
        "Folder of results, where a stopped search resumes when run again", default="optimum"
    )

    def run_study(self, scenario: Scenario, parameters: Parameters) -> Outcome:
        """Search, and write the front."""
        from laticauda.show.reports import write_front_figure

        folder = Path(self.output)
        if self.servo is not None:
            scenario = replace(scenario, robot=with_servos(scenario.robot, self.servo))
        front = self._front(scenario, folder)
        front.write_csv(folder / "front.csv")
        front.write_netcdf(folder / "front.nc")
        pictures = write_front_figure([front], folder)
        paragraphs = [_describe_front(front, folder)]
        design = Design.of(front)
        if design is not None:
            pictures = [*pictures, *design.write(folder)]
            paragraphs.append(design.words)
        elif pictures:
            paragraphs.append(f"Figure: {', '.join(map(str, pictures))}")
        facts = _facts_of_front(front, folder, pictures)
        if design is not None:
            facts["limits"] = design.facts
        return Outcome(
            facts=facts,
            text="\n\n".join(paragraphs),
            succeeded=len(front) > 0,
        )

    def _front(self, scenario: Scenario, folder: Path) -> studies.Front:
        """Do the remaining work."""
        objectives = self._objectives()
        typed = list(chain.from_iterable(self.vary)) or RANGES
        optimization = studies.Optimization(
            scenario=scenario,
            bounds=parse_ranges(typed, list_parameters(scenario), RANGE_FORM),
            objectives=objectives,
            **vars(self.limits),
        )
        with stored_trials(folder) as show, connected(self.scheduler) as client:
            if client is None:
                warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
            return studies.optimize(
                optimization,
                folder,
                progress=show,
                budget=self.budget,
                population=self.population,
                method=self.method,
                seed=self.seed,
                client=client,
                threads=self.threads,
            )

    def _objectives(self) -> Sequence[str]:
        """Return the names of the figures that are optimized."""
        names = [
            check_choice("objective", name.replace("_", "-"), OBJECTIVES) for name in self.objective
        ]
        if names == [SPEED_AND_POWER]:
            return studies.SPEED_POWER
        return [name.replace("-", "_") for name in names]


def _name_limits(scenario: Scenario, points: Sequence[Mapping[str, float]]) -> str:
    """Return which limits of the robot the trials at some points of a sweep come up against."""
    names = tuple(points[0])
    table = np.array([[point[name] for name in names] for point in points])
    return describe_limits(scenarios_at(scenario, names, table))


def _name_limits_beyond(
    scenario: Scenario, names: Sequence[str], point: Mapping[str, float]
) -> str | None:
    """Return which limits of the robot the trial at a point is beyond; None: the robot can do it."""
    if not point["utilization"] > CAN_DO:
        return None
    return _name_limits(scenario, [{name: point[name] for name in names}]) or "the robot"


def _facts_of_front(front: studies.Front, folder: Path, pictures: Sequence[Path]) -> dict[str, Any]:
    """Return what was run and some points of a front, in SI units."""
    files = [folder / "front.csv", folder / "front.nc", *pictures]
    return {
        "status": _describe_status(front),
        "objectives": list(front.optimization.objectives),
        "n_trials": front.n_trials,
        "n_infeasible": front.n_infeasible,
        "seed": front.seed,
        "output": str(folder),
        **shared_facts(front.optimization.scenario),
        "files": [str(path) for path in files],
        "n_points": len(front),
        "at_bounds": front.at_bounds(),
        "points": [front.point(i) for i in front.spread(N_SHOWN)],
    }


def _describe_front(front: studies.Front, folder: Path) -> str:
    """Return some points of a front as a table, and the location of the files."""
    optimization = front.optimization
    parts = [_describe_status(front)]
    if len(front):
        points = [front.point(i) for i in front.spread(N_SHOWN)]
        figures_shown = [*optimization.objectives, *SHOWN_OF_FRONT, *optimization.load_limits]
        table = format_points(optimization.scenario, optimization.names, figures_shown, points)
        parts.append(table)
    hints = _hints_to_widen(front)
    if hints:
        parts.append("\n".join(hints))
    parts.append(f"All points: {folder}/front.csv, {folder}/front.nc")
    return "\n\n".join(parts)


def _hints_to_widen(front: studies.Front) -> list[str]:
    """Return a sentence for each parameter that lies at an end of its range."""
    parameters = list_parameters(front.optimization.scenario)
    sentences: list[str] = []
    for row in front.at_bounds():
        parameter = parameters[row["name"]]
        value = " ".join(format_figure(row["value"], parameter.unit)).strip()
        if len(front) > 1:
            value += f" at {row['n_points']} of the {len(front)} points"
        finding = f"{spell_parameter(parameter)} is {value}, the {row['end']} of its range"
        sentences.append(f"{finding}: the best may be beyond it; widen it with --vary.")
    return sentences


def _describe_status(front: studies.Front) -> str:
    optimization = front.optimization
    scenario = optimization.scenario
    gait = scenario.gait.kind.replace("_", "-")
    objectives = " against ".join(name.replace("_", " ") for name in optimization.objectives)
    status = f"{gait}, robot {scenario.robot.name}, {objectives}: {front.n_trials} points tried"
    if front.n_infeasible:
        status += f", {front.n_infeasible} of them not feasible"
    if front.n_slope_trials:
        status += f", and {front.n_slope_trials} trials for slopes"
    if not len(front) and optimization.limits_design:
        refused = describe_refusals(front)
        return f"{status}; none is feasible: {refused}. The robot as it is: {describe_start(optimization)}"
    if not len(front):
        return (
            f"{status}; none is feasible: gaits exceed the limits of joints or actuators (--beyond-actuators), or "
            "runs blow up (a smaller --dt may help), are too slow, or are too short for the objective."
        )
    if len(optimization.objectives) > 1:
        status = f"{status}, {len(front)} on the front."
        if studies.moves_water(scenario, optimization.names):
            status += f" {IN_MOVING_WATER}"
        return status
    if studies.moves_water(scenario, optimization.names):
        return f"{status}. {IN_MOVING_WATER} The best is:"
    return f"{status}; the best is:"
