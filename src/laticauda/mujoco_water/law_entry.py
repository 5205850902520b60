"""The door of one drag law for the water's callback: a function of two addresses, kept on disk.

A template (see `functions`): what moves stands at the first address, and the loads go behind it; the law's own numbers
stand at the second.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false

import numpy as np
from numba import (
    carray,  # pyright: ignore[reportPrivateImportUsage]
    cfunc,
    types,
)

from laticauda.compiling.formulas import in_numbers, rows_from
from laticauda.compiling.lanes import OPTIONS
from laticauda.compiling.templates import bindings, named_after
from laticauda.fluid.laws import MOTION, Element
from laticauda.formulas import MOST_NUMBERS
from laticauda.mujoco_water.table import LOADS

_formula = bindings(__name__)["law"]
_law = in_numbers(_formula, Element, MOTION)
_given, _own = rows_from(0, LOADS), rows_from(0, len(_formula.fields))


def _call(moving, numbers):
    a, own = carray(moving, (LOADS + 3,), np.float64), carray(numbers, (MOST_NUMBERS,), np.float64)
    a[LOADS], a[LOADS + 1], a[LOADS + 2] = _law(*_given(a), *_own(own))


_numbers = types.CPointer(types.float64)
call = cfunc(types.void(_numbers, _numbers), cache=True, **OPTIONS)(
    named_after(__name__[__name__.rindex("_") + 1 :], _call)
)
