"""Path following in space: path following twice, once in plan and once in profile.

A path in space is a path in plan and a profile: a path in the plane of the distance along the
former (to the right) and the height (up). Every path, guidance law and heading law therefore also
works vertically: in profile, "left of the path" is above it, and the heading is the climb, the mean
pitch of the links with the opposite sign.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance, HeadingController
from laticauda.control.path_following import PathFollowing, PathFollowingState
from laticauda.robot import Robot
from laticauda.scenarios import Command, Observation
from laticauda.values import BadArgument, option, value_class

SIGNALS_IN_PROFILE = {
    "heading_ref": "climb_ref",
    "heading_used": "climb_used",
    "cross_track_error": "height_error",
    "path_tangential_angle": "path_climb",
    "offset": "climb_offset",
    "is_saturated": "climb_is_saturated",
}
"""Names in the log of the signals of the controller in profile."""


@dataclass(frozen=True, kw_only=True)
class SpatialPathFollowingState(PathFollowingState):
    """State of path following in space: the state in plan and the state in profile."""

    profile: PathFollowingState
    """State in profile."""


@value_class
class SpatialPathFollowing(PathFollowing):
    """Controller that makes a robot with pitch joints follow a path in space.

    In plan it is `PathFollowing`; in profile it is a second `PathFollowing` that sets the offset of
    the pitch joints.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> from laticauda.control import LineOfSight, StraightLine
        >>> from laticauda.motion.gaits import Gait
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

    profile: Path[Any] = option(
        "The path in profile: x is the distance along `path`, y the height, 0 at the surface"
    )
    climb_guidance: Guidance[Any] = option("Guidance law in profile")
    climb: HeadingController = option("Climb controller")

    @property
    def _profile(self) -> PathFollowing:
        """Controller in profile."""
        return PathFollowing(
            gait=self.gait,
            path=self.profile,
            guidance=self.climb_guidance,
            heading=self.climb,
            heading_estimate=self.heading_estimate,
            interval=self.interval,
        )

    def init(self) -> SpatialPathFollowingState:
        """Return the state before the first control instant."""
        return SpatialPathFollowingState(**vars(super().init()), profile=self._profile.init())

    def step(
        self, state: PathFollowingState, observation: Observation
    ) -> tuple[SpatialPathFollowingState, Command]:
        """Return the state after the observation, and the command until the next instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: Current observation of the robot.

        Raises:
            ValueError: If the observation comes from a planar model.
        """
        if observation.center_of_mass.size != 3:
            raise BadArgument(
                "observation",
                "must come from a spatial model for a path in space, got one from a planar model",
            )
        plan, command = super().step(state, observation)
        in_profile = _project_to_profile(observation, plan)
        state_in_profile = cast(SpatialPathFollowingState, state).profile
        profile, climb_command = self._profile.step(state_in_profile, in_profile)
        signals = dict(plan.signals)
        for name, name_in_profile in SIGNALS_IN_PROFILE.items():
            signals[name_in_profile] = profile.signals[name]
        plan = replace(plan, signals=signals)
        state_after = SpatialPathFollowingState(**vars(plan), profile=profile)
        return state_after, replace(command, pitch_offset=-climb_command.offset)

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: Robot that is to follow the path.

        Raises:
            ValueError: If there are no pitch joints, or the largest offset could take a joint
                beyond its limit.
        """
        super().check(robot)
        limits = [joint.limit for joint in robot.joints if joint.axis == "pitch"]
        if not limits:
            rule = "must have pitch joints for a path in space, got"
            raise BadArgument(
                "robot", f"{rule} `{robot.name}` (`axis` in its file; the planar model has none)"
            )
        room = min(limits)
        pitch = self.gait.pitch
        if pitch is not None:
            room -= pitch.amplitude + abs(pitch.offset)
        if self.climb.max_offset > room:
            rule = (
                f"must be <= {room:.4g} rad, or a pitch joint goes beyond its limit with this gait"
            )
            raise BadArgument("climb.max_offset", f"{rule}; got {self.climb.max_offset}")


def _project_to_profile(observation: Observation, plan: PathFollowingState) -> Observation:
    """Return what the controller in profile observes: distance along the path, height and climb."""
    course = plan.signals["path_tangential_angle"]
    distance = plan.signals["along_track_distance"]
    height = observation.center_of_mass[2]
    velocity = observation.center_of_mass_velocity
    speed_along_path = velocity[0] * math.cos(course) + velocity[1] * math.sin(course)
    return replace(
        observation,
        center_of_mass=np.array([distance, height]),
        center_of_mass_velocity=np.array([speed_along_path, velocity[2]]),
        heading=-observation.pitch,
    )
