"""Loads of water or ground on one element, and the motion of the water.

`laws` has drag laws as values and the plate of a pectoral fin, `inertia` the loads of added mass.
`flow` says what a flow is; `uniform`, `eddies`, `wake`, `waves` and `gridded` have the flows, the last one
with `grids` (reading them) and `cells` (interpolation). `arrows` and `surface` draw moving water.
"""

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
    from laticauda.water.fluid.arrows import Arrows as Arrows, arrows_of as arrows_of
    from laticauda.water.fluid.flow import Flow as Flow, Rows as Rows, rows_of as rows_of
    from laticauda.water.fluid.grids import Grid as Grid
    from laticauda.water.fluid.surface import (
        MOMENTS as MOMENTS,
        Surface as Surface,
        grid_points as grid_points,
        has_waves as has_waves,
        surface_elevation as surface_elevation,
    )
    from laticauda.water.fluid.wake import Wake as Wake, find_circulation as find_circulation
    from laticauda.water.fluid.waves import Waves as Waves

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
        "laticauda.water.fluid.arrows": ["Arrows", "arrows_of"],
        "laticauda.water.fluid.flow": ["Flow", "Rows", "rows_of"],
        "laticauda.water.fluid.grids": ["Grid"],
        "laticauda.water.fluid.laws": ["MOTION"],
        "laticauda.water.fluid.surface": [
            "MOMENTS",
            "Surface",
            "grid_points",
            "has_waves",
            "surface_elevation",
        ],
        "laticauda.water.fluid.wake": ["Wake", "find_circulation"],
        "laticauda.water.fluid.waves": ["Waves"],
    },
)
