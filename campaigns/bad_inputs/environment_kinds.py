"""The program under odd circumstances: closed streams, narrow terminals, pipes as outputs, limits, other languages."""

import contextlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from bad_inputs import odd, pantry
from bad_inputs.attempt import ACCEPTED, REFUSED, STOPPED_STATUS, Answer, Case, fault, limit

TIMEOUT = 150.0
"""Time after which the program counts as hanging, on a busy computer that may have to compile [s]."""
BROKEN_PIPE_STATUS = 141
GOOD_STATUSES = (0, 1, 2, STOPPED_STATUS, BROKEN_PIPE_STATUS)

COMMANDS = (
    "swim --duration 0.5 --json",
    "swim --duration 0.5 --save new.nc --plot new.png",
    "swim --duration 0.2 --model spatial --json",
    "swim --duration nan",
    "swim --help",
    "--help",
    "robots",
    "trial show trial.nc --json",
    "trial convert trial.nc new.csv",
    "sweep --duration 0.5 --vary amplitude-deg=20,30 --output out",
    "export urdf --output new.urdf",
    "nonsense",
)
"""What is typed; a command with --json has to print what it prints elsewhere."""


@dataclass(frozen=True, kw_only=True)
class Circumstance:
    """How the program is started."""

    title: str
    shell: str = ""
    """What stands behind the command in the shell: streams that are closed, or go elsewhere."""
    before: str = ""
    """What stands before it: limits of the shell, for instance."""
    variables: Mapping[str, str | None] = field(default_factory=dict[str, str | None])
    """Changed variables of the environment; None: it is removed."""
    words: tuple[str, ...] = ()
    """Further words that are typed."""
    is_mute: bool = False
    """Whether nobody can read what the program says on standard error."""
    may_be_killed: bool = False
    """Whether the system may end it by a signal: limits of the processor's time or of files."""
    only: str = ""
    """Only for commands with this word."""


def _streams() -> list[Circumstance]:
    forms = {
        "stdout closed": (">&-", False),
        "stderr closed": ("2>&-", True),
        "stdout and stderr closed": (">&- 2>&-", True),
        "stdin closed": ("<&-", False),
        "all closed": ("<&- >&- 2>&-", True),
        "stdout full": (">/dev/full", False),
        "stderr full": ("2>/dev/full", True),
        "both full": (">/dev/full 2>/dev/full", True),
        "reader gone": ("| head -c1", False),
        "no reader": ("| true", False),
    }
    return [
        Circumstance(title=title, shell=shell, is_mute=is_mute)
        for title, (shell, is_mute) in forms.items()
    ]


def _variables() -> list[Circumstance]:
    choices: dict[str, tuple[str | None, ...]] = {
        "COLUMNS": ("0", "1", "2", "5", "20", "40", "-1", "x", "", "1000000"),
        "LINES": ("0", "1", "x"),
        "TERM": ("dumb", "", "nonsense", None),
        "LC_ALL": ("C", "POSIX", "tr_TR.UTF-8", "de_DE.UTF-8", "nonsense"),
        "PYTHONIOENCODING": ("ascii", "utf-16", "latin-1", "ascii:strict"),
        "PYTHONUTF8": ("0", "1"),
        "HOME": (None, "/nonexistent", "/dev/null", ""),
        "TMPDIR": ("/nonexistent", "/dev/null", "", "nowhere"),
        "XDG_CACHE_HOME": ("/nonexistent", "/dev/null"),
        "NUMBA_CACHE_DIR": ("/nonexistent", "/dev/null"),
        "NUMBA_DISABLE_JIT": ("1", "x"),
        "NUMBA_NUM_THREADS": ("0", "1", "x", "100000"),
        "OMP_NUM_THREADS": ("0", "x"),
        "MPLBACKEND": ("nonsense", "TkAgg"),
        "MPLCONFIGDIR": ("/nonexistent", "/dev/null"),
        "MUJOCO_GL": ("nonsense", "glfw", ""),
        "PYTHONOPTIMIZE": ("1", "2"),
        "PYTHONWARNINGS": ("error", "nonsense"),
        "PYTHONHASHSEED": ("0",),
        "TZ": ("nonsense", "Asia/Kathmandu"),
        "NO_COLOR": ("1",),
        "FORCE_COLOR": ("1",),
        "SOURCE_DATE_EPOCH": ("x",),
        "DISPLAY": ("nonsense:0",),
        "PATH": ("",),
    }
    circumstances: list[Circumstance] = []
    for name, contents in choices.items():
        for content in contents:
            title = f"{name} removed" if content is None else f"{name}={content}"
            circumstances.append(Circumstance(title=title, variables={name: content}))
    return circumstances


def _limits() -> list[Circumstance]:
    # With four open files Python cannot read its own modules, not even the one that prints errors.
    limits = {
        "-v 200000": False,
        "-v 400000": False,
        "-v 800000": False,
        "-v 1500000": False,
        "-n 8": False,
        "-n 16": False,
        "-n 64": False,
        "-s 256": False,
        "-f 0": True,
        "-f 1": True,
        "-f 10": True,
        "-t 1": True,
        "-u 1": False,
        "-c 0": False,
    }
    # Python keeps what it could write of a module that it compiled: where files are cut, it writes none.
    variables: dict[str, str | None] = {"PYTHONDONTWRITEBYTECODE": "1"}
    return [
        Circumstance(
            title=f"ulimit {words}",
            before=f"ulimit {words};",
            variables=variables,
            may_be_killed=may_be_killed,
        )
        for words, may_be_killed in limits.items()
    ]


