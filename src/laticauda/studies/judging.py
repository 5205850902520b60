"""Which limits a design comes up against, in words: what it takes of each, and why it is refused."""

import math
from dataclasses import dataclass, replace

import numpy as np

from laticauda.models.simulate import build_plant, change_parameters, run_scenario
from laticauda.robot import Robot, Water
from laticauda.scenarios import Scenario
from laticauda.studies.design_limits import (
    BALLAST,
    BATTERY,
    BUOYANCY,
    LONGEST,
    MASS,
    SECONDS_PER_HOUR,
    SHORTEST,
    BodyNumbers,
    ballasted_masses,
    battery_share,
    limits_of_body,
)
from laticauda.studies.limits import NEAR
from laticauda.studies.optimization import Optimization, speed_of_range
from laticauda.studies.point_trials import swum_figure
from laticauda.trials import Trial
from laticauda.trials.feasibility import ROUNDING

SERVOS = "joints"
SPEED = "speed"
RUN = "run"
MILLIMETERS = 1e3
"""Millimeters of a meter."""


@dataclass(frozen=True, kw_only=True)
class LimitUse:
    """How much of a limit a design takes."""

    limit: str
    """Name of the limit."""
    share: float
    """What it takes, as a share of what there is; more than 1 is too much [-]."""
    description: str
    """What it takes and what there is, in words."""

    @property
    def is_active(self) -> bool:
        """Whether the limit is reached, so that it decides on the design."""
        return self.share >= NEAR

    @property
    def is_exceeded(self) -> bool:
        """Whether the design is refused because of it."""
        return not self.share <= 1.0 + ROUNDING


@dataclass(frozen=True, kw_only=True)
class Judgment:
    """A design beside its limits."""

    scenario: Scenario
    """The scenario that swims, with ballast if there is any."""
    trial: Trial
    """Its run."""
    uses: tuple[LimitUse, ...]
    """What it takes of every limit, the largest share first."""

    @property
    def is_feasible(self) -> bool:
        """Whether no limit is exceeded."""
        return not self.refusals

    @property
    def refusals(self) -> tuple[str, ...]:
        """Why it is refused, a sentence for each limit that is exceeded; empty if it is not."""
        return tuple(f"{use.limit}: {use.description}" for use in self.uses if use.is_exceeded)

    @property
    def active(self) -> tuple[str, ...]:
        """Names of the limits that are reached."""
        return tuple(use.limit for use in self.uses if use.is_active)


def judge_design(optimization: Optimization, scenario: Scenario | None = None) -> Judgment:
    """Run a design, and compare it with the limits of an optimization.

    Args:
        optimization: The optimization.
        scenario: The design, its modules without ballast; None: that with which the search begins.

    Returns:
        What it takes of every limit.
    """
    if scenario is None:
        scenario = optimization.scenario
    swimming = scenario
    if optimization.ballast:
        swimming = add_ballast(scenario)
    trial = run_scenario(swimming, build_plant(swimming), link_forces=optimization.needs_loads)
    body = BodyNumbers.of(scenario, with_ballast=optimization.ballast)
    uses = _judge_body(optimization, scenario, body)
    if trial.succeeded:
        uses += _judge_swim(optimization, trial, body)
    else:
        uses.append(LimitUse(limit=RUN, share=math.inf, description=trial.status))
    uses.sort(key=lambda use: -use.share)
    return Judgment(scenario=swimming, trial=trial, uses=tuple(uses))


def judge_point(optimization: Optimization, point: np.ndarray) -> Judgment:
    """Run a point of an optimization, and compare it with its limits.

    Args:
        optimization: The optimization.
        point: Values of its parameters.
    """
    numbers = dict(zip(optimization.names, point.tolist(), strict=True))
    return judge_design(optimization, change_parameters(optimization.scenario, numbers))


def add_ballast(scenario: Scenario) -> Scenario:
    """Return a scenario whose robot's modules are filled up with ballast.

    Args:
        scenario: Scenario in water.
    """
    assert isinstance(scenario.environment, Water)
    robot = scenario.robot
    masses = ballasted_masses(robot, scenario.environment.density)
    modules = tuple(
        replace(module, mass=mass) for module, mass in zip(robot.modules, masses, strict=True)
    )
    return replace(scenario, robot=replace(robot, modules=modules))


