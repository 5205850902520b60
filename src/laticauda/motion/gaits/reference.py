"""Reference generator: from the requested gait to joint angles that a body can follow.

The request may change at any time. Amplitude, frequency, phase shift and offset each pass through a
critically damped second-order filter, the phase is the integral of the filtered frequency, and the
amplitude starts with a smooth ramp. Therefore phi_ref and phi_ref' are continuous for any request,
and phi_ref'' jumps only where the request jumps. Only the envelope is not filtered: bring the
amplitude to zero before requesting another kind of gait.

The filter has a closed-form solution for a constant input, so a time step of any size is exact.

A robot has up to three waves: of its yaw joints, of its pitch joints, and of a driven fin. They
share the time, the smooth start and the bandwidth.

These are plain scalar functions: the kernels of both models compile them;
`laticauda.motion.gaits.Generator` wraps them for a real robot. Sines and exp(-w dt), which each caller
computes in its own way, are passed as arguments. The annotations say float, but complex numbers
(complex-step derivatives) and lanes (many trials at once) also work.
"""

from typing import NamedTuple

from laticauda.values import where


class WaveTarget(NamedTuple):
    """Target of one wave."""

    amplitude: float
    """alpha [rad]."""
    frequency: float
    """omega [rad/s]."""
    phase_shift: float
    """delta between neighboring joints [rad]."""
    offset: float
    """phi_0 [rad]."""
    phase: float
    """Phase lead over the integral of the frequency; not filtered [rad]."""


class WaveState(NamedTuple):
    """State of one wave: values after the filters, with their rates."""

    phase: float
    """Integral of the frequency [rad]."""
    amplitude: float
    """alpha [rad]."""
    amplitude_rate: float
    """alpha' [rad/s]."""
    frequency: float
    """omega [rad/s]."""
    frequency_rate: float
    """omega' [rad/s^2]."""
    phase_shift: float
    """delta [rad]."""
    phase_shift_rate: float
    """delta' [rad/s]."""
    offset: float
    """phi_0 [rad]."""
    offset_rate: float
    """phi_0' [rad/s]."""


class WaveMotion(NamedTuple):
    """Quantities shared by the joints of one wave at one moment."""

    amplitude: float
    """alpha, ramp included [rad]."""
    amplitude_rate: float
    """alpha' [rad/s]."""
    amplitude_acceleration: float
    """alpha'' [rad/s^2]."""
    frequency: float
    """psi' of the first joint [rad/s]."""
    frequency_rate: float
    """psi'' of the first joint [rad/s^2]."""
    phase_shift_rate: float
    """Increment of psi' from joint to joint [rad/s]."""
    phase_shift_acceleration: float
    """Increment of psi'' from joint to joint [rad/s^2]."""
    offset: float
    """phi_0 [rad]."""
    offset_rate: float
    """phi_0' [rad/s]."""
    offset_acceleration: float
    """phi_0'' [rad/s^2]."""


def first_state(target: WaveTarget) -> WaveState:
    """Return the initial wave: amplitude, frequency and phase shift of its target; the offset builds up from zero.

    Args:
        target: Target at the start.
    """
    amplitude, frequency, phase_shift, _, _ = target
    return WaveState(0.0, amplitude, 0.0, frequency, 0.0, phase_shift, 0.0, 0.0, 0.0)


def advance_wave(
    wave: WaveState,
    target: tuple[float, float, float, float],
    bandwidth: float,
    decay: float,
    dt: float,
) -> WaveState:
    """Return a wave after a time step.

    Args:
        wave: Wave before the step.
        target: Target amplitude, frequency, phase shift and offset, held over the step.
        bandwidth: w, bandwidth of all its filters [rad/s].
        decay: exp(-w dt) [-].
        dt: Time step [s].
    """
    amplitude, amplitude_rate, _ = filter_step(wave[1], wave[2], target[0], bandwidth, decay, dt)
    frequency, frequency_rate, turned = filter_step(
        wave[3], wave[4], target[1], bandwidth, decay, dt
    )
    phase_shift, phase_shift_rate, _ = filter_step(
        wave[5], wave[6], target[2], bandwidth, decay, dt
    )
    offset, offset_rate, _ = filter_step(wave[7], wave[8], target[3], bandwidth, decay, dt)
    return WaveState(
        wave[0] + turned,
        amplitude,
        amplitude_rate,
        frequency,
        frequency_rate,
        phase_shift,
        phase_shift_rate,
        offset,
        offset_rate,
    )


def advance_time(time: float, rest: float, dt: float) -> tuple[float, float]:
    """Return the time after a step, and its accumulated rounding error (Kahan summation).

    Args:
        time: Time before the step [s].
        rest: Rounding error before the step [s].
        dt: Time step [s].
    """
    due = dt - rest
    after = time + due
    return after, (after - time) - due


