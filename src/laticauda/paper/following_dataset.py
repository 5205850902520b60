"""The path-following study as one xarray Dataset, and as a netCDF file."""

# xarray's own annotations are partial: this module is the door of the studies to it.
# pyright: reportUnknownMemberType=false

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from laticauda.paper.following_run import FollowingRun
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.trial import Trial, following

if TYPE_CHECKING:
    import xarray

RUN_FIGURES = {
    "duration": ("s", "how long the run was"),
    "forward_velocity": ("m/s", "forward velocity, straight line over the whole run"),
    "path_speed": ("m/s", "length of the path over time"),
    "steady_velocity": ("m/s", "forward velocity over whole gait cycles after the transient"),
    "mechanical_power": ("W", "mechanical power, mean of sum |u phi'|"),
    "joules_per_meter": ("J/m", "mechanical power / forward velocity"),
    "last_third_rms": ("m", "root mean square of the cycle-mean error over the last third"),
    "last_third_largest": ("m", "largest cycle-mean error over the last third"),
    "offset_swing": ("rad", "amplitude of the offset asked for over the last third"),
}
SERIES: dict[str, tuple[str, str, Callable[[Trial], np.ndarray]]] = {
    "time": ("s", "time since the start of the run", lambda trial: trial.time),
    "x": ("m", "center of mass, along the path", lambda trial: trial.center_of_mass[:, 0]),
    "y": ("m", "center of mass, across the path", lambda trial: trial.center_of_mass[:, 1]),
    "heading": ("rad", "mean angle of the links", lambda trial: trial.heading),
    "heading_ref": ("rad", "heading asked for", lambda trial: trial.signals["heading_ref"]),
    "cross_track_error": ("m", "distance from the path", lambda trial: trial.signals["cross_track_error"]),
    "offset": ("rad", "offset asked for", lambda trial: trial.signals["offset"]),
}


def following_dataset(study: PathFollowingStudy) -> xarray.Dataset:
    """The study as an xarray Dataset.

    Its dimensions are case, the rows of Table 2 and the held-out trial behind them; way, the ways in which every case
    is run; and sample, of the chosen runs. What a run does not have is nan: samples beyond its end, figures that it has
    not, and for the held-out trial everything but the chosen way. SI units, angles in radians.

    Args:
        study: What `run_path_following` returned.
    """
    import xarray

    ways = [run.name for run in (*study.cases[0].band, study.cases[0].cycle_mean)]
    held = study.held_out
    alone = [held.run if name == held.run.name else None for name in ways]
    runs: list[Sequence[FollowingRun | None]] = [(*case.band, case.cycle_mean) for case in study.cases]
    variables: dict[str, Any] = _rows(study)
    for name, (unit, title) in RUN_FIGURES.items():
        values = _table([*runs, alone], lambda run, name=name: getattr(run, name))
        variables[name] = (("case", "way"), values, {"units": unit, "long_name": title})
    for name, (unit, title) in following.FIGURES.items():
        values = _table([*runs, alone], lambda run, name=name: run.figures[name])
        variables[name] = (("case", "way"), values, {"units": unit or "1", "long_name": title})
    trials = [*(case.trial for case in study.cases), held.trial]
    for name, (unit, title, of) in SERIES.items():
        values = _padded([of(trial) for trial in trials])
        variables[f"run_{name}"] = (("case", "sample"), values, {"units": unit, "long_name": title})
    return xarray.Dataset(
        variables,
        coords={
            "case": [*(f"{case.group.name}, case {case.measured.case}" for case in study.cases), "held out"],
            "way": ways,
        },
        attrs=_attributes(study),
    )


def write_following_netcdf(study: PathFollowingStudy, path: str | Path) -> None:
    """Write the study to a netCDF file, which any netCDF tool opens.

    Args:
        study: What `run_path_following` returned.
        path: The file; an older one of that name is replaced.
    """
    following_dataset(study).to_netcdf(path, engine="netcdf4")


def _rows(study: PathFollowingStudy) -> dict[str, Any]:
    """The cases' initial conditions, and what was measured."""
    held, missing = study.held_out.settings, float("nan")
    columns = {
        "initial_cross_track_error": ("m", held.initial_cross_track_error),
        "initial_heading": ("rad", held.initial_heading),
    }
    measured = {"forward_velocity": "m/s", "mean_power": "W"}
    gaits = [*(case.measured.gait for case in study.cases), held.gait]
    variables: dict[str, Any] = {
        name: ("case", [getattr(gait, name) for gait in gaits], {"units": unit})
        for name, unit in {"amplitude": "rad", "frequency": "rad/s", "phase_shift": "rad"}.items()
    }
    for name, (unit, last) in columns.items():
        values = [*(getattr(case.measured, name) for case in study.cases), last]
        variables[name] = ("case", values, {"units": unit})
    for name, unit in measured.items():
        values = [*(getattr(case.measured, name) for case in study.cases), missing]
        variables[f"measured_{name}"] = ("case", values, {"units": unit})
    free = [*(case.free_velocity for case in study.cases), missing]
    variables["unsteered_steady_velocity"] = ("case", free, {"units": "m/s"})
    figures = [*(case.figure for case in study.cases), 0]
    variables["paper_figure"] = ("case", figures, {"long_name": "number of the paper's figure; 0: none"})
    return variables


def _table(
    runs: Sequence[Sequence[FollowingRun | None]], figure: Callable[[FollowingRun], float | None]
) -> Float[np.ndarray, "n_cases n_ways"]:
    return np.array([[None if run is None else figure(run) for run in row] for row in runs], dtype=float)


def _padded(series: Sequence[np.ndarray]) -> Float[np.ndarray, "n_cases n_samples"]:
    """Series of different lengths one below the other, nan behind their ends."""
    padded = np.full((len(series), max(values.size for values in series)), np.nan)
    for row, values in zip(padded, series, strict=True):
        row[: values.size] = values
    return padded


def _attributes(study: PathFollowingStudy) -> dict[str, Any]:
    settings = study.settings
    how = {name: int(value) if isinstance(value, bool) else value for name, value in study.how.items()}
    return {
        "title": "Path-following study: Figs. 12 to 23 and Table 2 of the paper",
        "laticauda": study.version,
        "longest_duration": settings.duration,
        "distance": settings.distance,
        "chosen_way": study.cases[0].run.name,
        **how,
    }
