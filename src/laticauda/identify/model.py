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
from laticauda.identify.problem import Problem
from laticauda.identify.seeing import SAMPLE_INTERVAL, Raw, Values, interpolated, moved_start, seen, starts_of
from laticauda.identify.settling import with_tied
from laticauda.identify.twin import by_differences
from laticauda.identify.unknowns import SIDE
from laticauda.interfaces import Start
from laticauda.planar import rows
from laticauda.planar.batch import STEP, Block, Run
from laticauda.scenarios import Scenario
from laticauda.simulate.derivatives import Number, slopes
from laticauda.simulate.many import batch_of, collected, runs_of
from laticauda.simulate.numbers import changed
from laticauda.simulate.runner import Progress
from laticauda.simulate.sensitivities import UNITS
from laticauda.trial import metrics


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
        found, slope, ends = by_differences(problem, values, jacobian, progress)
        return Predicted(values=found, jacobian=slope, failures=ends)
    settings = problem.apply(values)
    raw, failures = _simulated(problem, settings, values)
    predicted = [seen(m, raw[i], problem.side(i, values)) for i, m in enumerate(problem.measurements)]
    found = _slopes(problem, settings, values, raw) if jacobian else None
    return Predicted(values=np.concatenate(predicted), jacobian=found, failures=failures)


def _by_duration(problem: Problem, members: Sequence[int]) -> dict[float, list[int]]:
    """Numbers in `members` of measurements of equal duration."""
    found: dict[float, list[int]] = {}
    for place, i in enumerate(members):
        found.setdefault(problem.measurements[i].duration, []).append(place)
    return found


def _runs(problem: Problem, settings: Sequence[Scenario], starts: Sequence[Start], members: Sequence[int]) -> list[Run]:
    chosen = [settings[i] for i in members]
    scenarios = batch_of(
        [setting.robot for setting in chosen],
        [setting.gait for setting in chosen],
        [setting.environment for setting in chosen],
        [starts[i] for i in members],
        **problem.options,
    )
    return runs_of(scenarios)


def _simulated(problem: Problem, settings: Sequence[Scenario], values: Values) -> tuple[list[Raw], dict[str, str]]:
    """What every measurement's run gives."""
    starts = starts_of(problem, values)
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


def _slopes(problem: Problem, settings: Sequence[Scenario], values: Values, raw: Sequence[Raw]) -> np.ndarray:
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
    starts = starts_of(problem, values)
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


def _all_runs(problem: Problem, settings: Sequence[Scenario], starts: Sequence[Start]) -> list[Run]:
    """The run of every measurement; runs of equal robot and water share their plant."""
    return _runs(problem, settings, starts, range(len(settings)))


def _number(problem: Problem, setting: Scenario, start: Start, i: int, k: int, values: Values) -> Number:
    """One unknown of one measurement, for `slopes`."""
    name, value = problem.unknowns[k].parameter.name, float(values[k])
    if name in SIDE:
        return Number(
            name=f"{name} of {problem.measurements[i].name}",
            scenario=setting,
            value=value,
            change=lambda _: setting,
            start=lambda other: moved_start(start, name, other - value),
        )
    return Number(
        name=name, scenario=setting, value=value, change=partial(_changed, setting, name, problem.unknowns[k].tied)
    )


def _changed(setting: Scenario, name: str, tied: Mapping[str, float], value: float) -> Any:
    # Where the search has come to, what is tied is in proportion already.
    return changed(setting, with_tied(setting, name, value, tied))


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
