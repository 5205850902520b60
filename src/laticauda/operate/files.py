"""Trial files and series files: TOML, read strictly.

    kind = "trial"
    name = "line-1"
    robot = "mamba"
    duration = 60.0

    [gait]
    kind = "lateral-undulation"
    amplitude_deg = 30
    frequency_deg_s = 90
    phase_shift_deg = 40

    [following]                    # left out: open loop
    look_ahead_distance = 0.18

Tables and keys are the fields of `Operation` and of what it holds. Units are SI; an angle may be given in degrees under
its name with ``_deg``, an angular rate with ``_deg_s``. A series file has the kind ``series``, the number of `repeats`,
the table ``[common]`` with what all trials share, and a list ``[[trials]]`` of what differs.
"""

from pathlib import Path
from typing import cast

from laticauda import codec, files
from laticauda.errors import BadArgument, LaticaudaError
from laticauda.operate.settings import Operation
from laticauda.quantities import option, quantity, value


class OperationFileError(LaticaudaError, ValueError):
    """A trial or series file is wrong: it says which file, key, rule and value."""


@value
class SeriesFile:
    """What a series file says."""

    name: str = option("what its folder is called")
    repeats: int = quantity("", "how often every setting is run", ge=1, default=1)
    retries: int = quantity("", "how many rejected runs of a setting are run again", ge=0, default=1)
    trials: tuple[Operation, ...] = option("the settings, in their order")

    def __post_init__(self) -> None:
        """Refuse no trials, and two of one name."""
        if not self.trials:
            raise BadArgument("trials", "must hold at least one trial, got none")
        names = [operation.name for operation in self.trials]
        for name in names:
            if names.count(name) > 1:
                raise BadArgument("trials", f"must have names of their own, got {name!r} twice")


def load_operation(path: str | Path) -> Operation | SeriesFile:
    """Read a trial or series file.

    Args:
        path: Of the TOML file.

    Returns:
        The `Operation` of a trial file, or the `SeriesFile`.

    Raises:
        OperationFileError: If it cannot be read, or anything in it is wrong; the message has the file, the key, the
            rule and the value.
    """
    return parse_operation(files.read_text(path, OperationFileError), str(path))


def parse_operation(text: str, shown: str = "<text>") -> Operation | SeriesFile:
    """The same from a text.

    Args:
        text: TOML.
        shown: What messages call it.

    Raises:
        OperationFileError: As `load_operation`.
    """
    table = files.parse_toml(text, shown, OperationFileError)
    with codec.keys_of(shown, OperationFileError):
        if codec.take_kind(table, "trial", "series") == "trial":
            return codec.decode(Operation, table)
        return codec.decode(SeriesFile, _with_common(table))


def _with_common(table: codec.Table) -> codec.Table:
    """A series with what all trials share put into every one of them."""
    common, trials = codec.table_of(table.pop("common", {}), "common"), table.get("trials")
    if isinstance(trials, list):
        entries = [codec.table_of(entry, f"trials[{i}]") for i, entry in enumerate(cast("list[object]", trials))]
        table["trials"] = [codec.merged(common, entry) for entry in entries]
    return table
