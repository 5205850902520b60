"""Loads of water or ground on one element: drag laws as values, and the plate of a pectoral fin."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.water.fluid.laws import (
        CoulombFriction as CoulombFriction,
        DragLaw as DragLaw,
        Element as Element,
        FunctionDrag as FunctionDrag,
        PolynomialDrag as PolynomialDrag,
        TotalSpeedDrag as TotalSpeedDrag,
        ViscousFriction as ViscousFriction,
        plate as plate,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.water.fluid.laws": [
            "CoulombFriction",
            "DragLaw",
            "Element",
            "FunctionDrag",
            "PolynomialDrag",
            "TotalSpeedDrag",
            "ViscousFriction",
            "plate",
        ],
    },
)
