"""The digital twin: a plant that runs beside the filter and foresees how the robot moves through still water.

Nothing in still water depends on place or heading, so what a simulated robot does in its own axes is what the real one
does, wherever the twin itself has got to meanwhile. See docs/theory/estimation.md.
"""

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda import gaits, interfaces, scenarios
from laticauda.actuation.laws import Prescribed
from laticauda.dynamics.plant import Plant
from laticauda.errors import BadArgument, instance
from laticauda.robot import Robot

Vector: TypeAlias = NDArray[np.float64]

# A robot whose joints are elsewhere for so long is not what the twin takes it for.
ASTRAY = 0.5  # rad
ASTRAY_TIME = 1.0  # s
# References leave no part to the gait.
STILL = gaits.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
# A plant that leaves these bounds has diverged.
FASTEST = 10.0  # m/s
FASTEST_TURN = 50.0  # rad/s


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
    joint_angle: Vector
    """Its joint angles [rad]."""
    astray: float = 0.0
    """For how long a joint has been more than `ASTRAY` from the robot's [s]."""
    along: float = 0.0
    """Way of the center of mass through the water in the last step, along the heading (6) at its start [m]."""
    across: float = 0.0
    """To the left of it [m]."""
    turn: float = 0.0
    """Change of the heading in the last step [rad]."""


def check_plant(plant: Plant[Any] | None, robot: Robot) -> None:
    """Refuse what cannot be the twin of a robot.

    Args:
        plant: A plant, or None.
        robot: Whose twin it is to be.

    Raises:
        ValueError: If it is none, has other joints, or joints that do not follow references.
    """
    if plant is None:
        return
    instance("plant", plant, Plant)
    n, expected = plant.robot.planar().n_joints, robot.planar().n_joints
    if n != expected or (plant.robot.n_joints != n and isinstance(plant.settings, scenarios.Spatial)):
        raise BadArgument("plant", f"must have {expected} joints, all of them yaw joints, got {plant.robot.n_joints}")
    if isinstance(plant.settings.joints, Prescribed):
        raise BadArgument("plant", "must have joints that follow references, `pd` or `servo`, got 'prescribed'")


def start_twin(plant: Plant[Any], reference: Vector) -> TwinState:
    """At rest, straight, at the origin.

    Args:
        plant: What runs beside the filter.
        reference: The first references [rad].
    """
    state = plant.init(interfaces.Start(), _held(reference))
    observation = plant.observe(state)
    return TwinState(
        plant=state,
        center_of_mass=np.zeros(2),
        velocity=np.zeros(2),
        heading=observation.heading,
        rate=0.0,
        joint_angle=observation.joint_angle,
    )


def step_twin(
    plant: Plant[Any],
    state: TwinState,
    reference: Vector,
    joint_angle: Vector | None,
    coupling: float,
    dt: float,
    *,
    fin: tuple[float, ...] = (),
) -> TwinState | None:
    """The twin after some time; None if it diverged, or is not what the robot is.

    Its joints follow phi_ref + k (phi - phi_twin): references drive it, and what the sensors say pulls it along.

    Args:
        plant: What runs beside the filter.
        state: Before.
        reference: phi_ref, held [rad].
        joint_angle: phi of the robot; None where it is not known [rad].
        coupling: k [-].
        dt: [s].
        fin: phi_ref of a driven fin, or nothing, which leaves it straight [rad].
    """
    fin = fin[: len(plant.robot.driven_joints) - plant.robot.n_joints]
    astray = 0.0
    if joint_angle is not None:
        apart = joint_angle - state.joint_angle
        reference = reference + coupling * apart
        astray = state.astray + dt if float(np.abs(apart).max(initial=0.0)) > ASTRAY else 0.0
    then, _, trouble = plant.advance(state.plant, _held(reference, fin), dt, dt)
    seen = plant.observe(then)
    # The water's own motion is the filter's affair.
    drift = np.array(getattr(plant.environment, "uniform", (0.0, 0.0))[:2])
    velocity, rate = seen.center_of_mass_velocity[:2] - drift, float(seen.heading_rate)
    is_sane = bool(np.abs(velocity).max() < FASTEST) and abs(rate) < FASTEST_TURN
    if trouble is not None or not is_sane or astray > ASTRAY_TIME:
        return None
    center_of_mass, heading = seen.center_of_mass[:2], float(seen.heading)
    way = center_of_mass - state.center_of_mass - dt * drift
    c, s = math.cos(state.heading), math.sin(state.heading)
    return TwinState(
        plant=then,
        center_of_mass=center_of_mass,
        velocity=velocity,
        heading=heading,
        rate=rate,
        joint_angle=seen.joint_angle,
        astray=astray,
        along=float(c * way[0] + s * way[1]),
        across=float(c * way[1] - s * way[0]),
        turn=heading - state.heading,
    )


def _held(reference: Vector, fin: tuple[float, ...] = ()) -> interfaces.Command:
    return interfaces.Command(gait=STILL, references=(*reference.tolist(), *fin))
