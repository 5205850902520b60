"""Bad input on the command line, and in the files that commands read."""

import contextlib
import json
import os
import random
import re
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

import laticauda as lc
from bad_inputs import odd, pantry, surface
from bad_inputs.attempt import PATIENCE, SERVING, Answer, Case, judge_command
from laticauda.robot.files import to_toml


@dataclass(frozen=True, kw_only=True)
class TypedWords:
    """Words on a command line, beside good files."""

    words: tuple[str, ...]
    names: tuple[str, ...] = ()
    """A refusal has to contain one of these."""
    files: tuple[tuple[str, str], ...] = ()
    """Files that are written before, with their texts."""
    pantry: Path | None = None
    """Folder of good files, which are copied if they are among the words."""
    patience: float = PATIENCE
    """Time after which Ctrl-C is pressed [s]."""

    def __call__(self) -> Answer:
        """Type them in the working directory."""
        if self.pantry is not None:
            pantry.lay_out(self.pantry, self.words)
        for name, text in self.files:
            Path(name).write_text(text, encoding="utf-8", errors="surrogateescape")
        return judge_command(*self.words, names=self.names, patience=self.patience)


# ---- options -------------------------------------------------------------------------------------

REFUSED_BY_ITS_PLACE = ("Unrecognized", "Missing", "Invalid", "unexpected")
"""What the reader of the command line says of words that belong to no option."""


