"""Path following (Fig. 3 of the paper): guidance gives a heading, the heading controller an offset of the gait."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, cast

import numpy as np

from laticauda.control.current import SPEED, CurrentObserver, ObserverState, crab_angle
from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance, HeadingController, HeadingEstimate, HeadingWindow
from laticauda.motion import gaits
from laticauda.robot import Robot
from laticauda.scenarios.interfaces import Command, Controller, Observation
from laticauda.values import angles
from laticauda.values.checks import check_positive
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

_SLOWEST = 0.5  # lower bound of the speed used for a crab angle, as a fraction of the gait's speed


@dataclass(frozen=True, kw_only=True)
class PathFollowingState:
    """State of path following: the states of its parts, and its last signals."""

    progress: Any
    """Progress along the path."""
    guidance: Any
    """State of the guidance law."""
    window: HeadingWindow
    """State of the heading estimate."""
    time: float | None = None
    """Time of the last control instant; None before the first [s]."""
    observed: ObserverState | None = None
    """State of the observer of the current; None without an observer, and before the first control instant."""
    signals: Mapping[str, float] = field(default_factory=dict[str, float])
    """Signals of the last control instant, for the log."""


@value_class
class PathFollowing(Controller[PathFollowingState]):
    """Controller that makes a robot follow a path with its gait.

    At every control instant, it locates the center of mass relative to the path and computes the
    heading that leads back to the path and the offset that turns the robot to that heading. The
    offset is held until the next control instant; the reference generator of the plant smooths it.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> from laticauda.control import LineOfSight, StraightLine
        >>> from laticauda.motion.gaits import Gait
        >>> controller = PathFollowing(
        ...     gait=Gait(amplitude=0.5, frequency=1.6, phase_shift=0.7),
        ...     path=StraightLine(),
        ...     guidance=LineOfSight(look_ahead_distance=0.18),
        ...     heading=HeadingController(gain=0.4, max_offset=0.35),
        ... )
        >>> controller.interval
        0.05
    """

    gait: gaits.Gait = option("Gait that follows the path; its own offset is added")
    path: Path[Any] = option("Path to follow: `StraightLine`, `Polyline`, `Spline` or a custom one")
    guidance: Guidance[Any] = option(
        "Guidance law: `LineOfSight`, `IntegralLineOfSight` or a custom one"
    )
    heading: HeadingController = option("Heading controller")
    heading_estimate: Literal["raw", "cycle_mean"] = option(
        "Heading that is used: raw (6), with the gait's ripple, or cycle_mean, over the last gait period",
        default="raw",
    )
    interval: float = quantity("s", "Time between two control instants", default=0.05, gt=0.0)
    observer: CurrentObserver | None = option(
        "Observer of the current, to point upstream; None: none", default=None
    )
    max_crab_angle: float = quantity(
        "rad",
        "Largest angle by which it points upstream",
        default=math.radians(60.0),
        gt=0.0,
        le=0.5 * math.pi,
    )

    def __post_init__(self) -> None:
        """Check every field once."""
        if self.heading_estimate == "cycle_mean":
            check_positive("gait.frequency", self.gait.frequency, "rad/s for a mean over its cycle")

    @cached_property
    def estimate(self) -> HeadingEstimate:
        """Heading estimate."""
        is_raw = self.heading_estimate == "raw"
        return HeadingEstimate(window=0.0 if is_raw else 2.0 * math.pi / self.gait.frequency)

    def init(self) -> PathFollowingState:
        """Return the state before the first control instant."""
        return PathFollowingState(
            progress=self.path.init(), guidance=self.guidance.init(), window=self.estimate.init()
        )

    def step(
        self, state: PathFollowingState, observation: Observation
    ) -> tuple[PathFollowingState, Command]:
        """Return the `state` after the `observation`, and the command until the next control instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: Current observation of the robot.
        """
        dt = 0.0 if state.time is None else observation.time - state.time
        window, heading = self.estimate.step(state.window, observation.time, observation.heading)
        progress, frame = self.path.locate(state.progress, observation.center_of_mass[:2])
        was_saturated = bool(state.signals.get("is_saturated"))
        guidance, heading_ref = self.guidance.step(
            state.guidance, frame, heading, dt, was_saturated
        )
        observed, crab = self._observed(state, observation, heading_ref)
        if crab:
            heading_ref = heading + angles.wrap_to_pi(heading_ref - crab["crab_angle"] - heading)
        offset, is_saturated = self.heading.offset(heading_ref=heading_ref, heading=heading)
        signals = {
            "heading_ref": heading_ref,
            "heading_used": heading,
            **frame.signals,
            "offset": offset,
            "is_saturated": float(is_saturated),
            **crab,
        }
        after = PathFollowingState(
            progress=progress,
            guidance=guidance,
            window=window,
            time=observation.time,
            observed=observed,
            signals=signals,
        )
        return after, Command(gait=self.gait, offset=offset)

    def _observed(
        self, state: PathFollowingState, observation: Observation, course: float
    ) -> tuple[ObserverState | None, dict[str, float]]:
        """Update the estimate of the current, and find how the robot points into the current on its course."""
        if self.observer is None:
            return None, {}
        frequency, held = self.gait.frequency, self.gait.offset + state.signals.get("offset", 0.0)
        seen = self.observer.step(state.observed, frequency, held, observation)
        # With the filter's own speed, its errors in speed and current cancel; at the start it has
        # no speed.
        speed = max(float(seen.mean[SPEED]), _SLOWEST * self.observer.model.speed(frequency, 0.0))
        angle, is_limited = crab_angle(course, seen.drift, speed, self.max_crab_angle)
        crab = {"crab_angle": angle, "is_crab_limited": float(is_limited)}
        return seen, self.observer.signals(seen) | crab

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: Robot that is to follow the path.

        Raises:
            ValueError: If the largest offset could take a joint beyond its limit.
        """
        refuse_offset(robot, self.gait, self.heading.max_offset)


