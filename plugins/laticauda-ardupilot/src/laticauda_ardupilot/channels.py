"""Servo outputs: from the width of a pulse to an angle, a rate or a force of the robot.

Each kind of channel names one number of a command. Where several channels name the same one, their
values are added: this is how outputs of ArduPilot that already mix thrust and turning are taken
apart again.
"""

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

from laticauda.values import BadArgument, option, quantity, value_class

MOST_CHANNELS = 32
"""Servo outputs of ArduPilot at most."""


@value_class
class _Channel:
    """Common fields of all channels."""

    servo: int = quantity("", "Number of the output, as in SERVO1", ge=1, le=MOST_CHANNELS)
    pwm_min: float = quantity("us", "Pulse at which it has `at_min`", gt=0.0, default=1100.0)
    pwm_trim: float = quantity("us", "Pulse at which it has `at_trim`", gt=0.0, default=1500.0)
    pwm_max: float = quantity("us", "Pulse at which it has `at_max`", gt=0.0, default=1900.0)
    reversed: bool = option(
        "Whether pulses above the trim count as below it, and those below as above", default=False
    )

    def __post_init__(self) -> None:
        """Check the order of the pulses."""
        if not self.pwm_min <= self.pwm_trim <= self.pwm_max or self.pwm_min == self.pwm_max:
            rule = "must be between `pwm_min` and `pwm_max`, which must differ"
            pulses = f"{self.pwm_min:g}, {self.pwm_trim:g} and {self.pwm_max:g} us"
            raise BadArgument("pwm_trim", f"{rule}; got {pulses}")

    def share(self, pwm: int) -> float:
        """Return where a pulse lies between the least (-1), the trim (0) and the largest (1).

        Without a pulse, as long as ArduPilot is not armed, it is that of the trim.

        Args:
            pwm: Width of the pulse, 0 without one [us].
        """
        if pwm == 0:
            return 0.0
        limited = min(max(float(pwm), self.pwm_min), self.pwm_max)
        share = 0.0
        if limited > self.pwm_trim:
            share = (limited - self.pwm_trim) / (self.pwm_max - self.pwm_trim)
        elif limited < self.pwm_trim:
            share = (limited - self.pwm_trim) / (self.pwm_trim - self.pwm_min)
        return -share if self.reversed else share

    def between(self, pwm: int, at_min: float, at_trim: float, at_max: float) -> float:
        """Return the number between those at the least, the trim and the largest pulse.

        Args:
            pwm: Width of the pulse, 0 without one [us].
            at_min: Number at the least.
            at_trim: Number at the trim.
            at_max: Number at the largest.
        """
        share = self.share(pwm)
        if share < 0.0:
            return at_trim - share * (at_min - at_trim)
        return at_trim + share * (at_max - at_trim)


@value_class
class Amplitude(_Channel):
    """Amplitude of the gait; a sum below 0 counts as 0."""

    at_min: float = quantity("rad", "At the shortest pulse", ge=-math.pi, le=math.pi, default=0.0)
    at_trim: float = quantity("rad", "At the trim", ge=-math.pi, le=math.pi, default=0.0)
    at_max: float = quantity("rad", "At the longest pulse", ge=-math.pi, le=math.pi)


@value_class
class Frequency(_Channel):
    """Angular frequency of the gait; a sum below 0 counts as 0."""

    at_min: float = quantity("rad/s", "At the shortest pulse", default=0.0)
    at_trim: float = quantity("rad/s", "At the trim", default=0.0)
    at_max: float = quantity("rad/s", "At the longest pulse")


@value_class
class PhaseShift(_Channel):
    """Phase shift of the gait; where it changes its sign, the robot swims tail first."""

    at_min: float = quantity("rad", "At the shortest pulse", ge=-math.pi, le=math.pi, default=0.0)
    at_trim: float = quantity("rad", "At the trim", ge=-math.pi, le=math.pi, default=0.0)
    at_max: float = quantity("rad", "At the longest pulse", ge=-math.pi, le=math.pi)


@value_class
class Offset(_Channel):
    """Offset of the yaw joints, the rudder of a swimmer without one: positive turns left."""

    at_min: float = quantity("rad", "At the shortest pulse", ge=-math.pi, le=math.pi)
    at_trim: float = quantity("rad", "At the trim", ge=-math.pi, le=math.pi, default=0.0)
    at_max: float = quantity("rad", "At the longest pulse", ge=-math.pi, le=math.pi)


@value_class
class PitchOffset(_Channel):
    """Offset of the pitch joints, its elevator: positive turns down."""

    at_min: float = quantity("rad", "At the shortest pulse", ge=-math.pi, le=math.pi)
    at_trim: float = quantity("rad", "At the trim", ge=-math.pi, le=math.pi, default=0.0)
    at_max: float = quantity("rad", "At the longest pulse", ge=-math.pi, le=math.pi)


@value_class
class Thrust(_Channel):
    """Thrust of a thruster that has a `max_thrust`."""

    thruster: int = quantity("", "Which of them, counted from 0", ge=0, default=0)
    at_min: float = quantity("N", "At the shortest pulse")
    at_trim: float = quantity("N", "At the trim", default=0.0)
    at_max: float = quantity("N", "At the longest pulse")


@value_class
class Deflection(_Channel):
    """Angle of a pectoral fin that has a `max_deflection`."""

    fin: int = quantity("", "Which of them, counted from 0", ge=0, default=0)
    at_min: float = quantity("rad", "At the shortest pulse", ge=-math.pi, le=math.pi)
    at_trim: float = quantity("rad", "At the trim", ge=-math.pi, le=math.pi, default=0.0)
    at_max: float = quantity("rad", "At the longest pulse", ge=-math.pi, le=math.pi)


Channel: TypeAlias = Amplitude | Frequency | PhaseShift | Offset | PitchOffset | Thrust | Deflection


@dataclass(frozen=True, kw_only=True)
class Sums:
    """Sums of the channels of each kind; None where there is no channel of it."""

    amplitude: float | None
    """[rad]."""
    frequency: float | None
    """[rad/s]."""
    phase_shift: float | None
    """[rad]."""
    offset: float | None
    """[rad]."""
    pitch_offset: float | None
    """[rad]."""
    thrusts: dict[int, float]
    """By the number of the thruster [N]."""
    deflections: dict[int, float]
    """By the number of the fin [rad]."""


def add_channels(channels: tuple[Channel, ...], pwm: tuple[int, ...]) -> Sums:
    """Return what the pulses of all outputs stand for together.

    Args:
        channels: The channels.
        pwm: Width of the pulse of every output, 0 without one [us].
    """
    sums = dict[type[Any], float]()
    thrusts = dict[int, float]()
    deflections = dict[int, float]()
    for channel in channels:
        width = pwm[channel.servo - 1] if channel.servo <= len(pwm) else 0
        value = channel.between(width, channel.at_min, channel.at_trim, channel.at_max)
        if isinstance(channel, Thrust):
            thrusts[channel.thruster] = thrusts.get(channel.thruster, 0.0) + value
        elif isinstance(channel, Deflection):
            deflections[channel.fin] = deflections.get(channel.fin, 0.0) + value
        else:
            kind = type(channel)
            sums[kind] = sums.get(kind, 0.0) + value
    return Sums(
        amplitude=sums.get(Amplitude),
        frequency=sums.get(Frequency),
        phase_shift=sums.get(PhaseShift),
        offset=sums.get(Offset),
        pitch_offset=sums.get(PitchOffset),
        thrusts=thrusts,
        deflections=deflections,
    )
