"""The matrices of (1)-(2) against a solver of another structure, and the laws of swimming."""

import runpy
from dataclasses import fields, replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import printed_equations as eq
import pytest
from hypothesis import assume, given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from printed_equations import Chain, Options
from scipy.integrate import solve_ivp

from laticauda.water.fluid.laws import DragLaw, PolynomialDrag, TotalSpeedDrag

FORMS = ("relative", "kirchhoff", "classic")
NO_DRAG: dict[str, Any] = {"drag": PolynomialDrag(linear=False, quadratic=False)}
RANGES = {
    "half_length": (0.02, 0.2), "mass": (0.1, 2.0), "inertia": (1e-3, 1e-2), "c_t": (0.0, 2.0), "c_n": (0.0, 20.0),
    "mu_t": (0.0, 1.0), "mu_n": (0.0, 5.0), "lambda_1": (0.0, 1e-2), "lambda_2": (0.0, 1e-2), "lambda_3": (0.0, 1e-2),
}  # fmt: skip


class Problem(NamedTuple):
    """A chain in some state, with the loads on it."""

    chain: Chain
    options: Options
    theta: np.ndarray
    rate: np.ndarray
    velocity: np.ndarray
    joint_torque: np.ndarray
    joint_acceleration: np.ndarray
    prescribed: np.ndarray
    force: np.ndarray
    torque: np.ndarray

    @property
    def state(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, Chain, Options]:
        return self.theta, self.rate, self.velocity, self.chain, self.options

    def accelerations(self) -> tuple[np.ndarray, np.ndarray]:
        return eq.accelerations(*self.state, self.joint_torque, self.force, self.torque)

    def constrained(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return eq.constrained_accelerations(
            *self.state,
            self.joint_acceleration,
            self.force,
            self.torque,
            self.prescribed,
            self.joint_torque,
        )


def numbers(shape: Any, low: float, high: float) -> st.SearchStrategy[np.ndarray]:
    # A trailing edge sheds only where it moves forward: a speed that is next to nothing has no sign
    # in a moving frame.
    digits = st.floats(low, high, allow_subnormal=False).map(lambda number: round(number, 9))
    return arrays(np.float64, shape, elements=digits)


POLYNOMIAL = st.builds(
    PolynomialDrag, linear=st.booleans(), quadratic=st.booleans(), reference_speed=st.floats(0.1, 2.0),
    sway_friction=st.floats(0.0, 2.0),
)  # fmt: skip
LAWS = POLYNOMIAL | st.builds(TotalSpeedDrag, beta=st.floats(0.0, 1.0), gamma=st.floats(0.0, 1.0))


@st.composite
def problems(
    draw: st.DrawFn, forms: tuple[str, ...] = FORMS, wake: bool = True, least: int = 1,
    laws: st.SearchStrategy[DragLaw] = LAWS,
) -> Problem:  # fmt: skip
    n = draw(st.integers(least, 6))
    form = draw(st.sampled_from(forms))
    options = Options(
        form=form,
        drag=draw(laws),
        current=draw(numbers(2, -1.0, 1.0)),
        wake_mass=draw(st.sampled_from([0.0, 6.36])) if wake and form == "kirchhoff" else 0.0,
    )  # fmt: skip
    return Problem(
        chain=Chain(**{name: draw(numbers(n, *limits)) for name, limits in RANGES.items()}), options=options,
        theta=draw(numbers(n, -4.0, 4.0)), rate=draw(numbers(n, -5.0, 5.0)), velocity=draw(numbers(2, -2.0, 2.0)),
        joint_torque=draw(numbers(n - 1, -5.0, 5.0)), joint_acceleration=draw(numbers(n - 1, -20.0, 20.0)),
        prescribed=draw(arrays(np.bool_, n - 1)), force=draw(numbers((n, 2), -5.0, 5.0)),
        torque=draw(numbers(n, -1.0, 1.0)),
    )  # fmt: skip


def example(n: int, seed: int, **options: Any) -> Problem:
    """A moving chain with nothing driving it, the same on every call."""
    rng = np.random.default_rng(seed)
    none = np.zeros(n - 1)
    return Problem(
        chain=Chain(**{name: rng.uniform(*limits, n) for name, limits in RANGES.items()}), options=Options(**options),
        theta=rng.uniform(-1, 1, n), rate=rng.uniform(-2, 2, n), velocity=rng.uniform(-0.5, 0.5, 2), joint_torque=none,
        joint_acceleration=none, prescribed=none.astype(bool), force=np.zeros((n, 2)), torque=np.zeros(n),
    )  # fmt: skip


def assert_close(actual: np.ndarray, expected: np.ndarray, tolerance: float = 1e-9) -> None:
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * scale)


