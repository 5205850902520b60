"""Is a table of any dialect read right, or refused with its cause, by every reader of tables?

Question: dialects are drawn at random (separator x decimal sign x encoding x header x time base x
unit x line ends), one table is written in each, and brought to `identify --table`, `--joint-angles`
and a log with a column map. Which give other numbers than those that were written, without a word?

    python campaigns/dialects.py          # the counts, from dialects.csv
    python campaigns/dialects.py --run    # 200 dialects anew, a minute of one core; writes dialects.csv
    python campaigns/dialects.py --run --number 2000 --seed 7  # others; writes nothing

Verdicts: `right`; `said` (other numbers, as the file calls radians degrees, and the trial says so);
`cured` (refused, and right once the message's `--column` is typed); `refused`
(with a sentence that names the file); `SILENT` (read, with other numbers); `crashed` (an error that
is no sentence). The last two must be 0.
"""

import argparse
import csv
import io
import math
import random
import shlex
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.identify import from_table
from laticauda.trials.logs import load_trial
from laticauda.values import LaticaudaError, TableWarning
from laticauda.values.tables import parse_columns

STORED = Path(__file__).with_suffix(".csv")
NUMBER = 200
SEED = 1
N_ROWS = 40
STEP = 0.05
"""Time between rows [s]."""
EPOCH = 1_764_437_400
"""2025-11-29 17:30 [s]."""
SEPARATORS = {"comma": ",", "semicolon": ";", "tab": "\t", "bar": "|", "blank": " "}
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1", "xlsx")
HEADERS = (
    "ours",
    "brackets",
    "parentheses",
    "unit row",
    "comment",
    "own names",
    "sep line",
    "none",
)
TIMES = {
    "s": (1.0, 0.0),
    "s, late": (1.0, 12.5),
    "s since 1970": (1.0, EPOCH),
    "ms since 1970": (1e3, EPOCH),
    "us since 1970": (1e6, EPOCH),
    "ns since 1970": (1e9, EPOCH),
    "ms": (1e3, 0.0),
    "ms unsaid": (1e3, 0.0),
    "us": (1e6, 0.0),
}
"""Units per second, and the time of the first row [s]."""
UNITS = ("deg", "rad", "deg called rad", "rad called deg")
ENDS = {"unix": "\n", "windows": "\r\n", "mac": "\r"}
DOUBT = "as angles in rad would"
"""What a trial says of a heading in degrees that never swings."""
DOORS = ("--table", "--joint-angles", "column map")


class Answer(NamedTuple):
    """What became of one table at one door."""

    door: str
    separator: str
    decimal: str
    encoding: str
    header: str
    time: str
    unit: str
    ends: str
    verdict: str
    sentence: str


class Column(NamedTuple):
    """A column as it is written."""

    ours: str
    """Our name, with its unit."""
    theirs: str
    """A name that somebody else gives it."""
    unit: str
    """The unit that the file states."""
    cells: Sequence[str]


Dialect = dict[str, str]


def draw_dialect(draw: random.Random) -> Dialect:
    """Return a dialect."""
    encodings = [name for name in ENCODINGS if name != "xlsx" or find_spec("openpyxl")]
    return {
        "separator": draw.choice(list(SEPARATORS)),
        "decimal": draw.choice([".", ".", ","]),
        "encoding": draw.choice(encodings),
        "header": draw.choice(HEADERS),
        "time": draw.choice(list(TIMES)),
        "unit": draw.choice(["deg", "deg", "rad", *UNITS[2:]]),
        "ends": draw.choice(list(ENDS)),
    }


# ---- what is written -----------------------------------------------------------------------------


def true_numbers(door: str) -> np.ndarray:
    """Return what a reader must give: rows of angles [deg], positions [m], speeds [m/s] and times [s]."""
    time = STEP * np.arange(N_ROWS)
    if door == "--table":
        return np.array([[30.0, 130.5, 40.25, 0.1514], [25.5, 110.25, 40.5, 0.125]])
    if door == "--joint-angles":
        swing = [20.0 * np.sin(3.0 * time + phase) for phase in (0.0, 0.7, 1.4)]
        return np.round(np.column_stack((time, *swing)), 6)
    heading = 30.0 * np.sin(3.0 * time)
    return np.round(np.column_stack((time, 0.5 + 0.15 * time, 0.0 * time + 0.01, heading)), 6)


