"""Results prepared for readers: a report, figures and tables in one folder.

- `chapter`: a chapter of a report, and how it is written
- `cells`: numbers and tables on a page and in CSV files
- `identify`: folder and page of an identification; `identify_tables`: its tables;
  `identify_figures`: its figures; `identify_axes`: what is drawn on their axes
- `parameter_names`: names of parameters, short enough for a figure
- `design`: drawing of a designed robot beside the one with which a search began
- `front`: figure of an optimization; `front_axes`: its fronts; `front_bodies`: its bodies
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.reports.cells import (
        Row as Row,
        format_number as format_number,
        write_csv as write_csv,
    )
    from laticauda.show.reports.chapter import (
        Chapter as Chapter,
        ReportFigure as ReportFigure,
        load_templates as load_templates,
        make_writable_folder as make_writable_folder,
        write_chapter as write_chapter,
    )
    from laticauda.show.reports.design import (
        draw_design_sheet as draw_design_sheet,
        write_design_sheet as write_design_sheet,
    )
    from laticauda.show.reports.front import (
        draw_front_sheet as draw_front_sheet,
        write_front_figure as write_front_figure,
    )
    from laticauda.show.reports.identify import (
        describe_identification as describe_identification,
        write_identification as write_identification,
    )
    from laticauda.show.reports.identify_axes import (
        Mark as Mark,
        draw_expected_deviations as draw_expected_deviations,
        draw_parity as draw_parity,
    )
    from laticauda.show.reports.identify_tables import (
        list_errors as list_errors,
        list_identification_tables as list_identification_tables,
    )
    from laticauda.show.reports.parameter_names import shorten_names as shorten_names

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.show.reports.cells": ["Row", "format_number", "write_csv"],
        "laticauda.show.reports.chapter": [
            "Chapter",
            "ReportFigure",
            "load_templates",
            "make_writable_folder",
            "write_chapter",
        ],
        "laticauda.show.reports.design": ["draw_design_sheet", "write_design_sheet"],
        "laticauda.show.reports.front": ["draw_front_sheet", "write_front_figure"],
        "laticauda.show.reports.identify": ["describe_identification", "write_identification"],
        "laticauda.show.reports.identify_axes": [
            "Mark",
            "draw_expected_deviations",
            "draw_parity",
        ],
        "laticauda.show.reports.identify_tables": ["list_errors", "list_identification_tables"],
        "laticauda.show.reports.parameter_names": ["shorten_names"],
    },
)
