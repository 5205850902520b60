"""The `laticauda` command: text in, one call, text out.

Ctrl-C ends the program with a one-line message, even during imports and compilation and where a C
library prints exceptions that it cannot propagate, all of which would print much more; a second
Ctrl-C ends it at once. Only this module is imported before the handler is installed.
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
        args: Arguments after the program name; None uses those of this process, which ends with
            this call.

    Returns:
        The exit status.
    """
    usual, printing, before = signal.default_int_handler, sys.excepthook, sys.unraisablehook
    is_ours = (
        signal.getsignal(signal.SIGINT) is usual
        and threading.current_thread() is threading.main_thread()
    )
    if is_ours:
        signal.signal(signal.SIGINT, _stop)
        sys.excepthook = lambda kind, e, at: (
            os._exit(_say()) if kind is KeyboardInterrupt else printing(kind, e, at)
        )
        sys.unraisablehook = lambda lost: _lose(lost, before)
    try:
        from laticauda.cli import app

        return app.main(args)
    except KeyboardInterrupt:
        return _say()
    finally:
        if is_ours:
            if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
                gc.collect()  # while errors of half-built objects are still suppressed
            signal.signal(signal.SIGINT, signal.SIG_DFL if args is None else usual)
            sys.excepthook, sys.unraisablehook = printing, before


def _stop(number: int, frame: FrameType | None) -> None:
    """Interrupt the current work; during an import or compilation, exit instead: a partial result is of no use.

    A compiler that is interrupted inside its C code may crash when its objects are destroyed.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    while frame is not None:
        if any(one in frame.f_code.co_filename for one in ("<frozen importlib", *COMPILERS)):
            os._exit(_say())
        frame = frame.f_back
    raise KeyboardInterrupt


def _lose(lost: Any, before: Callable[[Any], Any]) -> None:
    """Exit on an interrupt that cannot be propagated; suppress errors of the objects that it left half-built."""
    if lost.exc_type is KeyboardInterrupt:
        os._exit(_say())
    if signal.getsignal(signal.SIGINT) is not signal.SIG_DFL:
        before(lost)


def _say() -> int:
    print("laticauda: stopped.", file=sys.stderr, flush=True)
    return 130
