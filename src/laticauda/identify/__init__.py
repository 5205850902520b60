"""Identify physical parameters and their uncertainty from measured trials (`fit`); needs the extra `identify`."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.identify.fitting import fit as fit
    from laticauda.identify.measurements import Measurement as Measurement, from_trial as from_trial
    from laticauda.identify.result import Fit as Fit, ParameterEstimate as ParameterEstimate
    from laticauda.identify.tables import from_table as from_table, from_table1 as from_table1
    from laticauda.identify.tasks import TrialFile as TrialFile, compare_laws as compare_laws
    from laticauda.identify.uncertainty import (
        sample_posterior as sample_posterior,
        profile_interval as profile_interval,
    )
    from laticauda.identify.unknowns import Unknown as Unknown
    from laticauda.identify.validation import (
        compared_with_null_models as compared_with_null_models,
        leave_out as leave_out,
        linear_leave_one_out as linear_leave_one_out,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.identify.fitting": ["fit"],
        "laticauda.identify.measurements": ["Measurement", "from_trial"],
        "laticauda.identify.result": ["Fit", "ParameterEstimate"],
        "laticauda.identify.tables": ["from_table", "from_table1"],
        "laticauda.identify.tasks": ["TrialFile", "compare_laws"],
        "laticauda.identify.uncertainty": ["sample_posterior", "profile_interval"],
        "laticauda.identify.unknowns": ["Unknown"],
        "laticauda.identify.validation": [
            "compared_with_null_models",
            "leave_out",
            "linear_leave_one_out",
        ],
    },
    renamed={"posterior": "sample_posterior", "profile": "profile_interval"},
)
