"""Eddies: vortices about vertical axes, the vortex street behind a cylinder, and turbulence.

The velocity around a vortex of circulation Gamma (Lamb and Oseen) at the distance r from its axis
is

    Gamma / (2 pi r) (1 - exp(-r^2 / r_c^2)),    r_c^2 = core^2 + 4 nu t

Behind a cylinder of diameter D in a stream U, vortices are shed at the frequency St U / D,
alternately on either side. In the stable street the rows are .281 of their spacing l apart, and it
moves through the water at Gamma / (sqrt(8) l) (von Karman); spacing and circulation therefore
follow from the share of U at which the street moves over ground.

Turbulence is a sum of Fourier modes, each divergence-free:

    u = sum of a_n cos(k_n . (x - U t) - omega_n t + phi_n),    a_n at right angles to k_n

Wave vectors, directions and phases are drawn from a seed (after Kraichnan, Phys. Fluids 13, 1970;
not read). Between the wave numbers of the largest and the smallest eddies the energy falls as
k^(-5/3), and it is zero outside:

    E(k) ~ k^(-5/3) for 2 pi / largest < k < 2 pi / smallest,    integral of E = 3/2 intensity^2

That range is divided into bands of equal ratio, and each mode has the energy of its band, |a_n|^2 /
4, at a wave number drawn from the band. The mean velocity U carries the pattern along (Taylor's
hypothesis). The pattern is frozen or evolves: omega_n is then drawn from a normal distribution with
a width of `evolution` times an eddy's own rate, sqrt(k^3 E(k)).
"""

import math
from dataclasses import fields
from functools import cached_property

import numpy as np

from laticauda.values import BadArgument, quantity, value_class, where
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.uniform import Uniform

ROWS_APART = math.asinh(1.0) / math.pi
"""Distance of the rows of a stable street, .281 of the spacing of its vortices [-]."""
SMALL = 0.02
"""Value of r^2 / r_c^2 below which series are used [-]."""
FADE = 0.06
"""Share of a street over which a vortex grows, and over which it fades at the end [-]."""


def lamb_oseen(q: float) -> tuple[float, float, float]:
    """Return (1 - exp(-q)) / q, its slope, and exp(-q); the first two by series near 0, where they are 0/0.

    Args:
        q: r^2 / r_c^2, not negative [-].
    """
    far = where(q.real > SMALL, q, 1.0 + 0.0 * q)
    fall = np.exp(-q)
    h = (1.0 - fall) / far
    slope = (fall - h) / far
    series = 1.0 - q * (0.5 - q * (1.0 / 6.0 - q * (1.0 / 24.0 - q * (1.0 / 120.0 - q / 720.0))))
    its_slope = -0.5 + q * (
        1.0 / 3.0 - q * (1.0 / 8.0 - q * (1.0 / 30.0 - q * (1.0 / 144.0 - q / 840.0)))
    )
    return where(q.real > SMALL, h, series), where(q.real > SMALL, slope, its_slope), fall


def around(
    x: float, y: float, g: float, slope: float, g_t: float, c_x: float, c_y: float
) -> tuple[float, ...]:
    """Return the motion around a moving axis: velocity g (-y, x), with g a function of r^2 and t.

    Args:
        x: Distance from the axis along x [m].
        y: Distance from the axis along y [m].
        g: Angular velocity g [1/s].
        slope: Derivative of g with respect to r^2 [1/(m^2 s)].
        g_t: Rate of change of g at a fixed r [1/s^2].
        c_x: Velocity of the axis along x [m/s].
        c_y: Velocity of the axis along y [m/s].
    """
    u = -g * y
    v = g * x
    u_x = -2.0 * slope * x * y
    u_y = -g - 2.0 * slope * y * y
    v_x = g + 2.0 * slope * x * x
    v_y = 2.0 * slope * x * y
    u_t = -g_t * y - c_x * u_x - c_y * u_y
    v_t = g_t * x - c_x * v_x - c_y * v_y
    return u, v, 0.0, u_t, v_t, 0.0, u_x, u_y, 0.0, v_x, v_y, 0.0, 0.0, 0.0, 0.0, 0.0


