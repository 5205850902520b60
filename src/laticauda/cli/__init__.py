"""The command `laticauda`: text in, one call, text out.

Ctrl-C ends it with one line, in the midst of imports and compilers too, and where a library in C prints what it cannot
hand on, all of which would say much more; a second one ends it at once. Only this is imported before it listens.
"""

import gc
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Any

__all__ = ["main"]

COMPILERS = (f"{os.sep}llvmlite{os.sep}", f"{os.sep}numba{os.sep}")


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: The words behind the program's name; None takes those of this process, which ends with this call.

    Returns:
        The exit status.
    """
    usual, printing, before = signal.default_int_handler, sys.excepthook, sys.unraisablehook
    is_ours = signal.getsignal(signal.SIGINT) is usual and threading.current_thread() is threading.main_thread()
    if is_ours:
        signal.signal(signal.SIGINT, _stop)
        sys.excepthook = lambda kind, e, at: os._exit(_say()) if kind is KeyboardInterrupt else printing(kind, e, at)
        sys.unraisablehook = lambda lost: _lose(lost, before)
    try:
        from laticauda.cli import app

        return app.main(args)
    except KeyboardInterrupt:
        return _say()
    finally:
        if is_ours:
            if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
                gc.collect()  # while nobody says that half-made things break
            signal.signal(signal.SIGINT, signal.SIG_DFL if args is None else usual)
            sys.excepthook, sys.unraisablehook = printing, before


def _stop(number: int, frame: FrameType | None) -> None:
    """Interrupt what is done; while something is imported or compiled, end: half of it is of use to nobody.

    A compiler that is left in the midst of what it does in C may crash when its objects go.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    while frame is not None:
        if any(one in frame.f_code.co_filename for one in ("<frozen importlib", *COMPILERS)):
            os._exit(_say())
        frame = frame.f_back
    raise KeyboardInterrupt


def _lose(lost: Any, before: Callable[[Any], Any]) -> None:
    """End at an interrupt that cannot be handed on; of objects that it left half made nobody says that they break."""
    if lost.exc_type is KeyboardInterrupt:
        os._exit(_say())
    if signal.getsignal(signal.SIGINT) is not signal.SIG_DFL:
        before(lost)


def _say() -> int:
    print("laticauda: stopped.", file=sys.stderr, flush=True)
    return 130
