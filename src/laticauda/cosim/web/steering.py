"""Path following on a page: a control instant as a formula of numbers, made of what `laticauda.control` computes with.

It is compiled as laws are. The page itself keeps what varies in length: waypoints, and the headings of a gait cycle.
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

from laticauda.angles import wrap_to_pi, wrapped
from laticauda.compiling import INLINED, compiling_for
from laticauda.compiling.formulas import in_numbers, rows_from
from laticauda.control.guidance import HeadingController, IntegralLineOfSight, grown, mean_over
from laticauda.control.paths import Polyline, seen_from
from laticauda.cosim.native import entry
from laticauda.formulas import Formula

# Now; the leg's ends; of the window first, second and last heading, and where it begins; laws, and what they remember.
NUMBERS = (
    *("x", "y", "heading", "time", "x0", "y0", "x1", "y1"),
    *("t1", "heading1", "integral1", "t2", "heading2", "t3", "heading3", "integral3", "begin"),
    *("look_ahead_distance", "integral_gain", "gain", "max_offset", "integral", "is_saturated"),
)
NAME = "laticauda_steer"
"""What it is called."""
RESULTS = "offset", "is_saturated", "integral", "error", "heading_ref", "heading_integral", "beyond"
"""Of `instant`."""
_Legs, _Frame = namedtuple("_Legs", "waypoints"), namedtuple("_Frame", "cross_track_error path_tangential_angle")
_angle, _aim, _turn = Polyline.angle, IntegralLineOfSight.step, HeadingController.offset


def instant(s: Any) -> tuple[float, ...]:
    """The `RESULTS` of a control instant of `PathFollowing`; `beyond` is how far the end of the leg is behind [m].

    Args:
        s: What has the `NUMBERS`, with the units of `laticauda.control`.
    """
    now = s.time, s.heading, grown((s.t3, s.heading3, s.integral3), s.time, s.heading)
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
def _fmod(x, y):  # Numba knows that of NumPy only
    return lambda x, y: np.fmod(x, y)


def bitcode() -> bytes:
    """LLVM's module with a function of an address, where it takes `NUMBERS` and leaves `RESULTS`."""
    target = entry.target()
    wrapping = target.kernel(inspect.unwrap(wrapped))  # checks of types are no formula
    with compiling_for(replace(target, formulas={**target.formulas, wrap_to_pi: wrapping})):
        inner = in_numbers(Formula(name="instant", function=instant, fields=NUMBERS), None, 0)
        numbers = rows_from(0, len(NUMBERS))

    @cfunc(types.void(types.CPointer(types.float64)), **INLINED, **entry.OWN)
    def steer(address):
        for i, result in enumerate(inner(*numbers(address))):
            address[i] = result

    return entry.exported(steer, NAME)
