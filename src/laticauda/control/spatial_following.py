"""Path following in space: the planar one twice, once in plan and once in profile.

A path in space is a path in plan and a profile: a path in the plane of the distance along the first (to the right) and
the height (up). So every path, guidance law and heading law serves the vertical too: in profile, "left of the path" is
above it, and the heading is the climb, the mean pitch of the links with the opposite sign.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance, HeadingController
from laticauda.control.path_following import PathFollowing, PathFollowingState
from laticauda.errors import BadArgument
from laticauda.interfaces import Command, Observation
from laticauda.quantities import option, value
from laticauda.robot import Robot

_SIGNALS = {
    "heading_ref": "climb_ref",
    "heading_used": "climb_used",
    "cross_track_error": "height_error",
    "path_tangential_angle": "path_climb",
    "offset": "climb_offset",
    "is_saturated": "climb_is_saturated",
}


@dataclass(frozen=True, kw_only=True)
class SpatialPathFollowingState(PathFollowingState):
    """What it remembers: the state of the path following in plan, and of the one in profile."""

    profile: PathFollowingState
    """In profile."""


@value
class SpatialPathFollowing(PathFollowing):
    """A controller that makes a robot with pitch joints follow a path in space.

    In plan it is `PathFollowing`. In profile it is the same once more, with the offset of the pitch joints.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> from laticauda.control import LineOfSight, StraightLine
        >>> from laticauda.gaits import Gait
        >>> controller = SpatialPathFollowing(
        ...     gait=Gait(amplitude=0.5, frequency=1.6, phase_shift=0.7),
        ...     path=StraightLine(),
        ...     profile=StraightLine(point=(0.0, -1.0)),
        ...     guidance=LineOfSight(look_ahead_distance=0.5),
        ...     climb_guidance=LineOfSight(look_ahead_distance=1.0),
        ...     heading=HeadingController(gain=0.4, max_offset=0.35),
        ...     climb=HeadingController(gain=0.2, max_offset=0.1),
        ... )
        >>> controller.interval
        0.05
    """

    profile: Path[Any] = option("The path in profile: x is the distance along `path`, y the height, 0 at the surface")
    climb_guidance: Guidance[Any] = option("The law that leads to the path in profile")
    climb: HeadingController = option("The law that turns it in profile")

    @property
    def _profile(self) -> PathFollowing:
        own = {name: getattr(self, name) for name in ("gait", "heading_estimate", "interval")}
        return PathFollowing(path=self.profile, guidance=self.climb_guidance, heading=self.climb, **own)

    def init(self) -> SpatialPathFollowingState:
        """Before the first control instant."""
        return SpatialPathFollowingState(**vars(super().init()), profile=self._profile.init())

    def step(self, state: PathFollowingState, observation: Observation) -> tuple[SpatialPathFollowingState, Command]:
        """One control instant: the `state` after the `observation`, and the command until the next one.

        Raises:
            ValueError: If the observation is of a planar model.
        """
        if observation.center_of_mass.size != 3:
            raise BadArgument(
                "observation", "must be of a spatial model for a path in space, got one of a planar model"
            )
        plan, turn = super().step(state, observation)
        at, velocity = observation.center_of_mass, observation.center_of_mass_velocity
        course, gone = (plan.signals[name] for name in ("path_tangential_angle", "along_track_distance"))
        along = velocity[0] * math.cos(course) + velocity[1] * math.sin(course)
        seen = replace(
            observation,
            center_of_mass=np.array([gone, at[2]]),
            center_of_mass_velocity=np.array([along, velocity[2]]),
            heading=-observation.pitch,
        )
        profile, rise = self._profile.step(cast(SpatialPathFollowingState, state).profile, seen)
        climb = {ours: profile.signals[name] for name, ours in _SIGNALS.items()}
        state = SpatialPathFollowingState(**vars(replace(plan, signals={**plan.signals, **climb})), profile=profile)
        return state, replace(turn, pitch_offset=-rise.offset)

    def check(self, robot: Robot) -> None:
        """Refuse a robot whose joints cannot bend as far as gait and steering together may ask.

        Args:
            robot: What is to follow the path.

        Raises:
            ValueError: If there are no pitch joints, or the largest offset could take a joint beyond its limit.
        """
        super().check(robot)
        limits = [joint.limit for joint in robot.joints if joint.axis == "pitch"]
        if not limits:
            rule = "must have pitch joints for a path in space, got"
            raise BadArgument("robot", f"{rule} `{robot.name}` (the planar model holds them straight)")
        pitch = self.gait.pitch
        room = min(limits) - (0.0 if pitch is None else pitch.amplitude + abs(pitch.offset))
        if self.climb.max_offset > room:
            rule = f"must be <= {room:.4g} rad, or a pitch joint goes beyond its limit with this gait"
            raise BadArgument("climb.max_offset", f"{rule}; got {self.climb.max_offset}")
