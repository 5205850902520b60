"""What holds for every flow."""

import pytest

from laticauda.fluid.flow import FunctionFlow, Motion


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
