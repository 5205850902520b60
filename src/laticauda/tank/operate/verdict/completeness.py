"""Checks of the recording itself: did the modules answer, and was this computer on time?

A computer that is starved loses answers and sends references late. Joints, markers and clocks then
seem to be wrong although nothing is wrong with them. These checks are therefore judged first.
"""

import numpy as np
from jaxtyping import Float, Int

from laticauda.tank.operate.verdict.check import Measurement
from laticauda.tank.operate.verdict.recorded_run import Cycles, RecordedRun

LONE_MODULE_RATIO = 2.0
"""A module is named if it misses this many times more answers than any other one [-]."""


def measure_missing_answers(run: RecordedRun) -> Measurement | None:
    """Measure the share of a cycle's answers that did not come, for the module that misses most.

    Modules answer at every tick at which references are sent. Ticks that were left out because
    this computer was late are not counted here, but by `measure_time_late`.
    """
    if not len(run.cycles) or not run.joint_samples:
        return None
    reference_times = [reference.time for reference in run.references]
    n_expected = np.maximum(_count_by_cycle(run.cycles, reference_times), 1)
    n_modules = run.joint_samples[0].angle.size
    missing = np.empty((len(run.cycles), n_modules))
    for module in range(n_modules):
        answer_times = [
            sample.time for sample in run.joint_samples if np.isfinite(sample.angle[module])
        ]
        n_answers = _count_by_cycle(run.cycles, answer_times)
        missing[:, module] = np.maximum(1.0 - n_answers / n_expected, 0.0)
    return Measurement(
        times=run.cycles.ends, values=missing.max(axis=1), location=_lone_module(missing)
    )


def measure_time_late(run: RecordedRun) -> Measurement | None:
    """Measure the share of a cycle's time by which ticks of this computer began too late.

    Only ticks that were late by more than the time between two of them count: these are missed.
    """
    timing = run.log.timing
    if timing is None or not len(run.cycles):
        return None
    is_missed = timing.lateness > timing.interval
    time_late = _sum_by_cycle(
        run.cycles,
        times=timing.began[is_missed],
        values=timing.lateness[is_missed],
    )
    return Measurement(times=run.cycles.ends, values=time_late / run.cycles.period)


def _lone_module(missing: Float[np.ndarray, "n_cycles n_modules"]) -> str:
    """Return the module that misses answers while the others do not; "" if many miss some."""
    if missing.shape[1] < 2:
        return ""
    worst_of_each = missing.max(axis=0)
    second_worst, worst = np.sort(worst_of_each)[-2:]
    if worst <= LONE_MODULE_RATIO * second_worst:
        return ""
    return f"module {int(worst_of_each.argmax()) + 1}"


def _count_by_cycle(cycles: Cycles, times: list[float]) -> Int[np.ndarray, " n_cycles"]:
    """Return how many of these times [s] are in each cycle."""
    return np.bincount(_cycle_of(cycles, np.array(times)), minlength=len(cycles) + 2)[1:-1]


def _sum_by_cycle(
    cycles: Cycles, times: Float[np.ndarray, " n_values"], values: Float[np.ndarray, " n_values"]
) -> Float[np.ndarray, " n_cycles"]:
    """Return the sum of the values whose times [s] are in each cycle."""
    sums = np.bincount(_cycle_of(cycles, times), weights=values, minlength=len(cycles) + 2)
    return sums[1:-1].astype(float)  # without any value, they are integers


def _cycle_of(
    cycles: Cycles, times: Float[np.ndarray, " n_values"]
) -> Int[np.ndarray, " n_values"]:
    """Return the cycle of each time [s], from 1 on; 0: before the first; n + 1: after the last."""
    bounds = np.append(cycles.ends[0] - cycles.period, cycles.ends)
    return np.searchsorted(bounds, times, side="left")
