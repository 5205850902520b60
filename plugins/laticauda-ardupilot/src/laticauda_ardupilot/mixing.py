"""What every servo output of ArduPilot does to the robot, in TOML.

    kind = "mixing"
    attitude = "body"              # or "head": whose attitude and place the autopilot sees

    [[channels]]
    kind = "amplitude"             # or frequency, phase-shift, offset, pitch-offset, thrust, deflection
    servo = 1                      # SERVO1
    at_max_deg = 30                # at pwm_max = 1900 us; `at_trim` is 0, at pwm_trim = 1500 us
    at_min_deg = -30

    [battery]
    capacity = 10.0

Keys are the fields of `Mixing` and of the classes it holds.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

from laticauda.motion.gaits import Gait
from laticauda.robot import Robot
from laticauda.scenarios import EFFECTORS, Command, Model, Planar
from laticauda.values import (
    BadArgument,
    RobotFileError,
    decode,
    keys_of,
    option,
    read_toml,
    take_kind,
    value_class,
)
from laticauda_ardupilot.battery import Battery
from laticauda_ardupilot.channels import (
    Channel,
    Deflection,
    PitchOffset,
    Sums,
    Thrust,
    add_channels,
)

FILES = Path(__file__).parent / "files"
"""Folder of the files that come with the package."""


@value_class
class Mixing:
    """What every servo output does, and what the autopilot sees of the robot.

    What no channel names stays as in the scenario's gait.
    """

    channels: tuple[Channel, ...] = option("Servo outputs and what they do")
    attitude: Literal["body", "head"] = option(
        "Whose attitude and place the autopilot sees: the body's as a whole, or the head's",
        default="body",
    )
    battery: Battery | None = option("The battery; None: the autopilot sees none", default=None)

    def command(self, gait: Gait, robot: Robot, pwm: tuple[int, ...]) -> Command:
        """Return the command that the pulses of all outputs stand for.

        Args:
            gait: Gait of the scenario, of which the channels change numbers.
            robot: The robot, whose effectors have limits.
            pwm: Width of the pulse of every output, 0 without one [us].
        """
        sums = add_channels(self.channels, pwm)
        return Command(
            gait=_changed_gait(gait, sums),
            offset=sums.offset or 0.0,
            pitch_offset=sums.pitch_offset or 0.0,
            thrusts=_effector_values(robot, "thrusters", sums.thrusts),
            deflections=_effector_values(robot, "pectoral_fins", sums.deflections),
        )

    def check(self, robot: Robot, model: Model) -> None:
        """Reject channels that move what a robot does not have.

        Args:
            robot: The robot.
            model: The model that computes it.

        Raises:
            ValueError: If there is such a channel.
        """
        n_thrusters = _count_driven(robot, "thrusters")
        n_fins = _count_driven(robot, "pectoral_fins")
        has_pitch = any(joint.axis == "pitch" for joint in robot.joints)
        can_pitch = has_pitch and not isinstance(model, Planar)
        for i, channel in enumerate(self.channels):
            name = f"channels[{i}]"
            if isinstance(channel, Thrust):
                _check_number(f"{name}.thruster", channel.thruster, n_thrusters)
            elif isinstance(channel, Deflection):
                _check_number(f"{name}.fin", channel.fin, n_fins)
            elif isinstance(channel, PitchOffset) and not can_pitch:
                rule = "must not be `pitch-offset` without pitch joints, in space"
                raise BadArgument(f"{name}.kind", f"{rule}; the robot is `{robot.name}`")


def _changed_gait(gait: Gait, sums: Sums) -> Gait:
    """Return the gait with the numbers that channels set."""
    changes = dict[str, float]()
    if sums.amplitude is not None:
        changes["amplitude"] = _limited(sums.amplitude, 0.0, math.pi)
    if sums.frequency is not None:
        changes["frequency"] = max(sums.frequency, 0.0)
    if sums.phase_shift is not None:
        changes["phase_shift"] = _limited(sums.phase_shift, -math.pi, math.pi)
    return replace(gait, **changes)


def _limited(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _effector_values(
    robot: Robot, group: str, values: dict[int, float]
) -> tuple[float, ...] | None:
    """Return one value per driven effector, 0 for those without a channel; None if there is no channel at all."""
    if not values:
        return None
    return tuple(values.get(i, 0.0) for i in range(_count_driven(robot, group)))


def _count_driven(robot: Robot, group: str) -> int:
    """Return how many effectors of a group a command can set."""
    (kind,) = [effector for effector in EFFECTORS if effector.robot_field == group]
    limit = f"max_{kind.quantity}"
    return sum(getattr(effector, limit) is not None for effector in getattr(robot, group))


def _check_number(name: str, number: int, count: int) -> None:
    if number >= count:
        rule = f"must be below {count}, the number of driven ones of the robot"
        raise BadArgument(name, f"{rule}, got {number}")


def load_mixing(path: str | Path) -> Mixing:
    """Load a mixing table.

    Args:
        path: Path of the TOML file, or the name of one that comes with the package: `eel`.

    Raises:
        RobotFileError: If the file cannot be read, or anything in it is wrong; the message gives
            the file, the key, the rule and the value.
    """
    own_file = FILES / f"{path}-mixing.toml"
    if own_file.is_file():
        path = own_file
    with keys_of(path, RobotFileError):
        table = dict(read_toml(path, RobotFileError))
        take_kind(table, "mixing")
        return decode(Mixing, table)