def flags(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Odd words behind every option of every command, none at all, and lists in the place of one."""
    with contextlib.chdir(folder):
        targets = surface.find_options()
    targets = [target for target in targets if target.flag not in surface.LEFT_OUT_OPTIONS]
    for target in odd.draw_in_turn(rng, targets):
        extra = rng.choices(odd.WORDS, k=rng.choice((0, 1, 1, 1, 1, 1, 2, 3)))
        yield attack_option(target, extra, folder)


def attack_option(target: surface.OptionTarget, extra: list[str], folder: Path) -> Case:
    """Return the input in which these words are behind an option.

    Args:
        target: The option.
        extra: The words.
        folder: The folder of good files.
    """
    if target.flag.startswith("-"):
        words = (*target.run, target.flag, *extra)
    else:  # a file without a flag
        words = (*target.run, *extra)
    patience = SERVING if target.is_server else PATIENCE
    typed = [word for word in extra if word]
    names = (target.flag, *typed, "``", "--", *REFUSED_BY_ITS_PLACE)
    attack = TypedWords(words=words, names=names, pantry=folder, patience=patience)
    return Case("flags", " ".join(words), attack)


# ---- files ---------------------------------------------------------------------------------------

READERS = (
    ("swim", "--duration", "0.1", "--robot"),
    ("swim", "--duration", "0.1", "--water"),
    ("swim", "--duration", "0.1", "--ground"),
    ("swim", "--duration", "0.1", "--parameters"),
    ("swim", "--duration", "0.1", "--current"),
    ("swim", "--duration", "0.1", "--model", "spatial", "--scene"),
    ("swim", "--duration", "0.1", "--gait"),
    ("swim", "--duration", "0.1", "--joint-angles"),
    ("swim",),
    ("sweep", "--duration", "0.1", "--list"),
    ("operate", "--check"),
    ("identify",),
    ("identify", "--robot", "mamba", "--table"),
    ("predict",),
    ("design-experiment", "--after"),
    ("trial", "show"),
    ("trial", "show", "good.csv", "--columns"),
    ("trial", "compare"),
    ("view",),
    ("swim", "--duration", "0.1", "--resume"),
    ("replay",),
    ("export", "mjcf", "--output", "x.xml", "--robot"),
    ("export", "urdf", "--output", "x.urdf", "--robot"),
    ("export", "c", "--output", "x.h", "--robot"),
    ("export", "web", "--output", "page", "--robots"),
)
"""Commands that read a file, without its name."""
PATHS = (
    "/dev/zero",
    "/dev/null",
    "/dev/urandom",
    "/",
    ".",
    "\udcff.toml",
    "a" * 300,
    "s3://a/b.nc",
    "memory://b",
    "pipe.toml",
    "pipe.nc",
)


@dataclass(frozen=True, kw_only=True)
class OddPath:
    """A device, a pipe, a folder or an address in the place of a file."""

    words: tuple[str, ...]
    path: str

    def __call__(self) -> Answer:
        """Type it; a pipe gets a writer of rubbish, who does not wait for ever for a reader."""
        Path("good.csv").write_text("t,x\n0,1\n1,2\n")
        if self.path.startswith("pipe"):
            os.mkfifo(self.path)
            if os.fork() == 0:
                signal.signal(signal.SIGALRM, signal.SIG_DFL)
                signal.alarm(10)
                with contextlib.suppress(OSError), open(self.path, "wb") as pipe:
                    pipe.write(b"\x00a = [" * 1000)
                os._exit(0)
        names = (self.path, repr(self.path)[1:-1], self.path[:40], "--", "preset")
        return judge_command(*self.words, self.path, names=names)


def paths(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Devices, pipes, folders, addresses and names that are not UTF-8 in the place of a file."""
    while True:
        words, path = rng.choice(READERS), rng.choice(PATHS)
        yield Case("paths", " ".join([*words, path]), OddPath(words=words, path=path))


ODD_TEXTS = (
    "[" * 100_000,
    "a = 1\n" * 3 + "\x00",
    "\ufeffkind = 3",
    "kind = []",
    'kind = {a = "b"}',
    "kind = 1e400",
    "kind = " + "9" * 5000,
    "kind = 2020-01-01",
    "[[kind]]\na=1",
    "",
    "\n",
    "\r",
    "{}",
    "null",
)


def texts(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Nested and odd TOML and JSON in the place of a good text."""
    while True:
        words = rng.choice(READERS)
        text = rng.choice((_nested_text(rng), *ODD_TEXTS))
        name = "bad.toml"
        if "--list" in words or "--table" in words:
            name = "bad.csv"
        attack = TypedWords(
            words=(*words, name),
            names=(name, "--"),
            files=(("good.csv", "t,x\n0,1\n1,2\n"), (name, text)),
        )
        yield Case("texts", f"{' '.join(words)} {text[:40]!r}", attack)


def _nested_text(rng: random.Random) -> str:
    """Return a TOML text that is nested deeply."""
    depth = rng.choice((50, 2000, 100_000))
    forms = (
        "a = " + "[" * depth + "]" * depth,
        "a = " + "{b = " * depth + "1" + "}" * depth,
        "[" + "a." * depth + "b]",
    )
    return rng.choice(forms)


HEADS = (
    "amplitude-deg",
    "frequency-deg-s",
    "normal-drag",
    "n-links",
    "amplitude",
    "",
    "x",
    "water.density",
)


def lists(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Lists of points of a sweep with odd names and cells."""
    words = ("sweep", "--duration", "0.1", "--output", "out", "--list", "points.csv")
    while True:
        heads = rng.sample(HEADS, rng.choice((1, 2, 3)))
        lines = [",".join(heads)]
        for _ in range(rng.choice((0, 1, 3))):
            cells = [rng.choice((*odd.CELLS, "30", "30", "30")) for _ in heads]
            n_cells = rng.choice((len(cells), len(cells), 1))
            lines.append(",".join(cells[:n_cells]))
        text = "\n".join(lines)
        files = (("points.csv", text),)
        attack = TypedWords(words=words, names=("points.csv",), files=files)
        yield Case("lists", repr(text), attack)


# ---- tables with one thing changed ---------------------------------------------------------------


def change_one(rng: random.Random, table: dict[str, Any]) -> dict[str, Any]:
    """Return a table of tables in which one thing is odd, missing or too many.

    Args:
        rng: Source of the change.
        table: The table.
    """
    key = rng.choice(sorted(table))
    if isinstance(table[key], dict) and rng.random() < 0.8:
        return table | {key: change_one(rng, table[key])}
    change = rng.choice(("odd", "odd", "odd", "missing", "more"))
    if change == "missing":
        return {name: value for name, value in table.items() if name != key}
    if change == "more":
        key = rng.choice(("nonsense", "", "\x00"))
    return table | {key: rng.choice(odd.LEAVES)}


def columns(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Column maps in which something is odd, and logs with odd cells."""
    import tomllib

    good_map = tomllib.loads(pantry.COLUMN_MAP)
    words = ("trial", "show", "log.csv", "--columns", "map.toml", "--json")
    while True:
        table, rows = good_map, pantry.log_rows()
        n_odd_cells = rng.choice((1, 3))
        if rng.random() < 0.7:
            table = change_one(rng, good_map)
            n_odd_cells = rng.choice((0, 1, 3))
        for _ in range(n_odd_cells):
            row = rng.choice(rows)
            row[rng.randrange(len(row))] = rng.choice(odd.CELLS)
        files = (("log.csv", pantry.log_text(rows)), ("map.toml", tomli_w.dumps(table)))
        attack = TypedWords(words=words, names=("map.toml", "log.csv"), files=files)
        changed = {key: value for key, value in table.items() if value is not good_map.get(key)}
        cells = [cell for row in rows for cell in row if cell in odd.CELLS and cell != "0"]
        yield Case("columns", f"{changed} {cells}", attack)


def tasks(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Identification tasks in which something is odd, for the fit and for the design of experiments after it."""
    import tomllib

    good_task = tomllib.loads(pantry.TASK)
    identify = ("identify", "task.toml", "--quick", "--output", "out", "--json")
    design = ("design-experiment", "--after", "task.toml", "--json")
    while True:
        table = change_one(rng, good_task)
        if rng.random() < 0.3:
            parameter = change_one(rng, good_task["parameters"][0])
            table = good_task | {"parameters": [parameter]}
        words = rng.choice((identify, design))
        files = (("task.toml", tomli_w.dumps(table)),)
        attack = TypedWords(words=words, names=("task.toml",), files=files)
        changed = {key: value for key, value in table.items() if value is not good_task.get(key)}
        yield Case("tasks", f"{words[0]} {changed}", attack)


# ---- robots --------------------------------------------------------------------------------------

EXPORTS = (
    "export mjcf --output x.xml --robot bad.toml",
    "export urdf --output x.urdf --robot bad.toml",
    "export fmu --output x.fmu --robot bad.toml",
    "export c --output x.h --robot bad.toml",
    "export web --output page --robots bad.toml",
)
NAMES = (
    "",
    "a b",
    'a"b',
    "a*/b",
    "</script>",
    "\u202e",
    "x" * 3000,
    "../x",
    "int",
    "1",
    "%s%n",
    "a\\nb",
    "${x}",
)


def exports(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Robots with odd names and descriptions, written for other programs."""
    plain_texts = [to_toml(lc.load_robot(name)) for name in pantry.ROBOTS]
    while True:
        line, name, key = (
            rng.choice(EXPORTS),
            rng.choice(NAMES),
            rng.choice(("name", "description")),
        )
        odd_line = f"{key} = {json.dumps(name)}".replace("\\", r"\\")
        text = re.sub(rf"(?m)^{key} = .*$", odd_line, rng.choice(plain_texts))
        files = (("bad.toml", text),)
        attack = TypedWords(words=tuple(line.split()), names=("bad.toml",), files=files)
        yield Case("exports", f"{line} {key} {name[:40]!r}", attack)


def robots(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Robots and waters with numbers of any size: what is accepted comes to finite figures, or says it diverged."""
    robot_texts = [to_toml(lc.load_robot(name)) for name in pantry.ROBOTS]
    water_texts = [to_toml(lc.load_water("paper-lateral"))]
    names = ("bad.toml", "--", "environment", "joint")
    while True:
        flag, good_texts = "--robot", robot_texts
        if rng.random() < 0.2:
            flag, good_texts = "--water", water_texts
        good_text = rng.choice(good_texts)
        text = _with_odd_numbers(rng, good_text)
        words = ("swim", "--duration", "12", "--json", flag, "bad.toml")
        attack = TypedWords(words=words, names=names, files=(("bad.toml", text),))
        changed = [line for line in text.splitlines() if line not in good_text.splitlines()]
        yield Case("robots", "; ".join(changed), attack)


def _with_odd_numbers(rng: random.Random, text: str) -> str:
    """Return a TOML text in which some numbers are of any size."""
    numbers = list(re.finditer(r"(?m)^(\w+) = (-?[\d.e+-]+)$", text))
    n_changed = min(len(numbers), rng.choice((1, 1, 2, 4)))
    changed = rng.sample(numbers, n_changed)
    for found in sorted(changed, key=lambda match: -match.start()):  # from the end, as places move
        number = float(found[2]) * 10.0 ** rng.uniform(-9.0, 9.0)
        if rng.random() < 0.4:
            number = rng.choice((1.0, 1.0, -1.0)) * 10.0 ** rng.uniform(-320.0, 308.0)
        text = f"{text[: found.start()]}{found[1]} = {number!r}{text[found.end() :]}"
    return text
