"""Candidate trials of a design: swimming with the available sensors, and coast-downs.

A candidate is a `Measurement` whose measured numbers are not used. Its group is its kind, swim, tow
or coast-down, for tables. In a coast-down, the path of the straight robot released at a speed is tracked.
Candidate tows are made by `laticauda.identify.conversion.from_tow`.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

import laticauda as lc
from laticauda.identify.conversion import STRAIGHT, fin_suffix
from laticauda.identify.measurements import Measurement
from laticauda.identify.series import SERIES, SERIES_KINDS
from laticauda.identify.tables import setting_of
from laticauda.robot import Environment, Robot
from laticauda.values import check_positive, renamed_names


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
INTERVAL = 0.5
"""Interval between the samples of a series that are used [s]."""
_COAST_DOWN_INTERVAL = 0.1
"""The same for a coast-down, which is over soon [s]."""
_ROUNDING = 1e-9
"""By how much the last sample may exceed the duration [-]."""

__getattr__ = renamed_names(
    __name__, {"swims": "swim_candidates", "from_tow": "laticauda.identify.conversion:from_tow"}
)


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
    candidates: list[Measurement] = []
    for gait in gaits:
        gait_kind = gait.kind.replace("_", "-")
        candidate = _candidate(
            kind="swim",
            name=f"swim, {gait_kind} {setting_of(gait)} deg{fin_suffix(robot)}",
            scenario=lc.Scenario(
                robot=robot, motion=gait, environment=environment, duration=duration
            ),
            sensors=sensors,
            interval=interval,
        )
        candidates.append(candidate)
    return candidates


def coast_down(
    robot: Robot,
    environment: Environment,
    speed: float,
    *,
    sigma: float = 0.005,
    duration: float = 5.0,
) -> Measurement:
    """Return a candidate with the straight robot released at a speed.

    Its center of mass is tracked ten times a second.

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
        kind="coast-down",
        name=f"coast-down from {speed:g} m/s{fin_suffix(robot)}",
        scenario=scenario,
        sensors={"path": sigma},
        interval=_COAST_DOWN_INTERVAL,
    )


def _candidate(
    *,
    kind: str,
    name: str,
    scenario: lc.Scenario,
    sensors: Mapping[str, float],
    interval: float,
) -> Measurement:
    """Return a trial with figures and series whose measured numbers are not used."""
    check_positive("interval", interval, "s")
    time = np.arange(1, round(scenario.duration / interval) + 1) * interval
    time = time[time <= scenario.duration * (1.0 + _ROUNDING)]
    figures: dict[str, tuple[float, float]] = {}
    series: dict[str, tuple[np.ndarray, float]] = {}
    for sensor, sigma in sensors.items():
        measured_name = SENSORS[sensor].quantity
        if measured_name in SERIES:
            sample_shape = _sample_shape(measured_name, scenario.robot)
            series[measured_name] = (np.zeros((time.size, *sample_shape)), sigma)
        else:
            figures[measured_name] = (0.0, sigma)
    return Measurement(
        name=name,
        scenario=scenario,
        group=kind,
        figures=figures,
        series=series,
        time=time if series else None,
    )


def _sample_shape(series_name: str, robot: Robot) -> tuple[int, ...]:
    """Return the shape of one sample of a series of this robot."""
    n_joints = robot.n_links - 1
    shape = SERIES_KINDS[series_name].sample_shape
    return tuple(n_joints if size is None else size for size in shape)
