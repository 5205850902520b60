"""Water that moves uniformly or in layers: uniform flow that may turn and ramp up, linear and power-law shear."""

import math

import numpy as np

from laticauda.values import quantity, value_class, where
from laticauda.water.fluid.flow import Flow

BED_LAYER = 0.01
"""Fraction of the depth, from the bed, below which a power law becomes linear, because its slope is unbounded there."""


@value_class
class Uniform(Flow):
    """The same velocity everywhere, which may turn, like that of a tide, and start smoothly from rest.

    During the ramp T its magnitude is (1 - cos(pi t / T)) / 2 of the full one.
    """

    u: float = quantity("m/s", "Velocity along x", default=0.0)
    v: float = quantity("m/s", "Velocity along y", default=0.0)
    w: float = quantity("m/s", "Velocity upward", default=0.0)
    turning: float = quantity(
        "rad/s", "Rate at which it turns about the vertical, counter-clockwise", default=0.0
    )
    ramp: float = quantity("s", "T, time from rest to full speed", ge=0.0, default=0.0)

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion, which is the same everywhere."""
        zero = 0.0 * (x + y + z + t)
        begins = (t.real < self.ramp.real) & (self.ramp.real > 0.0)
        pace = math.pi / where(begins, self.ramp + zero, 1.0 + zero)
        share = where(begins, 0.5 - 0.5 * np.cos(pace * t), 1.0 + zero)
        rate = where(begins, 0.5 * pace * np.sin(pace * t), zero)
        c = np.cos(self.turning * t)
        s = np.sin(self.turning * t)
        u = c * self.u - s * self.v
        v = s * self.u + c * self.v
        rates = (
            rate * u - share * self.turning * v,
            rate * v + share * self.turning * u,
            rate * self.w,
        )
        velocity = share * u, share * v, share * self.w
        return *velocity, *rates, *(0.0,) * 10

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """Velocity of the flow if it neither turns nor has a ramp."""
        if self.turning or self.ramp:
            return None
        return self.u, self.v, self.w


@value_class
class LinearShear(Flow):
    """Straight layers whose speed changes across the flow, with the height, or both."""

    speed: float = quantity("m/s", "U, at the origin", default=0.0)
    direction: float = quantity(
        "rad", "Direction of flow, from the x axis, counter-clockwise", default=0.0
    )
    across: float = quantity(
        "1/s", "Gradient of the speed toward the left of the flow", default=0.0
    )
    upward: float = quantity("1/s", "Change of the speed with height", default=0.0)

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion, whose gradient is the same everywhere."""
        c = np.cos(self.direction)
        s = np.sin(self.direction)
        speed = self.speed + self.across * (c * y - s * x) + self.upward * z
        return layer(c, s, speed, self.across, self.upward)


@value_class
class PowerLawShear(Flow):
    """Layers of a river or tide: U (h / d)^n at the height h above the bed; above the surface as at the surface."""

    speed: float = quantity("m/s", "U, at the surface", default=0.1)
    direction: float = quantity(
        "rad", "Direction of flow, from the x axis, counter-clockwise", default=0.0
    )
    depth: float = quantity("m", "d, of the water", gt=0.0, default=1.0)
    exponent: float = quantity("", "n, about 1/7 in rivers", gt=0.0, le=1.0, default=1.0 / 7.0)

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion, which is zero below the bed."""
        zero = 0.0 * (x + y + z + t)
        h = 1.0 + z / self.depth
        outer = h.real > BED_LAYER
        inside = (h.real > 0.0) & (h.real < 1.0)
        h = where(inside, h + zero, where(h.real > 0.0, 1.0 + zero, zero))
        bound = where(outer, h, BED_LAYER + zero)
        scale = self.speed * bound**self.exponent / bound
        power = where(outer, self.exponent + zero, 1.0 + zero)
        slope = where(inside, power * scale / self.depth, zero)
        c = np.cos(self.direction)
        s = np.sin(self.direction)
        return layer(c, s, scale * h, zero, slope)


def layer(c: float, s: float, speed: float, across: float, upward: float) -> tuple[float, ...]:
    """Return the motion of straight layers.

    Args:
        c: Cosine of the direction of the flow.
        s: Sine of the direction of the flow.
        speed: Speed of this layer [m/s].
        across: Change of the speed to the left [1/s].
        upward: Change of the speed with the height [1/s].
    """
    slopes = (
        -c * s * across,
        c * c * across,
        c * upward,
        -s * s * across,
        c * s * across,
        s * upward,
    )
    return c * speed, s * speed, *(0.0,) * 4, *slopes, *(0.0,) * 4