def write_angle(degrees: float, dialect: Dialect) -> str:
    """Return an angle in the dialect's unit."""
    if dialect["unit"].startswith("rad"):
        return f"{math.radians(degrees):.12f}"
    return f"{degrees:.6f}"


def write_time(seconds: float, dialect: Dialect) -> str:
    """Return a time in the dialect's unit, in whole numbers where it is a small one."""
    factor, start = TIMES[dialect["time"]]
    if factor == 1.0:
        return f"{start + seconds:.6f}"
    return str(int(start) * int(factor) + round(factor * seconds))


def columns_of(door: str, dialect: Dialect) -> list[Column]:
    """Return the columns of the door's table."""
    numbers = true_numbers(door).T
    angle_unit = dialect["unit"].rsplit(" ", 1)[-1]
    if door == "--table":
        alpha, omega, delta = ([write_angle(x, dialect) for x in row] for row in numbers[:3])
        return [
            Column("gait", "Gait", "", ["LU", "LU"]),
            Column(f"alpha_{angle_unit}", "Amplitude", angle_unit, alpha),
            Column(f"omega_{angle_unit}_s", "Frequency", f"{angle_unit}/s", omega),
            Column(f"delta_{angle_unit}", "Phase shift", angle_unit, delta),
            Column("v_m_s", "Speed", "m/s", [f"{x:.6f}" for x in numbers[3]]),
        ]
    time_unit = dialect["time"].split()[0].strip(",")
    name = f"time_{time_unit}"
    if dialect["time"] in ("ms unsaid", "ns since 1970"):
        time_unit, name = "", "time"
    columns = [Column(name, "Timestamp", time_unit, [write_time(t, dialect) for t in numbers[0]])]
    if door == "--joint-angles":
        for i, row in enumerate(numbers[1:], start=1):
            cells = [write_angle(x, dialect) for x in row]
            columns.append(Column(f"joint_{i}_{angle_unit}", f"Phi{i}", angle_unit, cells))
        return columns
    x, y = ([f"{number:.6f}" for number in row] for row in numbers[1:3])
    yaw = [write_angle(number, dialect) for number in numbers[3]]
    return [
        *columns,
        Column("x_m", "East", "m", x),
        Column("y_m", "North", "m", y),
        Column(f"yaw_{angle_unit}", "Heading", angle_unit, yaw),
    ]


def names_of(columns: Sequence[Column], header: str) -> list[str]:
    """Return the names that a file gives to columns."""
    names: list[str] = []
    for column in columns:
        bare = column.ours.removesuffix(f"_{column.unit.replace('/', '_')}")
        names.append(
            {
                "brackets": f"{bare} [{column.unit}]" if column.unit else bare,
                "parentheses": f"{bare} ({column.unit})" if column.unit else bare,
                "unit row": bare,
                "own names": f"{column.theirs} [{column.unit}]" if column.unit else column.theirs,
            }.get(header, column.ours)
        )
    return names


def write_table(path: Path, door: str, dialect: Dialect) -> list[str]:
    """Write the door's table in a dialect, and return the names of its columns."""
    columns = columns_of(door, dialect)
    names = names_of(columns, dialect["header"])
    rows = [list(cells) for cells in zip(*(column.cells for column in columns), strict=True)]
    if dialect["decimal"] == ",":
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    if dialect["header"] == "unit row":
        rows.insert(0, [column.unit for column in columns])
    if dialect["header"] != "none":
        rows.insert(0, names)
    if dialect["encoding"] == "xlsx":
        write_workbook(path, rows)
        return names
    separator = SEPARATORS[dialect["separator"]]
    text = io.StringIO()
    if dialect["header"] == "sep line":
        text.write(f"sep={separator}\n")
    if dialect["header"] == "comment":
        text.write("# ")
    csv.writer(text, delimiter=separator, lineterminator="\n").writerows(rows)
    content = text.getvalue().replace("\n", ENDS[dialect["ends"]])
    path.write_bytes(content.encode(dialect["encoding"]))
    return names


def write_workbook(path: Path, rows: Sequence[Sequence[str]]) -> None:
    """Write cells as a workbook, numbers as such."""
    import openpyxl

    book = openpyxl.Workbook()
    sheet: Any = book.active
    for row in rows:
        cells: list[Any] = []
        for cell in row:
            try:
                cells.append(float(cell))
            except ValueError:
                cells.append(cell)
        sheet.append(cells)
    book.save(path)


# ---- what is read --------------------------------------------------------------------------------


