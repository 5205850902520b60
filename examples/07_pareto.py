"""What does speed cost? The front of speed against power for Mamba's eel-like
motion, with and without the caudal fin.

No other gait within the bounds is both faster and cheaper than one on the front.
Water and joints are those that were identified on the robot: the fin makes it faster,
for more power, and the servos limit both.

    python examples/07_pareto.py
"""

from math import degrees, radians

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.studies import Optimization, optimize

bounds = {
    "gait.amplitude": (radians(10), radians(50)),
    "gait.frequency": (radians(50), radians(150)),
    "gait.phase_shift": (radians(10), radians(60)),
}
gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)

figure, (ax,) = new_panels(width=5.4, height=3.4)
for name, label, side in (
    ("mamba-fin", "with the fin", "right"),
    ("mamba", "without the fin", "left"),
):
    scenario = lc.build_scenario(name, gait, parameters="mamba-identified")
    optimization = Optimization(scenario=scenario, bounds=bounds)
    front = optimize(optimization, budget=400, population=40, seed=1)
    speed = front.figures["forward_velocity"]
    power = front.figures["mechanical_power"]
    print(name)
    for i in front.spread(5):
        amplitude, frequency, phase_shift = front.values[i]
        print(
            f"  {speed[i]:.4f} m/s for {power[i]:5.2f} W: "
            f"{degrees(amplitude):.0f} deg, {degrees(frequency):.0f} deg/s, "
            f"{degrees(phase_shift):.0f} deg"
        )
    fastest = len(front) - 1
    limits = ", ".join(front.limits(fastest))
    print(f"  the fastest is limited by: {limits}")
    ax.plot(power, speed, marker=".", markersize=4, label=label)
    note = f"{speed[fastest]:.4f} m/s, limited by:\n" + limits.replace(", ", "\n")
    end = (power[fastest], speed[fastest])
    style.add_note(ax, note, end, (4, -14), va="top", ha=side, color=style.INK)
ax.set(xlim=(0.0, 14.0), ylim=(0.0, 0.3))
style.style_axes(ax, xlabel="mechanical power [W]", ylabel="forward velocity [m/s]")
style.add_legend(ax, loc="lower right")
save_figure(figure, "front.png")
