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
        times=run.cycles.ends,
        values=missing.max(axis=1),
        location=_lone_module(missing.max(axis=0)),
    )


def measure_missing_in_run(run: RecordedRun) -> Measurement | None:
    """Measure the share of the whole run's answers that did not come, for the module that misses most.

    Unlike `measure_missing_answers`, it also sees what lies outside of whole cycles: these end with
    the last answer, so a run that nobody heard has none.
    """
    if not run.references:
        return None
    n_expected = len(run.references)
    n_answers = np.array([times.size for times in _answer_times_by_module(run)])
    missing = np.maximum(1.0 - n_answers / n_expected, 0.0)
    return Measurement(
        times=np.array([run.references[-1].time]),
        values=np.array([missing.max()]),
        location=_lone_module(missing),
    )


def measure_longest_silence(run: RecordedRun) -> Measurement | None:
    """Measure the longest time without an answer of a module, while references were sent.

    It counts from the beginning of the run to the last reference, whoever is to blame: a module, the
    bus, or a computer that stood still.
    """
    if not run.references:
        return None
    first_sent_at = run.references[0].time
    last_sent_at = run.references[-1].time
    ends: list[np.ndarray] = []
    silences: list[np.ndarray] = []
    for answer_times in _answer_times_by_module(run):
        heard_at = np.concatenate(([first_sent_at], answer_times, [last_sent_at]))
        ends.append(heard_at[1:])
        silences.append(np.diff(heard_at))
    order = np.argsort(np.concatenate(ends), kind="stable")
    longest_of_each = np.array([module_silences.max() for module_silences in silences])
    return Measurement(
        times=np.concatenate(ends)[order],
        values=np.concatenate(silences)[order],
        location=_lone_module(longest_of_each),
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


def _answer_times_by_module(run: RecordedRun) -> list[Float[np.ndarray, " n_answers"]]:
    """Return the times of every module's answers while references were sent [s]."""
    first_sent_at = run.references[0].time
    last_sent_at = run.references[-1].time
    samples = [
        sample for sample in run.joint_samples if first_sent_at <= sample.time <= last_sent_at
    ]
    times = np.array([sample.time for sample in samples])
    n_modules = run.references[0].angle.size
    angles = np.array([sample.angle for sample in samples]).reshape(len(samples), n_modules)
    return [times[np.isfinite(angles[:, module])] for module in range(n_modules)]


def _lone_module(worst_of_each: Float[np.ndarray, " n_modules"]) -> str:
    """Return the module that misses answers while the others do not; "" if many miss some."""
    if worst_of_each.size < 2:
        return ""
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
