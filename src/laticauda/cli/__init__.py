"""The `laticauda` command: text in, one call, text out.

How a command line becomes a call:

1. `app` finds the command by its first words. ``commands.toml`` lists the class of each; only its
   module is imported.
2. The class is a declared value (`laticauda.values.quantities`): every field says its unit, range,
   text and default once. `declared_flags` makes a flag of each field; a field that holds a gait or
   water gives one flag per number of it. `flag_names` and ``flag_names.toml`` say how fields are
   spelled, `flag_types` how files and words are read, `number_flags` how numbers are.
3. The words that were typed become values in SI units, each checked against its declaration, and
   the values become the command: an instance of its class.
4. A command about a scenario is read twice (`scene`): first the names of robot, gait and water,
   since the flags of the second reading are the numbers of what they stand for.
5. `command.Command` checks the files that will be written, calls `run`, and prints its `Outcome`: a
   text for people (`report`, `tables`), or one JSON object in SI units.

A module has the name of its command; `studies` is sweep and optimize, and what they share is in
`vary`. `trial_output` writes what `swim`, `follow` and `replay` have made; `first_screen` is what they
print, and `short_forms` are what they also accept.

Where to add something:

- an option: a field in the class of the command; `shared_options` if several families have it. A
  field of a gait, a robot or water is an option by itself; if it should not be one, or be called
  otherwise, ``flag_names.toml`` says so;
- a command: a class derived from `command.Command`, or from `scene.OfScenario` if a scenario is run,
  and a line in ``commands.toml``;
- a column or a figure of the output: where the command makes its rows for `tables.format_table`; a
  figure of trials in `laticauda.trials.FIGURES`, from which the tables of trials are made;
- a column of the tables of studies: a figure that studies store (`FIGURES` in
  `laticauda.studies.point_trials`; `LABELS` there is its head), and its name in `SHOWN_OF_BEST` (of
  a sweep) or `SHOWN_OF_FRONT` in `studies`. A folder that lacks a new figure was begun by another
  release, and is not resumed: `check_same` in `laticauda.studies.folder` refuses it;
- a file format of trials: a subclass of `laticauda.trials.Format`. Outputs are checked against its
  ending, and the help of --save and `trial convert` lists it. Two sentences name formats
  by hand: the docstring of `trial.Convert` and the line of `trial convert` in ``commands.toml``;
- a condition that ends a run: not here, but in the package that runs it (`laticauda.models.simulate`,
  or `laticauda.tank.operate` for an operation); a number of it is an option by itself once
  a field of the scenario has it.

This module itself ends the program at Ctrl-C with a one-line message, even during imports and
compilation and where a C library prints exceptions that it cannot propagate, all of which would
print much more; a second Ctrl-C ends it at once. Only this module is imported before that.
"""

import gc
import os
import signal
import sys
import threading
from collections.abc import Sequence
from types import FrameType
from typing import Any

__all__ = ["main"]

NOT_INTERRUPTED = (
    "<frozen importlib",
    f"{os.sep}llvmlite{os.sep}",
    f"{os.sep}numba{os.sep}",
)
"""Parts of the file names of code that cannot be interrupted halfway: imports and the compiler."""
STATUS_STOPPED = 130
"""Exit status after Ctrl-C, as shells have it: 128 and the number of the signal."""


def main(args: Sequence[str] | None = None) -> int:
    """Run the program.

    Args:
        args: Arguments after the program name; None uses those of this process, which ends with
            this call.

    Returns:
        The exit status.
    """
    if args is None:
        # What is imported is no garbage; to look for some in it takes a sixth of the start. `app`
        # switches this on again before the command runs.
        gc.disable()
    if not _may_handle_interrupts():
        return _run(args)
    excepthook, unraisablehook = sys.excepthook, sys.unraisablehook

    def exit_or_print(kind: Any, error: Any, traceback: Any) -> None:
        if kind is KeyboardInterrupt:
            os._exit(_report_stop())
        excepthook(kind, error, traceback)

    def exit_or_report(event: Any) -> None:
        if event.exc_type is KeyboardInterrupt:
            os._exit(_report_stop())
        if not _is_stopping():  # else it is an error of an object that the stop left half-built
            unraisablehook(event)

    signal.signal(signal.SIGINT, _stop)
    sys.excepthook = exit_or_print
    sys.unraisablehook = exit_or_report
    try:
        return _run(args)
    finally:
        if _is_stopping():
            gc.collect()  # while errors of half-built objects are still suppressed
        if args is None:  # the process ends: no message any more
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        else:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        sys.excepthook = excepthook
        sys.unraisablehook = unraisablehook


def _may_handle_interrupts() -> bool:
    """Return whether Ctrl-C is ours to handle: in the main thread, unless somebody else handles it already."""
    is_main_thread = threading.current_thread() is threading.main_thread()
    return is_main_thread and signal.getsignal(signal.SIGINT) is signal.default_int_handler


def _run(args: Sequence[str] | None) -> int:
    try:
        from laticauda.cli import app

        return app.main(args)
    except KeyboardInterrupt:
        return _report_stop()


def _stop(number: int, frame: FrameType | None) -> None:
    """Interrupt the current work; during an import or compilation, exit instead: a partial result is of no use.

    A compiler that is interrupted inside its C code may crash when its objects are destroyed.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second Ctrl-C ends the program at once
    while frame is not None:
        if any(part in frame.f_code.co_filename for part in NOT_INTERRUPTED):
            os._exit(_report_stop())
        frame = frame.f_back
    raise KeyboardInterrupt


def _is_stopping() -> bool:
    """Return whether Ctrl-C was pressed: `_stop` has then given up its place as handler."""
    return signal.getsignal(signal.SIGINT) is signal.SIG_DFL


def _report_stop() -> int:
    print("laticauda: stopped.", file=sys.stderr, flush=True)
    return STATUS_STOPPED
