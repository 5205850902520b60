"""One accuracy for all kinds of joints at their default steps: speeds to 1e-5, powers to 1e-4."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import Robot, Water

SPEED_ERROR = 1e-5
POWER_ERROR = {"prescribed": 4e-4}
"""Relative error of mean power; of all other joints 1e-4. Prescribed joints count work by the trapezoidal rule."""
DURATION = 10.0
FINER = 16.0
GAITS = [
    lc.lateral_undulation(amplitude=0.5236, frequency=2.2689, phase_shift=0.6981),
    lc.lateral_undulation(amplitude=0.3, frequency=1.2, phase_shift=0.9),
    lc.lateral_undulation(amplitude=0.65, frequency=1.8, phase_shift=0.5, offset=0.1),
    lc.eel_like(amplitude=0.8, frequency=1.9, phase_shift=0.7),
]


class Case(NamedTuple):
    """Robot, water and joints."""

    robot: Robot
    water: Water
    joints: str | lc.JointLaw


def standard(name: str, joints: str) -> Case:
    return Case(lc.load_robot(name), lc.load_water("paper-lateral"), joints)


def identified(name: str) -> Case:
    found = lc.load_parameters("mamba-identified")
    kind = GAITS[0].kind
    assert found.joints is not None
    return Case(found.robot(lc.load_robot(name), kind), found.water(kind), found.joints)


CASES = {
    "prescribed": standard("mamba", "prescribed"),
    "prescribed, fin": standard("mamba-fin", "prescribed"),
    "pd": standard("mamba", "pd"),
    "pd, fin": standard("mamba-fin", "pd"),
    "servo": standard("mamba", "servo"),
    "speed-servo": standard("mamba", "speed-servo"),
    "ekeberg": standard("mamba", "ekeberg"),
    "hill": standard("mamba", "hill"),
    "identified": identified("mamba"),
    "identified, fin": identified("mamba-fin"),
}


def swim(case: Case, dt: float | None) -> lc.Swims:
    return lc.swim_many(
        case.robot, GAITS, DURATION, joints=case.joints, environments=case.water, dt=dt
    )


def relative_errors(values: np.ndarray, exact: np.ndarray) -> Sequence[float]:
    return [float(error) for error in np.abs(values / exact - 1.0)]


@pytest.mark.filterwarnings("ignore::laticauda.InfeasibleWarning")
@pytest.mark.parametrize("name", CASES)
def test_speeds_are_right_to_1e_5_and_powers_to_1e_4_at_the_default_step(name):
    case = CASES[name]
    plant = lc.build_plant(case.robot, case.water, model="planar", joints=case.joints)
    swims, exact = swim(case, None), swim(case, plant.dt / FINER)
    assert max(relative_errors(swims.forward_velocity, exact.forward_velocity)) <= SPEED_ERROR
    assert max(relative_errors(swims.mean_power, exact.mean_power)) <= POWER_ERROR.get(
        str(case.joints), 1e-4
    )
    distance = np.linalg.norm(exact.center_of_mass, axis=1)
    off = np.linalg.norm(swims.center_of_mass - exact.center_of_mass, axis=1)
    assert np.max(off / distance) <= 2.0 * SPEED_ERROR
