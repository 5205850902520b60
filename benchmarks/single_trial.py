"""How fast is one warm 30 s trial of Mamba, and how exact at that speed?

Question: does a prescribed trial take under 2 ms of one core at an error of 1e-6 of the distance,
and a pd or servo trial under 60 ms at 1e-4? Times are the least of many runs; the ratio is to the
same accelerations by the printed matrices (`tests/printed_equations.py`, NumPy), as many
evaluations as the run makes.

Last answer (2 shared cores, AMD EPYC, 2026-11-21), of the whole public call; the kernel alone takes
1.0 of the 1.4 ms:
    joints      dt [s]   time [ms]   matrices / kernel   error / distance
    prescribed   0.050         1.4               x 700            3.7e-07
    pd           0.002        11.5               x 690            1.0e-05
    servo        0.002        15.7               x 510            2.7e-05
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.robot.hydrodynamics import link_coefficients

sys.path.append(str(Path(__file__).parent.parent / "tests"))
import printed_equations as equations  # the oracle of the tests

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
STAGES = {"prescribed": 6, "pd": 2, "servo": 2}


def least(action: Callable[[], object], runs: int) -> float:
    """Least wall time of `runs` calls after one to warm up [s]."""
    action()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def matrices_time(robot: lc.Robot, water: lc.Water) -> float:
    """Time of one evaluation by the printed matrices [s]."""
    c = link_coefficients(robot, water)
    names = (
        "half_length",
        "mass",
        "c_t",
        "c_n",
        "mu_t",
        "mu_n",
        "lambda_1",
        "lambda_2",
        "lambda_3",
    )
    inertia = np.array([module.moment_of_inertia for module in robot.modules])
    chain = equations.Chain(inertia=inertia, **{name: getattr(c, name) for name in names})
    n = robot.n_links
    rng = np.random.default_rng(0)
    theta, rate = rng.normal(size=n), rng.normal(size=n)
    velocity, torque = np.zeros(2), np.zeros(n - 1)
    link_force, link_torque = np.zeros((n, 2)), np.zeros(n)
    options = equations.Options()

    def evaluate() -> object:
        return equations.accelerations(
            theta, rate, velocity, chain, options, torque, link_force, link_torque
        )

    return least(evaluate, 200)


def main() -> None:
    """Print the table."""
    robot, water = lc.load_robot("mamba"), lc.load_water("paper-lateral")
    time_of_matrices = matrices_time(robot, water)
    print(
        f"{'joints':<12}{'dt [s]':>8}{'time [ms]':>12}{'matrices / kernel':>20}{'error / distance':>19}"
    )
    for joints, stages in STAGES.items():
        trial = lc.swim(robot, GAIT, environment=water, joints=joints)
        dt = float(trial.settings["dt"])
        fine = lc.swim(robot, GAIT, environment=water, joints=joints, dt=dt / 32)
        end, exact_end = trial.center_of_mass[-1], fine.center_of_mass[-1]
        error = np.linalg.norm(end - exact_end) / np.linalg.norm(exact_end)
        swim = partial(lc.swim, robot, GAIT, environment=water, joints=joints)
        seconds = least(swim, 30)
        n_evaluations = stages * 30.0 / dt
        ratio = n_evaluations * time_of_matrices / seconds
        print(f"{joints:<12}{dt:>8.3f}{1e3 * seconds:>12.1f}{f'x{ratio:5.0f}':>20}{error:>19.1e}")


if __name__ == "__main__":
    main()
