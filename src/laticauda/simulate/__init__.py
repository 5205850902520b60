"""Make plants by name, and run them: `plant`, `run`, `swim`, and `swim_many` for many at once."""

from typing import TYPE_CHECKING, Any

from laticauda.simulate.parameters import Parameter, parameters
from laticauda.simulate.plants import MODELS, FluidLaw, needs_compiling, plant, plant_of
from laticauda.simulate.runner import resume, run
from laticauda.simulate.sensitivities import Sensitivities, sensitivities
from laticauda.simulate.swimming import default_water, swim

if TYPE_CHECKING:
    from laticauda.simulate.many import Swims, swim_many

__all__ = [
    "MODELS",
    "FluidLaw",
    "Parameter",
    "Sensitivities",
    "Swims",
    "default_water",
    "needs_compiling",
    "parameters",
    "plant",
    "plant_of",
    "resume",
    "run",
    "sensitivities",
    "swim",
    "swim_many",
]


def __getattr__(name: str) -> Any:
    # What loads the compiler is imported when it is first used.
    if name in ("Swims", "swim_many"):
        from laticauda.simulate import many

        return getattr(many, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