# --- The other solver: each link has its own x, y and theta; joints are constraints with Lagrange
# multipliers


def axes(angle: Any) -> np.ndarray:
    """Columns t_hat and n_hat."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def turning(function: Any, angle: float) -> np.ndarray:
    """Derivative by the angle, by a complex step."""
    return np.imag(function(angle + 1e-30j)) / 1e-30


def walk(
    chain: Chain, across: np.ndarray, along: np.ndarray, mean: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    """Vectors of the centers that differ from link to link by what a half link adds, and average to `mean`."""
    half = (
        np.array([axes(a) @ [t, n] for a, t, n in zip(theta, along, across, strict=True)])
        * chain.half_length[:, None]
    )
    values = np.zeros((len(theta), 2))
    for i in range(len(theta) - 1):
        values[i + 1] = values[i] + half[i] + half[i + 1]
    return values + mean - np.average(values, axis=0, weights=chain.mass)


def velocities(p: Problem) -> np.ndarray:
    return walk(p.chain, p.rate, np.zeros_like(p.rate), p.velocity, p.theta)


def loads(p: Problem, i: int, v: np.ndarray) -> tuple[np.ndarray, float]:
    """Force and torque of the fluid on link i, without what multiplies accelerations."""
    chain, options, rate = p.chain, p.options, p.rate[i]
    mu = np.diag([chain.mu_t[i], chain.mu_n[i]])
    R, dR = axes(p.theta[i]), turning(axes, p.theta[i])
    u = v - options.current
    drag: Any = options.drag
    along_axes = R.T @ u
    if isinstance(drag, TotalSpeedDrag):
        linear, quadratic = 0.0, 1.0
        growth = np.sqrt([[1.0, drag.gamma**2], [drag.beta**2, 1.0]] @ along_axes**2)
    else:
        linear, quadratic = drag.linear * drag.reference_speed, drag.quadratic
        growth = (
            linear
            + quadratic * np.abs(along_axes)
            + drag.sway_friction * np.array([abs(along_axes[1]), 0.0])
        )
    force = -R @ (np.array([chain.c_t[i], chain.c_n[i]]) * along_axes * growth)
    torque = -(chain.lambda_2[i] * linear + chain.lambda_3[i] * quadratic * abs(rate)) * rate
    if options.form == "kirchhoff":  # Lagrange's equations for T = 1/2 u^T R mu R^T u
        dA = turning(lambda angle: axes(angle) @ mu @ axes(angle).T, p.theta[i])
        force = force - rate * dA @ u
        torque = torque + u @ dA @ u / 2
    else:  # along each axis k: -mu_k k d(k . u)/dt, with only the current left of u in `classic`
        force = (
            force - R @ mu @ dR.T @ (u if options.form == "relative" else -options.current) * rate
        )
    if i == 0 and options.wake_mass > 0:
        arm = -chain.half_length[0] * R[:, 0]
        speed, sideways = R.T @ (u + rate * np.array([-arm[1], arm[0]]))
        if speed > 0:
            wake = options.wake_mass * (sideways**2 / 2 * R[:, 0] - speed * sideways * R[:, 1])
            force = force + wake
            torque = torque + arm[0] * wake[1] - arm[1] * wake[0]
    return force, torque


def maximal(p: Problem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta'', p'' and joint torques, from 3 n coordinates and as many constraints as there are."""
    n, chain = len(p.theta), p.chain
    mass, known, v = np.zeros((3 * n, 3 * n)), np.zeros(3 * n), velocities(p)
    for i in range(n):
        R, k = axes(p.theta[i]), slice(3 * i, 3 * i + 2)
        mass[k, k] = chain.mass[i] * np.eye(2) + R @ np.diag([chain.mu_t[i], chain.mu_n[i]]) @ R.T
        mass[3 * i + 2, 3 * i + 2] = chain.inertia[i] + chain.lambda_1[i]
        force, torque = loads(p, i, v[i])
        known[k], known[3 * i + 2] = force + p.force[i], torque + p.torque[i]
    rows, targets = [], []
    for j in range(n - 1):
        closed, hinge = np.zeros((2, 3 * n)), np.zeros(3 * n)
        target = np.zeros(2)
        for i, side in ((j, 1.0), (j + 1, -1.0)):  # r_j + l_j t_j = r_{j+1} - l_{j+1} t_{j+1}
            t_hat, n_hat = axes(p.theta[i]).T
            closed[:, 3 * i : 3 * i + 2] = side * np.eye(2)
            closed[:, 3 * i + 2] = chain.half_length[i] * n_hat
            target += chain.half_length[i] * p.rate[i] ** 2 * t_hat
            hinge[3 * i + 2] = -side
        rows.append(closed)
        targets.append(target)
        if p.prescribed[j]:
            rows.append(hinge[None])
            targets.append(np.array([p.joint_acceleration[j]]))
        else:
            known = known + hinge * p.joint_torque[j]
    G = np.vstack([np.zeros((0, 3 * n)), *rows])
    system = np.block([[mass, -G.T], [G, np.zeros((len(G), len(G)))]])
    solution = np.linalg.solve(system, np.concatenate([known, *targets]))
    q, multipliers = solution[: 3 * n].reshape(n, 3), list(solution[3 * n :])
    torques = p.joint_torque.copy()
    for j in range(n - 1):
        multipliers = multipliers[2:]
        if p.prescribed[j]:
            torques[j] = multipliers.pop(0)
    return q[:, 2], np.average(q[:, :2], axis=0, weights=chain.mass), torques


