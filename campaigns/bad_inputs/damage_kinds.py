"""Files that are damaged at every 97th byte: flipped, zeroed or cut off.

Of a file that carries checksums the damage is named in a sentence, or every value is read as it was.
A file for people to edit, and one that another program wrote, has none: a digit that was changed is
another number, which nobody can tell. Of such a file anything may be read, but no traceback, and no
hang; how often another value was read is counted as `differs`.

`LEFT_OUT_FILES` are those that no code of laticauda reads.
"""

import contextlib
import dataclasses
import hashlib
import io
import random
import shutil
import signal
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

import laticauda as lc
from bad_inputs import odd
from bad_inputs.attempt import Answer, Case, fault
from laticauda.identify import from_table, load_basis
from laticauda.studies import open_sweep
from laticauda.trials.logs import load_column_map, load_trial
from laticauda.values import LaticaudaError
from laticauda.water.fluid.gridded import Gridded

STRIDE = 97
"""Bytes from one damaged place to the next."""
PLACES = 30
"""Places that one input tries at most."""
READING_TIME = 60
"""Time in which a damaged file is read [s]: a longer one counts as a hang."""
LEFT_OUT_FILES: Mapping[str, str] = {
    "robot.fmu": "laticauda writes FMUs, and reads none; what reads them checks the zip's own checksums",
    "mamba.dbc": "laticauda writes its description of the bus, and reads none; cantools reads it",
}
"""Files that the package has or writes, but does not read, and why they are not damaged here."""
FLIP, ZERO, CUT = "flipped", "zeroed", "cut"


@dataclass(frozen=True, kw_only=True)
class Format:
    """A file, or the files in a folder, and how they are read."""

    name: str
    """In the folder of good files."""
    read: Callable[[Path], Any]
    """Reads all values, or raises an error that says what is wrong."""
    has_checksums: bool
    is_slow: bool = False
    """Whether the file takes seconds to make: see `pantry.fill_slow_pantry`."""


class LossesNamed(LaticaudaError):
    """The reader says what is lost, and gives the rest."""


def _read_recording(path: Path) -> Any:
    from laticauda.tank.operate import read_operation

    log = read_operation(path)
    losses = getattr(log, "lost", None)
    if losses:
        raise LossesNamed(str(losses))
    return log


def _read_sweep(path: Path) -> Any:
    dataset = open_sweep(path).load()
    return {str(name): array.to_numpy() for name, array in dataset.variables.items()}


def _read_through_map(path: Path) -> Any:
    return load_trial(path, columns=path.with_name("map.toml"))


def _read_flow(path: Path) -> Any:
    """Read a current on a grid, and what it is at some places: it is read when it is first used."""
    flow = Gridded(source=str(path))
    places = np.array([[0.0, 0.0, 0.0], [1.0, -1.0, 0.0]])
    return replace(lc.load_water("paper-lateral"), current=flow).velocity(places, 1.0)


FORMATS = (
    Format(name="mamba.toml", read=lc.load_robot, has_checksums=False),
    Format(name="water.toml", read=lc.load_water, has_checksums=False),
    Format(name="parameters.toml", read=lc.load_parameters, has_checksums=False),
    Format(name="scenario.toml", read=lc.load_scenario, has_checksums=False),
    Format(name="flow.nc", read=_read_flow, has_checksums=False),
    Format(name="map.toml", read=load_column_map, has_checksums=False),
    Format(name="log.csv", read=_read_through_map, has_checksums=False),
    Format(name="speeds.csv", read=from_table, has_checksums=False),
    Format(name="trial.mat", read=load_trial, has_checksums=False),
    Format(name="trial.parquet", read=load_trial, has_checksums=False),
    Format(name="trial.nc", read=load_trial, has_checksums=True),
    Format(name="trial.mcap", read=load_trial, has_checksums=True),
    Format(name="recording.mcap", read=_read_recording, has_checksums=True, is_slow=True),
    Format(name="swept", read=_read_sweep, has_checksums=True, is_slow=True),
    Format(name="fit", read=load_basis, has_checksums=True, is_slow=True),
)
BESIDE: Mapping[str, tuple[str, ...]] = {"log.csv": ("map.toml",), "map.toml": ("mamba.toml",)}
"""Good files that are read with another one."""
FOR_PEOPLE = (".toml", ".csv", ".html", ".png", ".tex", ".md")
"""Endings of files in folders that people read or edit, and that have no checksum."""


