"""Does any bad input end in a traceback, a figure that is not finite, a message that names nothing, or a full memory?

Property style: a seed draws inputs of each kind, and each is tried in a child process of its own
with 6 GB more than its parent and 60 s of a core. What is refused has to be refused in one sentence
that names the place; what is accepted has to come to finite figures, or to a run that says that it
diverged; and no warning of numpy may reach the shell.

    python campaigns/bad_input.py [--seed N] [--count N] [--only KIND ...]

Last answer (seed 11): flags, paths, texts, lists, columns and tasks 0 faults of 100 each; seed 7:
exports 0 of 8, and folders 0 of 8. What they found before is in the changelog. Calls of seeds 11
and 21 (cut off) found `Grid`, `Resumed`, `check_waves`, `from_frame` and functions of `compiling`,
as `for_python(range)`, which are mended.
"""

import argparse
import contextlib
import dataclasses
import importlib
import inspect
import io
import json
import math
import os
import pickle
import pkgutil
import random
import re
import resource
import shutil
import signal
import tempfile
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.cli.app import COMMANDS, main
from laticauda.values.errors import LaticaudaError

GIGABYTES, SECONDS = 6, 60
ROBOTS = ("mamba", "mamba-fin", "mamba-thruster")
HUGE = 10**9
PACKAGES = tuple(
    one.name for one in pkgutil.iter_modules(lc.__path__) if one.ispkg and one.name != "cli"
)
MODULES = ("robot.hydrodynamics", "robot.kinematics", "scenarios.interfaces")
"""Modules that users import as they are."""


class Case(NamedTuple):
    """One bad input."""

    kind: str
    shown: str
    work: Callable[[], str]
    """Tries it in a folder of its own, and returns what is wrong with what came; "" for nothing."""


# ---- what happens to a case ----------------------------------------------------------------------


