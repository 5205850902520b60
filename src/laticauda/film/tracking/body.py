"""Where a body was in every frame of a film: its center of mass and the angles of its links."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.film.calibration import Calibration, describe_certainty, points_on_plane
from laticauda.film.chain import PointPlaces, fit_chain, places_at
from laticauda.film.points import TrackedPoints
from laticauda.film.tags import LinkTag, TagFilm, TagLayout
from laticauda.robot import Robot, kinematics
from laticauda.trials.arrays import Samples
from laticauda.values import BadArgument

NOTED_SIZE_ERROR = 0.03
"""Difference of the size of tags from the stated one that is noted [-]."""
WORST_SIZE_ERROR = 0.15
"""Difference above which a height or a size is wrong [-]."""
N_DRAWS = 32
"""Draws of a fit from which the deviation of the center of mass is found."""
STRETCHED = 0.9
"""Quantile of the distance of two neighbors that is taken for that on the straight body."""
FARTHEST = 1.2
"""Distance of points in the film by that on the body, at most [-]."""
CLOSEST = 0.5
"""The same at least, on a body that is bent between them [-]."""
FEWEST_FRAMES = 5
"""Frames in which a body is seen at least."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyTrack:
    """A body in every frame of a film."""

    robot: Robot
    """Its planar chain."""
    time: Samples
    """Time of every frame [s]."""
    center_of_mass: Float[np.ndarray, "n_frames 2"]
    """Where its center of mass was; nan where that is not known [m]."""
    link_angle: Float[np.ndarray, "n_frames n_links"]
    """Angle of every link from the x axis; nan where it was not seen [rad]."""
    frame: Int[np.ndarray, " n_frames"]
    """Number of every frame in the film, from 0."""
    points: TrackedPoints
    """What was seen, in px unless there is no calibration."""
    calibration: Calibration | None
    """Of the camera; None if the points are in m."""
    center_deviation: float
    """Standard deviation of the center of mass along one axis, without that of the camera; nan where one
    tag alone cannot tell [m]."""
    notes: tuple[str, ...] = ()
    """What a reader of the figures should know, a sentence each."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LinkPoses:
    """Poses of links that carry tags."""

    link: tuple[int, ...]
    """The links, 0 = tail."""
    center: Float[np.ndarray, "n_frames n_tags 2"]
    """Middle of each; nan where its tag was not found [m]."""
    angle: Float[np.ndarray, "n_frames n_tags"]
    """Angle of each from the x axis, without jumps [rad]."""
    size_ratio: float
    """Usual size of the tags as seen, over the stated one [-]."""


def poses_of_links(film: TagFilm, layout: TagLayout, calibration: Calibration) -> LinkPoses:
    """Return the poses of links from their tags.

    Args:
        film: Tags in the film.
        layout: Which is on which link.
        calibration: Of the camera.

    Raises:
        ValueError: If no tag was found on a link.
    """
    poses: list[_LinkPose] = []
    for tag in sorted(layout.links, key=lambda tag: tag.link):
        corners = film.corners_of(tag.number)
        if np.isnan(corners[:, 0, 0]).all():
            continue
        places = calibration.to_plane(corners.reshape(-1, 2))
        poses.append(_pose_of_link(tag, places.reshape(corners.shape)))
    if not poses:
        numbers = ", ".join(str(tag.number) for tag in layout.links)
        raise BadArgument("film", f"must show tags on the robot, {numbers}: none was found")
    angle = np.stack([pose.angle for pose in poses], axis=1)
    size_ratios = [pose.tag_size / layout.link_size for pose in poses]
    return LinkPoses(
        link=tuple(pose.link for pose in poses),
        center=np.stack([pose.center for pose in poses], axis=1),
        angle=_turn_to_neighbors(angle),
        size_ratio=float(np.median(size_ratios)),
    )


class _LinkPose(NamedTuple):
    """What one tag says of its link."""

    link: int
    center: Float[np.ndarray, "n_frames 2"]
    angle: Float[np.ndarray, " n_frames"]
    tag_size: float
    """Usual length of an edge of the tag as seen [m]."""


def _pose_of_link(tag: LinkTag, corners: Float[np.ndarray, "n_frames 4 2"]) -> _LinkPose:
    """Return the pose of a link from the corners of its tag, in OpenCV's order [m]."""
    rear_left, front_left, front_right, rear_right = np.moveaxis(corners, 1, 0)
    along = 0.5 * (front_left - rear_left + front_right - rear_right)
    angle = np.arctan2(along[:, 1], along[:, 0]) - tag.angle
    headward = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    leftward = np.stack((-headward[:, 1], headward[:, 0]), axis=1)
    offset = tag.offset[0] * headward + tag.offset[1] * leftward
    lengths = np.linalg.norm(along, axis=1)
    return _LinkPose(
        link=tag.link,
        center=corners.mean(axis=1) - offset,
        angle=unwrap_seen(angle),
        tag_size=float(np.nanmedian(lengths)),
    )


