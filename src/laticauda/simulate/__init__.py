"""Creating plants by name and running them: `plant`, `run`, `swim`, and `swim_many` for many runs at once."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.simulate.certainty import (
        intervals_of as intervals_of,
        figure_intervals as figure_intervals,
        widen_by_textbook_error as widen_by_textbook_error,
    )
    from laticauda.simulate.derivatives import (
        Sensitivities as Sensitivities,
        sensitivities as sensitivities,
    )
    from laticauda.simulate.many import Swims as Swims, swim_many as swim_many
    from laticauda.simulate.numbers import (
        Parameter as Parameter,
        list_parameters as list_parameters,
    )
    from laticauda.simulate.plants import (
        needs_compiling as needs_compiling,
        build_plant as build_plant,
    )
    from laticauda.simulate.runner import resume as resume, run as run, swim as swim
    from laticauda.simulate.several import swim_together as swim_together

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.simulate.certainty": [
            "intervals_of",
            "figure_intervals",
            "widen_by_textbook_error",
        ],
        "laticauda.simulate.derivatives": ["Sensitivities", "sensitivities"],
        "laticauda.simulate.many": ["Swims", "swim_many"],
        "laticauda.simulate.numbers": ["Parameter", "list_parameters"],
        "laticauda.simulate.plants": ["needs_compiling", "build_plant"],
        "laticauda.simulate.runner": ["resume", "run", "swim"],
        "laticauda.simulate.several": ["swim_together"],
    },
    renamed={
        "parameters": "list_parameters",
        "plant": "build_plant",
        "spread": "figure_intervals",
        "stated": "widen_by_textbook_error",
    },
)
