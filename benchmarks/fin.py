"""Print how well hinges stand for a plate that bends, and what its stiffness does to the speed: docs/theory/fin.md."""

from dataclasses import replace
from math import pi, radians, sqrt

import numpy as np

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials
from laticauda.robot import CaudalFin
from laticauda.robot.hydrodynamics import bending_frequencies

WATER = lc.load_water("paper-lateral")
ROBOT = lc.load_robot("mamba-fin")
ROOTS = (1.875104068711961, 4.694091132974175)  # of cos(x) cosh(x) = -1


def frequencies() -> None:
    """Error of the first two frequencies of a uniform plate in water, with fine strips."""
    print(
        "Error of the bending frequencies of a uniform plate in water [%], open: against 200 equal hinges"
    )
    print("hinges    first   second     first, open")
    for n in range(1, 7):
        fin = CaudalFin(
            opening="closed", n_strips=400, n_hinges=n, flexural_rigidity=1.0, added_mass=1.0
        )
        mass = fin.mass / fin.length + WATER.density * pi * (0.5 * fin.height) ** 2
        computed = bending_frequencies(replace(ROBOT, caudal_fin=fin), WATER)
        exact = [root**2 * sqrt(1.0 / mass) / (2.0 * pi * fin.length**2) for root in ROOTS]
        errors = [
            f"{100.0 * (frequency / exact_frequency - 1.0):+8.3f}"
            for frequency, exact_frequency in zip(computed, exact, strict=False)
        ]
        if n == 1:
            errors.append("       -")
        open_fin = replace(fin, opening="open")
        first, *_ = bending_frequencies(replace(ROBOT, caudal_fin=open_fin), WATER)
        error_of_open = first / open_frequency(open_fin) - 1.0
        print(f"{n:6d} {' '.join(errors)}        {100.0 * error_of_open:+8.3f}")


def open_frequency(fin: CaudalFin, n: int = 200) -> float:
    """First frequency of the plate with its opening, from very many hinges in the middles of equal parts [Hz]."""
    water = WATER.density * pi * (0.5 * fin.height) ** 2
    x = (np.arange(100 * n) + 0.5) * fin.length / (100 * n)
    mass = (fin.mass / fin.length + water * (x > fin.opening_length)) * fin.length / x.size
    hinge = (np.arange(n) + 0.5) * fin.length / n
    arm = np.maximum(x - hinge[:, np.newaxis], 0.0)
    stiffness = 1.0 / (fin.length / n)
    flexibility = (arm * mass) @ arm.T / stiffness
    largest_eigenvalue = np.linalg.eigvalsh(flexibility)[-1]
    return float(1.0 / np.sqrt(largest_eigenvalue) / (2.0 * pi))


def speeds() -> None:
    """Speed and power of Mamba over the stiffness of its fin, and over the number of hinges."""
    gait = lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
    )
    print("Speed [m/s] and mean power [W] over 30 s; E I [N m^2], first bending frequency [Hz]")
    without_fin = lc.swim(lc.load_robot("mamba"), gait)
    rigid = lc.swim(ROBOT, gait)
    print(f"no fin        {without_fin.forward_velocity:.4f} {without_fin.mean_power:6.2f}")
    print(f"rigid         {rigid.forward_velocity:.4f} {rigid.mean_power:6.2f}")
    for rigidity in (100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.0, 0.5, 0.3, 0.1, 0.03, 0.01, 0.001):
        trials = []
        for n in (1, 3, 6):
            fin = replace(ROBOT.caudal_fin, n_hinges=n, flexural_rigidity=rigidity)
            trials.append(lc.swim(replace(ROBOT, caudal_fin=fin), gait))
        first = bending_frequencies(trials[1].robot, WATER)[0]
        columns = "   ".join(
            f"{trial.forward_velocity:.4f} {trial.mean_power:6.2f}" for trial in trials
        )
        print(f"{rigidity:8g} {first:7.3f}   {columns}")


def gains() -> None:
    """By how much the fin makes Mamba faster: in the tank (Table 1) and with fins of several stiffnesses."""
    measured = {
        (trial.gait, trial.has_fin): trial.forward_velocity for trial in read_efficiency_trials()
    }
    stiffnesses = (3.0, 1.0, 0.5, 0.3)
    print(
        f"Mean gain in speed by the fin [%]: measured, rigid, E I = {', '.join(map(str, stiffnesses))}"
    )
    fins = [ROBOT.caudal_fin]
    for stiffness in stiffnesses:
        fins.append(replace(ROBOT.caudal_fin, n_hinges=3, flexural_rigidity=stiffness))
    for kind in ("lateral_undulation", "eel_like"):
        ratios = []
        for (gait, has_fin), speed in measured.items():
            with_fin = measured.get((gait, True))
            if gait.kind != kind or has_fin or speed is None or with_fin is None:
                continue
            without_fin = lc.swim(lc.load_robot("mamba"), gait).forward_velocity
            ratios_of_gait = [with_fin / speed]
            for fin in fins:
                trial = lc.swim(replace(ROBOT, caudal_fin=fin), gait)
                ratios_of_gait.append(trial.forward_velocity / without_fin)
            ratios.append(ratios_of_gait)
        mean_gains = 100.0 * (np.mean(ratios, axis=0) - 1.0)
        print(f"{kind} ({len(ratios)} gaits): {' '.join(f'{gain:5.1f}' for gain in mean_gains)}")


def steps() -> None:
    """Worst errors at the default step and at others, over stiffnesses and numbers of hinges."""
    gait = lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
    )
    print(
        "Worst error of path (over the distance) and of mean power in 30 s, E I from 0.001 to 100 and at 1e6 N m^2"
    )
    for rigidities in ((0.001, 0.01, 0.1, 1.0, 10.0, 100.0), (1e6,)):
        worst = {dt: [0.0, 0.0] for dt in (0.01, 0.005, 0.0025)}
        for n in (1, 3, 6):
            for rigidity in rigidities:
                fin = replace(ROBOT.caudal_fin, n_hinges=n, flexural_rigidity=rigidity)
                robot = replace(ROBOT, caudal_fin=fin)
                fine = lc.swim(robot, gait, dt=3e-4)
                for dt, errors in worst.items():
                    trial = lc.swim(robot, gait, dt=dt)
                    gap = np.linalg.norm(trial.center_of_mass - fine.center_of_mass, axis=1).max()
                    errors[0] = max(errors[0], float(gap / (30.0 * fine.forward_velocity)))
                    errors[1] = max(errors[1], abs(trial.mean_power / fine.mean_power - 1.0))
        print(
            "; ".join(
                f"dt {dt:g} s: {path:.0e}, {power:.0e}" for dt, (path, power) in worst.items()
            )
        )


if __name__ == "__main__":
    frequencies()
    steps()
    gains()
    speeds()
