"""Loads of the water (or the ground) on one rigid element, as scalar functions.

They are plain Python on purpose: the kernels compile them, and anything else may call them as they stand. A law of
one's own has the signature of `polynomial_drag` and is handed to `laticauda.simulate.plant(..., fluid_law=...)`.
All quantities are in the element's own axes: t along the link towards the head, n to its left.
"""

import math


def magnitude(x: float) -> float:
    """|x|, also for complex-step derivatives, where it is x or -x by the sign of the real part."""
    return x if x.real >= 0.0 else -x


def polynomial_drag(
    v_t: float,
    v_n: float,
    rate: float,
    c_t: float,
    c_n: float,
    lambda_2: float,
    lambda_3: float,
    reference_speed: float,
    linear: float,
    quadratic: float,
) -> tuple[float, float, float]:
    """Linear plus quadratic drag: f = -c v (U_ref + |v|), tau = -(U_ref lambda_2 + lambda_3 |theta'|) theta'.

    Args:
        v_t: Velocity along the element relative to the water [m/s].
        v_n: Velocity across it [m/s].
        rate: Angular velocity theta' [rad/s].
        c_t: Drag coefficient along [N s^2/m^2].
        c_n: Drag coefficient across [N s^2/m^2].
        lambda_2: Coefficient of the linear torque [N s^2].
        lambda_3: Coefficient of the quadratic torque [N m s^2].
        reference_speed: U_ref, the speed at which linear and quadratic drag are equal [m/s].
        linear: 1 keeps the linear part, 0 drops it.
        quadratic: 1 keeps the quadratic part, 0 drops it.

    Returns:
        f_t [N], f_n [N], tau [N m]. They never feed energy in: f_t v_t + f_n v_n + tau theta' <= 0.
    """
    base = reference_speed * linear
    f_t = -c_t * v_t * (base + quadratic * magnitude(v_t))
    f_n = -c_n * v_n * (base + quadratic * magnitude(v_n))
    tau = -(base * lambda_2 + quadratic * lambda_3 * magnitude(rate)) * rate
    return f_t, f_n, tau


def coulomb_friction(
    v_t: float,
    v_n: float,
    rate: float,
    c_t: float,
    c_n: float,
    lambda_2: float,
    lambda_3: float,
    reference_speed: float,
    linear: float,
    quadratic: float,
) -> tuple[float, float, float]:
    """Dry anisotropic friction on the ground: f = -c v / sqrt(v^2 + eps^2), with c = mu m g and eps = U_ref.

    Same arguments as `polynomial_drag`; `c_t` and `c_n` are in N here, and there is no torque about the contact.
    """
    f_t = -c_t * v_t / (v_t * v_t + reference_speed * reference_speed) ** 0.5
    f_n = -c_n * v_n / (v_n * v_n + reference_speed * reference_speed) ** 0.5
    return f_t, f_n, 0.0 * rate


def plate(
    v_t: float,
    v_n: float,
    half_density_area: float,
    lift_slope: float,
    stall_angle: float,
    sharpness: float,
    parasitic_drag: float,
) -> tuple[float, float]:
    """Lift and drag of a flat plate, stall included, in the plate's axes (chord, normal).

        C_L = (1 - s) a sin(alpha) cos(alpha) + s 2 sign(alpha) sin^2(alpha) cos(alpha)
        C_D = C_D0 + 2 |sin(alpha)|^3

    The blend s(alpha) between attached and separated flow is that of Beard and McLain, Small Unmanned Aircraft
    (2012), eqs. (4.9)-(4.10). Two things differ so that the law holds all around the circle: the attached branch is
    a sin(alpha) cos(alpha), the same as a alpha for small alpha but valid for flow from behind, and the drag of the
    separated plate, 2 |sin|^3, belongs to the lift 2 sin^2 cos (their resultant is normal to the plate).

    Args:
        v_t: Velocity along the chord relative to the water [m/s].
        v_n: Velocity across it [m/s].
        half_density_area: rho S / 2 [kg/m].
        lift_slope: a, slope of the lift coefficient [1/rad].
        stall_angle: Angle of attack at which the flow separates [rad].
        sharpness: M, how sudden that is [-].
        parasitic_drag: C_D0 [-].

    Returns:
        Force along the chord and across it [N]; f . v <= 0.
    """
    speed_squared = v_t * v_t + v_n * v_n + 1e-30
    speed = speed_squared**0.5
    sine, cosine = -v_n / speed, v_t / speed  # of the angle of attack: positive when the flow comes from the right
    size = magnitude(sine)
    separated = 1.0 / (1.0 + math.exp(-sharpness * (size - math.sin(stall_angle))))
    lift = ((1.0 - separated) * lift_slope + separated * 2.0 * size) * sine * cosine
    drag = parasitic_drag + 2.0 * size * size * size
    scale = half_density_area * speed
    # Drag acts against v, lift a quarter turn to the left of it.
    return scale * (-drag * v_t - lift * v_n), scale * (-drag * v_n + lift * v_t)
