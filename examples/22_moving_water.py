"""Swimming in turbulence: how much slower the robot is, how much more energy it
needs per meter, and how much of that is chance.

Twenty seeds of each intensity run as lanes of one kernel; the parameters of the
turbulence can also be axes of a sweep.

    python examples/22_moving_water.py
"""

from dataclasses import replace
from math import radians

import matplotlib.pyplot as plt
import numpy as np

import laticauda as lc

robot, water = lc.load_robot("mamba-fin"), lc.load_water("paper-lateral")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
gusts = replace(lc.load_current("turbulence"), mean=(0.0, 0.0, 0.0))
still = lc.swim_many(robot, gait, 30.0, environments=water)
dearness = still.mechanical_power / still.forward_velocity
figure, ax = plt.subplots(layout="constrained")

for intensity in (0.01, 0.03, 0.1):
    waters = [
        replace(water, current=replace(gusts, intensity=intensity, seed=seed))
        for seed in range(20)
    ]
    found = lc.swim_many(robot, [gait] * len(waters), 30.0, environments=waters)
    speed = 100.0 * (found.forward_velocity / still.forward_velocity - 1.0)
    energy = 100.0 * (
        found.mechanical_power / found.forward_velocity / dearness - 1.0
    )
    turned = np.degrees(found.heading - still.heading)
    print(
        f"{intensity:.2f} m/s: speed {np.mean(speed):+.1f} % +- "
        f"{np.std(speed, ddof=1):.1f}, energy per meter "
        f"{np.mean(energy):+.1f} % +- {np.std(energy, ddof=1):.1f}, turned by +- "
        f"{np.std(turned, ddof=1):.0f} deg"
    )
    ax.plot(np.full(speed.size, intensity), speed, "o", alpha=0.4)
ax.set(
    xscale="log",
    xlabel="turbulence [m/s]",
    ylabel="speed against still water [%]",
)
figure.savefig("turbulence.png", dpi=150)
