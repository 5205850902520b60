"""Scenarios: everything that determines a run, as a value: what swims, how, where and by which model.

scenario.py  what a run is: `Scenario`, its models, and `Experiment` for runs that cannot be repeated
building.py  scenarios from a robot, a gait and deviations from the defaults
waters.py    waters and grounds by default and by name
choice.py    the names with which a command or a file chooses robot, environment and model
toml.py      files that people write
stored.py    text with every number, as trials store it

interfaces.py      what plants and controllers exchange
vector_control.py  the same of many robots at once, as arrays

plausibility  whether a run can be meant: what cannot be is refused, of what hardly is there is a warning
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.scenarios.building import (
        Changes as Changes,
        ModelChanges as ModelChanges,
        SwimChanges as SwimChanges,
        Motion as Motion,
        build_scenario as build_scenario,
        model_of as model_of,
    )
    from laticauda.scenarios.choice import (
        Choice as Choice,
        Chosen as Chosen,
        identified_parameters as identified_parameters,
        take_identified_parameters as take_identified_parameters,
    )
    from laticauda.scenarios.plausibility import (
        Doubt as Doubt,
        judge_scenario as judge_scenario,
        limit_case as limit_case,
        check_described as check_described,
        check_many as check_many,
        check_plausible as check_plausible,
        telling as telling,
        warn_of_doubt as warn_of_doubt,
        warn_of_speed as warn_of_speed,
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
        NO_FILTER as NO_FILTER,
    )
    from laticauda.scenarios.stored import (
        run_from_table as run_from_table,
        run_from_toml as run_from_toml,
        run_to_toml as run_to_toml,
        unknown_in as unknown_in,
    )
    from laticauda.scenarios.vector_control import (
        Observations as Observations,
        VectorController as VectorController,
        Decisions as Decisions,
        REFERENCES as REFERENCES,
        STEERED as STEERED,
        OneByOne as OneByOne,
        check_decisions as check_decisions,
        vectorize_alike as vectorize_alike,
        is_vectorized as is_vectorized,
        kind_of_controller as kind_of_controller,
        vectorize as vectorize,
    )
    from laticauda.scenarios.toml import (
        load_scenario as load_scenario,
        save_scenario as save_scenario,
        scenario_from_table as scenario_from_table,
        NAMES as NAMES,
        take_chosen as take_chosen,
    )
    from laticauda.scenarios.waters import (
        default_water as default_water,
        environment_of as environment_of,
        named_after as named_after,
        preset_water as preset_water,
        water_for as water_for,
    )
    from laticauda.scenarios.interfaces import (
        Command as Command,
        Controller as Controller,
        EFFECTORS as EFFECTORS,
        ORIENTATION as ORIENTATION,
        Observation as Observation,
        OpenLoop as OpenLoop,
        Resumed as Resumed,
        SHORTEST_INTERVAL as SHORTEST_INTERVAL,
        Start as Start,
        check_waves as check_waves,
        decide as decide,
        fin_signals as fin_signals,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.scenarios.building": [
            "Changes",
            "ModelChanges",
            "SwimChanges",
            "Motion",
            "build_scenario",
            "model_of",
        ],
        "laticauda.scenarios.choice": ["Choice", "Chosen"],
        "laticauda.scenarios.plausibility": ["Doubt", "judge_scenario", "limit_case"],
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
        "laticauda.scenarios.stored": [
            "run_from_table",
            "run_from_toml",
            "run_to_toml",
            "unknown_in",
        ],
        "laticauda.scenarios.vector_control": ["Observations", "VectorController"],
        "laticauda.scenarios.toml": ["load_scenario", "save_scenario", "scenario_from_table"],
        "laticauda.scenarios.waters": [
            "default_water",
            "environment_of",
            "named_after",
            "preset_water",
            "water_for",
        ],
    },
    plain={
        "laticauda.scenarios.choice": [
            "identified_parameters",
            "take_identified_parameters",
        ],
        "laticauda.scenarios.interfaces": [
            "Command",
            "Controller",
            "EFFECTORS",
            "ORIENTATION",
            "Observation",
            "OpenLoop",
            "Resumed",
            "SHORTEST_INTERVAL",
            "Start",
            "check_waves",
            "decide",
            "fin_signals",
        ],
        "laticauda.scenarios.plausibility": [
            "check_described",
            "check_many",
            "check_plausible",
            "telling",
            "warn_of_doubt",
            "warn_of_speed",
        ],
        "laticauda.scenarios.scenario": ["NO_FILTER"],
        "laticauda.scenarios.toml": ["NAMES", "take_chosen"],
        "laticauda.scenarios.vector_control": [
            "Decisions",
            "REFERENCES",
            "STEERED",
            "OneByOne",
            "check_decisions",
            "vectorize_alike",
            "is_vectorized",
            "kind_of_controller",
            "vectorize",
        ],
    },
)