# --- The matrices against it ---


def sheds_or_not_clearly(p: Problem) -> bool:
    """Whether rounding cannot tip the scales: the force of the trailing edge jumps where it stops moving headward."""
    v = eq.link_velocities(p.theta, p.rate, p.velocity, p.chain)[0] - p.options.current
    u = v @ (np.cos(p.theta[0]), np.sin(p.theta[0]))
    return p.options.wake_mass == 0 or abs(u) > 1e-9


@given(problems())
@settings(max_examples=150)
def test_accelerations_agree_with_a_solver_in_maximal_coordinates(p: Problem):
    assume(sheds_or_not_clearly(p))
    theta, center, _ = maximal(p._replace(prescribed=np.zeros_like(p.prescribed)))
    for ours, other in zip(p.accelerations(), (theta, center), strict=True):
        assert_close(ours, other)


@given(problems())
@settings(max_examples=100)
def test_any_mixture_of_prescribed_and_free_joints_agrees_with_it_too(p: Problem):
    assume(sheds_or_not_clearly(p))
    for ours, other in zip(p.constrained(), maximal(p), strict=True):
        assert_close(ours, other)


@given(problems())
@settings(max_examples=30)
def test_all_joints_are_prescribed_unless_told_otherwise(p: Problem):
    expected = p._replace(prescribed=np.ones_like(p.prescribed)).constrained()
    actual = eq.constrained_accelerations(*p.state, p.joint_acceleration, p.force, p.torque)
    for ours, other in zip(actual, expected, strict=True):
        np.testing.assert_array_equal(ours, other)


@given(problems())
@settings(max_examples=50)
def test_the_torques_of_prescribed_joints_give_the_same_motion_in_the_free_model(p: Problem):
    theta, center, torque = p.constrained()
    free_theta, free_center = p._replace(joint_torque=torque).accelerations()
    assert_close(np.diff(theta)[p.prescribed], p.joint_acceleration[p.prescribed])
    assert_close(free_theta, theta)
    assert_close(free_center, center)


@given(problems())
@settings(max_examples=50)
def test_the_inertia_of_the_link_angles_is_symmetric_and_positive_definite(p: Problem):
    M = eq.matrices(p.theta, p.rate, p.chain, p.options).M_theta
    assert_close(M, M.T, 1e-12)
    assert np.all(np.linalg.eigvalsh(M) > 0)


@given(problems(least=2))
@settings(max_examples=50)
def test_positions_and_velocities_keep_the_joints_closed(p: Problem):
    assert_close(eq.link_velocities(*p.state[:4]), velocities(p), 1e-12)
    positions = eq.link_positions(p.theta, p.velocity, p.chain)
    assert_close(
        positions,
        walk(p.chain, np.zeros_like(p.rate), np.ones_like(p.rate), p.velocity, p.theta),
        1e-12,
    )


