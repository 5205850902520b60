"""What the model says about measurements, and the derivatives of that to the unknowns.

The planar model computes all trials side by side, and their derivatives by a complex step in the kernels. The 3D twin
is run trial by trial, and its derivatives are differences.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem, Setting
from laticauda.identify.unknowns import SIDE
from laticauda.interfaces import Start
from laticauda.planar import rows
from laticauda.planar.batch import STEP, Block, Run
from laticauda.simulate.derivatives import Number, slopes
from laticauda.simulate.many import collected, runs_of
from laticauda.simulate.parameters import changed
from laticauda.simulate.runner import Progress
from laticauda.simulate.sensitivities import UNITS
from laticauda.simulate.swimming import swim
from laticauda.trial import Trial, metrics

SAMPLE_INTERVAL = 0.05  # of the logs that series are interpolated from [s]
DIFFERENCE = 1e-3  # a step of the differences in the 3D twin, as a share of what is a large change

Raw = dict[str, Any]
"""What a run gave, by name of figure or series; complex if it has a derivative."""
Values = Float[np.ndarray, " n_unknowns"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Predicted:
    """What the model says at some values of the unknowns."""

    values: Float[np.ndarray, " n_data"]
    """As `Problem.observed`; nan where a run diverged."""
    jacobian: Float[np.ndarray, "n_data n_unknowns"] | None
    """Derivative of each to each unknown, if asked for."""
    failures: Mapping[str, str]
    """How runs ended that diverged, by name of the measurement."""


def predict(problem: Problem, values: Values, *, jacobian: bool = False, progress: Progress | None = None) -> Predicted:
    """What the model says about all measurements.

    Args:
        problem: Measurements and unknowns.
        values: Of the unknowns, in their units.
        jacobian: Whether derivatives are wanted.
        progress: Called with the share that is finished (3D twin only).
    """
    if problem.model == "spatial":
        return _by_differences(problem, values, jacobian, progress)
    settings = problem.apply(values)
    raw, failures = _simulated(problem, settings, values)
    predicted = [seen(m, raw[i], problem.side(i, values)) for i, m in enumerate(problem.measurements)]
    found = _slopes(problem, settings, values, raw) if jacobian else None
    return Predicted(values=np.concatenate(predicted), jacobian=found, failures=failures)


def seen(measurement: Measurement, raw: Mapping[str, Any], side: Mapping[str, Any]) -> np.ndarray:
    """What a measurement would show of a run: the tracked point, the tracker's heading, the meter's power.

    Args:
        measurement: Says what was measured.
        raw: What the run gave, as `Raw`.
        side: Values of `SIDE` by name; what is missing is 0.
    """
    ahead, left = side.get("measured.offset_x", 0.0), side.get("measured.offset_y", 0.0)
    turned, more = side.get("measured.heading_offset", 0.0), side.get("measured.power_offset", 0.0)
    figures: list[Any] = []
    for name in measurement.figures:
        value: Any = raw[name]
        if name == "heading":
            value = value + turned
        elif name == "mean_power":
            value = value + more
        elif name == "x":
            value = value + ahead * np.cos(raw["heading"]) - left * np.sin(raw["heading"])
        elif name == "y":
            value = value + ahead * np.sin(raw["heading"]) + left * np.cos(raw["heading"])
        figures.append(value)
    parts = [np.array(figures)]
    for name in measurement.series:
        value = raw[f"{name} series"]
        if name == "heading":
            value = value + turned
        elif name == "center_of_mass" and (ahead != 0.0 or left != 0.0):
            c, s = np.cos(raw["heading series"]), np.sin(raw["heading series"])
            value = value + np.stack((ahead * c - left * s, ahead * s + left * c), axis=1)
        parts.append(np.ravel(value))
    return np.concatenate(parts)


def _starts(problem: Problem, values: Values) -> list[Start]:
    """Where every trial begins."""
    found: list[Start] = []
    for i, measurement in enumerate(problem.measurements):
        side, begin = problem.side(i, values), measurement.start
        for name in ("start.x", "start.y", "start.heading"):
            if name in side:
                begin = _moved(begin, name, float(side[name]))
        found.append(begin)
    return found


def _moved(start: Start, name: str, value: float) -> Start:
    """A start with one number added: identified starts are what is to be added to the stated ones."""
    x, y = start.center_of_mass
    if name == "start.heading":
        return Start(center_of_mass=(x, y), heading=start.heading + value)
    return Start(center_of_mass=(x + value, y) if name == "start.x" else (x, y + value), heading=start.heading)


def _by_duration(problem: Problem, members: Sequence[int]) -> dict[float, list[int]]:
    """Numbers in `members` of measurements of equal duration."""
    found: dict[float, list[int]] = {}
    for place, i in enumerate(members):
        found.setdefault(problem.measurements[i].duration, []).append(place)
    return found


def _runs(problem: Problem, settings: Sequence[Setting], starts: Sequence[Start], members: Sequence[int]) -> list[Run]:
    chosen = [settings[i] for i in members]
    return runs_of(
        [setting.robot for setting in chosen],
        [setting.gait for setting in chosen],
        [setting.environment for setting in chosen],
        [starts[i] for i in members],
        **problem.options,
    )


def _simulated(problem: Problem, settings: Sequence[Setting], values: Values) -> tuple[list[Raw], dict[str, str]]:
    """What every measurement's run gives."""
    starts = _starts(problem, values)
    everyone = range(len(settings))
    raw: list[Raw] = [{} for _ in everyone]
    failures: dict[str, str] = {}
    for duration, members in _by_duration(problem, everyone).items():
        runs = _runs(problem, settings, starts, members)
        weights = np.array([metrics.carried_weight(run.plant.robot, run.plant.environment) for run in runs])
        mine = [raw[i] for i in members]
        look = partial(_keep, [problem.measurements[i] for i in members], mine)
        found = collected(
            runs,
            weights,
            duration,
            SAMPLE_INTERVAL,
            problem.threads,
            None,
            look=look,
            with_joints=_needs_joints(problem, members),
        )
        for place, i in enumerate(members):
            raw[i] |= {name: found.figures[name][place] for name in UNITS}
            if not found.succeeded[place]:
                failures[problem.measurements[i].name] = found.status[place]
                raw[i] |= {name: np.full(np.shape(value), np.nan) for name, value in raw[i].items()}
    return raw, failures