def _turn_to_neighbors(
    angle: Float[np.ndarray, "n_frames n_tags"],
) -> Float[np.ndarray, "n_frames n_tags"]:
    """Return angles less whole turns, so that each is usually within half a turn of that of the tag before."""
    turned = angle.copy()
    whole_turn = 2.0 * np.pi
    for i in range(1, angle.shape[1]):
        difference = np.nanmedian(turned[:, i] - turned[:, i - 1])
        if np.isfinite(difference):
            turned[:, i] -= whole_turn * np.round(difference / whole_turn)
    return turned


def unwrap_seen(angle: Float[np.ndarray, " n_frames"]) -> Float[np.ndarray, " n_frames"]:
    """Return angles without jumps of whole turns from one seen frame to the next [rad].

    Args:
        angle: Angles; nan where not seen [rad].
    """
    is_seen = np.isfinite(angle)
    unwrapped = angle.copy()
    unwrapped[is_seen] = np.unwrap(angle[is_seen])
    return unwrapped


def follow_tags(
    film: TagFilm,
    layout: TagLayout,
    calibration: Calibration,
    robot: Robot,
    *,
    is_straight: bool = False,
    takes_frames_alone: bool = False,
) -> BodyTrack:
    """Find a body from tags on its links.

    A chain is fitted to all frames at once, which bridges tags that are lost, and is several times as
    exact as frames that are taken alone.

    Args:
        film: Tags in the film.
        layout: Which is on which link.
        calibration: Of the camera.
        robot: What swims.
        is_straight: Whether it holds straight, as in a glide: then one tag is enough.
        takes_frames_alone: Whether each frame is taken by itself, without a chain between them; every
            link then needs a tag that is never lost for long.

    Raises:
        ValueError: If a tag's link does not exist, the tags look too large or too small, or too few
            were found.
    """
    chain = robot.planar()
    _check_size_of_film(film, calibration)
    _check_links_exist(layout, chain)
    poses = poses_of_links(film, layout, calibration)
    notes = [
        describe_certainty(calibration),
        *_check_sizes(poses.size_ratio),
        _describe_lost(film, layout),
    ]
    points = points_of_tags(film, layout, poses.link)
    takes_frames_alone = takes_frames_alone or chain.n_links == 1
    if not is_straight and not takes_frames_alone:
        places = _places_of_tags(layout, poses.link, chain)
        tracked = points_on_plane(points, calibration)
        return _fit(tracked, points, places, chain, calibration, notes)
    if is_straight:
        angle = _mean_of_seen(poses.angle)
        link_angle = np.repeat(angle[:, np.newaxis], chain.n_links, axis=1)
        notes.append("The body is taken for straight.")
    else:
        _check_all_tagged(poses.link, chain)
        link_angle = poses.angle
    _check_seen(link_angle)
    estimates = _estimate_centers(chain, poses, link_angle)
    return BodyTrack(
        robot=chain,
        time=film.time,
        center_of_mass=_mean_center(estimates),
        link_angle=link_angle,
        frame=np.arange(film.time.size),
        points=points,
        calibration=calibration,
        center_deviation=_deviation_of_means(estimates),
        notes=tuple(notes),
    )


def follow_points(
    points: TrackedPoints, places: PointPlaces, calibration: Calibration | None, robot: Robot
) -> BodyTrack:
    """Find a body from points that a tracker found: a chain is fitted to all frames at once.

    Args:
        points: The points.
        places: Where they sit on the body.
        calibration: Of the camera; None if the points are in m.
        robot: What swims.

    Raises:
        ValueError: If points in px have no calibration, or too few were seen.
    """
    tracked = points
    if points.unit == "px":
        if calibration is None:
            raise BadArgument("calibration", "must be given: the points are in px")
        tracked = points_on_plane(points, calibration)
    elif calibration is not None:
        raise BadArgument("calibration", "must not be given: the points are in m already")
    _check_lengths(tracked, places)
    return _fit(tracked, points, places, robot.planar(), calibration, list(tracked.notes))