def refuse_offset(robot: Robot, gait: gaits.Gait, max_offset: float) -> None:
    """Reject an offset that could take a joint beyond its limit.

    Args:
        robot: Robot that is to follow a path.
        gait: Gait that swims.
        max_offset: Largest offset that steering may add to either side [rad].

    Raises:
        ValueError: If a joint could go beyond its limit.
    """
    chain = robot.planar()
    for i, (joint, g) in enumerate(
        zip(chain.joints, gait.joint_envelope(chain.n_links), strict=True)
    ):
        room = joint.limit - gait.amplitude * abs(g) - abs(gait.offset)
        if max_offset > room:
            rule = (
                f"must be <= {room:.4g} rad, or joint {i} goes beyond its limit "
                f"of {joint.limit:.4g} rad with this gait"
            )
            raise BadArgument("max_offset", f"{rule}; got {max_offset}")


# ---- in space: twice, once in plan and once in profile -------------------------------------------
# A path in space is a path in plan and a profile: a path in the plane of the distance along the
# former (to the right) and the height (up). Every path, guidance law and heading law therefore also
# works vertically: in profile, "left of the path" is above it, and the heading is the climb, the
# mean pitch of the links with the opposite sign.

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
        own = {name: getattr(self, name) for name in ("gait", "heading_estimate", "interval")}
        return PathFollowing(
            path=self.profile, guidance=self.climb_guidance, heading=self.climb, **own
        )

    def init(self) -> SpatialPathFollowingState:
        """Return the state before the first control instant."""
        return SpatialPathFollowingState(**vars(super().init()), profile=self._profile.init())

    def step(
        self, state: PathFollowingState, observation: Observation
    ) -> tuple[SpatialPathFollowingState, Command]:
        """Return the `state` after the `observation`, and the command until the next control instant.

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
        plan, turn = super().step(state, observation)
        at, velocity = observation.center_of_mass, observation.center_of_mass_velocity
        course, gone = (
            plan.signals[name] for name in ("path_tangential_angle", "along_track_distance")
        )
        along = velocity[0] * math.cos(course) + velocity[1] * math.sin(course)
        seen = replace(
            observation,
            center_of_mass=np.array([gone, at[2]]),
            center_of_mass_velocity=np.array([along, velocity[2]]),
            heading=-observation.pitch,
        )
        profile, rise = self._profile.step(cast(SpatialPathFollowingState, state).profile, seen)
        climb = {ours: profile.signals[name] for name, ours in _SIGNALS.items()}
        state = SpatialPathFollowingState(
            **vars(replace(plan, signals={**plan.signals, **climb})), profile=profile
        )
        return state, replace(turn, pitch_offset=-rise.offset)

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
        pitch = self.gait.pitch
        room = min(limits) - (0.0 if pitch is None else pitch.amplitude + abs(pitch.offset))
        if self.climb.max_offset > room:
            rule = (
                f"must be <= {room:.4g} rad, or a pitch joint goes beyond its limit with this gait"
            )
            raise BadArgument("climb.max_offset", f"{rule}; got {self.climb.max_offset}")
