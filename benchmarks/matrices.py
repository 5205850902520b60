"""How much faster is the kernel than the closed form as one would write it: NumPy matrices and `solve_ivp`?

Question: Mamba, 30 s, prescribed joints; the printed matrices (`tests/printed_equations.py`) under
SciPy's integrators with its usual tolerances, against `swim` and a trial of a batch. Printed: time,
ratio, error of the end point over the distance (reference: the kernel at a 32nd of its step). All
compute the same model.
"""

import sys
import time
from pathlib import Path

import numpy as np
from _timing import fastest, print_load
from scipy.integrate import solve_ivp

import laticauda as lc
from laticauda.motion.gaits import reference
from laticauda.robot.hydrodynamics import link_coefficients

sys.path.append(str(Path(__file__).parent.parent / "tests"))
import printed_equations as equations  # the oracle of the tests

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
METHODS = {
    "RK45, defaults": {"method": "RK45"},
    "LSODA, rtol 1e-6": {"method": "LSODA", "rtol": 1e-6, "atol": 1e-9},
}
DURATION = 30.0


def right_side(robot: lc.Robot, water: lc.Water):
    """y' for y = heading, p, heading', p'."""
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
    n, options = robot.n_links, equations.Options()
    joint = np.arange(n - 1)
    still = np.zeros((n, 2)), np.zeros(n)

    def spread(joints: np.ndarray) -> np.ndarray:
        """Angles of the links around their mean."""
        links = np.concatenate(([0.0], np.cumsum(joints)))
        return links - links.mean()

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        a = reference.ramped(GAIT.amplitude, 0.0, 0.0, *reference.smooth_start(t, 1.0))
        psi = GAIT.frequency * t + joint * GAIT.phase_shift
        motion = reference.WaveMotion(*a, GAIT.frequency, *(0.0,) * 6)
        angle, rate, acceleration = reference.wave_reference(
            np.sin(psi), np.cos(psi), 1.0, 0.0, motion
        )
        theta, theta_rate = y[0] + spread(angle), y[3] + spread(rate)
        spin, p, _ = equations.constrained_accelerations(
            theta, theta_rate, y[4:6], chain, options, acceleration, *still
        )
        return np.concatenate((y[3:6], [spin.mean()], p))

    return slope


def main() -> None:
    """Print the table."""
    robot, water = lc.load_robot("mamba").planar(), lc.load_water("paper-lateral")
    exact = lc.swim(robot, GAIT, environment=water, dt=0.05 / 32).center_of_mass[-1]

    def error(end: np.ndarray) -> float:
        return float(np.linalg.norm(end - exact) / np.linalg.norm(exact))

    def swim_batch() -> object:
        return lc.swim_many(robot, [GAIT] * 800, environments=water, threads=1)

    kernel = fastest(time.process_time, lambda: lc.swim(robot, GAIT, environment=water), 30)
    batch = fastest(time.process_time, swim_batch) / 800
    error_of_swim = error(lc.swim(robot, GAIT, environment=water).center_of_mass[-1])
    print(f"{'':<20}{'time [ms]':>11}{'x swim':>9}{'x batch':>10}{'error':>10}")
    slope = right_side(robot, water)
    for name, settings in METHODS.items():
        start = time.process_time()
        end = solve_ivp(slope, (0.0, DURATION), np.zeros(6), **settings).y[1:3, -1]
        seconds = time.process_time() - start
        ratios = f"{seconds / kernel:>9.0f}{seconds / batch:>10.0f}"
        print(f"{name:<20}{1e3 * seconds:>11.0f}{ratios}{error(end):>10.1e}")
    print(f"{'swim':<20}{1e3 * kernel:>11.2f}{1:>9}{kernel / batch:>10.1f}{error_of_swim:>10.1e}")
    print(f"{'trial of a batch':<20}{1e3 * batch:>11.3f}{'':>9}{1:>10}{error_of_swim:>10.1e}")
    print_load()


if __name__ == "__main__":
    main()
