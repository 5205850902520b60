"""Make plants by name, and run them: `plant`, `run`, `swim`."""

from laticauda.simulate.plants import MODELS, plant
from laticauda.simulate.runner import resume, run
from laticauda.simulate.swimming import default_water, swim

__all__ = ["MODELS", "default_water", "plant", "resume", "run", "swim"]
