"""Limits of a design: what a body and its gait must be, so that someone can build the robot and send it off.

Every limit is a *share*: how much of what there is a design takes, at most 1. A design that takes more
is refused, and the limit with the largest share is named.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot, Water, has_power_model
from laticauda.scenarios import Scenario
from laticauda.trials import LOAD_FIGURES
from laticauda.values import BadArgument, option, quantity, value_class

SECONDS_PER_HOUR = 3600.0
"""Seconds of an hour: 1 Wh is 3600 J [s]."""
BATTERY = "battery"
MASS = "mass"
BUOYANCY = "buoyancy"
BALLAST = "weight of a module"
SHORTEST = "shortest module"
LONGEST = "longest module"
END_OF_LIMIT = "_limit"
"""End of the name of a limit that begins with the name of the figure that is limited."""

Column = Float[np.ndarray, " n_points"]


@value_class
class DesignLimits:
    """Limits of a design; None: this one does not count."""

    battery: float | None = quantity(
        "Wh", "Energy of the battery, for `battery_range` or `battery_time`", gt=0.0, default=None
    )
    battery_range: float | None = quantity(
        "m", "Distance through the water that the battery must last for", gt=0.0, default=None
    )
    battery_time: float | None = quantity(
        "s", "Time that the battery must last for", gt=0.0, default=None
    )
    servo_share: float = quantity(
        "",
        "Largest share of joint angles, servo torque and servo speed that a gait may use",
        gt=0.0,
        le=1.0,
        default=1.0,
    )
    most_mass: float | None = quantity("kg", "Largest mass of the robot", gt=0.0, default=None)
    buoyancy_tolerance: float | None = quantity(
        "",
        "Largest difference between the robot's mass and that of its water, as a share of the latter",
        gt=0.0,
        le=1.0,
        default=None,
    )
    ballast: bool = option(
        "Fill every module up with ballast until it weighs as much as its water; "
        "`mass` of a module is then what it weighs without",
        default=False,
    )
    shortest_module: float | None = quantity(
        "m", "Smallest length of a module, such as a servo's", gt=0.0, default=None
    )
    longest_module: float | None = quantity(
        "m", "Largest length of a module, such as a printer's", gt=0.0, default=None
    )
    length_step: float | None = quantity(
        "m", "Lengths of modules are multiples of this", gt=0.0, default=None
    )
    peak_bending_moment_limit: float | None = quantity(
        "N m", "Largest bending moment that a joint may carry", gt=0.0, default=None
    )
    rms_bending_moment_limit: float | None = quantity(
        "N m", "Largest root mean square of the bending moment in a joint", gt=0.0, default=None
    )
    peak_shear_force_limit: float | None = quantity(
        "N", "Largest shear force that a joint may carry", gt=0.0, default=None
    )
    rms_shear_force_limit: float | None = quantity(
        "N", "Largest root mean square of the shear force in a joint", gt=0.0, default=None
    )
    peak_axial_force_limit: float | None = quantity(
        "N", "Largest axial force that a joint may carry", gt=0.0, default=None
    )
    rms_axial_force_limit: float | None = quantity(
        "N", "Largest root mean square of the axial force in a joint", gt=0.0, default=None
    )

    @property
    def limits_body(self) -> bool:
        """Whether some limit is about the body alone, whatever its motion."""
        limits = (
            self.most_mass,
            self.buoyancy_tolerance,
            self.shortest_module,
            self.longest_module,
        )
        return self.ballast or any(limit is not None for limit in limits)

    @property
    def limits_design(self) -> bool:
        """Whether some limit is about more than the gait."""
        is_limited = self.battery is not None or self.length_step is not None
        return self.limits_body or is_limited or bool(self.load_limits)

    @property
    def load_limits(self) -> dict[str, float]:
        """Limits of what joints carry, by the name of the figure that is limited; SI units."""
        limits: dict[str, float] = {}
        for name in LOAD_FIGURES:
            limit: float | None = getattr(self, f"{name}{END_OF_LIMIT}")
            if limit is not None:
                limits[name] = limit
        return limits


def check_design_limits(limits: DesignLimits, scenario: Scenario) -> None:
    """Reject limits that contradict each other, or that a scenario cannot be judged by.

    Args:
        limits: The limits.
        scenario: Scenario with the robot.

    Raises:
        ValueError: If a limit lacks what it needs.
    """
    _check_battery(limits, scenario)
    needs_water = limits.ballast or limits.buoyancy_tolerance is not None
    if needs_water and not isinstance(scenario.environment, Water):
        name = "ballast" if limits.ballast else "buoyancy_tolerance"
        raise BadArgument(name, "must not be given on ground, where nothing floats")
    if limits.ballast and limits.buoyancy_tolerance is not None:
        rule = (
            "must be left out with `ballast`, which fills modules up to the weight of their water"
        )
        raise BadArgument("buoyancy_tolerance", f"{rule}, got {limits.buoyancy_tolerance:g}")
    shortest = limits.shortest_module or 0.0
    longest = limits.longest_module or math.inf
    if shortest > longest:
        rule = f"must be >= `shortest_module`, {shortest:g} m"
        raise BadArgument("longest_module", f"{rule}, got {longest:g}")


def _check_battery(limits: DesignLimits, scenario: Scenario) -> None:
    """Reject a battery without a purpose, a purpose without a battery, and a robot of unknown power."""
    purposes = [
        name for name in ("battery_range", "battery_time") if getattr(limits, name) is not None
    ]
    if limits.battery is None:
        if purposes:
            raise BadArgument("battery", f"must be given with `{purposes[0]}`, got None")
        return
    if len(purposes) != 1:
        rule = "must come with one of `battery_range` and `battery_time`"
        received = "both" if purposes else "neither"
        raise BadArgument("battery", f"{rule}, got {received}")
    if not has_power_model(scenario.robot, scenario.model.joints):
        raise BadArgument(
            "battery",
            "must be of a robot whose electrical power is known: one with servo joints, or with an "
            f"`active_power` (0 W counts its motors alone), got {scenario.robot.name}",
        )


class BodyNumbers(NamedTuple):
    """What limits of the body are about, of one robot."""

    mass: float
    """Mass, with ballast if there is any [kg]."""
    displaced: float
    """Mass of the displaced water; nan on ground [kg]."""
    idle_power: float
    """Power at rest [W]."""
    lengths: tuple[float, ...]
    """Lengths of the modules [m]."""
    shares_of_water: tuple[float, ...]
    """Mass of every module without ballast, as a share of that of its water; nan on ground [-]."""

    @classmethod
    def of(cls, scenario: Scenario, *, with_ballast: bool) -> "BodyNumbers":
        """Return the numbers of a scenario's robot.

        Args:
            scenario: Scenario with the robot as it is without ballast.
            with_ballast: Whether its modules are filled up with ballast.
        """
        robot = scenario.robot
        density = math.nan
        if isinstance(scenario.environment, Water):
            density = scenario.environment.density
        mass = robot.mass
        if with_ballast:
            mass_of_modules = math.fsum(module.mass for module in robot.modules)
            mass += math.fsum(ballasted_masses(robot, density)) - mass_of_modules
        return cls(
            mass=mass,
            displaced=density * robot.volume,
            idle_power=robot.idle_power,
            lengths=tuple(module.length for module in robot.modules),
            shares_of_water=tuple(
                module.mass / (density * module.volume) for module in robot.modules
            ),
        )


def ballasted_masses(robot: Robot, density: float) -> list[float]:
    """Return the masses of modules that are filled up with ballast; one that is too heavy keeps its own [kg].

    Args:
        robot: The robot without ballast.
        density: Density of the water [kg/m^3].
    """
    return [max(module.mass, density * module.volume) for module in robot.modules]


def limits_of_body(limits: DesignLimits, body: BodyNumbers) -> dict[str, np.ndarray]:
    """Return how much of each limit of the body a robot takes, smooth in all numbers [-].

    A limit with two sides has two shares, one that concerns modules has one for each.

    Args:
        limits: The limits.
        body: Numbers of the robot.
    """
    shares: dict[str, np.ndarray] = {}
    if limits.most_mass is not None:
        shares[MASS] = np.array([body.mass / limits.most_mass])
    if limits.buoyancy_tolerance is not None:
        excess = (body.mass / body.displaced - 1.0) / limits.buoyancy_tolerance
        shares[BUOYANCY] = np.array([excess, -excess])
    if limits.ballast:
        shares[BALLAST] = np.array(body.shares_of_water)
    lengths = np.array(body.lengths)
    if limits.shortest_module is not None:
        shares[SHORTEST] = limits.shortest_module / lengths
    if limits.longest_module is not None:
        shares[LONGEST] = lengths / limits.longest_module
    return shares


def battery_share(
    limits: DesignLimits, power: Column, speed: Column, idle_power: Column
) -> Column | None:
    """Return how much of the battery designs take [-]; None if there is no such limit.

    Args:
        limits: The limits.
        power: Electrical power above idle [W].
        speed: Speed through the water [m/s].
        idle_power: Power at rest [W].
    """
    if limits.battery is None:
        return None
    duration = limits.battery_time
    total_power = power + idle_power
    if duration is not None:
        return total_power * duration / (limits.battery * SECONDS_PER_HOUR)
    assert limits.battery_range is not None
    with np.errstate(divide="ignore"):
        return total_power / speed * limits.battery_range / (limits.battery * SECONDS_PER_HOUR)


class LargestShare(NamedTuple):
    """The limit of which a design takes most."""

    limit: str
    """Its name; "" if there are no limits."""
    share: float
    """The share; 0 if there are no limits [-]."""


def largest_share(shares: Mapping[str, np.ndarray]) -> LargestShare:
    """Return the limit of which a design takes the largest share.

    Args:
        shares: Shares by the name of the limit.
    """
    largest = LargestShare("", 0.0)
    for limit, values in shares.items():
        share = float(np.max(values))
        if not largest.limit or share > largest.share:
            largest = LargestShare(limit, share)
    return largest
