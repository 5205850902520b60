"""Which tag is where: numbers, sizes and places, as a small TOML file that goes with the printed sheet."""

import math
from collections import Counter
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot
from laticauda.values import (
    BadArgument,
    TrialFileError,
    codec,
    files,
    option,
    quantity,
    value_class,
)

FIRST_ON_LINKS = 20
"""Number of the tag on the tail link; those on the floor count from 0."""
KIND = "film-tags"
DICTIONARIES = {"aruco-4x4": "DICT_4X4_50", "apriltag-36h11": "DICT_APRILTAG_36h11"}
"""OpenCV's names of the sets of tags."""
CELLS = {"aruco-4x4": 6, "apriltag-36h11": 8}
"""Cells along a side of a tag, its black border too."""
MOST_TAGS = 50
FEWEST_FLOOR_TAGS = 4


@value_class
class FloorTag:
    """A tag that stays where it is, and shows the camera where that is."""

    number: int = quantity("", "Number of the tag", ge=0, le=MOST_TAGS - 1)
    x: float = quantity("m", "Place of its center")
    y: float = quantity("m", "Place of its center")
    angle: float = quantity("rad", "Angle of its arrow from the x axis", default=0.0)


@value_class
class LinkTag:
    """A tag on a link of the robot."""

    number: int = quantity("", "Number of the tag", ge=0, le=MOST_TAGS - 1)
    link: int = quantity("", "Link that carries it, 0 = tail", ge=0)
    offset: tuple[float, float] = quantity(
        "m", "Place of its center from mid-link: toward the head, to the left", default=(0.0, 0.0)
    )
    angle: float = quantity("rad", "Angle of its arrow from the direction to the head", default=0.0)


@value_class
class TagLayout:
    """All tags of a film; sizes are those of the black squares."""

    dictionary: Literal["aruco-4x4", "apriltag-36h11"] = option(
        "Set of tags; the second is larger, and less often mistaken", default="aruco-4x4"
    )
    floor_size: float = quantity("m", "Side of the tags on the floor", gt=0.0)
    link_size: float = quantity("m", "Side of the tags on the robot", gt=0.0)
    place_deviation: float = quantity(
        "m", "Standard deviation of the places on the floor", default=0.002, ge=0.0
    )
    floor: tuple[FloorTag, ...] = option("Tags on the floor or the rim")
    links: tuple[LinkTag, ...] = option("Tags on the robot")

    def __post_init__(self) -> None:
        """Check that every number and every link has one tag, and that there are enough on the floor."""
        counts = Counter(tag.number for tag in (*self.floor, *self.links))
        for number, count in counts.items():
            if count > 1:
                raise BadArgument("floor", f"must have every number once, got {number} twice")
        for link, count in Counter(tag.link for tag in self.links).items():
            if count > 1:
                raise BadArgument("links", f"must have one tag for a link, got two on link {link}")

    @property
    def numbers(self) -> tuple[int, ...]:
        """Numbers of all tags, those on the floor first."""
        return tuple(tag.number for tag in (*self.floor, *self.links))


def corners_of(center: tuple[float, float], angle: float, size: float) -> Float[np.ndarray, "4 2"]:
    """Return the corners of a tag in the order of OpenCV: left of the arrow's start, and clockwise [m].

    Args:
        center: Its center [m].
        angle: Angle of its arrow [rad].
        size: Its side [m].
    """
    local = 0.5 * size * np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    along = np.array([math.cos(angle), math.sin(angle)])
    left = np.array([-along[1], along[0]])
    return np.array(center) + local @ np.stack((along, left))


