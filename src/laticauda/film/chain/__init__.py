"""One fit of all frames of a film by a chain of links of fixed lengths.

geometry     where points of the chain are, and how they move with its coordinates
basis        functions of time: splines, and the harmonics of a gait
equations    what the points say of the unknowns, and what is known beforehand
arrow        equations of that shape: a band with a border
frequency    the frequency of the gait
first_guess  where the fit begins
fitting      `fit_chain`: the unknowns, and weights that the film itself decides
swimmers     animals as robots, from length, mass and profile
motion       a motion over time, of one or of many draws
result       `ChainFit`: what was found, and draws of whole motions
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.chain.fitting import fit_chain as fit_chain
    from laticauda.film.chain.geometry import PointPlaces as PointPlaces, places_at as places_at
    from laticauda.film.chain.motion import ChainMotion as ChainMotion
    from laticauda.film.chain.result import ChainFit as ChainFit
    from laticauda.film.chain.swimmers import (
        build_body as build_body,
        build_eel as build_eel,
        build_fish as build_fish,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.chain.fitting": ["fit_chain"],
        "laticauda.film.chain.geometry": ["PointPlaces", "places_at"],
        "laticauda.film.chain.motion": ["ChainMotion"],
        "laticauda.film.chain.result": ["ChainFit"],
        "laticauda.film.chain.swimmers": ["build_body", "build_eel", "build_fish"],
    },
)
