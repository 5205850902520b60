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
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from _mutations import Mutant, mutants_of

from laticauda.missions.campaign import wilson_interval

ROOT = Path(__file__).parents[1]
STORED = Path(__file__).with_suffix(".csv")
ALIVE = Path(__file__).with_name("mutants_alive.csv")
PROGRESS = ROOT / "build" / "mutants.jsonl"
ENOUGH = 0.85
PATIENCE, AT_LEAST = 3.0, 10.0  # times what sound code takes; [s], of this process's own
IMPORTING = 20.0  # what it may take until the tests begin [s]
SLOWLY = 6.0  # a computer that is busy does as much in so many times the time
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
        one = self.mutant
        told = {
            "file": self.file,
            "function": one.function,
            "line": one.line,
            "before": one.before,
            "after": one.after,
        }
        return (
            json.dumps(
                {"digest": self.digest, **told, "outcome": outcome, "seconds": round(seconds, 2)}
            )
            + "\n"
        )


def work_in(root: Path, file: str) -> list[Work]:
    """All mutants of a file."""
    text = (root / file).read_text(encoding="utf-8")
    return [
        Work(file, hashlib.sha256(f"{file}\n{one.text}".encode()).hexdigest()[:16], one)
        for one in mutants_of(text)
    ]


# ---- in forks ------------------------------------------------------------------------------------


class Asked:
    """A plugin of pytest: which tests are asked, in which order; with mutants of functions, a fork for each of them."""

    def __init__(
        self,
        root: Path,
        target: Target,
        works: Sequence[Work],
        tell: Callable[[Work, str, float], None],
    ) -> None:
        self._root, self._target, self._works, self._tell = root, target, works, tell
        self.seconds: dict[str, float] = {}
        self.at_import: list[Work] = []
        self._used: set[tuple[str, str, int]] = set()

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
        items[:] = [
            item for item in items if not any(word in item.nodeid for word in self._target.left_out)
        ]
        items.sort(key=lambda item: self.seconds.get(item.nodeid, math.inf))

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        self._target.warm(getattr(session.items[0], "module", None))
        known = _functions({str(self._root / file) for file in self._target.files})
        status, told, _ = forked(lambda say: self._sound(session.items, say), 600.0)
        if status != "0":
            raise RuntimeError(f"the tests fail without any fault: {status} {told}")
        self.seconds |= json.loads(told)
        session.items.sort(key=lambda item: self.seconds[item.nodeid])
        patience = max(PATIENCE * sum(self.seconds.values()), AT_LEAST)
        gc.freeze()  # what is there already is not looked through, and so not copied, in every fork
        for work in self._works:
            key = (str(self._root / work.file), work.mutant.function, work.mutant.first)
            functions = known.get(key, [])
            code = _code_of(work.mutant, key[0])
            if (
                not functions
                or code is None
                or len(code.co_freevars) != len(functions[0].__code__.co_freevars)
            ):
                self.at_import.append(work)
                continue
            status, _, seconds = forked(
                lambda _, f=functions, c=code: self._faulty(session.items, f, c), patience
            )
            if (
                status == "0" and key in self._used
            ):  # it may have done its work when the tests were collected
                self.at_import.append(work)
            else:
                self._tell(work, outcome_of(status), seconds)
        return True

    def _sound(self, items: list[pytest.Item], say: Callable[[str], None]) -> int:
        seconds = {}
        for item in items:
            begin = time.monotonic()
            if not _passes(item):
                say(item.nodeid)
                return 1
            seconds[item.nodeid] = time.monotonic() - begin
        say(json.dumps(seconds))
        return 0

    def _faulty(self, items: list[pytest.Item], functions: list[Any], code: types.CodeType) -> int:
        for function in functions:
            function.__code__ = code
        return 0 if all(map(_passes, items)) else 1


def _passes(item: pytest.Item) -> bool:
    runner = import_module("_pytest.runner")
    return all(
        report.passed or report.skipped
        for report in runner.runtestprotocol(item, log=False, nextitem=None)
    )


def _functions(files: set[str]) -> dict[tuple[str, str, int], list[Any]]:
    """All functions that there are in this process, by file, name and line."""
    found: dict[tuple[str, str, int], list[Any]] = {}
    for one in gc.get_objects():
        if isinstance(one, types.FunctionType) and one.__code__.co_filename in files:
            code = one.__code__
            found.setdefault((code.co_filename, code.co_qualname, code.co_firstlineno), []).append(
                one
            )
    return found


