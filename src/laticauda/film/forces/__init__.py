"""From a fitted film to forces, power and efficiency with intervals.

arguments    what they may be, checked before the work
window       which part of a film the figures are of
assumptions  what is assumed of water and body, and draws of it
loads        forces and torques of every draw, and what the water does not explain
free_swim    how fast the model swims with the filmed joint angles
estimates    figures with median, interval and where it comes from
inverse      `find_forces`
from_points  `invert_points`: from tracked points in one call
stretch      whether lengths in the film are those of the body
doubts       signs that a figure may be wrong
progress     shares of the parts in the whole work
measured     films as measurements for `laticauda.identify`
words        a filmed swim in words
picture      its figure
chain_picture  the chain over the points
page         a page with its results
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.forces.assumptions import Assumptions as Assumptions
    from laticauda.film.forces.doubts import list_doubts as list_doubts
    from laticauda.film.forces.estimates import Estimate as Estimate
    from laticauda.film.forces.from_points import (
        guess_places as guess_places,
        invert_points as invert_points,
        points_of_trial as points_of_trial,
        scale_points as scale_points,
    )
    from laticauda.film.forces.inverse import FilmForces as FilmForces, find_forces as find_forces
    from laticauda.film.forces.measured import measure_glide as measure_glide
    from laticauda.film.forces.page import write_page as write_page
    from laticauda.film.forces.picture import draw_forces as draw_forces
    from laticauda.film.forces.words import list_remarks as list_remarks, summarize as summarize

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.forces.assumptions": ["Assumptions"],
        "laticauda.film.forces.doubts": ["list_doubts"],
        "laticauda.film.forces.estimates": ["Estimate"],
        "laticauda.film.forces.from_points": [
            "guess_places",
            "invert_points",
            "points_of_trial",
            "scale_points",
        ],
        "laticauda.film.forces.inverse": ["FilmForces", "find_forces"],
        "laticauda.film.forces.measured": ["measure_glide"],
        "laticauda.film.forces.page": ["write_page"],
        "laticauda.film.forces.picture": ["draw_forces"],
        "laticauda.film.forces.words": ["list_remarks", "summarize"],
    },
)
