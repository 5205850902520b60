"""What does the speed depend on? Derivatives with respect to any parameter of the
robot, the gait and the water.

python examples/06_sensitivities.py
"""

from math import radians

import numpy as np

import laticauda as lc
from laticauda.models.simulate import compute_sensitivities
from laticauda.show.figures import new_panels, save_figure, style

gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
scenario = lc.build_scenario("mamba-fin", gait, parameters="mamba-identified")
names = [
    "gait.amplitude",
    "gait.frequency",
    "gait.phase_shift",
    "water.tangential_friction",
    "water.normal_drag",
    "water.added_mass",
    "robot.module.length",
    "robot.module.mass",
    "robot.caudal_fin.length",
    "robot.caudal_fin.height",
]
sensitivities = compute_sensitivities([scenario], names=names)
speed_index = sensitivities.figures.index("forward_velocity")
power_index = sensitivities.figures.index("mean_power")
speed = sensitivities.values[0, speed_index]
power = sensitivities.values[0, power_index]
# Change in percent for a change of one percent of each parameter.
speed_change = sensitivities.elasticity[0, speed_index]
power_change = sensitivities.elasticity[0, power_index]

print(f"{speed:.4f} m/s, {power:.2f} W. One percent more of")
for k, parameter in enumerate(sensitivities.parameters):
    print(
        f"  {parameter.name:<28} changes the speed by {speed_change[k]:+.2f} %, "
        f"the power by {power_change[k]:+.2f} %"
    )

figure, (ax,) = new_panels(height=3.6)
rows = np.arange(len(names))
for shift, changes, color, label in (
    (-0.2, speed_change, style.BLUE, "speed"),
    (0.2, power_change, style.AMBER, "power"),
):
    bars = ax.barh(rows + shift, changes, 0.4, color=color, label=label)
    ax.bar_label(bars, fmt="%+.2f", padding=3, fontsize=style.TICK - 1)
labels = [name.split(".", 1)[1].replace("_", " ") for name in names]
ax.set_yticks(rows, [label.replace(".", " ") for label in labels])
ax.invert_yaxis()
ax.margins(x=0.12)
style.style_axes(ax, xlabel="change [%] for a change of 1 %", ylabel="")
handles, _ = ax.get_legend_handles_labels()
style.outside_legend(figure, handles, "outside lower center", ncols=2)
save_figure(figure, "sensitivities.png")
