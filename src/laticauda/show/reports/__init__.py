"""Results prepared for readers: a report, figures and tables in one folder."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.show.reports.chapter import (
        Chapter as Chapter,
        Row as Row,
        in_digits as in_digits,
        load_templates as load_templates,
        writable_folder as writable_folder,
        write_chapter as write_chapter,
    )
    from laticauda.show.reports.front import write_front_figure as write_front_figure
    from laticauda.show.reports.identify import (
        as_dict as as_dict,
        errors_of as errors_of,
        identification_tables as identification_tables,
        write_identification as write_identification,
    )
    from laticauda.show.reports.identify_figures import (
        parity as parity,
        short_names as short_names,
        shrinking as shrinking,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.show.reports.chapter": [
            "Chapter",
            "Row",
            "in_digits",
            "load_templates",
            "writable_folder",
            "write_chapter",
        ],
        "laticauda.show.reports.front": ["write_front_figure"],
        "laticauda.show.reports.identify": [
            "as_dict",
            "errors_of",
            "identification_tables",
            "write_identification",
        ],
        "laticauda.show.reports.identify_figures": ["parity", "short_names", "shrinking"],
    },
)