def wave_motion(
    wave: WaveState,
    target: tuple[float, float, float, float],
    bandwidth: float,
    ramp: tuple[float, float, float],
) -> WaveMotion:
    """Return the quantities shared by the joints of a wave.

    Args:
        wave: State of the wave.
        target: Target amplitude, frequency, phase shift and offset.
        bandwidth: w, bandwidth of its filters [rad/s].
        ramp: Ramp from `smooth_start`.
    """
    second = filter_acceleration(wave[1], wave[2], target[0], bandwidth)
    amplitude, amplitude_rate, amplitude_acceleration = ramped(
        wave[1], wave[2], second, ramp[0], ramp[1], ramp[2]
    )
    return WaveMotion(
        amplitude,
        amplitude_rate,
        amplitude_acceleration,
        wave[3],
        wave[
            4
        ],  # the phase is the integral of the filtered frequency, so psi'' is the rate of that frequency
        wave[6],
        filter_acceleration(wave[5], wave[6], target[2], bandwidth),
        wave[7],
        wave[8],
        filter_acceleration(wave[7], wave[8], target[3], bandwidth),
    )


def wave_reference(
    sine: float, cosine: float, envelope: float, k: float, motion: WaveMotion
) -> tuple[float, float, float]:
    """Return phi_ref = alpha g sin(psi) + phi_0 (3) of one joint of a wave, and its first two derivatives.

    Args:
        sine: Sine of the joint's phase psi [-].
        cosine: Cosine of the joint's phase psi [-].
        envelope: g of this joint [-].
        k: Number of joints of the wave before this one [-].
        motion: Quantities shared by the joints.

    Returns:
        phi_ref [rad], phi_ref' [rad/s], phi_ref'' [rad/s^2].
    """
    a, a_1, a_2 = motion.amplitude, motion.amplitude_rate, motion.amplitude_acceleration
    phase_rate = motion.frequency + k * motion.phase_shift_rate
    phase_acceleration = motion.frequency_rate + k * motion.phase_shift_acceleration
    angle = envelope * a * sine + motion.offset
    rate = envelope * (a_1 * sine + a * phase_rate * cosine) + motion.offset_rate
    swing = a_2 * sine + 2.0 * a_1 * phase_rate * cosine
    turn = a * (phase_acceleration * cosine - phase_rate * phase_rate * sine)
    return angle, rate, envelope * (swing + turn) + motion.offset_acceleration


def between_knots(
    time: float,
    start: float,
    end: float,
    angle: float,
    rate: float,
    next_angle: float,
    next_rate: float,
) -> tuple[float, float, float]:
    """Return an angle between two knots of a cubic spline, and its first two derivatives; held outside the knots.

    Args:
        time: Current time [s].
        start: Time of the first knot [s].
        end: Time of the second knot [s].
        angle: Angle at the first knot [rad].
        rate: Rate at the first knot [rad/s].
        next_angle: Angle at the second knot [rad].
        next_rate: Rate at the second knot [rad/s].

    Returns:
        phi [rad], phi' [rad/s], phi'' [rad/s^2].
    """
    step = end - start
    share = (time - start) / step
    s = where(share.real > 0.0, where(share.real < 1.0, share, 1.0 + 0.0 * share), 0.0 * share)
    mean = (next_angle - angle) / step
    second = 3.0 * mean - 2.0 * rate - next_rate
    third = rate + next_rate - 2.0 * mean
    acceleration = (2.0 * second + 6.0 * s * third) / step
    moves = (share.real >= 0.0) & (share.real < 1.0)
    return (
        angle + step * s * (rate + s * (second + s * third)),
        rate + s * (2.0 * second + 3.0 * s * third),
        where(moves, acceleration, 0.0 * acceleration),
    )


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
        decay: exp(-w dt), passed in because it is the same for every filter [-].
        dt: Time step [s].

    Returns:
        y and y' after the step, and the integral of y over it [unit of y * s]. Two steps of dt/2
        give the same result as one step of dt.
    """
    error = value - target
    slope = rate + bandwidth * error
    left = (error + slope * dt) * decay
    delay = 1.0 / bandwidth
    gone = (error + slope * delay) * (1.0 - decay) - slope * dt * decay
    return target + left, (rate - bandwidth * slope * dt) * decay, target * dt + gone * delay


def filter_acceleration(value: float, rate: float, target: float, bandwidth: float) -> float:
    """Return y'' of the filter: w^2 (target - y) - 2 w y'.

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
    """Return the ramp s^3 (10 - 15 s + 6 s^2), s = t / T, and its first two time derivatives; 1 after T.

    Args:
        time: Time since the start, not negative [s].
        duration: T [s]; 0 means no ramp.

    Returns:
        Value [-], rate [1/s], acceleration [1/s^2]. All three are continuous; with T = 0 the value
        is 1 from the start.
    """
    over = time.real >= duration.real
    pace = 1.0 / where(over, 1.0 + 0.0 * duration, duration)
    s = where(
        over, 1.0 + 0.0 * time, time * pace
    )  # at its end the ramp has the value 1 and zero slopes
    value = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    rate = 30.0 * s * s * (1.0 - s) * (1.0 - s) * pace
    acceleration = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * pace * pace
    return value, rate, acceleration


def ramped(
    amplitude: float,
    rate: float,
    acceleration: float,
    ramp: float,
    ramp_rate: float,
    ramp_acceleration: float,
) -> tuple[float, float, float]:
    """Return the product of the filtered amplitude and the ramp, with its first two time derivatives.

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
