"""What decides a run, as a value: what swims, how, where and by which model."""

from laticauda.scenarios.building import Changes, ModelChanges, Motion, default_water, model_of, preset_water, scenario
from laticauda.scenarios.building import Choice, Chosen, named_after
from laticauda.scenarios.coding import run_from_table, run_from_toml, run_to_toml, unknown_in
from laticauda.scenarios.scenario import Experiment
from laticauda.scenarios.scenario import MODELS, Model, Planar, Spatial, settings_of
from laticauda.scenarios.scenario import Scenario
from laticauda.scenarios.scenario_files import load_scenario, save_scenario, scenario_from_table

__all__ = [
    "MODELS",
    "Changes",
    "Choice",
    "Chosen",
    "Experiment",
    "Model",
    "ModelChanges",
    "Motion",
    "Planar",
    "Scenario",
    "Spatial",
    "default_water",
    "load_scenario",
    "model_of",
    "named_after",
    "preset_water",
    "run_from_table",
    "run_from_toml",
    "run_to_toml",
    "save_scenario",
    "scenario",
    "scenario_from_table",
    "settings_of",
    "unknown_in",
]
