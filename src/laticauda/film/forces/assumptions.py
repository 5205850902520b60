"""What is assumed of water and body, and draws of it: numbers that no film of points shows.

Every number lies anywhere between its least and its greatest value, with its central value as median.
Height and width of the body differ by factors that are log-normal.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from laticauda import scenarios
from laticauda.identify import Fit
from laticauda.models.simulate.numbers import change_parameters, value_of
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.robot import Module, Robot, Water, textbook_water
from laticauda.values import BadArgument

Interval = tuple[float, float]
BODY_NAMES = ("height", "width")
"""Sizes of the body that a deviation spreads; its mass goes with them, since its density stays."""


@dataclass(frozen=True, kw_only=True)
class Assumptions:
    """Water and body of an inverse, with what is not known of them."""

    water: Water
    """Central values."""
    intervals: Mapping[str, Interval] = field(default_factory=dict[str, Interval])
    """Least and greatest value of coefficients, by name, as `water.normal_drag`."""
    body_deviation: float = 0.0
    """Relative standard deviation of height and width of the body [-]."""
    scale_deviation: float = 0.0
    """Relative standard deviation of the film's scale, as its calibration states it [-]."""

    def __post_init__(self) -> None:
        """Check the fields."""
        for name, (lowest, highest) in self.intervals.items():
            if not name.startswith("water."):
                raise BadArgument("intervals", f"must be of numbers of the water, got `{name}`")
            if not lowest <= highest:
                rule = "must go from the least value to the greatest"
                raise BadArgument(f"intervals[{name}]", f"{rule}, got {lowest} to {highest}")
        for name in ("body_deviation", "scale_deviation"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise BadArgument(name, f"must be 0 to 1, got {getattr(self, name)}")

    @classmethod
    def of_textbook(cls, robot: Robot, speed: float, **deviations: float) -> "Assumptions":
        """Return the water from tables, with its intervals, for a body at a speed.

        Args:
            robot: What swims.
            speed: Its speed [m/s].
            deviations: `body_deviation` and `scale_deviation`.
        """
        textbook = textbook_water(robot, speed=speed)
        return cls(water=textbook.water, intervals=textbook.intervals, **deviations)

    @classmethod
    def of_identified(cls, fit: Fit, **deviations: float) -> "Assumptions":
        """Return the water that was identified, with its intervals; that they are correlated is left out.

        Args:
            fit: What `laticauda.identify` found.
            deviations: `body_deviation` and `scale_deviation`.

        Raises:
            ValueError: If it found nothing of the water.
        """
        intervals = {
            estimate.name: estimate.interval
            for estimate in fit.estimates
            if estimate.name.startswith("water.") and estimate.interval is not None
        }
        if not intervals:
            raise BadArgument("fit", "must hold a number of the water, such as its friction")
        scenario = fit.problem.scenarios_at(fit.best)[0]
        return cls(water=_water_of(scenario), intervals=intervals, **deviations)


@dataclass(frozen=True, kw_only=True, eq=False)
class Draw:
    """Body and water of one draw."""

    robot: Robot
    """The body."""
    water: Water
    """The water."""


@dataclass(frozen=True, kw_only=True, eq=False)
class AssumptionDraws:
    """Many draws of what is assumed."""

    draws: tuple[Draw, ...]
    """Bodies and waters."""
    water_numbers: Float[np.ndarray, "n_draws n_numbers"]
    """Numbers of the water that were drawn, each from -1 to 1 about its central value."""
    body_numbers: Float[np.ndarray, "n_draws n_sizes"]
    """Numbers of the body that were drawn, by their deviation."""
    scale: Float[np.ndarray, " n_draws"]
    """Scale of the film by that which its calibration found."""


def draw_assumptions(
    robot: Robot, assumptions: Assumptions, n_draws: int, seed: int
) -> AssumptionDraws:
    """Draw bodies and waters.

    Args:
        robot: The planar robot.
        assumptions: What is known of them.
        n_draws: Number of draws.
        seed: Seed.
    """
    chance = np.random.default_rng(seed)
    names = list(assumptions.intervals)
    positions = chance.uniform(-1.0, 1.0, (n_draws, len(names)))
    body = chance.standard_normal((n_draws, len(BODY_NAMES)))
    scale = np.exp(assumptions.scale_deviation * chance.standard_normal(n_draws))
    scenario = _scenario_of(robot, assumptions.water)
    centers = {name: value_of(name, scenario) for name in names}
    draws: list[Draw] = []
    for number in range(n_draws):
        values: dict[str, float] = {}
        for i, name in enumerate(names):
            interval = assumptions.intervals[name]
            values[name] = _value_at(positions[number, i], centers[name], interval)
        drawn_water = _water_of(change_parameters(scenario, values))
        drawn_robot = robot
        if assumptions.body_deviation > 0.0:
            factors = np.exp(assumptions.body_deviation * body[number])
            drawn_robot = _scale_body(robot, *factors.tolist())
        draws.append(Draw(robot=drawn_robot, water=drawn_water))
    return AssumptionDraws(
        draws=tuple(draws), water_numbers=positions, body_numbers=body, scale=scale
    )


def _value_at(position: float, center: float, interval: Interval) -> float:
    """Return the value at a position from -1, the least, over 0, the center, to 1, the greatest."""
    lowest, highest = interval
    if position < 0.0:
        return center + position * (center - min(lowest, center))
    return center + position * (max(highest, center) - center)


def _scenario_of(robot: Robot, water: Water) -> scenarios.Scenario:
    """Return a scenario in which numbers of the water have names; its motion does not matter."""
    still = JointAngles(time=(0.0, 1.0), angle=((0.0, 0.0),) * robot.n_joints)
    return scenarios.build_scenario(robot, recorded_gait(still), 1.0, environment=water)


def _water_of(scenario: scenarios.Scenario) -> Water:
    water = scenario.environment
    if not isinstance(water, Water):
        raise BadArgument("water", "must be water: on the ground no film tells forces")
    return water


def _scale_body(robot: Robot, height: float, width: float) -> Robot:
    """Return a robot of other sections, but the same lengths and densities."""
    modules: list[Module] = []
    for module in robot.modules:
        section = replace(
            module.section,
            half_height=height * module.section.half_height,
            half_width=width * module.section.half_width,
        )
        modules.append(replace(module, mass=height * width * module.mass, section=section))
    return replace(robot, modules=tuple(modules))
