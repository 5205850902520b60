"""What came of a run, by what is true of it: how near the body came to places, and what was seen of a net."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.missions.pings import find_new_rows, read_distances
from laticauda.robot import kinematics
from laticauda.scenarios import Scenario
from laticauda.sensing import Dock, Net, Place, Sonar, surroundings_of
from laticauda.trials import Trial

POINTS_PER_PANEL = 8
"""Points of a panel of which it is asked whether they were seen."""
LARGEST_INCIDENCE = math.radians(60.0)
"""Largest angle between a ray and the net's normal at which a point counts as seen [rad]."""


def measure_clearance(trial: Trial) -> float:
    """Return how near the surface of the body came to places, docks left out; negative: it went through [m].

    Args:
        trial: The run.
    """
    places = tuple(
        place for place in _scenario_of(trial).model.places if not isinstance(place, Dock)
    )
    if not places:
        return math.inf
    posture = _posture_of(trial)
    lines = np.concatenate((posture.link_ends, posture.link_centers), axis=1)
    points = lines.reshape(-1, 2)
    depth = np.zeros((len(points), 1))
    distances = surroundings_of(places).distances(np.concatenate((points, depth), axis=1))
    half_width = max(module.section.half_width for module in posture.robot.modules)
    return float(np.min(distances)) - half_width


def measure_share_seen(trial: Trial, net: Net, sonar: Sonar) -> float:
    """Return the share of a net's circumference that the sonar saw, within its range and 60 deg of incidence.

    Only where the robot was when the sonar told something new counts: a silent or frozen one sees nothing.

    Args:
        trial: The run.
        net: The net.
        sonar: The sonar.
    """
    marks = _marks_on(net)
    tips = _posture_of(trial).link_ends[:, -1]
    directions = trial.link_angle[:, -1].tolist()
    is_seen = np.zeros(len(marks.points), dtype=bool)
    for sample in find_new_rows(read_distances(trial, sonar)):
        is_seen |= _sees(tips[sample], directions[sample], marks, sonar)
    return float(np.mean(is_seen))


class _Marks(NamedTuple):
    """Points on a net of which it is asked whether they were seen."""

    points: Float[np.ndarray, "n 2"]
    """The points [m]."""
    normals: Float[np.ndarray, "n 2"]
    """Outward normals of the net there [-]."""


def _sees(
    head: Float[np.ndarray, " 2"], heading: float, marks: _Marks, sonar: Sonar
) -> Bool[np.ndarray, " n"]:
    """Return which marks the sonar sees from one pose of the head."""
    to_points = marks.points - head
    distance = np.linalg.norm(to_points, axis=1)
    bearing = np.arctan2(to_points[:, 1], to_points[:, 0]) - heading
    bearing = np.angle(np.exp(1j * bearing))
    rightmost = min(sonar.beams) - 0.5 * sonar.beam_width
    leftmost = max(sonar.beams) + 0.5 * sonar.beam_width
    is_in_fan = (rightmost <= bearing) & (bearing <= leftmost)
    is_in_range = distance <= sonar.largest_range
    cosine_of_incidence = -np.sum(to_points * marks.normals, axis=1) / distance
    is_faced = cosine_of_incidence >= math.cos(LARGEST_INCIDENCE)
    return is_in_fan & is_in_range & is_faced


def _marks_on(net: Net) -> _Marks:
    """Return marks along a net, equally many on every panel."""
    begins = np.array(net.corners)
    spans = np.roll(begins, -1, axis=0) - begins
    lengths = np.linalg.norm(spans, axis=1, keepdims=True)
    right_of_spans = np.stack((spans[:, 1], -spans[:, 0]), axis=1)
    points: list[np.ndarray] = []
    for mark in range(POINTS_PER_PANEL):
        share = (mark + 0.5) / POINTS_PER_PANEL
        points.append(begins + share * spans)
    # The corners go round counter-clockwise: outward is to the right of the way.
    outward = right_of_spans / lengths
    return _Marks(
        points=np.concatenate(points),
        normals=np.tile(outward, (POINTS_PER_PANEL, 1)),
    )


def _posture_of(trial: Trial) -> kinematics.Posture:
    """Return the body in plan at every sample."""
    robot = trial.robot.planar()
    return kinematics.Posture(robot, trial.center_of_mass[:, :2], trial.link_angle)


def find_dock(places: tuple[Place, ...]) -> Dock | None:
    """Return the first dock; None if there is none.

    Args:
        places: The places.
    """
    return next((place for place in places if isinstance(place, Dock)), None)


def find_net(places: tuple[Place, ...]) -> Net | None:
    """Return the first net; None if there is none.

    Args:
        places: The places.
    """
    return next((place for place in places if isinstance(place, Net)), None)


def _scenario_of(trial: Trial) -> Scenario:
    """Return what was run."""
    scenario = trial.scenario
    if not isinstance(scenario, Scenario):
        raise ValueError("A mission's trial must be that of a scenario.")
    return scenario
