"""Does the planar model identify a robot that is not the planar model?

Question: the modular Mamba of the 3D twin, 19 modules that float freely in water with weight and buoyancy, swims four
gaits of either kind; a tracker sees its center of mass and heading with noise. What does the planar model, which has
ten links and no depth, make of its water? The twin's own coefficients are known, but the two models are not the same,
and nothing says that the intervals of a wrong model hold the truth. A marker data set of a swimming robot under an open
license, which would answer the same question better, was looked for and not found.

    python campaigns/identify_twin.py

Last answer (2 shared cores, 2026-11-21, 12 s):
without noise: 3 of 3 parameters identified from 4 measurements (736 numbers); residuals are 1.8 times the stated noise
  water.tangential_friction   0.2130 [0.2095, 0.2166]   true 0.2, +6.5%
  water.normal_drag           1.5041 [1.4797, 1.5288]   true 1.4, +7.4%
  water.added_mass            1.2137 [1.1955, 1.2322]   true 1.2, +1.1%
  speeds: 0.55 %, left out 0.55 %
with noise: 3 of 3 parameters identified from 4 measurements (736 numbers); residuals are 2 times the stated noise
  water.tangential_friction   0.2135 [0.2065, 0.2207]   true 0.2, +6.8%
  water.normal_drag           1.5079 [1.4598, 1.5576]   true 1.4, +7.7%
  water.added_mass            1.2099 [1.1741, 1.2468]   true 1.2, +0.8%
  speeds: 0.62 %, left out 0.63 %

The ratio of friction to drag comes out within 1 %, and speeds are predicted to 0.6 %; but friction and drag themselves
are 7 % too great, more than their intervals allow. Residuals of twice the noise say that the model is not the robot.
"""

from dataclasses import replace

import numpy as np

import laticauda as lc
from laticauda.identify import Fit, Measurement, fit, from_trial, leave_out

DURATION = 15.0  # [s]
POSITION, HEADING = 0.003, 0.01  # standard deviations of the tracker's noise [m], [rad]
TRUTH = {"tangential_friction": 0.2, "normal_drag": 1.4, "added_mass": 1.2}
NAMES = [f"water.{name}" for name in TRUTH]
GAITS = (
    lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7),
    lc.lateral_undulation(amplitude=0.35, frequency=2.4, phase_shift=0.5, offset=0.03),
    lc.eel_like(amplitude=0.7, frequency=1.8, phase_shift=0.7),
    lc.eel_like(amplitude=0.55, frequency=2.2, phase_shift=0.55, offset=-0.03),
)


def tracked(number: int, noise: float, rng: np.random.Generator) -> Measurement:
    """One trial of the twin, and what the tracker makes of it."""
    robot, water = lc.load_robot("mamba-modules"), lc.load_water("paper-lateral")
    trial = lc.swim(robot, GAITS[number], DURATION, environment=replace(water, **TRUTH), model="spatial")
    log = replace(
        trial,
        center_of_mass=trial.center_of_mass + noise * POSITION * rng.standard_normal(trial.center_of_mass.shape),
        heading=trial.heading + noise * HEADING * rng.standard_normal(trial.heading.shape),
    )
    series = {"center_of_mass": POSITION, "heading": HEADING}
    seen = from_trial(log, name=f"trial {number}", series=series, figures={"forward_velocity": 0.001}, every=5)
    return replace(seen, scenario=replace(seen.scenario, start=lc.Start(), environment=water))


def show(title: str, found: Fit) -> None:
    print(f"{title}: {found.status}")
    for estimate, truth in zip(found.estimates, TRUTH.values(), strict=True):
        ends = "not identified" if estimate.interval is None else "[{:.4f}, {:.4f}]".format(*estimate.interval)
        print(f"  {estimate.name:26} {estimate.value:7.4f} {ends:18} true {truth:g}, {estimate.value / truth - 1:+.1%}")
    print(
        f"  speeds: {found.percentage_error():.2f} %, left out {leave_out(found).percentage_error():.2f} %", flush=True
    )


def main() -> None:
    rng = np.random.default_rng(1)
    for noise, title in ((0.0, "without noise"), (1.0, "with noise")):
        measured = [tracked(number, noise, rng) for number in range(len(GAITS))]
        show(title, fit(measured, parameters=NAMES, noise="known" if noise == 0.0 else "estimated"))


if __name__ == "__main__":
    main()
