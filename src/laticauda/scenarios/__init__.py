"""Scenarios: everything that determines a run, as a value: what swims, how, where and by which model."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports
from laticauda.scenarios.building import Motion as Motion, scenario as scenario

if TYPE_CHECKING:
    from laticauda.scenarios.building import Changes as Changes, Choice as Choice, Chosen as Chosen
    from laticauda.scenarios.building import (
        ModelChanges as ModelChanges,
        default_water as default_water,
    )
    from laticauda.scenarios.building import environment_of as environment_of, model_of as model_of
    from laticauda.scenarios.building import (
        named_after as named_after,
        preset_water as preset_water,
    )
    from laticauda.scenarios.building import water_for as water_for
    from laticauda.scenarios.toml import (
        run_from_table as run_from_table,
        run_from_toml as run_from_toml,
    )
    from laticauda.scenarios.toml import run_to_toml as run_to_toml, unknown_in as unknown_in
    from laticauda.scenarios.scenario import (
        MODELS as MODELS,
        Experiment as Experiment,
        Model as Model,
    )
    from laticauda.scenarios.scenario import (
        Planar as Planar,
        Scenario as Scenario,
        Spatial as Spatial,
    )
    from laticauda.scenarios.scenario import (
        loop_in_words as loop_in_words,
        settings_of as settings_of,
    )
    from laticauda.scenarios.toml import (
        load_scenario as load_scenario,
        save_scenario as save_scenario,
    )
    from laticauda.scenarios.toml import scenario_from_table as scenario_from_table

__getattr__, __dir__, __all__ = lazy_exports()
