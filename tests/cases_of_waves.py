"""Cases from the field about waves, and bodies in them; each has its source in tests/cases."""

import math
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import pytest
from cases_of_bodies import EXACT, FAST, GRAVITY, RHO, ball, run, wet_model
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.optimize import brentq

from laticauda.water.fluid.uniform import Uniform
from laticauda.water.fluid.waves import Sea, Waves, wave_number
from laticauda.water.mujoco import Element


def follow(flow: Any, start: tuple[float, float, float], duration: float) -> np.ndarray:
    """Where a particle of the water goes."""
    solved = solve_ivp(
        lambda t, at: flow.velocity(at, t), (0.0, duration), start, rtol=1e-10, atol=1e-12
    )
    return solved.y[:, -1]


def case_q09_wave_plus_current(_):
    wave = Waves(height=0.1, length=4.0)
    for flow in (wave, wave + Uniform(u=0.2)):
        handle = wet_model(ball(0.01, RHO, pos="0 0 -.5"), option=EXACT, surface=0.0, current=flow)
        data = mujoco.MjData(handle.model())
        data.qvel[:3] = flow.velocity(np.array([0.0, 0.0, -0.5]), 0.0)
        run(handle.model(), 8.0, data)
        np.testing.assert_allclose(data.qpos[:3], follow(flow, (0.0, 0.0, -0.5), 8.0), atol=1e-6)


def case_q12_surface_not_at_zero(_):
    ends: list[np.ndarray] = []
    for level in (0.0, 3.0):
        body = f"""<body name="b" pos="0 0 {level}"><freejoint/>
        <geom type="box" size=".2 .1 .05" density="500"/></body>"""
        handle = wet_model(body, option=FAST, surface=level, current=Waves(height=0.1, length=4.0))
        data = run(handle.model(), 20.0)
        ends.append(data.qpos - [0, 0, level, 0, 0, 0, 0])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-11)


def case_q13_dispersion(_):
    for period in (0.5, 1.0, 2.0, 4.0, 8.0, 15.0, 30.0):
        omega = 2.0 * math.pi / period
        for depth in (0.05, 0.3, 1.0, 5.0, 20.0, 100.0, 4000.0):

            def excess(k: float, depth: float = depth, omega: float = omega) -> float:
                return GRAVITY * k * math.tanh(k * depth) - omega**2

            k = brentq(excess, 1e-9, 10.0 * omega**2 / GRAVITY + 10.0 * omega, xtol=1e-18)
            assert wave_number(omega, depth) == pytest.approx(k, rel=1e-12)
    assert 2.0 * math.pi / wave_number(2.0 * math.pi / 8.0, 5.0) == pytest.approx(53.08, abs=0.01)


def surface_of(sea: Sea, times: np.ndarray) -> np.ndarray:
    """Elevation at the origin."""
    height = np.zeros(times.size)
    parts: tuple[Any, ...] = sea.parts
    for wave in parts:
        height += wave.amplitude * np.cos(wave.phase - wave.omega * times)
    return height


def case_q14_hs_from_surface(_):
    times = np.arange(0.0, 2000.0, 0.1)
    forms: list[dict[str, Any]] = [{}, {"depth": 1.0}, {"spread": 0.5}, {"components": 1000}]
    forms += [{"spectrum": "pierson_moskowitz", "seed": seed} for seed in range(6)]
    for form in forms:
        sea = Sea(significant_height=0.1, peak_period=2.0, **form)
        elevation = surface_of(sea, times)
        # 32 waves repeat late; of 1000, 2000 s are a sample.
        share = 0.01 if sea.components == 32 else 0.04
        assert 4.0 * np.std(elevation) == pytest.approx(0.1, rel=share)
    sea = Sea(significant_height=0.1, peak_period=2.0, components=1000)
    elevation = surface_of(sea, times)
    upward = np.count_nonzero((elevation[:-1] < 0.0) & (elevation[1:] >= 0.0))
    assert times[-1] / upward == pytest.approx(1.639, rel=0.02)