def _code_of(mutant: Mutant, path: str) -> types.CodeType | None:
    """The code of the outermost function with the fault."""

    def inside(code: types.CodeType) -> Iterator[types.CodeType]:
        for one in code.co_consts:
            if isinstance(one, types.CodeType):
                yield one
                yield from inside(one)

    whole = compile(mutant.text, path, "exec", dont_inherit=True)
    same = (
        one
        for one in inside(whole)
        if (one.co_qualname, one.co_firstlineno) == (mutant.function, mutant.first)
    )
    return next(same, None)


def forked(do: Callable[[Callable[[str], None]], int], patience: float) -> tuple[str, str, float]:
    """Do something in a fork: its exit status or the signal that ended it, what it said, and how long that took [s]."""
    begin, (there, here) = time.monotonic(), os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of threads, which no child misses
        pid = os.fork()
    if pid == 0:
        status = 3
        try:
            os.setpgid(0, 0)
            os.close(there)
            for alarm in (signal.SIGPROF, signal.SIGALRM):
                signal.signal(alarm, signal.SIG_DFL)
            signal.setitimer(signal.ITIMER_PROF, patience)
            signal.setitimer(signal.ITIMER_REAL, SLOWLY * patience)
            status = do(lambda text: os.write(here, text.encode()) and None)
        except BaseException:
            traceback.print_exc()
            status = 1
        finally:
            with contextlib.suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(status)
    os.close(here)
    with os.fdopen(there, "rb") as said:
        text = said.read().decode()
    code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)  # what it may have started
    return (signal.Signals(-code).name if code < 0 else str(code)), text, time.monotonic() - begin


def outcome_of(status: str) -> str:
    return "alive" if status == "0" else "hung" if status in ("SIGPROF", "SIGALRM") else "noticed"


def _imported_with(root: Path, work: Work, target: Target, seconds: dict[str, float]) -> int:
    """Run the tests in a process that has yet to import the file, and gets another text of it."""
    path, read = root / work.file, importlib.machinery.SourceFileLoader.get_data

    def get_data(loader: Any, wanted: str) -> bytes:
        given = Path(wanted)
        if given == path:
            return work.mutant.text.encode()
        if given.parent == path.parent / "__pycache__" and given.name.startswith(f"{path.stem}."):
            raise FileNotFoundError
        return read(loader, wanted)

    importlib.machinery.SourceFileLoader.get_data = get_data  # type: ignore[method-assign]
    # Bytecode of a fault must not stay behind; the tests switch on that bytecode is written.
    importlib.machinery.SourceFileLoader.set_data = lambda *_, **__: None  # type: ignore[method-assign]
    plugin = Asked(root, target, (), lambda *_: None)
    plugin.seconds = seconds
    plugin.pytest_runtestloop = lambda session: None  # type: ignore[assignment, method-assign, return-value]
    return int(pytest.main([*_words(root, target), "-x"], plugins=[plugin])) and 1


def _words(root: Path, target: Target) -> list[str]:
    without = (
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
        "-W",
        "ignore::pytest.PytestAssertRewriteWarning",
    )
    return [*(str(root / one) for one in target.tests), f"--rootdir={root}", "-q", *without]


def try_all(root: Path, target: Target, works: Sequence[Work], progress: Path) -> None:
    """Try mutants of one target and add the answers to a file of JSON lines.

    Raises:
        RuntimeError: If the tests fail without any fault.
    """

    def tell(work: Work, outcome: str, seconds: float) -> None:
        with progress.open("a", encoding="utf-8") as file:
            file.write(work.answer(outcome, seconds))

    def first(say: Callable[[str], None]) -> int:
        plugin = Asked(root, target, works, tell)
        status = int(pytest.main(_words(root, target), plugins=[plugin]))
        say(json.dumps([[work.digest for work in plugin.at_import], plugin.seconds]))
        return status

    with tempfile.TemporaryFile() as out:
        status, said, _ = forked(lambda say: _quietly(out.fileno(), lambda: first(say)), 1e6)
        if status != "0":
            out.seek(0)
            raise RuntimeError(out.read().decode()[-3000:])
        left, seconds = json.loads(said)
        patience = max(PATIENCE * sum(seconds.values()), AT_LEAST) + IMPORTING
        for work in works:
            if work.digest in left:
                status, _, took = forked(
                    lambda _, one=work: _quietly(
                        out.fileno(), lambda: _imported_with(root, one, target, seconds)
                    ),
                    patience,
                )
                tell(work, outcome_of(status), took)


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


Key = tuple[str, str, str, str]


def equivalents() -> dict[Key, str]:
    """The reasons for which no test can tell a mutant from the code: by file, function, the lines before and after."""
    return {key: reason for key, (word, reason) in _listed().items() if word == "equivalent"}


