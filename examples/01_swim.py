"""Mamba swims by lateral undulation for half a minute, as in a trial of the paper.

The robot and the gait are data; `swim` runs the planar model and returns a `Trial`,
the log of the run.

    python examples/01_swim.py
"""

from math import radians

import laticauda as lc

robot = lc.load_robot("mamba")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
trial = lc.swim(robot, gait, duration=30.0)

print(
    f"average forward velocity: {trial.forward_velocity:.4f} m/s (measured on the "
    "robot: 0.1514 m/s)"
)
print(f"mechanical power:         {trial.mean_power:.1f} W")
print(f"end of the run:           {trial.center_of_mass[-1].round(2)} m")
trial.plot().savefig("swim.png")