def damage(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Every file that laticauda reads, damaged at places 97 bytes apart."""
    formats = [one for one in FORMATS if (folder / one.name).exists()]
    targets = [(one, change) for one in formats for change in (FLIP, ZERO, CUT)]
    for file_format, change in odd.draw_in_turn(rng, targets):
        path = _draw_file(rng, folder / file_format.name)
        places = list(range(rng.randrange(STRIDE), path.stat().st_size, STRIDE))
        if len(places) > PLACES:
            places = sorted(rng.sample(places, PLACES))
        attack = DamagedAt(
            file_format=file_format,
            folder=folder,
            file=path.relative_to(folder),
            change=change,
            places=tuple(places),
            bit=rng.randrange(8),
        )
        shown = f"{attack.file} {change} at {len(places)} places from byte {places[:1]}"
        yield Case("damage", shown, attack)


def _draw_file(rng: random.Random, path: Path) -> Path:
    """Return the file, or one of those in a folder that are not for people."""
    if path.is_file():
        return path
    files = [
        file
        for file in sorted(path.rglob("*"))
        if file.is_file() and file.suffix not in FOR_PEOPLE and file.stat().st_size
    ]
    return rng.choice(files)


@dataclass(frozen=True, kw_only=True)
class DamagedAt:
    """A file that is damaged at one place after the other."""

    file_format: Format
    folder: Path
    """The folder of good files."""
    file: Path
    """The damaged file, in it."""
    change: str
    places: Sequence[int]
    """Bytes."""
    bit: int
    """The bit that is flipped."""

    def __call__(self) -> Answer:
        """Damage the file at each place, and read it."""
        for name in (self.file_format.name, *BESIDE.get(self.file_format.name, ())):
            source = self.folder / name
            if source.is_dir():
                shutil.copytree(source, name)
            else:
                shutil.copy(source, name)
        good_content = self.file.read_bytes()
        expected = fingerprint(self._read())
        n_differing = 0
        for place in self.places:
            self.file.write_bytes(self._damaged(good_content, place))
            try:
                difference = self._judge(expected)
            except BaseException as error:  # no traceback, whatever it is
                return fault(f"byte {place}: {type(error).__name__}: {str(error)[:400]}")
            if difference:
                n_differing += 1
                if self.file_format.has_checksums:
                    return fault(f"byte {place}: {difference}")
        verdict = "differs" if n_differing else "refused"
        return Answer(verdict, f"{n_differing} of {len(self.places)}", len(self.places))

    def _damaged(self, content: bytes, place: int) -> bytes:
        if self.change == CUT:
            return content[:place]
        changed = content[place] ^ (1 << self.bit)
        if self.change == ZERO:
            changed = 0
        return content[:place] + bytes([changed]) + content[place + 1 :]

    def _judge(self, expected: str) -> str:
        """Read the file; return what is wrong: "" if its damage is named, or all values are as they were."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                found = fingerprint(self._read())
            except (ValueError, LaticaudaError, OSError, MemoryError) as error:
                if str(error).strip() and "Traceback" not in str(error):
                    return ""
                raise
        said = [str(warning.message) for warning in caught]
        if found == expected or any("damaged" in text or "checksum" in text for text in said):
            return ""
        return "other values are read, without a word"

    def _read(self) -> Any:
        path = Path(self.file_format.name)
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out), _time_limit():
            return self.file_format.read(path)


@contextlib.contextmanager
def _time_limit() -> Iterator[None]:
    """Raise an error if reading takes too long."""

    def end(number: int, frame: FrameType | None) -> None:
        raise AssertionError(f"a hang: it was not read in {READING_TIME} s")

    signal.signal(signal.SIGALRM, end)
    signal.alarm(READING_TIME)
    try:
        yield
    finally:
        signal.alarm(0)


def fingerprint(value: Any) -> str:
    """Return a text that is the same for values of the same bits, and another one for others.

    Args:
        value: What was read.
    """
    digest = hashlib.sha256()
    for part in _parts_of(value):
        digest.update(part)
    return digest.hexdigest()


def _parts_of(value: Any) -> Iterator[bytes]:
    """Yield the bytes of all that is in a value."""
    if isinstance(value, np.ndarray) and value.dtype != object:
        yield f"{value.dtype.str}{value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif dataclasses.is_dataclass(value):
        yield type(value).__name__.encode()
        for field in dataclasses.fields(value):
            yield field.name.encode()
            yield from _parts_of(getattr(value, field.name))
    elif isinstance(value, Mapping):
        for key, content in value.items():
            yield repr(key).encode()
            yield from _parts_of(content)
    elif isinstance(value, list | tuple):
        for content in value:
            yield from _parts_of(content)
    elif isinstance(value, np.ndarray):
        yield from _parts_of(value.tolist())
    elif type(value).__repr__ is object.__repr__:
        yield from _parts_of(vars(value))
    else:
        yield repr(value).encode()
