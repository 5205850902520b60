"""Loads of water or ground on one element: drag laws as values, and the plate of a pectoral fin."""

from laticauda.fluid.laws import (
    CoulombFriction as CoulombFriction,
    DragLaw as DragLaw,
    Element as Element,
)
from laticauda.fluid.laws import FunctionDrag as FunctionDrag, PolynomialDrag as PolynomialDrag
from laticauda.fluid.laws import (
    TotalSpeedDrag as TotalSpeedDrag,
    ViscousFriction as ViscousFriction,
    plate as plate,
)
from laticauda.packaging import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports()
