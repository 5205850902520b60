"""Turbulence as a sum of Fourier modes, each free of divergence.

    u = sum of a_n cos(k_n . (x - U t) - omega_n t + phi_n),    a_n at right angles to k_n

Wave vectors, directions and phases are drawn from a seed (after Kraichnan, Phys. Fluids 13, 1970; not read). Between
the wave numbers of the largest and the smallest eddies the energy falls as k^(-5/3), and there is none outside:

    E(k) ~ k^(-5/3) for 2 pi / largest < k < 2 pi / smallest,    integral of E = 3/2 intensity^2

That range is cut into bands of equal ratio, and each mode has the energy of its band, |a_n|^2 / 4, at a wave number
drawn from it. The pattern is carried along by the mean velocity U (Taylor's hypothesis). It is frozen, or evolves:
omega_n is then drawn from a normal distribution as wide as `evolution` times an eddy's own rate, sqrt(k^3 E(k)).
"""

import math
from dataclasses import fields
from functools import cached_property

import numpy as np

from laticauda.errors import BadArgument
from laticauda.fluid.flow import Flow
from laticauda.fluid.uniform import Uniform
from laticauda.quantities import quantity, value


@value
class _Mode(Flow):
    """One wave of velocity."""

    a_x: float = quantity("m/s", "Amplitude")
    a_y: float = quantity("m/s", "The same")
    a_z: float = quantity("m/s", "The same")
    k_x: float = quantity("1/m", "Wave number")
    k_y: float = quantity("1/m", "The same")
    k_z: float = quantity("1/m", "The same")
    omega: float = quantity("rad/s", "Frequency")
    phase: float = quantity("rad", "At the origin at the start")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """The motion of the water, see `Flow.__call__`."""
        angle = self.k_x * x + self.k_y * y + self.k_z * z - self.omega * t + self.phase
        c, s = np.cos(angle), np.sin(angle)
        s_x, s_y, s_z = self.a_x * s, self.a_y * s, self.a_z * s
        along_x = -self.k_x * s_x, -self.k_y * s_x, -self.k_z * s_x
        along_y = -self.k_x * s_y, -self.k_y * s_y, -self.k_z * s_y
        along_z = -self.k_x * s_z, -self.k_y * s_z, -self.k_z * s_z
        rates = self.omega * s_x, self.omega * s_y, self.omega * s_z
        return self.a_x * c, self.a_y * c, self.a_z * c, *rates, *along_x, *along_y, *along_z, 0.0


@value
class Turbulence(Flow):
    """Homogeneous and isotropic turbulence, and the mean velocity that carries it."""

    intensity: float = quantity("m/s", "Root mean square of each component of the velocity", ge=0.0, default=0.03)
    largest: float = quantity("m", "Wave length of the largest eddies", gt=0.0, default=4.0)
    smallest: float = quantity("m", "Wave length of the smallest eddies", gt=0.0, default=0.4)
    mean: tuple[float, float, float] = quantity("m/s", "U, world axes", default=(0.0, 0.0, 0.0))
    evolution: float = quantity("", "Change of eddies per their own rate; 0: frozen", ge=0.0, default=0.0)
    modes: int = quantity("", "How many modes", ge=1, le=1000, default=32)
    seed: int = quantity("", "Of the random numbers", ge=0, default=0)

    def __post_init__(self) -> None:
        """Refuse eddies the smallest of which are the largest."""
        if not self.smallest < self.largest:
            raise BadArgument("smallest", f"must be < {self.largest:g} m, the largest eddies, got {self.smallest:g}")

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The modes, and the mean if there is one."""
        random, n = np.random.default_rng(self.seed), self.modes
        edges = 2.0 * math.pi / self.largest * (self.largest / self.smallest) ** (np.arange(n + 1) / n)
        energy = -np.diff(edges ** (-2.0 / 3.0))
        energy *= 1.5 * self.intensity**2 / energy.sum()
        k = np.exp(random.uniform(np.log(edges[:-1]), np.log(edges[1:])))
        direction, other = random.standard_normal((2, n, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        across = np.cross(direction, other)
        amplitude = (2.0 * np.sqrt(energy) / np.linalg.norm(across, axis=1))[:, np.newaxis] * across
        waves, density = k[:, np.newaxis] * direction, energy / np.diff(edges)
        omega = waves @ np.array(self.mean) + self.evolution * np.sqrt(k**3 * density) * random.standard_normal(n)
        phase = random.uniform(0.0, 2.0 * math.pi, n)
        table = np.column_stack((amplitude, waves, omega, phase)).tolist()
        names = [field.name for field in fields(_Mode)]
        found = tuple(_Mode(**dict(zip(names, row, strict=True))) for row in table)
        u, v, w = self.mean
        return (Uniform(u=u, v=v, w=w), *found) if any(self.mean) else found
