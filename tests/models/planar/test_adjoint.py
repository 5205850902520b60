"""Derivatives backward in time are those of the kernels with duals, row by row."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.planar import batch, reverse, rows
from laticauda.models.simulate import batch_scenarios
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.robot import (
    CaudalFin,
    Joint,
    PectoralFin,
    Tether,
    Thruster,
    load_robot,
    load_water,
)
from laticauda.water.fluid.laws import TotalSpeedDrag

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.31, phase_shift=0.7, offset=0.03)
STILL = load_water("paper-lateral")
STREAM = replace(STILL, tangential_added_mass=0.1, current=(0.03, -0.02), friction_taper=0.3)
FINITE = replace(STREAM, added_mass_form="kirchhoff", trailing_edge="finite-span")
MAMBA = load_robot("mamba")
FINNED = replace(load_robot("mamba-fin"), tether=Tether(drag=0.8, force=(0.1, 0.2)))
EQUIPPED = replace(
    FINNED,
    pectoral_fins=(
        PectoralFin(link=3, area=0.01, lift_slope=3.0, stall_angle=0.5, y=0.05, angle=0.1),
    ),
    thrusters=(Thruster(link=2, thrust=0.3, angle=0.2, y=0.02),),
)
BROAD = CaudalFin(length=0.06, height=0.2, opening_length=0.0, added_mass=1.0, joint=Joint())
DRIVEN = replace(FINNED, caudal_fin=BROAD)
RECORDED = recorded_gait(
    JointAngles(
        time=tuple(np.linspace(0.0, 1.0, 6).tolist()),
        angle=tuple(
            tuple((0.4 * np.sin(np.linspace(0.0, 5.0, 6) + 0.6 * joint)).tolist())
            for joint in range(MAMBA.n_links - 1)
        ),
    )
)
CASES = {
    "still water": (MAMBA, GAIT, STILL),
    "everything": (EQUIPPED, GAIT, STREAM),
    "classic form": (FINNED, GAIT, replace(STREAM, added_mass_form="classic")),
    "slender edge": (
        FINNED,
        GAIT,
        replace(FINITE, trailing_edge="elongated"),
    ),
    "driven fin of finite span": (
        DRIVEN,
        replace(GAIT, fin=lc.Wave(amplitude=0.4, frequency=2.5, phase=1.0, offset=0.1)),
        FINITE,
    ),
    "recording": (MAMBA, RECORDED, STILL),
    "total speed": (EQUIPPED, GAIT, replace(STREAM, drag=TotalSpeedDrag(beta=0.4, gamma=0.9))),
}
CHOICES = (
    rows.OWN_VELOCITY,
    rows.KIRCHHOFF,
    rows.KNOTS,
    rows.N_KNOTS,
    rows.FLOW,
    rows.HEIGHT,
    rows.TIME,
    rows.TIME_REST,
)
"""Rows that choose a law or a place: nothing is differentiated to them."""


def of_case(case, duration):
    robot, gait, water = CASES[case]
    scenario = lc.build_scenario(robot, gait, duration, environment=water)
    return batch_scenarios.runs_of([scenario])[0]


def differentiated(run):
    """Rows that a number of robot, water or gait may change."""
    layout = run.plant.layout
    header = [*range(rows.HEADING_ACCELERATION), *range(rows.LAW, rows.LAW + 6)]
    bodies = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(layout.n_bodies)
    of_body = [*range(rows.C_T + 4), *range(rows.THRUST_T, rows.THRUST_MOMENT + 1)]
    of_joint = (rows.ENVELOPE, rows.STIFFNESS, rows.DAMPING)
    records = [
        int(b) + row for b in bodies for row in of_body if b > bodies[0] or row not in of_joint
    ]
    end = rows.HEADER_ROWS + rows.BODY_ROWS * layout.n_bodies
    return [
        *(row for row in header if row not in CHOICES),
        *records,
        *range(end, run.rows.size),
    ]


def random_seeds(n_samples, every=3):
    """Derivatives of a number that depends on some samples, and on the works at the end."""
    seeds = np.random.default_rng(0).normal(size=(n_samples, reverse.SEED_ROWS, 1))
    seeds[np.arange(n_samples) % every > 0] = 0.0
    seeds[:-1, rows.BASE_ROWS :] = 0.0
    return seeds


def by_duals(run, duration, seeds, differentiated):
    """The same derivatives, one run with duals for every row."""
    size = run.rows.size
    runs = [replace(run, slope=np.eye(1, size, row)[0]) for row in differentiated]
    result = np.empty(len(runs))
    base = rows.HEADING - rows.TIME

    def collect(block):
        states = np.imag(block.log[:, base : base + rows.BASE_ROWS]) / batch.STEP
        works = np.imag(block.work) / batch.STEP
        result[block.index] = np.einsum("tr,trl->l", seeds[:, : rows.BASE_ROWS, 0], states)
        result[block.index] += seeds[-1, rows.BASE_ROWS :, 0] @ works

    for _ in batch.march_many(runs, duration, 0.05, collect, with_joints=True):
        pass
    return result


def with_constant_mass(run, chosen, derivatives):
    """The same derivatives, with those to shares of the mass, which add up to 1, relative to their mean."""
    result = derivatives.copy()
    bodies = rows.HEADER_ROWS + rows.BODY_ROWS * np.arange(run.plant.layout.n_bodies)
    is_share = np.isin(chosen, bodies + rows.MASS_SHARE)
    result[is_share] -= result[is_share].mean()
    return result


@pytest.mark.parametrize("case", CASES)
def test_bars_of_all_rows_are_the_derivatives_that_duals_find(case):
    duration = 4.0  # more than a segment
    run = of_case(case, duration)
    seeds = random_seeds(1 + round(duration / 0.05))
    bars = reverse.march_back([run], duration, 0.05, lambda block: seeds)[:, 0]
    chosen = differentiated(run)
    expected = by_duals(run, duration, seeds, chosen)
    np.testing.assert_allclose(
        with_constant_mass(run, chosen, bars[chosen]),
        with_constant_mass(run, chosen, expected),
        rtol=1e-10,
        atol=1e-12 * np.abs(expected).max(),
    )
