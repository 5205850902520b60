"""Path following (Fig. 3 of the paper).

Guidance gives a heading, and the heading controller gives the offset of the gait that turns the
robot there. In space, see `laticauda.control.spatial_path_following`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

from laticauda.control.current import SPEED, CurrentObserver, ObserverState, crab_angle
from laticauda.control.frames import Path
from laticauda.control.guidance import Guidance, HeadingController, HeadingEstimate, HeadingWindow
from laticauda.motion import gaits
from laticauda.robot import Robot
from laticauda.scenarios import (
    SHORTEST_INTERVAL,
    Command,
    Controller,
    Observation,
    VectorController,
)
from laticauda.values import (
    BadArgument,
    angles,
    check_positive,
    make_quickly,
    option,
    quantity,
    value_class,
)

SLOWEST = 0.5
"""Lower bound of the speed used for a crab angle, as a fraction of the gait's speed [-]."""


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
    observer: ObserverState | None = None
    """State of the observer of the current; None without one, and before the first instant."""
    signals: Mapping[str, float] = field(default_factory=dict[str, float])
    """Signals of the last control instant, for the log."""


class Crab(NamedTuple):
    """How a robot points into the current, so that its course over ground is the desired one."""

    angle: float
    """Angle upstream of the course, positive to the right [rad]."""
    is_limited: bool
    """Whether the current is too strong for the course."""

    @property
    def signals(self) -> dict[str, float]:
        """Signals for the log."""
        return {"crab_angle": self.angle, "is_crab_limited": float(self.is_limited)}


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
    interval: float = quantity(
        "s", "Time between two control instants", ge=SHORTEST_INTERVAL, default=0.05
    )
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
        if self.heading_estimate == "raw":
            return HeadingEstimate(window=0.0)
        return HeadingEstimate(window=2.0 * math.pi / self.gait.frequency)

    def init(self) -> PathFollowingState:
        """Return the state before the first control instant."""
        return PathFollowingState(
            progress=self.path.init(), guidance=self.guidance.init(), window=self.estimate.init()
        )

    def step(
        self, state: PathFollowingState, observation: Observation
    ) -> tuple[PathFollowingState, Command]:
        """Return the state after the observation, and the command until the next instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: Current observation of the robot.
        """
        dt = 0.0
        if state.time is not None:
            dt = observation.time - state.time
        window, heading = self.estimate.step(state.window, observation.time, observation.heading)
        progress, frame = self.path.locate(state.progress, observation.center_of_mass[:2])
        was_saturated = bool(state.signals.get("is_saturated"))
        guidance, heading_ref = self.guidance.step(
            state.guidance, frame, heading, dt, was_saturated
        )
        observer_state: ObserverState | None = None
        current_signals: dict[str, float] = {}
        if self.observer is not None:
            observer_state = self._observe_current(self.observer, state, observation)
            crab = self._crab_into_current(self.observer, observer_state, heading_ref)
            turn = angles.wrap_to_pi(heading_ref - crab.angle - heading)
            heading_ref = heading + turn
            current_signals = self.observer.signals(observer_state) | crab.signals
        offset, is_saturated = self.heading.offset(heading_ref=heading_ref, heading=heading)
        signals = {
            "heading_ref": heading_ref,
            "heading_used": heading,
            **frame.signals,
            "offset": offset,
            "is_saturated": float(is_saturated),
            **current_signals,
        }
        state_after = make_quickly(
            PathFollowingState,
            progress=progress,
            guidance=guidance,
            window=window,
            time=observation.time,
            observer=observer_state,
            signals=signals,
        )
        return state_after, make_quickly(Command, gait=self.gait, offset=offset)

    @classmethod
    def vectorize(cls, controllers: Sequence[Any]) -> VectorController | None:
        """Return one object that makes a robot follow a path for each of many controllers.

        Args:
            controllers: The controllers, one for each robot.
        """
        if cls is not PathFollowing or not _observe_alike(controllers):
            return None
        from laticauda.control.vector_following import VectorFollowing

        return VectorFollowing(controllers)

    def _observe_current(
        self, observer: CurrentObserver, state: PathFollowingState, observation: Observation
    ) -> ObserverState:
        """Return the observer's state after an observation, under the command so far."""
        offset = self.gait.offset + state.signals.get("offset", 0.0)
        return observer.step(state.observer, self.gait.frequency, offset, observation)

    def _crab_into_current(
        self, observer: CurrentObserver, state: ObserverState, course: float
    ) -> Crab:
        """Return how the robot must point into the observed current on its `course` [rad]."""
        # With the filter's own speed, its errors in speed and current cancel; at the start it has
        # no speed.
        usual_speed = observer.model.speed(self.gait.frequency, 0.0)
        speed = max(float(state.mean[SPEED]), SLOWEST * usual_speed)
        return Crab(*crab_angle(course, state.drift, speed, self.max_crab_angle))

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: Robot that is to follow the path.

        Raises:
            ValueError: If the largest offset could take a joint beyond its limit.
        """
        refuse_offset(robot, self.gait, self.heading.max_offset)


def _observe_alike(controllers: Sequence[PathFollowing]) -> bool:
    """Return whether no controller observes the current, or all do with the same model of their gaits."""
    observers = [controller.observer for controller in controllers]
    first = observers[0]
    if first is None:
        return not any(observers)
    return all(observer is not None and observer.model == first.model for observer in observers)


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
    envelope = gait.joint_envelope(chain.n_links)
    for i, (joint, g) in enumerate(zip(chain.joints, envelope, strict=True)):
        room = joint.limit - gait.amplitude * abs(g) - abs(gait.offset)
        if max_offset > room:
            rule = (
                f"must be <= {room:.4g} rad, or joint {i} goes beyond its limit "
                f"of {joint.limit:.4g} rad with this gait"
            )
            raise BadArgument("max_offset", f"{rule}; got {max_offset}")
