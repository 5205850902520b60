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
from laticauda.control import (
    HeadingController,
    HeadingSample,
    IntegralLineOfSight,
    Polyline,
    compute_mean_heading,
    extend_integral,
    transform_to_axes,
)
from laticauda.values import Formula, wrap_to_pi, wrapped

_CURRENT_VALUES = ("x", "y", "heading", "time")
_ENDS_OF_LEG = ("x0", "y0", "x1", "y1")
# The first, second and last heading, with their times and integrals, and the start of the window.
_HEADING_WINDOW = (
    "t1",
    "heading1",
    "integral1",
    "t2",
    "heading2",
    "t3",
    "heading3",
    "integral3",
    "begin",
)
_LAWS = ("look_ahead_distance", "integral_gain", "gain", "max_offset")
_MEMORY_OF_LAWS = ("integral", "is_saturated")
NUMBERS = (*_CURRENT_VALUES, *_ENDS_OF_LEG, *_HEADING_WINDOW, *_LAWS, *_MEMORY_OF_LAWS)
"""Names of the numbers that `instant` takes."""
RESULTS = (
    "offset",
    "is_saturated",
    "integral",
    "error",
    "heading_ref",
    "heading_integral",
    "beyond",
)
"""Names of the results of `instant`."""
ENTRY_FUNCTION = "laticauda_steer"
"""Name of the compiled function."""

# What the functions of `laticauda.control` read of a path, and of a robot's position relative to it.
_Legs = namedtuple("_Legs", "waypoints")
_Frame = namedtuple("_Frame", "cross_track_error path_tangential_angle")

_angle_of_leg = Polyline.angle
_reference_heading = IntegralLineOfSight.step
_offset_for_heading = HeadingController.offset


def instant(s: Any) -> tuple[float, ...]:
    """Compute the `RESULTS` of a control instant of `PathFollowing`; `beyond` is the distance past the leg's end [m].

    Args:
        s: Object with the `NUMBERS` as attributes, in the units of `laticauda.control`.
    """
    last = HeadingSample(s.t3, s.heading3, s.integral3)
    heading_integral = extend_integral(last, s.time, s.heading)
    first = HeadingSample(s.t1, s.heading1, s.integral1)
    second = HeadingSample(s.t2, s.heading2, 0.0)
    latest = HeadingSample(s.time, s.heading, heading_integral)
    heading = s.heading
    if s.time > s.begin:
        heading = compute_mean_heading((first, second, latest), s.begin)

    begin = (s.x0, s.y0)
    end = (s.x1, s.y1)
    position = (s.x, s.y)
    angle = _angle_of_leg(_Legs((begin, end)), 0)
    _, error = transform_to_axes(begin, angle, position)
    beyond, _ = transform_to_axes(end, angle, position)
    frame = _Frame(error, wrap_to_pi(angle))

    was_saturated = s.is_saturated != 0.0
    integral, heading_ref = _reference_heading(
        s, s.integral, frame, heading, s.time - s.t3, was_saturated
    )
    offset, is_saturated = _offset_for_heading(s, heading_ref=heading_ref, heading=heading)
    saturation = 1.0 if is_saturated else 0.0
    return offset, saturation, integral, error, heading_ref, heading_integral, beyond


@overload(math.fmod)
def _fmod(x, y):  # Numba supports only NumPy's version
    return lambda x, y: np.fmod(x, y)


def compile_bitcode() -> bytes:
    """Return the LLVM module of a function that reads `NUMBERS` from an address and writes `RESULTS` there."""
    target = entry.native_target()
    wrapping = target.kernel(inspect.unwrap(wrapped))  # type checks are not part of the formula
    formulas = {**target.formulas, wrap_to_pi: wrapping}
    formula = Formula(name="instant", function=instant, fields=NUMBERS)
    with compiling_for(replace(target, formulas=formulas)):
        compiled_instant = in_numbers(formula, None, 0)
        numbers = rows_from(0, len(NUMBERS))

    @cfunc(types.void(types.CPointer(types.float64)), **INLINED, **entry.OWN)
    def steer(address):
        for i, result in enumerate(compiled_instant(*numbers(address))):
            address[i] = result

    return entry.write_bitcode(steer, ENTRY_FUNCTION)
