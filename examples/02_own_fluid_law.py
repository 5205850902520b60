"""Swim in water of one's own: a power law between linear and quadratic drag.

A law is a value below `DragLaw`: its fields are its numbers, its `__call__` is the formula. It stands in the water, and
its numbers have names: they can be swept, identified, stored and given to an FMU. The kernels are compiled for the
formula once, whatever its numbers; an edited formula compiles anew by itself.

    python examples/02_own_fluid_law.py
"""

from dataclasses import replace
from math import radians

import laticauda as lc
from laticauda.fluid import DragLaw
from laticauda.quantities import quantity, value


def power(v, exponent):
    return v * (v * v + 1e-12) ** (0.5 * (exponent - 1.0))


@value
class PowerDrag(DragLaw):
    """Drag that grows with a power of the speed."""

    exponent: float = quantity("", "Of the speed", ge=1.0, le=2.0, default=1.5)

    def __call__(self, v_t, v_n, across, rate, element):
        return (
            -element.c_t * power(v_t, self.exponent),
            -element.c_n * power(v_n, self.exponent),
            -element.lambda_2 * rate,
        )


robot, water = lc.load_robot("mamba"), lc.load_water("paper-lateral")
gait = lc.lateral_undulation(amplitude=radians(30), frequency=radians(130), phase_shift=radians(40))
usual = lc.swim(robot, gait)
print(f"{water.drag.words}: {usual.forward_velocity:.4f} m/s, {usual.mean_power:.1f} W")
for exponent in (1.2, 1.5, 1.8):
    own = lc.swim(robot, gait, environment=replace(water, drag=PowerDrag(exponent=exponent)))
    print(f"drag ~ v^{exponent}: {own.forward_velocity:.4f} m/s, {own.mean_power:.1f} W")
