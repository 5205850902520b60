"""Loads of water or ground on one element: drag laws as values, and the plate of a pectoral fin."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

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
        MOTION as MOTION,
    )
    from laticauda.water.fluid.arrows import (
        Arrows as Arrows,
        MOMENTS as MOMENTS,
        Surface as Surface,
        arrows_of as arrows_of,
        grid_points as grid_points,
        has_waves as has_waves,
        surface_elevation as surface_elevation,
    )
    from laticauda.water.fluid.flow import Flow as Flow, Rows as Rows, rows_of as rows_of
    from laticauda.water.fluid.gridded import Grid as Grid

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
    plain={
        "laticauda.water.fluid.arrows": [
            "Arrows",
            "MOMENTS",
            "Surface",
            "arrows_of",
            "grid_points",
            "has_waves",
            "surface_elevation",
        ],
        "laticauda.water.fluid.flow": ["Flow", "Rows", "rows_of"],
        "laticauda.water.fluid.gridded": ["Grid"],
        "laticauda.water.fluid.laws": ["MOTION"],
    },
)
