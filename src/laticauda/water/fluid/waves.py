"""Waves of small steepness on water of any depth (Airy), and seas that are sums of such waves, from a seed.

The surface is at eta = a cos(theta), theta = k . x - omega t + phase, with omega^2 = g k tanh(k d);
below it the velocity is a omega cosh k(z + d) / sinh kd along the wave, in phase with the surface,
and a omega sinh k(z + d) / sinh kd upward, a quarter of a period ahead. This holds up to the mean
level; above it, in the crests, the motion is that at the mean level, and below the bed it is that
at the bed.
"""

import math
from functools import cached_property
from typing import Any, Literal

import numpy as np

from laticauda.values import BadArgument, hints_of, option, quantity, value_class, where
from laticauda.water.fluid.flow import Flow

GRAVITY = 9.81  # m/s^2
STEEPEST = (
    0.142  # height per length at which waves break, to be multiplied by tanh kd (Miche's limit)
)
DEEP = 300.0  # k d beyond which water counts as infinitely deep, and up to which exp(k d) does not overflow
BAND = (0.5, 3.0)  # frequencies of a sea relative to that of its peak


@value_class
class _Level(Flow):
    """A single wave at one height."""

    k_x: float = quantity("1/m", "Wave number along x")
    k_y: float = quantity("1/m", "Along y")
    omega: float = quantity("rad/s", "Frequency")
    phase: float = quantity("rad", "Of the crest")
    amplitude: float = quantity("m", "Of the surface")
    along_x: float = quantity("m/s", "Amplitude of u")
    along_y: float = quantity("m/s", "Of v")
    upward: float = quantity("m/s", "Of w")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion, which is the same at all heights."""
        return wave_motion(self, x, y, t, 1.0, 1.0)


@value_class
class _Wave(_Level):
    """A single wave at any height; its amplitudes are those at the mean level."""

    k: float = quantity("1/m", "Wave number")
    bed: float = quantity("", "k d, how deep the bed is")
    echo: float = quantity("", "exp(-2 k d), what it sends back")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion, above the mean level as at that level, below the bed as at the bed."""
        return wave_motion(self, x, y, t, *amplitude_shares(self, z))

    def at_height(self, z: float) -> Flow:
        """Return the wave with its amplitudes at height z as numbers."""
        along, upward = amplitude_shares(self, z)
        share = {"along_x": along, "along_y": along, "upward": upward}
        return _Level(
            **{name: getattr(self, name) * share.get(name, 1.0) for name in hints_of(_Level)}
        )


def amplitude_shares(wave: _Wave, z: float) -> tuple[float, float]:
    """Return the velocity amplitudes along a wave and upward, relative to those at the mean level.

    Args:
        wave: Wave.
        z: Height above the mean level [m].
    """
    depth = wave.k * where(z.real < 0.0, -z, 0.0 * z)
    growing = np.exp(-where(depth.real < wave.bed.real, depth, wave.bed + 0.0 * z))
    falling = wave.echo / growing
    return (growing + falling) / (1.0 + wave.echo), (growing - falling) / (1.0 - wave.echo)


def wave_motion(
    wave: Any, x: float, y: float, t: float, along: float, upward: float
) -> tuple[float, ...]:
    """Return the motion of the water in one wave.

    Args:
        wave: Wave.
        x: World coordinate x [m].
        y: World coordinate y [m].
        t: Time [s].
        along: Factor on the wave's amplitudes of u and v.
        upward: Factor on the wave's amplitude of w.
    """
    k_x, k_y, omega = wave.k_x, wave.k_y, wave.omega
    theta = k_x * x + (k_y * y + (wave.phase - omega * t))
    c, s = np.cos(theta), np.sin(theta)
    along_x, along_y, upward = along * wave.along_x, along * wave.along_y, upward * wave.upward
    p, q, r = along_x * s, along_y * s, upward * c
    slopes = (
        -k_x * p,
        -k_y * p,
        k_x * r,
        -k_x * q,
        -k_y * q,
        k_y * r,
        k_x * r,
        k_y * r,
        k_x * p + k_y * q,
    )
    return (
        along_x * c,
        along_y * c,
        upward * s,
        omega * p,
        omega * q,
        -omega * r,
        *slopes,
        wave.amplitude * c,
    )


def wave_component(
    amplitude: float, omega: float, direction: float, phase: float, depth: float
) -> _Wave:
    """Return one wave of a sea.

    Args:
        amplitude: Amplitude of the surface [m].
        omega: Frequency [rad/s].
        direction: Direction that the wave moves to, from the x axis [rad].
        phase: Phase of the crest at the origin, at the start [rad].
        depth: Depth of the water, infinite for deep water [m].
    """
    k = wave_number(omega, depth)
    bed, (x, y), speed = (
        min(k * depth, DEEP),
        (math.cos(direction), math.sin(direction)),
        amplitude * omega,
    )
    along = speed / math.tanh(bed)
    waves = {"omega": omega, "phase": phase, "amplitude": amplitude, "k_x": k * x, "k_y": k * y}
    speeds = {"along_x": along * x, "along_y": along * y, "upward": speed}
    return _Wave(**waves, **speeds, k=k, bed=bed, echo=math.exp(-2.0 * bed))


