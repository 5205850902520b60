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
found = compute_sensitivities([scenario], names=names)
speed, power = (
    found.figures.index(figure) for figure in ("forward_velocity", "mean_power")
)

print(
    f"{found.values[0, speed]:.4f} m/s, {found.values[0, power]:.2f} W. One "
    "percent more of"
)
for k, parameter in enumerate(found.parameters):
    share = found.elasticity[0, :, k]
    print(
        f"  {parameter.name:<28} changes the speed by {share[speed]:+.2f} %, the "
        f"power by {share[power]:+.2f} %"
    )

figure, (ax,) = new_panels(height=3.6)
rows = np.arange(len(names))
for shift, figure_index, color, label in (
    (-0.2, speed, style.BLUE, "speed"),
    (0.2, power, style.AMBER, "power"),
):
    shares = found.elasticity[0, figure_index]
    bars = ax.barh(rows + shift, shares, 0.4, color=color, label=label)
    ax.bar_label(bars, fmt="%+.2f", padding=3, fontsize=style.TICK - 1)
labels = [name.split(".", 1)[1].replace("_", " ") for name in names]
ax.set_yticks(rows, [label.replace(".", " ") for label in labels])
ax.invert_yaxis()
ax.margins(x=0.12)
style.style_axes(ax, xlabel="change [%] for a change of 1 %", ylabel="")
handles, _ = ax.get_legend_handles_labels()
style.outside_legend(figure, handles, "outside lower center", ncols=2)
save_figure(figure, "sensitivities.png")