def split(values: np.ndarray, parts: int) -> np.ndarray:
    """The first link as equal strips, each with its share."""
    return np.concatenate([np.full(parts, values[0] / parts), values[1:]])


@given(problems(laws=POLYNOMIAL), st.integers(2, 6))
@settings(max_examples=50)
def test_a_link_equals_strips_with_locked_joints(p: Problem, parts: int):
    """The caudal fin as locked strips: with linear drag alone and strip theory nothing depends on their number."""
    c, n = p.chain, len(p.theta)
    share = {
        "inertia": c.mass,
        "lambda_1": c.mu_n,
        "lambda_2": c.c_n,
    }  # of each l^2/3 is the link's own
    length = split(c.half_length, parts)
    whole = replace(
        c,
        **{
            k: np.append(v[:1] * c.half_length[0] ** 2 / 3, getattr(c, k)[1:])
            for k, v in share.items()
        },
    )
    strips = Chain(**{f.name: split(getattr(whole, f.name), parts) for f in fields(Chain)})
    strips = replace(
        strips,
        **{
            k: np.append((split(v, parts) * length**2 / 3)[:parts], getattr(c, k)[1:])
            for k, v in share.items()
        },
    )
    locked = np.zeros(parts - 1)
    options = replace(p.options, drag=replace(p.options.drag, quadratic=False, sway_friction=0.0))

    one = p._replace(chain=whole, options=options, force=np.zeros((n, 2)))
    assume(sheds_or_not_clearly(one))
    # The offset between the centers of the fin and of its first strip does not matter: no force
    # acts on either.
    many = one._replace(
        chain=strips, theta=np.append(np.repeat(p.theta[0], parts - 1), p.theta), torque=split(p.torque, parts),
        rate=np.append(np.repeat(p.rate[0], parts - 1), p.rate), force=np.zeros((n + parts - 1, 2)),
        joint_torque=np.append(locked, p.joint_torque), joint_acceleration=np.append(locked, p.joint_acceleration),
        prescribed=np.append(np.ones(parts - 1, dtype=bool), p.prescribed),
    )  # fmt: skip
    theta, center, torque = one.constrained()
    strip_theta, strip_center, strip_torque = many.constrained()
    assert_close(strip_theta[parts - 1 :], theta)
    assert_close(strip_center, center)
    assert_close(strip_torque[parts - 1 :], torque)


# --- Laws ---


def stored_and_spent(p: Problem) -> tuple[float, float]:
    """Rate of the kinetic energy in the water's frame, and the power of joints and effectors there [W]."""
    theta, center = p.accelerations()
    c, u = p.chain, velocities(p) - p.options.current
    a = walk(c, theta, -(p.rate**2), center, p.theta)
    power = 0.0
    for i, angle in enumerate(p.theta):
        R, dR = axes(angle), turning(axes, angle)
        along_axes, rate_along_axes = R.T @ u[i], R.T @ a[i] + p.rate[i] * dR.T @ u[i]
        power += c.mass[i] * u[i] @ a[i] + along_axes @ (
            np.array([c.mu_t[i], c.mu_n[i]]) * rate_along_axes
        )
        power += (c.inertia[i] + c.lambda_1[i]) * p.rate[i] * theta[i]
    return power, float(p.joint_torque @ np.diff(p.rate) + np.sum(p.force * u) + p.torque @ p.rate)


@given(problems(forms=("relative", "kirchhoff")))
@settings(max_examples=100)
def test_power_of_joints_and_effectors_goes_into_kinetic_energy_drag_and_wake(p: Problem):
    stored, spent = stored_and_spent(p)
    lost = eq.dissipated_power(*p.state) + eq.wake_power(*p.state)
    assert abs(spent - stored - lost) <= 1e-9 * (1 + abs(spent) + abs(stored) + lost)


def test_classic_added_mass_makes_energy_out_of_nothing():
    stored, spent = stored_and_spent(example(4, 0, form="classic", **NO_DRAG))
    assert spent == 0
    assert abs(stored) > 0.01


@given(problems())
@settings(max_examples=50)
def test_the_kinetic_energy_is_that_of_links_and_added_mass_in_the_water(p: Problem):
    c, u = p.chain, velocities(p) - p.options.current
    energy = 0.0
    for i, angle in enumerate(p.theta):
        A = c.mass[i] * np.eye(2) + axes(angle) @ np.diag([c.mu_t[i], c.mu_n[i]]) @ axes(angle).T
        energy += (u[i] @ A @ u[i] + (c.inertia[i] + c.lambda_1[i]) * p.rate[i] ** 2) / 2
    assert eq.kinetic_energy(*p.state) == pytest.approx(energy, rel=1e-12)


