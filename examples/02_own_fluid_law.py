"""Swim in water of one's own: a power law between linear and quadratic drag.

A law is a plain function of scalars with the signature of `laticauda.fluid.laws.polynomial_drag`. A factory gives it
its constants. The kernels are compiled for it once; an edited law, or another exponent, compiles anew by itself.

    python examples/02_own_fluid_law.py
"""

from math import radians

import laticauda as lc


def power(v, exponent):
    return v * (v * v + 1e-12) ** (0.5 * (exponent - 1.0))


def make_power_law(exponent):
    def power_law(v_t, v_n, rate, c_t, c_n, lambda_2, lambda_3, reference_speed, linear, quadratic, sway_friction):
        f_t = -c_t * reference_speed ** (2.0 - exponent) * power(v_t, exponent)
        f_n = -c_n * reference_speed ** (2.0 - exponent) * power(v_n, exponent)
        return f_t, f_n, -lambda_2 * reference_speed * rate

    return power_law


robot = lc.load_robot("mamba")
gait = lc.lateral_undulation(amplitude=radians(30), frequency=radians(130), phase_shift=radians(40))
usual = lc.swim(robot, gait)
own = lc.swim(robot, gait, fluid_law=make_power_law(1.5))

print(f"linear + quadratic drag: {usual.forward_velocity:.4f} m/s, {usual.mean_power:.1f} W")
print(f"drag ~ v^1.5:            {own.forward_velocity:.4f} m/s, {own.mean_power:.1f} W")