def case_q16_morison_fixed_cylinder(_):
    """C_M 2 with the material acceleration, C_D 1.2; upright, a piece of 0.1 m, 0.3 m deep."""
    radius, length = 0.05, 0.1
    section = math.pi * radius**2 * length
    across = RHO * 1.2 * radius * length
    held = (
        '<body name="b"><joint type="slide" axis="1 0 0" armature="1e15"/><geom size=".1"/></body>'
    )
    element = Element(
        body="b",
        position=(0.0, 0.0, -0.3),
        orientation=(0.5**0.5, 0.0, -(0.5**0.5), 0.0),
        drag=(0.0, across, across),
        added_mass=(0.0, RHO * section, RHO * section),
        volume=section,
        shape="cylinder",
        half_size=(0.5 * length, radius, radius),
    )
    for depth in (math.inf, 1.0):
        wave = Waves(height=0.1, length=4.0, depth=depth)
        with pytest.warns(UserWarning, match="has buoyancy but no free joint"):
            handle = wet_model(held, [element], surface=0.0, current=wave)
        data = mujoco.MjData(handle.model())
        k, omega = math.pi / 2.0, wave.omega
        assert omega**2 == pytest.approx(GRAVITY * k * math.tanh(k * min(depth, 100.0)))
        if depth == math.inf:
            along = upward = 0.05 * omega * math.exp(-0.3 * k)
        else:
            scale = 0.05 * omega / math.sinh(k * depth)
            along = scale * math.cosh(k * (depth - 0.3))
            upward = scale * math.sinh(k * (depth - 0.3))
        found, right = np.zeros(24), np.zeros(24)
        for i in range(24):
            data.time = i / 24 * 2.0 * math.pi / omega
            phase = omega * data.time
            u, w = along * math.cos(phase), -upward * math.sin(phase)
            rate = omega * along * -math.sin(phase)  # of u with time; then what the water carries
            rate += u * (k * along * math.sin(phase)) + w * (k * upward * math.cos(phase))
            right[i] = RHO * section * 2.0 * rate + across * abs(u) * u
            loads = handle.forces(data)
            found[i] = loads["drag"][0, 0] + loads["added_mass"][0, 0]
        assert np.max(np.abs(right)) > 0.5
        np.testing.assert_allclose(found, right, atol=1e-9 * np.max(np.abs(right)))


def energy_below(sea: Sea, frequency: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Share of a whole spectrum's energy below some frequencies, by its formula."""
    relative = grid * sea.peak_period / (2.0 * math.pi)
    width = np.where(relative > 1.0, 0.09, 0.07)
    density = grid**-5.0 * np.exp(-1.25 * relative**-4.0)
    if sea.spectrum == "jonswap":
        density *= 3.3 ** np.exp(-((relative - 1.0) ** 2) / (2.0 * width**2))
    total = cumulative_trapezoid(density, grid, initial=0.0)
    return np.interp(frequency, grid, total / total[-1])


def case_q30_raschii_wavespectra(_):
    """Against the formulas that raschii (Airy) and wavespectra have; both are no part of the tests' environment."""
    for depth in (0.3, 1.0, 50.0):
        wave = Waves(height=0.02, length=2.0, depth=depth)
        k, omega, a = math.pi, wave.omega, 0.01
        for x, z, t in ((0.0, -0.05, 0.0), (0.3, -0.2, 0.7), (1.1, 0.0, 2.2)):
            phase = k * x - omega * t
            scale = a * omega / math.sinh(k * depth)
            u = scale * math.cosh(k * (z + depth)) * math.cos(phase)
            w = scale * math.sinh(k * (z + depth)) * math.sin(phase)
            motion = wave.motion(x, 0.0, z, t)
            found = (motion.u, motion.w, motion.elevation)
            assert found == pytest.approx((u, w, a * math.cos(phase)), abs=1e-13)
    for spectrum, share in (("jonswap", 0.015), ("pierson_moskowitz", 0.02)):
        sea = Sea(significant_height=0.1, peak_period=2.0, spectrum=spectrum, components=1000)
        parts: tuple[Any, ...] = sea.parts
        frequency = np.sort([wave.omega for wave in parts])
        grid = np.linspace(0.3, 60.0, 200_000)
        below = energy_below(sea, frequency, grid)
        drawn = (np.arange(1000) + 0.5) / 1000.0
        assert np.max(np.abs(drawn - below)) < share


WAVES: dict[str, Callable[..., None]] = {
    name: value for name, value in globals().items() if name.startswith("case_")
}