@given(problems())
@settings(max_examples=100)
def test_drag_never_feeds_energy_to_the_robot(p: Problem):
    """By its forces on the links as well as by the number that states it."""
    still = p._replace(options=replace(p.options, form="relative", wake_mass=0.0))
    u = velocities(p) - p.options.current
    f_x, f_y, tau = eq.fluid_forces(*still.state)
    assert np.all(f_x * u[:, 0] + f_y * u[:, 1] <= 1e-12)
    assert np.all(tau == 0)
    assert eq.dissipated_power(*p.state) >= 0


# The module without the run-time shape checks: they would take twice as long as the thousands of
# calls of a run.
unchecked = SimpleNamespace(**runpy.run_path(eq.__file__))


def drift(p: Problem, duration: float = 3.0) -> tuple[float, float]:
    """Largest change of the energy [J] and of the momenta over a free run."""
    n, none = len(p.theta), np.zeros(len(p.theta) - 1)

    def rates(_t: float, y: np.ndarray) -> np.ndarray:
        theta, rate, velocity = y[:n], y[n : 2 * n], y[2 * n + 2 :]
        moving = unchecked.accelerations(
            theta, rate, velocity, p.chain, p.options, none, p.force, p.torque
        )
        return np.concatenate([rate, moving[0], velocity - p.options.current, moving[1]])

    def kept(y: np.ndarray) -> np.ndarray:
        theta, rate, position, velocity = y[:n], y[n : 2 * n], y[2 * n : 2 * n + 2], y[2 * n + 2 :]
        linear, angular = eq.momentum(theta, rate, position, velocity, p.chain, p.options)
        return np.array(
            [eq.kinetic_energy(theta, rate, velocity, p.chain, p.options), *linear, angular]
        )

    start = np.concatenate([p.theta, p.rate, [0.3, -0.2], p.velocity])
    times = np.linspace(0.0, duration, 30)
    run = solve_ivp(
        rates, (0.0, duration), start, method="DOP853", rtol=1e-11, atol=1e-11, t_eval=times
    )
    assert run.success
    change = np.abs(np.array([kept(y) for y in run.y.T]) - kept(start)).max(axis=0)
    return change[0], change[1:].max()


@given(n=st.integers(1, 3), seed=st.integers(0, 10**6))
@settings(max_examples=3)
def test_without_drag_kirchhoff_keeps_energy_and_momentum(n: int, seed: int):
    energy, momentum = drift(
        example(n, seed, form="kirchhoff", current=np.array([0.3, -0.2]), **NO_DRAG)
    )
    assert energy < 1e-8
    assert momentum < 1e-8


@given(n=st.integers(1, 3), seed=st.integers(0, 10**6))
@settings(max_examples=3)
def test_without_drag_relative_keeps_energy(n: int, seed: int):
    energy, _ = drift(example(n, seed, form="relative", current=np.array([0.3, -0.2]), **NO_DRAG))
    assert energy < 1e-8


def test_relative_does_not_keep_momentum():
    _, momentum = drift(example(3, 3, form="relative", **NO_DRAG), duration=1.0)
    assert momentum > 0.01


def carried_along(p: Problem, shift: np.ndarray) -> Problem:
    """The same swimmer and the same water, seen from a moving frame."""
    options = replace(p.options, current=p.options.current + shift)
    return p._replace(velocity=p.velocity + shift, options=options)


@given(problems(forms=("relative", "kirchhoff")), numbers(2, -3.0, 3.0))
@settings(max_examples=50)
def test_accelerations_do_not_depend_on_the_frame(p: Problem, shift: np.ndarray):
    for ours, other in zip(carried_along(p, shift).accelerations(), p.accelerations(), strict=True):
        assert_close(ours, other)


def test_in_the_classic_form_they_do():
    p = example(4, 0, form="classic")
    (theta, _), (other, _) = (
        p.accelerations(),
        carried_along(p, np.array([1.0, 0.0])).accelerations(),
    )
    assert np.max(np.abs(theta - other)) > 0.1


