"""From sections and dimensionless coefficients to loads: coefficients per link, and scalar laws per element."""

from laticauda.fluid.bending import bending_frequencies
from laticauda.fluid.coefficients import Coefficients, immersion_factor, link_coefficients
from laticauda.fluid.laws import coulomb_friction, magnitude, plate, polynomial_drag

__all__ = [
    "Coefficients",
    "bending_frequencies",
    "coulomb_friction",
    "immersion_factor",
    "link_coefficients",
    "magnitude",
    "plate",
    "polynomial_drag",
]