def _slopes(problem: Problem, settings: Sequence[Setting], values: Values, raw: Sequence[Raw]) -> np.ndarray:
    """The Jacobian, pair by pair of a measurement and an unknown."""
    jacobian = np.zeros((problem.owner.size, len(problem.unknowns)))
    rows_of = [np.flatnonzero(problem.owner == i) for i in range(len(settings))]
    simulated: list[tuple[int, int]] = []
    for i, k in cast("list[tuple[int, int]]", np.argwhere(problem.moves).tolist()):
        name = problem.unknowns[k].parameter.name
        if name.startswith("measured."):
            side = problem.side(i, values.astype(complex) + 1j * STEP * (np.arange(values.size) == k))
            found = seen(problem.measurements[i], raw[i], side)
            jacobian[rows_of[i], k] = np.imag(found) / STEP
        else:
            simulated.append((i, k))
    starts = _starts(problem, values)
    every_run = _all_runs(problem, settings, starts)
    for duration, places in _by_duration(problem, [i for i, _ in simulated]).items():
        pairs = [simulated[place] for place in places]
        mine: list[Raw] = [{} for _ in pairs]
        found = slopes(
            [every_run[i] for i, _ in pairs],
            [_number(problem, settings[i], starts[i], i, k, values) for i, k in pairs],
            duration,
            sample_interval=SAMPLE_INTERVAL,
            threads=problem.threads,
            look=partial(_keep, [problem.measurements[i] for i, _ in pairs], mine),
            with_joints=_needs_joints(problem, [i for i, _ in pairs]),
        )
        for place, (i, k) in enumerate(pairs):
            for name in UNITS:
                mine[place][name] = found.value[name][place] + 1j * STEP * found.slope[name][place]
            predicted = seen(problem.measurements[i], mine[place], problem.side(i, values))
            well = np.imag(predicted) / STEP
            jacobian[rows_of[i], k] = well if found.succeeded[place] else np.nan
    return jacobian


def _all_runs(problem: Problem, settings: Sequence[Setting], starts: Sequence[Start]) -> list[Run]:
    """The run of every measurement; runs of equal robot and water share their plant."""
    return _runs(problem, settings, starts, range(len(settings)))


def _number(problem: Problem, setting: Setting, start: Start, i: int, k: int, values: Values) -> Number:
    """One unknown of one measurement, for `slopes`."""
    name, value = problem.unknowns[k].parameter.name, float(values[k])
    if name in SIDE:
        return Number(
            name=f"{name} of {problem.measurements[i].name}",
            trial=setting,
            value=value,
            change=lambda _: setting,
            start=lambda other: _moved(start, name, other - value),
        )
    return Number(name=name, trial=setting, value=value, change=partial(_changed, setting, name))


