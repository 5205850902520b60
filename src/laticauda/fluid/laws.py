"""Loads of the water (or the ground) on one rigid element, as scalar functions.

They are plain Python on purpose: the kernels compile them, and anything else may call them as they stand. A law of
one's own has the signature of `polynomial_drag` and is handed to `laticauda.simulate.plant(..., fluid_law=...)`.

All quantities are in the element's own axes: t along the element towards the head, n to its left. Velocities are those
of the element's middle relative to the water, or to the ground. The annotations say float; complex numbers work too,
which is how derivatives with respect to any argument are taken (complex step), and so do lanes, which is how many
trials are computed at once. So conditions look at the real part only, magnitudes come from `magnitude`, choices from
`laticauda.scalars.where`, and transcendental functions from numpy. A law with an `if` works as well; in a batch it is
then called trial by trial.
"""

import numpy as np

from laticauda.scalars import magnitude

# Keeps the direction of a velocity defined at rest, far below any speed that matters [m^2/s^2].
_AT_REST = 1e-30


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
    sway_friction: float,
) -> tuple[float, float, float]:
    """Linear plus quadratic drag: f = -c v (U_ref + |v|), tau = -(U_ref lambda_2 + lambda_3 |theta'|) theta'.

    The literature uses the same number for the linear and the quadratic part; U_ref is the speed that this implies.

    Along the element a third part may grow with how fast the element moves sideways,

        f_t = -c_t v_t (U_ref + |v_t| + gamma |v_n|)

    because sideways motion keeps the boundary layer thin. That friction grows so is established (Bone in [2]; review
    [3]); that it grows in proportion to |v_n| is this model, with one number to be identified: for a plate that moves
    along its normal into the flow, theory has the square root of the normal velocity [4].

    Args:
        v_t: Velocity along the element [m/s].
        v_n: Velocity across it [m/s].
        rate: Angular velocity theta' [rad/s].
        c_t: Drag coefficient along [N s^2/m^2], not negative.
        c_n: Drag coefficient across [N s^2/m^2], not negative.
        lambda_2: Coefficient of the linear torque [N s^2], not negative.
        lambda_3: Coefficient of the quadratic torque [N m s^2], not negative.
        reference_speed: U_ref, the speed at which linear and quadratic drag are equal [m/s]; it acts on the torque too.
        linear: 1 keeps the linear part of force and torque, 0 drops it.
        quadratic: 1 keeps the quadratic part, 0 drops it.
        sway_friction: gamma, not negative [-]; it acts whatever `linear` and `quadratic` say, 0 drops it.

    Returns:
        f_t [N], f_n [N], tau about the element's middle [N m]. None of the three ever feeds energy in: f_t v_t <= 0,
        f_n v_n <= 0, tau theta' <= 0.

    References:
        [1] E. Kelasidi et al., IEEE Robot. Autom. Mag. 23(1), 2016, eq. (7), which implies U_ref = 1 m/s.
        [2] M. J. Lighthill, Large-amplitude elongated-body theory of fish locomotion, Proc. R. Soc. B 179, 1971.
        [3] F. E. Fish, G. V. Lauder, Passive and active flow control by swimming fishes and mammals, Annu. Rev. Fluid
            Mech. 38, 2006.
        [4] U. Ehrenstein, C. Eloy, Skin friction on a moving wall and its implications for swimming animals, J. Fluid
            Mech. 718, 2013.
    """
    base = reference_speed * linear
    f_t = -c_t * v_t * (base + quadratic * magnitude(v_t) + sway_friction * magnitude(v_n))
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
    sway_friction: float,
) -> tuple[float, float, float]:
    """Dry anisotropic friction on the ground: f = -c v / sqrt(v^2 + eps^2), along and across on their own.

    That is -c sgn(v) with the jump at v = 0 spread over some eps. There is no torque about the contact.

    Args:
        v_t: Velocity along the element [m/s].
        v_n: Velocity across it [m/s].
        rate: Not used, like `lambda_2`, `lambda_3`, `linear`, `quadratic` and `sway_friction`: all laws have one
            signature.
        c_t: Friction along at speeds far above eps, mu_t m g [N], not negative.
        c_n: Friction across, mu_n m g [N], not negative.
        lambda_2: Not used.
        lambda_3: Not used.
        reference_speed: eps, positive [m/s].
        linear: Not used.
        quadratic: Not used.
        sway_friction: Not used.

    Returns:
        f_t [N], f_n [N], tau = 0 [N m]. Never feeds energy in: f_t v_t <= 0 and f_n v_n <= 0. |f_t| < c_t, |f_n| < c_n.
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

        C_L = (1 - s) a sin(alpha) cos(alpha) + s 2 sin(alpha) |sin(alpha)| cos(alpha)
        C_D = C_D0 + 2 |sin(alpha)|^3
        1 - s = 1 / ((1 + exp(-M (sin(alpha_0) - sin(alpha)))) (1 + exp(-M (sin(alpha_0) + sin(alpha)))))

    alpha is the angle of attack, a the lift slope, alpha_0 the stall angle, M the sharpness. The share s of separated
    flow and the way it blends the lift follow Beard and McLain [1], eqs. (4.9) and (4.10). Three things differ, so that
    the law holds all around the circle and needs no aspect ratio:

    - s sees sin(alpha) where they have alpha, so that flow from behind counts as attached again. To lowest order that
      is their stall with M cos(alpha_0) for M.
    - The attached lift is a sin(alpha) cos(alpha) where they have C_L0 + a alpha: the same for small alpha (C_L0 = 0).
    - Their drag, (4.11), adds the induced drag C_L^2 / (pi e R), R the aspect ratio. Ours adds 2 |sin(alpha)|^3, the
      drag that belongs to the separated lift: their resultant is normal to the plate, and 2 rho S v^2 / 2 at 90 deg.
      Induced drag before the stall is left out: put what matters of it into `parasitic_drag`.

    Args:
        v_t: Velocity along the chord relative to the water [m/s].
        v_n: Velocity across it [m/s].
        half_density_area: rho S / 2 [kg/m].
        lift_slope: a, slope of the lift coefficient at small angles [1/rad].
        stall_angle: alpha_0, between 0 and pi/2, where the flow separates: s = 1/2 there [rad].
        sharpness: M, how sudden that is [-]; below 4 / sin(alpha_0), s blunts the slope at alpha = 0 too.
        parasitic_drag: C_D0 [-].

    Returns:
        Force along the chord and across it [N]. Never feeds energy in: f . v = -rho S/2 |v|^3 C_D <= 0.

    References:
        [1] R. W. Beard, T. W. McLain, Small Unmanned Aircraft: Theory and Practice, Princeton University Press, 2012,
        ch. 4; the equations as published implementations of the book have them.
    """
    speed = (v_t * v_t + v_n * v_n + _AT_REST) ** 0.5
    sine, cosine = -v_n / speed, v_t / speed  # alpha is positive when the flow comes from the right
    size = magnitude(sine)
    # A logistic function is (1 + tanh) / 2, which cannot overflow however sharp the stall.
    half, stall = 0.5 * sharpness, np.sin(stall_angle)
    attached = 0.25 * (1.0 + np.tanh(half * (stall - sine))) * (1.0 + np.tanh(half * (stall + sine)))
    lift = (attached * lift_slope + (1.0 - attached) * 2.0 * size) * sine * cosine
    drag = parasitic_drag + 2.0 * size * size * size
    scale = half_density_area * speed
    # Drag acts against v, lift a quarter turn to the left of it.
    return scale * (-drag * v_t - lift * v_n), scale * (-drag * v_n + lift * v_t)
