"""Controls of the path that the robot follows, and of the depth that it holds along the path."""

import math
from typing import Any

from laticauda.control import StraightLine
from laticauda.scenarios import Scenario
from laticauda.show.cockpit.changes import Changes, read_depth, read_path
from laticauda.show.cockpit.control import Control
from laticauda.show.cockpit.live import Live

DEEPEST = 10.0
"""Largest depth that can be set [m]."""
ASIDE = 0.6
"""From the robot to the start of a path, so that the approach is visible [m]."""
HINT_OF_PATH = (
    "Follow a straight line with the paper's line-of-sight guidance; "
    "drag its gizmo to move or turn it."
)
HINT_OF_DEPTH = (
    "Along the path, by the pitch joints of a robot in space; 0: depth is not steered [m]"
)


class PathControls:
    """Controls of path and depth, which are in different places of the page.

    Args:
        live: The simulation that they control.
    """

    def __init__(self, live: Live) -> None:
        self._live = live

    def add_path(self, gui: Any) -> Control:
        """Add the control that begins and ends the following of a path."""
        handle = gui.add_checkbox("follow a path", False, hint=HINT_OF_PATH)
        return Control(handle, _has_path, self._change_path)

    def add_depth(self, gui: Any) -> Control:
        """Add the control of the depth."""
        handle = gui.add_number(
            "hold depth [m]", 0.0, min=0.0, max=DEEPEST, step=0.05, hint=HINT_OF_DEPTH
        )
        return Control(handle, _read_depth_or_zero, self._change_depth)

    def _change_path(self, is_followed: bool) -> Changes:
        if not is_followed:
            return {"path": None}
        return {"path": self._path_ahead(ASIDE)}

    def _change_depth(self, depth: float) -> Changes:
        """Return the changes that hold a depth along the path, or straight ahead if there is none."""
        if not depth:
            return {"depth": None}
        if read_path(self._live.scenario) is not None:
            return {"depth": depth}
        return {"depth": depth, "path": self._path_ahead(0.0)}

    def _path_ahead(self, aside: float) -> StraightLine:
        """Return a path along the robot's heading, some distance to its right [m]."""
        sample = self._live.latest()
        x, y = (float(value) for value in sample.center_of_mass[:2])
        angle = float(sample.heading)
        start = (x + aside * math.sin(angle), y - aside * math.cos(angle))
        return StraightLine(point=start, angle=angle)


def _has_path(scenario: Scenario) -> bool:
    return read_path(scenario) is not None


def _read_depth_or_zero(scenario: Scenario) -> float:
    return read_depth(scenario) or 0.0
