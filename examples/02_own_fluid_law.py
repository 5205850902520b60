"""Swim in water with a drag law of your own: linear at low speed, and the drag
along the body depends on part of the sideways speed.

A law is a subclass of `DragLaw`: its fields are the parameters, and its `__call__`
is the formula. The law is part of the water, and its parameters have names, so they
can be swept, identified, stored and passed to an FMU. The kernels are compiled once
per formula, whatever the parameter values; an edited formula is recompiled
automatically.

    python examples/02_own_fluid_law.py
"""

from dataclasses import replace
from math import radians

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style
from laticauda.values.quantities import quantity, value_class
from laticauda.values.scalars import magnitude
from laticauda.water.fluid import DragLaw


@value_class
class WashedDrag(DragLaw):
    """Linear at low speed; along the body it sees some of the sideways speed."""

    wash: float = quantity(
        "",
        "Share of the sideways speed that the drag along sees",
        ge=0.0,
        default=0.2,
    )
    floor: float = quantity(
        "m/s", "Speed below which drag is linear", ge=0.0, default=0.1
    )

    def __call__(self, v_t, v_n, across, rate, element):
        f_t = (
            -element.c_t * v_t * (self.floor + magnitude(v_t) + self.wash * across)
        )
        f_n = -element.c_n * v_n * (self.floor + magnitude(v_n))
        return f_t, f_n, -element.lambda_3 * magnitude(rate) * rate


robot = lc.load_robot("mamba")
water = lc.load_water("paper-lateral")
gait = lc.lateral_undulation(
    amplitude=radians(30), frequency=radians(90), phase_shift=radians(40)
)
with_default_law = lc.swim(robot, gait)
print(
    f"{water.drag.words}: {with_default_law.forward_velocity:.4f} m/s, "
    f"{with_default_law.mean_power:.1f} W"
)
figure, (ax,) = new_panels(width=5.0)
for wash in (0.0, 0.2, 0.4):
    washed_water = replace(water, drag=WashedDrag(wash=wash))
    trial = lc.swim(robot, gait, environment=washed_water)
    print(
        f"{wash:.0%} of the sideways speed counts along: "
        f"{trial.forward_velocity:.4f} m/s, {trial.mean_power:.1f} W"
    )
    distance = trial.center_of_mass[:, 0]
    ax.plot(trial.time, distance, label=f"{wash:.0%} of the sideways speed")
distance = with_default_law.center_of_mass[:, 0]
ax.plot(with_default_law.time, distance, label="the usual law")
style.style_axes(ax, xlabel="time [s]", ylabel="distance [m]")
style.add_legend(ax, loc="upper left")
save_figure(figure, "laws.png")
