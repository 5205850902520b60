"""Vortices about vertical axes, and the street of them behind a cylinder.

The velocity around a vortex of circulation Gamma (Lamb and Oseen) at the distance r from its axis is

    Gamma / (2 pi r) (1 - exp(-r^2 / r_c^2)),    r_c^2 = core^2 + 4 nu t

Behind a cylinder of diameter D in a stream U, vortices leave at the frequency St U / D, in turn on either side. In the
stable street the rows are .281 of their spacing l apart, and it moves through the water at Gamma / (sqrt(8) l) (von
Karman); so spacing and circulation follow from the share of U at which the street moves over ground.
"""

import math
from functools import cached_property

import numpy as np

from laticauda.errors import BadArgument
from laticauda.fluid.flow import Flow
from laticauda.fluid.uniform import Uniform
from laticauda.quantities import quantity, value
from laticauda.scalars import where

ROWS_APART = math.asinh(1.0) / math.pi  # of the spacing, .281
SMALL = 0.02  # of r^2 / r_c^2, below which series are taken
FADE = 0.06  # share of a street over which a vortex grows, and fades away at its end


def lamb_oseen(q: float) -> tuple[float, float, float]:
    """(1 - exp(-q)) / q, its slope, and exp(-q); by series near 0, where both are 0/0.

    Args:
        q: r^2 / r_c^2, not negative [-].
    """
    far = where(q.real > SMALL, q, 1.0 + 0.0 * q)
    fall = np.exp(-q)
    h = (1.0 - fall) / far
    slope = (fall - h) / far
    series = 1.0 - q * (0.5 - q * (1.0 / 6.0 - q * (1.0 / 24.0 - q * (1.0 / 120.0 - q / 720.0))))
    its_slope = -0.5 + q * (1.0 / 3.0 - q * (1.0 / 8.0 - q * (1.0 / 30.0 - q * (1.0 / 144.0 - q / 840.0))))
    return where(q.real > SMALL, h, series), where(q.real > SMALL, slope, its_slope), fall


def around(x: float, y: float, g: float, slope: float, g_t: float, c_x: float, c_y: float) -> tuple[float, ...]:
    """The motion around an axis that moves: velocity g (-y, x), with g a function of r^2 and t.

    Args:
        x: From the axis [m].
        y: The same [m].
        g: [1/s].
        slope: Of g with r^2 [1/(m^2 s)].
        g_t: Rate of g at a fixed r [1/s^2].
        c_x: Velocity of the axis [m/s].
        c_y: The same [m/s].
    """
    u_x, u_y = -2.0 * slope * x * y, -g - 2.0 * slope * y * y
    v_x, v_y = g + 2.0 * slope * x * x, 2.0 * slope * x * y
    u_t, v_t = -g_t * y - c_x * u_x - c_y * u_y, g_t * x - c_x * v_x - c_y * v_y
    return -g * y, g * x, 0.0, u_t, v_t, 0.0, u_x, u_y, 0.0, v_x, v_y, 0.0, 0.0, 0.0, 0.0, 0.0


@value
class LambOseen(Flow):
    """A vortex with a smooth core, which grows as the water's (or an eddy) viscosity spreads it."""

    circulation: float = quantity("m^2/s", "Gamma, positive counter-clockwise from above")
    core: float = quantity("m", "r_c at the start", gt=0.0)
    x: float = quantity("m", "Where its axis is at the start", default=0.0)
    y: float = quantity("m", "The same", default=0.0)
    velocity_x: float = quantity("m/s", "Of its axis", default=0.0)
    velocity_y: float = quantity("m/s", "The same", default=0.0)
    viscosity: float = quantity("m^2/s", "nu; of water 1e-6, of eddies more", ge=0.0, default=0.0)

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """The motion of the water, see `Flow.__call__`."""
        dx, dy = x - self.x - self.velocity_x * t, y - self.y - self.velocity_y * t
        wide = self.core * self.core + 4.0 * self.viscosity * t
        h, slope, fall = lamb_oseen((dx * dx + dy * dy) / wide)
        strength = 0.5 * self.circulation / (math.pi * wide)
        g_t = -4.0 * self.viscosity * strength * fall / wide
        return around(dx, dy, strength * h, strength * slope / wide, g_t, self.velocity_x, self.velocity_y)


