"""Measured trials in, physical parameters with their uncertainty out: `fit`. It needs the extra `identify`."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laticauda.identify.fitting import fit
    from laticauda.identify.measurements import Measurement, from_table1, from_trial
    from laticauda.identify.result import Estimate, Fit
    from laticauda.identify.unknowns import Unknown

_HOMES = {
    "fitting": ("fit",),
    "measurements": ("Measurement", "from_table1", "from_trial"),
    "result": ("Estimate", "Fit"),
    "unknowns": ("Unknown",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = ["Estimate", "Fit", "Measurement", "Unknown", "fit", "from_table1", "from_trial"]


def __getattr__(name: str) -> Any:
    # scipy and the kernels are loaded when something is first used.
    if name in _HOME_OF:
        return getattr(import_module(f"laticauda.identify.{_HOME_OF[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
