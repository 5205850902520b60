"""What section and environment make of a body: drag and added mass per element, and how a fin bends in water."""

from laticauda.hydrodynamics.coefficients import Coefficients, bending_frequencies, immersion_factor, link_coefficients
from laticauda.hydrodynamics.coefficients import mass_across, own, wake_mass

__all__ = ["Coefficients", "bending_frequencies", "immersion_factor", "link_coefficients"]
__all__ += ["mass_across", "own", "wake_mass"]