@value_class
class LambOseen(Flow):
    """A vortex with a smooth core that grows by viscosity (of the water or an eddy viscosity)."""

    circulation: float = quantity("m^2/s", "Gamma, positive counter-clockwise from above")
    core: float = quantity("m", "r_c at the start", gt=0.0)
    x: float = quantity("m", "Initial x of its axis", default=0.0)
    y: float = quantity("m", "Initial y of its axis", default=0.0)
    velocity_x: float = quantity("m/s", "Velocity of its axis along x", default=0.0)
    velocity_y: float = quantity("m/s", "Velocity of its axis along y", default=0.0)
    viscosity: float = quantity(
        "m^2/s", "nu: 1e-6 for water, more as an eddy viscosity", ge=0.0, default=0.0
    )

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion of the water, see `Flow.__call__`."""
        dx = x - self.x - self.velocity_x * t
        dy = y - self.y - self.velocity_y * t
        core_2 = self.core * self.core + 4.0 * self.viscosity * t
        h, slope, fall = lamb_oseen((dx * dx + dy * dy) / core_2)
        strength = 0.5 * self.circulation / (math.pi * core_2)
        g = strength * h
        g_slope = strength * slope / core_2
        g_t = -4.0 * self.viscosity * strength * fall / core_2
        return around(dx, dy, g, g_slope, g_t, self.velocity_x, self.velocity_y)


def smooth_step(s: float) -> tuple[float, float]:
    """Return a smooth step from 0 at s <= 0 to 1 at s >= 1, and its slope.

    Args:
        s: Share of the step [-].
    """
    not_negative = where(s.real > 0.0, s, 0.0 * s)
    share = where(not_negative.real < 1.0, not_negative, 1.0 + 0.0 * s)
    return share * share * (3.0 - 2.0 * share), 6.0 * share * (1.0 - share)


@value_class
class _Shed(LambOseen):
    """One vortex of a street: it leaves the cylinder, drifts downstream, fades, and restarts; its core is constant."""

    life: float = quantity("s", "Time from one start to the next", gt=0.0)
    born: float = quantity("s", "Time at which it first leaves")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion of the water, see `Flow.__call__`."""
        share = (t - self.born) / self.life
        share = share - np.floor(share.real)
        dx = x - self.x - self.velocity_x * self.life * share
        dy = y - self.y - self.velocity_y * self.life * share

        # Up at the beginning of a life, down at its end.
        grown_share, growth_slope = smooth_step(share / FADE)
        unfaded_share, fading_slope = smooth_step((1.0 - share) / FADE)
        strength_share = grown_share * unfaded_share
        slope_of_share = growth_slope * unfaded_share - grown_share * fading_slope
        rate = slope_of_share / (FADE * self.life)

        core_2 = self.core * self.core
        h, slope, _ = lamb_oseen((dx * dx + dy * dy) / core_2)
        strength = 0.5 * self.circulation / (math.pi * core_2)
        g = strength * strength_share
        g_slope = strength * strength_share / core_2
        g_t = strength * rate * h
        return around(dx, dy, g * h, g_slope * slope, g_t, self.velocity_x, self.velocity_y)


@value_class
class KarmanStreet(Flow):
    """The vortex street behind a vertical cylinder in a stream, including the stream.

    Vortices grow to full strength close behind the cylinder, drift downstream and fade at the end
    of the street; the effect of the cylinder itself on the water around it is neglected.
    """

    speed: float = quantity("m/s", "U, of the stream", gt=0.0, default=0.2)
    direction: float = quantity(
        "rad", "Direction of the stream, from the x axis, counter-clockwise", default=0.0
    )
    diameter: float = quantity("m", "D, of the cylinder", gt=0.0, default=0.3)
    x: float = quantity("m", "x of the cylinder", default=0.0)
    y: float = quantity("m", "y of the cylinder", default=0.0)
    strouhal: float = quantity(
        "", "St, shedding frequency on one side times D / U", gt=0.0, default=0.2
    )
    street_speed: float = quantity(
        "", "Downstream speed of vortices as a fraction of U", gt=0.0, le=1.0, default=0.86
    )
    core: float = quantity(
        "", "r_c of the vortices as a fraction of D", gt=0.0, le=1.0, default=0.25
    )
    pairs: int = quantity("", "Length of the street in pairs of vortices", ge=2, le=200, default=10)
    phase: float = quantity("rad", "Initial phase of the shedding", default=0.0)

    def __post_init__(self) -> None:
        widest = 0.5 * self.spacing / self.diameter
        if self.core > widest:
            raise BadArgument(
                "core", f"must be <= {widest:.4g}, half the vortex spacing, got {self.core:g}"
            )

    @property
    def frequency(self) -> float:
        """Frequency at which the vortices of one side are shed [Hz]."""
        return self.strouhal * self.speed / self.diameter

    @property
    def spacing(self) -> float:
        """Spacing l of the vortices of one side [m]."""
        return self.street_speed * self.speed / self.frequency

    @property
    def circulation(self) -> float:
        """Circulation of each vortex [m^2/s]."""
        return math.sqrt(8.0) * self.spacing * (1.0 - self.street_speed) * self.speed

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The stream and both rows of vortices."""
        cosine = math.cos(self.direction)
        sine = math.sin(self.direction)
        stream = Uniform(u=self.speed * cosine, v=self.speed * sine)
        left_row = self._row_of_vortices(1)
        right_row = self._row_of_vortices(-1)
        return (stream, *left_row, *right_row)

    def _row_of_vortices(self, side: int) -> list[_Shed]:
        """Return the vortices to the left (1) or to the right (-1) of the cylinder's wake."""
        c = math.cos(self.direction)
        s = math.sin(self.direction)
        pace = self.street_speed * self.speed
        aside = 0.5 * ROWS_APART * self.spacing
        return [
            _Shed(
                x=self.x - side * aside * s,
                y=self.y + side * aside * c,
                velocity_x=pace * c,
                velocity_y=pace * s,
                circulation=-side * self.circulation,
                core=self.core * self.diameter,
                life=self.pairs / self.frequency,
                born=(k + 0.25 * (1 - side) - self.phase / (2.0 * math.pi)) / self.frequency,
            )
            for k in range(self.pairs)
        ]