@given(problems(), st.floats(-3.0, 3.0))
@settings(max_examples=50)
def test_a_turned_world_turns_the_motion(p: Problem, angle: float):
    R = axes(angle)
    ahead = axes(p.theta[0])[:, 0] @ (velocities(p)[0] - p.options.current)
    assume(
        p.options.wake_mass == 0.0 or abs(ahead) > 1e-9
    )  # the wake begins where the trailing edge moves ahead
    options = replace(p.options, current=R @ p.options.current)
    turned = p._replace(
        theta=p.theta + angle, velocity=R @ p.velocity, force=p.force @ R.T, options=options
    )
    (theta, center), (turned_theta, turned_center) = p.accelerations(), turned.accelerations()
    assert_close(turned_theta, theta)
    assert_close(turned_center, R @ center)


@given(problems())
@settings(max_examples=50)
def test_a_mirrored_swimmer_moves_in_the_mirror(p: Problem):
    flip = np.array([1.0, -1.0])
    mirrored = p._replace(
        theta=-p.theta, rate=-p.rate, velocity=flip * p.velocity, joint_torque=-p.joint_torque, force=flip * p.force,
        torque=-p.torque, options=replace(p.options, current=flip * p.options.current),
    )  # fmt: skip
    (theta, center), (mirrored_theta, mirrored_center) = p.accelerations(), mirrored.accelerations()
    assert_close(mirrored_theta, -theta)
    assert_close(mirrored_center, flip * center)


# --- The trailing edge ---


def straight(speed: float, sideways: float, wake_mass: float) -> Problem:
    p = example(2, 0, form="kirchhoff", wake_mass=wake_mass, **NO_DRAG)
    return p._replace(theta=np.zeros(2), rate=np.zeros(2), velocity=np.array([speed, sideways]))


def test_the_wake_pushes_forward_and_against_the_sideways_motion():
    f_x, f_y, tau = eq.fluid_forces(*straight(2.0, 3.0, 5.0).state)
    without = eq.fluid_forces(*straight(2.0, 3.0, 0.0).state)
    assert f_x[0] - without[0][0] == pytest.approx(5 * 3**2 / 2)
    assert f_y[0] - without[1][0] == pytest.approx(-5 * 2 * 3)
    assert tau[0] - without[2][0] == pytest.approx(
        straight(2.0, 3.0, 5.0).chain.half_length[0] * 5 * 2 * 3
    )
    assert f_x[1] == without[0][1] and f_y[1] == without[1][1] and tau[1] == without[2][1]
    assert eq.wake_power(*straight(2.0, 3.0, 5.0).state) == pytest.approx(5 * 3**2 * 2 / 2)


@pytest.mark.parametrize("speed", [0.0, -2.0])
def test_there_is_no_wake_while_the_tail_does_not_move_forward(speed: float):
    with_wake, without = straight(speed, 3.0, 5.0), straight(speed, 3.0, 0.0)
    for ours, other in zip(
        eq.fluid_forces(*with_wake.state), eq.fluid_forces(*without.state), strict=True
    ):
        np.testing.assert_array_equal(ours, other)
    assert eq.wake_power(*with_wake.state) == 0


# --- Bad input ---


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": np.array([1.0, 0.0])}, r"`mass\[1\]` must be > 0, got 0.0\."),
        ({"half_length": np.array([-1.0, 1.0])}, r"`half_length\[0\]` must be > 0, got -1.0\."),
        ({"c_n": np.array([1.0, -2.0])}, r"`c_n\[1\]` must be >= 0, got -2.0\."),
        ({"mu_t": np.array([np.nan, 0.0])}, r"`mu_t\[0\]` must be a finite number, got nan\."),
        ({"mu_n": np.ones(3)}, r"`mu_n` must have one value per link, got shape \(3,\)\."),
    ],
)
def test_a_chain_refuses_what_no_chain_can_be(changes: dict[str, np.ndarray], message: str):
    with pytest.raises(ValueError, match=message):
        unchecked.Chain(**vars(example(2, 0).chain) | changes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"form": "kirchoff"},
            "`form` must be one of .*, got 'kirchoff'; did you mean `kirchhoff`?",
        ),
        (
            {"wake_mass": 1.0},
            r"`wake_mass` must be 0 kg/m unless `form` is `kirchhoff`, got 1\.0\.",
        ),
        ({"current": np.array([0.0, np.inf])}, "`current` must be 2 finite numbers in m/s"),
    ],
)
def test_options_refuse_what_does_not_exist(options: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        unchecked.Options(**options)
