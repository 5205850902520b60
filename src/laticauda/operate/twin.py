"""The digital twin: a plant that runs beside the filter and foresees how the robot moves through still water.

Nothing in still water depends on place or heading, so what a simulated robot does in its own axes is what the real one
does, wherever the twin itself has got to meanwhile. See docs/theory/estimation.md.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.errors import instance
from laticauda.gaits import lateral_undulation
from laticauda.interfaces import Command, Plant, Start
from laticauda.robot import Environment, Robot

Vector: TypeAlias = NDArray[np.float64]

# A robot whose joints are elsewhere for so long is not what the twin takes it for.
ASTRAY = 0.5  # rad
ASTRAY_TIME = 1.0  # s
# References leave no part to the gait.
STILL = lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
# What a record keeps of a plant's settings.
SETTINGS = ("model", "joints", "dt", "offset_bandwidth", "ramp", "root", "gravity")
# A plant that leaves these bounds has diverged.
FASTEST = 10.0  # m/s
FASTEST_TURN = 50.0  # rad/s


@dataclass(frozen=True, kw_only=True)
class PlantRecord:
    """How a plant was made, as a recording keeps it: `laticauda.simulate.plant` makes it again."""

    robot: Robot
    """What swims."""
    environment: Environment
    """Where it swims."""
    settings: Mapping[str, Any]
    """The rest of what `laticauda.simulate.plant` takes."""

    def made(self, plant: Callable[..., Plant[Any]]) -> Plant[Any]:
        """The plant again.

        Args:
            plant: `laticauda.simulate.plant`.
        """
        return plant(self.robot, self.environment, **self.settings)


@dataclass(frozen=True, kw_only=True, eq=False)
class TwinState:
    """Where the twin is, and how it moves, in its own world."""

    plant: Any
    """State of the plant."""
    center_of_mass: Vector
    """[m]."""
    velocity: Vector
    """Of the center of mass, through the water [m/s]."""
    heading: float
    """(6), unwrapped [rad]."""
    rate: float
    """Of the heading [rad/s]."""
    joint: Vector
    """Its joint angles [rad]."""
    astray: float = 0.0
    """For how long a joint has been more than `ASTRAY` from the robot's [s]."""


@dataclass(frozen=True, kw_only=True)
class Moved:
    """What the twin did in one step, in its own axes at the step's start."""

    along: float
    """Way of the center of mass through the water, along the heading (6) [m]."""
    across: float
    """To the left of it [m]."""
    turned: float
    """Change of the heading [rad]."""


def record_of(plant: Plant[Any]) -> PlantRecord:
    """How a plant was made.

    Args:
        plant: Made by `laticauda.simulate.plant`.

    Raises:
        ValueError: If it has a fluid law or a shore of one's own, which a recording does not hold.
    """
    law = plant.settings.get("fluid_law", "built-in")
    if law != "built-in" or "shore" in plant.settings:
        raise ValueError("`plant` must have a built-in fluid law and no shore to be recorded.")
    chosen = {name: plant.settings[name] for name in SETTINGS if name in plant.settings}
    return PlantRecord(robot=plant.robot, environment=plant.environment, settings=chosen)


def check_plant(plant: object, robot: Robot) -> None:
    """Refuse what cannot be the twin of a robot.

    Args:
        plant: A plant, the record of one, or None.
        robot: Whose twin it is to be.

    Raises:
        ValueError: If it is none, has other joints, or joints that do not follow references.
    """
    if plant is None:
        return
    instance("plant", plant, Plant, PlantRecord)
    known: Any = plant
    n, wanted = known.robot.planar().n_joints, robot.planar().n_joints
    if n != wanted or (known.robot.n_joints != n and known.settings.get("model") == "spatial"):
        raise ValueError(f"`plant` must have {wanted} joints, all of them yaw joints, got {known.robot.n_joints}.")
    if known.settings.get("joints") == "prescribed":
        raise ValueError("`plant` must have joints that follow references, `pd` or `servo`, got 'prescribed'.")


def start(plant: Plant[Any], joint: Vector) -> TwinState:
    """At rest, straight, at the origin.

    Args:
        plant: What runs beside the filter.
        joint: The first references [rad].
    """
    state = plant.init(Start(), _held(joint))
    seen = plant.observe(state)
    return TwinState(
        plant=state,
        center_of_mass=np.zeros(2),
        velocity=np.zeros(2),
        heading=seen.heading,
        rate=0.0,
        joint=seen.joint_angle,
    )


def stepped(
    plant: Plant[Any], state: TwinState, references: Vector, joint: Vector | None, coupling: float, dt: float
) -> tuple[TwinState, Moved] | None:
    """The twin after some time, and what it did; None if it diverged, or is not what the robot is.

    Its joints are told phi_ref + k (phi - phi_twin): references drive it, and what the sensors say pulls it along.

    Args:
        plant: What runs beside the filter.
        state: Before.
        references: phi_ref, held [rad].
        joint: phi of the robot; None where it is not known [rad].
        coupling: k [-].
        dt: [s].
    """
    astray = 0.0
    if joint is not None:
        apart = joint - state.joint
        references = references + coupling * apart
        astray = state.astray + dt if float(np.abs(apart).max(initial=0.0)) > ASTRAY else 0.0
    then, log, trouble = plant.march(state.plant, _held(references), dt, dt)
    # The water's own motion is the filter's affair.
    drift = np.array(getattr(plant.environment, "current", (0.0, 0.0)))
    velocity, rate = log["center_of_mass_velocity"][-1, :2] - drift, float(log["heading_rate"][-1])
    is_sane = bool(np.abs(velocity).max() < FASTEST) and abs(rate) < FASTEST_TURN
    if trouble is not None or not is_sane or astray > ASTRAY_TIME:
        return None
    after = TwinState(
        plant=then,
        center_of_mass=log["center_of_mass"][-1, :2],
        velocity=velocity,
        heading=float(log["heading"][-1]),
        rate=rate,
        joint=log["joint_angle"][-1],
        astray=astray,
    )
    way = after.center_of_mass - state.center_of_mass - dt * drift
    c, s = math.cos(state.heading), math.sin(state.heading)
    along, across = float(c * way[0] + s * way[1]), float(c * way[1] - s * way[0])
    return after, Moved(along=along, across=across, turned=after.heading - state.heading)


def _held(references: Vector) -> Command:
    return Command(gait=STILL, references=tuple(references.tolist()))
