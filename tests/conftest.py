"""Set-up of all tests: shapes are checked at run time, and nothing is drawn on a screen.

Every module whose functions state array shapes is loaded through jaxtyping's hook, with beartype as the checker.
Modules that Numba compiles are left alone: the hook wraps functions, and Numba cannot compile the wrapper.
"""

import os
from pathlib import Path

from hypothesis import settings
from jaxtyping import install_import_hook

SOURCES = Path(__file__).parent.parent / "src"

os.environ["MPLBACKEND"] = "Agg"
os.environ["NUMBA_NRT_STATS"] = "1"  # lets a test count the allocations of compiled code
settings.register_profile("laticauda", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("laticauda")


def _states_shapes(path: Path) -> bool:
    text = path.read_text(encoding="utf-8")
    return "from jaxtyping import" in text and "njit" not in text


install_import_hook(
    [
        ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")
        for path in sorted(SOURCES.rglob("*.py"))
        if _states_shapes(path)
    ],
    "typechecker.check",
)
