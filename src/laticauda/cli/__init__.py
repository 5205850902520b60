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

NOT_INTERRUPTED = (
    "<frozen importlib",
    f"{os.sep}llvmlite{os.sep}",
    f"{os.sep}numba{os.sep}",
)
"""Parts of the file names of code that cannot be interrupted halfway: imports and the compiler."""


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: Arguments after the program name; None uses those of this process, which ends with
            this call.

    Returns:
        The exit status.
    """
    usual_handler = signal.default_int_handler
    excepthook, unraisablehook = sys.excepthook, sys.unraisablehook
    is_main_thread = threading.current_thread() is threading.main_thread()
    is_ours = is_main_thread and signal.getsignal(signal.SIGINT) is usual_handler

    def exit_or_print(kind: Any, error: Any, traceback: Any) -> None:
        if kind is KeyboardInterrupt:
            os._exit(_report_stop())
        excepthook(kind, error, traceback)

    if is_ours:
        signal.signal(signal.SIGINT, _stop)
        sys.excepthook = exit_or_print
        sys.unraisablehook = lambda event: _suppress_or_report(event, unraisablehook)
    try:
        from laticauda.cli import app

        return app.main(args)
    except KeyboardInterrupt:
        return _report_stop()
    finally:
        if is_ours:
            if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
                gc.collect()  # while errors of half-built objects are still suppressed
            signal.signal(signal.SIGINT, signal.SIG_DFL if args is None else usual_handler)
            sys.excepthook = excepthook
            sys.unraisablehook = unraisablehook


def _stop(number: int, frame: FrameType | None) -> None:
    """Interrupt the current work; during an import or compilation, exit instead: a partial result is of no use.

    A compiler that is interrupted inside its C code may crash when its objects are destroyed.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    while frame is not None:
        if any(part in frame.f_code.co_filename for part in NOT_INTERRUPTED):
            os._exit(_report_stop())
        frame = frame.f_back
    raise KeyboardInterrupt


def _suppress_or_report(event: Any, report: Callable[[Any], Any]) -> None:
    """Exit on an interrupt that cannot be propagated; suppress errors of the objects that it left half-built."""
    if event.exc_type is KeyboardInterrupt:
        os._exit(_report_stop())
    if signal.getsignal(signal.SIGINT) is not signal.SIG_DFL:
        report(event)


def _report_stop() -> int:
    print("laticauda: stopped.", file=sys.stderr, flush=True)
    return 130
