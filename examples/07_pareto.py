"""What does speed cost? The front of speed against power for Mamba's eel-like
motion, with and without the caudal fin.

No other gait within the bounds is both faster and cheaper than one on the front.

    python examples/07_pareto.py
"""

from math import radians

import matplotlib.pyplot as plt
import numpy as np

import laticauda as lc
from laticauda.studies import Optimization, optimize

bounds = {
    "gait.amplitude": (radians(10), radians(50)),
    "gait.frequency": (radians(50), radians(150)),
    "gait.phase_shift": (radians(10), radians(60)),
}
gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)

figure, ax = plt.subplots(layout="constrained")
for name in ("mamba", "mamba-fin"):
    front = optimize(
        Optimization(scenario=lc.build_scenario(name, gait), bounds=bounds),
        budget=400,
        population=40,
        seed=1,
    )
    print(name)
    for i in front.spread(5):
        alpha, omega, delta = np.degrees(front.values[i])
        speed, power = (
            front.figures["forward_velocity"][i],
            front.figures["mechanical_power"][i],
        )
        print(
            f"  {speed:.3f} m/s for {power:6.2f} W: {alpha:.0f} deg, {omega:.0f} "
            f"deg/s, {delta:.0f} deg"
        )
    ax.plot(
        front.figures["forward_velocity"],
        front.figures["mechanical_power"],
        ".",
        label=name,
    )
ax.set(xlabel="forward velocity [m/s]", ylabel="mechanical power [W]")
ax.legend()
figure.savefig("front.png", dpi=150)