def wave_number(omega: float, depth: float) -> float:
    """Return the wave number k for a frequency: omega^2 = g k tanh kd, by Newton's method, to rounding.

    Args:
        omega: Frequency [rad/s].
        depth: Depth of the water, infinite for deep water [m].
    """
    deep = omega**2 / GRAVITY
    if (a := deep * depth) > DEEP:
        return deep
    kd = a / math.sqrt(math.tanh(a))  # Eckart's approximation, within 5 %
    for _ in range(6):
        tanh = math.tanh(kd)
        kd -= (kd * tanh - a) / (tanh + kd * (1.0 - tanh**2))
    return kd / depth


def check_unbroken(name: str, height: float, omega: float, depth: float) -> None:
    """Reject waves that are so steep that they would break.

    Args:
        name: Name of the argument with their height.
        height: Height from trough to crest [m].
        omega: Frequency [rad/s].
        depth: Depth of the water, infinite for deep water [m].
    """
    k = wave_number(omega, depth)
    most = STEEPEST * (length := 2.0 * math.pi / k) * math.tanh(k * depth)
    if height > most:
        raise BadArgument(
            name, f"must be <= {most:.4g} m, where waves {length:.4g} m long break, got {height:g}"
        )


@value_class
class Waves(Flow):
    """Regular waves of one period, which is given or follows from their length and the depth."""

    height: float = quantity("m", "H, from trough to crest", gt=0.0, default=0.1)
    period: float | None = quantity(
        "s", "T; from the `length`, or 2 s, if omitted", gt=0.0, default=None
    )
    length: float | None = quantity(
        "m", "From crest to crest; from the `period` if omitted", gt=0.0, default=None
    )
    depth: float = quantity("m", "d, of the water; deep if omitted", gt=0.0, default=math.inf)
    direction: float = quantity(
        "rad", "Direction of travel, from the x axis, counter-clockwise", default=0.0
    )
    phase: float = quantity(
        "rad", "Phase of the surface at the origin at the start; 0: a crest", default=0.0
    )

    def __post_init__(self) -> None:
        if self.period is not None and self.length is not None:
            found = 2.0 * math.pi / wave_number(self.omega, self.depth)
            if abs(self.length - found) > 1e-3 * found:
                raise BadArgument(
                    "length",
                    f"must be {found:.4g} m, as follows from the period, got {self.length:g}",
                )
        check_unbroken("height", self.height, self.omega, self.depth)

    @property
    def omega(self) -> float:
        """Frequency of the waves [rad/s]."""
        if self.period is not None or self.length is None:
            return 2.0 * math.pi / (self.period or 2.0)
        k = 2.0 * math.pi / self.length
        return math.sqrt(GRAVITY * k * math.tanh(k * self.depth))

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The single wave."""
        return (
            wave_component(0.5 * self.height, self.omega, self.direction, self.phase, self.depth),
        )


@value_class
class Sea(Flow):
    """Irregular waves of equal energy, with frequencies, directions and phases drawn from a spectrum by a seed.

    S ~ omega^-5 exp(-5/4 (omega_p/omega)^4) gamma^exp(-(omega/omega_p - 1)^2 / 2 sigma^2), sigma
    0.07 below the peak and 0.09 above it, within `BAND`; directions ~ cos^2s of half the angle from
    the mean direction.
    """

    significant_height: float = quantity(
        "m", "H_s, 4 standard deviations of the surface", gt=0.0, default=0.1
    )
    peak_period: float = quantity("s", "T_p, at the peak of the spectrum", gt=0.0, default=2.0)
    spectrum: Literal["jonswap", "pierson_moskowitz"] = option(
        "Shape; `jonswap` has a sharper peak", default="jonswap"
    )
    peakedness: float = quantity("", "gamma of `jonswap`", ge=1.0, le=10.0, default=3.3)
    direction: float = quantity("rad", "Mean direction of travel, from the x axis", default=0.0)
    spread: float = quantity(
        "rad", "Standard deviation of the direction", ge=0.0, le=1.4, default=0.0
    )
    depth: float = quantity("m", "d, of the water; deep if omitted", gt=0.0, default=math.inf)
    components: int = quantity("", "Number of waves", ge=1, le=1000, default=32)
    seed: int = quantity("", "Seed of frequencies, directions and phases", ge=0, default=0)

    def __post_init__(self) -> None:
        peak = 2.0 * math.pi / self.peak_period
        check_unbroken("significant_height", self.significant_height, peak, self.depth)

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The waves: one from each of `components` bands of equal energy, which together have H_s."""
        n, random = self.components, np.random.default_rng(self.seed)
        grid = np.linspace(*BAND, 4001)
        peak = np.exp(-((grid - 1.0) ** 2) / (2.0 * np.where(grid > 1.0, 0.09, 0.07) ** 2))
        gamma = self.peakedness if self.spectrum == "jonswap" else 1.0
        energy = np.cumsum(grid**-5.0 * np.exp(-1.25 * grid**-4.0) * gamma**peak)
        share = (np.arange(n) + random.random(n)) / n
        omega = np.interp(share, energy / energy[-1], grid) * 2.0 * math.pi / self.peak_period
        square = random.beta(
            2.0 / max(self.spread, 1e-9) ** 2 - 0.5, 0.5, n
        )  # cos^2 of half the angle
        side = 2.0 * np.arccos(np.sqrt(square)) * random.choice((-1.0, 1.0), n)
        amplitude = self.significant_height / math.sqrt(8.0 * n)
        phase = random.uniform(0.0, 2.0 * math.pi, n)
        waves = zip(omega.tolist(), (self.direction + side).tolist(), phase.tolist(), strict=True)
        return tuple(wave_component(amplitude, *wave, self.depth) for wave in waves)
