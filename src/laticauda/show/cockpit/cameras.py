"""The camera of each page, which follows the robot.

Cameras are updated in the server's own event loop, where the pages' reports arrive. In another
thread, a report that arrives between two lines would mix a camera's old and new positions, and the
next report would preserve that error.
"""

import asyncio
import math
import time
import warnings
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from laticauda.show.pictures import lift_to_space

AHEAD = 0.35
"""What a camera looks at, along x from the robot: the panel hides the right side of the page [m]."""
ELEVATION = math.radians(34.0)
"""Initial elevation of a camera above the robot's plane [rad]."""
HOME_BACK = 0.5
"""Initial distance of a camera from what it looks at, along x, toward the tail [m]."""
HOME_DISTANCE = 3.2
"""Initial distance of a camera from what it looks at, seen along x [m]."""
FIELD_OF_VIEW = math.radians(55.0)
"""Vertical angle of view [rad]."""
NARROW = 0.7
"""Largest ratio of width to height of a phone held upright [-]."""
PATIENCE = 5.0
"""How long a camera is moved to the robot unless its page confirms the move earlier [s]."""
CONFIRMED = 0.02
"""Largest difference between a camera and its home that is a confirmation, along any axis [m]."""


class View(NamedTuple):
    """A camera relative to the robot."""

    position: Any
    """Where it is [m]."""
    look_at: Any
    """What it looks at [m]."""


HOME = View(
    position=(
        AHEAD - HOME_BACK,
        -HOME_DISTANCE * math.cos(ELEVATION),
        HOME_DISTANCE * math.sin(ELEVATION),
    ),
    look_at=(AHEAD, 0.0, 0.0),
)
"""Initial camera, beside and above the robot."""
BELOW = np.array((0.0, 0.0, -1.35))
"""What a phone's camera looks at, from the robot: the panel hides the bottom [m]."""
PHONE = View(
    position=BELOW + 1.9 * np.subtract(HOME.position, HOME.look_at),
    look_at=BELOW,
)
"""`HOME` for a page that is much taller than wide."""


FARTHEST = 1e6
"""Largest coordinate of a camera that is believed [m]."""
LARGEST_IMAGE = 1e5
"""Largest width and height of a page's picture that are believed [px]."""


def is_camera(report: Any) -> bool:
    """Return whether a page's report of its camera can be computed with.

    Args:
        report: viser's message, with whatever a page has sent.
    """
    vectors: tuple[Sequence[float], ...] = (report.position, report.look_at, report.up_direction)
    lenses = (report.fov, report.near, report.far)
    sizes = (report.image_width, report.image_height)
    return (
        all(_are_numbers(vector, 3, -FARTHEST, FARTHEST) for vector in vectors)
        and math.dist(vectors[0], vectors[1]) > 0.0
        and _are_numbers(report.wxyz, 4, -2.0, 2.0)
        and any(report.wxyz)
        and _are_numbers(lenses, 3, 0.0, math.inf)
        and _are_numbers(sizes, 2, 1.0, LARGEST_IMAGE)
    )


def _are_numbers(values: Sequence[float], count: int, least: float, most: float) -> bool:
    """Return whether these are so many numbers within these limits; viser has made numbers of them."""
    return len(values) == count and all(least <= value <= most for value in values)


class PageCamera:
    """Camera of one page, with the page's controls for it.

    Args:
        client: The page.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self.camera = client.camera
        """Camera as last reported by the page, or as moved since."""
        self._home_until = time.monotonic() + PATIENCE
        with client.gui.add_folder("This page"):
            self.follows = client.gui.add_checkbox("camera follows", True)
            client.gui.add_button("camera to the robot").on_click(self._go_home)
        self.camera.on_update(self._take_report)

    @property
    def is_home(self) -> bool:
        """Whether the page has confirmed that its camera is at the home position, or has had the time to."""
        return time.monotonic() >= self._home_until

    def show(self, center: np.ndarray) -> None:
        """Follow a robot.

        Args:
            center: Position of the robot, in the plane or in space [m].
        """
        is_home = self.is_home
        if is_home and not self.follows.value:
            return
        home = self._home
        if is_home:
            # Reports of a slow page are outdated, but their direction and distance are correct.
            offset = self.camera.position - self.camera.look_at
        else:
            offset = np.subtract(home.position, home.look_at)
        target = np.array(home.look_at) + lift_to_space(center, 0.0)
        with warnings.catch_warnings(), self._client.atomic():
            warnings.simplefilter("ignore", UserWarning)  # a page has just been closed
            self.camera.position = target + offset
            self.camera.look_at = target

    @property
    def _home(self) -> View:
        if self.camera.aspect < NARROW:
            return PHONE
        return HOME

    async def _go_home(self, event: Any) -> None:
        self._home_until = time.monotonic() + PATIENCE

    async def _take_report(self, camera: Any) -> None:
        # A page that has just been opened reports where its camera was before it was moved here.
        home_offset = np.subtract(self._home.position, self._home.look_at)
        if np.allclose(camera.position - camera.look_at, home_offset, atol=CONFIRMED):
            self._home_until = 0.0


class PageCameras:
    """Cameras of all open pages.

    Args:
        server: Server of the pages.
    """

    def __init__(self, server: Any) -> None:
        self._cameras: dict[int, PageCamera] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        self._center: np.ndarray | None = None
        """Where the robot is, until the loop has shown it [m]."""
        # The loop awaits both, so no page can be removed before it has been added.
        server.on_client_connect(self._add)
        server.on_client_disconnect(self._remove)

    def all(self) -> list[PageCamera]:
        """Return the cameras in the order in which their pages were opened."""
        return list(self._cameras.values())

    def show(self, center: np.ndarray) -> None:
        """Point the cameras that follow at the robot, keeping the offsets set on their pages; return at once.

        Args:
            center: Position of the robot [m].
        """
        if self._loop is None or self._loop.is_closed():
            return
        is_waiting = self._center is not None
        self._center = center
        # With many pages a loop may need longer than a frame: calls for older ones would pile up.
        if not is_waiting:
            self._loop.call_soon_threadsafe(self._show)

    def _show(self) -> None:
        center, self._center = self._center, None
        if center is None:
            return
        for camera in self._cameras.values():
            camera.show(center)

    async def _add(self, client: Any) -> None:
        self._loop = asyncio.get_running_loop()
        self._cameras[client.client_id] = PageCamera(client)

    async def _remove(self, client: Any) -> None:
        self._cameras.pop(client.client_id, None)
