"""Waves of small steepness on water of any depth (Airy), and seas that are sums of such waves, from a seed.

The surface is at eta = a cos(theta), theta = k . x - omega t + phase, with omega^2 = g k tanh(k d);
below it the velocity is a omega cosh k(z + d) / sinh kd along the wave, in phase with the surface,
and a omega sinh k(z + d) / sinh kd upward, a quarter of a period ahead. This holds up to the mean
level; above it, in the crests, the motion is that at the mean level, and below the bed it is that
at the bed.
"""

import math
import warnings
from functools import cached_property
from typing import Any, Literal

import numpy as np

from laticauda.values import BadArgument, hints_of, option, quantity, value_class, where
from laticauda.water.fluid.flow import Flow

GRAVITY = 9.81
"""Standard gravity [m/s^2]."""
STEEPEST = 0.142
"""Height per length at which waves break, to be multiplied by tanh kd (Miche's limit) [-]."""
STEEPEST_SEAS = ((8.0, 1.0 / 15.0), (15.0, 1.0 / 25.0))
"""Peak period [s] and the H_s over the length at the peak in deep water up to which seas are found in
nature [-]; straight between them, constant beyond (DNV-RP-C205, 3.5.4; from memory)."""
DEEP = 300.0
"""k d beyond which water counts as infinitely deep, and up to which exp(k d) does not overflow [-]."""
BAND = (0.5, 3.0)
"""Lowest and highest frequency of a sea, relative to that of its peak [-]."""
N_FREQUENCIES = 4001
"""Frequencies at which the spectrum of a sea is summed."""
LENGTH_TOLERANCE = 1e-3
"""Share by which the length of waves may differ from the one that follows from their period [-]."""
NEWTON_STEPS = 6
"""Steps to the wave number: from an error of 5 % to rounding."""


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
        factors = {"along_x": along, "along_y": along, "upward": upward}
        numbers = {name: getattr(self, name) * factors.get(name, 1.0) for name in hints_of(_Level)}
        return _Level(**numbers)


def amplitude_shares(wave: _Wave, z: float) -> tuple[float, float]:
    """Return the velocity amplitudes along a wave and upward, relative to those at the mean level.

    Args:
        wave: Wave.
        z: Height above the mean level [m].
    """
    depth = wave.k * where(z.real < 0.0, -z, 0.0 * z)
    growing = np.exp(-where(depth.real < wave.bed.real, depth, wave.bed + 0.0 * z))
    falling = wave.echo / growing
    along = (growing + falling) / (1.0 + wave.echo)
    upward = (growing - falling) / (1.0 - wave.echo)
    return along, upward


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
    k_x = wave.k_x
    k_y = wave.k_y
    omega = wave.omega
    theta = k_x * x + (k_y * y + (wave.phase - omega * t))
    c = np.cos(theta)
    s = np.sin(theta)
    along_x = along * wave.along_x
    along_y = along * wave.along_y
    upward = upward * wave.upward
    p = along_x * s
    q = along_y * s
    r = upward * c
    velocity = along_x * c, along_y * c, upward * s
    rates = omega * p, omega * q, -omega * r
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
    return *velocity, *rates, *slopes, wave.amplitude * c


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
    bed = min(k * depth, DEEP)
    x = math.cos(direction)
    y = math.sin(direction)
    speed = amplitude * omega
    along = speed / math.tanh(bed)
    return _Wave(
        k_x=k * x,
        k_y=k * y,
        omega=omega,
        phase=phase,
        amplitude=amplitude,
        along_x=along * x,
        along_y=along * y,
        upward=speed,
        k=k,
        bed=bed,
        echo=math.exp(-2.0 * bed),
    )


def wave_number(omega: float, depth: float) -> float:
    """Return the wave number k for a frequency: omega^2 = g k tanh kd, by Newton's method, to rounding.

    Args:
        omega: Frequency [rad/s].
        depth: Depth of the water, infinite for deep water [m].
    """
    deep = omega**2 / GRAVITY
    a = deep * depth
    if a > DEEP:
        return deep
    kd = a / math.sqrt(math.tanh(a))  # Eckart's approximation, within 5 %
    for _ in range(NEWTON_STEPS):
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
    length = 2.0 * math.pi / k
    highest = STEEPEST * length * math.tanh(k * depth)
    if height > highest:
        limit = f"must be <= {highest:.4g} m, where waves {length:.4g} m long break"
        raise BadArgument(name, f"{limit}, got {height:g}")


def warn_of_steep_sea(significant_height: float, peak_period: float) -> None:
    """Warn of a sea that is steeper than those found in nature: breaking would take its energy.

    Args:
        significant_height: H_s [m].
        peak_period: T_p [s].
    """
    periods, steepnesses = zip(*STEEPEST_SEAS, strict=True)
    steepness = float(np.interp(peak_period, periods, steepnesses))
    length = GRAVITY * peak_period**2 / (2.0 * math.pi)
    highest = steepness * length
    if significant_height > highest:
        warnings.warn(
            f"`significant_height` {significant_height:g} m is more than seas with a peak period of {peak_period:g} s "
            f"reach, {highest:.2g} m: their waves break, which is not modeled",
            stacklevel=3,
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
            length_of_period = 2.0 * math.pi / wave_number(self.omega, self.depth)
            if abs(self.length - length_of_period) > LENGTH_TOLERANCE * length_of_period:
                rule = f"must be {length_of_period:.4g} m, as follows from the period"
                raise BadArgument("length", f"{rule}, got {self.length:g}")
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
        wave = wave_component(
            amplitude=0.5 * self.height,
            omega=self.omega,
            direction=self.direction,
            phase=self.phase,
            depth=self.depth,
        )
        return (wave,)


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
        warn_of_steep_sea(self.significant_height, self.peak_period)

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The waves: one from each of `components` bands of equal energy, which together have H_s."""
        n = self.components
        random = np.random.default_rng(self.seed)
        grid = np.linspace(*BAND, N_FREQUENCIES)
        energy = self._energy_below(grid)
        share = (np.arange(n) + random.random(n)) / n
        relative = np.interp(share, energy / energy[-1], grid)
        omega = relative * 2.0 * math.pi / self.peak_period

        side = self._draw_sides(random)
        amplitude = self.significant_height / math.sqrt(8.0 * n)
        phase = random.uniform(0.0, 2.0 * math.pi, n)
        columns = (omega.tolist(), (self.direction + side).tolist(), phase.tolist())
        return tuple(
            wave_component(
                amplitude=amplitude,
                omega=omega_of_wave,
                direction=direction,
                phase=phase_of_wave,
                depth=self.depth,
            )
            for omega_of_wave, direction, phase_of_wave in zip(*columns, strict=True)
        )

    def _energy_below(self, grid: np.ndarray) -> np.ndarray:
        """Return the energy up to each of some frequencies over that of the peak, in an arbitrary unit."""
        width = np.where(grid > 1.0, 0.09, 0.07)
        peak = np.exp(-((grid - 1.0) ** 2) / (2.0 * width**2))
        gamma = 1.0
        if self.spectrum == "jonswap":
            gamma = self.peakedness
        return np.cumsum(grid**-5.0 * np.exp(-1.25 * grid**-4.0) * gamma**peak)

    def _draw_sides(self, random: np.random.Generator) -> np.ndarray:
        """Draw the waves' directions relative to the mean one [rad]."""
        n = self.components
        cos_2 = random.beta(2.0 / max(self.spread, 1e-9) ** 2 - 0.5, 0.5, n)  # of half the angle
        return 2.0 * np.arccos(np.sqrt(cos_2)) * random.choice((-1.0, 1.0), n)
