"""The linearly implicit step: of second order, and damping what is stiff."""

import numpy as np
import pytest
from derivatives import check_compiled

from laticauda.models.dynamics.stages import (
    GAMMA,
    combined,
    implicit_inertia,
    joint_powers,
    second_torque,
)

INERTIA, DAMPING, STIFFNESS = 0.4, 0.3, 5.0


def swung(
    dt: float, duration: float = 1.0, stiffness: float = STIFFNESS, damping: float = DAMPING
) -> float:
    """Angle of a joint with a spring and a damper, from 1 rad."""
    angle, rate, gamma_dt = 1.0, 0.0, GAMMA * dt

    def torque(angle: float, rate: float) -> float:
        return -stiffness * angle - damping * rate

    for _ in range(round(duration / dt)):
        extra = implicit_inertia(stiffness, damping, gamma_dt)
        first = (torque(angle, rate) - gamma_dt * stiffness * rate) / (INERTIA + extra)
        first_rate = rate + gamma_dt * first
        ahead, ahead_rate = angle + dt * first_rate, rate + dt * first
        push = second_torque(
            torque(ahead, ahead_rate), stiffness, extra, ahead_rate, first_rate, first, gamma_dt
        )
        slopes = combined(ahead_rate, push / (INERTIA + extra), first_rate, first, gamma_dt)
        angle, rate = angle + dt * slopes[0], rate + dt * slopes[1]
    return angle


def test_a_swinging_joint_is_followed_with_order_two():
    decay, pull = DAMPING / (2.0 * INERTIA), STIFFNESS / INERTIA
    turn = np.sqrt(pull - decay**2)
    exact = np.exp(-decay) * (np.cos(turn) + decay / turn * np.sin(turn))
    steps = np.array([0.02, 0.01, 0.005])
    errors = [abs(swung(float(dt)) - exact) for dt in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.1)


def test_a_joint_far_stiffer_than_the_step_resolves_comes_to_rest():
    assert abs(swung(0.1, duration=3.0, stiffness=1e6, damping=1e4)) < 1e-3


def test_powers_are_the_size_the_signed_and_the_positive_one():
    assert joint_powers(2.0, -3.0) == (6.0, -6.0, 0.0)
    assert joint_powers(2.0, 3.0) == (6.0, 6.0, 6.0)


def test_compiled_they_give_the_same():
    check_compiled(combined, (0.3, -1.2, 0.5, 0.7, 0.01))
    check_compiled(second_torque, (0.3, 4.0, 0.01, 0.5, 0.7, -0.2, 0.01))
