"""What the sensors told during a mission, for pictures of it: pings of the sonar, and when which sensor failed."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.missions.pings import find_new_rows, read_distances
from laticauda.missions.running import MissionResult
from laticauda.robot import kinematics
from laticauda.scenarios import Scenario
from laticauda.sensing import Sensor, Sonar
from laticauda.trials import Trial


class Ping(NamedTuple):
    """A ping of the sonar."""

    time: float
    """When [s]."""
    head: Float[np.ndarray, " 2"]
    """Where the tip of the head was [m]."""
    echoes: Float[np.ndarray, "n_echoes 2"]
    """Where the echoes came from, by the distances that were told [m]."""


def find_pings(result: MissionResult) -> list[Ping]:
    """Return the pings of the first sonar that told something new; none if there is no sonar.

    Args:
        result: The mission.
    """
    trial = result.trial
    sonars = [sensor for sensor in _sensors_of(trial) if isinstance(sensor, Sonar)]
    if not sonars:
        return []
    sonar = sonars[0]
    bearings = np.array(sonar.beams)
    distances = read_distances(trial, sonar)
    robot = trial.robot.planar()
    posture = kinematics.Posture(robot, trial.center_of_mass[:, :2], trial.link_angle)
    pings: list[Ping] = []
    for sample in find_new_rows(distances):
        is_echo = np.isfinite(distances[sample])
        head = posture.link_ends[sample, -1]
        directions = trial.link_angle[sample, -1] + bearings[is_echo]
        rays = np.stack((np.cos(directions), np.sin(directions)), axis=-1)
        echoes = head + distances[sample, is_echo, np.newaxis] * rays
        pings.append(Ping(time=float(trial.time[sample]), head=head, echoes=echoes))
    return pings


class Failure(NamedTuple):
    """A time during which a sensor fails."""

    description: str
    """Which sensor, and how."""
    begin: float
    """From when on [s]."""
    end: float
    """Until when [s]."""

    def lasts_at(self, time: float) -> bool:
        """Return whether it lasts at some time.

        Args:
            time: The time [s].
        """
        return self.begin <= time < self.end


def list_failures(result: MissionResult) -> list[Failure]:
    """Return when which sensor failed.

    Args:
        result: The mission.
    """
    failures: list[Failure] = []
    for sensor in _sensors_of(result.trial):
        name = sensor.name.replace("_", " ")
        for fault in sensor.faults:
            failures.append(Failure(f"{name} {fault.kind}", fault.begin, fault.end))
    return failures


def _sensors_of(trial: Trial) -> tuple[Sensor, ...]:
    """Return the sensors of the robot."""
    scenario = trial.scenario
    assert isinstance(scenario, Scenario)
    return scenario.model.sensors
