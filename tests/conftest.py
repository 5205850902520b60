"""Set-up of all tests: shapes are checked at run time, and nothing is drawn on a screen.

Every module whose functions state array shapes is loaded through jaxtyping's hook, with beartype as the checker.
Modules that Numba compiles are left alone: the hook wraps functions, and Numba cannot compile the wrapper.
"""

import os
import signal
from pathlib import Path

import jaxtyping
from hypothesis import settings
from typechecker import shaped

SOURCES = Path(__file__).parent.parent / "src"

os.environ["MPLBACKEND"] = "Agg"
os.environ["NUMBA_NRT_STATS"] = "1"  # lets a test count the allocations of compiled code
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell starts its background jobs, and theirs, deaf to Ctrl-C
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("laticauda", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("laticauda")


def _states_shapes(path: Path) -> bool:
    text = path.read_text(encoding="utf-8")
    return "from jaxtyping import" in text and "njit" not in text


jaxtyping.jaxtyped = shaped  # what the hook's decorator is called by
jaxtyping.install_import_hook(
    [
        ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")
        for path in sorted(SOURCES.rglob("*.py"))
        if _states_shapes(path)
    ]
    + ["printed_equations"],
    "typechecker.check",
)