@value_class
class _Mode(Flow):
    """One Fourier mode of the velocity."""

    a_x: float = quantity("m/s", "Amplitude")
    a_y: float = quantity("m/s", "The same")
    a_z: float = quantity("m/s", "The same")
    k_x: float = quantity("1/m", "Wave number")
    k_y: float = quantity("1/m", "The same")
    k_z: float = quantity("1/m", "The same")
    omega: float = quantity("rad/s", "Frequency")
    phase: float = quantity("rad", "At the origin at the start")

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion of the water, see `Flow.__call__`."""
        angle = self.k_x * x + self.k_y * y + self.k_z * z - self.omega * t + self.phase
        c = np.cos(angle)
        s = np.sin(angle)
        velocity = self.a_x * c, self.a_y * c, self.a_z * c
        s_x = self.a_x * s
        s_y = self.a_y * s
        s_z = self.a_z * s
        rates = self.omega * s_x, self.omega * s_y, self.omega * s_z
        slopes_of_u = -self.k_x * s_x, -self.k_y * s_x, -self.k_z * s_x
        slopes_of_v = -self.k_x * s_y, -self.k_y * s_y, -self.k_z * s_y
        slopes_of_w = -self.k_x * s_z, -self.k_y * s_z, -self.k_z * s_z
        return *velocity, *rates, *slopes_of_u, *slopes_of_v, *slopes_of_w, 0.0


@value_class
class Turbulence(Flow):
    """Homogeneous isotropic turbulence and the mean velocity that carries it."""

    intensity: float = quantity(
        "m/s", "Root mean square of each component of the velocity", ge=0.0, default=0.03
    )
    largest: float = quantity("m", "Wavelength of the largest eddies", gt=0.0, default=4.0)
    smallest: float = quantity("m", "Wavelength of the smallest eddies", gt=0.0, default=0.4)
    mean: tuple[float, float, float] = quantity("m/s", "U in world axes", default=(0.0, 0.0, 0.0))
    evolution: float = quantity(
        "", "Rate of change of eddies per their own rate; 0: frozen", ge=0.0, default=0.0
    )
    modes: int = quantity("", "Number of modes", ge=1, le=1000, default=32)
    seed: int = quantity("", "Seed of the random numbers", ge=0, default=0)

    def __post_init__(self) -> None:
        """Reject smallest eddies that are not smaller than the largest."""
        if not self.smallest < self.largest:
            raise BadArgument(
                "smallest", f"must be < `largest` = {self.largest:g} m, got {self.smallest:g}"
            )

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """The modes, and the mean flow if there is one."""
        modes = self._draw_modes()
        if not any(self.mean):
            return modes
        u, v, w = self.mean
        return (Uniform(u=u, v=v, w=w), *modes)

    def _draw_modes(self) -> tuple[_Mode, ...]:
        """Draw wave vectors, directions and phases from the seed; the order of draws decides the result."""
        random = np.random.default_rng(self.seed)
        n = self.modes
        edges = self._edges_of_bands()
        energy = -np.diff(edges ** (-2.0 / 3.0))  # of each band: the integral of k^(-5/3)
        energy *= 1.5 * self.intensity**2 / energy.sum()

        k = np.exp(random.uniform(np.log(edges[:-1]), np.log(edges[1:])))
        direction, auxiliary = random.standard_normal((2, n, 3))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        wave_vector = k[:, np.newaxis] * direction

        across = np.cross(direction, auxiliary)
        size = 2.0 * np.sqrt(energy) / np.linalg.norm(across, axis=1)
        amplitude = size[:, np.newaxis] * across

        density = energy / np.diff(edges)  # E(k)
        own_rate = self.evolution * np.sqrt(k**3 * density)
        omega = wave_vector @ np.array(self.mean) + own_rate * random.standard_normal(n)
        phase = random.uniform(0.0, 2.0 * math.pi, n)

        names = [field.name for field in fields(_Mode)]
        table = np.column_stack((amplitude, wave_vector, omega, phase)).tolist()
        return tuple(_Mode(**dict(zip(names, row, strict=True))) for row in table)

    def _edges_of_bands(self) -> np.ndarray:
        """Return the wave numbers between the bands, from the largest to the smallest eddies [1/m]."""
        n = self.modes
        ratio = self.largest / self.smallest
        return 2.0 * math.pi / self.largest * ratio ** (np.arange(n + 1) / n)
