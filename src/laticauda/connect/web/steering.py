"""Path following on a web page: one control instant as a formula, built from the functions of `laticauda.control`.

It is compiled in the same way as laws. The page itself stores data of variable length: waypoints,
and the headings of a gait cycle.
"""

# pyright: basic
# pyright: reportArgumentType=false, reportCallIssue=false

import inspect
import math
from collections import namedtuple
from dataclasses import replace
from typing import Any

import numpy as np
from numba import cfunc, types
from numba.extending import overload

from laticauda.compiling import INLINED, compiling_for
from laticauda.compiling.formulas import in_numbers, rows_from
from laticauda.connect.native import entry
from laticauda.control.guidance import (
    HeadingController,
    IntegralLineOfSight,
    extend_integral,
    mean_over,
)
from laticauda.control.paths import Polyline, seen_from
from laticauda.values.angles import wrap_to_pi, wrapped
from laticauda.values.formulas import Formula

# Current values; ends of the leg; first, second and last heading and start of the window; laws and
# their memory.
NUMBERS = (
    *("x", "y", "heading", "time", "x0", "y0", "x1", "y1"),
    *("t1", "heading1", "integral1", "t2", "heading2", "t3", "heading3", "integral3", "begin"),
    *("look_ahead_distance", "integral_gain", "gain", "max_offset", "integral", "is_saturated"),
)
NAME = "laticauda_steer"
"""Name of the compiled function."""
RESULTS = "offset", "is_saturated", "integral", "error", "heading_ref", "heading_integral", "beyond"
"""Names of the results of `instant`."""
_Legs, _Frame = (
    namedtuple("_Legs", "waypoints"),
    namedtuple("_Frame", "cross_track_error path_tangential_angle"),
)
_angle, _aim, _turn = Polyline.angle, IntegralLineOfSight.step, HeadingController.offset


def instant(s: Any) -> tuple[float, ...]:
    """Compute the `RESULTS` of a control instant of `PathFollowing`; `beyond` is the distance past the leg's end [m].

    Args:
        s: Object with the `NUMBERS` as attributes, in the units of `laticauda.control`.
    """
    now = s.time, s.heading, extend_integral((s.t3, s.heading3, s.integral3), s.time, s.heading)
    window = (s.t1, s.heading1, s.integral1), (s.t2, s.heading2, 0.0), now
    used = mean_over(window, s.begin) if s.time > s.begin else s.heading
    begin, end = (s.x0, s.y0), (s.x1, s.y1)
    angle = _angle(_Legs((begin, end)), 0)
    error, beyond = seen_from(begin, angle, (s.x, s.y))[1], seen_from(end, angle, (s.x, s.y))[0]
    frame, is_saturated = _Frame(error, wrap_to_pi(angle)), s.is_saturated != 0.0
    integral, heading_ref = _aim(s, s.integral, frame, used, s.time - s.t3, is_saturated)
    offset, is_saturated = _turn(s, heading_ref=heading_ref, heading=used)
    return offset, 1.0 if is_saturated else 0.0, integral, error, heading_ref, now[2], beyond


@overload(math.fmod)
def _fmod(x, y):  # Numba supports only NumPy's version
    return lambda x, y: np.fmod(x, y)


def bitcode() -> bytes:
    """Return the LLVM module of a function that reads `NUMBERS` from an address and writes `RESULTS` there."""
    target = entry.native_target()
    wrapping = target.kernel(inspect.unwrap(wrapped))  # type checks are not part of the formula
    with compiling_for(replace(target, formulas={**target.formulas, wrap_to_pi: wrapping})):
        inner = in_numbers(Formula(name="instant", function=instant, fields=NUMBERS), None, 0)
        numbers = rows_from(0, len(NUMBERS))

    @cfunc(types.void(types.CPointer(types.float64)), **INLINED, **entry.OWN)
    def steer(address):
        for i, result in enumerate(inner(*numbers(address))):
            address[i] = result

    return entry.exported(steer, NAME)
