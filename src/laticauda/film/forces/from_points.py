"""`invert_points`: from tracked points to forces in one call; and points from a trial or in px."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from laticauda.film.chain import PointPlaces, fit_chain, places_at
from laticauda.film.forces.assumptions import Assumptions
from laticauda.film.forces.inverse import USUAL_DRAWS, FilmForces, find_forces
from laticauda.film.points import TrackedPoints
from laticauda.robot import Robot, Water, kinematics
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_instance, check_positive

PLACE_DEVIATION = 0.015
"""Standard deviation of places along the body that were guessed, by its length."""
LARGEST_MISFIT = 0.15
"""By how much the points may span more or less than the body, by its length."""
STRETCHED = 90.0
"""Percentile of the distance of two neighbors that is taken for that on the straight body."""


def invert_points(
    points: TrackedPoints,
    robot: Robot,
    along: Sequence[float] | Float[np.ndarray, " n_points"] | PointPlaces | None = None,
    *,
    water: Water | Assumptions | None = None,
    span: tuple[float, float] | None = None,
    body_deviation: float = 0.0,
    scale_deviation: float = 0.0,
    n_draws: int = USUAL_DRAWS,
    seed: int = 0,
    threads: int | None = None,
) -> FilmForces:
    """Find forces, power and efficiency from points that were tracked on a body.

    Args:
        points: Tracked points, in m.
        robot: What swims: a robot, or the body of an animal (`laticauda.film.chain.build_body`).
        along: Distance of every point from the tail end along the body [m], or its places; None: the points
            are in order from head to tail, the first at the nose, the last at the tail tip.
        water: The water, taken as known; or what is assumed of water and body; None: the water from tables
            for this body at this speed, with its intervals.
        span: Part of the film that is used [s].
        body_deviation: Relative standard deviation of the body's height and width [-].
        scale_deviation: Relative standard deviation of the film's scale [-].
        n_draws: Number of draws.
        seed: Seed of the draws.
        threads: Number of threads; None uses all cores.

    Returns:
        The figures, and everything that they were computed from.

    Raises:
        ValueError: If the points do not fit the body, or an argument is out of its range.
    """
    check_instance("points", points, TrackedPoints)
    check_instance("robot", robot, Robot)
    if along is None:
        places = guess_places(points, robot)
    elif isinstance(along, PointPlaces):
        places = along
    else:
        places = places_at(along)
    fit = fit_chain(points, robot, places, seed=seed)
    return find_forces(
        fit,
        water,
        span=span,
        body_deviation=body_deviation,
        scale_deviation=scale_deviation,
        n_draws=n_draws,
        seed=seed,
        threads=threads,
    )


def guess_places(points: TrackedPoints, robot: Robot) -> PointPlaces:
    """Return where points in order from head to tail probably sit: nose, tail tip, and between by their distances.

    Args:
        points: Tracked points, in m.
        robot: What swims.

    Raises:
        ValueError: If the points span much more or less than the body: in another unit, or in another order.
    """
    steps = np.linalg.norm(points.position[:, 1:] - points.position[:, :-1], axis=2)
    distances = np.nanpercentile(steps, STRETCHED, axis=0)
    reach = float(np.sum(distances))
    if not abs(reach / robot.reach - 1.0) < LARGEST_MISFIT:
        rule = (
            f"must span about {robot.reach:.3g} m, the length of `{robot.name}`, from head to tail"
        )
        raise BadArgument(
            "points", f"{rule}, got {reach:.3g} m; is the scale right, and the order?"
        )
    from_head = np.append(0.0, np.cumsum(distances)) * robot.reach / reach
    along = np.clip(robot.length - from_head, robot.length - robot.reach, robot.length)
    places = places_at(along)
    return replace(places, along_deviation=PLACE_DEVIATION * robot.length)


def scale_points(points: TrackedPoints, pixels_per_meter: float) -> TrackedPoints:
    """Return points in m from points in px, seen straight from above.

    Args:
        points: Points in px.
        pixels_per_meter: Scale of the film in the plane of motion [1/m].
    """
    scale = check_positive("pixels_per_meter", pixels_per_meter, "1/m")
    if points.unit != "px":
        raise BadArgument("pixels_per_meter", f"must be left out: the points are in {points.unit}")
    # In a picture, y points down.
    position = points.position / scale * np.array([1.0, -1.0])
    return replace(points, position=position, unit="m")


def points_of_trial(trial: Trial) -> TrackedPoints:
    """Return tail end, joints and head end of a trial as points, for one whose joints and path were measured.

    Args:
        trial: The trial.

    Raises:
        ValueError: If it lacks joint angles, heading or path.
    """
    missing = {"joint_angle", "heading", "center_of_mass"} & set(trial.not_measured)
    if missing:
        listed = " and ".join(sorted(missing))
        raise BadArgument("trial", f"must have path, heading and joint angles, but lacks {listed}")
    robot = trial.chain
    posture = kinematics.Posture(robot, trial.center_of_mass[:, :2], trial.link_angle)
    ends = posture.link_ends
    names = ("tail", *(f"joint_{i + 1}" for i in range(robot.n_joints)), "head")
    return TrackedPoints(
        time=trial.time,
        names=names,
        position=ends,
        likelihood=np.full(ends.shape[:2], np.nan),
        unit="m",
        source=f"trial of {robot.name}",
    )
