"""One table in all the forms that people's programs write it in, and the three doors that it is brought to.

    python tests/table_forms.py    # forms x doors: read, read with a warning, or refused with the sentence

A form says how names and rows become the bytes of a file, and what must come of it at each door.
"""

import datetime
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.trials.logs import load_trial
from laticauda.trials.measured import load_speeds
from laticauda.values import LaticaudaError

STEP = 0.05
COUNT = 40
TIMES = [round(STEP * i, 10) for i in range(COUNT)]
EPOCH = 1_700_000_000
MAP = """
kind = "columns"
robot = "mamba"
longest_gap = 0.2
[time]
column = "t"
[center_of_mass]
position = ["x", "y"]
"""

Rows = list[list[str]]


@dataclass
class Cells:
    """Names and cells of a table, numbers with points."""

    names: list[str]
    rows: Rows
    units: list[str]
    map: str = MAP


def speeds() -> Cells:
    rows = [["LU", "30", "130.5", "40", "0.151"], ["LU", "25", "110.25", "40.5", "0.125"]]
    names = ["gait", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s"]
    return Cells(names, rows, ["", "deg", "deg/s", "deg", "m/s"])


def angles() -> Cells:
    degrees = [[20.0 * np.sin(3.0 * t), 25.0 * np.sin(3.0 * t + 0.7)] for t in TIMES]
    rows = [[f"{t}", f"{a:.3f}", f"{b:.3f}"] for t, (a, b) in zip(TIMES, degrees, strict=True)]
    return Cells(["time_s", "joint_1_deg", "joint_2_deg"], rows, ["s", "deg", "deg"])


def log() -> Cells:
    rows = [[f"{t}", f"{0.5 + 0.15 * t:.4f}", "0.010"] for t in TIMES]
    return Cells(["t", "x", "y"], rows, ["s", "m", "m"])


def read_speeds(path: Path, _: Cells) -> list[list[float]]:
    trials = load_speeds(path)
    return [[t.alpha_deg, t.omega_deg_s, t.delta_deg, t.v_m_s or 0.0] for t in trials]


def read_angles(path: Path, _: Cells) -> list[list[float]]:
    recorded = lc.load_joint_angles(path)
    return np.column_stack((recorded.time, np.degrees(np.array(recorded.angle).T))).tolist()


def read_log(path: Path, cells: Cells) -> list[list[float]]:
    column_map = path.with_name("map.toml")
    column_map.write_text(cells.map, encoding="utf-8")
    trial = load_trial(path, column_map)
    return np.column_stack((trial.time, trial.center_of_mass)).tolist()


DOORS: dict[str, tuple[Callable[[], Cells], Callable[[Path, Cells], list[list[float]]]]] = {
    "--table": (speeds, read_speeds),
    "--joint-angles": (angles, read_angles),
    "column map": (log, read_log),
}


def numbers_of(cells: Cells) -> list[list[float]]:
    return [[float(cell) for cell in row if cell != "LU"] for row in cells.rows]


# ---- how files are written -----------------------------------------------------------------------


def joined(cells: Cells, separator: str = ",", end: str = "\n") -> str:
    return "".join(f"{separator.join(row)}{end}" for row in [cells.names, *cells.rows])


def commas(cells: Cells, quote: str = "") -> Cells:
    def comma(cell: str) -> str:
        return f"{quote}{cell.replace('.', ',')}{quote}" if "." in cell else cell

    return Cells(cells.names, [[comma(cell) for cell in row] for row in cells.rows], cells.units)


def with_times(cells: Cells, times: Iterable[object], name: str | None = None) -> Cells:
    """The same rows at other times; --table has none."""
    if cells.names[0] == "gait":
        return cells
    rows = [[str(t), *row[1:]] for t, row in zip(times, cells.rows, strict=True)]
    names = [name or cells.names[0], *cells.names[1:]]
    return Cells(names, rows, cells.units, cells.map.replace('"t"', f'"{names[0]}"'))


def clock(t: float, pattern: str) -> str:
    return (datetime.datetime(2026, 11, 29, 17, 30) + datetime.timedelta(seconds=t)).strftime(
        pattern
    )


def changed(cells: Cells, row: int, column: int, text: str) -> Cells:
    rows = [list(cells_of_row) for cells_of_row in cells.rows]
    rows[row][column] = text
    return Cells(cells.names, rows, cells.units)


def scaled(cells: Cells, factor: float, columns: Iterable[int]) -> Cells:
    rows = [list(row) for row in cells.rows]
    for row in rows:
        for column in columns:
            row[column] = repr(factor * float(row[column]))
    return Cells(cells.names, rows, cells.units)


def in_brackets(cells: Cells) -> Cells:
    names = [
        f"{name.removesuffix('_deg').removesuffix('_s')} [{unit}]" if unit else name
        for name, unit in zip(cells.names, cells.units, strict=True)
    ]
    return Cells(names, cells.rows, cells.units)


def unit_row(cells: Cells, form: str = "{}") -> str:
    units = [form.format(unit) if unit else "" for unit in cells.units]
    return joined(Cells(cells.names, [units, *cells.rows], cells.units))


def wrong_unit_row(cells: Cells) -> str:
    wrong = {"deg": "rad", "m": "s"}
    units = [wrong.get(unit, unit) for unit in cells.units]
    return joined(Cells(cells.names, [units, *cells.rows], cells.units))


# ---- forms ---------------------------------------------------------------------------------------


@dataclass
class Form:
    """How a table is written, and what must come of it."""

    change: Callable[[Cells], Cells | str | bytes]
    refused: dict[str, str] = field(default_factory=dict)
    """What the sentence says, by the doors that refuse it."""
    warned: dict[str, str] = field(default_factory=dict)
    """What the warning says, by the doors that warn."""
    doors: tuple[str, ...] = tuple(DOORS)
    """Doors where it can be brought."""
    ending: str = ".csv"


TIMED = ("--joint-angles", "column map")
SINCE_1970 = {"--joint-angles": "since 1970; time 0 is its first row"}
EVERYWHERE = tuple(DOORS)


def everywhere(sentence: str) -> dict[str, str]:
    return dict.fromkeys(EVERYWHERE, sentence)


def timed(sentence: str) -> dict[str, str]:
    return dict.fromkeys(TIMED, sentence)


FORMS: dict[str, Form] = {
    "commas": Form(joined),
    "Windows lines": Form(lambda c: joined(c, end="\r\n")),
    "old Mac lines": Form(lambda c: joined(c, end="\r")),
    "tabs": Form(lambda c: joined(c, "\t"), ending=".tsv"),
    "semicolons": Form(lambda c: joined(c, ";")),
    "bars": Form(lambda c: joined(c, "|"), ending=".txt"),
    "blanks": Form(lambda c: joined(c, " ")),
    "aligned blanks": Form(lambda c: joined(c, "   ", "  \n")),
    "semicolons, decimal commas": Form(lambda c: joined(commas(c), ";")),
    "tabs, decimal commas": Form(lambda c: joined(commas(c), "\t")),
    "quoted decimal commas": Form(lambda c: joined(commas(c, '"'))),
    "bare decimal commas": Form(
        lambda c: joined(commas(c)), refused=everywhere(r"row \d+ must have \d cells")
    ),
    "sep=;": Form(lambda c: "sep=;\r\n" + joined(commas(c), ";", "\r\n")),
    "sep=,": Form(lambda c: "SEP=,\n" + joined(c)),
    "byte-order mark": Form(lambda c: b"\xef\xbb\xbf" + joined(c).encode()),
    "UTF-16": Form(lambda c: joined(c, "\t").encode("utf-16")),
    "UTF-16, big-endian": Form(lambda c: b"\xfe\xff" + joined(c, ";").encode("utf-16-be")),
    "UTF-16 without a mark": Form(lambda c: joined(c).encode("utf-16-le")),
    "Latin-1": Form(lambda c: "# Größe\n".encode("latin-1") + joined(c).encode()),
    "comments": Form(lambda c: "# made by hand\n\n" + joined(c) + "# end\n"),
    "names in a comment": Form(lambda c: "# " + joined(c)),
    "a row of units": Form(unit_row),
    "a row of units in brackets": Form(lambda c: unit_row(c, "[{}]")),
    "a row of other units": Form(
        wrong_unit_row,
        refused={
            "--table": "row 2 says rad for column `alpha_deg`, whose name says deg",
            "--joint-angles": "row 2 says rad for column `joint_1_deg`, whose name says deg",
            "column map": "Column `x` must be in m, cm, mm, in, but the file says 's'",
        },
    ),
    "units in brackets": Form(
        in_brackets,
        refused={"--table": r"column `alpha \[deg\]` is not known; did you mean `alpha_deg`\?"},
    ),
    "trailing separators": Form(lambda c: joined(c, end=",,\n")),
    "empty rows at the end": Form(lambda c: joined(c) + ",,,,\n" * 3),
    "a running number": Form(
        lambda c: Cells(["", *c.names], [[str(i), *r] for i, r in enumerate(c.rows)], c.units)
    ),
    "s since 1970": Form(
        lambda c: with_times(c, [f"{EPOCH + t:.3f}" for t in TIMES]), warned=SINCE_1970, doors=TIMED
    ),
    "ms since 1970": Form(
        lambda c: with_times(c, [round(1e3 * (EPOCH + t)) for t in TIMES]),
        warned=SINCE_1970,
        doors=TIMED,
    ),
    "us since 1970": Form(
        lambda c: with_times(c, [EPOCH * 10**6 + round(1e6 * t) for t in TIMES]),
        warned=SINCE_1970,
        doors=TIMED,
    ),
    "ns since 1970": Form(
        lambda c: with_times(c, [EPOCH * 10**9 + round(1e9 * t) for t in TIMES]),
        warned=SINCE_1970,
        doors=TIMED,
    ),
    "dates": Form(
        lambda c: with_times(c, [clock(t, "%Y-%m-%dT%H:%M:%S.%f") for t in TIMES]),
        warned=SINCE_1970,
        doors=TIMED,
    ),
    "a clock": Form(
        lambda c: with_times(c, [clock(t, "%H:%M:%S.%f") for t in TIMES]),
        warned={"--joint-angles": "its times begin at 63000 s; time 0 is its first row"},
        doors=TIMED,
    ),
    "ms by name": Form(
        lambda c: with_times(c, [round(1e3 * t) for t in TIMES], "time_ms"), doors=TIMED
    ),
    "ns by name": Form(
        lambda c: with_times(c, [round(1e9 * t) for t in TIMES], "time_ns"), doors=TIMED
    ),
    "ms unsaid": Form(
        lambda c: with_times(c, [1e3 * t for t in TIMES]),
        refused=timed(r"must have steps of at most 1 s, got 50 s; is its unit ms\?"),
        doors=TIMED,
    ),
    "ns unsaid": Form(
        lambda c: with_times(c, [1e9 * t for t in TIMES]),
        refused=timed(r"got 5e\+07 s; is its unit ns\?"),
        doors=TIMED,
    ),
    "a late start": Form(
        lambda c: with_times(c, [12.3 + t for t in TIMES]),
        warned={"--joint-angles": "its times begin at 12.3 s; time 0 is its first row"},
        doors=TIMED,
    ),
    "a time twice": Form(
        lambda c: with_times(c, [TIMES[9] if t == TIMES[10] else t for t in TIMES]),
        refused=timed("must increase strictly, got 0.45 s and then 0.45 s in row 12"),
        doors=TIMED,
    ),
    "time backward": Form(
        lambda c: with_times(c, TIMES[::-1]), refused=timed("must increase strictly"), doors=TIMED
    ),
    "a name twice": Form(
        lambda c: Cells([*c.names[:-1], c.names[-2]], c.rows, c.units),
        refused=everywhere(r"row 1 must name every column once, got `\w+` twice"),
    ),
    "no names": Form(
        lambda c: joined(c).split("\n", 1)[1].replace("LU", "1"),
        refused=everywhere("row 1 must have the names of the columns"),
    ),
    "an empty cell": Form(
        lambda c: changed(c, 1, 2, ""),
        refused={
            "--table": "row 3: `omega_deg_s` must be a number, got ''",
            "--joint-angles": "column `joint_2_deg` must hold a number in every row, but has none in row 3",
            "column map": "",
        },
    ),
    "a word": Form(
        lambda c: changed(c, 1, 2, "oops"),
        refused={
            "--table": "row 3: `omega_deg_s` must be a number, got 'oops'",
            "--joint-angles": "Column `joint_2_deg` must hold numbers, got 'oops' in row 3",
            "column map": "Column `y` must hold numbers, got 'oops' in row 3",
        },
    ),
    "separators of thousands": Form(
        lambda c: changed(c, 1, 2, '"1,130.5"'),
        refused={
            "--table": "row 3: `omega_deg_s` must be a number, got '1,130.5'",
            "--joint-angles": "got '1,130.5' in row 3; write it without separators of thousands",
            "column map": "got '1,130.5' in row 3; write it without separators of thousands",
        },
    ),
    "a cut row": Form(
        lambda c: joined(c).rstrip().rsplit(",", 1)[0],
        refused=everywhere(r"row \d+ must have \d cells, as row 1 has, got \d"),
    ),
    "an open quote": Form(
        lambda c: changed(c, 1, 2, '"1'), refused=everywhere("row 3: unexpected end of data")
    ),
    "nothing": Form(lambda _: b"", refused=everywhere("it is not a text file of columns")),
    "names alone": Form(
        lambda c: Cells(c.names, [], c.units),
        refused={
            "--table": "the table has no rows",
            "--joint-angles": "at least a row of names and a row of numbers",
            "column map": "at least a row of names and a row of numbers",
        },
    ),
    "rubbish": Form(
        lambda _: bytes(range(256)), refused=everywhere("it is not a text file of columns")
    ),
    "an old Excel file": Form(
        lambda _: b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        refused=everywhere("it is an old Excel file; save it as .xlsx or as CSV"),
    ),
    "a damaged Excel file": Form(
        lambda _: b"PK\x03\x04",
        refused=everywhere("Reading Excel files needs openpyxl|it is not an intact Excel file"),
        ending=".xlsx",
    ),
    "rad for deg": Form(
        lambda c: scaled(c, np.pi / 180.0, [1] if c.names[0] == "gait" else [1, 2]),
        refused={
            "--table": r"column `alpha_deg` only reaches 0.52\d*, too little for deg; is it in rad\?",
            "--joint-angles": r"only reaches 0.436, too little for deg; is it in rad\?",
        },
        doors=("--table", "--joint-angles"),
    ),
    "deg for rad": Form(
        lambda c: Cells([n.replace("_deg", "_rad") for n in c.names], c.rows, c.units),
        refused={
            "--table": r"`alpha_rad` is not known; did you mean `alpha_deg`\?",
            "--joint-angles": r"`joint_1_rad` must be between -pi and pi rad, got 19.96 rad; is its `unit` deg\?",
        },
        doors=("--table", "--joint-angles"),
    ),
    "mm for m": Form(
        lambda c: scaled(c, 1e3, [1, 2]),
        refused={"column map": r"at most 5 lengths per second, got 150 m/s; is `length_unit` mm\?"},
        doors=("column map",),
    ),
    "whole turns": Form(
        lambda c: Cells(
            c.names,
            [[t, repr(float(a) + 360.0 * (i > 20)), b] for i, (t, a, b) in enumerate(c.rows)],
            c.units,
        ),
        warned={"--joint-angles": "whole turns were taken out of joint_1_deg"},
        doors=("--joint-angles",),
    ),
    "an encoder from 0 to 360": Form(
        lambda c: Cells(c.names, [[t, repr(float(a) % 360.0), b] for t, a, b in c.rows], c.units),
        warned={"--joint-angles": "whole turns were taken out of joint_1_deg"},
        doors=("--joint-angles",),
    ),
    "a lost encoder": Form(
        lambda c: changed(c, 20, 1, "999"),
        refused={"--joint-angles": "`joint_1_deg` jumps by .* in row 22: no joint turns that fast"},
        doors=("--joint-angles",),
    ),
    "a lost marker": Form(
        lambda c: changed(changed(c, 20, 1, "0"), 20, 2, "0"), doors=("column map",)
    ),
}
del FORMS["an empty cell"].refused["column map"]


@dataclass
class Result:
    """What came of a form at a door."""

    numbers: list[list[float]] | None
    """None if it was refused."""
    sentence: str
    """Why it was refused, or what was warned of; "" if neither."""


def bring(form: Form, door: str, folder: Path) -> Result:
    """Bring a form of the door's table to the door."""
    make, read = DOORS[door]
    cells = form.change(make())
    content = cells if isinstance(cells, str | bytes) else joined(cells)
    path = folder / f"table{form.ending}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    known = cells if isinstance(cells, Cells) else make()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            numbers = read(path, known)
        except LaticaudaError as error:
            return Result(None, str(error))
    return Result(numbers, "; ".join(str(warning.message) for warning in caught))


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        for name, form in FORMS.items():
            for door in form.doors:
                result = bring(form, door, Path(folder))
                outcome = "refused" if result.numbers is None else "read"
                sentence = result.sentence.replace(folder, "")
                sys.stdout.write(f"{name:28} {door:15} {outcome:8} {sentence}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
