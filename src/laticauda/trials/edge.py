"""The trailing edge in the water: how steeply it meets the flow, and whether the law of its thrust holds there.

The law of the edge is that of small motions. Against a vortex lattice with large motions and a free
wake, its thrust was within some 25 % up to 40 deg of incidence and within some 50 % beyond, as long as the
flow stays attached. Where the flow separates, as it does on thin plates at such angles, there is
less thrust still. A slender edge sheds its momentum at any incidence.
"""

import math
from typing import NamedTuple

import numpy as np

from laticauda.robot import Ground, Posture, Robot, Water, fin_plate
from laticauda.scenarios import Scenario
from laticauda.trials.contents import Contents
from laticauda.values import BadArgument
from laticauda.water.fluid.edges import plate_functions

LARGEST_INCIDENCE = math.radians(20.0)
"""Incidence up to which the law of a broad edge is taken to hold [rad]."""
BROAD_LIFT_SHARE = 0.9
"""An edge is broad if it lifts less than this share of what a slender one of its height lifts [-]."""
LARGE_INCIDENCE = math.radians(40.0)
"""Incidence up to which the smaller of the two errors was seen [rad]."""
ERROR_TO_LARGE_INCIDENCE = 0.25
"""Error of the thrust up to there [-]."""
ERROR_BEYOND = 0.5
"""Error of the thrust beyond [-]."""
ERROR_OF_SLENDER_LAW = (
    (0.08, 0.03),
    (0.24, 0.09),
    (0.5, 0.19),
    (1.0, 0.40),
    (2.0, 0.83),
    (3.0, 1.32),
    (5.56, 2.52),
    (8.0, 3.70),
)
"""Error of the thrust by `elongated`, the law of slender plates, by height over length: the lattice's mean."""
ERROR_WITH_PLATE_MASS = (
    (0.08, 0.02),
    (0.24, 0.05),
    (0.5, 0.12),
    (1.0, 0.23),
    (2.0, 0.33),
    (3.0, 0.39),
    (5.56, 0.45),
    (8.0, 0.48),
)
"""The same if strips and edge have the added mass of a plate; either way [-]."""
SHARE_OF_START = 1.0 / 3.0
"""Share of the run that is left out: it begins at rest, where every edge is across the flow [-]."""
SHARE_OF_FASTEST = 0.5
"""Moments count at which the edge moves across at least at this share of its largest speed [-].

At rest, an incidence means nothing.
"""


def edge_incidence(trial: Contents) -> float:
    """Compute the largest incidence of the trailing edge, the angle between the flow and its link or fin [rad].

    It is atan(|w| / u) with u the speed of the edge through the water along its own plate and w that
    across, for moments after the first third of the run at which w is at least half of its largest
    value. Velocities of the edge relative to the center of mass are differences of samples. Raises
    a ValueError on ground, or if the run has fewer than three samples.
    """
    if isinstance(trial.environment, Ground):
        raise ValueError("The environment must be water for an incidence; on ground there is none.")
    trial.need("an incidence", "link_angle")
    if trial.time.size < 3:
        rule = "must have at least 3 samples for an incidence"
        raise BadArgument("time", f"{rule}, got {trial.time.size}")
    velocity = _edge_velocity(trial, trial.environment)
    duration = np.ptp(trial.time)
    start_ends_at = trial.time[0] + SHARE_OF_START * duration
    is_late = trial.time >= start_ends_at
    across = np.abs(velocity.across[is_late])
    along = velocity.along[is_late]
    fastest = np.max(across)
    is_fast = across >= SHARE_OF_FASTEST * fastest
    incidence = np.arctan2(across, along)
    return float(np.max(incidence[is_fast]))


class _EdgeVelocity(NamedTuple):
    """Velocity of a trailing edge through the water, at every sample."""

    along: np.ndarray
    """u, forward along its plate [m/s]."""
    across: np.ndarray
    """w, across its plate to the left [m/s]."""


