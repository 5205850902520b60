"""Does a test notice when a line of the safety code, or of state estimation, says something else?

Question: of all small faults (mutants: see _mutations.py) that can be made in the safety code of
`operate` and in `estimation`, which share do the tests next to them notice? At least 85 % is asked
for.

    python campaigns/mutants.py                          # all that is not known yet; goes on where it was stopped
    python campaigns/mutants.py --only estimation        # files whose paths hold one of these
    python campaigns/mutants.py --sample 300 --seed 2    # so many by chance, with the interval of the share
    python campaigns/mutants.py --again                  # once more those that lived: after new tests
    python campaigns/mutants.py --show                   # those that live, as a list of lines

A process imports everything, collects the tests and waits; each mutant is a fork of it in which one
function's code is another, so that a mutant costs its tests and no start (some 0.1 to 1 s). What
runs when a file is imported gets a fork from before the import. The quickest tests come first, and
the first that fails ends it; what takes longer than three times the sound code counts as noticed,
for tests that hang are. Nothing here is compiled: what Numba compiles lies in other packages, and
its tests compare results to the last digits.

mutants.csv has the last answer, file by file, and mutants_alive.csv the mutants that live:
`equivalent` with the reason for which no test can tell them from the code (they are read from there
and stay), `alive` without. The progress lies in build/mutants.jsonl. The tests run a slice, and ask
whether every mutant that is called equivalent still exists.

Last answer (2 shared cores, 2026-11-29; an hour, after all these files had been rewritten):
supervisor and limits 241 of 244; estimation 1429 of 1471 (97.1 %), its twin that learns (learning,
learning_state, stretches) 505 of 591 (85.4 %). Of the verdict a sample of 302 by chance, of which 260
are noticed (86 %; 83 % of the last 130, which hold at least ten that no test can tell from the code,
such as other lines through the same plane). None of those that live is called equivalent yet.
"""

import argparse
import contextlib
import csv
import gc
import hashlib
import importlib.machinery
import json
import math
import multiprocessing
import os
import random
import signal
import sys
import tempfile
import time
import traceback
import types
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from _mutations import Mutant, mutants_of

from laticauda.missions.campaign import wilson_interval

ROOT = Path(__file__).parents[1]
STORED = Path(__file__).with_suffix(".csv")
ALIVE = Path(__file__).with_name("mutants_alive.csv")
PROGRESS = ROOT / "build" / "mutants.jsonl"
ENOUGH = 0.85
"""Share of mutants that the tests are to notice."""
PATIENCE = 3.0
"""How many times as long as sound code a mutant may take."""
AT_LEAST = 10.0
"""Time that it may take in any case, of this process's own [s]."""
IMPORTING = 20.0
"""Time that it may take until the tests begin [s]."""
SLOWLY = 6.0
"""A computer that is busy does as much in so many times the time."""
BEFORE = (
    "numpy",
    "numba",
    "scipy.optimize",
    "xarray",
    "matplotlib.pyplot",
    "hypothesis",
    "beartype",
    "jaxtyping",
)
"""What is imported once and for all."""


@dataclass(frozen=True, kw_only=True)
class Target:
    """Files, and the tests that are to notice what is wrong in them."""

    files: tuple[str, ...]
    tests: tuple[str, ...]
    left_out: tuple[str, ...] = ()
    """Tests whose name holds one of these are too slow to be asked two thousand times; `--thorough` asks them, too."""
    warm: Callable[[Any], object] = lambda module: None
    """What has kernels loaded and runs swum, without a line of the files; it gets the first module of the tests."""


def _swim(module: Any) -> None:
    lc = import_module("laticauda")
    robot, water = lc.load_robot("mamba"), lc.load_water("paper-lateral")
    lc.swim(
        robot, lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7), duration=0.1
    )
    plant = lc.build_plant(robot, water, joints="servo")
    gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    lc.run(plant, lc.OpenLoop(command=lc.Command(gait=gait)), 0.1)
    getattr(module, "swum", lambda: None)()


