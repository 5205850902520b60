"""Faults in the tank, on command or according to a schedule in a TOML file.

A schedule is a list of tables ``[[faults]]``, each with the fields of `Fault`:

    [[faults]]
    kind = "leak"
    time = 12.0
    node = 5
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from laticauda.tank import protocol
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    check_choice,
    codec,
    files,
    option,
    quantity,
    value_class,
)

KINDS = {
    "frame_loss": "a `share` of the frames on the bus is lost",
    "frame_corruption": "a `share` of the frames on the bus arrives with wrong bytes",
    "bus_off": "a node neither sends nor hears",
    "dead_module": "a node has no power; when it comes back, it starts up anew",
    "stuck_servo": "a joint is jammed where it stands",
    "leak": "water in a module",
    "over_temperature": "a motor is as hot as `temperature`",
    "body_lost": "the cameras do not see the markers",
    "mocap_silent": "the cameras' server sends nothing",
    "meter_silent": "the meter does not answer",
    "late_computer": "frames of the operator's computer arrive late by `delay`",
    # What no device tells of; only who looks at the whole run may notice it.
    "weak_servo": "a motor has only a `share` of its torque",
    "slipped_zero": "a horn slips on its shaft by `angle_deg`, and the motor's sensor does not show it",
    "lost_fin": "the fin comes off",
    "moving_water": "the water moves at `speed`, `towards` an angle",
    "marker_slip": "the marker body turns on its module by `angle_deg`",
    "wrong_body": "the cameras mistake another body, which lies still, for the robot's",
    "clock_drift": "the cameras' clock is fast by a `share`",
}
"""What may go wrong in the virtual tank."""
ON_NODES = (
    "frame_loss",
    "frame_corruption",
    "bus_off",
    "dead_module",
    "stuck_servo",
    "leak",
    "over_temperature",
    "weak_servo",
    "slipped_zero",
)
"""Kinds of faults of one module."""


class FaultFileError(LaticaudaError, ValueError):
    """A schedule of faults is invalid; the message gives the file, the key, the rule and the value."""


@value_class
class Fault:
    """One fault."""

    kind: str = option(
        "Kind of fault; see `KINDS`",
        check=lambda name, kind: check_choice(name, kind, tuple(KINDS)),
    )
    time: float = quantity("s", "Time at which it begins, on the lab's clock", ge=0.0, default=0.0)
    duration: float = quantity(
        "s", "How long it lasts; infinite: to the end", ge=0.0, default=math.inf
    )
    node: int = quantity(
        "", "Node that it affects; 0: all", ge=0, le=protocol.N_NODES, default=protocol.EVERY_NODE
    )
    share: float = quantity(
        "",
        "Share of frames lost or corrupted, of a motor's torque that remains, or by which a clock is fast",
        ge=0.0,
        le=1.0,
        default=0.1,
    )
    delay: float = quantity("s", "Delay of late frames", ge=0.0, default=0.1)
    temperature: float = quantity(
        "deg C", "Temperature of the motor", ge=-273.15, le=1000.0, default=95.0
    )
    angle: float = quantity(
        "rad", "Angle by which a horn slips, or the marker body turns", default=math.radians(5.0)
    )
    speed: float = quantity("m/s", "Velocity of water that begins to move", ge=0.0, default=0.03)
    towards: float = quantity("rad", "Direction in which it moves", default=0.0)

    def __post_init__(self) -> None:
        """Check every field once."""
        if self.node != protocol.EVERY_NODE and self.kind not in ON_NODES:
            raise BadArgument("node", f"must be left out for `{self.kind}`, got {self.node}")

    def is_on(self, time: float) -> bool:
        """Return whether the fault is present at a time.

        Args:
            time: Time on the lab's clock [s].
        """
        return self.time <= time < self.time + self.duration


class Faults:
    """All present, past and future faults.

    Args:
        schedule: Faults that are known in advance.
    """

    def __init__(self, schedule: Iterable[Fault] = ()) -> None:
        self._all = list(schedule)
        self.present: tuple[Fault, ...] = ()
        """Faults that are present now."""

    def add(self, fault: Fault) -> None:
        """Add one more `fault`.

        Args:
            fault: Fault to add, with its place and time.
        """
        self._all.append(fault)

    def clear(self) -> None:
        """Remove all faults; what they have done remains."""
        self._all, self.present = [], ()

    def look(self, time: float) -> None:
        """Find the faults that are present at `time` [s]; later queries refer to this time.

        Args:
            time: Current time [s].
        """
        self.present = tuple(fault for fault in self._all if fault.is_on(time))

    def on(self, kind: str, node: int = protocol.EVERY_NODE) -> Fault | None:
        """Return a fault of `kind` that is present now, at `node` or everywhere; None if there is none.

        Args:
            kind: Kind of fault, such as `meter_silent`.
            node: Number of the module; by default, all modules.
        """
        for fault in self.present:
            if fault.kind == kind and fault.node in (protocol.EVERY_NODE, node):
                return fault
        return None


def load_faults(path: str | Path) -> tuple[Fault, ...]:
    """Read a schedule of faults.

    Args:
        path: Path of a TOML file.

    Raises:
        FaultFileError: If anything in it is invalid; the message gives the file, the entry, the
            rule and the value.
    """
    table = files.read_toml(path, FaultFileError)
    with codec.keys_of(path, FaultFileError):
        codec.check_keys(table, ("faults",))
        return codec.decode(tuple[Fault, ...], table.get("faults", []), "faults")


def fault_from_words(text: str, now: float) -> Fault:
    """Return the fault that a line such as `leak node=5 duration=2` describes; it begins now unless a `time` is given.

    Args:
        text: Kind, followed by fields.
        now: Current time on the lab's clock [s].

    Raises:
        ValueError: If the line does not describe a fault.
    """
    kind_and_fields = text.split()
    if not kind_and_fields:
        raise BadArgument("kind", "is missing")
    kind, *fields = kind_and_fields
    entry: dict[str, Any] = {"time": now}
    for field in fields:
        key, equals, value = field.partition("=")
        if not equals:
            raise BadArgument(key, f"must have a value: {key}=...")
        try:
            entry[key] = int(value) if key == "node" else float(value)
        except ValueError:
            raise BadArgument(key, f"must be a number, got {value!r}") from None
    return codec.decode(Fault, {**entry, "kind": kind})
