"""From a fitted film to forces, power and efficiency with intervals.

window       which part of a film the figures are of
assumptions  what is assumed of water and body, and draws of it
loads        forces and torques of every draw, and what the water does not explain
free_swim    how fast the model swims with the filmed joint angles
estimates    figures with median, interval and where it comes from
inverse      `find_forces`
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.forces.assumptions import Assumptions as Assumptions
    from laticauda.film.forces.estimates import Estimate as Estimate
    from laticauda.film.forces.inverse import FilmForces as FilmForces, find_forces as find_forces

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.forces.assumptions": ["Assumptions"],
        "laticauda.film.forces.estimates": ["Estimate"],
        "laticauda.film.forces.inverse": ["FilmForces", "find_forces"],
    },
)
