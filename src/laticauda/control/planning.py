"""The door of CasADi and IPOPT: a plan over a horizon with the averaged model, solved from the last one.

Multiple shooting: the states at the stages and the commands between them are the unknowns, the model's step ties them
together. The problem is written once, for a structure that is fixed; numbers that change from one instant to the next
are its parameters.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportMissingTypeStubs=false

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from laticauda.extras import optional_import

if TYPE_CHECKING:
    from laticauda.control.predictive import ModelPredictive

Array = np.ndarray
_N_STATES, _N_COMMANDS = 6, 2
# An offset that wanders costs nothing in the model and wear on the robot: a little keeps it quiet [1/rad^2].
_OFFSET_CHANGE = 30.0
_FREQUENCY_CHANGE = 0.3


class Given(NamedTuple):
    """What changes: all in axes at the robot, along the path there."""

    state: Array
    """The six of the model."""
    drift: Array
    """x, y [m/s]."""
    command: Array
    """The last one: frequency [rad/s] and offset [rad]."""
    path: Array
    """For the end of every stage x, y [m] and direction [rad] of the path, one row each."""


class Plan(NamedTuple):
    """What came out."""

    commands: Array
    """Frequency [rad/s] and offset [rad] of every stage."""
    states: Array
    """Those of the model at the end of every stage."""
    unknowns: Array
    """All, to begin the next plan with."""
    is_solved: bool
    """Whether the solver says so and the commands are numbers."""
    iterations: int
    """How many it took."""


def plan(problem: "ModelPredictive", given: Given, begin: Array | None) -> Plan:
    """Solve one.

    Args:
        problem: The structure, whatever its path: its solver is built once.
        given: The numbers of this instant.
        begin: The unknowns of the last plan; None at the start.

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
    """IPOPT for the problem, with the limits of the unknowns and of the rules."""
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
        moved = model.after(tuple(before[i] for i in range(_N_STATES)), f, offset, dt, casadi.sin, casadi.cos)
        moved = casadi.vertcat(moved[0] + drift[0] * dt, moved[1] + drift[1] * dt, *moved[2:])
        ties.append(states[:, k] - moved)
        rates.append((commands[:, k] - held) / dt)
        powers.append(model.power(f, offset))
        cost += dt * _cost(problem, casadi, states[:, k], f, offset, drift, path[:, k])
        cost += _FREQUENCY_CHANGE * (f - held[0]) ** 2 + _OFFSET_CHANGE * (offset - held[1]) ** 2
    unknowns = casadi.vertcat(casadi.vec(states), casadi.vec(commands))
    rules = casadi.vertcat(*ties, *rates, *powers)
    parameters = casadi.vertcat(start, drift, last, casadi.vec(path))
    quiet = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False, "show_eval_warnings": False}
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
    return solver, low, high, np.concatenate([tied, -pace, -np.inf * np.ones(n)]), np.concatenate([tied, pace, most])


def _cost(problem: "ModelPredictive", casadi: Any, state: Any, f: Any, offset: Any, drift: Any, path: Any) -> Any:
    """What a second of it costs. Far from the path the distance counts in proportion, not squared."""
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