def _estimation(*names: str) -> tuple[str, ...]:
    return tuple(f"src/laticauda/control/estimation/{name}.py" for name in names)


def _verdict(*names: str) -> tuple[str, ...]:
    return tuple(f"src/laticauda/tank/operate/verdict/{name}.py" for name in names)


TARGETS = (
    Target(
        files=(
            "src/laticauda/tank/operate/safety/limits.py",
            "src/laticauda/tank/operate/safety/supervisor.py",
        ),
        tests=("tests/tank/operate/safety",),
    ),
    Target(
        files=_verdict(
            *("cameras", "check", "completeness", "joints", "model_run", "motion"),
            *("preparation", "recorded_run", "signals", "verdict"),
        ),
        tests=("tests/tank/operate/test_verdict.py",),
        warm=_swim,
    ),
    Target(
        files=_estimation(
            *("samples", "filter_state", "kinematics", "digital_twin"),
            *("state_vector", "motion_model", "filter"),
        ),
        tests=("tests/control/estimation",),
        left_out=(
            "test_estimator_campaign",
            "turning_tells_a_current",
            "it_knows_how_far_off_it_is",
            "in_its_own_axes_does_not_depend_on_where_it_is",
            "knows_the_robots_speed_tells_it_from_a_current",
            "come_out_of_order_beside_a_twin",
            "gap_in_a_turn_is_bridged",
            "a_reflection_is_worth",
            "may_come_late_and_out_of_order",
            "gives_in_when_every_frame_contradicts_it",
            "dead_module_is_taken",
            "choice_of_world_axes",
            "without_references_a_plant",
            "twin_that_diverges",
        ),
        warm=_swim,
    ),
    Target(
        files=_estimation("learning", "learning_state", "stretches"),
        tests=(
            "tests/control/estimation/test_learning.py",
            "tests/control/estimation/test_stretches.py",
        ),
        warm=_swim,
    ),
)


@dataclass(frozen=True)
class Work:
    """One mutant to be tried."""

    file: str
    digest: str
    """Of the file and this mutant."""
    mutant: Mutant

    def answer(self, outcome: str, seconds: float) -> str:
        """As a line of the progress."""
        row = {
            "digest": self.digest,
            "file": self.file,
            "function": self.mutant.function,
            "line": self.mutant.line,
            "before": self.mutant.before,
            "after": self.mutant.after,
            "outcome": outcome,
            "seconds": round(seconds, 2),
        }
        return json.dumps(row) + "\n"


def work_in(root: Path, file: str) -> list[Work]:
    """All mutants of a file."""
    works: list[Work] = []
    for mutant in mutants_of((root / file).read_text(encoding="utf-8")):
        digest = hashlib.sha256(f"{file}\n{mutant.text}".encode()).hexdigest()
        works.append(Work(file, digest[:16], mutant))
    return works


# ---- in forks ------------------------------------------------------------------------------------

FunctionKey = tuple[str, str, int]
"""File, name and first line of a function."""


