"""Scenarios: everything that determines a run, as a value: what swims, how, where and by which model."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.scenarios.building import (
        Changes as Changes,
        Choice as Choice,
        Chosen as Chosen,
        ModelChanges as ModelChanges,
        Motion as Motion,
        build_scenario as build_scenario,
        default_water as default_water,
        environment_of as environment_of,
        model_of as model_of,
        named_after as named_after,
        preset_water as preset_water,
        water_for as water_for,
    )
    from laticauda.scenarios.scenario import (
        Experiment as Experiment,
        MODELS as MODELS,
        Model as Model,
        Planar as Planar,
        Scenario as Scenario,
        Spatial as Spatial,
        loop_in_words as loop_in_words,
        settings_of as settings_of,
    )
    from laticauda.scenarios.toml import (
        load_scenario as load_scenario,
        run_from_table as run_from_table,
        run_from_toml as run_from_toml,
        run_to_toml as run_to_toml,
        save_scenario as save_scenario,
        scenario_from_table as scenario_from_table,
        unknown_in as unknown_in,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.scenarios.building": [
            "Changes",
            "Choice",
            "Chosen",
            "ModelChanges",
            "Motion",
            "build_scenario",
            "default_water",
            "environment_of",
            "model_of",
            "named_after",
            "preset_water",
            "water_for",
        ],
        "laticauda.scenarios.scenario": [
            "Experiment",
            "MODELS",
            "Model",
            "Planar",
            "Scenario",
            "Spatial",
            "loop_in_words",
            "settings_of",
        ],
        "laticauda.scenarios.toml": [
            "load_scenario",
            "run_from_table",
            "run_from_toml",
            "run_to_toml",
            "save_scenario",
            "scenario_from_table",
            "unknown_in",
        ],
    },
)
