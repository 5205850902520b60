"""The wake of a swimmer that is ahead: a street of vortices that its tail leaves where it turns.

The leader swims straight at the speed U through the water; its tail tip beats with the period T, over
the distance b from side to side. At every turn it leaves one vortex of the circulation Gamma: clockwise on
the left, seen from above, counter-clockwise on the right, so that the water between both rows moves away
from the leader. The vortices move each other away from it at the speed of von Karman's staggered street,

    c = Gamma / (2 a) tanh(pi b / a),    a = (U + c) T

with a the spacing of a row. Away from the leader, such a street carries the mean momentum flux

    F / rho = Gamma b / a (U + 2 c) - Gamma^2 / (2 pi a)

per length of the vortices (von Karman's drag of a street, with the circulation reversed).

Nothing that swims behind changes the vortices, and the leader's own body does not move the water.
"""

import math
from functools import cached_property

import numpy as np

from laticauda.values import BadArgument, quantity, value_class
from laticauda.water.fluid.eddies import LambOseen, around, lamb_oseen, smooth_step
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.uniform import Uniform

STEPS_OF_NEWTON = 40
"""Steps in which the spacing of a street is found; 6 are enough for any that swims."""
GROWTH = 1.1
"""Ratio of the circulations among which the first with enough momentum is sought [-]."""
HALVINGS = 60
"""Steps in which it is then found to rounding."""


@value_class
class _TrailedVortex(LambOseen):
    """One vortex of a wake: left by the tail, it drifts, fades, and is left again further on."""

    advance_x: float = quantity("m/s", "Velocity of the tail over ground, along x")
    advance_y: float = quantity("m/s", "The same, along y")
    first_begin: float = quantity(
        "s", "Time at which it first begins to grow, at its initial place"
    )
    life: float = quantity("s", "Time from one beginning to the next", gt=0.0)
    growth: float = quantity("s", "Time in which it grows", gt=0.0)
    fading: float = quantity("s", "Time in which it fades, at the end of its life", gt=0.0)

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion of the water, see `Flow.__call__`."""
        time_since_first = t - self.first_begin
        lives = time_since_first / self.life
        time_of_earlier_lives = self.life * np.floor(lives.real)
        age = time_since_first - time_of_earlier_lives
        dx = x - self.x - self.advance_x * time_of_earlier_lives - self.velocity_x * age
        dy = y - self.y - self.advance_y * time_of_earlier_lives - self.velocity_y * age

        grown_share, growth_slope = smooth_step(age / self.growth)
        unfaded_share, fading_slope = smooth_step((self.life - age) / self.fading)
        growth_rate = growth_slope / self.growth
        fading_rate = fading_slope / self.fading
        share = grown_share * unfaded_share
        rate = growth_rate * unfaded_share - grown_share * fading_rate

        core_2 = self.core * self.core + 4.0 * self.viscosity * age
        h, slope, fall = lamb_oseen((dx * dx + dy * dy) / core_2)
        strength = 0.5 * self.circulation / (math.pi * core_2)
        g = strength * share * h
        g_slope = strength * share * slope / core_2
        g_t = strength * (rate * h - 4.0 * self.viscosity * share * fall / core_2)
        return around(dx, dy, g, g_slope, g_t, self.velocity_x, self.velocity_y)


@value_class
class Wake(Flow):
    """The vortex street behind a swimmer that is ahead, and the uniform water in which it swims.

    The street is there from the start, and goes on with its swimmer. It is not changed by what swims in it.
    """

    speed: float = quantity("m/s", "U, of the leader through the water", gt=0.0)
    period: float = quantity("s", "T, of its tail beat", gt=0.0)
    width: float = quantity("m", "b, from row to row: its tail's way from side to side", gt=0.0)
    circulation: float = quantity("m^2/s", "Gamma, of each vortex", ge=0.0)
    core: float = quantity("m", "r_c of a new vortex", gt=0.0)
    viscosity: float = quantity(
        "m^2/s",
        "nu that widens the cores: 1e-6 for water, more as an eddy viscosity",
        ge=0.0,
        default=1e-6,
    )
    direction: float = quantity(
        "rad",
        "Direction in which the leader swims, from the x axis, counter-clockwise",
        default=0.0,
    )
    x: float = quantity("m", "x of the middle of its tail's way at the start", default=0.0)
    y: float = quantity("m", "y of the same", default=0.0)
    phase: float = quantity(
        "rad", "Phase of its tail at the start: to its left by b/2 times the sine", default=0.0
    )
    pairs: int = quantity("", "Length of the street in pairs of vortices", ge=2, le=200, default=8)
    mean: tuple[float, float, float] = quantity(
        "m/s", "Velocity of the water that carries leader and street", default=(0.0, 0.0, 0.0)
    )

    def __post_init__(self) -> None:
        """Reject cores that reach into the next vortex."""
        widest = 0.5 * min(self.spacing, math.hypot(0.5 * self.spacing, self.width))
        if self.core > widest:
            raise BadArgument(
                "core",
                f"must be <= {widest:.4g} m, half the way to the next vortex, got {self.core:g}",
            )

    @cached_property
    def spacing(self) -> float:
        """Spacing a of the vortices of one row [m]."""
        return find_spacing(self.speed, self.period, self.width, self.circulation)

    @property
    def drift(self) -> float:
        """Speed c at which the vortices move each other, away from the leader [m/s]."""
        return self.spacing / self.period - self.speed

    @property
    def jet(self) -> float:
        """Mean speed of the water between the rows, away from the leader [m/s]."""
        return self.circulation / self.spacing

    @property
    def momentum_flux(self) -> float:
        """Mean flux of momentum away from the leader, per density and per length of the vortices [m^3/s^2]."""
        return flux_of_street(self.speed, self.period, self.width, self.circulation)

    @cached_property
    def parts(self) -> tuple[Flow, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Both rows of vortices, and the uniform water if it moves."""
        vortices = (*self._row_of_vortices(1), *self._row_of_vortices(-1))
        if not any(self.mean):
            return vortices
        u, v, w = self.mean
        return (Uniform(u=u, v=v, w=w), *vortices)

    def _row_of_vortices(self, side: int) -> list[_TrailedVortex]:
        """Return the vortices to the left (1) or to the right (-1) of the leader's way."""
        c = math.cos(self.direction)
        s = math.sin(self.direction)
        advance_x = self.speed * c + self.mean[0]
        advance_y = self.speed * s + self.mean[1]
        velocity_x = self.mean[0] - self.drift * c
        velocity_y = self.mean[1] - self.drift * s
        growth = 0.5 * self.period
        half_growth = growth / 2.0
        cycles_to_turn = 0.5 - 0.25 * side - 0.5 * self.phase / math.pi
        first_turn = cycles_to_turn * self.period
        left_of_way = 0.5 * side * self.width
        vortices: list[_TrailedVortex] = []
        for k in range(self.pairs):
            turn = first_turn + k * self.period
            first_begin = turn - half_growth
            # It begins where its drift takes it to the place of the turn in time.
            drift_x = velocity_x * half_growth
            drift_y = velocity_y * half_growth
            vortices.append(
                _TrailedVortex(
                    circulation=-side * self.circulation,
                    core=self.core,
                    viscosity=self.viscosity,
                    x=self.x - left_of_way * s + advance_x * turn - drift_x,
                    y=self.y + left_of_way * c + advance_y * turn - drift_y,
                    velocity_x=velocity_x,
                    velocity_y=velocity_y,
                    advance_x=advance_x,
                    advance_y=advance_y,
                    first_begin=first_begin,
                    life=self.pairs * self.period,
                    growth=growth,
                    fading=self.period,
                )
            )
        return vortices


