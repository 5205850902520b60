"""From film to forces: bodies that were tracked on video; needs the extra `film`.

- points: points tracked on one body, what all else here takes and returns
- calibration: from pixels to metres
- tags: printed tags, and finding them in a film
- tracking: from tags or points to a trial
- vision: OpenCV
- example_films: two short films to try
- formats: files of DeepLabCut, SLEAP, TRex, idtracker.ai, and plain tables of points
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.example_films import write_example as write_example
    from laticauda.film.formats.reading import read_points as read_points
    from laticauda.film.points import TrackedPoints as TrackedPoints

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.example_films": ["write_example"],
        "laticauda.film.formats.reading": ["read_points"],
        "laticauda.film.points": ["TrackedPoints"],
    },
)