class Reading(NamedTuple):
    """What a reader gave."""

    numbers: np.ndarray
    """In the units of `true_numbers`."""
    status: str = ""
    """What it says of them."""


def read_numbers(
    door: str, path: Path, names: Sequence[str], columns: Mapping[str, str] | None
) -> Reading:
    """Return what a reader gives."""
    if door == "--table":
        rows: list[list[float]] = []
        for measurement in from_table(path, columns=columns):
            gait = measurement.scenario.gait
            angles = np.degrees([gait.amplitude, gait.frequency, gait.phase_shift])
            rows.append([*angles, measurement.figures["forward_velocity"][0]])
        return Reading(np.array(rows))
    if door == "--joint-angles":
        recorded = lc.load_joint_angles(path, columns=columns)
        return Reading(np.column_stack((recorded.time, np.degrees(np.array(recorded.angle).T))))
    time, x, y, yaw = names
    column_map = path.with_name("map.toml")
    column_map.write_text(
        f'kind = "columns"\nrobot = "mamba"\ntime.column = "{time}"\n'
        f'center_of_mass.position = ["{x}", "{y}"]\nheading.column = "{yaw}"\n'
    )
    trial = load_trial(path, column_map)
    numbers = np.column_stack((trial.time, trial.center_of_mass, np.degrees(trial.heading)))
    return Reading(numbers, trial.status)


def judge(door: str, dialect: Dialect, folder: Path) -> tuple[str, str]:
    """Return the verdict on a dialect at a door, and what was said."""
    ending = ".xlsx" if dialect["encoding"] == "xlsx" else ".csv"
    path = folder / f"table{ending}"
    names = write_table(path, door, dialect)
    verdict = "right"
    refusal = ""
    columns: Mapping[str, str] | None = None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TableWarning)
        try:
            reading = read_numbers(door, path, names, columns)
        except LaticaudaError as error:
            refusal = str(error).replace(f"{folder}/", "")
            if "--column " not in refusal:
                return "refused", refusal
            columns = parse_columns(shlex.split(refusal.split("--column ")[1]))
            try:
                reading = read_numbers(door, path, names, columns)
            except LaticaudaError as again:
                return "refused", str(again).replace(f"{folder}/", "")
            verdict = "cured"
        except Exception as error:  # whatever is no sentence
            return "crashed", f"{type(error).__name__}: {error}".replace(f"{folder}/", "")
    numbers, expected = reading.numbers, true_numbers(door)
    if numbers.shape != expected.shape or not np.allclose(numbers, expected, rtol=1e-6, atol=1e-5):
        if DOUBT in reading.status:
            return "said", reading.status
        return "SILENT", refusal
    return verdict, refusal


def judge_dialects(number: int, seed: int) -> list[Answer]:
    """Return the answers on so many dialects, each at every door."""
    draw = random.Random(seed)
    answers: list[Answer] = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(number):
            dialect = draw_dialect(draw)
            for door in DOORS:
                verdict, sentence = judge(door, dialect, Path(folder))
                shown = " ".join(sentence.split())[:200]
                answers.append(Answer(door=door, **dialect, verdict=verdict, sentence=shown))
    return answers


def stored() -> list[Answer]:
    """Return the last answer."""
    with STORED.open(encoding="utf-8", newline="") as file:
        return [Answer(**row) for row in csv.DictReader(file)]


def table(answers: Sequence[Answer]) -> str:
    """Return how many dialects have which verdict at which door."""
    verdicts = ("right", "said", "cured", "refused", "crashed", "SILENT")
    lines = ["| door | dialects | " + " | ".join(verdicts) + " |", "|---" * 8 + "|"]
    for door in DOORS:
        counts = Counter(answer.verdict for answer in answers if answer.door == door)
        cells = [door, str(counts.total()), *(str(counts[verdict]) for verdict in verdicts)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--number", type=int, default=NUMBER)
    parser.add_argument("--seed", type=int, default=SEED)
    arguments = parser.parse_args()
    if not arguments.run:
        print(table(stored()))
        return 0
    answers = judge_dialects(arguments.number, arguments.seed)
    for answer in answers:
        if answer.verdict in ("SILENT", "crashed"):
            print(*answer, sep=" | ")
    if (arguments.number, arguments.seed) == (NUMBER, SEED):
        with STORED.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(Answer._fields)
            writer.writerows(answers)
    print(table(answers))
    return 0


if __name__ == "__main__":
    sys.exit(main())
