"""Set-up of all tests: shapes are checked at run time, and nothing is drawn on a screen.

Every module whose functions state array shapes is loaded through jaxtyping's hook, see
`typechecker.check_shapes`.
"""

import gc
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import threads  # noqa: F401, it acts by being imported
from hypothesis import settings
from typechecker import check_shapes, next_test

SOURCES = Path(__file__).parent.parent / "src"

# Python keeps what it compiles, also of the programs that tests start, whatever the shell says: it
# is half their time.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
gc.set_threshold(10_000, 20, 20)  # tests and modules live as long as the process
os.environ["MPLBACKEND"] = "Agg"
os.environ["NUMBA_NRT_STATS"] = "1"  # lets a test count the allocations of compiled code
if (
    signal.getsignal(signal.SIGINT) is signal.SIG_IGN
):  # a shell starts its background jobs, and theirs, deaf to Ctrl-C
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("laticauda", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("laticauda")
check_shapes(SOURCES, "printed_equations")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Begin to count calls, see `typechecker`."""
    next_test()


@pytest.fixture
def limit_case() -> Iterator[None]:
    """Let a test describe what cannot be: water without mass, motors without limits, a gait beyond all reason."""
    from laticauda.scenarios import limit_case  # after the hook of the shapes

    with limit_case():
        yield


def pytest_sessionstart(session: pytest.Session) -> None:
    """Take over what other clones have compiled; the workers begin after this."""
    if not hasattr(session.config, "workerinput"):
        import kernels

        kernels.fetch()


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Keep what was compiled for other clones."""
    if not hasattr(session.config, "workerinput"):
        import kernels

        kernels.keep()
