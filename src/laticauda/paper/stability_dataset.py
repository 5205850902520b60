"""The stability maps as one xarray Dataset, and as a netCDF file."""

# xarray's own annotations are partial: this module is a door of the studies to it.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.stability import BEHAVIORS, StabilityStudy

if TYPE_CHECKING:
    import xarray

QUANTITIES = {
    "rms": ("m", "root mean square of the cycle-mean cross-track error over the last third of the run"),
    "rms_before": ("m", "the same over the second third"),
    "forward_velocity": ("m/s", "forward velocity, straight line over the whole run"),
}


def stability_dataset(study: StabilityStudy) -> xarray.Dataset:
    """The study as an xarray Dataset.

    The names end in `_cycle_mean` or `_raw`, after the heading that was used; each has its own gains. A behavior is the
    index of its name in the attribute `behaviors`. SI units.

    Args:
        study: What `run_stability` returned.
    """
    import xarray

    settings = study.settings
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {
        "swimmer": [found.swimmer.name for found in study.maps],
        "robot_length": ("swimmer", [found.swimmer.length for found in study.maps], {"units": "m"}),
        "look_ahead_distance": ("look_ahead_distance", np.array(settings.look_ahead_distances), {"units": "m"}),
    }
    for kind, gains in (("cycle_mean", settings.gains), ("raw", settings.raw_gains)):
        axis = f"gain_{kind}"
        coordinates[axis] = (axis, np.array(gains, dtype=float), {"units": "1"})
        axes = ("swimmer", "look_ahead_distance", axis)
        loops = [getattr(found, kind) for found in study.maps]
        for name, (unit, title) in QUANTITIES.items():
            values = np.array([getattr(loop, name) for loop in loops])
            variables[f"{name}_{kind}"] = (axes, values, {"units": unit, "long_name": title})
        codes = [[[BEHAVIORS.index(one) for one in row] for row in loop.behaviors] for loop in loops]
        shape = (len(loops), len(settings.look_ahead_distances), len(gains))
        variables[f"behavior_{kind}"] = (axes, np.array(codes, dtype=np.int8).reshape(shape), {"units": "1"})
    attributes = {
        "title": "Stability maps of line of sight over look-ahead distance and gain",
        "laticauda": study.version,
        "behaviors": ", ".join(BEHAVIORS),
        "duration": settings.duration,
        "initial_cross_track_error": settings.initial_cross_track_error,
        "control_interval": settings.control_interval,
        "max_offset": settings.max_offset,
        "tolerance": settings.tolerance,
        **study.how,
    }
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def write_stability_netcdf(study: StabilityStudy, path: str | Path) -> None:
    """Write the study to a netCDF file, which any netCDF tool opens.

    Args:
        study: What `run_stability` returned.
        path: The file; an older one of that name is replaced.
    """
    stability_dataset(study).to_netcdf(path, engine="netcdf4")
