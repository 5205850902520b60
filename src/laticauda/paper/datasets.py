"""The studies as xarray Datasets, for netCDF files and any tool that reads them. SI units, angles in radians."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.paper.beyond import BeyondStudy
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.following_run import FollowingRun
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.settings import PARAMETERS
from laticauda.paper.stability import BEHAVIORS, StabilityStudy
from laticauda.trial import Trial, following

if TYPE_CHECKING:
    import xarray

UNITS = {"amplitude": "rad", "frequency": "rad/s", "phase_shift": "rad"}
VELOCITY = ("m/s", "forward velocity, straight line over the whole run")
POWER = ("W", "mechanical power, mean of sum |u phi'|")
CURVES = {
    "forward_velocity": VELOCITY,
    "steady_velocity": ("m/s", "the same over whole gait cycles after the transient"),
    "mechanical_power": POWER,
}
RUN_FIGURES = {
    "duration": ("s", "how long the run was"),
    "forward_velocity": VELOCITY,
    "path_speed": ("m/s", "length of the path over time"),
    "steady_velocity": ("m/s", "forward velocity over whole gait cycles after the transient"),
    "mechanical_power": POWER,
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
LOOPS = {
    "rms": ("m", "root mean square of the cycle-mean cross-track error over the last third of the run"),
    "rms_before": ("m", "the same over the second third"),
    "forward_velocity": VELOCITY,
}


@singledispatch
def to_dataset(study: Any) -> xarray.Dataset:
    """A study as an xarray Dataset; what a run does not have is nan.

    Efficiency: a sweep's curves are named after it, as in `forward_velocity_over_amplitude` with the dimensions model,
    group and amplitude; Table 1 has the dimension case. Path following: the dimensions are case, the rows of Table 2
    and the held-out trial behind them; way, in which every case is run; and sample, of the chosen runs. Stability:
    names end in `_cycle_mean` or `_raw`, after the heading that was used, and each has its own gains; a behavior is the
    index of its name in the attribute `behaviors`. Beyond the paper: names begin with `drift_`, `curved_` or
    `turning_`; errors are means over the gait cycle around each moment.

    Args:
        study: What `run_efficiency`, `run_path_following`, `run_stability` or `run_beyond` returned.

    Raises:
        ValueError: If it is none of these.
    """
    raise BadArgument("study", f"must be an efficiency, path-following or stability study or one beyond, got {study!r}")


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
    cases = study.cases
    variables["case_group"] = ("case", [case.group.name for case in cases])
    variables["case_number"] = ("case", [case.index + 1 for case in cases], {"long_name": "number in Table 1"})
    variables["case_starred"] = ("case", [case.starred or "" for case in cases], {"long_name": "fastest of this sweep"})
    for name in PARAMETERS:
        variables[f"case_{name}"] = _variable("case", [getattr(case.gait, name) for case in cases], UNITS[name])
    for name, unit in (("measured_velocity", "m/s"), ("measured_power", "W")):
        variables[name] = _variable("case", np.array([getattr(case, name) for case in cases], dtype=float), unit)
    for name in ("forward_velocity", "mechanical_power"):
        values = np.array([getattr(case, name) for case in cases]).T
        variables[f"case_{name}"] = _variable(("model", "case"), values, CURVES[name][0])
    title = "Efficiency study: Figs. 4 to 11 and Table 1 of the paper"
    return _dataset(study, title, variables, coordinates, duration=study.settings.duration)


@to_dataset.register(PathFollowingStudy)
def _path_following(study: PathFollowingStudy) -> xarray.Dataset:
    held, settings = study.held_out, study.settings
    ways = [run.name for run in (*study.cases[0].band, study.cases[0].cycle_mean)]
    runs: list[Sequence[FollowingRun | None]] = [(*case.band, case.cycle_mean) for case in study.cases]
    runs.append([held.run if name == held.run.name else None for name in ways])
    gaits = [*(case.measured.gait for case in study.cases), held.settings.gait]
    variables = {name: _variable("case", [getattr(gait, name) for gait in gaits], unit) for name, unit in UNITS.items()}
    for name, unit, last in (
        ("initial_cross_track_error", "m", held.settings.initial_cross_track_error),
        ("initial_heading", "rad", held.settings.initial_heading),
        ("forward_velocity", "m/s", np.nan),
        ("mean_power", "W", np.nan),
    ):
        values = [*(getattr(case.measured, name) for case in study.cases), last]
        variables[name if name.startswith("initial") else f"measured_{name}"] = _variable("case", values, unit)
    free = [*(case.free_velocity for case in study.cases), np.nan]
    variables["unsteered_steady_velocity"] = _variable("case", free, "m/s")
    figures = [*(case.figure for case in study.cases), 0]
    variables["paper_figure"] = ("case", figures, {"long_name": "number of the paper's figure; 0: none"})

    def table(figure: Callable[[FollowingRun], float | None]) -> np.ndarray:
        return np.array([[None if run is None else figure(run) for run in row] for row in runs], dtype=float)

    for name, words in RUN_FIGURES.items():
        variables[name] = _variable(("case", "way"), table(lambda run, name=name: getattr(run, name)), *words)
    for name, (unit, title) in following.FIGURES.items():
        values = table(lambda run, name=name: run.figures[name])
        variables[name] = _variable(("case", "way"), values, unit or "1", title)
    trials = [*(case.trial for case in study.cases), held.trial]
    for name, (unit, title, of) in SERIES.items():
        variables[f"run_{name}"] = _variable(("case", "sample"), _padded([of(trial) for trial in trials]), unit, title)
    cases = [*(f"{case.group.name}, case {case.measured.case}" for case in study.cases), "held out"]
    more = {"longest_duration": settings.duration, "distance": settings.distance}
    title = "Path-following study: Figs. 12 to 23 and Table 2 of the paper"
    coordinates = {"case": cases, "way": ways}
    return _dataset(study, title, variables, coordinates, **more, chosen_way=study.cases[0].run.name)


@to_dataset.register(StabilityStudy)
def _stability(study: StabilityStudy) -> xarray.Dataset:
    settings = study.settings
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {
        "swimmer": [found.swimmer.name for found in study.maps],
        "robot_length": _variable("swimmer", [found.swimmer.length for found in study.maps], "m"),
        "look_ahead_distance": _variable("look_ahead_distance", np.array(settings.look_ahead_distances), "m"),
    }
    for kind, gains in (("cycle_mean", settings.gains), ("raw", settings.raw_gains)):
        axes = ("swimmer", "look_ahead_distance", f"gain_{kind}")
        coordinates[axes[2]] = _variable(axes[2], np.array(gains, dtype=float), "1")
        loops = [getattr(found, kind) for found in study.maps]
        for name, words in LOOPS.items():
            variables[f"{name}_{kind}"] = _variable(axes, np.array([getattr(loop, name) for loop in loops]), *words)
        codes = [[[BEHAVIORS.index(one) for one in row] for row in loop.behaviors] for loop in loops]
        shape = (len(loops), len(settings.look_ahead_distances), len(gains))
        variables[f"behavior_{kind}"] = _variable(axes, np.array(codes, dtype=np.int8).reshape(shape), "1")
    names = ("duration", "initial_cross_track_error", "control_interval", "max_offset", "tolerance")
    more = {"behaviors": ", ".join(BEHAVIORS), **{name: getattr(settings, name) for name in names}}
    title = "Stability maps of line of sight over look-ahead distance and gain"
    return _dataset(study, title, variables, coordinates, **more)


@to_dataset.register(BeyondStudy)
def _beyond(study: BeyondStudy) -> xarray.Dataset:
    settings = study.settings
    coordinates: dict[str, Any] = {
        "drift_law": [run.law.name for run in study.drift],
        "curved_swimmer": [run.swimmer.name for run in study.curved],
        "turning_swimmer": [curve.swimmer.name for curve in study.turning],
        "offset": _variable("offset", np.array(settings.turning.offsets), "rad"),
    }
    variables: dict[str, Any] = {}
    for axis, runs in (("drift_law", study.drift), ("curved_swimmer", study.curved)):
        part = axis.partition("_")[0]
        time = max((run.error.time for run in runs), key=lambda time: time.size, default=np.zeros(0))  # all start alike
        coordinates[f"{part}_time"] = _variable(f"{part}_time", time, "s")
        errors = _padded([run.error.value for run in runs])
        variables[f"{part}_error"] = _variable((axis, f"{part}_time"), errors, "m", "cycle-mean cross-track error")
    along, words = _padded([run.along for run in study.curved]), "cycle mean of the distance along the curve"
    variables["curved_along"] = _variable(("curved_swimmer", "curved_time"), along, "m", words)
    for name, unit in (("turning_rate", "rad/s"), ("radius", "m"), ("path_speed", "m/s"), ("mechanical_power", "W")):
        values = np.array([getattr(curve, name) for curve in study.turning])
        key = name if name.startswith("turning") else f"turning_{name}"
        variables[key] = _variable(("turning_swimmer", "offset"), values, unit)
    more = {
        "drift_current": np.array(settings.drift.current),
        "curved_waypoints": np.array(settings.curved.waypoints).ravel(),
        "turning_duration": settings.turning.duration,
    }
    title = "Beyond the paper: a cross current, a curved path, open-loop turning; simulation only"
    return _dataset(study, title, variables, coordinates, **more)


def _variable(axes: str | tuple[str, ...], values: Any, unit: str, title: str = "", **more: str) -> Any:
    """A variable as xarray takes it, with its unit and what it is."""
    return axes, values, {"units": unit, **({"long_name": title} if title else {}), **more}


def _dataset(
    study: Any, title: str, variables: Mapping[str, Any], coordinates: Mapping[str, Any], **more: Any
) -> xarray.Dataset:
    """The Dataset, with what made it; netCDF knows no truth values."""
    import xarray

    how = {name: int(value) if isinstance(value, bool) else value for name, value in study.how.items()}
    attributes = {"title": title, "laticauda": study.version, **more, **how}
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes)


def _padded(rows: Sequence[np.ndarray]) -> np.ndarray:
    """One row per run, ended by nan where it was shorter."""
    table = np.full((len(rows), max((row.size for row in rows), default=0)), np.nan)
    for i, row in enumerate(rows):
        table[i, : row.size] = row
    return table
