"""`invert_points`: from tracked points to forces in one call; and points from a trial or in px."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float

from laticauda.film.chain import PointPlaces, fit_chain, places_at
from laticauda.film.forces.arguments import check_force_arguments
from laticauda.film.forces.assumptions import Assumptions
from laticauda.film.forces.inverse import USUAL_DRAWS, USUAL_SWIMS, FilmForces, find_forces
from laticauda.film.forces.progress import SHARE_OF_FIT, ignore_progress, part_of_progress
from laticauda.film.forces.stretch import measure_stretch
from laticauda.film.points import TrackedPoints
from laticauda.robot import Robot, Water, kinematics
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_instance, check_positive

PLACE_DEVIATION = 0.015
"""Standard deviation of places along the body that were guessed, by its length."""
LARGEST_MISFIT = 0.15
"""By how much the points may span more or less than the body, by its length."""
FEWEST_FRAMES = 3
"""Frames in which a point must have been seen to say anything of a motion."""
SMALLEST_SHARE = 0.05
"""The same as a share of the frames, for a point whose place on the body is not given."""
SMALLEST_STRETCH = 0.02
"""Misfit of lengths in the film and on the body that noise may cause, and that widens no interval."""
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
    on_progress: Callable[[float], object] | None = None,
) -> FilmForces:
    """Find forces, power and efficiency from points that were tracked on a body.

    A point that was hardly ever seen is left out, with a note. If lengths in the film and on the body
    disagree, scale and body are taken to be as uncertain as that.

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
        on_progress: Called with the share of the work that is done.

    Returns:
        The figures, and everything that they were computed from.

    Raises:
        ValueError: If the points do not fit the body, or an argument is out of its range.
    """
    check_instance("points", points, TrackedPoints)
    check_instance("robot", robot, Robot)
    check_force_arguments(
        time=points.time,
        water=water,
        span=span,
        body_deviation=body_deviation,
        scale_deviation=scale_deviation,
        n_draws=n_draws,
        n_swims=USUAL_SWIMS,
        seed=seed,
        threads=threads,
    )
    points, places = _place_points(points, robot, along)
    report = on_progress or ignore_progress
    fit = fit_chain(
        points, robot, places, seed=seed, on_progress=part_of_progress(report, 0.0, SHARE_OF_FIT)
    )
    mismatch = abs(measure_stretch(fit) - 1.0)
    if mismatch > SMALLEST_STRETCH:
        scale_deviation = min(math.hypot(scale_deviation, mismatch), 1.0)
        body_deviation = min(math.hypot(body_deviation, mismatch), 1.0)
    return find_forces(
        fit,
        water,
        span=span,
        body_deviation=body_deviation,
        scale_deviation=scale_deviation,
        n_draws=n_draws,
        seed=seed,
        threads=threads,
        on_progress=part_of_progress(report, SHARE_OF_FIT, 1.0),
    )


def _place_points(
    points: TrackedPoints,
    robot: Robot,
    along: Sequence[float] | Float[np.ndarray, " n_points"] | PointPlaces | None,
) -> tuple[TrackedPoints, PointPlaces]:
    """Return the points that were seen often enough, and where they sit."""
    n_seen = np.count_nonzero(points.is_seen, axis=0)
    if along is None:
        is_used = n_seen >= max(FEWEST_FRAMES, math.ceil(SMALLEST_SHARE * points.n_frames))
        used = _leave_out(points, is_used)
        return used, guess_places(used, robot)
    places = along
    if not isinstance(places, PointPlaces):
        places = places_at(places)
    is_used = n_seen >= FEWEST_FRAMES
    if places.along.size != points.n_points:
        return points, places  # the fit refuses them
    used = _leave_out(points, is_used)
    return used, replace(places, along=places.along[is_used], left=places.left[is_used])


def _leave_out(points: TrackedPoints, is_used: Bool[np.ndarray, " n_points"]) -> TrackedPoints:
    """Return the points without those that are not used, and a note of them."""
    if is_used.all():
        return points
    names = [name for name, used in zip(points.names, is_used, strict=True) if used]
    if len(names) < 2:
        rule = f"must have two points at least that were seen in {FEWEST_FRAMES} frames"
        raise BadArgument("points", f"{rule}, got {len(names)}")
    left_out = ", ".join(name for name in points.names if name not in names)
    note = f"Hardly ever seen, and left out: {left_out}."
    return points.only(tuple(names)).with_notes(note)


def guess_places(points: TrackedPoints, robot: Robot) -> PointPlaces:
    """Return where points in order from head to tail probably sit: nose, tail tip, and between by their distances.

    Args:
        points: Tracked points, in m.
        robot: What swims.

    Raises:
        ValueError: If the points span much more or less than the body: in another unit, or in another order.
    """
    if points.n_points < 2:
        raise BadArgument(
            "points",
            "must be two at least: a single one, such as a centroid, has a path, but no motion of the body",
        )
    steps = np.linalg.norm(points.position[:, 1:] - points.position[:, :-1], axis=2)
    is_known = np.isfinite(steps)
    for i in np.flatnonzero(~is_known.any(axis=0)):
        pair = f"`{points.names[i]}` and `{points.names[i + 1]}`"
        raise BadArgument(
            "points", f"must show neighbors in one frame: {pair} never are; leave one out"
        )
    distances = np.nanpercentile(steps, STRETCHED, axis=0)
    reach = float(np.sum(distances))
    if not abs(reach / robot.reach - 1.0) < LARGEST_MISFIT:
        rule = f"must span about {robot.reach:.3g} m, the length of `{robot.name}`, from nose to tail tip"
        raise BadArgument(
            "points",
            f"{rule}, got {reach:.3g} m; is the scale right, and the order? If they do not reach from nose to "
            "tail tip, say how far from the tail end each sits (--along)",
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
