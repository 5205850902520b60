"""How stiff should a caudal fin be? Mamba swims with fins from limp to rigid.

A fin with hinges bends; `flexural_rigidity` is the E I of its plate, 2.2 N m^2 for
5 mm of polycarbonate. All fins that bend swim side by side in one batch.

    python examples/09_elastic_fin.py
"""

from dataclasses import replace
from math import radians

import laticauda as lc
from laticauda.robot.hydrodynamics import bending_frequencies
from laticauda.show.figures import new_panels, save_figure, style

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
scenario = lc.build_scenario("mamba-fin", gait, parameters="mamba-identified")
robot = scenario.robot

stiffnesses = [0.03, 0.1, 0.3, 1.0, 2.0, 3.0, 10.0, 100.0]
robots = []
for stiffness in stiffnesses:
    fin = replace(robot.caudal_fin, n_hinges=3, flexural_rigidity=stiffness)
    robots.append(replace(robot, caudal_fin=fin))
bent = lc.swim_many([replace(scenario, robot=robot) for robot in robots])
rigid = lc.swim(scenario)

print("E I [N m^2]   swings at [Hz]   speed [m/s]   mean power [W]")
for i, stiffness in enumerate(stiffnesses):
    frequency = bending_frequencies(robots[i], scenario.environment)[0]
    print(
        f"{stiffness:11g}   {frequency:14.2f}   {bent.forward_velocity[i]:11.4f}  "
        f" {bent.mean_power[i]:14.1f}"
    )
print(
    f"      rigid                    {rigid.forward_velocity:11.4f}   "
    f"{rigid.mean_power:14.1f}"
)

figure, (ax,) = new_panels(width=5.0)
ax.semilogx(
    stiffnesses,
    bent.forward_velocity,
    marker="o",
    markersize=4,
    label="a fin that bends",
)
ax.axhline(rigid.forward_velocity, label="a rigid fin", **style.AIM)
ax.axvline(2.2, color=style.GRID, zorder=0)
style.add_note(ax, "5 mm of\npolycarbonate", (2.2, ax.get_ylim()[0]), (4, 4))
style.style_axes(
    ax, xlabel="bending stiffness E I [N m$^2$]", ylabel="forward velocity [m/s]"
)
style.add_legend(ax, loc="upper right")
save_figure(figure, "fin.png")
