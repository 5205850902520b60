"""From sections and dimensionless coefficients to loads: coefficients per link, and scalar laws per element."""

from laticauda.fluid.coefficients import Coefficients, immersion_factor, link_coefficients

__all__ = ["Coefficients", "immersion_factor", "link_coefficients"]
