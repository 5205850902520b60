"""Table of a campaign: a CSV file with a row for every run, to which one process at a time appends.

A row ends in a line feed. A last line without one was cut short when its process was killed, or
when the disk was full: readers leave it out, and the next process that writes cuts it off.
"""

import csv
import io
from collections.abc import Generator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from laticauda.studies import storage
from laticauda.values import BadArgument, local, locked
from laticauda.values.files import write


@dataclass(frozen=True, kw_only=True)
class MissionRow:
    """One run of a campaign: what was drawn, and what came of it."""

    campaign: str
    """Which mission under which conditions: see `name_of_campaign`."""
    seed: int
    """What decided the draw."""
    current: float
    """Speed of the current [m/s]."""
    current_direction: float
    """Where it flows to [rad]."""
    wave_height: float
    """Height of the waves [m]."""
    wave_period: float
    """Their period [s]."""
    failing: str
    """Sensor that failed."""
    fault: str
    """How."""
    fault_begin: float
    """From when on [s]."""
    fault_end: float
    """Until when [s]."""
    is_docked: int
    """1 if the dock has caught the robot."""
    duration: float
    """How long it took [s]."""
    clearance: float
    """How near the body came to anything but the dock [m]."""
    share_seen: float
    """Share of the net that was seen."""
    largest_error: float
    """Largest error of the believed position [m]."""
    last_phase: str
    """The phase in which it ended."""
    reason: str
    """Why that began."""


class CampaignTable:
    """A campaign's table, open for writing by this process alone; see `open_table`.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.rows = read_rows(path)
        """The rows so far, by seed, with the digits that the file has."""

    @property
    def seeds(self) -> set[int]:
        """Seeds of the runs that are stored."""
        return {row.seed for row in self.rows}

    def check_campaign(self, campaign: str) -> None:
        """Reject a table with rows of another mission, or of other conditions.

        Args:
            campaign: What all rows must be of.

        Raises:
            ValueError: If it has others.
        """
        if any(row.campaign != campaign for row in self.rows):
            rule = "must be a new file, or of the same mission under the same conditions"
            raise BadArgument("table", f"{rule}, got {self.path} of another one")

    def append(self, rows: Sequence[MissionRow]) -> None:
        """Append rows; a new file gets its header first.

        Args:
            rows: The rows.

        Raises:
            StorageFailed: If they cannot be written; all rows before them are kept.
        """
        text = _format_rows(rows)
        with storage(self.path, f"{len(self.rows)} runs are stored"):
            if not self.path.stat().st_size:
                text = _format_header() + text
            with self.path.open("a", newline="", encoding="utf-8") as file:
                file.write(text)
        self.rows = read_rows(self.path)

    def sort(self) -> None:
        """Order the rows in the file by seed, unless they are.

        Raises:
            StorageFailed: If they cannot be written; the file is as before.
        """
        text = _format_header() + _format_rows(self.rows)
        if self.path.read_bytes() != text.encode():
            write(self.path, text)


@contextmanager
def open_table(path: Path) -> Generator[CampaignTable]:
    """Open a campaign's table, and create it if there is none.

    Args:
        path: The file.

    Raises:
        ValueError: If it is no table of a campaign, or another process writes to it.
        StorageFailed: If it cannot be created.
    """
    with ExitStack() as stack:
        with storage(path, "nothing was changed"):
            try:
                stack.enter_context(locked(local(path), wait=False))
            except BlockingIOError as error:
                rule = f"must be one that no other process is writing to, got {path}"
                raise BadArgument("table", rule) from error
            table = CampaignTable(path)
            _cut_off_torn_row(path)
        yield table


def _cut_off_torn_row(path: Path) -> None:
    """Cut off a last line that is not complete."""
    content = path.read_bytes()
    complete = _leave_out_torn_row(content)
    if len(complete) < len(content):
        with path.open("r+b") as file:
            file.truncate(len(complete))


def _leave_out_torn_row(content: bytes) -> bytes:
    """Return the lines of a table that are complete."""
    return content[: content.rfind(b"\n") + 1]


def read_rows(path: Path) -> list[MissionRow]:
    """Return the rows of a campaign's file by seed; none if there is no file.

    Args:
        path: The file.

    Raises:
        ValueError: If it is no table of a campaign.
    """
    if not path.exists():
        return []
    content = path.read_bytes()
    if _format_header().encode().startswith(content):  # not even the header is complete
        return []
    text = _leave_out_torn_row(content).decode()
    types = {field.name: field.type for field in fields(MissionRow)}
    rows: list[MissionRow] = []
    reader = csv.DictReader(io.StringIO(text))
    if reader.fieldnames != list(types):
        raise BadArgument("table", f"must be a table of a campaign of missions, got {path}")
    for cells in reader:
        values: dict[str, Any] = {
            name: _value_of(cell, types[name]) for name, cell in cells.items()
        }
        rows.append(MissionRow(**values))
    return sorted(rows, key=lambda row: row.seed)


def _value_of(cell: str, field_type: object) -> str | int | float:
    """Return the value in a cell of a file."""
    if field_type is int:
        return int(cell)
    if field_type is float:
        return float(cell)
    return cell


def _format_header() -> str:
    return ",".join(field.name for field in fields(MissionRow)) + "\n"


def _format_rows(rows: Sequence[MissionRow]) -> str:
    """Return the lines of rows, numbers with five digits."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([_format_cell(value) for value in asdict(row).values()])
    return text.getvalue()


def _format_cell(value: str | int | float) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    return str(value)
