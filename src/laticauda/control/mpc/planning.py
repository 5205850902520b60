"""Optimal plan of the next seconds: its problem, stated for CasADi, and its solution by IPOPT.

Multiple shooting: the states at the ends of the stages and the commands during them are the
unknowns, tied together by the model's step. The solver is built once for a `PlanProblem`; numbers
that change from one plan to the next, `PlanParameters`, are its parameters. A solution is the
initial guess of the next plan.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.averaged import AveragedModel
from laticauda.control.current import N_MOTION
from laticauda.values import optional_import

Array = np.ndarray

N_COMMANDS = 2
"""Numbers of a command: frequency [rad/s] and offset [rad]."""
OFFSET_CHANGE_COST = 30.0
"""Cost of a change of the offset, squared [1/rad^2].

In the model, a wandering offset costs nothing, but it wears the robot: a small cost keeps it
steady.
"""
FREQUENCY_CHANGE_COST = 0.3
"""Likewise of a change of the frequency [s^2/rad^2]."""

SOLVER_OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "show_eval_warnings": False,
    "ipopt.tol": 1e-4,
    "ipopt.mu_init": 1e-2,
    "ipopt.warm_start_init_point": "yes",
    "ipopt.mu_strategy": "monotone",
}
"""Quiet; started from the last plan, which is good, so the barrier is small from the beginning."""


@dataclass(frozen=True, kw_only=True)
class PlanProblem:
    """What stays the same from plan to plan; see `ModelPredictive`, which has the same fields."""

    model: AveragedModel
    """Model of gait and robot."""
    stages: tuple[float, ...]
    """Durations for which a plan holds each command [s]."""
    speed: float
    """Desired speed along the path [m/s]."""
    lowest_frequency: float
    """Lowest frequency [rad/s]."""
    highest_frequency: float
    """Highest frequency [rad/s]."""
    max_offset: float
    """Largest offset to either side [rad]."""
    power_limit: float
    """Largest mean power over a cycle [W]."""
    offset_rate: float
    """Largest rate of change of the offset [rad/s]."""
    frequency_rate: float
    """Largest rate of change of the frequency [rad/s^2]."""
    cross_track_tolerance: float
    """Distance from the path that costs 1 per second [m]."""
    course_tolerance: float
    """Angle between course and path that costs 1 per second [rad]."""
    speed_tolerance: float
    """Lack of speed that costs 1 per second [m/s]."""
    power_tolerance: float
    """Power that costs 1 per second [W]."""
    iterations: int
    """Most solver iterations per plan."""


class PlanParameters(NamedTuple):
    """Numbers that change from plan to plan, all in axes at the robot, along the path there."""

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


class _Bounds(NamedTuple):
    """Lowest and highest values of the solver's unknowns, or of its constraints."""

    low: Array
    high: Array


class _Solver(NamedTuple):
    """IPOPT solver of a problem."""

    function: Any
    """CasADi function that solves for one plan."""
    unknowns: _Bounds
    """Bounds of the unknowns: all states, then all commands."""
    constraints: _Bounds
    """Bounds of the constraints: steps of the model, then rates of the commands, then powers."""


def solve_plan(problem: PlanProblem, parameters: PlanParameters, guess: Array | None) -> Plan:
    """Solve for one plan.

    Args:
        problem: What stays the same from plan to plan; its solver is built once.
        parameters: Parameters at this instant.
        guess: Unknowns of the last plan; None at the start.

    Raises:
        MissingExtra: If CasADi is not installed.
    """
    solver = _build_solver(problem)
    n = len(problem.stages)
    if guess is None:
        states = np.tile(parameters.state, n)
        commands = np.tile(parameters.command, n)
        guess = np.concatenate([states, commands])
    solution = solver.function(
        x0=guess,
        p=np.concatenate(
            [parameters.state, parameters.drift, parameters.command, parameters.path.ravel()]
        ),
        lbx=solver.unknowns.low,
        ubx=solver.unknowns.high,
        lbg=solver.constraints.low,
        ubg=solver.constraints.high,
    )
    statistics = solver.function.stats()
    unknowns = np.asarray(solution["x"]).ravel()
    is_finite = bool(np.all(np.isfinite(unknowns)))
    states, commands = np.split(unknowns, [N_MOTION * n])
    return Plan(
        commands=commands.reshape(n, N_COMMANDS),
        states=states.reshape(n, N_MOTION),
        unknowns=unknowns,
        is_solved=bool(statistics["success"]) and is_finite,
        iterations=int(statistics["iter_count"]),
    )


