"""Systems that are not like this one: those without POSIX, those where nothing can be written, archives."""

import os
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import laticauda

PACKAGE = Path(laticauda.__file__).parent
WITHOUT_POSIX = textwrap.dedent(
    """
    import builtins, importlib, os, pkgutil, signal, sys
    import laticauda, laticauda.values.errors

    gone = {"fcntl", "termios", "tty", "pty", "resource", "pwd", "grp", "posix", "syslog"}
    ordinary = builtins.__import__

    def importing(name, globals=None, *rest, **further):
        if (globals or {}).get("__name__", "").startswith("laticauda") and name.split(".")[0] in gone:
            raise ModuleNotFoundError(f"No module named {name!r}")
        return ordinary(name, globals, *rest, **further)

    builtins.__import__ = importing
    for module in pkgutil.walk_packages(laticauda.__path__, "laticauda."):
        try:
            importlib.import_module(module.name)
        except laticauda.values.errors.MissingExtra:
            pass
        except KeyError as error:  # a template of kernels, which is loaded for something
            assert error.args == (module.name,), module.name
    import pathlib, tempfile
    from laticauda.values import files
    from laticauda.tank.lab.serving import SerialLine
    from laticauda.tank.operate.terminal import Keys, Terminal
    for name in ("openpty", "tcgetpgrp", "getpgrp", "sched_getaffinity", "fork", "getuid", "ttyname"):
        delattr(os, name)
    for name in ("SIGKILL", "SIGHUP", "SIGUSR1", "SIGALRM", "pthread_sigmask"):
        delattr(signal, name)
    with tempfile.TemporaryDirectory() as folder, files.locked(pathlib.Path(folder), wait=False):
        with Terminal(Keys()):
            pass
    try:
        SerialLine(lambda line: b"")
    except laticauda.values.errors.LaticaudaError as error:
        print(error)
    gait = laticauda.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
    print(laticauda.swim("mamba", gait, 1.0).succeeded)
    """
)


UNWRITABLE = """
import warnings
from numba.core import caching
ordinary = caching._CacheLocator.ensure_cache_path
def ensure_cache_path(self):
    if "laticauda-" not in self.get_cache_path():
        raise PermissionError("Permission denied")
    ordinary(self)
caching._CacheLocator.ensure_cache_path = ensure_cache_path
import os, sys
warnings.simplefilter("error")
from laticauda import compiling  # which compiles nothing
warnings.simplefilter("default")
from laticauda.compiling.templates import is_kept
@compiling.entry
def _twice_0(x):
    return 2.0 * x
assert _twice_0(2.0) == 4.0 and is_kept(_twice_0)
print(os.environ["NUMBA_CACHE_DIR"])
print(len(list(os.scandir(os.environ["NUMBA_CACHE_DIR"]))))
"""


def test_without_posix_every_module_can_be_imported_and_what_needs_it_says_so():
    done = subprocess.run([sys.executable, "-c", WITHOUT_POSIX], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [
        "The meter's port cannot be opened: No module named 'tty'.",
        "True",
    ]


def test_where_nothing_can_be_written_kernels_are_kept_until_the_program_ends_and_it_says_so(
    tmp_path,
):
    script = tmp_path / "script.py"
    script.write_text(UNWRITABLE)
    environment = {name: one for name, one in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    folder, count = done.stdout.split()
    assert not Path(folder).exists()
    assert int(count) == 1
    assert done.stderr.count("UserWarning") == 1
    assert (
        f"compiled kernels are kept in {folder} only until this program ends; set NUMBA_CACHE"
        in done.stderr
    )


def test_an_archive_is_refused_by_name(tmp_path):
    with zipfile.ZipFile(tmp_path / "swim.pyz", "w") as archive:
        archive.writestr("__main__.py", "import laticauda")
        for file in PACKAGE.rglob("*.py"):
            archive.write(file, Path("laticauda") / file.relative_to(PACKAGE))
    environment = {**os.environ, "PYTHONPATH": ""}
    done = subprocess.run(
        [sys.executable, tmp_path / "swim.pyz"], capture_output=True, text=True, env=environment
    )
    assert done.returncode != 0
    assert "ImportError: laticauda must be installed in a folder" in done.stderr
