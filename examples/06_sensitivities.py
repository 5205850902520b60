"""What does the speed depend on? Derivatives with respect to any parameter of the
robot, the gait and the water.

python examples/06_sensitivities.py
"""

from math import radians

import matplotlib.pyplot as plt
import numpy as np

import laticauda as lc
from laticauda.models.simulate import compute_sensitivities

robot = lc.load_robot("mamba-fin")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
)
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
found = compute_sensitivities(robot, gait, names=names)
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

figure, ax = plt.subplots(figsize=(8, 4), layout="constrained")
rows = np.arange(len(names))
ax.barh(rows - 0.2, found.elasticity[0, speed], 0.4, label="speed")
ax.barh(rows + 0.2, found.elasticity[0, power], 0.4, label="power")
ax.set_yticks(rows, names)
ax.set_xlabel("change [%] for a change of 1 %")
ax.legend()
figure.savefig("sensitivities.png", dpi=150)
