"""Entry point of one drag law or flow for the water's callback: a function of two addresses, cached on disk.

This is a template (see `compiling.templates`). The first address holds the law's inputs, followed
by its loads; or position and time, followed by the flow felt there. The second holds the parameters
of the law, or of the flow's parts.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import numpy as np
from numba import carray, types  # pyright: ignore[reportPrivateImportUsage]

from laticauda.compiling import compile_scalar, for_c
from laticauda.compiling.formulas import PLACE, in_numbers, rows_from, summed
from laticauda.compiling.templates import bindings, named_after
from laticauda.values import MOST_NUMBERS
from laticauda.water.fluid.flow import Motion, local_flow
from laticauda.water.fluid.laws import MOTION, Element
from laticauda.water.mujoco.table import LOADS

ANY_SIZE = 1 << 40
"""Size of an array of as many numbers at an address as needed."""

_names = bindings(__name__)
_formula = _names.get("law")
_flow = summed(_names.get("flow", ()), len(Motion._fields))
_local_flow = compile_scalar(local_flow)
if _formula is not None:
    _law = in_numbers(_formula, Element, MOTION)
    _arguments = rows_from(0, LOADS)
    _own = rows_from(0, len(_formula.fields))


def _load(moving, numbers):
    a = carray(moving, (LOADS + 3,), np.float64)
    own = carray(numbers, (MOST_NUMBERS,), np.float64)
    a[LOADS], a[LOADS + 1], a[LOADS + 2] = _law(*_arguments(a), *_own(own))


def _motion(place, numbers):
    a = carray(place, (ANY_SIZE,), np.float64)
    own = carray(numbers, (ANY_SIZE,), np.float64)
    motion = _flow(own, 0, a[0], a[1], a[2], a[3])
    for k, component in enumerate(_local_flow(motion)):
        a[PLACE + k] = component


_numbers = types.CPointer(types.float64)
_digest = __name__[__name__.rindex("_") + 1 :]
_function = _load
if _formula is None:
    _function = _motion
call = for_c(types.void(_numbers, _numbers), named_after(_digest, _function))
