"""The studies as xarray Datasets, for netCDF files and any tool that reads them. SI units, angles in radians."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.path_following import FollowingRun, PathFollowingStudy
from laticauda.paper.settings import PARAMETERS
from laticauda.quantities import quantities_of
from laticauda.studies.trials import QUANTITIES
from laticauda.trial import Trial, following

if TYPE_CHECKING:
    import xarray

UNITS = {"amplitude": "rad", "frequency": "rad/s", "phase_shift": "rad"}
CURVES = {name: QUANTITIES[name] for name in ("forward_velocity", "steady_velocity", "mechanical_power")}
HOW = ("offset_bandwidth", "loop_delay", "dt", "ramp")  # the way of a run has them
SERIES: dict[str, tuple[str, str, Callable[[Trial], np.ndarray]]] = {
    "time": ("s", "time since the start of the run", lambda trial: trial.time),
    "x": ("m", "center of mass, along the path", lambda trial: trial.center_of_mass[:, 0]),
    "y": ("m", "center of mass, across the path", lambda trial: trial.center_of_mass[:, 1]),
    "heading": ("rad", "mean angle of the links", lambda trial: trial.heading),
    "heading_ref": ("rad", "heading asked for", lambda trial: trial.signals["heading_ref"]),
    "cross_track_error": ("m", "distance from the path", lambda trial: trial.signals["cross_track_error"]),
    "offset": ("rad", "offset asked for", lambda trial: trial.signals["offset"]),
}


@singledispatch
def to_dataset(study: Any) -> xarray.Dataset:
    """A study as an xarray Dataset; what a run does not have is nan.

    Efficiency: a sweep's curves are named after it, as in `forward_velocity_over_amplitude` with the dimensions model,
    group and amplitude; Table 1 has the dimension case. Path following: the dimensions are case, the rows of Table 2
    and the held-out trial behind them; way, in which every case is run; and sample, of the chosen runs.

    Args:
        study: What `run_efficiency` or `run_path_following` returned.

    Raises:
        ValueError: If it is neither.
    """
    raise BadArgument("study", f"must be an efficiency or a path-following study, got {study!r}")


@to_dataset.register(EfficiencyStudy)
def _efficiency(study: EfficiencyStudy) -> xarray.Dataset:
    coordinates: dict[str, Any] = {"model": list(study.models), "group": [one.name for one in study.settings.groups]}
    variables: dict[str, Any] = {}
    for sweep in study.sweeps:
        parameter = sweep.settings.parameter
        coordinates[parameter] = (parameter, sweep.values, {"units": UNITS[parameter]})
        fixed = {f"at_{name}": f"{value:.6g} {UNITS[name]}" for name, value in sweep.settings.fixed.items()}
        for name, words in CURVES.items():
            axes = ("model", "group", parameter)
            variables[f"{name}_over_{parameter}"] = _variable(axes, getattr(sweep, name), *words, **fixed)
    cases, rows = study.cases, [case.measured for case in study.cases]
    starred = [row.starred or "" for row in rows]
    variables["case_group"] = ("case", [row.group for row in rows])
    variables["case_number"] = ("case", [row.case for row in rows], {"long_name": "number in Table 1"})
    variables["case_starred"] = ("case", starred, {"long_name": "fastest of this sweep"})
    for name in PARAMETERS:
        variables[f"case_{name}"] = _variable("case", [getattr(row.gait, name) for row in rows], UNITS[name])
    variables["measured_velocity"] = _variable("case", _numbers(row.forward_velocity for row in rows), "m/s")
    variables["measured_power"] = _variable("case", _numbers(row.mean_power for row in rows), "W")
    for name in ("forward_velocity", "mechanical_power"):
        values = np.array([getattr(case, name) for case in cases]).T
        variables[f"case_{name}"] = _variable(("model", "case"), values, CURVES[name][0])
    title = "Efficiency study: Figs. 4 to 11 and Table 1 of the paper"
    return _dataset(study, title, variables, coordinates, duration=study.settings.duration)


@to_dataset.register(PathFollowingStudy)
def _path_following(study: PathFollowingStudy) -> xarray.Dataset:
    held, settings, rows = study.held_out, study.settings, [case.measured for case in study.cases]
    ways = [run.name for run in (*study.cases[0].band, study.cases[0].cycle_mean)]
    runs: list[Sequence[FollowingRun | None]] = [(*case.band, case.cycle_mean) for case in study.cases]
    runs.append([held.run if name == held.run.name else None for name in ways])
    gaits = [*(row.gait for row in rows), held.settings.gait]
    variables = {name: _variable("case", [getattr(gait, name) for gait in gaits], unit) for name, unit in UNITS.items()}
    for name, unit, values in (
        ("initial_cross_track_error", "m", [one.initial_cross_track_error for one in (*rows, held.settings)]),
        ("initial_heading", "rad", [one.initial_heading for one in (*rows, held.settings)]),
        ("measured_forward_velocity", "m/s", [*(row.forward_velocity for row in rows), np.nan]),
        ("measured_mean_power", "W", [*(row.mean_power for row in rows), np.nan]),
        ("unsteered_steady_velocity", "m/s", [*(case.free_velocity for case in study.cases), np.nan]),
    ):
        variables[name] = _variable("case", values, unit)
    figures = [*(case.figure for case in study.cases), 0]
    variables["paper_figure"] = ("case", figures, {"long_name": "number of the paper's figure; 0: none"})
    own = {name: (one.unit, one.text) for name, one in quantities_of(FollowingRun).items() if name not in HOW}
    for name, words in {**own, **following.FIGURES}.items():
        table = [_numbers(None if run is None else {**vars(run), **run.figures}[name] for run in row) for row in runs]
        variables[name] = _variable(("case", "way"), np.array(table), words[0] or "1", words[1])
    trials = [*(case.trial for case in study.cases), held.trial]
    for name, (unit, title, of) in SERIES.items():
        variables[f"run_{name}"] = _variable(("case", "sample"), _padded([of(trial) for trial in trials]), unit, title)
    cases = [*(f"{row.group}, case {row.case}" for row in rows), "held out"]
    more = {"longest_duration": settings.duration, "distance": settings.distance}
    title = "Path-following study: Figs. 12 to 23 and Table 2 of the paper"
    coordinates = {"case": cases, "way": ways}
    return _dataset(study, title, variables, coordinates, **more, chosen_way=study.cases[0].run.name)


def _variable(axes: str | tuple[str, ...], values: Any, unit: str, title: str = "", **more: str) -> Any:
    """A variable as xarray takes it, with its unit and what it is."""
    return axes, values, {"units": unit, **({"long_name": title} if title else {}), **more}


def _dataset(
    study: Any, title: str, variables: Mapping[str, Any], coordinates: Mapping[str, Any], **more: Any
) -> xarray.Dataset:
    """The Dataset, with what made it; netCDF knows neither truth values nor None."""
    import xarray

    how = {
        name: int(value) if isinstance(value, bool) else value for name, value in study.how.items() if value is not None
    }
    attributes = {"title": title, "laticauda": study.version, **more, **how}
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def _numbers(values: Iterable[float | None]) -> np.ndarray:
    """Numbers, nan where one is missing."""
    return np.array([*values], dtype=float)


def _padded(rows: Sequence[np.ndarray]) -> np.ndarray:
    """One row per run, ended by nan where it was shorter."""
    table = np.full((len(rows), max((row.size for row in rows), default=0)), np.nan)
    for i, row in enumerate(rows):
        table[i, : row.size] = row
    return table
