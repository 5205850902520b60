"""Joint laws: what torque an actuator delivers, and how stiffly it depends on the joint's angle and rate.

Each law returns the torque and the two slopes K_p = -du/dphi and K_d = -du/dphi' that an implicit time step needs.
They are plain scalar functions; the kernels compile them.
"""

import math


def pd(
    angle: float,
    rate: float,
    reference: float,
    reference_rate: float,
    reference_acceleration: float,
    proportional_gain: float,
    derivative_gain: float,
) -> tuple[float, float, float]:
    """The law of the published simulations: u = phi_ref'' + k_d (phi_ref' - phi') + k_p (phi_ref - phi).

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        reference_rate: phi_ref' [rad/s].
        reference_acceleration: phi_ref'' [rad/s^2]; fed forward with an inertia of 1 kg m^2.
        proportional_gain: k_p [N m/rad].
        derivative_gain: k_d [N m s/rad].

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad].
    """
    torque = (
        reference_acceleration
        + derivative_gain * (reference_rate - rate)
        + proportional_gain * (reference - angle)
    )
    return torque, proportional_gain, derivative_gain


def servo(
    angle: float,
    rate: float,
    reference: float,
    gain: float,
    stall_torque: float,
    no_load_speed: float,
    friction_torque: float,
    viscous_friction: float,
) -> tuple[float, float, float, float]:
    """A hobby servo: proportional control of a geared DC motor through its duty cycle.

        d = clip(gain (phi_ref - phi), -1, 1)
        u = u_stall (d - phi'/phi'_0) - b phi' - u_c tanh(phi'/eps),    eps = 0.05 rad/s

    Torque and speed are limited by the motor itself: at full duty it stalls at `stall_torque` and stops pulling at
    `no_load_speed`.

    Args:
        angle: phi [rad].
        rate: phi' [rad/s].
        reference: phi_ref [rad].
        gain: Duty per angle error [1/rad].
        stall_torque: u_stall [N m].
        no_load_speed: phi'_0 [rad/s].
        friction_torque: u_c, dry friction of the gear [N m].
        viscous_friction: b [N m s/rad].

    Returns:
        u [N m], K_p [N m/rad], K_d [N m s/rad], duty d [-].
    """
    demand = gain * (reference - angle)
    inside = 1.0 if -1.0 < demand.real < 1.0 else 0.0
    duty = demand if inside > 0.0 else (1.0 if demand.real > 0.0 else -1.0) + 0.0 * demand
    sliding = math.tanh(rate / 0.05)
    torque = stall_torque * (duty - rate / no_load_speed) - viscous_friction * rate - friction_torque * sliding
    damping = stall_torque / no_load_speed + viscous_friction + friction_torque / 0.05 * (1.0 - sliding * sliding)
    return torque, inside * gain * stall_torque, damping, duty


def servo_power(duty: float, rate: float, no_load_speed: float, stall_power: float) -> float:
    """Electrical power a servo draws, without idle: max(d (d - phi'/phi'_0), 0) V I_stall.

    The motor's current is proportional to its torque; the bridge draws it for the share d of the time and cannot
    give energy back.

    Args:
        duty: d [-].
        rate: phi' [rad/s].
        no_load_speed: phi'_0 [rad/s].
        stall_power: V I_stall [W].

    Returns:
        Power [W], not negative.
    """
    share = duty * (duty - rate / no_load_speed)
    return stall_power * (share if share.real > 0.0 else 0.0 * share)
