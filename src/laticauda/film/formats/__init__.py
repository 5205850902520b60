"""Files of programs that track points in films, see `read_points`.

format        what every format is, and what one file holds
reading       from a file to the points of one individual
plausibility  what no body in a film does
contents      HDF5, archives of NumPy, pickled arrays
deeplabcut, sleap, trex, idtracker, plain   the formats
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.formats.format import (
        PointFormat as PointFormat,
        PointsFile as PointsFile,
        TrackedIndividual as TrackedIndividual,
    )
    from laticauda.film.formats.reading import read_points as read_points

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.formats.format": ["PointFormat", "PointsFile", "TrackedIndividual"],
        "laticauda.film.formats.reading": ["read_points"],
    },
)