class FaultyRuns:
    """A plugin of pytest: which tests are asked, in which order; with mutants of functions, a fork for each of them."""

    def __init__(
        self,
        root: Path,
        target: Target,
        works: Sequence[Work],
        tell: Callable[[Work, str, float], None],
    ) -> None:
        self._root = root
        self._target = target
        self._works = works
        self._tell = tell
        self.seconds: dict[str, float] = {}
        """What every test takes with sound code [s]."""
        self.at_import: list[Work] = []
        """Mutants that have to be there when the file is imported."""
        self._used: set[FunctionKey] = set()

    def pytest_collection(self) -> None:
        with contextlib.suppress(ImportError):
            hypothesis = import_module("hypothesis")
            steps = [hypothesis.Phase.explicit, hypothesis.Phase.generate]
            checks = list(hypothesis.HealthCheck)
            hypothesis.settings.register_profile(
                "mutants",
                derandomize=True,
                database=None,
                deadline=None,
                phases=steps,
                suppress_health_check=checks,
            )
            hypothesis.settings.load_profile("mutants")
        sys.setprofile(self._note)

    def _note(self, frame: types.FrameType, event: str, _: object) -> None:
        if event == "call":
            code = frame.f_code
            self._used.add((code.co_filename, code.co_qualname, code.co_firstlineno))

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        sys.setprofile(None)

        def is_asked(item: pytest.Item) -> bool:
            return not any(word in item.nodeid for word in self._target.left_out)

        items[:] = filter(is_asked, items)
        items.sort(key=lambda item: self.seconds.get(item.nodeid, math.inf))

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self._target.warm(getattr(session.items[0], "module", None))
        functions = _functions({str(self._root / file) for file in self._target.files})
        fork = forked(lambda say: self._run_sound(session.items, say), 600.0)
        if fork.status != "0":
            raise RuntimeError(f"the tests fail without any fault: {fork.status} {fork.said}")
        self.seconds |= json.loads(fork.said)
        session.items.sort(key=lambda item: self.seconds[item.nodeid])
        patience = max(PATIENCE * sum(self.seconds.values()), AT_LEAST)
        gc.freeze()  # what is there already is not looked through, and so not copied, in every fork
        for work in self._works:
            self._try(work, session.items, functions, patience)
        return True

    def _try(
        self,
        work: Work,
        items: list[pytest.Item],
        functions: dict[FunctionKey, list[Any]],
        patience: float,
    ) -> None:
        """Run the tests with one mutant, and tell what came of it, or note that it has to be there at import."""
        path = str(self._root / work.file)
        key = (path, work.mutant.function, work.mutant.first)
        code = _code_of(work.mutant, path)
        if key not in functions or code is None:
            self.at_import.append(work)
            return
        if len(code.co_freevars) != len(functions[key][0].__code__.co_freevars):
            self.at_import.append(work)
            return
        fork = forked(lambda _: self._run_faulty(items, functions[key], code), patience)
        was_used_before = key in self._used  # when the tests were collected
        if fork.status == "0" and was_used_before:
            self.at_import.append(work)
        else:
            self._tell(work, outcome_of(fork.status), fork.seconds)

    def _run_sound(self, items: list[pytest.Item], say: Callable[[str], None]) -> int:
        seconds = {}
        for item in items:
            begin = time.monotonic()
            if not _passes(item):
                say(item.nodeid)
                return 1
            seconds[item.nodeid] = time.monotonic() - begin
        say(json.dumps(seconds))
        return 0

    def _run_faulty(
        self, items: list[pytest.Item], functions: list[Any], code: types.CodeType
    ) -> int:
        for function in functions:
            function.__code__ = code
        do_all_pass = all(map(_passes, items))
        return int(not do_all_pass)


def _passes(item: pytest.Item) -> bool:
    runner = import_module("_pytest.runner")
    reports = runner.runtestprotocol(item, log=False, nextitem=None)
    return all(report.passed or report.skipped for report in reports)


def _functions(files: set[str]) -> dict[FunctionKey, list[Any]]:
    """All functions of some files that there are in this process."""
    functions: dict[FunctionKey, list[Any]] = {}
    for thing in gc.get_objects():
        if isinstance(thing, types.FunctionType) and thing.__code__.co_filename in files:
            code = thing.__code__
            key = (code.co_filename, code.co_qualname, code.co_firstlineno)
            functions.setdefault(key, []).append(thing)
    return functions


def _code_of(mutant: Mutant, path: str) -> types.CodeType | None:
    """The code of the outermost function with the fault."""

    def codes_inside(code: types.CodeType) -> Iterator[types.CodeType]:
        for constant in code.co_consts:
            if isinstance(constant, types.CodeType):
                yield constant
                yield from codes_inside(constant)

    for code in codes_inside(compile(mutant.text, path, "exec", dont_inherit=True)):
        if (code.co_qualname, code.co_firstlineno) == (mutant.function, mutant.first):
            return code
    return None


