"""The efficiency study as one xarray Dataset, and as a netCDF file."""

# xarray's own annotations are partial: this module is the door of the studies to it.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.efficiency import Case, EfficiencyStudy
from laticauda.paper.settings import PARAMETERS

if TYPE_CHECKING:
    import xarray

QUANTITIES = {
    "forward_velocity": ("m/s", "forward velocity, straight line over the whole run"),
    "steady_velocity": ("m/s", "the same over whole gait cycles after the transient"),
    "mechanical_power": ("W", "mechanical power, mean of sum |u phi'|"),
}
UNITS = {"amplitude": "rad", "frequency": "rad/s", "phase_shift": "rad"}


def to_dataset(study: EfficiencyStudy) -> xarray.Dataset:
    """The study as an xarray Dataset.

    A sweep's curves are named after it, as in `forward_velocity_over_amplitude` with the dimensions model, group and
    amplitude. Table 1 has the dimension case; missing measurements are nan. SI units, angles in radians.

    Args:
        study: What `run_efficiency` returned.
    """
    import xarray

    coordinates: dict[str, Any] = {
        "model": list(study.models),
        "group": [group.name for group in study.settings.groups],
    }
    variables: dict[str, Any] = {}
    for sweep in study.sweeps:
        parameter = sweep.settings.parameter
        coordinates[parameter] = (parameter, sweep.values, {"units": UNITS[parameter]})
        for name, (unit, title) in QUANTITIES.items():
            attributes = {"units": unit, "long_name": title, **_fixed(sweep.settings.fixed)}
            variables[f"{name}_over_{parameter}"] = (("model", "group", parameter), getattr(sweep, name), attributes)
    variables |= _table(study.cases)
    how = {name: int(value) if isinstance(value, bool) else value for name, value in study.how.items()}
    attributes = {
        "title": "Efficiency study: Figs. 4 to 11 and Table 1 of the paper",
        "laticauda": study.version,
        "duration": study.settings.duration,
        **how,
    }
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def write_netcdf(study: EfficiencyStudy, path: str | Path) -> None:
    """Write the study to a netCDF file, which any netCDF tool opens.

    Args:
        study: What `run_efficiency` returned.
        path: The file; an older one of that name is replaced.
    """
    to_dataset(study).to_netcdf(path, engine="netcdf4")


def _fixed(fixed: Any) -> dict[str, str]:
    return {f"at_{name}": f"{value:.6g} {UNITS[name]}" for name, value in fixed.items()}


def _table(cases: tuple[Case, ...]) -> dict[str, Any]:
    """The rows of Table 1 as variables."""
    over_cases: dict[str, Any] = {
        "case_group": ("case", [case.group.name for case in cases]),
        "case_number": ("case", [case.index + 1 for case in cases], {"long_name": "number in Table 1"}),
        "case_starred": ("case", [case.starred or "" for case in cases], {"long_name": "fastest of this sweep"}),
    }
    for name in PARAMETERS:
        values = [getattr(case.gait, name) for case in cases]
        over_cases[f"case_{name}"] = ("case", values, {"units": UNITS[name]})
    for name, unit in (("measured_velocity", "m/s"), ("measured_power", "W")):
        values = np.array([getattr(case, name) for case in cases], dtype=float)
        over_cases[name] = ("case", values, {"units": unit})
    for name in ("forward_velocity", "mechanical_power"):
        values = np.array([getattr(case, name) for case in cases]).T
        over_cases[f"case_{name}"] = (("model", "case"), values, {"units": QUANTITIES[name][0]})
    return over_cases