def find_spacing(speed: float, period: float, width: float, circulation: float) -> float:
    """Return the spacing a of a row of a swimmer's street: a = T (U + Gamma / (2 a) tanh(pi b / a)) [m].

    Args:
        speed: U, of the swimmer through the water [m/s].
        period: T, of its tail beat [s].
        width: b, distance of the rows [m].
        circulation: Gamma, of each vortex [m^2/s].
    """
    spacing = speed * period
    for _ in range(STEPS_OF_NEWTON):
        tanh = math.tanh(math.pi * width / spacing)
        drift = 0.5 * circulation / spacing * tanh
        slope_of_tanh = -math.pi * width / spacing**2 * (1.0 - tanh * tanh)
        slope_of_drift = 0.5 * circulation / spacing * slope_of_tanh - drift / spacing
        excess = spacing - period * (speed + drift)
        spacing -= excess / (1.0 - period * slope_of_drift)
    return spacing


def flux_of_street(speed: float, period: float, width: float, circulation: float) -> float:
    """Return von Karman's mean flux of momentum in a swimmer's street, per density and length [m^3/s^2].

    Args:
        speed: U, of the swimmer through the water [m/s].
        period: T, of its tail beat [s].
        width: b, distance of the rows [m].
        circulation: Gamma, of each vortex [m^2/s].
    """
    spacing = find_spacing(speed, period, width, circulation)
    drift = spacing / period - speed
    flux_of_jet = circulation * width / spacing * (speed + 2.0 * drift)
    return flux_of_jet - circulation**2 / (2.0 * math.pi * spacing)


def find_circulation(flux: float, speed: float, period: float, width: float) -> float:
    """Return the circulation with which a swimmer's street has a given mean flux of momentum [m^2/s].

    It is the smallest: beyond a certain circulation, a narrow street drifts so fast that the flux falls again.

    Args:
        flux: Mean flux of momentum, per density and per length of the vortices [m^3/s^2].
        speed: U, of the swimmer through the water [m/s].
        period: T, of its tail beat [s].
        width: b, distance of the rows [m].

    Raises:
        ValueError: If no street of this width has that flux.
    """
    lower = 0.0
    upper = flux * period / width
    flux_of_upper = flux_of_street(speed, period, width, upper)
    while flux_of_upper < flux:
        stronger = GROWTH * upper
        flux_of_stronger = flux_of_street(speed, period, width, stronger)
        if flux_of_stronger <= flux_of_upper:
            raise BadArgument(
                "thrust", f"must be less: no street {width:.3g} m wide carries that much momentum"
            )
        lower = upper
        upper, flux_of_upper = stronger, flux_of_stronger
    for _ in range(HALVINGS):
        center = 0.5 * (lower + upper)
        if flux_of_street(speed, period, width, center) < flux:
            lower = center
        else:
            upper = center
    return 0.5 * (lower + upper)
