"""What holds for every flow, and a flow for tests of what swims in one."""

import numpy as np
import pytest

from laticauda.values.quantities import quantity, value_class
from laticauda.water.fluid.flow import Flow, FunctionFlow, Motion


def check_incompressible(flow, x, y, z, t):
    found = flow.motion(x, y, z, t)
    size = max(abs(one) for one in found[6:15])
    assert abs(found.u_x + found.v_y + found.w_z) <= 1e-10 * (1.0 + size)


def check_derivatives(flow, x, y, z, t, tolerance=2e-5):
    found = flow.motion(x, y, z, t)
    numerical = FunctionFlow(function=lambda *at: tuple(flow.motion(*at)[:3])).motion(x, y, z, t)
    size = max(abs(one) for one in found[:15])
    assert tuple(found[:15]) == pytest.approx(tuple(numerical[:15]), abs=tolerance * (1.0 + size))
    assert len(found) == len(Motion._fields)


@value_class
class Moving(Flow):
    """Waves of deep water along x, in water that moves with v_x + shear y + gain t, v_y + swing x + veer z.

    One for all tests of robots in water whose motion is known: its kernels take seconds, and are
    compiled once.
    """

    v_x: float = quantity("m/s", "velocity", default=0.0)
    v_y: float = quantity("m/s", "velocity", default=0.0)
    shear: float = quantity("1/s", "change of the velocity along x with y", default=0.0)
    swing: float = quantity("1/s", "change of the velocity along y with x", default=0.0)
    gain: float = quantity("m/s^2", "change of the velocity along x with time", default=0.0)
    veer: float = quantity("1/s", "change of the velocity along y with height", default=0.0)
    amplitude: float = quantity("m", "of the surface", default=0.0)
    k: float = quantity("1/m", "wave number", default=2.0)

    def __call__(self, x, y, z, t):
        k, a = self.k, self.amplitude
        omega = (9.81 * k) ** 0.5
        size, theta = a * omega * np.exp(k * z), k * x - omega * t
        c, s = size * np.cos(theta), size * np.sin(theta)
        o = 0.0 * c
        velocity = (
            self.v_x + self.shear * y + self.gain * t + c,
            self.v_y + self.swing * x + self.veer * z,
            s,
        )
        slopes = (-k * s, self.shear + o, k * c, self.swing + o, o, self.veer + o, k * c, o, k * s)
        return (*velocity, self.gain + omega * s, o, -omega * c, *slopes, a * np.cos(theta))