@value
class _Shed(LambOseen):
    """One vortex of a street: it leaves the cylinder, goes downstream, fades away, and begins anew; its core stays."""

    life: float = quantity("s", "From one begin to the next", gt=0.0)
    born: float = quantity("s", "When it leaves for the first time")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """The motion of the water, see `Flow.__call__`."""
        share = (t - self.born) / self.life
        share = share - np.floor(share.real)
        dx, dy = x - self.x - self.velocity_x * self.life * share, y - self.y - self.velocity_y * self.life * share
        begun, left = share / FADE, (1.0 - share) / FADE
        begun, left = where(begun.real < 1.0, begun, 1.0 + 0.0 * begun), where(left.real < 1.0, left, 1.0 + 0.0 * left)
        grown, whole = begun * begun * (3.0 - 2.0 * begun), left * left * (3.0 - 2.0 * left)
        rate = 6.0 / (FADE * self.life) * (begun * (1.0 - begun) * whole - left * (1.0 - left) * grown)
        wide = self.core * self.core
        h, slope, _ = lamb_oseen((dx * dx + dy * dy) / wide)
        strength = 0.5 * self.circulation / (math.pi * wide)
        g, g_slope = strength * grown * whole, strength * grown * whole / wide
        return around(dx, dy, g * h, g_slope * slope, strength * rate * h, self.velocity_x, self.velocity_y)


@value
class KarmanStreet(Flow):
    """The street of vortices behind a vertical cylinder in a stream, with the stream.

    Vortices grow to their strength close behind the cylinder, go downstream and fade away at the street's end; what the
    cylinder itself does to the water around it is left out.
    """

    speed: float = quantity("m/s", "U, of the stream", gt=0.0, default=0.2)
    direction: float = quantity("rad", "To where the stream goes, from x counter-clockwise", default=0.0)
    diameter: float = quantity("m", "D, of the cylinder", gt=0.0, default=0.3)
    x: float = quantity("m", "Where the cylinder stands", default=0.0)
    y: float = quantity("m", "The same", default=0.0)
    strouhal: float = quantity("", "St, frequency of vortices of one side times D / U", gt=0.0, default=0.2)
    street_speed: float = quantity("", "Share of U at which vortices go downstream", gt=0.0, le=1.0, default=0.86)
    core: float = quantity("", "r_c of vortices per D", gt=0.0, le=1.0, default=0.25)
    pairs: int = quantity("", "How many pairs of vortices the street is long", ge=2, le=200, default=10)
    phase: float = quantity("rad", "Of the shedding at the start", default=0.0)

    def __post_init__(self) -> None:
        widest = 0.5 * self.spacing / self.diameter
        if self.core > widest:
            raise BadArgument("core", f"must be <= {widest:.4g}, half the way between vortices, got {self.core:g}")

    @property
    def frequency(self) -> float:
        """At which vortices of one side leave [Hz]."""
        return self.strouhal * self.speed / self.diameter

    @property
    def spacing(self) -> float:
        """l, of the vortices of one side [m]."""
        return self.street_speed * self.speed / self.frequency

    @property
    def circulation(self) -> float:
        """Of each vortex [m^2/s]."""
        return math.sqrt(8.0) * self.spacing * (1.0 - self.street_speed) * self.speed

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The stream, and both rows."""
        c, s, pace = math.cos(self.direction), math.sin(self.direction), self.street_speed * self.speed
        aside, life = 0.5 * ROWS_APART * self.spacing, self.pairs / self.frequency
        rows = [
            _Shed(
                x=self.x - side * aside * s,
                y=self.y + side * aside * c,
                velocity_x=pace * c,
                velocity_y=pace * s,
                circulation=-side * self.circulation,
                core=self.core * self.diameter,
                life=life,
                born=(k + 0.25 * (1 - side) - self.phase / (2.0 * math.pi)) / self.frequency,
            )
            for side in (1, -1)
            for k in range(self.pairs)
        ]
        return (Uniform(u=self.speed * c, v=self.speed * s), *rows)