def _edge_velocity(trial: Contents, water: Water) -> _EdgeVelocity:
    center = trial.center_of_mass[:, :2]
    posture = Posture(trial.chain, center, trial.link_angle, fin_angle=trial.fin_angle)
    line = posture.link_ends
    if trial.chain.caudal_fin is not None:
        line = posture.fin_line
    edge = line[:, 0]
    forward = line[:, 1] - edge
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    of_water = water.velocity(edge, trial.time)
    offset = edge - center
    relative_to_center = np.gradient(offset, trial.time, axis=0, edge_order=2)
    of_center = trial.center_of_mass_velocity[:, :2]
    velocity = of_center + relative_to_center - of_water
    left = np.column_stack((-forward[:, 1], forward[:, 0]))
    along = np.sum(velocity * forward, axis=1)
    across = np.sum(velocity * left, axis=1)
    return _EdgeVelocity(along=along, across=across)


def edge_aspect(robot: Robot) -> float:
    """Return height over length of the plate that ends in the trailing edge: the fin, or without one the body [-].

    Args:
        robot: The robot.
    """
    fin = robot.caudal_fin
    if fin is None:
        return 2.0 * robot.modules[0].section.half_height / robot.length
    if fin.silhouette is not None:
        return fin.height**2 / fin.area
    opening_length = 0.0
    if fin.opening == "open":
        opening_length = fin.opening_length
    return fin.height / (fin.length - opening_length)


class ThrustError(NamedTuple):
    """Error of the thrust of an edge outside its law, simulated / true - 1."""

    lowest: float
    """Lower end [-]."""
    highest: float
    """Upper end [-]."""
    reason: str
    """Why it is outside its law, in words."""


def thrust_error(trial: Contents) -> ThrustError | None:
    """Return the error of a simulated edge's thrust; None if the edge is within its law, or slender.

    Args:
        trial: Any trial, including a failed one.
    """
    water = trial.environment
    is_simulated = isinstance(trial.scenario, Scenario) and trial.succeeded
    if not is_simulated or isinstance(water, Ground) or water.trailing_edge == "none":
        return None
    aspect = edge_aspect(trial.chain)
    plate = fin_plate(trial.chain)
    if plate is None:
        plate = plate_functions(aspect)
    lift_share = plate.lift
    if lift_share >= BROAD_LIFT_SHARE:
        return None
    if water.trailing_edge == "elongated":
        return _error_of_slender_law(aspect, has_plate_mass=water.plate_added_mass is not None)
    try:
        incidence = edge_incidence(trial)
    except ValueError:
        return None
    if incidence <= LARGEST_INCIDENCE:
        return None
    error = ERROR_BEYOND
    if incidence <= LARGE_INCIDENCE:
        error = ERROR_TO_LARGE_INCIDENCE
    angle, limit = math.degrees(incidence), math.degrees(LARGEST_INCIDENCE)
    reason = f"the flow meets the broad fin at up to {angle:.0f} deg, and the law holds to about {limit:.0f}"
    return ThrustError(-error, error, reason)


def _error_of_slender_law(aspect: float, *, has_plate_mass: bool) -> ThrustError:
    reason = f"that law is for slender fins, and this one is {aspect:.3g} times as high as long"
    if has_plate_mass:
        aspects, errors = zip(*ERROR_WITH_PLATE_MASS, strict=True)
        error = float(np.interp(aspect, aspects, errors))
        return ThrustError(-error, error, reason)
    aspects, errors = zip(*ERROR_OF_SLENDER_LAW, strict=True)
    return ThrustError(0.0, float(np.interp(aspect, aspects, errors)), reason)


def describe_edge(trial: Contents) -> str:
    """Return a sentence if the thrust of a run's trailing edge lies outside its law; "" if it does not.

    Args:
        trial: Any trial, including a failed one.
    """
    error = thrust_error(trial)
    if error is None:
        return ""
    amount = f"may be wrong by {error.highest:.0%}, and is too high by more if the flow separates"
    if error.lowest == 0.0:
        amount = f"may be {1.0 + error.highest:.2g} times too high"
    return f"The thrust of the edge is outside its law and {amount}: {error.reason}."
