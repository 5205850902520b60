"""The studies as xarray Datasets, for netCDF files and any tool that reads them. SI units, angles in radians."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.paper.beyond import BeyondStudy
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.path_following import FollowingRun, PathFollowingStudy
from laticauda.paper.settings import PARAMETERS
from laticauda.paper.stability import BEHAVIORS, StabilityStudy
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
LOOPS = {
    "rms": ("m", "root mean square of the cycle-mean cross-track error over the last third of the run"),
    "rms_before": ("m", "the same over the second third"),
    "forward_velocity": QUANTITIES["forward_velocity"],
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


@to_dataset.register(StabilityStudy)
def _stability(study: StabilityStudy) -> xarray.Dataset:
    settings = study.settings
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {
        "swimmer": [one.name for one in settings.swimmers],
        "robot_length": _variable("swimmer", [one.length for one in settings.swimmers], "m"),
        "look_ahead_distance": _variable("look_ahead_distance", np.array(settings.look_ahead_distances), "m"),
    }
    for kind, gains in (("cycle_mean", settings.gains), ("raw", settings.raw_gains)):
        axes = ("swimmer", "look_ahead_distance", f"gain_{kind}")
        coordinates[axes[2]] = _variable(axes[2], np.array(gains, dtype=float), "1")
        loops = [found for found in study.maps if found.heading == kind]
        for name, words in LOOPS.items():
            variables[f"{name}_{kind}"] = _variable(axes, np.array([getattr(loop, name) for loop in loops]), *words)
        codes = [sum(i * (loop.behaviors == one) for i, one in enumerate(BEHAVIORS)) for loop in loops]
        variables[f"behavior_{kind}"] = _variable(axes, np.array(codes, dtype=np.int8), "1")
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
    along, words = _padded([run.along.value for run in study.curved]), "cycle mean of the distance along the curve"
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
