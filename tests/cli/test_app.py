import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from patience import LONG, running
from rendering import skip_without_rendering

import laticauda
from laticauda.cli import app
from laticauda.film import write_example
from laticauda.paper.command import Reproduce

PROGRAM = Path(sys.executable).parent / "laticauda"


def shell(*words: str, **settings: Any) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [PROGRAM, *words], capture_output=True, text=True, timeout=120, **settings
    )


def test_the_installed_command_swims():
    done = shell("swim", "--duration", "2")
    assert done.returncode == 0, done.stderr
    assert "speed   0." in done.stdout
    assert "Traceback" not in done.stderr


def test_the_installed_command_refuses_bad_input():
    done = shell("swim", "--amplitude-deg", "-3")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == "laticauda: --amplitude-deg must be between 0 and 180 deg, got -3.\n"


def test_a_closed_pipe_is_no_error_message():
    pipe = subprocess.Popen([PROGRAM, "robots"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert pipe.stdout is not None and pipe.stderr is not None
    pipe.stdout.close()
    assert pipe.wait(timeout=60) == 141
    assert pipe.stderr.read() == b""
    pipe.stderr.close()


def test_the_version_is_that_of_the_package(run):
    assert run("--version").out == f"laticauda {laticauda.__version__}\n"


@pytest.mark.parametrize(
    "line", ["--help", "-h", "trial --help", "swim -h", "robots --help", "trial show --help"]
)
def test_help_is_printed_and_ends_well(run, line):
    done = run(line)
    assert done.status == 0
    assert "usage: laticauda" in done.out
    assert done.err == ""


def test_the_help_lists_every_command(run):
    framed = "".join(run(f"{words} --help").out for words in ("", *app.GROUPS))
    listed = " ".join(framed.replace("│", " ").split())  # without the frame and its line breaks
    assert all(
        words.split()[-1] in listed and text in listed for words, (_, text) in app.COMMANDS.items()
    )


@pytest.mark.parametrize("width", [80, 120])
@pytest.mark.parametrize("words", app.COMMANDS)
def test_the_help_of_every_command_fits_a_terminal(run, monkeypatch, words, width):
    monkeypatch.setenv("COLUMNS", str(width))
    lines = run(f"{words} --help").out.splitlines()[1:]  # tyro does not break the line of the usage
    assert max(map(len, lines)) <= width


def test_the_help_names_groups_by_what_they_are_and_lists_single_numbers_last(run):
    groups = re.findall(r"^\W*(\S+) options\W*$", run("sweep --help").out, re.MULTILINE)
    lists = ["names", "scenario", "gait", "water", "total-speed-drag", "planar", "speed-servo"]
    assert groups == [*lists, "start"]


EEL = "--gait eel-like --amplitude-deg 50 --frequency-deg-s 110 --phase-shift-deg 40"
SERVERS = ("lab", "serve", "cockpit")


def example_of(run, words):
    """What the help of a command gives as an example, on one line."""
    text = run(f"{words} --help").out
    assert "--json" in text
    (example,) = re.findall(r"For example: laticauda (.+?)\n\n", text, re.DOTALL)
    return " ".join(example.split())


SAVED = {
    "run.nc": "",
    "bare.nc": "",
    "run-1.nc": "",
    "run-2.nc": EEL,
    "fin.nc": "--robot mamba-fin",
}
"""Runs that the examples read, and the flags of each."""


@pytest.fixture(scope="module")
def saved_runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of `SAVED`."""
    folder = tmp_path_factory.mktemp("saved_runs")
    for name, flags in SAVED.items():
        assert (
            app.main([*"swim --duration 3 --save".split(), str(folder / name), *flags.split()]) == 0
        )
    return folder


FIRST = {"predict": "identify"}
"""Commands whose example needs what that of another one writes; that one is tested with it."""
SHORTER = {"mission": "--duration 20"}
"""Flags that the examples of commands get, because they take long."""


@pytest.mark.parametrize(
    "words", [words for words in app.COMMANDS if words not in {*SERVERS, *FIRST.values()}]
)
def test_the_help_of_every_command_has_an_example_that_runs_and_offers_json(
    run, words, folder, saved_runs
):
    if words in ("operate", "drivers"):
        assert example_of(run, words)
        pytest.skip(f"needs a robot: tests/cli/test_{words}.py runs it in the virtual tank")
    if words == "lens":
        assert example_of(run, words)
        pytest.skip("needs a checkerboard: tests/film/calibration/test_boards.py renders one")
    if words == "reproduce":
        assert Reproduce.read(shlex.split(example_of(run, words))[1:], words).joints == "prescribed"
        pytest.skip("takes long: tests/paper/test_command.py runs it with studies cut down")
    if words == "inverse":
        assert example_of(run, words)
        pytest.skip("needs points of a tracker: tests/cli/test_inverse.py makes some")
    if words in ("camera", "track"):
        write_example(folder)
    for file in saved_runs.iterdir():
        shutil.copy(file, folder)
    if words == "import farms":
        shutil.copy(Path(__file__).parent.parent / "data" / "farms" / "eel.sdf", folder)
        (folder / "animat_config.yaml").write_text("sdf: eel.sdf\n")
    if words == "view":
        skip_without_rendering()
    if words == "replay":
        from tank.operate.tank import record

        record(Path("run.mcap"))
    for command in filter(None, (FIRST.get(words), words)):
        done = run(f"{example_of(run, command)} {SHORTER.get(command, '')}")
        assert done.status == 0, done.err
        assert done.out


@pytest.mark.parametrize("words", SERVERS)
def test_the_example_of_a_server_says_its_address_and_ends_well_by_ctrl_c(run, words):
    command = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]
    free = re.sub(
        r"--port \d+", "--port 0", example_of(run, words)
    )  # other tests serve at the same time
    with running(
        [*command, *free.split()], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as server:
        assert server.stdout.readline().strip()
        server.send_signal(signal.SIGINT)
        _, told = server.communicate(timeout=LONG)
        assert server.returncode == 0, told


@pytest.mark.parametrize(
    "command",
    ["--help", "--version", "swim --help", "robots", "robots mamba --toml", "trial --help"],
)
def test_commands_that_do_not_simulate_load_no_heavy_library(command):
    heavy = ["numba", "matplotlib", "netCDF4", "xarray", "scipy", "tqdm"]
    code = (
        f"import sys; from laticauda.cli import main; status = main({command.split()!r});"
        f"print(*[name for name in {heavy} if name in sys.modules], file=sys.stderr); sys.exit(status)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.split() == []


def test_a_swim_loads_neither_plots_nor_files_unless_asked():
    heavy = ["matplotlib", "netCDF4", "xarray", "tqdm"]
    code = (
        "import sys; from laticauda.cli import main; status = main(['swim', '--duration', '1']);"
        f"print(*[name for name in {heavy} if name in sys.modules], file=sys.stderr); sys.exit(status)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert [line for line in done.stderr.splitlines() if "compiling" not in line] == [""]


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (KeyboardInterrupt(), 130, "laticauda: stopped.\n"),
        (
            MemoryError(),
            2,
            "laticauda: there is not enough memory; try a shorter run, or fewer samples.\n",
        ),
        (OverflowError("too much"), 2, "laticauda: a number is out of range: too much.\n"),
        (
            PermissionError(13, "Permission denied", "a.nc"),
            2,
            "laticauda: a.nc: permission denied.\n",
        ),
        (
            FileNotFoundError(2, "No such file or directory", "b"),
            2,
            "laticauda: b: no such file or directory.\n",
        ),
        (OSError("no space"), 2, "laticauda: no space.\n"),
        (
            laticauda.values.errors.TrialFileError("Cannot read `x`."),
            2,
            "laticauda: Cannot read `x`.\n",
        ),
        (ValueError("`json` must be nice."), 2, "laticauda: `json` must be nice.\n"),
        (
            laticauda.values.errors.BadArgument("json", "must be nice"),
            2,
            "laticauda: --json must be nice.\n",
        ),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_every_failure_has_its_status_and_a_message(run, monkeypatch, error, status, message):
    from laticauda.cli import robots

    def fail(self: object) -> int:
        raise error

    monkeypatch.setattr(robots.Robots, "__call__", fail)
    done = run("robots --json")
    assert (done.status, done.out, done.err) == (status, "", message)


def test_a_bug_is_not_hidden_as_bad_input(run, monkeypatch):
    from laticauda.cli import robots

    def fail(self: object) -> int:
        raise ZeroDivisionError

    monkeypatch.setattr(robots.Robots, "__call__", fail)
    with pytest.raises(ZeroDivisionError):
        run("robots")


def test_the_output_can_be_written_where_there_is_no_unicode():
    done = shell("robots", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0, done.stderr


INTERRUPTED = """
import os, signal, sys
from laticauda.cli import main

def interrupt(event, args):
    if event == "import" and args[0] == sys.argv[1]:
        os.kill(os.getpid(), signal.SIGINT)

sys.addaudithook(interrupt)
# In moving water, because usual runs do not need the compiler.
sys.exit(main(["swim", "--duration", "1", "--current", "shear"]))
"""


@pytest.mark.parametrize("module", ["tyro", "numpy", "numba.core.registry"])
def test_ctrl_c_while_something_is_imported_is_one_line(module: str):
    words = [sys.executable, "-c", INTERRUPTED, module]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "laticauda: stopped.\n")


IN_C = """
import ctypes, os, signal
from laticauda import cli
from laticauda.cli import app

def work(args):
    ctypes.pythonapi.PyRun_SimpleString(b"import os, signal; os.kill(os.getpid(), signal.SIGINT)\\nwhile True: pass")
    print("goes on")

app.main = work
cli.main([])
"""


def test_ctrl_c_where_a_library_in_c_prints_errors_instead_of_handing_them_on_is_one_line():
    done = subprocess.run([sys.executable, "-c", IN_C], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "laticauda: stopped.\n")


COMPILED = """
import os, signal
from numba import njit
from numba.extending import overload
from laticauda import cli
from laticauda.cli import app

def law(x):
    return x

@overload(law)
def _typed(x):
    os.kill(os.getpid(), signal.SIGINT)
    return lambda x: x

def work(args):
    try:
        njit(lambda x: law(x))(1.0)
    except KeyboardInterrupt:
        print("takes a compiler apart")

app.main = work
cli.main([])
"""


def test_ctrl_c_while_a_kernel_is_compiled_ends_at_once_as_what_the_compiler_left_may_crash():
    done = subprocess.run(
        [sys.executable, "-c", COMPILED], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "laticauda: stopped.\n")


HALF_MADE = """
import os, signal, sys
from laticauda import cli
from laticauda.cli import app

class Handle:
    def __init__(self, is_cycle):
        self.cycle = self if is_cycle else None
        if sys.argv[1] == "interrupted":
            os.kill(os.getpid(), signal.SIGINT)

    def __del__(self):
        print(self.pointer)

def work(args):
    Handle(sys.argv[2] == "in a cycle")
    return 0

app.main = work
sys.exit(cli.main())
"""


@pytest.mark.parametrize("where", ["alone", "in a cycle"])
def test_what_ctrl_c_leaves_half_made_says_nothing_when_it_goes(where: str):
    words = [sys.executable, "-c", HALF_MADE]
    done = subprocess.run(
        [*words, "interrupted", where], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "laticauda: stopped.\n")


def test_what_breaks_without_ctrl_c_is_said():
    words = [sys.executable, "-c", HALF_MADE, "undisturbed", "alone"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0
    assert "AttributeError: 'Handle' object has no attribute 'pointer'" in done.stderr


TWICE = """
import os, signal, sys
from laticauda import cli
from laticauda.cli import app

def work(args):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    except KeyboardInterrupt:
        os.kill(os.getpid(), signal.SIGINT)
        print("goes on")

app.main = work
cli.main([])
"""


@pytest.mark.skipif(os.name != "posix", reason="another end of processes")
def test_a_second_ctrl_c_ends_it_at_once():
    done = subprocess.run(
        [sys.executable, "-c", TWICE], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")


def test_a_mistyped_command_is_told_the_nearest(run):
    done = run("swimm")
    assert (done.status, done.err) == (
        2,
        "laticauda: there is no command `swimm`; did you mean `swim`?\n",
    )
    assert (
        run("nonsense").err
        == "laticauda: there is no command `nonsense`; `laticauda --help` lists all commands.\n"
    )
