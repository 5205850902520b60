"""From a `Twist` to a command: what a swimmer does to go forward, to turn and to climb.

    kind = "drive"
    forward_speed = 0.15       # m/s, of linear.x at which the wave has its full amplitude
    amplitude_deg = 25
    turn_rate = 0.16           # rad/s, of angular.z at which the body has its full bend
    offset_deg = 10
    climb_speed = 0.07         # m/s, of linear.z at which thruster and pitch joints do all they can
    thruster = 0               # that pushes upward; left out: none
    thrust = 12.0
    pitch_offset_deg = 4

Keys are the fields of `Drive`.
"""

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import NamedTuple

from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import Command, Model, Planar
from laticauda.values import (
    BadArgument,
    RobotFileError,
    decode,
    keys_of,
    quantity,
    read_toml,
    take_kind,
    value_class,
)


class Wish(NamedTuple):
    """What is asked for: the parts of a `Twist` that a swimmer has."""

    forward: float = 0.0
    """linear.x [m/s]."""
    climb: float = 0.0
    """linear.z [m/s]."""
    turn: float = 0.0
    """angular.z [rad/s]."""


@value_class
class Drive:
    """How strongly a swimmer does what a `Twist` asks for: in proportion, up to its most; nothing is fed back.

    The speeds are those that the robot reaches, as measured in a run; they only scale what is asked for.
    """

    forward_speed: float = quantity("m/s", "Speed forward at full amplitude", gt=0.0, default=0.2)
    amplitude: float = quantity("rad", "Full amplitude of the wave", gt=0.0, le=pi, default=0.5)
    turn_rate: float = quantity("rad/s", "Turning rate at full bend", gt=0.0, default=0.2)
    offset: float = quantity(
        "rad", "Full bend of the yaw joints, to either side", ge=0.0, le=pi, default=0.2
    )
    climb_speed: float = quantity("m/s", "Speed upward at full thrust", gt=0.0, default=0.1)
    pitch_offset: float = quantity(
        "rad", "Full bend of the pitch joints, up or down", ge=0.0, le=pi, default=0.0
    )
    thruster: int | None = quantity(
        "",
        "Which of the thrusters with a `max_thrust` pushes upward; None: none",
        default=None,
        ge=0,
    )
    thrust: float = quantity("N", "Its full thrust", ge=0.0, default=0.0)

    def command(self, gait: Gait, robot: Robot, wish: Wish) -> Command:
        """Return the command for what is asked for.

        Going backward, the wave runs from tail to head.

        Args:
            gait: Gait of the scenario, of which the amplitude is set.
            robot: The robot.
            wish: What is asked for.
        """
        forward = _limited(wish.forward / self.forward_speed)
        climb = _limited(wish.climb / self.climb_speed)
        phase_shift = gait.phase_shift
        if forward < 0.0:
            phase_shift = -phase_shift
        thrusts = None
        if self.thruster is not None:
            values = [0.0] * _count_driven_thrusters(robot)
            values[self.thruster] = climb * self.thrust
            thrusts = tuple(values)
        return Command(
            gait=replace(gait, amplitude=abs(forward) * self.amplitude, phase_shift=phase_shift),
            offset=_limited(wish.turn / self.turn_rate) * self.offset,
            pitch_offset=-climb * self.pitch_offset,
            thrusts=thrusts,
        )

    def check(self, robot: Robot, model: Model) -> None:
        """Reject what the robot does not have.

        Args:
            robot: The robot.
            model: The model that computes it.

        Raises:
            ValueError: If something is missing.
        """
        n_thrusters = _count_driven_thrusters(robot)
        if self.thruster is not None and self.thruster >= n_thrusters:
            rule = f"must be below {n_thrusters}, the number of driven ones of the robot"
            raise BadArgument("thruster", f"{rule}, got {self.thruster}")
        has_pitch = any(joint.axis == "pitch" for joint in robot.joints)
        if self.pitch_offset > 0.0 and (isinstance(model, Planar) or not has_pitch):
            rule = "must be 0 without pitch joints, in space"
            raise BadArgument("pitch_offset", f"{rule}, got {self.pitch_offset:g} rad")


def load_drive(path: str | Path) -> Drive:
    """Load how a robot does what a `Twist` asks for.

    Args:
        path: Path of the TOML file.

    Raises:
        RobotFileError: If the file cannot be read, or anything in it is wrong.
    """
    with keys_of(path, RobotFileError):
        table = dict(read_toml(path, RobotFileError))
        take_kind(table, "drive")
        return decode(Drive, table)


def _count_driven_thrusters(robot: Robot) -> int:
    return sum(thruster.max_thrust is not None for thruster in robot.thrusters)


def _limited(share: float) -> float:
    return min(max(share, -1.0), 1.0)
