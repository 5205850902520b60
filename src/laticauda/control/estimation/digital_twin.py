"""Digital twin: a plant that runs alongside the filter and predicts the motion through still water.

In still water nothing depends on position or heading, so the simulated robot moves in its own axes
as the real one does, wherever the twin itself is by then. See docs/theory/estimation.md.
"""

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda import scenarios
from laticauda.models.dynamics import Plant
from laticauda.motion import gaits
from laticauda.motion.joints import Prescribed
from laticauda.robot import Robot
from laticauda.scenarios import interfaces
from laticauda.values import BadArgument, check_instance

Vector: TypeAlias = NDArray[np.float64]

ASTRAY = 0.5
"""Deviation of a joint beyond which the robot may not be what the twin assumes [rad]."""
ASTRAY_TIME = 1.0
"""Time for which it must last until the twin is abandoned [s]."""
STILL = gaits.lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
"""Gait of a robot whose joint references replace the gait completely."""
FASTEST = 10.0
"""Speed beyond which a plant has diverged [m/s]."""
FASTEST_TURN = 50.0
"""Rate of the heading beyond which a plant has diverged [rad/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TwinState:
    """Position and motion of the twin, in its own world."""

    plant: Any
    """State of the plant."""
    center_of_mass: Vector
    """Center of mass [m]."""
    velocity: Vector
    """Velocity of the center of mass through the water [m/s]."""
    heading: float
    """Heading (6), unwrapped [rad]."""
    rate: float
    """Rate of the heading [rad/s]."""
    joint_angle: Vector
    """Joint angles of the twin [rad]."""
    astray: float = 0.0
    """Time for which a joint has deviated by more than `ASTRAY` from the robot's [s]."""
    along: float = 0.0
    """Displacement of the center of mass through the water in the last step, along its first
    heading (6) [m]."""
    across: float = 0.0
    """Displacement in the last step, to the left of that heading [m]."""
    turn: float = 0.0
    """Change of the heading in the last step [rad]."""


def check_plant(plant: Plant[Any] | None, robot: Robot) -> None:
    """Reject a plant that cannot serve as the robot's twin.

    Args:
        plant: A plant, or None.
        robot: Robot that the twin is to represent.

    Raises:
        ValueError: If it is not a plant, has other joints, or has joints that do not follow
            references.
    """
    if plant is None:
        return
    check_instance("plant", plant, Plant)
    n_yaw_joints = plant.robot.planar().n_joints
    n_expected = robot.planar().n_joints
    is_spatial = isinstance(plant.settings, scenarios.Spatial)
    has_pitch_joints = plant.robot.n_joints != n_yaw_joints
    if n_yaw_joints != n_expected or (has_pitch_joints and is_spatial):
        rule = f"must have {n_expected} joints, all of them yaw joints"
        raise BadArgument("plant", f"{rule}, got {plant.robot.n_joints}")
    if isinstance(plant.settings.joints, Prescribed):
        raise BadArgument(
            "plant", "must have joints that follow references, `pd` or `servo`, got 'prescribed'"
        )


def start_twin(plant: Plant[Any], reference: Vector) -> TwinState:
    """Return a twin at rest, straight, at the origin.

    Args:
        plant: Plant that runs alongside the filter.
        reference: First references [rad].
    """
    state = plant.init(interfaces.Start(), _command_references(reference))
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
    """Return the twin after a time step; None if it diverged or does not represent the robot.

    Its joints follow phi_ref + k (phi - phi_twin): the references drive it, and the sensor readings
    correct it.

    Args:
        plant: Plant that runs alongside the filter.
        state: State before the step.
        reference: phi_ref, held [rad].
        joint_angle: phi of the robot; None if unknown [rad].
        coupling: k [-].
        dt: Time step [s].
        fin: phi_ref of a driven fin; empty leaves it straight [rad].
    """
    n_fin_joints = len(plant.robot.driven_joints) - plant.robot.n_joints
    astray = 0.0
    if joint_angle is not None:
        deviation = joint_angle - state.joint_angle
        reference = reference + coupling * deviation
        if float(np.abs(deviation).max(initial=0.0)) > ASTRAY:
            astray = state.astray + dt
    command = _command_references(reference, fin[:n_fin_joints])
    plant_state, _, trouble = plant.advance(state.plant, command, dt, dt)
    observation = plant.observe(plant_state)
    # The motion of the water is left to the filter.
    drift = np.array(getattr(plant.environment, "uniform", (0.0, 0.0))[:2])
    velocity = observation.center_of_mass_velocity[:2] - drift
    rate = float(observation.heading_rate)
    has_diverged = not _is_possible_motion(velocity, rate)
    if trouble is not None or has_diverged or astray > ASTRAY_TIME:
        return None
    center_of_mass = observation.center_of_mass[:2]
    heading = float(observation.heading)
    displacement = center_of_mass - state.center_of_mass - dt * drift
    c = math.cos(state.heading)
    s = math.sin(state.heading)
    return TwinState(
        plant=plant_state,
        center_of_mass=center_of_mass,
        velocity=velocity,
        heading=heading,
        rate=rate,
        joint_angle=observation.joint_angle,
        astray=astray,
        along=float(c * displacement[0] + s * displacement[1]),
        across=float(c * displacement[1] - s * displacement[0]),
        turn=heading - state.heading,
    )


def _is_possible_motion(velocity: Vector, heading_rate: float) -> bool:
    """Return whether a robot can move so; nan cannot."""
    is_slow = bool(np.abs(velocity).max() < FASTEST)
    return is_slow and abs(heading_rate) < FASTEST_TURN


def _command_references(reference: Vector, fin: tuple[float, ...] = ()) -> interfaces.Command:
    """Return the command that holds joint references [rad]."""
    return interfaces.Command(gait=STILL, references=(*reference.tolist(), *fin))