PIPES = {
    "pipe.nc": "--save",
    "pipe.csv": "--save",
    "pipe.mcap": "--save",
    "pipe.png": "--plot",
    "pipe.mp4": "--video",
    "pipe.toml": "--save-scenario",
}
"""Outputs that may be pipes that nobody reads."""


def _places() -> list[Circumstance]:
    pipes = [
        Circumstance(
            title=f"{flag} {name} is a pipe",
            before=f"mkfifo {name};",
            words=(flag, name),
            only="swim --duration",
        )
        for name, flag in PIPES.items()
    ]
    return [
        Circumstance(title="umask 777", before="umask 777;"),
        Circumstance(title="no working directory", before='mkdir gone; cd gone; rmdir "$PWD";'),
        *pipes,
        Circumstance(
            title="--output is a pipe",
            before="mkfifo pipe;",
            words=("--output", "pipe"),
            only="--output",
        ),
        Circumstance(
            title="--save is a device", words=("--save", "/dev/full"), only="swim --duration"
        ),
        Circumstance(
            title="--save is a link to nowhere",
            before="ln -s nowhere/at.nc link.nc;",
            words=("--save", "link.nc"),
            only="swim --duration",
        ),
        Circumstance(
            title="--save is a link to itself",
            before="ln -s link.nc link.nc;",
            words=("--save", "link.nc"),
            only="swim --duration",
        ),
    ]


CIRCUMSTANCES = (*_streams(), *_variables(), *_limits(), *_places())


def environment(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Commands under every circumstance."""
    for circumstance in odd.draw_in_turn(rng, CIRCUMSTANCES):
        suited = [command for command in COMMANDS if circumstance.only in command]
        command = rng.choice(suited)
        attack = UnderCircumstance(circumstance=circumstance, command=command, pantry=folder)
        yield Case("environment", f"{circumstance.title}: {command}", attack)


@dataclass(frozen=True, kw_only=True)
class UnderCircumstance:
    """A command under a circumstance."""

    circumstance: Circumstance
    command: str
    pantry: Path

    def __call__(self) -> Answer:
        """Run it in a shell in the working directory."""
        pantry.lay_out(self.pantry, tuple(self.command.split()))
        words = " ".join([self.command, *self.circumstance.words])
        program = f"{sys.executable} -m laticauda {words}"
        line = f"{self.circumstance.before} {program} {self.circumstance.shell}"
        ran = _run_in_shell(line, self.circumstance.variables)
        if ran is None:
            return fault(f"hangs: not ended after {TIMEOUT:g} s")
        return self._judge(ran)

    def _judge(self, ran: "Ran") -> Answer:
        if "Traceback" in ran.err or "Exception ignored" in ran.err:
            return fault(f"a traceback: {ran.err[-600:]}")
        if ran.status not in GOOD_STATUSES:
            is_killed = ran.status < 0 or ran.status > 128
            if is_killed and self.circumstance.may_be_killed:
                return REFUSED
            return fault(f"exit status {ran.status}: {ran.err[-600:]}")
        if ran.status == 2:
            if not ran.err.strip() and not self.circumstance.is_mute:
                return fault("refused without a word")
            return REFUSED
        if "--json" in self.command and ran.out.strip() and "|" not in self.circumstance.shell:
            expected = _usual_output(self.command, self.pantry)
            if ran.out != expected:
                return fault(f"prints {ran.out[:300]} instead of {expected[:300]}")
        return ACCEPTED


@dataclass(frozen=True)
class Ran:
    """What the shell said."""

    status: int
    out: str
    err: str


def _run_in_shell(line: str, changes: Mapping[str, str | None]) -> Ran | None:
    """Return what a line says in a shell; None if it does not come to an end."""
    variables = dict(os.environ)
    for name, content in changes.items():
        variables.pop(name, None)
        if content is not None:
            variables[name] = content
    for kind in (resource.RLIMIT_AS, resource.RLIMIT_CPU):
        limit(kind, resource.RLIM_INFINITY)
    shell = subprocess.Popen(
        ["/bin/bash", "-c", f"set -o pipefail; {line}"],
        env=variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    try:
        out, err = shell.communicate(timeout=TIMEOUT)
    except subprocess.TimeoutExpired:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(shell.pid, signal.SIGKILL)
        shell.wait()
        return None
    encoding = "utf-8"
    if variables.get("PYTHONIOENCODING") == "utf-16":
        encoding = "utf-16"
    return Ran(
        status=shell.returncode,
        out=out.decode(encoding, errors="replace"),
        err=err.decode(encoding, errors="replace"),
    )


def _usual_output(command: str, folder: Path) -> str:
    """Return what a command prints under no special circumstance; it is written to the folder of good files once."""
    kept = folder / f"usual-{COMMANDS.index(command)}.txt"
    if not kept.exists():
        ran = _run_in_shell(f"{sys.executable} -m laticauda {command}", {})
        assert ran is not None
        json.loads(ran.out)
        kept.write_text(ran.out)
    return kept.read_text()
