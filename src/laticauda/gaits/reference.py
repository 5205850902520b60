"""The reference generator: from the gait that is asked for to joint angles that a body can follow.

What is asked for may change at any time. Amplitude, frequency, phase shift and offset each pass through a critically
damped second-order filter, the phase is the integral of the filtered frequency, and the amplitude starts with a
smooth ramp. So phi_ref and phi_ref' are continuous whatever is asked for, and phi_ref'' jumps only where that jumps.
The envelope alone is not filtered: bring the amplitude to zero before another kind of gait is asked for.

The filter has a closed-form solution for a constant input, so a time step of any size is exact.

These are plain scalar functions: the kernels compile them; `laticauda.gaits.Generator` wraps them for a real robot.
The annotations say float; complex numbers work too, for complex-step derivatives, and lanes, for many trials at once.
"""

from laticauda.scalars import where


def filter_step(
    value: float, rate: float, target: float, bandwidth: float, decay: float, dt: float
) -> tuple[float, float, float]:
    """Advance y'' = w^2 (target - y) - 2 w y' by dt, exactly.

    With e = y - target and r = y' + w e, e(t) = (e + r t) exp(-w t).

    Args:
        value: y.
        rate: y' [unit of y / s].
        target: Constant input over the step.
        bandwidth: w, positive [rad/s].
        decay: exp(-w dt), handed in because it is the same for every filter [-].
        dt: Step [s].

    Returns:
        y and y' after the step, and the integral of y over it [unit of y * s]. Two steps of dt/2 give the same as one
        of dt.
    """
    error = value - target
    slope = rate + bandwidth * error
    left = (error + slope * dt) * decay
    delay = 1.0 / bandwidth
    gone = (error + slope * delay) * (1.0 - decay) - slope * dt * decay
    return target + left, (rate - bandwidth * slope * dt) * decay, target * dt + gone * delay


def filter_acceleration(value: float, rate: float, target: float, bandwidth: float) -> float:
    """y'' of the filter: w^2 (target - y) - 2 w y'.

    Args:
        value: y.
        rate: y' [unit of y / s].
        target: Input.
        bandwidth: w [rad/s].

    Returns:
        y'' [unit of y / s^2].
    """
    return bandwidth * (bandwidth * (target - value) - 2.0 * rate)


def smooth_start(time: float, duration: float) -> tuple[float, float, float]:
    """The ramp s^3 (10 - 15 s + 6 s^2), s = t / T, and its two time derivatives; 1 after T.

    Args:
        time: Since the start, not negative [s].
        duration: T [s]; 0 means no ramp.

    Returns:
        Value [-], rate [1/s], acceleration [1/s^2]. All three are continuous; with T = 0 the value is 1 from the start.
    """
    over = time.real >= duration.real
    pace = 1.0 / where(over, 1.0 + 0.0 * duration, duration)
    s = where(over, 1.0 + 0.0 * time, time * pace)  # at its end the ramp has the value 1 and no slopes
    value = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) * pace
    acceleration = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * pace * pace
    return value, rate, acceleration


def ramped(
    amplitude: float, rate: float, acceleration: float, ramp: float, ramp_rate: float, ramp_acceleration: float
) -> tuple[float, float, float]:
    """Product of the filtered amplitude and the ramp, with its two time derivatives.

    Args:
        amplitude: alpha [rad].
        rate: alpha' [rad/s].
        acceleration: alpha'' [rad/s^2].
        ramp: Value of `smooth_start` [-].
        ramp_rate: Its rate [1/s].
        ramp_acceleration: Its acceleration [1/s^2].

    Returns:
        Ramped amplitude [rad], its rate [rad/s] and its acceleration [rad/s^2].
    """
    return (
        amplitude * ramp,
        rate * ramp + amplitude * ramp_rate,
        acceleration * ramp + 2.0 * rate * ramp_rate + amplitude * ramp_acceleration,
    )


def joint_reference(
    sine: float,
    cosine: float,
    envelope: float,
    amplitude: float,
    amplitude_rate: float,
    amplitude_acceleration: float,
    phase_rate: float,
    phase_acceleration: float,
    offset: float,
    offset_rate: float,
    offset_acceleration: float,
) -> tuple[float, float, float]:
    """phi_ref = alpha g sin(psi) + phi_0 (3) and its two derivatives, given sin and cos of the joint's phase psi.

    Args:
        sine: sin(psi) [-].
        cosine: cos(psi) [-].
        envelope: g of this joint [-].
        amplitude: alpha, ramp included [rad].
        amplitude_rate: alpha' [rad/s].
        amplitude_acceleration: alpha'' [rad/s^2].
        phase_rate: psi' [rad/s].
        phase_acceleration: psi'' [rad/s^2].
        offset: phi_0 [rad].
        offset_rate: phi_0' [rad/s].
        offset_acceleration: phi_0'' [rad/s^2].

    Returns:
        phi_ref [rad], phi_ref' [rad/s], phi_ref'' [rad/s^2].
    """
    angle = envelope * amplitude * sine + offset
    rate = envelope * (amplitude_rate * sine + amplitude * phase_rate * cosine) + offset_rate
    swing = amplitude_acceleration * sine + 2.0 * amplitude_rate * phase_rate * cosine
    turn = amplitude * (phase_acceleration * cosine - phase_rate * phase_rate * sine)
    return angle, rate, envelope * (swing + turn) + offset_acceleration
