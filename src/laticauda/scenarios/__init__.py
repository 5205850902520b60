"""What decides a run, as a value: what swims, how, where and by which model."""

from laticauda.scenarios.building import Changes, ModelChanges, Motion, default_water, model_of, preset_water, scenario
from laticauda.scenarios.choice import Choice, Chosen, named_after
from laticauda.scenarios.models import MODELS, Model, Planar, Spatial
from laticauda.scenarios.scenario import Scenario

__all__ = [
    "MODELS",
    "Changes",
    "Choice",
    "Chosen",
    "Model",
    "ModelChanges",
    "Motion",
    "Planar",
    "Scenario",
    "Spatial",
    "default_water",
    "model_of",
    "named_after",
    "preset_water",
    "scenario",
]
