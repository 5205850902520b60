"""Path-following parameters as in trial files and on the command line.

Paths are followed in plan, and in space if a depth is given. `Following` is one flat list of
parameters; its `controller` builds the path, the laws and the controller from them.
"""

import math
from typing import Any, Literal

from laticauda.control import current, path_following, spatial_path_following
from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance, HeadingController, IntegralLineOfSight, LineOfSight
from laticauda.control.paths import Circle, Polyline, Spline, StraightLine
from laticauda.motion.gaits import Gait
from laticauda.scenarios import SHORTEST_INTERVAL
from laticauda.values import BadArgument, option, quantity, value_class

LEVEL = 1.0
"""Level stretch of a profile before its first and after its last depth [m]."""


@value_class
class Course:
    """Course to follow, apart from waypoints.

    A circle's depths are those at its start and after its turns; without depths, depth is not
    steered. A path with a depth needs pitch joints and the spatial model.
    """

    smooth: bool = option(
        "A smooth curve through the waypoints instead of straight legs", default=False
    )
    circle: tuple[float, float, float, float] | None = quantity(
        "",
        "A circle instead: x and y of its middle, its radius in m, and turns, positive to the left",
        default=None,
    )
    path_depth: tuple[float, ...] | None = quantity(
        "m",
        "Depth of the path: one for all of it, or one per waypoint; None: no depth control. Requires pitch "
        "joints and the spatial model",
        default=None,
    )


@value_class
class Following(Course):
    """Parameters of path following, as in trial files; the defaults are the paper's for Mamba.

    The integral gain is where published integral guidance starts. With a `path_depth` the robot is
    also steered in depth, by its pitch joints and integral guidance, so that even a robot lighter
    than water holds its depth.
    """

    waypoints: tuple[tuple[float, float], ...] | None = quantity(
        "m", "corners; None: the x axis", default=None
    )
    guidance: Literal["line_of_sight", "integral_line_of_sight"] = option(
        "guidance law", default="line_of_sight"
    )
    look_ahead_distance: float = quantity("m", "Delta", gt=0.0, default=0.18)
    integral_gain: float = quantity("m/s", "sigma of the integral law", ge=0.0, default=0.12)
    gain: float = quantity("", "k, offset per heading error", gt=0.0, default=0.4)
    max_offset: float = quantity(
        "rad", "largest offset to either side", gt=0.0, default=math.radians(20.0)
    )
    heading_estimate: Literal["raw", "cycle_mean"] = option(
        "raw, or cycle_mean over the last cycle", default="raw"
    )
    interval: float = quantity(
        "s", "time between two control instants", ge=SHORTEST_INTERVAL, default=0.05
    )
    observer: current.CurrentObserver | None = option(
        "observer of the current, which lets the robot point upstream; None: no observer",
        default=None,
    )
    climb_look_ahead_distance: float = quantity("m", "Delta for depth", gt=0.0, default=1.0)
    climb_integral_gain: float = quantity(
        "m/s", "sigma for depth; 0: no integral", ge=0.0, default=0.03
    )
    climb_gain: float = quantity(
        "", "offset of the pitch joints per climb error", gt=0.0, default=0.6
    )
    max_climb_offset: float = quantity(
        "rad", "largest such offset to either side", gt=0.0, default=math.radians(10.0)
    )

    def __post_init__(self) -> None:
        """Check the waypoints and the parameters of the laws by building path and laws."""
        if self.circle is not None and self.waypoints is not None:
            raise BadArgument("circle", f"must not be given with `waypoints`, got {self.circle}")
        self.controller(Gait(amplitude=0.5, frequency=1.0, phase_shift=0.5))

    @property
    def path(self) -> Path[Any]:
        """Path in plan."""
        if self.circle is not None:
            x, y, radius, turns = self.circle
            return Circle(center=(x, y), radius=radius, turns=turns)
        if self.waypoints is None:
            return StraightLine()
        if self.smooth:
            return Spline(waypoints=self.waypoints)
        return Polyline(waypoints=self.waypoints)

    @property
    def profile(self) -> Path[Any] | None:
        """Height along the path; None if depth is not steered."""
        depths = self.path_depth
        if depths is None:
            return None
        if len(depths) == 1:
            return StraightLine(point=(0.0, -depths[0]))
        distances = self._distances_of_depths()
        if len(depths) != len(distances):
            n_depths = f"must be one depth, or {len(distances)}"
            rule = f"{n_depths}: one per waypoint, or the first and last of a circle"
            raise BadArgument("path_depth", f"{rule}, got {len(depths)} of them")
        points = [(distance, -depth) for distance, depth in zip(distances, depths, strict=True)]
        begin = (distances[0] - LEVEL, -depths[0])
        end = (distances[-1] + LEVEL, -depths[-1])
        return Polyline(waypoints=(begin, *points, end))

    def _distances_of_depths(self) -> tuple[float, ...]:
        """Return the distances along the path at which depths are given [m]."""
        path = self.path
        if isinstance(path, Circle | Polyline | Spline):
            return path.lengths
        return (0.0,)

    def controller(self, gait: Gait) -> path_following.PathFollowing:
        """Return the controller.

        Args:
            gait: Gait that swims along the path.
        """
        plan = path_following.PathFollowing(
            gait=gait,
            path=self.path,
            guidance=self._build_guidance(),
            heading=HeadingController(gain=self.gain, max_offset=self.max_offset),
            heading_estimate=self.heading_estimate,
            interval=self.interval,
            observer=self.observer,
        )
        profile = self.profile
        if profile is None:
            return plan
        return spatial_path_following.SpatialPathFollowing(
            **vars(plan),
            profile=profile,
            climb_guidance=IntegralLineOfSight(
                look_ahead_distance=self.climb_look_ahead_distance,
                integral_gain=self.climb_integral_gain,
            ),
            climb=HeadingController(gain=self.climb_gain, max_offset=self.max_climb_offset),
        )

    def _build_guidance(self) -> Guidance[Any]:
        """Return the guidance law in plan."""
        if self.guidance == "integral_line_of_sight":
            return IntegralLineOfSight(
                look_ahead_distance=self.look_ahead_distance, integral_gain=self.integral_gain
            )
        return LineOfSight(look_ahead_distance=self.look_ahead_distance)
