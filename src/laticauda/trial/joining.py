"""Two runs in a row as one trial: a run, and the one that went on from its final state."""

from __future__ import annotations

import dataclasses

import numpy as np

from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.scenarios import Experiment, Scenario
from laticauda.series import concatenated
from laticauda.trial.trial import Trial

_TOLERANCE = 1e-9  # of position [m] and angles [rad] at the joint: a restart continues the very state
_CONTINUED = ("center_of_mass", "center_of_mass_velocity", "heading", "link_angle", "joint_angle", "joint_rate")


def joined(first: Trial, second: Trial) -> Trial:
    """One trial of two: `second` was restarted from the final state of `first`.

    The sample at which they meet is in both and kept once. If the second run counted its time or its work from zero,
    they are counted on. Settings and gait are the first's, how it ended and the final state are the second's.

    Args:
        first: A run that reached its end.
        second: The run that went on from there.

    Raises:
        ValueError: If they differ in robot, gait, environment or what they log, or the second does not begin where the
            first ends.
    """
    _check_belong(first, second)
    series = vars(concatenated((first, second.at(slice(1, None)))))
    # At the joint a signal is what the second run decided there, as at every other control instant.
    signals = {name: np.concatenate((one[:-1], second.signals[name])) for name, one in first.signals.items()}
    counted = {"time": _counted_on(first.time, second.time), "work": _counted_on(first.work, second.work)}
    if first.electrical_work is not None and second.electrical_work is not None:
        counted["electrical_work"] = _counted_on(first.electrical_work, second.electrical_work)
    return dataclasses.replace(
        first,
        **{**series, **counted, "signals": signals},
        scenario=_scenario(first.scenario, second.scenario),
        status=second.status,
        succeeded=second.succeeded,
        state=second.state,
    )


def _scenario(first: Scenario | Experiment, second: Scenario | Experiment) -> Scenario | Experiment:
    """That of the run that was never cut; a controller began anew at the cut, and no scenario says so."""
    if isinstance(first, Scenario) and isinstance(second, Scenario) and isinstance(first.motion, Gait):
        return dataclasses.replace(first, duration=first.duration + second.duration)
    return Experiment(robot=first.robot, gait=first.gait, environment=first.environment, model=first.model)


def _check_belong(first: Trial, second: Trial) -> None:
    if not first.succeeded:
        raise ValueError(f"`first` must have reached its end, got a failed run: {first.status}")
    for name in ("robot", "gait", "environment"):
        if getattr(first, name) != getattr(second, name):
            raise BadArgument("second", f"must have the same `{name}` as `first`")
    if _logged(first) != _logged(second):
        raise BadArgument("second", "must log the same as `first`: electrical work, link forces, signals, or not")
    for name in _CONTINUED:
        gap = np.max(np.abs(getattr(second, name)[0] - getattr(first, name)[-1]), initial=0.0)
        if gap > _TOLERANCE:
            raise BadArgument("second", f"must begin where `first` ends, but `{name}` jumps by {gap:.3g}")


def _logged(trial: Trial) -> tuple[bool, set[str], set[str]]:
    return trial.electrical_work is not None, set(trial.link_force or {}), set(trial.signals)


def _counted_on(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """`second` behind `first`, shifted only if it starts elsewhere: a shift by rounding would change its last bits."""
    shift = first[-1] - second[0]
    return np.concatenate((first, second[1:] + shift if np.any(shift) else second[1:]))
