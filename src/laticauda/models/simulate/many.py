"""`swim_many`: the figures of many trials, computed side by side and on all cores."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack, cast

import numpy as np
from jaxtyping import Bool, Float

from laticauda.models.simulate.batch_run import CPU, BatchResult
from laticauda.models.simulate.batch_scenarios import runs_of, scenarios_of_batch
from laticauda.models.simulate.loads_of_many import KeptLoads, TrialLoads
from laticauda.models.simulate.run_figures import UNITS, Figure, RunFigures, of_figure
from laticauda.models.simulate.run_table import Columns, check_columns, scenarios_of_extremes
from laticauda.models.simulate.runner import Progress, silent
from laticauda.models.simulate.several import swim_each
from laticauda.models.simulate.table_run import TableResult, run_all, run_columns
from laticauda.motion.gaits import Gait
from laticauda.robot import Environment, Robot
from laticauda.scenarios import ModelChanges, Planar, Scenario, Spatial, Start, check_many
from laticauda.trials import AXES, LOAD_FIGURES, Trial
from laticauda.trials.feasibility import ROUNDING
from laticauda.values import BadArgument, check_choice, check_instance

if TYPE_CHECKING:
    import xarray

COLUMNS_AT_ONCE = 1 << 16
"""Trials of columns that are computed at once: what is kept of them until then takes some ten megabytes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swims(RunFigures):
    """Figures of many trials, in the order of the arguments; each is defined as in a `Trial`.

    A figure is nan where a trial has none: all figures where the trial diverged, `steady_velocity`
    also where the trial is too short for its gait, `cost_of_transport` where the robot did not
    move.
    """

    center_of_mass: Float[np.ndarray, "n_trials n_axes"]
    """Final position of the center of mass [m]."""
    heading: Figure
    """Final heading [rad]."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How each trial ended."""
    utilization: Float[np.ndarray, " n_trials"] | None = None
    """As in a `Trial`: above 1, the robot cannot do it; None if `feasibility` was not asked for [-]."""
    peak_bending_moment: Figure | None = None
    """As in a `Trial`; this and the next five are None if loads were not asked for [N m]."""
    rms_bending_moment: Figure | None = None
    """As in a `Trial` [N m]."""
    peak_shear_force: Figure | None = None
    """As in a `Trial` [N]."""
    rms_shear_force: Figure | None = None
    """As in a `Trial` [N]."""
    peak_axial_force: Figure | None = None
    """As in a `Trial` [N]."""
    rms_axial_force: Figure | None = None
    """As in a `Trial` [N]."""
    loads: tuple[TrialLoads | None, ...] | None = None
    """What links and joints bear in each trial, None for one that diverged; None if `link_forces` was not asked for."""

    def __repr__(self) -> str:
        """Return one line: how many trials, their speeds and powers, how many failed, and how many are infeasible."""
        n_trials = len(self)
        n_failed = n_trials - int(np.count_nonzero(self.succeeded))
        facts = [f"{n_failed or 'none'} failed"]
        if self.utilization is None:
            facts.append("infeasible ones are counted with feasibility=True")
        else:
            n_infeasible = np.count_nonzero(self.utilization > 1.0 + ROUNDING)
            facts.append(f"{n_infeasible or 'none'} of them demand more than the robot offers")
        if n_failed < n_trials:
            speeds = f"{_describe_range(self.forward_velocity)} m/s"
            facts.insert(0, f"{speeds}, {_describe_range(self.mean_power)} W")
        return f"<Swims of {n_trials} trials: {'; '.join(facts)}>"

    def __len__(self) -> int:
        """Return the number of trials."""
        return len(self.status)

    def to_dataset(self) -> "xarray.Dataset":
        """Convert to an xarray Dataset with the dimension `trial`, labeled like the results of a sweep.

        It holds the figures, not `loads`. Add varied parameters with `assign_coords`; an amplitude, for instance, with
        `amplitude=("trial", amplitudes)`.
        """
        import xarray

        variables: dict[str, Any] = {"status": ("trial", np.array(self.status, dtype=object))}
        for name, values in vars(self).items():
            if name not in ("status", "loads") and values is not None:
                dimensions = ("trial", "axis")[: np.ndim(values)]
                variables[name] = dimensions, values, of_figure(name)
        axes = AXES[: self.center_of_mass.shape[1]]
        coordinates = {"trial": np.arange(len(self)), "axis": np.array(axes, dtype=object)}
        return xarray.Dataset(variables, coords=coordinates)