class Fork(NamedTuple):
    """What became of a fork."""

    status: str
    """Its exit status, or the signal that ended it."""
    said: str
    """What it said."""
    seconds: float
    """How long it took [s]."""


def forked(do: Callable[[Callable[[str], None]], int], patience: float) -> Fork:
    """Do something in a fork, to which it gets a function that says something to this process."""
    begin = time.monotonic()
    reading_end, writing_end = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which no child misses
        pid = os.fork()
    if pid == 0:
        status = 3
        try:
            os.setpgid(0, 0)
            os.close(reading_end)
            for alarm in (signal.SIGPROF, signal.SIGALRM):
                signal.signal(alarm, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_PROF, patience)
            signal.setitimer(signal.ITIMER_REAL, SLOWLY * patience)
            status = do(lambda text: os.write(writing_end, text.encode()) and None)
        except BaseException:
            traceback.print_exc()
            status = 1
        finally:
            with contextlib.suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(status)
    os.close(writing_end)
    with os.fdopen(reading_end, "rb") as pipe:
        said = pipe.read().decode()
    _, wait_status = os.waitpid(pid, 0)
    code = os.waitstatus_to_exitcode(wait_status)
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)  # what it may have started
    status = str(code)
    if code < 0:
        status = signal.Signals(-code).name
    return Fork(status, said, time.monotonic() - begin)


def outcome_of(status: str) -> str:
    if status == "0":
        return "alive"
    if status in ("SIGPROF", "SIGALRM"):
        return "hung"
    return "noticed"


def _imported_with(root: Path, work: Work, target: Target, seconds: dict[str, float]) -> int:
    """Run the tests in a process that has yet to import the file, and gets another text of it."""
    path = root / work.file
    read = importlib.machinery.SourceFileLoader.get_data

    def get_data(loader: Any, name: str) -> bytes:
        file = Path(name)
        if file == path:
            return work.mutant.text.encode()
        is_in_cache = file.parent == path.parent / "__pycache__"
        if is_in_cache and file.name.startswith(f"{path.stem}."):
            raise FileNotFoundError
        return read(loader, name)

    importlib.machinery.SourceFileLoader.get_data = get_data  # type: ignore[method-assign]
    # Bytecode of a fault must not stay behind; the tests switch on that bytecode is written.
    importlib.machinery.SourceFileLoader.set_data = lambda *_, **__: None  # type: ignore[method-assign]
    plugin = FaultyRuns(root, target, (), lambda *_: None)
    plugin.seconds = seconds
    plugin.pytest_runtestloop = lambda session: None  # type: ignore[assignment, method-assign, return-value]
    status = pytest.main([*_pytest_arguments(root, target), "-x"], plugins=[plugin])
    return int(status != pytest.ExitCode.OK)


def _pytest_arguments(root: Path, target: Target) -> list[str]:
    arguments = [str(root / folder) for folder in target.tests]
    arguments += [f"--rootdir={root}", "-q"]
    arguments += ["-p", "no:cacheprovider", "-p", "no:xdist"]
    arguments += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
    return arguments


def try_all(root: Path, target: Target, works: Sequence[Work], progress: Path) -> None:
    """Try mutants of one target and add the answers to a file of JSON lines.

    Raises:
        RuntimeError: If the tests fail without any fault.
    """

    def tell(work: Work, outcome: str, seconds: float) -> None:
        with progress.open("a", encoding="utf-8") as file:
            file.write(work.answer(outcome, seconds))

    def try_functions(say: Callable[[str], None]) -> int:
        plugin = FaultyRuns(root, target, works, tell)
        status = int(pytest.main(_pytest_arguments(root, target), plugins=[plugin]))
        say(json.dumps([[work.digest for work in plugin.at_import], plugin.seconds]))
        return status

    with tempfile.TemporaryFile() as out:
        fork = forked(lambda say: _quietly(out.fileno(), lambda: try_functions(say)), 1e6)
        if fork.status != "0":
            out.seek(0)
            raise RuntimeError(out.read().decode()[-3000:])
        digests_at_import, seconds = json.loads(fork.said)
        patience = max(PATIENCE * sum(seconds.values()), AT_LEAST) + IMPORTING
        for work in works:
            if work.digest not in digests_at_import:
                continue
            run_tests = partial(_imported_with, root, work, target, seconds)
            fork = forked(lambda _, run=run_tests: _quietly(out.fileno(), run), patience)
            tell(work, outcome_of(fork.status), fork.seconds)


