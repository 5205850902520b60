"""Loads of the water and of the ground on one element: drag laws as values, and the plate of a pectoral fin."""

from laticauda.fluid.laws import (
    CoulombFriction,
    DragLaw,
    Element,
    FunctionDrag,
    PolynomialDrag,
    ViscousFriction,
    plate,
)

__all__ = ["CoulombFriction", "DragLaw", "Element", "FunctionDrag", "PolynomialDrag", "ViscousFriction", "plate"]