def _check_lengths(points: TrackedPoints, places: PointPlaces) -> None:
    """Refuse points that are much farther apart than on the body, or much closer: in another unit or on another one."""
    order = np.argsort(places.along)
    steps = np.linalg.norm(np.diff(points.position[:, order], axis=1), axis=2)
    is_known = np.isfinite(steps).any(axis=0)
    on_body = float(np.sum(np.diff(places.along[order])[is_known]))
    if on_body == 0.0:
        return
    in_film = float(np.sum(np.nanquantile(steps[:, is_known], STRETCHED, axis=0)))
    if not CLOSEST <= in_film / on_body <= FARTHEST:
        rule = f"must be {on_body:.3g} m apart along the body from the first to the last"
        raise BadArgument(
            "points",
            f"{rule}, as --along (`places`) says, got {in_film:.3g} m; is the scale in m, and the body the right one?",
        )


# ---- one frame after the other -------------------------------------------------------------------


def _check_links_exist(layout: TagLayout, chain: Robot) -> None:
    for tag in layout.links:
        if tag.link >= chain.n_links:
            rule = f"must be of links of {chain.name}, 0 to {chain.n_links - 1}"
            raise BadArgument("tags", f"{rule}, got {tag.link}")


def _check_all_tagged(links: Sequence[int], chain: Robot) -> None:
    missing = [str(link) for link in range(chain.n_links) if link not in links]
    if missing:
        rule = "must show a tag on every link if frames are taken alone"
        raise BadArgument("film", f"{rule}; none was found on link {', '.join(missing)}")


def _mean_center(
    estimates: Float[np.ndarray, "n_frames n_tags 2"],
) -> Float[np.ndarray, "n_frames 2"]:
    """Return the mean over links that were seen; nan where none was [m]."""
    means = [_mean_of_seen(estimates[..., axis]) for axis in (0, 1)]
    return np.stack(means, axis=1)


def _mean_of_seen(values: Float[np.ndarray, "n_frames n_tags"]) -> Float[np.ndarray, " n_frames"]:
    is_seen = np.isfinite(values)
    total = np.where(is_seen, values, 0.0).sum(axis=1)
    count = is_seen.sum(axis=1)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def _estimate_centers(
    chain: Robot, poses: LinkPoses, link_angle: Float[np.ndarray, "n_frames n_links"]
) -> Float[np.ndarray, "n_frames n_tags 2"]:
    """Return what every link that was seen says of the center of mass [m]."""
    estimates: list[np.ndarray] = []
    for i, link in enumerate(poses.link):
        place = poses.center[:, i]
        estimates.append(kinematics.center_of_mass(chain, place, link_angle, link=link))
    return np.stack(estimates, axis=1)


def _deviation_of_means(estimates: Float[np.ndarray, "n_frames n_tags 2"]) -> float:
    """Return the standard deviation of the mean over links that their scatter shows [m]; nan for one link."""
    n_tags = estimates.shape[1]
    if n_tags < 2:
        return float("nan")
    mean = _mean_center(estimates)
    from_mean = estimates - mean[:, np.newaxis]
    # What a link always says differently is no noise: its tag is not where it should be.
    usual = np.nanmedian(from_mean, axis=0, keepdims=True)
    scatter = from_mean - usual
    variance = float(np.nanmean(scatter**2))
    return math.sqrt(variance / (n_tags - 1.0))


def _check_seen(link_angle: Float[np.ndarray, "n_frames n_links"]) -> None:
    n_seen = np.isfinite(link_angle).sum(axis=0)
    if np.any(n_seen < FEWEST_FRAMES):
        link = int(np.argmin(n_seen))
        rule = f"must show every link in at least {FEWEST_FRAMES} frames"
        raise BadArgument("film", f"{rule}, got {n_seen[link]} of link {link}")


def _check_size_of_film(film: TagFilm, calibration: Calibration) -> None:
    if film.image_size != calibration.image_size:
        width, height = calibration.image_size
        rule = f"must be of a film of {film.image_size[0]} x {film.image_size[1]} px"
        raise BadArgument("calibration", f"{rule}, got one of {width} x {height} px")