def tried(case: Case) -> str:
    """What is wrong with what came of a case, "" for nothing."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        most = taken + (GIGABYTES << 30)
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        signal.alarm(10 * SECONDS)  # also where it waits for something
        folder = tempfile.mkdtemp()
        os.chdir(folder)
        try:
            found = case.work()
        except BaseException as error:
            found = f"{type(error).__name__}: {error} at {traceback.extract_tb(error.__traceback__)[-1]}"
        shutil.rmtree(folder, ignore_errors=True)
        os.write(writing, pickle.dumps(found[:2000]))
        os._exit(0)
    os.close(writing)
    with open(reading, "rb") as pipe:
        content = pipe.read()
    _, status = os.waitpid(child, 0)
    return pickle.loads(content) if content else f"killed by {os.waitstatus_to_exitcode(status)}"


def shell(*words: str, names: tuple[str, ...] = ()) -> Callable[[], str]:
    """Run a command; if it refuses, its message has one of the names in it."""

    def work() -> str:
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = main(words)
        said = " ".join(err.getvalue().split())
        if "Traceback" in said or "Warning:" in said:
            return f"{status}: {said[-300:]}"
        if status not in (0, 1, 2):
            return f"exit status {status}: {said[-300:]}"
        plain = re.sub(r"[│╭╮╰╯─\s]", "", said)
        if status == 2 and names and not any(re.sub(r"\s", "", name) in plain for name in names):
            return f"names nothing: {said[-300:]}"
        if status != 2 and "--json" in words:
            json.loads(out.getvalue(), parse_constant=_refuse)
        return ""

    return work


def _refuse(word: str) -> None:
    raise ArithmeticError(f"{word} in what is printed")


def call(function: Callable[..., Any], given: dict[str, Any], name: str) -> Callable[[], str]:
    """Call something with one bad argument: it works, or a ValueError or one of our own errors says which."""

    def work() -> str:
        with (
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(io.StringIO()) as err,
        ):
            try:
                function(**given)
            except (ValueError, LaticaudaError) as error:
                return "" if str(error).strip() else f"{type(error).__name__} says nothing"
            except TypeError as error:
                if not re.search(
                    r"missing \d+ required|unexpected keyword|also needs `", str(error)
                ):  # said well by Python
                    raise
        return "" if "Warning:" not in err.getvalue() else err.getvalue()[-300:]

    return work


# ---- kinds of bad input --------------------------------------------------------------------------

WORDS = (
    "-1",
    "nan",
    "inf",
    "1e400",
    "x",
    "",
    "1,2",
    "[1]",
    "9" * 400,
    "-0",
    "1e308",
    "1e-308",
    "none",
    "\udcff",
    "\u202e",
)
FLAGS = [
    f"--{part}-{one}"
    for part in ("fin", "pitch")
    for one in ("amplitude-deg", "offset-deg", "phase-deg", "frequency-deg-s")
]
TYPED = (
    ("swim", "--duration", "0.1", "--robot", "mamba-fin"),
    ("follow", "--duration", "0.1", "--path", "0", "0", "1", "0"),
    ("sweep", "--duration", "0.1", "--vary", "amplitude-deg=10,20"),
    ("optimize", "--duration", "0.1", "--budget", "1"),
    ("export", "fmu", "--output", "x.fmu"),
    ("cockpit", "--port", "-1"),
)  # fmt: skip
NUMBERS = (
    *(
        "duration",
        "sample-interval",
        "dt",
        "density",
        "normal-drag",
        "added-mass",
        "depth",
        "current",
        "n-links",
    ),
    *("heading-deg", "amplitude-deg"),
)


def flags(rng: random.Random) -> Iterator[Case]:
    """Wrong fin and pitch flags, absurd numbers, and lists in the place of one."""
    while True:
        command, word = rng.choice(TYPED), rng.choice(WORDS)
        flag = rng.choice([*FLAGS, *(f"--{name}" for name in NUMBERS)])
        extra = [word, *rng.choices(WORDS, k=rng.choice((0, 0, 1, 3)))]
        names = (flag, "Unrecognized", "Missing", "--", word or "--")
        yield Case(
            "flags", " ".join([*command, flag, *extra]), shell(*command, flag, *extra, names=names)
        )


def _nested(rng: random.Random) -> str:
    depth = rng.choice((50, 2000, 100_000))
    return rng.choice(
        (
            "a = " + "[" * depth + "]" * depth,
            "a = " + "{b = " * depth + "1" + "}" * depth,
            "[" + "a." * depth + "b]",
        )
    )


FILES = (
    ("swim", "--duration", "0.1", "--robot"),
    ("swim", "--duration", "0.1", "--water"),
    ("swim", "--duration", "0.1", "--ground"),
    ("swim", "--duration", "0.1", "--parameters"),
    ("swim", "--duration", "0.1", "--current"),
    ("swim", "--duration", "0.1", "--model", "spatial", "--scene"),
    ("swim", "--duration", "0.1", "--gait"),
    ("swim",),
    ("sweep", "--duration", "0.1", "--list"),
    ("operate", "--check"),
    ("identify",),
    ("design-experiment", "--after"),
    ("trial", "show"),
    ("trial", "show", "good.csv", "--columns"),
    ("swim", "--duration", "0.1", "--resume"),
    ("replay",),
    ("export", "mjcf", "--output", "x.xml", "--robot"),
    ("export", "urdf", "--output", "x.urdf", "--robot"),
    ("export", "c", "--output", "x.h", "--robot"),
    ("export", "web", "--output", "page", "--robots"),
)


PATHS = (
    *(
        "/dev/zero",
        "/dev/null",
        "/dev/urandom",
        "/",
        ".",
        "\udcff.toml",
        "a" * 300,
        "s3://a/b.nc",
        "memory://b",
    ),
    *("pipe.toml", "pipe.nc"),
)


def paths(rng: random.Random) -> Iterator[Case]:
    """Devices, pipes, folders, addresses and names that are not UTF-8 in the place of a file."""
    while True:
        words = rng.choice(FILES)
        path = rng.choice(PATHS)

        def work(words: tuple[str, ...] = words, path: str = path) -> str:
            Path("good.csv").write_text("t,x\n0,1\n1,2\n")
            if path.startswith("pipe"):
                os.mkfifo(path)
                if (
                    os.fork() == 0
                ):  # a writer of rubbish, who does not wait for ever for one who reads it
                    signal.alarm(10)
                    with contextlib.suppress(OSError), open(path, "wb") as pipe:
                        pipe.write(b"\x00a = [" * 1000)
                    os._exit(0)
            names = (path, repr(path)[1:-1], path[:40], "--", "preset")
            return shell(*words, path, names=names)()

        yield Case("paths", " ".join([*words, path]), work)


def texts(rng: random.Random) -> Iterator[Case]:
    """Nested and odd TOML and JSON in the place of a good text."""
    odd = (
        "[" * 100_000,
        "a = 1\n" * 3 + "\x00",
        "\ufeffkind = 3",
        "kind = []",
        'kind = {a = "b"}',
        "kind = 1e400",
        "kind = " + "9" * 5000,
        "kind = 2020-01-01",
        "[[kind]]\na=1",
    )
    while True:
        words, text = rng.choice(FILES), rng.choice((_nested(rng), *odd))
        ending = ".csv" if "--list" in words else ".toml"

        def work(
            words: tuple[str, ...] = words, text: str = text, name: str = f"bad{ending}"
        ) -> str:
            Path("good.csv").write_text("t,x\n0,1\n1,2\n")
            Path(name).write_text(text, encoding="utf-8", errors="surrogateescape")
            return shell(*words, name, names=(name, "--"))()

        yield Case("texts", f"{' '.join(words)} {text[:40]!r}", work)


def _damaged(rng: random.Random, content: bytes) -> bytes:
    data = bytearray(content)
    how = rng.choice(("cut", "flip", "flip", "fill", "grow", "empty"))
    if how == "cut":
        del data[rng.randrange(len(data)) :]
    elif how == "flip":
        for _ in range(rng.choice((1, 8, 200))):
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    elif how == "fill":
        begin = rng.randrange(len(data))
        data[begin : begin + 64] = bytes([rng.choice((0, 255))]) * 64
    return b"" if how == "empty" else bytes(data) + (b"\xff" * 1000 if how == "grow" else b"")


def _prepared(folder: Path) -> dict[str, tuple[bytes, tuple[str, ...]]]:
    """Good files that programs wrote, and the commands that read them."""
    import xarray

    where = {name: (name, np.linspace(-5.0, 5.0, 4)) for name in ("y", "x")} | {
        "time": ("time", np.array([0.0, 9.0]))
    }
    still = {name: (("time", "y", "x"), np.zeros((2, 4, 4)), {"units": "m/s"}) for name in "uv"}
    xarray.Dataset(still, coords=where).to_netcdf(str(folder / "flow.nc"))  # pyright: ignore[reportUnknownMemberType]
    trial = lc.swim(
        "mamba", lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7), 0.5
    )
    found: dict[str, tuple[bytes, tuple[str, ...]]] = {}
    for ending in ("nc", "mcap", "parquet", "mat"):
        with contextlib.suppress(LaticaudaError):
            trial.save(folder / f"trial.{ending}")
            found[f"trial.{ending}"] = (folder / f"trial.{ending}").read_bytes(), ("trial", "show")
    found["flow.nc"] = (folder / "flow.nc").read_bytes(), ("swim", "--duration", "0.1", "--current")
    box = b'<mujoco><worldbody><geom name="b" type="box" size=".1 .1 .1" pos="3 0 0"/></worldbody></mujoco>'
    found["scene.xml"] = box, ("swim", "--duration", "0.05", "--model", "spatial", "--scene")
    return found


def damaged(rng: random.Random) -> Iterator[Case]:
    """Damaged trials, flows on a grid and MJCF files."""
    with tempfile.TemporaryDirectory() as folder:
        good = _prepared(Path(folder))
    while True:
        name = rng.choice(sorted(good))
        content, words = good[name]
        bad = _damaged(rng, content)

        def work(name: str = name, bad: bytes = bad, words: tuple[str, ...] = words) -> str:
            Path(name).write_bytes(bad)
            return shell(*words, name, names=(name, "--"))()

        yield Case("damaged", f"{' '.join(words)} {name}, {len(bad)} bytes", work)


SWEEP = ("sweep", "--duration", "0.1", "--vary", "amplitude-deg=10,20", "--output", "out")
OPTIMIZE = (
    "optimize",
    "--duration",
    "0.5",
    "--vary",
    "amplitude-deg=10:20",
    "--budget",
    "4",
    "--population",
    "4",
    "--output",
    "out",
)


def _odd_zip(rng: random.Random, content: bytes) -> bytes:
    """A zip whose entries say that they are encrypted, or of a method or a version that nobody has."""
    data, (at, number) = bytearray(content), rng.choice(((6, 1), (8, 99), (4, 99)))
    for mark, further in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        begin = data.find(mark)
        while begin >= 0:
            data[begin + at + further] = number
            begin = data.find(mark, begin + 1)
    return bytes(data)


def folders(rng: random.Random) -> Iterator[Case]:
    """Damaged folders of sweeps and optimizations, whose zip may be encrypted or of an odd method."""
    while True:
        words, how, seed = (
            rng.choice((SWEEP, OPTIMIZE)),
            rng.choice(("bytes", "zip", "text")),
            rng.random(),
        )

        def work(words: tuple[str, ...] = words, how: str = how, seed: float = seed) -> str:
            shell(*words)()
            inner = random.Random(seed)
            files = sorted(path for path in Path("out").rglob("*") if path.is_file())
            if not files:
                return "no files"
            bad = inner.choice(
                [path for path in files if path.suffix in (".json", ".npz", ".done")]
            )
            if how == "text" and bad.suffix == ".json":
                bad.write_text(
                    inner.choice(
                        (
                            "[" * 100_000,
                            "{}",
                            "[]",
                            '{"shape": 3, "region": {}}',
                            "nan",
                            '{"shape": [-1], "region": [0]}',
                        )
                    )
                )
            elif how == "zip" and bad.suffix == ".npz":
                bad.write_bytes(_odd_zip(inner, bad.read_bytes()))
            else:
                bad.write_bytes(_damaged(inner, bad.read_bytes()))
            return shell(*words, names=("out", "--output", "folder"))()

        yield Case("folders", f"{words[0]}, {how}, {seed}", work)


ODD: tuple[Callable[[], Any], ...] = (
    lambda: None,
    lambda: 3,
    lambda: -1.5,
    lambda: math.nan,
    lambda: math.inf,
    lambda: 2**70,
    lambda: "x",
    lambda: b"x",
    lambda: (),
    lambda: (0, 1),
    lambda: [1.0, [2.0]],
    lambda: {},
    lambda: {"x": 1},
    object,
    lambda: np.zeros(3),
    lambda: np.array(2.0),
    lambda: np.zeros((2, 2), dtype=complex),
    lambda: np.array(["a"]),
    lambda: iter([1]),
    lambda: range(HUGE),
    lambda: True,
    lambda: int,
    lambda: Path("/nowhere"),
)


def public() -> list[tuple[str, Callable[..., Any]]]:
    """Every public function and class of all packages, and of the modules beside them."""
    found: dict[int, tuple[str, Callable[..., Any]]] = {}
    for package in ("", *PACKAGES, *MODULES):
        module = importlib.import_module(f"laticauda.{package}".rstrip("."))
        told: list[str] | None = getattr(module, "__all__", None)
        whose = (
            "laticauda" if told else module.__name__
        )  # without a list, what it imports for itself is not its own
        for name in told or dir(module):
            thing: Any = getattr(module, name, None)
            own = callable(thing) and getattr(thing, "__module__", "").startswith(whose)
            is_class = inspect.isclass(thing)
            own = own and not (
                is_class and (issubclass(thing, Exception) or getattr(thing, "_is_protocol", False))
            )
            if own and not name.startswith("_") and thing is not lc.Plant:
                found.setdefault(id(thing), (f"{module.__name__}.{name}", thing))
    return sorted(found.values(), key=lambda one: one[0])


def good_arguments() -> dict[str, Any]:
    """What fits an argument of a name, where that is clear."""
    robot, gait = (
        lc.load_robot("mamba"),
        lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7),
    )
    trial = lc.swim(robot, gait, 0.5)
    scenario = trial.scenario
    body, command = lc.build_plant(scenario), lc.Command(gait=gait)
    return {
        **{
            "robot": robot,
            "gait": gait,
            "motion": gait,
            "trial": trial,
            "scenario": scenario,
            "start": lc.Start(),
        },
        **{
            "environment": scenario.environment,
            "water": scenario.environment,
            "plant": body,
            "body": body,
        },
        **{
            "robots": [robot],
            "gaits": [gait],
            "scenarios": [scenario],
            "trials": [trial, trial],
            "name": "mamba",
        },
        **{
            "first": trial,
            "second": trial,
            "controller": lc.OpenLoop(command=command),
            "command": command,
        },
        **{
            "duration": 0.1,
            "sample_interval": 0.05,
            "dt": 0.05,
            "amplitude": 0.5,
            "frequency": 2.3,
        },
        **{"phase_shift": 0.7, "time": trial.time, "center_of_mass": trial.center_of_mass},
    }


BLOCKING = re.compile(r"serve|run_lab|operate|Server|Cockpit|show|connected|export_|film|reproduce")


def calls(rng: random.Random) -> Iterator[Case]:
    """Wrong types in every public function and class, the other arguments as they should be where that is known."""
    known, names = good_arguments(), public()
    while True:
        name, function = rng.choice(names)
        if BLOCKING.search(name):
            continue
        try:
            signature = inspect.signature(function)
        except (TypeError, ValueError):
            continue
        plain = [
            p
            for p in signature.parameters.values()
            if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)
        ]
        plain = [p for p in plain if p.name != "self"]
        if not plain:
            continue
        bad, odd = rng.choice(plain), rng.choice(ODD)
        given = {p.name: known.get(p.name) for p in plain if p.default is p.empty}
        if any(p.default is p.empty and p.name not in known and p is not bad for p in plain):
            continue  # no good value of another is known: what is refused may be that one
        yield Case(
            "calls",
            f"{name}({bad.name}={odd()!r:.60})",
            call(function, {**given, bad.name: odd()}, bad.name),
        )


CELLS = (
    "nan",
    "inf",
    "",
    "x",
    "1e400",
    "1e308",
    "-1",
    "0",
    "9" * 400,
    '"',
    "1,5",
    "\u202e",
    "0x1",
    "30 deg",
)
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


def lists(rng: random.Random) -> Iterator[Case]:
    """Lists of points of a sweep with odd names and cells."""
    while True:
        heads = rng.sample(HEADS, rng.choice((1, 2, 3)))
        rows = [
            [rng.choice((*CELLS, "30", "30", "30")) for _ in heads]
            for _ in range(rng.choice((0, 1, 3)))
        ]
        text = "\n".join(
            ",".join(row[: rng.choice((len(row), len(row), 1))]) for row in (heads, *rows)
        )
        words = ("sweep", "--duration", "0.1", "--output", "out", "--list", "points.csv")

        def work(text: str = text, words: tuple[str, ...] = words) -> str:
            Path("points.csv").write_text(text, encoding="utf-8")
            return shell(*words, names=("points.csv",))()

        yield Case("lists", repr(text), work)


MAP: dict[str, Any] = {
    "kind": "columns",
    "robot": "mamba",
    "longest_gap": 0.2,
    "gait": {
        "kind": "lateral-undulation",
        "amplitude_deg": 30.0,
        "frequency_deg_s": 130.0,
        "phase_shift_deg": 40.0,
    },
    "time": {"column": "t", "unit": "s"},
    "frame": {"x": "x", "y": "y", "origin": [0.0, 0.0], "rotation_deg": 0.0},
    "body": {
        "link": 0,
        "position": ["x", "y"],
        "length_unit": "m",
        "yaw": "yaw",
        "angle_unit": "rad",
    },
    "joint_angle": {"columns": "phi {}", "unit": "rad"},
    "power": {"current": "I", "voltage": 35.0, "idle": 41.3},
}
LEAVES: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -1,
    0,
    1e308,
    1e-308,
    10**30,
    "",
    "x",
    "\x00",
    True,
    [],
    {},
    [[1]],
    ["a"],
    {"a": 1},
    "{",
)


def _one_changed(rng: random.Random, table: dict[str, Any]) -> dict[str, Any]:
    """A table of tables in which one thing is odd, missing or too many."""
    key = rng.choice(sorted(table))
    if isinstance(table[key], dict) and rng.random() < 0.8:
        return table | {key: _one_changed(rng, table[key])}
    how = rng.choice(("odd", "odd", "odd", "missing", "more"))
    if how == "missing":
        return {name: one for name, one in table.items() if name != key}
    return table | {
        key if how == "odd" else rng.choice(("nonsense", "", "\x00")): rng.choice(LEAVES)
    }


def columns(rng: random.Random) -> Iterator[Case]:
    """Column maps in which something is odd, and logs with odd cells."""
    import tomli_w

    names = ["t", "x", "y", "yaw", *(f"phi {i}" for i in range(8)), "I"]
    while True:
        table = _one_changed(rng, MAP) if rng.random() < 0.7 else MAP
        rows = [[f"{0.05 * k:.2f}", "0", "0", "0", *["0.1"] * 8, "1.5"] for k in range(40)]
        for _ in range(rng.choice((0, 1, 3)) if table is not MAP else 1):
            rows[rng.randrange(40)][rng.randrange(len(names))] = rng.choice(CELLS)
        text = "\n".join(map(",".join, (names, *rows)))

        def work(table: dict[str, Any] = table, text: str = text) -> str:
            Path("log.csv").write_text(text, encoding="utf-8")
            Path("map.toml").write_text(tomli_w.dumps(table), encoding="utf-8")
            words = ("trial", "show", "log.csv", "--columns", "map.toml", "--json")
            return shell(*words, names=("map.toml", "log.csv"))()

        odd = {key: one for key, one in table.items() if one is not MAP.get(key)}
        yield Case("columns", f"{odd} {[one for row in rows for one in row if one in CELLS]}", work)


TASK: dict[str, Any] = {
    "kind": "identification",
    "name": "x",
    "title": "t",
    "joints": "prescribed",
    "noise": "estimated",
    "starts": 1,
    "seed": 1,
    "parameters": [
        {"name": "water.tangential_friction", "start": 0.15, "lower": 0.03, "upper": 0.5}
    ],
    "table1": {"sigma": 0.05, "selected_from": 1},
    "fixed": {
        "water": {"normal_drag": 1.75, "added_mass": 1.5},
        "caudal_fin": {"normal_drag": 2.0},
    },
}


def tasks(rng: random.Random) -> Iterator[Case]:
    """Identification tasks in which something is odd, for the fit and for the design of experiments after it."""
    import tomli_w

    while True:
        table = _one_changed(rng, TASK)
        if rng.random() < 0.3:
            table = TASK | {"parameters": [_one_changed(rng, TASK["parameters"][0])]}
        words = rng.choice((("identify",), ("design-experiment", "--after")))

        def work(table: dict[str, Any] = table, words: tuple[str, ...] = words) -> str:
            Path("task.toml").write_text(tomli_w.dumps(table), encoding="utf-8")
            more = ("--quick", "--output", "out") if words == ("identify",) else ()
            return shell(*words, "task.toml", *more, "--json", names=("task.toml",))()

        odd = {key: one for key, one in table.items() if one is not TASK.get(key)}
        yield Case("tasks", f"{' '.join(words)} {odd}", work)


EXPORTS = tuple(
    f"export {kind} --output {name}"
    for kind, name in {
        "mjcf": "x.xml",
        "urdf": "x.urdf",
        "fmu": "x.fmu",
        "c": "x.h",
        "web": "page",
    }.items()
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


def exports(rng: random.Random) -> Iterator[Case]:
    """Robots with odd names and descriptions, written for other programs."""
    from laticauda.robot.files import to_toml

    plain = {name: to_toml(lc.load_robot(name)) for name in ROBOTS}
    while True:
        words, name, key = (
            rng.choice(EXPORTS).split(),
            rng.choice(NAMES),
            rng.choice(("name", "description")),
        )
        text = re.sub(
            rf"(?m)^{key} = .*$",
            lambda _, key=key, name=name: f"{key} = {json.dumps(name)}",
            plain[rng.choice(ROBOTS)],
        )

        def work(text: str = text, words: tuple[str, ...] = tuple(words)) -> str:
            Path("bad.toml").write_text(text, encoding="utf-8")
            return shell(
                *words, "--robots" if "web" in words else "--robot", "bad.toml", names=("bad.toml",)
            )()

        yield Case("exports", f"{' '.join(words)} {key} {name[:40]!r}", work)


def values(rng: random.Random) -> Iterator[Case]:
    """Numbers at the ends of what a declared quantity may be, and beyond; a file keeps what is accepted."""
    from laticauda.values import codec
    from laticauda.values.quantities import hints_of, quantities_of

    classes = [one for _, one in public() if inspect.isclass(one) and dataclasses.is_dataclass(one)]
    kinds = [one for one in classes if quantities_of(one)]
    while True:
        kind = rng.choice(kinds)
        name, declared = rng.choice(sorted(quantities_of(kind).items()))
        end = rng.choice((*declared.ends, declared.least if math.isfinite(declared.least) else 0.0))
        beside = math.nextafter(end, math.inf), math.nextafter(end, -math.inf)
        number: Any = rng.choice((end, *beside, 1e308, 5e-324, -end))
        number = rng.choice(
            (
                number,
                number,
                math.nan,
                math.inf,
                10**400,
                int(end),
                f"{end}",
                [end],
                np.float32(end),
            )
        )

        def work(kind: Any = kind, name: str = name, number: Any = number) -> str:
            try:
                made = kind(**{name: number})
            except (ValueError, LaticaudaError) as error:
                return "" if str(error).strip() else "refused without a word"
            except TypeError as error:
                is_named = re.search(r"missing|also needs `", str(error))  # by Python, or by us
                return "" if is_named else repr(error)
            there = (
                codec.decode(kind, json.loads(json.dumps(codec.encode(made, kind))))
                if hints_of(kind)
                else made
            )
            return "" if there == made else f"a file gives {there}"

        yield Case("values", f"{kind.__name__}({name}={number!r:.40})", work)


def robots(rng: random.Random) -> Iterator[Case]:
    """Robots and waters with numbers of any size: what is accepted comes to finite figures, or says it diverged."""
    from laticauda.robot.files import to_toml

    plain = [to_toml(lc.load_robot(name)) for name in ROBOTS]
    waters = [to_toml(lc.load_water("paper-lateral"))]
    while True:
        is_robot = rng.random() < 0.8
        text = rng.choice(plain if is_robot else waters)
        places = list(re.finditer(r"(?m)^(\w+) = (-?[\d.e+-]+)$", text))
        for place in sorted(
            rng.sample(places, min(len(places), rng.choice((1, 1, 2, 4)))),
            key=lambda one: -one.start(),
        ):
            number = (
                rng.choice((1.0, 1.0, -1.0)) * 10.0 ** rng.uniform(-320.0, 308.0)
                if rng.random() < 0.4
                else float(place[2]) * 10.0 ** rng.uniform(-9.0, 9.0)
            )
            text = f"{text[: place.start()]}{place[1]} = {number!r}{text[place.end() :]}"
        flag = "--robot" if is_robot else "--water"

        def work(text: str = text, flag: str = flag) -> str:
            Path("bad.toml").write_text(text)
            return shell(
                "swim",
                "--duration",
                "12",
                "--json",
                flag,
                "bad.toml",
                names=("bad.toml", "--", "environment", "joint"),
            )()

        yield Case(
            "robots",
            "; ".join(set(text.splitlines()) - set("".join((*plain, *waters)).splitlines())),
            work,
        )


CALLED = (calls, values)
KINDS = {
    one.__name__: one
    for one in (
        *CALLED,
        flags,
        paths,
        texts,
        lists,
        columns,
        tasks,
        exports,
        damaged,
        folders,
        robots,
    )
}


def faults(
    seed: int, count: int, kinds: tuple[str, ...] = tuple(KINDS)
) -> Iterator[tuple[Case, str]]:
    """The cases at fault, and what is wrong, as they are found.

    Args:
        seed: Of everything random.
        count: Cases of each kind.
        kinds: Which of `KINDS`.
    """
    for module, _ in COMMANDS.values():  # what every child would import
        importlib.import_module(f".{module.split(':')[0]}", "laticauda.cli")
    for robot in ROBOTS:
        lc.swim(robot, lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7), 0.1)
    for kind in kinds:
        cases = KINDS[kind](random.Random(f"{kind} {seed}"))
        for case, _ in zip(cases, range(count), strict=False):
            if wrong := tried(case):
                yield case, wrong


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, nargs="+", default=[0, 1, 2, 3, 4])
    parser.add_argument("--count", type=int, default=150)
    parser.add_argument("--only", nargs="+", default=list(KINDS), choices=list(KINDS))
    args = parser.parse_args()
    total = 0
    for seed in args.seed:
        n = 0
        for case, wrong in faults(seed, args.count, tuple(args.only)):
            n += 1
            print(f"[{case.kind}] {case.shown[:200]!r}\n    {wrong[-400:]}", flush=True)
        print(f"seed {seed}: {n} faults in {args.count * len(args.only)} inputs", flush=True)
        total += n
    raise SystemExit(1 if total else 0)
