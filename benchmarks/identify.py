"""How long does an identification take?

Question: 4 parameters from the speeds of 20 trials of 30 s, prescribed joints, Mamba; 4 starts, and
one. The reference is one batch of those 20 trials.
"""

import time

from _timing import fastest, print_load, random_gaits

import laticauda as lc
from laticauda.identify import Measurement, fit

NAMES = (
    "water.tangential_friction",
    "water.added_mass",
    "robot.joint.actuator.tracking",
    "water.drag.reference_speed",
)


def main() -> None:
    """Print the table."""
    robot, gaits, water = lc.load_robot("mamba"), random_gaits(20), lc.load_water("paper-eel")
    true = lc.swim_many(robot, gaits, environments=water).forward_velocity
    measured = [
        Measurement(
            name=f"{i}",
            scenario=lc.build_scenario(robot, gait),
            figures={"forward_velocity": (float(speed), 0.001)},
        )
        for i, (gait, speed) in enumerate(zip(gaits, true, strict=True))
    ]
    for n_starts in (1, 4):
        for name, clock in (("wall", time.perf_counter), ("processor", time.process_time)):
            took = fastest(
                clock, lambda n=n_starts: fit(measured, parameters=NAMES, n_starts=n), repeats=2
            )
            print(f"4 parameters, 20 trials, {n_starts} starts: {took:5.2f} s ({name})")
    print(
        f"one batch of the trials:          {fastest(time.perf_counter, lambda: lc.swim_many(robot, gaits)):7.4f} s"
    )
    print_load()


if __name__ == "__main__":
    main()
