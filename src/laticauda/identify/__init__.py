"""Measured trials in, physical parameters with their uncertainty out: `fit`. It needs the extra `identify`."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laticauda.identify.fitting import fit
    from laticauda.identify.measurements import Measurement, from_table1, from_trial
    from laticauda.identify.paper import paper_procedure
    from laticauda.identify.result import Estimate, Fit
    from laticauda.identify.uncertainty import posterior, profile
    from laticauda.identify.unknowns import Unknown
    from laticauda.identify.validation import compared_with_null_models, leave_out, linear_leave_one_out

_HOMES = {
    "fitting": ("fit",),
    "measurements": ("Measurement", "from_table1", "from_trial"),
    "paper": ("paper_procedure",),
    "result": ("Estimate", "Fit"),
    "uncertainty": ("posterior", "profile"),
    "unknowns": ("Unknown",),
    "validation": ("compared_with_null_models", "leave_out", "linear_leave_one_out"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Estimate",
    "Fit",
    "Measurement",
    "Unknown",
    "compared_with_null_models",
    "fit",
    "from_table1",
    "from_trial",
    "leave_out",
    "linear_leave_one_out",
    "paper_procedure",
    "posterior",
    "profile",
]


def __getattr__(name: str) -> Any:
    # scipy and the kernels are loaded when something is first used.
    if name in _HOME_OF:
        return getattr(import_module(f"laticauda.identify.{_HOME_OF[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
