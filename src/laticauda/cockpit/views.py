"""What every page has for itself: its camera.

All of it happens in the server's own loop, where the pages' reports arrive. In another thread, a report that comes in
between two lines would mix where the camera was with where it is, and a camera that follows would keep that error.
"""

import asyncio
import time
from typing import Any

import numpy as np

from laticauda.cockpit import door
from laticauda.cockpit.scene import look_down

PATIENCE = 5.0  # how long a camera is brought to the robot until its page says that it is there [s]


class View:
    """The camera of one page, with the page's controls of it.

    Args:
        client: The page.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self._until = time.monotonic() + PATIENCE
        with client.gui.add_folder("This page"):
            self.follows = client.gui.add_checkbox("camera follows", True)
            client.gui.add_button("camera to the robot").on_click(self._go_home)
        client.camera.on_update(self._seen)

    @property
    def camera(self) -> Any:
        """As the page has reported it last, or as it has been moved since."""
        return self._client.camera

    @property
    def is_home(self) -> bool:
        """Whether the page has said that its camera is where it was brought to, or has had the time to."""
        return time.monotonic() >= self._until

    def show(self, at: np.ndarray) -> None:
        """Go along with a robot.

        Args:
            at: Where the robot is [m].
        """
        position, look_at = (np.array(part) for part in look_down())
        target = look_at + np.array([float(at[0]), float(at[1]), 0.0])
        if not self.is_home:
            door.move(self._client, target + position - look_at, target)
        elif self.follows.value:
            # What a slow page reports is old, but its direction and distance are right.
            door.move(self._client, target + self.camera.position - self.camera.look_at, target)

    async def _go_home(self, event: Any) -> None:
        self._until = time.monotonic() + PATIENCE

    async def _seen(self, camera: Any) -> None:
        # A page that has just been opened reports where its camera was before it was brought here.
        position, look_at = look_down()
        if np.allclose(camera.position - camera.look_at, np.subtract(position, look_at), atol=0.02):
            self._until = 0.0


class Views:
    """The views of all pages that are open.

    Args:
        server: Of the pages.
    """

    def __init__(self, server: Any) -> None:
        self._views: dict[int, View] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        server.on_client_connect(self._welcome)
        server.on_client_disconnect(self._forget)

    def __len__(self) -> int:
        """How many pages are open."""
        return len(self._views)

    def all(self) -> list[View]:
        """Of the pages, in the order in which they were opened."""
        return list(self._views.values())

    def show(self, at: np.ndarray) -> None:
        """Let the cameras that follow look at the robot, from where their page has put them around it; returns at once.

        Args:
            at: Where the robot is [m].
        """
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._show, at)

    def _show(self, at: np.ndarray) -> None:
        for view in self._views.values():
            view.show(at)

    # The loop waits for these two, so no page can be forgotten before it was welcomed.

    async def _welcome(self, client: Any) -> None:
        self._loop = asyncio.get_running_loop()
        self._views[client.client_id] = View(client)

    async def _forget(self, client: Any) -> None:
        self._views.pop(client.client_id, None)
