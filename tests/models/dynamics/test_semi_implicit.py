"""The semi-implicit method of stiff joints: its order, its damping, and the parts of its first steps."""

import numpy as np
import pytest

from laticauda.models.dynamics.semi_implicit import (
    EXPLICIT_WEIGHTS,
    GAMMA,
    IMPLICIT_WEIGHTS,
    N_PARTS,
    N_STAGES,
    NODES,
    PARTS_PER_HALVING,
    WEIGHTS,
    length_of_part,
)

E = np.zeros((N_STAGES, N_STAGES))
E[:, :-1] = EXPLICIT_WEIGHTS
M = GAMMA * np.eye(N_STAGES)
M[:, :-1] += IMPLICIT_WEIGHTS
B = np.array(WEIGHTS)
C, D = E.sum(axis=1), M.sum(axis=1)


def damping(z: complex) -> complex:
    """Factor by which a step of the implicit half changes the solution of y' = z y."""
    ones = np.ones(N_STAGES)
    return 1.0 + z * (B @ np.linalg.solve(np.eye(N_STAGES) - z * M, ones))


def test_it_fulfils_the_conditions_of_order_three():
    assert B.sum() == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose([B @ C, B @ D], 1 / 2, atol=1e-14)
    np.testing.assert_allclose([B @ (C * C), B @ (C * D), B @ (D * D)], 1 / 3, atol=1e-14)
    np.testing.assert_allclose([B @ E @ C, B @ E @ D, B @ M @ C, B @ M @ D], 1 / 6, atol=1e-14)


def test_it_keeps_its_order_where_joints_are_stiff_beyond_measure():
    second_moments = np.linalg.solve(M, D * D)
    assert B @ E @ second_moments == pytest.approx(1 / 3, abs=1e-14)
    assert B @ (C * second_moments) == pytest.approx(2 / 3, abs=1e-14)


def test_its_implicit_half_damps_all_that_decays_and_forgets_what_is_stiff():
    for frequency in np.logspace(-2, 4, 100):
        assert abs(damping(1j * frequency)) <= 1.0
    assert abs(damping(-1e9)) < 1e-8


def test_explicit_states_follow_from_earlier_stages_only_and_the_last_implicit_one_is_the_end():
    assert np.all(np.triu(E) == 0.0)
    assert np.all(np.triu(M, 1) == 0.0)
    np.testing.assert_array_equal(M[-1], B)
    assert NODES[-1] == pytest.approx(1.0, abs=1e-15)


def swung(n_steps: int, stiffness: float, damping: float) -> float:
    """Angle after 1 s of a joint with a spring, a damper and a drag that is evaluated explicitly."""
    dt = 1.0 / n_steps
    angle, rate = 1.0, 0.0
    for _ in range(n_steps):
        rates, accelerations = np.zeros(N_STAGES), np.zeros(N_STAGES)
        for i in range(N_STAGES):
            explicit_rate = rate + dt * E[i] @ accelerations
            coast_rate = rate + dt * M[i] @ accelerations
            coast_angle = angle + dt * M[i] @ rates + GAMMA * dt * coast_rate
            push = (
                -stiffness * coast_angle - damping * coast_rate - abs(explicit_rate) * explicit_rate
            )
            added = GAMMA * dt * (damping + GAMMA * dt * stiffness)
            accelerations[i] = push / (1.0 + added)
            rates[i] = coast_rate + GAMMA * dt * accelerations[i]
        angle, rate = angle + dt * B @ rates, rate + dt * B @ accelerations
    return float(angle)


def test_a_swinging_joint_is_followed_with_order_three():
    steps = np.array([20, 40, 80])
    exact = swung(5000, stiffness=5.0, damping=0.3)
    errors = [abs(swung(n, stiffness=5.0, damping=0.3) - exact) for n in steps]
    assert np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0] == pytest.approx(3.0, abs=0.1)


def test_a_stiff_joint_is_followed_where_explicit_steps_would_be_unstable():
    exact = swung(5000, stiffness=30.0, damping=60.0)
    assert swung(20, stiffness=30.0, damping=60.0) == pytest.approx(exact, abs=2e-6)


@pytest.mark.parametrize("dt", [0.0125, 0.01, 0.003])
def test_the_parts_of_a_first_step_grow_and_add_up_to_it(dt):
    lengths = [length_of_part(part, N_PARTS, dt) for part in range(N_PARTS)]
    assert sum(lengths) == pytest.approx(dt, rel=1e-15)
    elapsed = np.cumsum(lengths)
    assert np.all(np.array(lengths[1:]) <= elapsed[:-1] / PARTS_PER_HALVING * (1.0 + 1e-12))
    assert length_of_part(0, 1, dt) == dt