def _changed(setting: Setting, name: str, value: float) -> Any:
    return changed(*setting, {name: value})


def _needs_joints(problem: Problem, members: Sequence[int]) -> bool:
    return any(name.startswith("joint_") for i in members for name in problem.measurements[i].series)


def _keep(measurements: Sequence[Measurement], raw: Sequence[Raw], runs: Sequence[Run], block: Block) -> None:
    """Keep of a block's logs what the measurements of its runs have series of."""
    for lane, at in enumerate(block.index):
        measurement = measurements[int(at)]
        if measurement.time is None:
            continue
        lay = runs[lane].plant.layout
        joints = lay.n_bodies - 1
        first = {"joint_angle": rows.LOG_STATE, "joint_torque": rows.LOG_STATE + 3 * joints}
        wanted = dict.fromkeys(("heading", *measurement.series))
        for name in wanted:
            if name == "heading":
                values = block.log[:, rows.HEADING - rows.TIME, lane]
            elif name == "center_of_mass":
                values = block.center_of_mass[:, :, lane]
            else:
                values = block.log[:, first[name] + lay.tail_link : first[name] + joints, lane]
            raw[int(at)][f"{name} series"] = interpolated(block.time, values, measurement.time)


def interpolated(time: Float[np.ndarray, " n"], values: np.ndarray, moments: Float[np.ndarray, " m"]) -> np.ndarray:
    """Samples at other moments: the cubic through the four nearest ones, on an even grid of at least four samples.

    Args:
        time: Of the samples [s].
        values: The samples, time first; may be complex.
        moments: [s].
    """
    step = (time[-1] - time[0]) / (time.size - 1)
    place = (moments - time[0]) / step
    first = np.clip(np.floor(place).astype(int) - 1, 0, max(time.size - 4, 0))
    s = place - first
    n = min(4, time.size)
    result = 0.0
    for j in range(n):
        others = [k for k in range(n) if k != j]
        weight = np.prod([(s - k) / (j - k) for k in others], axis=0)
        result = result + weight.reshape(-1, *[1] * (values.ndim - 1)) * values[first + j]
    return np.asarray(result)


def _by_differences(problem: Problem, values: Values, jacobian: bool, progress: Progress | None) -> Predicted:
    """The 3D twin: trial by trial, and central differences."""
    total = 1 + 2 * len(problem.unknowns) * jacobian
    predicted, failures = _in_space(problem, values)
    columns: list[np.ndarray] = []
    for k, unknown in enumerate(problem.unknowns if jacobian else ()):
        step = DIFFERENCE * unknown.slope(float(values[k])) * unknown.size
        ends = np.clip(values[k] + np.array([-step, step]), unknown.lower, unknown.upper)
        moved = np.repeat(values[np.newaxis], 2, axis=0)
        moved[:, k] = ends
        behind, ahead = (_in_space(problem, at)[0] for at in moved)
        columns.append((ahead - behind) / (ends[1] - ends[0]))
        if progress is not None:
            progress((3 + 2 * k) / total)
    return Predicted(values=predicted, jacobian=np.stack(columns, axis=1) if jacobian else None, failures=failures)


def _in_space(problem: Problem, values: Values) -> tuple[np.ndarray, dict[str, str]]:
    starts, failures = _starts(problem, values), dict[str, str]()
    parts: list[np.ndarray] = []
    for i, setting in enumerate(problem.apply(values)):
        measurement = problem.measurements[i]
        trial = swim(
            *setting[:2],
            measurement.duration,
            environment=setting.environment,
            model="spatial",
            start=starts[i],
            sample_interval=SAMPLE_INTERVAL,
            **problem.options,
        )
        if trial.succeeded:
            parts.append(seen(measurement, _raw_of(trial, measurement), problem.side(i, values)))
        else:
            failures[measurement.name] = trial.status
            parts.append(np.full(int(np.sum(problem.owner == i)), np.nan))
    return np.concatenate(parts), failures


def _raw_of(trial: Trial, measurement: Measurement) -> Raw:
    """What a trial gave, in the plane."""
    end = trial.center_of_mass[-1]
    raw: Raw = {"x": end[0], "y": end[1], "heading": trial.heading[-1]}
    raw |= {name: getattr(trial, name) for name in measurement.figures if name not in raw}
    if measurement.time is not None:
        for name in dict.fromkeys(("heading", *measurement.series)):
            values = getattr(trial, name)
            values = values[:, :2] if name == "center_of_mass" else values
            raw[f"{name} series"] = interpolated(trial.time, values, measurement.time)
    return raw
