"""What was run beyond the paper as one xarray Dataset, and as a netCDF file."""

# xarray's own annotations are partial: this module is a door of the studies to it.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.beyond import BeyondStudy

if TYPE_CHECKING:
    import xarray

    from laticauda.trial.cycles import CycleMean


def beyond_dataset(study: BeyondStudy) -> xarray.Dataset:
    """The study as an xarray Dataset.

    Names begin with `drift_`, `curved_` or `turning_`. Errors are means over the gait cycle around each moment; runs of
    unequal length end in nan. SI units, angles in radians.

    Args:
        study: What `run_beyond` returned.
    """
    import xarray

    settings = study.settings
    coordinates: dict[str, Any] = {
        "drift_law": [run.law.name for run in study.drift],
        "curved_swimmer": [run.swimmer.name for run in study.curved],
        "turning_swimmer": [curve.swimmer.name for curve in study.turning],
        "offset": ("offset", np.array(settings.turning.offsets), {"units": "rad"}),
    }
    variables: dict[str, Any] = {}
    for part, axis, runs in (("drift", "drift_law", study.drift), ("curved", "curved_swimmer", study.curved)):
        coordinates[f"{part}_time"] = (f"{part}_time", _longest_time([run.error for run in runs]), {"units": "s"})
        errors = _padded([run.error.value for run in runs])
        attributes = {"units": "m", "long_name": "cycle-mean cross-track error"}
        variables[f"{part}_error"] = ((axis, f"{part}_time"), errors, attributes)
    along = _padded([run.along for run in study.curved])
    attributes = {"units": "m", "long_name": "cycle mean of the distance along the curve"}
    variables["curved_along"] = (("curved_swimmer", "curved_time"), along, attributes)
    for name, unit in (("turning_rate", "rad/s"), ("radius", "m"), ("path_speed", "m/s"), ("mechanical_power", "W")):
        values = np.array([getattr(curve, name) for curve in study.turning])
        key = name if name.startswith("turning") else f"turning_{name}"
        variables[key] = (("turning_swimmer", "offset"), values, {"units": unit})
    attributes = {
        "title": "Beyond the paper: a cross current, a curved path, open-loop turning; simulation only",
        "laticauda": study.version,
        "drift_current": np.array(settings.drift.current),
        "curved_waypoints": np.array(settings.curved.waypoints).ravel(),
        "turning_duration": settings.turning.duration,
        **study.how,
    }
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def write_beyond_netcdf(study: BeyondStudy, path: str | Path) -> None:
    """Write the study to a netCDF file, which any netCDF tool opens.

    Args:
        study: What `run_beyond` returned.
        path: The file; an older one of that name is replaced.
    """
    beyond_dataset(study).to_netcdf(path, engine="netcdf4")


def _longest_time(errors: Sequence[CycleMean]) -> np.ndarray:
    """The times of the longest run: all runs are sampled alike from their start."""
    return max((error.time for error in errors), key=lambda time: time.size, default=np.zeros(0))


def _padded(rows: Sequence[np.ndarray]) -> np.ndarray:
    """One row per run, ended by nan where it was shorter."""
    table = np.full((len(rows), max((row.size for row in rows), default=0)), np.nan)
    for i, row in enumerate(rows):
        table[i, : row.size] = row
    return table
