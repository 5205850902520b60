"""How long does an identification take?

Question: 4 parameters from the speeds of 20 trials of 30 s, prescribed joints, Mamba; 4 starts, and
one. The reference is one batch of those 20 trials.
"""

import time
from functools import partial

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
    robot = lc.load_robot("mamba")
    gaits = random_gaits(20)
    swims = lc.swim_many(robot, gaits, environments=lc.load_water("paper-eel"))
    measurements: list[Measurement] = []
    for i, (gait, speed) in enumerate(zip(gaits, swims.forward_velocity, strict=True)):
        scenario = lc.build_scenario(robot, gait)
        figures = {"forward_velocity": (float(speed), 0.001)}
        measurements.append(Measurement(name=f"{i}", scenario=scenario, figures=figures))
    for n_starts in (1, 4):
        identify = partial(fit, measurements, parameters=NAMES, n_starts=n_starts)
        for name, clock in (("wall", time.perf_counter), ("processor", time.process_time)):
            seconds = fastest(clock, identify, repeats=2)
            print(f"4 parameters, 20 trials, {n_starts} starts: {seconds:5.2f} s ({name})")
    seconds = fastest(time.perf_counter, lambda: lc.swim_many(robot, gaits))
    print(f"one batch of the trials:          {seconds:7.4f} s")
    print_load()


if __name__ == "__main__":
    main()
