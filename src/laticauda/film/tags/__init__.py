"""Printed tags: which is where, the sheet to print, and finding them in a film.

layout     numbers, sizes and places of tags, and their file
sheet      the sheet to print, at true scale
detection  their corners in every frame of a film
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.film.tags.detection import (
        TagFilm as TagFilm,
        find_tags as find_tags,
        marks_of_floor as marks_of_floor,
    )
    from laticauda.film.tags.layout import (
        FloorTag as FloorTag,
        LinkTag as LinkTag,
        TagLayout as TagLayout,
        describe_placing as describe_placing,
        load_layout as load_layout,
        propose_layout as propose_layout,
        save_layout as save_layout,
    )
    from laticauda.film.tags.sheet import draw_sheet as draw_sheet, write_sheet as write_sheet

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.film.tags.detection": ["TagFilm", "find_tags", "marks_of_floor"],
        "laticauda.film.tags.layout": [
            "FloorTag",
            "LinkTag",
            "TagLayout",
            "describe_placing",
            "load_layout",
            "propose_layout",
            "save_layout",
        ],
        "laticauda.film.tags.sheet": ["draw_sheet", "write_sheet"],
    },
)