def swim_many(
    robots: Scenario | Sequence[Scenario] | Robot | Sequence[Robot] | str | Path,
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    columns: Columns | None = None,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    device: str = CPU,
    feasibility: bool = False,
    load_figures: bool = False,
    link_forces: bool = False,
    progress: Progress = silent,
    **changes: Unpack[ModelChanges],
) -> Swims:
    """Run many scenarios of one model, or let many robots swim, each starting straight and at rest.

    Trial i is the result of `swim` for the i-th element of every argument; where a single value is
    given instead of a sequence, all trials share it. Planar robots of equal shape are computed
    eight at a time, so a sweep over gaits, waters or sizes gains most; any mixture is allowed, and
    the figures agree with those of `swim` to rounding. Spatial robots run one by one on every
    thread, and their figures are those of `swim` to the last bit. Neither depends on what else is
    in the batch, nor on the number of threads.

    Args:
        robots: The scenarios, all planar or all spatial; planar ones share duration and sample
            interval. Controllers that are written for arrays, such as path following, are many
            times as fast as others (`Controller.vectorize`). Or the robots, together with their
            gaits; one robot may be given by preset name or file path.
        gaits: The commanded gaits.
        duration: Duration of every trial [s].
        columns: With a single scenario instead of robots: values of some of its numbers, one array for
            each and one value per trial, by the names of a sweep's parameters, such as
            `gait.amplitude` and `water.normal_drag` (SI, radians). No object is made for a trial, so
            a million takes no longer than the kernels; what differs besides the gait's waves costs
            about as much as a trial for each of its combinations.
        environments: Waters or grounds; None uses `default_water` of each robot and gait.
        starts: Start of each trial; None: at the origin, along x.
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        device: cpu, or a device provided by an installed package: cuda for a GPU, with
            `laticauda-cuda` (experimental), one planar trial per GPU thread. It pays off for
            thousands of trials.
        feasibility: Whether to compute `Swims.utilization` as well: which trials demand more than
            the robot offers. It takes about as long again as the fastest trials themselves, and
            works on the cpu.
        load_figures: Whether to compute the figures of what joints carry as well, such as
            `Swims.peak_bending_moment`. It takes seven times as long as the fastest trials
            themselves, half as long as trials with servos, and works on the cpu.
        link_forces: Whether to keep the force on every link and what every joint carries at all
            samples as well, as `Swims.loads`: about 1 MB for a trial of ten links and 30 s.
        progress: Called repeatedly with the completed share, from 0 to 1.
        changes: Settings of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`. A fluid law that branches
            with `if` works, but lane by lane.

    Returns:
        The figures, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or sequences differ in length, or there is
            no GPU.

    Example:
        >>> import laticauda as lc
        >>> gaits = [lc.eel_like(amplitude=a, frequency=2.0, phase_shift=0.7) for a in (0.4, 0.5, 0.6)]
        >>> lc.swim_many("mamba", gaits).forward_velocity.round(3)
        array([0.066, 0.091, 0.116])
        >>> scenario = lc.build_scenario("mamba", gaits[0])
        >>> columns = {"gait.amplitude": [0.4, 0.5, 0.6]}
        >>> lc.swim_many(scenario, columns=columns).forward_velocity.round(3)
        array([0.066, 0.091, 0.116])
    """
    requested = _Requested(
        feasibility=feasibility, load_figures=load_figures or link_forces, link_forces=link_forces
    )
    if columns is not None:
        check_choice("device", device, (CPU,))
        if gaits is not None or environments is not None or starts is not None or changes:
            raise BadArgument(
                "columns", "must be given with a scenario alone, and nothing to change it"
            )
        return _swim_columns(robots, columns, requested, threads=threads, progress=progress)
    if isinstance(robots, Scenario):
        rule = "must be a list of scenarios, or a scenario with `columns` of numbers that differ"
        raise BadArgument("robots", f"{rule}, got one without")
    scenarios = scenarios_of_batch(
        cast(Any, robots),
        gaits,
        environments=environments,
        starts=starts,
        duration=duration,
        sample_interval=sample_interval,
        **changes,
    )
    if scenarios and isinstance(getattr(scenarios[0], "model", None), Spatial):
        check_choice("device", device, (CPU,))
        check_many(scenarios)
        return _swim_spatial(scenarios, requested, threads=threads, progress=progress)
    if requested.needs_log:
        check_choice("device", device, (CPU,))
    runs = runs_of(scenarios, steered=True)
    check_many(scenarios)
    first = scenarios[0]
    kept_loads = None
    if requested.load_figures:
        kept_loads = KeptLoads(len(runs), with_series=requested.link_forces)
    result = run_all(
        runs,
        first.duration,
        first.sample_interval,
        threads=threads,
        progress=progress,
        device=device,
        with_peaks=requested.feasibility,
        kept_loads=kept_loads,
    )
    return _swims_of(result.batch, _fields_of_request(result, requested))


@dataclass(frozen=True, kw_only=True)
class _Requested:
    """What was asked for besides the figures that cost nothing."""

    feasibility: bool
    load_figures: bool
    link_forces: bool

    @property
    def needs_log(self) -> bool:
        """Whether the log of the joints is needed."""
        return self.feasibility or self.load_figures


