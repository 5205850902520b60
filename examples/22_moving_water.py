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
energy_in_still_water = still.mechanical_power / still.forward_velocity  # [J/m]
figure, (ax,) = new_panels(width=5.0)

for intensity in (0.01, 0.03, 0.1):
    scenarios = []
    for seed in range(20):
        turbulence = replace(gusts, intensity=intensity, seed=seed)
        moving_water = replace(water, current=turbulence)
        scenarios.append(replace(scenario, environment=moving_water))
    swims = lc.swim_many(scenarios)
    energy_per_meter = swims.mechanical_power / swims.forward_velocity
    speed = 100.0 * (swims.forward_velocity / still.forward_velocity - 1.0)
    energy = 100.0 * (energy_per_meter / energy_in_still_water - 1.0)
    turn = np.degrees(swims.heading - still.heading)
    print(
        f"{intensity:.2f} m/s: speed {np.mean(speed):+.1f} % +- "
        f"{np.std(speed, ddof=1):.1f}, energy per meter "
        f"{np.mean(energy):+.1f} % +- {np.std(energy, ddof=1):.1f}, turned by +- "
        f"{np.std(turn, ddof=1):.0f} deg"
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
