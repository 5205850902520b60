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

_names = bindings(__name__)
_formula, _flow = _names.get("law"), summed(_names.get("flow", ()), len(Motion._fields))
_felt, _any = compile_scalar(local_flow), 1 << 40  # as many numbers at an address as needed
if _formula is not None:
    _law, _given, _own = (
        in_numbers(_formula, Element, MOTION),
        rows_from(0, LOADS),
        rows_from(0, len(_formula.fields)),
    )


def _load(moving, numbers):
    a, own = carray(moving, (LOADS + 3,), np.float64), carray(numbers, (MOST_NUMBERS,), np.float64)
    a[LOADS], a[LOADS + 1], a[LOADS + 2] = _law(*_given(a), *_own(own))


def _motion(place, numbers):
    a = carray(place, (_any,), np.float64)
    for k, one in enumerate(
        _felt(_flow(carray(numbers, (_any,), np.float64), 0, a[0], a[1], a[2], a[3]))
    ):
        a[PLACE + k] = one


_numbers = types.CPointer(types.float64)
_named = named_after(__name__[__name__.rindex("_") + 1 :], _motion if _formula is None else _load)
call = for_c(types.void(_numbers, _numbers), _named)