def _check_sizes(size_ratio: float) -> list[str]:
    """Refuse tags that look too large or small, which shows that a height or a size is wrong."""
    error = size_ratio - 1.0
    if abs(error) > WORST_SIZE_ERROR:
        rule = "must be right: tags on the robot look"
        raise BadArgument("height", f"{rule} {size_ratio:.2f} times as large as they are")
    if abs(error) > NOTED_SIZE_ERROR:
        return [
            f"Tags on the robot look {size_ratio:.3f} times as large as they are: check the height of "
            "the plane and the size of the tags."
        ]
    return []


def _describe_lost(film: TagFilm, layout: TagLayout) -> str:
    numbers: list[int] = []
    lost_numbers: list[int] = []
    for tag in layout.links:
        is_lost = np.isnan(film.corners_of(tag.number)).all()
        if is_lost:
            lost_numbers.append(tag.number)
        else:
            numbers.append(tag.number)
    sentence = f"Tags on the robot were lost in {film.share_lost(numbers):.1%} of the frames."
    if lost_numbers:
        sentence += f" Never found: {', '.join(map(str, lost_numbers))}."
    return sentence


# ---- all frames at once --------------------------------------------------------------------------


def _fit(
    tracked: TrackedPoints,
    original: TrackedPoints,
    places: PointPlaces,
    chain: Robot,
    calibration: Calibration | None,
    notes: list[str],
) -> BodyTrack:
    fit = fit_chain(tracked, chain, places)
    motion = fit.motion(tracked.time)
    draws = fit.draw(N_DRAWS, tracked.time)
    shift = draws.center_of_mass - motion.center_of_mass
    variance = float(np.mean(shift**2))
    link_angle = kinematics.link_angles(motion.joint_angle, angle=motion.heading)
    millimeters = 1e3 * float(np.median(fit.noise))
    degrees = np.degrees(np.max(fit.joint_deviation, initial=0.0))
    notes.append(
        f"A chain was fitted to all frames: noise {millimeters:.2g} mm, joint "
        f"angles to {degrees:.2g} deg (standard deviation), {fit.n_outliers} outliers."
    )
    return BodyTrack(
        robot=chain,
        time=tracked.time,
        center_of_mass=motion.center_of_mass,
        link_angle=link_angle,
        frame=np.round(original.time * original.frame_rate).astype(int),
        points=original,
        calibration=calibration,
        center_deviation=math.sqrt(variance),
        notes=tuple(notes),
    )


def points_of_tags(film: TagFilm, layout: TagLayout, links: Sequence[int]) -> TrackedPoints:
    """Return two points for every tag on the robot: the middles of its rear and its front edge [px].

    Args:
        film: Tags in the film.
        layout: Which is on which link.
        links: Links whose tags are wanted.
    """
    names: list[str] = []
    positions: list[np.ndarray] = []
    for link in links:
        tag = _tag_of(layout, link)
        corners = film.corners_of(tag.number)
        names.append(f"tag {tag.number} rear")
        positions.append(0.5 * (corners[:, 0] + corners[:, 3]))
        names.append(f"tag {tag.number} front")
        positions.append(0.5 * (corners[:, 1] + corners[:, 2]))
    position = np.stack(positions, axis=1)
    return TrackedPoints(
        time=film.time,
        names=tuple(names),
        position=position,
        likelihood=np.full(position.shape[:2], np.nan),
        unit="px",
        source=f"{film.source}: tags",
    )


def _places_of_tags(layout: TagLayout, links: Sequence[int], chain: Robot) -> PointPlaces:
    """Return where the points of `points_of_tags` sit on the body."""
    ends = np.cumsum([module.length for module in chain.modules])
    half_size = 0.5 * layout.link_size
    along: list[float] = []
    left: list[float] = []
    for link in links:
        tag = _tag_of(layout, link)
        offset_along, offset_left = tag.offset
        middle_of_link = ends[link] - 0.5 * chain.modules[link].length
        middle_of_tag = middle_of_link + offset_along
        for to_edge in (-half_size, half_size):  # rear, front
            along.append(float(middle_of_tag + to_edge * np.cos(tag.angle)))
            left.append(float(offset_left + to_edge * np.sin(tag.angle)))
    return places_at(along, left)


def _tag_of(layout: TagLayout, link: int) -> LinkTag:
    return next(tag for tag in layout.links if tag.link == link)
