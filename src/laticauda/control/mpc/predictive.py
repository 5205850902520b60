"""Model-predictive path following: plan the next seconds, and carry out the start of the best plan.

Every control instant has a new plan, from the state that a filter estimates (see
`laticauda.control.current`); `laticauda.control.mpc.planning` solves for it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from laticauda.control import averaged, guidance, path_following
from laticauda.control.current import BEND, PSI, SPEED, SWAY, CurrentObserver, ObserverState, X, Y
from laticauda.control.frames import Path, PathFrame
from laticauda.control.mpc.planning import Plan, PlanParameters, PlanProblem, solve_plan
from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import Command, Controller, Observation
from laticauda.values import BadArgument, check_positive, option, quantity, value_class, wrap_to_pi

_LEAST_INTERVAL = 0.2
"""Least time between two control instants, which allows the solver enough time [s]."""
_SLOWEST = 0.2
"""Lower bound of the speed used to look ahead along the path, per requested speed [-]."""
_HALF_PIECE = 0.01
"""Half the length of the piece of path whose ends give the position and direction there [m]."""
_SATURATION = 1e-9
"""Distance from its limit within which an offset counts as saturated [rad]."""


class PlannedCommand(NamedTuple):
    """Command of a gait: the numbers that are planned."""

    frequency: float
    """Frequency of the gait [rad/s]."""
    offset: float
    """Offset of the joints [rad]."""


class Decision(NamedTuple):
    """What a plan, or the law that replaces it, decides."""

    heading_ref: float
    """Desired mean heading: the plan's after its first stage, or that of line of sight [rad]."""
    command: PlannedCommand
    """Command until the next control instant, not yet limited."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictiveState:
    """State of the controller, and its last signals."""

    progress: Any
    """Progress along the path."""
    command: PlannedCommand
    """Last command."""
    observer: ObserverState | None = None
    """Estimated state of the robot; None before the first instant."""
    unknowns: np.ndarray | None = None
    """Unknowns of the last plan, the initial guess of the next; None if it had no solution."""
    signals: Mapping[str, float] = field(default_factory=dict[str, float])
    """Signals of the last control instant, for the log."""


@value_class
class PlanLimits:
    """Limits of a plan, and the law that steers if there is no plan."""

    frequency_limits: tuple[float, float] | None = quantity(
        "rad/s", "Lowest, highest; None: the gait's", default=None
    )
    power_limit: float = quantity(
        "W", "Limit of the gait's modeled mean power over a cycle", default=math.inf
    )
    max_offset: float = quantity(
        "rad", "Largest offset to either side", default=math.radians(20.0), gt=0.0
    )
    look_ahead_distance: float = quantity(
        "m", "Look-ahead of the fallback line of sight", default=1.62, gt=0.0
    )
    gain: float = quantity("", "Gain of its heading law", default=0.25, gt=0.0)
    interval: float = quantity(
        "s", "Time between two control instants, 0.2 s or more", default=0.2, ge=_LEAST_INTERVAL
    )


@value_class
class ModelPredictive(PlanLimits, Controller[PredictiveState]):
    """Controller that plans offset and frequency with the averaged model, current included.

    The cost per second is the sum of the costs of the distance from the path, the course across it,
    the speed along it and the power, each relative to its tolerance. The offset, its rate, the
    frequency and the mean power stay within their limits. If the solver finds no plan,
    line-of-sight guidance steers while the frequency goes to its least value, within the limits of
    offset and rates, and the signal ``is_fallback`` is set.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("Gait; a run starts with its frequency")
    path: Path[Any] = option("Path to follow")
    model: averaged.AveragedModel = option("Model of this gait and robot, from `fit_averaged`")
    speed: float = quantity("m/s", "Desired speed along the path", gt=0.0)
    offset_rate: float = quantity(
        "rad/s", "Largest rate of change of the offset", default=math.radians(20.0), gt=0.0
    )
    frequency_rate: float = quantity(
        "rad/s^2", "Largest rate of change of the frequency", default=0.2, gt=0.0
    )
    cross_track_tolerance: float = quantity(
        "m",
        "Distance from the path that costs 1 per second; far away, the cost grows linearly",
        default=0.1,
        gt=0.0,
    )
    course_tolerance: float = quantity(
        "rad", "Angle between course and path that costs 1 per s", default=0.5, gt=0.0
    )
    speed_tolerance: float = quantity(
        "m/s", "Lack of speed that costs 1 per second", default=0.05, gt=0.0
    )
    power_tolerance: float = quantity("W", "Power that costs 1 per second", default=1000.0, gt=0.0)
    horizon: int = quantity(
        "", "Number of planned steps after the first, which lasts one interval", default=15, ge=1
    )
    stage: float = quantity("s", "Duration of each of them", default=1.0, gt=0.0)
    iterations: int = quantity("", "Most solver iterations per plan", default=40, ge=1)

    def __post_init__(self) -> None:
        """Check every field once."""
        low, high = self.frequencies
        check_positive("frequency_limits[0]", low, "rad/s")
        if not low <= self.gait.frequency <= high:
            rule = f"must enclose the gait's frequency of {self.gait.frequency:.4g} rad/s"
            raise BadArgument("frequency_limits", f"{rule}, got {low:.4g} and {high:.4g}")
        least_power = max(
            self.model.power(low, 0.0),
            self.model.power(low, self.max_offset),
        )
        if not self.power_limit >= least_power:
            at_least = f"must be >= {least_power:.4g} W"
            rule = f"{at_least}, the power at the lowest frequency with the largest offset"
            raise BadArgument("power_limit", f"{rule}, got {self.power_limit}")

    @property
    def frequencies(self) -> tuple[float, float]:
        """Least and greatest frequency [rad/s]."""
        return self.frequency_limits or (self.gait.frequency, self.gait.frequency)

    @property
    def stages(self) -> tuple[float, ...]:
        """Durations for which a plan holds each command [s]."""
        later_stages = (self.stage,) * self.horizon
        return (self.interval, *later_stages)

    @cached_property
    def _problem(self) -> PlanProblem:
        """Part that stays the same from plan to plan."""
        low, high = self.frequencies
        return PlanProblem(
            model=self.model,
            stages=self.stages,
            speed=self.speed,
            lowest_frequency=low,
            highest_frequency=high,
            max_offset=self.max_offset,
            power_limit=self.power_limit,
            offset_rate=self.offset_rate,
            frequency_rate=self.frequency_rate,
            cross_track_tolerance=self.cross_track_tolerance,
            course_tolerance=self.course_tolerance,
            speed_tolerance=self.speed_tolerance,
            power_tolerance=self.power_tolerance,
            iterations=self.iterations,
        )

    def init(self) -> PredictiveState:
        """Return the state before the first control instant."""
        command = PlannedCommand(frequency=self.gait.frequency, offset=0.0)
        return PredictiveState(progress=self.path.init(), command=command)

    def step(
        self, state: PredictiveState, observation: Observation
    ) -> tuple[PredictiveState, Command]:
        """Return the state after the observation, and the command until the next instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: Current observation of the robot.
        """
        observer = CurrentObserver(model=self.model)
        last = state.command
        estimate = observer.step(state.observer, last.frequency, last.offset, observation)
        # The plan starts from the filter's position: the center of mass swings across its course
        # with the gait.
        progress, frame = self.path.locate(state.progress, estimate.mean[[X, Y]])
        _, observed_frame = self.path.locate(progress, observation.center_of_mass[:2])
        parameters = self._plan_parameters(estimate, frame, last)
        plan = solve_plan(self._problem, parameters, state.unknowns)
        if plan.is_solved:
            decision = self._follow_plan(estimate, frame, plan)
            unknowns = plan.unknowns
        else:
            decision = self._follow_line_of_sight(estimate, frame)
            unknowns = None
        command = self._limit_command(decision.command, last)
        is_saturated = abs(command.offset) >= self.max_offset - _SATURATION
        state_after = PredictiveState(
            progress=progress,
            observer=estimate,
            unknowns=unknowns,
            command=command,
            signals={
                "heading_ref": decision.heading_ref,
                "heading_used": self._mean_heading(estimate),
                **observed_frame.signals,
                **observer.signals(estimate),
                "frequency": command.frequency,
                "offset": command.offset,
                "is_saturated": float(is_saturated),
                "solver_iterations": float(plan.iterations),
                "is_fallback": float(not plan.is_solved),
            },
        )
        gait = replace(self.gait, frequency=command.frequency)
        return state_after, Command(gait=gait, offset=command.offset)

    def _plan_parameters(
        self, estimate: ObserverState, frame: PathFrame, last: PlannedCommand
    ) -> PlanParameters:
        """Return the parameters of a plan, in axes at the robot along the path.

        They do not depend on where in the world the path is.
        """
        mean = estimate.mean
        chi = frame.path_tangential_angle
        drift = _rotate(estimate.drift, -chi)
        psi = wrap_to_pi(float(mean[PSI]) - chi)
        speed = max(mean[SPEED] * math.cos(psi) + float(drift[0]), _SLOWEST * self.speed)
        return PlanParameters(
            state=np.array(
                [0.0, frame.cross_track_error, psi, mean[BEND], mean[SPEED], mean[SWAY]]
            ),
            drift=drift,
            command=np.array(last),
            path=self._path_ahead(frame, speed),
        )

    def _path_ahead(self, frame: PathFrame, speed: float) -> np.ndarray:
        """Return x, y and direction of the path where a robot of this speed is after every stage.

        Position and direction are relative to the nearest point of the path and the path there.
        """
        chi = frame.path_tangential_angle
        distances = frame.along_track_distance + speed * np.cumsum(self.stages)
        before = self.path.points(distances - _HALF_PIECE)
        after = self.path.points(distances + _HALF_PIECE)
        nearest = self.path.points(np.array([frame.along_track_distance]))[0]
        tangent = _rotate(after - before, -chi)
        position = _rotate(0.5 * (after + before) - nearest, -chi)
        direction = np.arctan2(tangent[:, 1], tangent[:, 0])
        direction = np.unwrap(np.concatenate(([0.0], direction)))[1:]
        return np.column_stack([position, direction])

    def _follow_plan(self, estimate: ObserverState, frame: PathFrame, plan: Plan) -> Decision:
        """Return the heading at the end of the first whole stage, and the plan's first command."""
        heading = self._mean_heading(estimate)
        psi = float(estimate.mean[PSI])
        planned_state = plan.states[1]
        planned_heading = float(planned_state[PSI] + self.model.bend * planned_state[BEND])
        psi_on_path = wrap_to_pi(psi - frame.path_tangential_angle)
        turn = planned_heading - psi_on_path - (heading - psi)
        frequency, offset = plan.commands[0].tolist()
        return Decision(heading + turn, PlannedCommand(frequency, offset))

    def _follow_line_of_sight(self, estimate: ObserverState, frame: PathFrame) -> Decision:
        """Return the heading and command of the law that replaces a plan."""
        heading = float(estimate.mean[PSI])
        law = guidance.LineOfSight(look_ahead_distance=self.look_ahead_distance)
        _, heading_ref = law.step(None, frame, heading, 0.0, False)
        controller = guidance.HeadingController(gain=self.gain, max_offset=self.max_offset)
        offset, _ = controller.offset(heading_ref=heading_ref, heading=heading)
        lowest_frequency, _ = self.frequencies
        return Decision(heading_ref, PlannedCommand(lowest_frequency, offset))

    def _mean_heading(self, estimate: ObserverState) -> float:
        """Return the mean heading, without the ripple [rad]."""
        return float(estimate.mean[PSI] + self.model.bend * estimate.mean[BEND])

    def _limit_command(self, command: PlannedCommand, last: PlannedCommand) -> PlannedCommand:
        """Clip a command exactly to its limits, which the solver only nearly meets."""
        low, high = self.frequencies
        frequency_step = self.frequency_rate * self.interval
        offset_step = self.offset_rate * self.interval
        frequency = _clip_change(command.frequency, last.frequency, frequency_step)
        offset = _clip_change(command.offset, last.offset, offset_step)
        return PlannedCommand(
            frequency=min(max(frequency, low), high),
            offset=min(max(offset, -self.max_offset), self.max_offset),
        )

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: Robot that is to follow the path.

        Raises:
            ValueError: If the largest offset could take a joint beyond its limit.
        """
        path_following.refuse_offset(robot, self.gait, self.max_offset)


def _clip_change(value: float, last_value: float, largest_change: float) -> float:
    """Return the nearest value that differs from the last one by no more than allowed."""
    return min(max(value, last_value - largest_change), last_value + largest_change)


def _rotate(points: np.ndarray, angle: float) -> np.ndarray:
    """Rotate one or more points by `angle` [rad]."""
    c = math.cos(angle)
    s = math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])
