"""How does the error fall with the step, for the nine settings of the paper's Table 1 without the fin?

Question: which default step is converged to 1e-6 (prescribed) and 1e-4 (pd, servo) of the distance?
Printed: the worst of the nine, as a ratio to the distance swum.

Last answer (2026-11-21), at the default steps and at half of them:
    prescribed    0.0500 s  3.7e-07    0.0250 s  5.4e-08
    pd            0.0020 s  1.4e-05    0.0010 s  3.2e-06
    servo         0.0020 s  3.0e-05    0.0010 s  7.5e-06
"""

import numpy as np

import laticauda as lc
from laticauda.motion.gaits import envelope_of

SETTINGS = (
    ("lateral_undulation", 30, 130, 40),
    ("lateral_undulation", 30, 150, 40),
    ("lateral_undulation", 36, 110, 40),
    ("lateral_undulation", 30, 110, 35),
    ("eel_like", 30, 130, 40),
    ("eel_like", 30, 150, 40),
    ("eel_like", 48, 110, 40),
    ("eel_like", 50, 110, 40),
    ("eel_like", 30, 110, 35),
)
STEPS = {
    "prescribed": (0.1, 0.05, 0.025),
    "pd": (0.008, 0.004, 0.002, 0.001),
    "servo": (0.008, 0.004, 0.002, 0.001),
}


def main() -> None:
    """Print the table."""
    print(f"{'joints':<12}{'dt [s]':>8}{'worst error / distance':>25}")
    for joints, steps in STEPS.items():
        worst = dict.fromkeys(steps, 0.0)
        for robot in (lc.load_robot("mamba"), lc.load_robot("mamba-fin")):
            for kind, *degrees in SETTINGS:
                amplitude, frequency, phase_shift = np.deg2rad(degrees)
                gait = lc.Gait(
                    envelope=envelope_of(kind),
                    amplitude=amplitude,
                    frequency=frequency,
                    phase_shift=phase_shift,
                )
                ends = [
                    lc.swim(robot, gait, joints=joints, dt=dt, sample_interval=0.1).center_of_mass[
                        -1
                    ]
                    for dt in (*steps, steps[-1] / 16)
                ]
                for dt, end in zip(steps, ends, strict=False):
                    worst[dt] = max(
                        worst[dt], float(np.linalg.norm(end - ends[-1]) / np.linalg.norm(ends[-1]))
                    )
        for dt, error in worst.items():
            print(f"{joints:<12}{dt:>8.4f}{error:>25.1e}")


if __name__ == "__main__":
    main()