def _swim_columns(
    scenario: object,
    columns: Columns,
    requested: _Requested,
    *,
    threads: int | None,
    progress: Progress,
) -> Swims:
    """Return the figures of a scenario with other values of some of its numbers; arguments as for `swim_many`."""
    checked_scenario = cast(Scenario, check_instance("robots", scenario, Scenario))
    check_instance("robots.model", checked_scenario.model, Planar)
    arrays = check_columns(checked_scenario, columns)
    _, largest = scenarios_of_extremes(checked_scenario, arrays)
    check_many([largest])  # batches may begin at little
    n_trials = next(iter(arrays.values())).size
    parts: list[Swims] = []
    for first in range(0, n_trials, COLUMNS_AT_ONCE):
        part = {name: values[first : first + COLUMNS_AT_ONCE] for name, values in arrays.items()}

        def report(share: float, n_before: int = first) -> None:
            n_of_part = min(COLUMNS_AT_ONCE, n_trials - n_before)
            progress((n_before + share * n_of_part) / n_trials)

        result = run_columns(
            checked_scenario,
            part,
            threads=threads,
            progress=report,
            with_peaks=requested.feasibility,
            with_loads=requested.load_figures,
            with_load_series=requested.link_forces,
        )
        parts.append(_swims_of(result.batch, _fields_of_request(result, requested)))
    return _join_swims(parts)


def _fields_of_request(result: TableResult, requested: _Requested) -> dict[str, Any]:
    """Return the fields of `Swims` that were asked for besides the figures that cost nothing."""
    fields: dict[str, Any] = {}
    if requested.feasibility:
        utilization = result.peaks["utilization"]
        fields["utilization"] = np.where(result.batch.succeeded, utilization, np.nan)
    if result.loads is not None:
        fields |= result.loads.figures
        if requested.link_forces:
            fields["loads"] = tuple(result.loads.series)
    return fields


def _join_swims(parts: Sequence[Swims]) -> Swims:
    """Return the trials of several parts, one after the other."""
    if len(parts) == 1:
        return parts[0]
    joined: dict[str, Any] = {}
    for name, values in vars(parts[0]).items():
        values_of_parts = [getattr(part, name) for part in parts]
        if isinstance(values, tuple):
            joined[name] = tuple(chain.from_iterable(values_of_parts))
        elif values is not None:
            joined[name] = np.concatenate(values_of_parts)
    return Swims(**joined)


def _describe_range(values: np.ndarray) -> str:
    """Return the smallest and the largest value, or the only one; nan is left out."""
    lowest, highest = f"{np.nanmin(values):.3g}", f"{np.nanmax(values):.3g}"
    if lowest == highest:
        return lowest
    return f"{lowest} to {highest}"


def _swims_of(result: BatchResult, of_request: Mapping[str, Any]) -> Swims:
    """Return the figures of a batch with the final positions as vectors, and what was asked for besides."""
    positions = [result.figures[axis] for axis in AXES if axis in result.figures]
    scalar_figures: dict[str, Any] = {
        name: values
        for name, values in result.figures.items()
        if name not in (*AXES, "utilization", *LOAD_FIGURES)
    }
    return Swims(
        **of_request,
        **scalar_figures,
        center_of_mass=np.stack(positions, axis=1),
        succeeded=result.succeeded,
        status=result.status,
    )


SPATIAL_FIGURES = (*UNITS, "z", "utilization", *LOAD_FIGURES)
"""Names of the figures of a spatial trial; those of loads only if they are asked for."""


class _SpatialResult(NamedTuple):
    """Figures of a spatial trial, and how it ended."""

    numbers: list[float | None]
    """In the order of `SPATIAL_FIGURES`; None where the trial has none."""
    succeeded: bool
    status: str
    loads: TrialLoads | None
    """What links and joints bear, if all samples are to be kept."""


def _swim_spatial(
    scenarios: Sequence[Scenario],
    requested: _Requested,
    *,
    threads: int | None,
    progress: Progress,
) -> Swims:
    """Return the figures of spatial scenarios; arguments as for `swim_many`."""
    for i, scenario in enumerate(scenarios):
        check_instance(f"scenarios[{i}].model", scenario.model, Spatial)
    trials = swim_each(
        scenarios,
        partial(_spatial_result, keeps_loads=requested.link_forces),
        link_forces=requested.load_figures,
        threads=threads,
        progress=progress,
    )
    table = np.array([trial.numbers for trial in trials], dtype=float)
    figures = dict(zip(SPATIAL_FIGURES, table.T, strict=True))
    result = BatchResult(
        figures=figures,
        succeeded=np.array([trial.succeeded for trial in trials]),
        status=tuple(trial.status for trial in trials),
    )
    of_request: dict[str, Any] = {}
    if requested.feasibility:
        of_request["utilization"] = figures["utilization"]
    if requested.load_figures:
        of_request |= {name: figures[name] for name in LOAD_FIGURES}
    if requested.link_forces:
        of_request["loads"] = tuple(trial.loads for trial in trials)
    return _swims_of(result, of_request)


def _spatial_result(trial: Trial, *, keeps_loads: bool) -> _SpatialResult:
    """Return the figures of a trial; all are None if it diverged."""
    figures: Mapping[str, float | None] = {}
    if trial.succeeded:
        positions = dict(zip(AXES, trial.center_of_mass[-1], strict=True))
        figures = {**trial.figures()[0], "heading": trial.heading[-1], **positions}
    return _SpatialResult(
        numbers=[figures.get(name) for name in SPATIAL_FIGURES],
        succeeded=trial.succeeded,
        status=trial.status,
        loads=TrialLoads.of_trial(trial) if keeps_loads else None,
    )