@cache
def _build_solver(problem: PlanProblem) -> _Solver:
    """Build the IPOPT solver of the problem, with the bounds of the unknowns and constraints."""
    casadi: Any = optional_import("Model-predictive control", "CasADi", "mpc", "casadi")
    n = len(problem.stages)
    states = casadi.SX.sym("x", N_MOTION, n)
    commands = casadi.SX.sym("u", N_COMMANDS, n)
    first_state = casadi.SX.sym("x0", N_MOTION)
    drift = casadi.SX.sym("v", 2)
    first_command = casadi.SX.sym("u0", N_COMMANDS)
    path = casadi.SX.sym("path", 3, n)

    cost: Any = 0.0
    steps: list[Any] = []
    rates: list[Any] = []
    powers: list[Any] = []
    state_before, command_before = first_state, first_command
    for k, dt in enumerate(problem.stages):
        state, command = states[:, k], commands[:, k]
        f, offset = commands[0, k], commands[1, k]
        steps.append(state - _advance_state(problem, casadi, state_before, f, offset, drift, dt))
        rates.append((command - command_before) / dt)
        powers.append(problem.model.power(f, offset))
        cost += dt * _cost_rate(problem, casadi, state, f, offset, drift, path[:, k])
        f_change = f - command_before[0]
        offset_change = offset - command_before[1]
        cost += FREQUENCY_CHANGE_COST * f_change**2 + OFFSET_CHANGE_COST * offset_change**2
        state_before, command_before = state, command

    statement = {
        "x": casadi.vertcat(casadi.vec(states), casadi.vec(commands)),
        "p": casadi.vertcat(first_state, drift, first_command, casadi.vec(path)),
        "f": cost,
        "g": casadi.vertcat(*steps, *rates, *powers),
    }
    options = SOLVER_OPTIONS | {"ipopt.max_iter": problem.iterations}
    return _Solver(
        function=casadi.nlpsol("plan", "ipopt", statement, options),
        unknowns=_bound_unknowns(problem),
        constraints=_bound_constraints(problem),
    )


def _bound_unknowns(problem: PlanProblem) -> _Bounds:
    """Return the bounds of the unknowns: states are free, commands stay within their limits."""
    n = len(problem.stages)
    free = np.full(N_MOTION * n, np.inf)
    lowest = np.tile([problem.lowest_frequency, -problem.max_offset], n)
    highest = np.tile([problem.highest_frequency, problem.max_offset], n)
    return _Bounds(low=np.concatenate([-free, lowest]), high=np.concatenate([free, highest]))


def _bound_constraints(problem: PlanProblem) -> _Bounds:
    """Return the bounds of the constraints: steps are exact, rates and powers limited."""
    n = len(problem.stages)
    exact = np.zeros(N_MOTION * n)
    rates = np.tile([problem.frequency_rate, problem.offset_rate], n)
    powers = np.full(n, problem.power_limit)
    return _Bounds(
        low=np.concatenate([exact, -rates, -np.inf * np.ones(n)]),
        high=np.concatenate([exact, rates, powers]),
    )


def _advance_state(
    problem: PlanProblem, casadi: Any, state: Any, f: Any, offset: Any, drift: Any, dt: float
) -> Any:
    """Return the state after one stage, in water that moves."""
    components = tuple(state[i] for i in range(N_MOTION))
    x, y, *velocities_and_angles = problem.model.after(
        components, f, offset, dt, casadi.sin, casadi.cos
    )
    return casadi.vertcat(x + drift[0] * dt, y + drift[1] * dt, *velocities_and_angles)


def _cost_rate(
    problem: PlanProblem, casadi: Any, state: Any, f: Any, offset: Any, drift: Any, path: Any
) -> Any:
    """Return the cost per second. Far from the path, the distance counts linearly."""
    x, y, heading, _, forward_velocity, sideways_velocity = (state[i] for i in range(N_MOTION))
    path_x, path_y, path_angle = path[0], path[1], path[2]
    cos_path, sin_path = casadi.cos(path_angle), casadi.sin(path_angle)
    cross_track_error = cos_path * (y - path_y) - sin_path * (x - path_x)

    # The velocity over ground, drift included, along the path and across it.
    c, s = casadi.cos(heading - path_angle), casadi.sin(heading - path_angle)
    swum_along = forward_velocity * c - sideways_velocity * s
    swum_across = forward_velocity * s + sideways_velocity * c
    along = swum_along + drift[0] * cos_path + drift[1] * sin_path
    across = swum_across + drift[1] * cos_path - drift[0] * sin_path

    distance_share = cross_track_error / problem.cross_track_tolerance
    cost = 2.0 * (casadi.sqrt(1.0 + distance_share**2) - 1.0)
    cost += (across / problem.speed / problem.course_tolerance) ** 2
    cost += ((problem.speed - along) / problem.speed_tolerance) ** 2
    return cost + problem.model.power(f, offset) / problem.power_tolerance
