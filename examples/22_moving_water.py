"""Swimming in turbulence: how much slower the robot is, how much more energy it
needs per meter, and how much of that is chance.

Twenty seeds of each intensity run as lanes of one kernel; the parameters of the
turbulence can also be axes of a sweep.

    python examples/22_moving_water.py
"""

from dataclasses import replace
from math import radians

import numpy as np

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
scenario = lc.build_scenario("mamba-fin", gait, parameters="mamba-identified")
water = scenario.environment
gusts = replace(lc.load_current("turbulence"), mean=(0.0, 0.0, 0.0))
still = lc.swim_many([scenario])
dearness = still.mechanical_power / still.forward_velocity
figure, (ax,) = new_panels(width=5.0)

for intensity in (0.01, 0.03, 0.1):
    waters = [
        replace(water, current=replace(gusts, intensity=intensity, seed=seed))
        for seed in range(20)
    ]
    found = lc.swim_many([replace(scenario, environment=one) for one in waters])
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
    ax.plot(
        np.full(speed.size, intensity),
        speed,
        "o",
        color=style.BLUE,
        markersize=4,
        alpha=0.4,
    )
    mean = (intensity, float(np.mean(speed)))
    ax.plot(*mean, **style.marker_style("_", 16.0))
    style.add_note(ax, f"mean {mean[1]:+.1f} %", mean, (10, 0), color=style.INK)
ax.set_xscale("log")
ax.set_xlim(0.007, 0.25)
ax.set_xticks([0.01, 0.03, 0.1], ["0.01", "0.03", "0.1"])
ax.minorticks_off()
style.style_axes(
    ax, xlabel="turbulence [m/s]", ylabel="speed against still water [%]"
)
save_figure(figure, "turbulence.png")
