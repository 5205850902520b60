"""Path following in space: the planar one twice, once in plan and once in profile.

A path in space is a path in plan and a profile: a path in the plane of the distance along the first (to the right) and
the height (up). So every path, guidance law and heading law serves the vertical too: in profile, "left of the path" is
above it, and the heading is the climb, the mean pitch of the links with the opposite sign.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance
from laticauda.control.heading import HeadingController
from laticauda.control.path_following import PathFollowing, PathFollowingState
from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, Observation
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot

_OF_PLAN = tuple(PathFollowing.__dataclass_fields__)  # which this one has too
_SIGNALS = {
    "heading_ref": "climb_ref",
    "heading_used": "climb_used",
    "cross_track_error": "height_error",
    "path_tangential_angle": "path_climb",
    "offset": "climb_offset",
    "is_saturated": "climb_is_saturated",
}


@dataclass(frozen=True, kw_only=True)
class SpatialPathFollowingState:
    """What it remembers: the states of both path followings."""

    plan: PathFollowingState
    """In plan."""
    profile: PathFollowingState
    """In profile."""


@value
class SpatialPathFollowing(Controller[SpatialPathFollowingState]):
    """A controller that makes a robot with pitch joints follow a path in space.

    In plan it is `PathFollowing`. In profile it is the same once more, with the offset of the pitch joints.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> from laticauda.control import LineOfSight, StraightLine
        >>> controller = SpatialPathFollowing(
        ...     gait=Gait(amplitude=0.5, frequency=1.6, phase_shift=0.7),
        ...     path=StraightLine(),
        ...     profile=StraightLine(point=(0.0, -1.0)),
        ...     guidance=LineOfSight(look_ahead_distance=0.5),
        ...     climb_guidance=LineOfSight(look_ahead_distance=1.0),
        ...     heading=HeadingController(gain=0.4, max_offset=0.35),
        ...     climb=HeadingController(gain=0.2, max_offset=0.1),
        ... )
        >>> sorted(controller.signals(controller.init()))[:3]
        ['along_track_distance', 'climb_is_saturated', 'climb_offset']
    """

    gait: Gait = option("What swims along the path; its own offsets are added")
    path: Path[Any] = option("The path in plan")
    profile: Path[Any] = option("The path in profile: x is the distance along `path`, y the height, 0 at the surface")
    guidance: Guidance[Any] = option("The law that leads to the path in plan")
    climb_guidance: Guidance[Any] = option("The law that leads to the path in profile")
    heading: HeadingController = option("The law that turns the robot in plan")
    climb: HeadingController = option("The law that turns it in profile")
    heading_estimate: str = option("As for `PathFollowing`, for both", default="raw")
    interval: float = quantity("s", "Time between two control instants", default=0.05, gt=0.0)

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "heading_estimate", self._plan.heading_estimate)

    @property
    def _plan(self) -> PathFollowing:
        return PathFollowing(**{name: getattr(self, name) for name in _OF_PLAN})

    @property
    def _profile(self) -> PathFollowing:
        return replace(self._plan, path=self.profile, guidance=self.climb_guidance, heading=self.climb)

    def init(self) -> SpatialPathFollowingState:
        """Before the first control instant."""
        return SpatialPathFollowingState(plan=self._plan.init(), profile=self._profile.init())

    def step(
        self, state: SpatialPathFollowingState, observation: Observation
    ) -> tuple[SpatialPathFollowingState, Command]:
        """One control instant: the `state` after the `observation`, and the command until the next one.

        Raises:
            ValueError: If the observation is of a planar model.
        """
        if observation.center_of_mass.size != 3:
            raise BadArgument(
                "observation", "must be of a spatial model for a path in space, got one of a planar model"
            )
        plan, turn = self._plan.step(state.plan, observation)
        at, velocity = observation.center_of_mass, observation.center_of_mass_velocity
        along = velocity[0] * math.cos(plan.path_tangential_angle) + velocity[1] * math.sin(plan.path_tangential_angle)
        seen = replace(
            observation,
            center_of_mass=np.array([plan.along_track_distance, at[2]]),
            center_of_mass_velocity=np.array([along, velocity[2]]),
            heading=-observation.pitch,
        )
        profile, rise = self._profile.step(state.profile, seen)
        return SpatialPathFollowingState(plan=plan, profile=profile), replace(turn, pitch_offset=-rise.offset)

    def signals(self, state: SpatialPathFollowingState) -> dict[str, float]:
        """The signals of the last control instant, out of `state`, for the log."""
        profile = self._profile.signals(state.profile)
        return self._plan.signals(state.plan) | {ours: profile[name] for name, ours in _SIGNALS.items()}

    def check(self, robot: Robot) -> None:
        """Refuse a robot whose joints cannot bend as far as gait and steering together may ask.

        Args:
            robot: What is to follow the path.

        Raises:
            ValueError: If there are no pitch joints, or the largest offset could take a joint beyond its limit.
        """
        self._plan.check(robot)
        limits = [joint.limit for joint in robot.joints if joint.axis == "pitch"]
        if not limits:
            rule = "must have pitch joints for a path in space, got"
            raise BadArgument("robot", f"{rule} `{robot.name}` (the planar model holds them straight)")
        pitch = self.gait.pitch
        room = min(limits) - (0.0 if pitch is None else pitch.amplitude + abs(pitch.offset))
        if self.climb.max_offset > room:
            raise BadArgument(
                "climb.max_offset",
                f"must be <= {room:.4g} rad, or a pitch joint goes beyond its limit with this gait; "
                f"got {self.climb.max_offset}",
            )
