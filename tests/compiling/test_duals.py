"""Derivatives that the kernels carry along are those of dual numbers."""

from dataclasses import replace

import numpy as np
import pytest
from dualnumbers import Dual, python_kernels
from numba import njit

import laticauda as lc
from laticauda.compiling import (
    PROCESSOR,
    compile_scalar,
    functions,
    inner,
    lane_types,
    lanes,
)
from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant, specialize
from laticauda.motion.joints import JointLaw
from laticauda.robot import PectoralFin, Tether, load_robot, load_water
from laticauda.scenarios import Planar
from laticauda.scenarios.interfaces import Command, Start

WIDTH = 8
STEP = 2.0**-100
GAIT = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7, offset=0.05)
rows_of = lane_types.rows_of(WIDTH)
rng = np.random.default_rng(3)


def by_lanes(function, x, n_out):
    """Values and slopes of what `function` gives for eight numbers.

    Each number has a second derivative beside the first, four times as large.
    """

    @njit(**inner.OPTIONS)
    def run(flat, out):
        S, R = rows_of(flat), rows_of(out)
        found = function(S[0])
        for i in range(n_out):
            R[i] = found[i]

    row = lane_types.dual_row(WIDTH, 2)
    flat, out = np.zeros(1, row), np.zeros(n_out, row)
    flat["value"] = x
    flat["slopes"] = STEP * np.array([1.0, 4.0])[:, np.newaxis]
    run(flat, out)
    first, second = out["slopes"].swapaxes(0, 1) / STEP
    np.testing.assert_array_equal(second, 4.0 * first)
    return out["value"], first


def test_arithmetic_carries_derivatives_through():
    where, magnitude = lanes.where, lanes.magnitude

    @njit(**inner.OPTIONS)
    def mixed(x):
        total = 0.0
        for i in range(2):
            total += x * i
        total -= 2
        return (
            total * x / 3.0,
            1.0 / (2.0 + x) - x.real,
            where(x > 0.2, x * x, 1.0),
            magnitude(x) + abs(x) - (-x),
            (x * x + 1.0) ** 0.5 + np.sqrt(2.0 + x),
            max(min(x, 0.3), -x * x),
            np.floor(4.0 * x) * x,
            np.sin(x) * np.tanh(x) + np.exp(x) * np.cos(x),
        )

    x = rng.uniform(-0.9, 0.9, WIDTH)
    value, slope = by_lanes(mixed, x, 8)
    expected = (
        (2 * x - 2) / 3,
        -1 / (2 + x) ** 2,
        np.where(x > 0.2, 2 * x, 0.0),
        2 * np.sign(x) + 1,
        x / np.sqrt(x * x + 1) + 0.5 / np.sqrt(2 + x),
        np.where(x < -x * x, -2 * x, np.where(x < 0.3, 1.0, 0.0)),
        np.floor(4 * x),
        np.cos(x) * np.tanh(x) + np.sin(x) / np.cosh(x) ** 2 + np.exp(x) * (np.cos(x) - np.sin(x)),
    )
    np.testing.assert_allclose(value[0], (x - 2) * x / 3, rtol=1e-15)
    np.testing.assert_allclose(slope, np.array(expected), rtol=1e-13, atol=1e-14)


def test_the_slope_of_a_sine_is_its_cosine_to_the_last_bit():
    x = rng.uniform(-40.0, 40.0, WIDTH)
    (sine, cosine), (slope_of_sine, slope_of_cosine) = by_lanes(functions.sincos, x, 2)
    np.testing.assert_array_equal(slope_of_sine, cosine)
    np.testing.assert_array_equal(slope_of_cosine, -sine)


def test_roots_of_zero_have_no_slope():
    @njit(**inner.OPTIONS)
    def roots(x):
        return (x * x) ** 0.5 * x, np.sqrt(x * x) * x

    value, slope = by_lanes(roots, np.zeros(WIDTH), 2)
    assert not value.any()
    assert not slope.any()


def test_a_law_that_branches_is_differentiated_lane_by_lane():
    def law(x, y):
        if x > 0.2:
            return x * x, 3.0
        return -x, 2.0 * y

    call = PROCESSOR.in_lanes(compile_scalar(law))

    @njit(**inner.OPTIONS)
    def both(x):
        return call(x, x * x)

    x = np.linspace(-0.9, 0.9, WIDTH)
    value, slope = by_lanes(both, x, 2)
    np.testing.assert_allclose(
        value, np.where(x > 0.2, (x * x, 3.0 + 0.0 * x), (-x, 2 * x * x)), rtol=1e-15
    )
    np.testing.assert_allclose(
        slope, np.where(x > 0.2, (2 * x, 0.0 * x), (-1.0 + 0.0 * x, 4 * x)), rtol=1e-15
    )


@pytest.mark.parametrize("edge", ["elongated", "finite-span"])
@pytest.mark.parametrize(("joints", "seconds"), [("prescribed", 1.0), ("pd", 1.0), ("servo", 1.0)])
def test_a_run_has_the_derivatives_of_dual_numbers(joints, seconds, edge):
    body = load_robot("mamba-fin").planar()
    plate = PectoralFin(link=3, area=0.01, lift_slope=3.0, stall_angle=0.5, y=0.05, angle=0.1)
    robot = replace(
        body,
        modules=body.modules[:4],
        joints=body.joints[:3],
        tether=Tether(drag=1.0),
        pectoral_fins=(plate,),
    )
    water = replace(
        load_water("paper-eel"),
        added_mass_form="kirchhoff",
        trailing_edge=edge,
        current=(0.1, 0.0),
    )
    plant = PlanarPlant(robot=robot, environment=water, settings=Planar(joints=JointLaw.of(joints)))
    command = Command(gait=GAIT)
    S = plant.rows(plant.init(Start(), command), command)
    # Lane k moves every eighth row, so that all parameters are perturbed, but not all at once.
    slope = np.array(
        [rng.normal(size=S.size) * S * (np.arange(S.size) % WIDTH == k) for k in range(WIDTH)]
    ).T
    slope[rows.AMPLITUDE_NOW : rows.OFFSET_RATE] = 0.1
    steps = round(seconds / plant.dt)
    row = lane_types.dual_row(WIDTH, 2)
    flat = np.zeros(S.size, row)
    flat["value"] = S[:, np.newaxis]
    flat["slopes"][:, 0] = STEP * slope
    flat["slopes"][:, 1] = STEP * np.roll(slope, 1, axis=1)
    log = np.zeros((2, rows.LOG_STATE), row)
    settings = joints != "prescribed", steps, plant.dt, steps
    specialize(WIDTH).run(flat, *plant.layout.chain, *settings, log)
    lane = 5
    numbers = np.array([Dual(v, s) for v, s in zip(S, slope[:, lane], strict=True)], dtype=object)
    slow = np.empty((2, rows.LOG_STATE), dtype=object)
    python_kernels().run(numbers, *plant.layout.chain, *settings, slow)
    value = np.array([getattr(x, "real", x) for x in slow[1]], dtype=float)
    derivative = np.array([getattr(x, "slope", 0.0) for x in slow[1]])
    np.testing.assert_allclose(log["value"][1, :, lane], value, rtol=1e-12, atol=1e-13)
    assert np.abs(derivative[rows.X - rows.TIME : rows.VY - rows.TIME]).min() > 1e-6
    first, second = log["slopes"][1].swapaxes(0, 1) / STEP
    for carried in (first[:, lane], second[:, lane + 1]):
        np.testing.assert_allclose(carried, derivative, rtol=1e-12, atol=1e-12)
