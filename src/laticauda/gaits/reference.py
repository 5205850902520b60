"""The reference generator: from the gait that is asked for to joint angles that a body can follow.

What is asked for may change at any time. Amplitude, frequency, phase shift and offset each pass through a critically
damped second-order filter, the phase is the integral of the filtered frequency, and the amplitude starts with a
smooth ramp. So phi_ref is continuous with its first derivative, whatever happens. The filter has a closed-form
solution for a constant input, so a time step of any size is exact.

These are plain scalar functions: the kernels compile them; `laticauda.gaits.Generator` wraps them for a real robot.
"""


def filter_step(
    value: float, rate: float, target: float, bandwidth: float, decay: float, dt: float
) -> tuple[float, float, float]:
    """Advance y'' = w^2 (target - y) - 2 w y' by dt, exactly.

    Args:
        value: y.
        rate: y' [1/s].
        target: Constant input over the step.
        bandwidth: w [rad/s].
        decay: exp(-w dt), handed in because it is the same for every filter.
        dt: Step [s].

    Returns:
        y, y' after the step, and the integral of y over it.
    """
    error = value - target
    slope = rate + bandwidth * error
    left = (error + slope * dt) * decay
    gone = (error + slope / bandwidth) * (1.0 - decay) - slope * dt * decay
    return target + left, (rate - bandwidth * slope * dt) * decay, target * dt + gone / bandwidth


def filter_acceleration(value: float, rate: float, target: float, bandwidth: float) -> float:
    """y'' of the filter: w^2 (target - y) - 2 w y'."""
    return bandwidth * (bandwidth * (target - value) - 2.0 * rate)


def smooth_start(time: float, duration: float) -> tuple[float, float, float]:
    """The ramp s^3 (10 - 15 s + 6 s^2), s = t / T, and its two time derivatives; 1 after T.

    Args:
        time: Since the start [s].
        duration: T [s]; 0 means no ramp.

    Returns:
        Value, rate [1/s], acceleration [1/s^2]; all continuous.
    """
    if time.real >= duration.real:
        return 1.0, 0.0, 0.0
    s = time / duration
    value = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration
    acceleration = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (duration * duration)
    return value, rate, acceleration


def ramped(
    amplitude: float, rate: float, acceleration: float, ramp: float, ramp_rate: float, ramp_acceleration: float
) -> tuple[float, float, float]:
    """Product of the filtered amplitude and the ramp, with both derivatives."""
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

    Returns:
        phi_ref [rad], phi_ref' [rad/s], phi_ref'' [rad/s^2].
    """
    angle = envelope * amplitude * sine + offset
    rate = envelope * (amplitude_rate * sine + amplitude * phase_rate * cosine) + offset_rate
    swing = amplitude_acceleration * sine + 2.0 * amplitude_rate * phase_rate * cosine
    turn = amplitude * (phase_acceleration * cosine - phase_rate * phase_rate * sine)
    return angle, rate, envelope * (swing + turn) + offset_acceleration