def _quietly(file: int, do: Callable[[], int]) -> int:
    for number in (1, 2):
        os.dup2(file, number)
    return do()


# ---- the answer ----------------------------------------------------------------------------------


def wilson(n: int, of: int) -> tuple[float, float]:
    """The 95 % interval of a share, by Wilson's score."""
    if not of:
        return 0.0, 1.0
    return wilson_interval(n, of)


def answers(progress: Path) -> dict[str, dict[str, Any]]:
    """What is known, by the mutant's digest; later lines count."""
    if not progress.exists():
        return {}
    with progress.open(encoding="utf-8") as file:
        return {row["digest"]: row for row in map(json.loads, file)}


class Key(NamedTuple):
    """What tells a mutant from others, also after other lines of its file have changed."""

    file: str
    function: str
    before: str
    after: str


def equivalents() -> dict[Key, str]:
    """The reasons for which no test can tell a mutant from the code."""
    reasons: dict[Key, str] = {}
    if not ALIVE.exists():
        return reasons
    with ALIVE.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["outcome"] == "equivalent":
                key = Key(row["file"], row["function"], row["before"], row["after"])
                reasons[key] = row["reason"]
    return reasons


def stored() -> list[dict[str, str]]:
    """The last answer."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def key_of(work: Work) -> Key:
    return Key(work.file, work.mutant.function, work.mutant.before, work.mutant.after)


def write(
    works: Sequence[Work], known: dict[str, dict[str, Any]]
) -> list[tuple[str, Counter[str]]]:
    """Write both tables; returns what became of the mutants of every file."""
    reasons = equivalents()
    counts: dict[str, Counter[str]] = {}
    alive: list[tuple[str, ...]] = []
    for work in works:
        if work.digest not in known:
            continue
        outcome = known[work.digest]["outcome"]
        if outcome == "alive":
            reason = reasons.get(key_of(work), "")
            if reason:
                outcome = "equivalent"
            alive.append((*key_of(work), outcome, reason))
        counts.setdefault(work.file, Counter()).update([outcome, "tried"])
    rows = [*counts.items(), ("all", sum(counts.values(), Counter()))]
    n_mutants = Counter(work.file for work in works)
    n_mutants["all"] = len(works)
    with STORED.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        for name, count in rows:
            table.writerow(row_of(name, n_mutants[name], count))
    with ALIVE.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*Key._fields, "outcome", "reason"))
        table.writerows(dict.fromkeys(alive))
    return rows


COLUMNS = (
    "file",
    "mutants",
    "tried",
    "seen",
    "hung",
    "equivalent",
    "alive",
    "share",
    "without_equivalent",
)
"""Columns of the table of files."""


def row_of(name: str, n_mutants: int, count: Counter[str]) -> dict[str, object]:
    """What became of the mutants of a file, as a row of the table."""
    shares = shares_of(count)
    return {
        "file": name,
        "mutants": n_mutants,
        "tried": count["tried"],
        "seen": count["noticed"] + count["hung"],
        "hung": count["hung"],
        "equivalent": count["equivalent"],
        "alive": count["alive"],
        "share": f"{shares.of_tried:.4f}",
        "without_equivalent": f"{shares.of_others:.4f}",
    }


class Shares(NamedTuple):
    """Shares of mutants that are noticed."""

    of_tried: float
    of_others: float
    """Of those that are not equivalent."""


def shares_of(count: Counter[str]) -> Shares:
    noticed = count["noticed"] + count["hung"]
    n_others = count["tried"] - count["equivalent"]
    return Shares(noticed / max(count["tried"], 1), noticed / max(n_others, 1))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=[""], help="parts of files' paths")
    parser.add_argument("--sample", type=int, help="try so many by chance")
    parser.add_argument("--seed", type=int, default=1, help="of their order")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--again", action="store_true", help="those that lived")
    parser.add_argument("--thorough", action="store_true", help="with slow tests, too")
    parser.add_argument("--show", action="store_true", help="those that live, and try none")
    options = parser.parse_args()
    PROGRESS.parent.mkdir(exist_ok=True)
    known = answers(PROGRESS)
    everything: list[Work] = []
    for target in TARGETS:
        for file in target.files:
            everything += work_in(ROOT, file)
    chosen = [work for work in everything if any(part in work.file for part in options.only)]
    random.Random(options.seed).shuffle(chosen)
    chosen = chosen[: options.sample]
    if options.show:
        show_alive(chosen, known)
        return 0
    sys.path[:0] = [str(ROOT / "src")]
    os.environ["PYTHONPATH"] = f"{ROOT / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    os.nice(10)
    for name in BEFORE:
        with contextlib.suppress(ImportError):
            import_module(name)
    for target in TARGETS:
        if options.thorough:
            target = replace(target, left_out=())
        of_target = [work for work in chosen if work.file in target.files]
        left = works_left(of_target, known, again=options.again)
        if not left:
            continue
        print(f"{', '.join(target.files)}: {len(left)} mutants", file=sys.stderr, flush=True)
        if not try_in_jobs(target, left, options.jobs):
            return 1
    known = answers(PROGRESS)
    rows = write(everything, known)
    for name, count in rows:
        shares = shares_of(count)
        print(
            f"{name:<48} {dict(count)}  {shares.of_tried:.1%}, "
            f"without equivalent ones {shares.of_others:.1%}"
        )
    outcomes = Counter(known[work.digest]["outcome"] for work in chosen if work.digest in known)
    n_noticed = outcomes["noticed"] + outcomes["hung"]
    n_tried = outcomes.total()
    low, high = wilson(n_noticed, n_tried)
    print(
        f"chosen ones: {n_noticed} of {n_tried} noticed, {n_noticed / max(n_tried, 1):.1%}; "
        f"as a sample, {low:.1%} to {high:.1%} of all (95 %)"
    )
    _, count_of_all = rows[-1]
    return int(shares_of(count_of_all).of_tried < ENOUGH)


def show_alive(works: Sequence[Work], known: dict[str, dict[str, Any]]) -> None:
    """Print those that live and are not called equivalent, line by line."""
    reasons = equivalents()
    for work in sorted(works, key=lambda work: (work.file, work.mutant.line)):
        is_alive = known.get(work.digest, {}).get("outcome") == "alive"
        if is_alive and key_of(work) not in reasons:
            mutant = work.mutant
            print(f"{work.file}:{mutant.line}: {mutant.before}\n    -> {mutant.after}")


def works_left(
    works: Sequence[Work], known: dict[str, dict[str, Any]], *, again: bool
) -> list[Work]:
    """Mutants that are to be tried: what is not known, and again those that lived; equivalent ones last and once."""
    reasons = equivalents()
    left: list[Work] = []
    left_equivalents: list[Work] = []
    for work in works:
        is_known = work.digest in known
        if key_of(work) in reasons:
            if not is_known:
                left_equivalents.append(work)
        elif not is_known or (again and known[work.digest]["outcome"] == "alive"):
            left.append(work)
    return left + left_equivalents


def try_in_jobs(target: Target, works: Sequence[Work], n_jobs: int) -> bool:
    """Try mutants in several processes; whether all of them succeeded."""
    context = multiprocessing.get_context("fork")
    jobs = [
        context.Process(target=try_all, args=(ROOT, target, works[i::n_jobs], PROGRESS))
        for i in range(min(n_jobs, len(works)))
    ]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    return not any(job.exitcode for job in jobs)


if __name__ == "__main__":
    sys.exit(main())