def propose_layout(
    robot: Robot,
    *,
    area: tuple[float, float] = (3.0, 2.0),
    n_floor_tags: int = 6,
    floor_size: float = 0.13,
    link_size: float | None = None,
    dictionary: Literal["aruco-4x4", "apriltag-36h11"] = "aruco-4x4",
) -> TagLayout:
    """Return a layout for a robot: a tag on the middle of each link, and tags around an area.

    Args:
        robot: The robot.
        area: Length along x and y of the area that the tags surround [m].
        n_floor_tags: Number of tags around it; 6 tell the lens, too.
        floor_size: Their side [m].
        link_size: Side of the tags on the robot; None: as its links allow [m].
        dictionary: Set of tags.

    Raises:
        ValueError: If there are fewer than 4 tags, they would lie on each other, or a tag is larger
            than its link.
    """
    if min(area) <= floor_size:
        rule = f"must be longer and wider than a tag, {floor_size:g} m"
        raise BadArgument("area", f"{rule}, got {area[0]:g} by {area[1]:g} m")
    if not FEWEST_FLOOR_TAGS <= n_floor_tags <= FIRST_ON_LINKS:
        rule = f"must be between {FEWEST_FLOOR_TAGS} and {FIRST_ON_LINKS}"
        raise BadArgument("n_floor_tags", f"{rule}, got {n_floor_tags}")
    chain = robot.planar()
    if chain.n_links > MOST_TAGS - FIRST_ON_LINKS:
        rule = f"must have at most {MOST_TAGS - FIRST_ON_LINKS} links to be tagged"
        raise BadArgument("robot", f"{rule}, got {chain.n_links}")
    shortest = min(module.length for module in chain.modules)
    margin = 1.0 + 2.0 / CELLS[dictionary]
    if link_size is None:
        narrowest = min(2.0 * module.section.half_width for module in chain.modules)
        link_size = math.floor(1e3 * min(narrowest, SHARE_OF_LINK * shortest) / margin) / 1e3
    if link_size * margin > shortest:
        rule = f"must fit with its white margin on links of {shortest:g} m"
        raise BadArgument("link_size", f"{rule}, got {link_size:g} m")
    floor: list[FloorTag] = []
    for number, (x, y) in enumerate(around(area, n_floor_tags)):
        floor.append(FloorTag(number=number, x=x, y=y))
    links = [LinkTag(number=FIRST_ON_LINKS + i, link=i) for i in range(chain.n_links)]
    return TagLayout(
        dictionary=dictionary,
        floor_size=floor_size,
        link_size=link_size,
        floor=tuple(floor),
        links=tuple(links),
    )


SHARE_OF_LINK = 0.9
"""Side of a tag with its white margin, as a share of the length of a link at most [-]."""


def around(area: tuple[float, float], n: int) -> list[tuple[float, float]]:
    """Return places around a rectangle from the origin, counter-clockwise: its corners, and between them.

    Args:
        area: Length along x and y [m].
        n: Number of places, at least 4.
    """
    length, width = area
    corners = [(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)]
    n_between = [0, 0, 0, 0]
    for i in range(n - len(corners)):
        n_between[(0, 2, 1, 3)[i % 4]] += 1  # the long sides first
    places: list[tuple[float, float]] = []
    for side, (begin_x, begin_y) in enumerate(corners):
        end_x, end_y = corners[(side + 1) % 4]
        for i in range(n_between[side] + 1):
            share = i / (n_between[side] + 1)
            x = begin_x + share * (end_x - begin_x)
            y = begin_y + share * (end_y - begin_y)
            places.append((round(x, 3), round(y, 3)))
    return places


def describe_placing(layout: TagLayout) -> list[str]:
    """Return sentences that tell where to put the tags.

    Args:
        layout: The layout.
    """
    numbers = [tag.number for tag in layout.floor]
    on_robot: list[str] = []
    if layout.links:
        on_links = ", ".join(f"{tag.number} on link {tag.link}" for tag in layout.links)
        on_robot = [
            f"Put one tag on the middle of each link, arrow to the head: {on_links}. Link 0 is the tail."
        ]
    return [
        "Print at 100 %, without fitting to the page, and check the line of 100 mm.",
        f"Put tags {numbers[0]} to {numbers[-1]} flat around the swimming area, all at one height "
        "(floor or rim), arrows along x. Measure their centers to 2 mm, and correct x and y in the file.",
        *on_robot,
        "Measure how high the plane of motion is above the tags on the floor, and, if there is water "
        "above either, how high its surface is.",
        "The camera must not move, must see all tags on the floor, and must be in focus. "
        "A short exposure (1/500 s) keeps tags sharp; matt paper or film keeps them free of glare.",
    ]


def save_layout(layout: TagLayout, path: str | Path) -> None:
    """Write a layout to a TOML file.

    Args:
        layout: The layout.
        path: Path of the file.

    Raises:
        StorageFailed: If it cannot be written.
    """
    import tomli_w

    files.write(Path(path), tomli_w.dumps(codec.stamped(KIND, codec.encode(layout))).encode())


def load_layout(path: str | Path) -> TagLayout:
    """Read a layout.

    Args:
        path: Path of the TOML file.

    Raises:
        TrialFileError: If there is no such file, or anything in it is wrong.
    """
    path = Path(path)
    with codec.keys_of(path, TrialFileError):
        table = files.read_toml(path, TrialFileError)
        codec.take_kind(table, KIND)
        return codec.decode(TagLayout, table)
