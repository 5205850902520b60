"""Candidate trials, and what each would say about the unknowns.

Besides swimming with the available sensors, a candidate may be a tow (the loads that hold the
straight robot at a constant velocity, along itself or at an angle) or a coast-down (the path of the
straight robot released at a speed). It is a `Measurement` whose measured numbers are not used; its
group gives its kind: swim, tow or coast-down.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.identify import model, tables
from laticauda.identify.measurements import LOADS, SERIES, Measurement, Tow
from laticauda.identify.problem import Problem, other_measurements, with_starts
from laticauda.models.simulate.runner import Progress, silent
from laticauda.robot import Environment, Robot, Water
from laticauda.values.checks import check_choice, check_instance, check_positive


class Sensor(NamedTuple):
    """What a trial may be measured by."""

    quantity: str
    """Figure or series that it measures."""
    sigma: float
    """Standard deviation of its noise, in the unit of the quantity."""


SENSORS = {
    "speed": Sensor("forward_velocity", 0.005),
    "power": Sensor("mean_power", 2.0),
    "path": Sensor("center_of_mass", 0.005),
    "heading": Sensor("heading", 0.01),
    "joint-angle": Sensor("joint_angle", 0.01),
    "joint-torque": Sensor("joint_torque", 0.05),
}
"""Sensors by name, with their usual noise."""
FORCE_SIGMA, FORCE_SHARE, MISALIGNMENT = 0.05, 0.02, math.radians(0.5)
"""Noise of the loads of a tow: of a force [N], as a fraction of it [-], and of the angle [rad]."""
STRAIGHT = lc.Gait(amplitude=0.0, frequency=1.0, phase_shift=0.5)
"""Gait without joint motion."""
INTERVAL = 0.5
"""Interval between the samples of a series that are used [s]."""


def swim_candidates(
    robot: Robot,
    gaits: Sequence[lc.Gait],
    environment: Environment,
    sensors: Mapping[str, float],
    *,
    duration: float = 30.0,
    interval: float = INTERVAL,
) -> list[Measurement]:
    """Return one candidate per gait.

    Args:
        robot: Robot that would swim.
        gaits: Gaits to command.
        environment: Environment to swim in.
        sensors: Standard deviation of the noise of each sensor, by name from `SENSORS`.
        duration: Duration of a trial [s].
        interval: Interval between the samples of a series that are used [s].
    """
    found: list[Measurement] = []
    for gait in gaits:
        scenario = lc.Scenario(robot=robot, motion=gait, environment=environment, duration=duration)
        name = f"swim, {gait.kind.replace('_', '-')} {tables.setting_of(gait)} deg{_fin(robot)}"
        found.append(_candidate("swim", name, scenario, sensors, interval))
    return found


def coast_down(
    robot: Robot,
    environment: Environment,
    speed: float,
    *,
    sigma: float = 0.005,
    duration: float = 5.0,
) -> Measurement:
    """Return a candidate with the straight robot released at a speed, its center of mass tracked ten times a second.

    Args:
        robot: Robot that coasts.
        environment: Environment to coast in.
        speed: Initial speed [m/s].
        sigma: Standard deviation of the noise of the path [m].
        duration: Duration of the trial [s].
    """
    start = lc.Start(velocity=check_positive("speed", speed, "m/s"))
    scenario = lc.Scenario(
        robot=robot, motion=STRAIGHT, environment=environment, start=start, duration=duration
    )
    return _candidate(
        "coast-down", f"coast-down from {speed:g} m/s{_fin(robot)}", scenario, {"path": sigma}, 0.1
    )


def from_tow(
    robot: Robot,
    environment: Environment,
    tow: Tow,
    loads: Mapping[str, float] | None = None,
    *,
    name: str = "",
    sigma: float = FORCE_SIGMA,
    share: float = FORCE_SHARE,
    misalignment: float = MISALIGNMENT,
) -> Measurement:
    """Return the loads of a tow as a measurement or as a candidate.

    Args:
        robot: Robot that is towed, straight.
        environment: Water in which it is towed; the effect of errors of the angle is derived from
            it.
        tow: Speed and angle of the tow.
        loads: Loads by name, from `LOADS`; None: those computed for the water, for a straight tow
            only the drag.
        name: Name in tables and messages; empty: composed from the kind of tow, with or without
            fin.
        sigma: Standard deviation of the noise of a force [N]; for the moment, multiplied by half
            the robot's length.
        share: Additional standard deviation as a fraction of the load, from speed and calibration
            [-].
        misalignment: Standard deviation of the angle [rad].

    Raises:
        ValueError: If an argument is out of its range.
    """
    check_instance("environment", environment, Water)
    scenario = lc.Scenario(robot=robot, motion=STRAIGHT, environment=environment, duration=1.0)
    seen = {one: load for one, load in tow.loads(scenario).items() if one == "drag" or tow.angle}
    ends = [
        replace(tow, angle=tow.angle + end).loads(scenario) for end in (-misalignment, misalignment)
    ]
    figures: dict[str, tuple[float, float]] = {}
    for one, load in (seen if loads is None else loads).items():
        arm = 0.5 * robot.length if one == "yaw_moment" else 1.0
        turned = 0.5 * (ends[1][one] - ends[0][one])
        figures[check_choice("loads", one, tuple(LOADS))] = (
            load,
            math.hypot(arm * sigma, share * load, turned),
        )
    how = f"oblique tow, {math.degrees(tow.angle):.3g} deg," if tow.angle else "straight tow"
    name = name or f"{how} at {tow.speed:g} m/s{_fin(robot)}"
    return Measurement(name=name, scenario=scenario, figures=figures, tow=tow, group="tow")


def rows_of(
    problem: Problem,
    candidates: Sequence[Measurement],
    values: Float[np.ndarray, " n_unknowns"],
    progress: Progress = silent,
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Predict each candidate's measured numbers and their derivatives with respect to the coordinates of the unknowns.

    Args:
        problem: Provides the unknowns.
        candidates: The trials.
        values: Values of the unknowns.
        progress: Called with the finished fraction.

    Returns:
        For each candidate, in standard deviations of the noise: numbers, and rows of the Jacobian.
            The columns of the
        unknowns are followed by those of its start, which is unknown as in a fit, with rows for the
        priors on it.

    Raises:
        ValueError: If a candidate cannot be simulated.
    """
    found: list[tuple[np.ndarray, np.ndarray]] = []
    for begin in range(0, len(candidates), _AT_ONCE):
        members = candidates[begin : begin + _AT_ONCE]
        part = with_starts(other_measurements(problem, members))
        every = np.concatenate([values, part.start[values.size :]])
        predicted = model.predict(part, every)
        for name, status in predicted.failures.items():
            raise ValueError(
                f"`candidates` must be trials that can be simulated, got `{name}`: {status}"
            )
        rows = np.nan_to_num(predicted.jacobian / part.sigma[:, np.newaxis] * part.slopes(every))
        numbers, priors = np.nan_to_num(predicted.values / part.sigma), part.prior_slopes(every)
        for place in range(len(members)):
            data = part.owner == place
            begins = values.size + np.flatnonzero(part.moves[place, values.size :])
            known = priors[np.any(priors[:, begins] != 0.0, axis=1)]
            columns = np.concatenate([np.arange(values.size), begins])
            rows_and_priors = np.concatenate([rows[data], known])[:, columns]
            found.append((np.concatenate([numbers[data], np.zeros(len(known))]), rows_and_priors))
        progress(len(found) / len(candidates))
    return found


_AT_ONCE = 64


def _candidate(
    kind: str, name: str, scenario: lc.Scenario, sensors: Mapping[str, float], interval: float
) -> Measurement:
    """Return a trial with figures and series whose measured numbers are not used."""
    robot, duration = scenario.robot, scenario.duration
    time = np.arange(1, round(duration / check_positive("interval", interval, "s")) + 1) * interval
    time = time[time <= duration * (1.0 + 1e-9)]
    figures: dict[str, tuple[float, float]] = {}
    series: dict[str, tuple[np.ndarray, float]] = {}
    shapes = {"center_of_mass": (time.size, 2), "heading": (time.size,)}
    for word, sigma in sensors.items():
        what = SENSORS[word].quantity
        if what not in SERIES:
            figures[what] = (0.0, sigma)
        else:
            series[what] = (np.zeros(shapes.get(what, (time.size, robot.n_links - 1))), sigma)
    measured: Any = {"figures": figures, "series": series, "time": time if series else None}
    return Measurement(name=name, scenario=scenario, group=kind, **measured)


def _fin(robot: Robot) -> str:
    return ", with fin" if robot.caudal_fin is not None else ""