def _judge_body(
    optimization: Optimization, scenario: Scenario, body: BodyNumbers
) -> list[LimitUse]:
    """Return what a body takes of its limits."""
    descriptions = {
        MASS: f"{body.mass:.3g} kg of at most {optimization.most_mass or math.nan:g}",
        BUOYANCY: _describe_buoyancy(body, optimization.buoyancy_tolerance or math.nan),
        BALLAST: _describe_ballast(scenario, body),
        SHORTEST: _describe_length(body, np.argmin(body.lengths), optimization.shortest_module),
        LONGEST: _describe_length(body, np.argmax(body.lengths), optimization.longest_module),
    }
    uses: list[LimitUse] = []
    for limit, shares in limits_of_body(optimization, body).items():
        share = float(np.max(shares))
        uses.append(LimitUse(limit=limit, share=share, description=descriptions[limit]))
    return uses


def _describe_buoyancy(body: BodyNumbers, tolerance: float) -> str:
    excess = body.mass / body.displaced - 1.0
    comparison = "heavier" if excess > 0.0 else "lighter"
    return (
        f"{body.mass:.4g} kg in the place of {body.displaced:.4g} kg of water, "
        f"{100.0 * abs(excess):.2g} % {comparison}; {100.0 * tolerance:g} % are allowed"
    )


def _describe_ballast(scenario: Scenario, body: BodyNumbers) -> str:
    robot: Robot = scenario.robot
    heaviest = int(np.argmax(body.shares_of_water))
    mass = robot.modules[heaviest].mass
    water = mass / body.shares_of_water[heaviest]
    return f"module {heaviest} weighs {mass:.3g} kg without ballast, its water {water:.3g}"


def _describe_length(body: BodyNumbers, module: np.intp, limit: float | None) -> str:
    length = MILLIMETERS * body.lengths[module]
    limit_length = MILLIMETERS * (limit or math.nan)
    return f"module {module} is {length:.4g} mm long; the limit is {limit_length:g} mm"


def _judge_swim(optimization: Optimization, trial: Trial, body: BodyNumbers) -> list[LimitUse]:
    """Return what a swim takes of its limits."""
    uses: list[LimitUse] = []
    if not optimization.beyond_actuators:
        allowed = optimization.servo_share
        description = trial.feasibility.words
        if allowed < 1.0:
            description += f"; {100.0 * allowed:g} % of it may be used"
        share = trial.utilization / allowed
        uses.append(LimitUse(limit=SERVOS, share=share, description=description))
    if optimization.battery is not None:
        uses.append(_judge_battery(optimization, trial, body))
    uses += _judge_loads(optimization, trial)
    least_speed = optimization.least_velocity
    if least_speed is not None:
        figure = swum_figure("forward_velocity", optimization.scenario, optimization.names)
        speed: float = getattr(trial, figure)
        description = f"{speed:.3g} m/s of at least {least_speed:g}"
        share = least_speed / max(speed, ROUNDING)
        uses.append(LimitUse(limit=SPEED, share=share, description=description))
    return uses


def _judge_loads(optimization: Optimization, trial: Trial) -> list[LimitUse]:
    """Return what a swim takes of what joints may carry."""
    uses: list[LimitUse] = []
    for name, limit in optimization.load_limits.items():
        load: float = getattr(trial, name)
        unit: str = getattr(Trial, name).unit
        description = f"{load:.3g} {unit} of at most {limit:g}"
        limit_name = name.replace("_", " ")
        uses.append(LimitUse(limit=limit_name, share=load / limit, description=description))
    return uses


def _judge_battery(optimization: Optimization, trial: Trial, body: BodyNumbers) -> LimitUse:
    """Return what a swim takes of the battery."""
    assert optimization.battery is not None
    speed: float = getattr(trial, speed_of_range(optimization.scenario))
    shares = battery_share(
        optimization,
        np.array([trial.mean_power]),
        np.array([max(speed, ROUNDING)]),
        np.array([body.idle_power]),
    )
    assert shares is not None
    share = float(shares[0])
    total_power = trial.mean_power + body.idle_power
    purpose = f"{(optimization.battery_time or 0.0) / SECONDS_PER_HOUR:.3g} h"
    if optimization.battery_range is not None:
        purpose = f"{optimization.battery_range:g} m"
    needed = share * optimization.battery
    return LimitUse(
        limit=BATTERY,
        share=share,
        description=(
            f"{needed:.3g} of {optimization.battery:g} Wh for {purpose}, "
            f"with {total_power:.3g} W at {speed:.3g} m/s"
        ),
    )
