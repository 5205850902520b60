"""Table `control.network` of an animat: oscillators at their drives, and couplings.

Frequency and amplitude follow from the drive d: gain d + bias while low <= d <= high, else a saturation.
Files of 2023 count drives where later ones name them, and have one saturation where later ones have two.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from laticauda.connect.farms.entries import Entry


class Drives(NamedTuple):
    """Descending drives of both sides."""

    left: float
    """Of the left side [-]."""
    right: float
    """Of the right side [-]."""

    @property
    def middle(self) -> float:
        """Their mean [-]."""
        return 0.5 * (self.left + self.right)


@dataclass(frozen=True, kw_only=True)
class OscillatorPair:
    """Oscillators of a joint, by their names."""

    left: str
    """Name of the left one, `osc1`."""
    right: str
    """Name of the right one, `osc2`."""


@dataclass(frozen=True, kw_only=True)
class Oscillator:
    """Oscillator at its drive."""

    drive: float
    """d [-]."""
    frequency: float
    """omega [rad/s]."""
    amplitude: float
    """R [rad]."""
    rate: float
    """a [1/s]."""


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """Pull of one oscillator on another one."""

    pulled: str
    """Name of the oscillator that is pulled, `in` of the file."""
    pulling: str
    """Name of the oscillator that pulls, `out` of the file."""
    weight: float
    """w [1/(s rad)]."""
    bias: float
    """phi, by which the pulling one leads [rad]."""


@dataclass(frozen=True, kw_only=True)
class NetworkFile:
    """The network as the file states it, at given drives."""

    entry: Entry
    """Its table."""
    oscillators: Mapping[str, Oscillator]
    """Oscillators, by name."""
    couplings: Sequence[Coupling]
    """Couplings between oscillators."""

    def oscillator(self, name: str) -> Oscillator:
        """Return an oscillator that moves a joint.

        Args:
            name: Its name.

        Raises:
            RobotFileError: If there is none of that name.
        """
        if name not in self.oscillators:
            raise self.entry.error("oscillators", f"must have `{name}`, which moves a joint")
        return self.oscillators[name]


def read_network(
    entry: Entry,
    pairs: Sequence[OscillatorPair],
    drives: Drives | None,
) -> NetworkFile:
    """Read the table of a network.

    Args:
        entry: The table.
        pairs: Oscillators of the joints of the spine.
        drives: Drives in place of those of the file; None: those.

    Raises:
        RobotFileError: If a number is missing.
    """
    if drives is None:
        drive_of = _read_drives(entry)
    else:
        drive_of = _spread_drives(entry, pairs, drives)
    oscillators: dict[str, Oscillator] = {}
    for table in entry.items("oscillators"):
        name = table.text("name")
        if name not in drive_of:
            raise entry.error("drive2osc", f"must give a drive to oscillator `{name}`")
        oscillators[name] = _read_oscillator(table, drive_of[name])
    couplings = [_read_coupling(table) for table in entry.items("osc2osc")]
    return NetworkFile(entry=entry, oscillators=oscillators, couplings=couplings)


def _read_oscillator(table: Entry, drive: float) -> Oscillator:
    """Return an oscillator at a drive."""
    return Oscillator(
        drive=drive,
        frequency=value_at_drive(table, "frequency_", drive),
        amplitude=value_at_drive(table, "amplitude_", drive),
        rate=table.number("rate"),
    )


def _read_coupling(table: Entry) -> Coupling:
    """Return a coupling."""
    return Coupling(
        pulled=table.text("in"),
        pulling=table.text("out"),
        weight=table.number("weight"),
        bias=table.number("phase_bias"),
    )


def value_at_drive(
    table: Entry,
    prefix: str,
    drive: float,
) -> float:
    """Return a number that depends on a drive.

    Args:
        table: Table with gain, bias, low, high and saturation.
        prefix: Beginning of their keys.
        drive: The drive [-].
    """
    low = table.number(f"{prefix}low")
    high = table.number(f"{prefix}high")
    if low <= drive <= high:
        gain = table.number(f"{prefix}gain")
        return gain * drive + table.number(f"{prefix}bias")
    side = "low"
    if drive > high:
        side = "high"
    common = table.number(f"{prefix}saturation", 0.0)
    return table.number(f"{prefix}saturation_{side}", common)


# ---- drives --------------------------------------------------------------------------------------


def _spread_drives(
    entry: Entry,
    pairs: Sequence[OscillatorPair],
    drives: Drives,
) -> dict[str, float]:
    """Return one drive for all oscillators of the left, one for those of the right, the mean for limbs."""
    drive_of = {table.text("name"): drives.middle for table in entry.items("oscillators")}
    for pair in pairs:
        drive_of[pair.left] = drives.left
        drive_of[pair.right] = drives.right
    return drive_of


def _read_drives(entry: Entry) -> dict[str, float]:
    """Return the drive of every oscillator, by its name."""
    values = _values_of_drives(entry)
    if entry.is_list_of_numbers("drive2osc"):
        return _read_counted_drives(entry, list(values.values()))
    drive_of: dict[str, float] = {}
    for table in entry.items("drive2osc"):
        name = table.text("oscillator")
        drive_of[name] = _value_of_drive(table, "drive", values)
    return drive_of


def _read_counted_drives(entry: Entry, values: Sequence[float]) -> dict[str, float]:
    """Return the drive of every oscillator from a list of the drives' numbers."""
    names = [table.text("name") for table in entry.items("oscillators")]
    numbers = entry.numbers("drive2osc", len(names), -1.0)
    drive_of: dict[str, float] = {}
    for name, number in zip(names, numbers, strict=True):
        if 0 <= number < len(values):
            drive_of[name] = values[int(number)]
    return drive_of


def _values_of_drives(entry: Entry) -> dict[str, float]:
    """Return the first values of all drives, by name."""
    values: dict[str, float] = {}
    for table in entry.items("drives"):
        name = table.text("name")
        values[name] = table.number("initial_value")
    return values


def _value_of_drive(
    table: Entry,
    key: str,
    values: Mapping[str, float],
) -> float:
    """Return the value of a drive that a table names."""
    name = table.text(key)
    if name not in values:
        raise table.error(key, f"must be one of the drives, got `{name}`")
    return values[name]


def drives_of_joint(entry: Entry, joint: str) -> Drives | None:
    """Return the drives that bend a joint; None if the file does not say which.

    Args:
        entry: Table of the network.
        joint: Name of the joint.
    """
    if entry.is_list_of_numbers("drive2joint"):
        return None
    values = _values_of_drives(entry)
    for table in entry.items("drive2joint"):
        if table.text("joint") == joint:
            left = _value_of_drive(table, "drive0", values)
            right = _value_of_drive(table, "drive1", values)
            return Drives(left=left, right=right)
    return None