def _listed() -> dict[Key, tuple[str, str]]:
    if not ALIVE.exists():
        return {}
    with ALIVE.open(newline="", encoding="utf-8") as file:
        return {
            (row["file"], row["function"], row["before"], row["after"]): (
                row["outcome"],
                row["reason"],
            )
            for row in csv.DictReader(file)
        }


def stored() -> list[dict[str, str]]:
    """The last answer."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def key_of(work: Work) -> Key:
    return work.file, work.mutant.function, work.mutant.before, work.mutant.after


def write(
    works: Sequence[Work], known: dict[str, dict[str, Any]]
) -> list[tuple[str, Counter[str]]]:
    """Write both tables; returns what became of the mutants of every file."""
    reasons, counts, alive = equivalents(), dict[str, Counter[str]](), list[tuple[str, ...]]()
    for work in works:
        if work.digest not in known:
            continue
        outcome, reason = known[work.digest]["outcome"], reasons.get(key_of(work), "")
        if outcome == "alive":
            outcome = "equivalent" if reason else "alive"
            alive.append((*key_of(work), outcome, reason))
        counts.setdefault(work.file, Counter()).update([outcome, "tried"])
    rows = [*counts.items(), ("all", sum(counts.values(), Counter()))]
    with STORED.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            (
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
        )
        for name, count in rows:
            n = sum(name in (work.file, "all") for work in works)
            told = (count[word] for word in ("hung", "equivalent", "alive"))
            seen = count["noticed"] + count["hung"]
            table.writerow(
                (name, n, count["tried"], seen, *told, *(f"{share:.4f}" for share in shares(count)))
            )
    with ALIVE.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("file", "function", "before", "after", "outcome", "reason"))
        table.writerows(dict.fromkeys(alive))
    return rows


def shares(count: Counter[str]) -> tuple[float, float]:
    """Noticed of all tried, and of those that are not equivalent."""
    noticed = count["noticed"] + count["hung"]
    return noticed / max(count["tried"], 1), noticed / max(count["tried"] - count["equivalent"], 1)


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
    everything = [
        work for target in TARGETS for file in target.files for work in work_in(ROOT, file)
    ]
    chosen = [work for work in everything if any(part in work.file for part in options.only)]
    random.Random(options.seed).shuffle(chosen)
    chosen = chosen[: options.sample]
    if options.show:
        reasons = equivalents()
        for work in sorted(chosen, key=lambda one: (one.file, one.mutant.line)):
            if known.get(work.digest, {}).get("outcome") == "alive" and key_of(work) not in reasons:
                print(
                    f"{work.file}:{work.mutant.line}: {work.mutant.before}\n    -> {work.mutant.after}"
                )
        return 0
    sys.path[:0] = [str(ROOT / "src")]
    os.environ["PYTHONPATH"] = f"{ROOT / 'src'}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    os.nice(10)
    for name in BEFORE:
        with contextlib.suppress(ImportError):
            import_module(name)
    for target in (replace(one, left_out=()) if options.thorough else one for one in TARGETS):
        reasons = equivalents()
        todo = [
            work
            for work in chosen
            if work.file in target.files
            and (
                work.digest not in known
                or (options.again and known[work.digest]["outcome"] == "alive")
            )
            and key_of(work) not in reasons
        ] + [
            work
            for work in chosen
            if work.file in target.files and work.digest not in known and key_of(work) in reasons
        ]
        if not todo:
            continue
        print(f"{', '.join(target.files)}: {len(todo)} mutants", file=sys.stderr, flush=True)
        jobs = [
            multiprocessing.get_context("fork").Process(
                target=try_all, args=(ROOT, target, todo[i :: options.jobs], PROGRESS)
            )
            for i in range(min(options.jobs, len(todo)))
        ]
        for job in jobs:
            job.start()
        for job in jobs:
            job.join()
        if any(job.exitcode for job in jobs):
            return 1
    known = answers(PROGRESS)
    rows = write(everything, known)
    for name, count in rows:
        print(
            f"{name:<48} {dict(count)}  {shares(count)[0]:.1%}, without equivalent ones {shares(count)[1]:.1%}"
        )
    some = Counter(known[work.digest]["outcome"] for work in chosen if work.digest in known)
    n, of = some["noticed"] + some["hung"], some.total()
    low, high = wilson(n, of)
    print(
        f"chosen ones: {n} of {of} noticed, {n / max(of, 1):.1%}; as a sample, {low:.1%} to {high:.1%} of all (95 %)"
    )
    return int(shares(rows[-1][1])[0] < ENOUGH)


if __name__ == "__main__":
    sys.exit(main())
