"""Set-up of all tests: shapes are checked at run time, and nothing is drawn on a screen.

Every module whose functions state array shapes is loaded through jaxtyping's hook, see `typechecker.check_shapes`.
"""

import os
import signal
from pathlib import Path

from hypothesis import settings
from typechecker import check_shapes

SOURCES = Path(__file__).parent.parent / "src"

os.environ["MPLBACKEND"] = "Agg"
os.environ["NUMBA_NRT_STATS"] = "1"  # lets a test count the allocations of compiled code
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell starts its background jobs, and theirs, deaf to Ctrl-C
    signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("laticauda", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("laticauda")
check_shapes(SOURCES, "printed_equations")
