"""Model-predictive path following: at every instant, plan the next seconds and carry out the start of the best plan.

A plan is solved by CasADi and IPOPT, starting from the last one. Multiple shooting: the states at
the stages and the commands between them are the unknowns, tied together by the model's step. The
problem is built once for a fixed structure; numbers that change from one instant to the next are
its parameters.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np

from laticauda.control import averaged, guidance, path_following, paths
from laticauda.control.current import BEND, PSI, SPEED, SWAY, CurrentObserver, ObserverState, X, Y
from laticauda.control.frames import Path, PathFrame
from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios.interfaces import Command, Controller, Observation
from laticauda.values.angles import wrap_to_pi
from laticauda.values.checks import check_positive
from laticauda.values.errors import BadArgument
from laticauda.values.optional import optional_import
from laticauda.values.quantities import option, quantity, value_class

Array = np.ndarray
_N_STATES, _N_COMMANDS = 6, 2
# In the model, a wandering offset costs nothing, but it wears the robot: a small cost keeps it
# steady [1/rad^2].
_OFFSET_CHANGE = 30.0
_FREQUENCY_CHANGE = 0.3


class PlanParameters(NamedTuple):
    """Parameters that change from plan to plan, all in axes at the robot, along the path there."""

    state: Array
    """The six states of the model."""
    drift: Array
    """Drift x, y [m/s]."""
    command: Array
    """Last command: frequency [rad/s] and offset [rad]."""
    path: Array
    """One row x, y [m] and direction [rad] of the path for the end of every stage."""


class Plan(NamedTuple):
    """Result of the solver."""

    commands: Array
    """Frequency [rad/s] and offset [rad] of every stage."""
    states: Array
    """States of the model at the end of every stage."""
    unknowns: Array
    """All unknowns, the initial guess of the next plan."""
    is_solved: bool
    """Whether the solver reports success and the commands are finite."""
    iterations: int
    """Number of iterations."""


def solve_plan(problem: "ModelPredictive", given: PlanParameters, begin: Array | None) -> Plan:
    """Solve for one plan.

    Args:
        problem: Structure of the problem, independent of its path; its solver is built once.
        given: Parameters at this instant.
        begin: Unknowns of the last plan; None at the start.

    Raises:
        MissingExtra: If CasADi is not installed.
    """
    solver, low, high, rule_low, rule_high = _solver(problem)
    n = len(problem.stages)
    parameters = np.concatenate([given.state, given.drift, given.command, given.path.ravel()])
    if begin is None:
        begin = np.concatenate([np.tile(given.state, n), np.tile(given.command, n)])
    found = solver(x0=begin, p=parameters, lbx=low, ubx=high, lbg=rule_low, ubg=rule_high)
    unknowns = np.asarray(found["x"]).ravel()
    stats = solver.stats()
    is_solved = bool(stats["success"]) and bool(np.all(np.isfinite(unknowns)))
    states, commands = np.split(unknowns, [_N_STATES * n])
    each = commands.reshape(n, _N_COMMANDS), states.reshape(n, _N_STATES)
    return Plan(*each, unknowns, is_solved, int(stats["iter_count"]))


@cache
def _solver(problem: "ModelPredictive") -> tuple[Any, Array, Array, Array, Array]:
    """Build the IPOPT solver of the problem, with the bounds of the unknowns and constraints."""
    casadi = optional_import("Model-predictive control", "CasADi", "mpc", "casadi")
    n, model = len(problem.stages), problem.model
    states, commands = casadi.SX.sym("x", _N_STATES, n), casadi.SX.sym("u", _N_COMMANDS, n)
    start, drift = casadi.SX.sym("x0", _N_STATES), casadi.SX.sym("v", 2)
    last, path = casadi.SX.sym("u0", _N_COMMANDS), casadi.SX.sym("path", 3, n)
    cost: Any = 0.0
    ties: list[Any] = []
    rates: list[Any] = []
    powers: list[Any] = []
    for k, dt in enumerate(problem.stages):
        before = start if k == 0 else states[:, k - 1]
        held = last if k == 0 else commands[:, k - 1]
        f, offset = commands[0, k], commands[1, k]
        moved = model.after(
            tuple(before[i] for i in range(_N_STATES)), f, offset, dt, casadi.sin, casadi.cos
        )
        moved = casadi.vertcat(moved[0] + drift[0] * dt, moved[1] + drift[1] * dt, *moved[2:])
        ties.append(states[:, k] - moved)
        rates.append((commands[:, k] - held) / dt)
        powers.append(model.power(f, offset))
        cost += dt * _cost(problem, casadi, states[:, k], f, offset, drift, path[:, k])
        cost += _FREQUENCY_CHANGE * (f - held[0]) ** 2 + _OFFSET_CHANGE * (offset - held[1]) ** 2
    unknowns = casadi.vertcat(casadi.vec(states), casadi.vec(commands))
    rules = casadi.vertcat(*ties, *rates, *powers)
    parameters = casadi.vertcat(start, drift, last, casadi.vec(path))
    quiet = {
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "print_time": False,
        "show_eval_warnings": False,
    }
    effort = {"ipopt.max_iter": problem.iterations, "ipopt.tol": 1e-4, "ipopt.mu_init": 1e-2}
    warm = {"ipopt.warm_start_init_point": "yes", "ipopt.mu_strategy": "monotone"}
    stated = {"x": unknowns, "p": parameters, "f": cost, "g": rules}
    solver = casadi.nlpsol("plan", "ipopt", stated, quiet | effort | warm)
    free = np.full(_N_STATES * n, np.inf)
    low = np.concatenate([-free, np.tile([problem.frequencies[0], -problem.max_offset], n)])
    high = np.concatenate([free, np.tile([problem.frequencies[1], problem.max_offset], n)])
    pace = np.tile([problem.frequency_rate, problem.offset_rate], n)
    tied = np.zeros(_N_STATES * n)
    most = np.full(n, problem.power_limit)
    return (
        solver,
        low,
        high,
        np.concatenate([tied, -pace, -np.inf * np.ones(n)]),
        np.concatenate([tied, pace, most]),
    )


def _cost(
    problem: "ModelPredictive", casadi: Any, state: Any, f: Any, offset: Any, drift: Any, path: Any
) -> Any:
    """Return the cost per second. Far from the path, the distance counts linearly, not quadratically."""
    x, y, psi, _, u, w = (state[i] for i in range(_N_STATES))
    c, s = casadi.cos(psi - path[2]), casadi.sin(psi - path[2])
    cp, sp = casadi.cos(path[2]), casadi.sin(path[2])
    error = cp * (y - path[1]) - sp * (x - path[0])
    along = u * c - w * s + drift[0] * cp + drift[1] * sp
    across = u * s + w * c + drift[1] * cp - drift[0] * sp
    total = 2.0 * (casadi.sqrt(1.0 + (error / problem.cross_track_tolerance) ** 2) - 1.0)
    total += (across / problem.speed / problem.course_tolerance) ** 2
    total += ((problem.speed - along) / problem.speed_tolerance) ** 2
    return total + problem.model.power(f, offset) / problem.power_tolerance


# ---- the controller ------------------------------------------------------------------------------

_LEAST_INTERVAL = 0.2  # allows the solver enough time [s]
_SLOWEST = 0.2  # lower bound of the speed used to look ahead along the path, as a fraction of the requested speed


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictiveState:
    """State of the controller, and its last signals."""

    progress: Any
    """Progress along the path."""
    seen: ObserverState | None = None
    """Estimated state of the robot; None before the first instant."""
    unknowns: np.ndarray | None = None
    """Unknowns of the last plan found, the initial guess of the next."""
    command: tuple[float, float] = (0.0, 0.0)
    """Frequency [rad/s] and offset [rad] of the last command."""
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
    """Controller that plans offset and frequency with the averaged model, and thus takes a current into account.

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
        least = max(self.model.power(low, offset) for offset in (0.0, self.max_offset))
        if not self.power_limit >= least:
            rule = f"must be >= {least:.4g} W, the power at the lowest frequency with the largest offset"
            raise BadArgument("power_limit", f"{rule}, got {self.power_limit}")

    @property
    def frequencies(self) -> tuple[float, float]:
        """Least and greatest frequency [rad/s]."""
        return self.frequency_limits or (self.gait.frequency, self.gait.frequency)

    @property
    def stages(self) -> tuple[float, ...]:
        """Durations for which a plan holds each command [s]."""
        return (self.interval, *(self.stage,) * self.horizon)

    @cached_property
    def _problem(self) -> "ModelPredictive":
        """Part that stays the same from plan to plan: all but the path, which may not be hashable."""
        return replace(self, path=paths.StraightLine())

    def init(self) -> PredictiveState:
        """Return the state before the first control instant."""
        return PredictiveState(progress=self.path.init(), command=(self.gait.frequency, 0.0))

    def step(
        self, state: PredictiveState, observation: Observation
    ) -> tuple[PredictiveState, Command]:
        """Return the `state` after the `observation`, and the command until the next control instant.

        Args:
            state: State returned by the last control instant or by `init`.
            observation: Current observation of the robot.
        """
        observer = CurrentObserver(model=self.model)
        seen = observer.step(state.seen, *state.command, observation)
        # The plan starts from the filter's position: the center of mass swings across its course
        # with the gait.
        progress, frame = self.path.locate(state.progress, seen.mean[[X, Y]])
        _, raw = self.path.locate(progress, observation.center_of_mass[:2])
        found = solve_plan(self._problem, self._given(seen, frame, state.command), state.unknowns)
        is_fallback = not found.is_solved
        heading_ref, wanted = (
            self._line_of_sight(seen, frame) if is_fallback else self._first(seen, frame, found)
        )
        frequency, offset = self._limited(wanted, state.command)
        after = PredictiveState(
            progress=progress,
            seen=seen,
            unknowns=None if is_fallback else found.unknowns,
            command=(frequency, offset),
            signals={
                # Desired mean heading: the plan's after its first step, or that of line-of-sight
                # guidance.
                "heading_ref": heading_ref,
                "heading_used": self._heading(seen),
                **raw.signals,
                **observer.signals(seen),
                "frequency": frequency,
                "offset": offset,
                "is_saturated": float(abs(offset) >= self.max_offset - 1e-9),
                "solver_iterations": float(found.iterations),
                "is_fallback": float(is_fallback),
            },
        )
        return after, Command(gait=replace(self.gait, frequency=frequency), offset=offset)

    def _given(
        self, seen: ObserverState, frame: PathFrame, last: tuple[float, float]
    ) -> PlanParameters:
        """Return the parameters of a plan, in axes at the robot along the path, independent of where the path is."""
        chi = frame.path_tangential_angle
        drift, mean = _turned(seen.drift, -chi), seen.mean
        psi = wrap_to_pi(float(mean[PSI]) - chi)
        pace = max(mean[SPEED] * math.cos(psi) + float(drift[0]), _SLOWEST * self.speed)
        ahead = frame.along_track_distance + pace * np.cumsum(self.stages)
        # Ends of a short piece around each point give its position and direction.
        piece = 0.01
        before, after = (self.path.points(ahead + sign * piece) for sign in (-1.0, 1.0))
        foot = self.path.points(np.array([frame.along_track_distance]))[0]
        tangent = _turned(after - before, -chi)
        place = _turned(0.5 * (after + before) - foot, -chi)
        direction = np.arctan2(tangent[:, 1], tangent[:, 0])
        return PlanParameters(
            state=np.array(
                [0.0, frame.cross_track_error, psi, mean[BEND], mean[SPEED], mean[SWAY]]
            ),
            drift=drift,
            command=np.array(last),
            path=np.column_stack([place, np.unwrap(np.concatenate(([0.0], direction)))[1:]]),
        )

    def _first(
        self, seen: ObserverState, frame: PathFrame, found: Plan
    ) -> tuple[float, tuple[float, float]]:
        """Return the heading at the end of the first whole stage, and the command until the next instant."""
        now, psi = self._heading(seen), float(seen.mean[PSI])
        ahead = float(found.states[1, PSI] + self.model.bend * found.states[1, BEND])
        turn = ahead - wrap_to_pi(psi - frame.path_tangential_angle) - (now - psi)
        return now + turn, (float(found.commands[0, 0]), float(found.commands[0, 1]))

    def _line_of_sight(
        self, seen: ObserverState, frame: PathFrame
    ) -> tuple[float, tuple[float, float]]:
        """Return the heading and command of the fallback law."""
        heading = float(seen.mean[PSI])
        law = guidance.LineOfSight(look_ahead_distance=self.look_ahead_distance)
        _, asked = law.step(None, frame, heading, 0.0, False)
        turns = guidance.HeadingController(gain=self.gain, max_offset=self.max_offset)
        return asked, (self.frequencies[0], turns.offset(heading_ref=asked, heading=heading)[0])

    def _heading(self, seen: ObserverState) -> float:
        """Return the mean heading, without the ripple [rad]."""
        return float(seen.mean[PSI] + self.model.bend * seen.mean[BEND])

    def _limited(
        self, wanted: tuple[float, float], last: tuple[float, float]
    ) -> tuple[float, float]:
        """Clip a command exactly to its limits, which the solver meets only within its tolerance."""
        low, high = self.frequencies
        pace = self.frequency_rate * self.interval, self.offset_rate * self.interval
        f, offset = (min(max(w, b - p), b + p) for w, b, p in zip(wanted, last, pace, strict=True))
        return min(max(f, low), high), min(max(offset, -self.max_offset), self.max_offset)

    def check(self, robot: Robot) -> None:
        """Reject a robot whose joints cannot bend as far as gait and steering together may require.

        Args:
            robot: Robot that is to follow the path.

        Raises:
            ValueError: If the largest offset could take a joint beyond its limit.
        """
        path_following.refuse_offset(robot, self.gait, self.max_offset)


def _turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Rotate one or more points by `angle` [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])
