"""Make plants by name, and run them: `plant`, `run`, `swim`."""

from laticauda.simulate.many import Swims, swim_many
from laticauda.simulate.plants import MODELS, FluidLaw, needs_compiling, plant, plant_of
from laticauda.simulate.runner import resume, run
from laticauda.simulate.swimming import default_water, swim

__all__ = [
    "MODELS",
    "FluidLaw",
    "Swims",
    "default_water",
    "needs_compiling",
    "plant",
    "plant_of",
    "resume",
    "run",
    "swim",
    "swim_many",
]
