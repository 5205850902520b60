"""A trial as an xarray Dataset and back: what every format of files is made of.

Every time series is a variable with its dimensions, unit and long name. Everything else is an attribute: a text (TOML
or JSON, which write floats with all their digits) or a number, so that any tool shows it.
"""

import base64
import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda import codec, scenarios
from laticauda.series import LINK_FORCE, SERIES, SIGNAL, Series, log_of
from laticauda.trial.arrays import AnyArray
from laticauda.trial.contents import Contents

if TYPE_CHECKING:
    import xarray

FORMAT = 2
"""Number of this layout; another one is an older or a newer laticauda's."""
MARK = "laticauda_trial"
"""The attribute that makes a Dataset a trial; its value is `FORMAT`."""
AXES = ("x", "y", "z")
TEXTS = ("version", "created", "status")


ELECTRICAL = "electrical_work"
PLAIN = tuple(name for name in SERIES if name not in ("work", ELECTRICAL))
"""The time series that are an array of `Trial` as it stands."""
WORK = {
    "work_absolute": "mechanical work of the joints, sum of |u phi'|",
    "work_net": "mechanical work of the joints, sum of u phi'",
    "work_positive": "mechanical work of the joints, sum of max(u phi', 0)",
}
"""The columns of `Trial.work`."""

SIGNALS = {
    "heading_ref": ("rad", "heading that guidance asks for"),
    "heading_used": ("rad", "heading that the controller goes by"),
    "cross_track_error": ("m", "distance from the path, positive to the left"),
    "along_track_distance": ("m", "length of the path up to the nearest point"),
    "path_tangential_angle": ("rad", "direction of the path at the nearest point"),
    "offset": ("rad", "offset of all joints that steering asks for"),
    "is_saturated": ("1", "whether the offset is at its limit: 0 or 1"),
    **{f"orientation_{part}": ("1", f"quaternion of module 0 to the world axes, {part}") for part in "wxyz"},
    "drift_x": ("m/s", "velocity with which the robot is believed to be carried, along x"),
    "drift_y": ("m/s", "velocity with which the robot is believed to be carried, along y"),
    "drift_x_std": ("m/s", "standard deviation of that velocity along x"),
    "drift_y_std": ("m/s", "standard deviation of that velocity along y"),
    "crab_angle": ("rad", "how far upstream of its course the robot is to point, positive to the right"),
    "is_crab_limited": ("1", "whether the current is too strong for that: 0 or 1"),
    "frequency": ("rad/s", "frequency of the gait that is asked for"),
    "solver_iterations": ("1", "iterations that the plan took"),
    "is_fallback": ("1", "whether there was no plan and line of sight took over: 0 or 1"),
    "climb_ref": ("rad", "climb that guidance asks for"),
    "climb_used": ("rad", "climb that the controller goes by"),
    "height_error": ("m", "distance from the path in profile, positive above"),
    "path_climb": ("rad", "climb of the path at the nearest point"),
    "climb_offset": ("rad", "offset that climbing asks for, positive upward"),
    "climb_is_saturated": ("1", "whether that offset is at its limit: 0 or 1"),
    "pitch": ("rad", "mean pitch of the links, positive downward"),
}
"""Unit and meaning of the signals of `laticauda.control` and of spatial runs; others may have others."""


def variable(name: str) -> Series:
    """The description of a time series.

    Args:
        name: As in the file.

    Raises:
        KeyError: If no trial has one of that name.
    """
    if name.startswith(LINK_FORCE):
        words = name.removeprefix(LINK_FORCE).replace("_", " ")
        return Series("N", f"force of the {words} on each link, world axes", ("time", "link", "axis"))
    if name.startswith(SIGNAL):
        signal = name.removeprefix(SIGNAL)
        return Series(*SIGNALS.get(signal, ("SI", f"signal {signal} of the controller")))
    return Series("J", WORK[name]) if name in WORK else SERIES[name]


def to_dataset(trial: Contents) -> "xarray.Dataset":
    """A trial as a Dataset, from which `fields_of` has all of it.

    Args:
        trial: Any trial.
    """
    import xarray

    arrays = trial.series()
    work = dict(zip(WORK, arrays.pop("work").T, strict=True))
    arrays = {name: arrays.pop(name) for name in PLAIN} | work | arrays
    series: dict[str, Any] = {}
    for name, values in arrays.items():
        one = variable(name)
        series[name] = one.dimensions, values.copy(), {"units": one.units, "long_name": one.text}
    index = {
        "link": np.arange(trial.link_angle.shape[1], dtype=np.int32),
        "joint": np.arange(trial.joint_angle.shape[1], dtype=np.int32),
        "axis": np.array(AXES[: trial.center_of_mass.shape[1]], dtype=object),
    }
    return xarray.Dataset(series, coords=index, attrs=_attributes(trial))


def assembled(read: Callable[[str], AnyArray], attributes: Mapping[str, Any]) -> "xarray.Dataset":
    """The Dataset of a trial from its time series.

    Args:
        read: Gives the array of a time series by its name; what it raises passes through.
        attributes: Those of the Dataset, as they were stored.

    Raises:
        KeyError: If an attribute is missing.
        ValueError: If the attributes are not those of a trial.
    """
    import xarray

    variables = {name: (variable(name).dimensions, read(name)) for name in _names(attributes)}
    return xarray.Dataset(variables, attrs=dict(attributes))


def _names(attributes: Mapping[str, Any]) -> list[str]:
    """Of the time series of a trial, by what was stored of it."""
    check_format(attributes)
    names = [*PLAIN, *WORK, *([ELECTRICAL] if attributes["has_electrical_work"] else [])]
    names += [LINK_FORCE + name for name in json.loads(attributes["link_force"]) or ()]
    return names + [SIGNAL + name for name in json.loads(attributes["signals"])]


def fields_of(dataset: "xarray.Dataset") -> dict[str, Any]:
    """What the trial holds that `to_dataset` made a Dataset of, by the fields of `Contents`.

    Args:
        dataset: As it was made, or as a format read it.

    Raises:
        KeyError: If a variable or an attribute is missing.
        ValueError: If anything is not as it was written.
    """
    attributes: dict[str, Any] = {str(name): one for name, one in dataset.attrs.items()}
    arrays: dict[str, AnyArray] = {}
    for name in _names(attributes):
        if name not in dataset.variables:
            raise KeyError(name)
        arrays[name] = dataset.variables[name].values
    log = log_of({**arrays, "work": np.stack([arrays[name] for name in WORK], axis=1)})
    with codec.keys_of("scenario", ValueError):
        scenario = scenarios.run_from_toml(attributes["scenario"])
    return {
        **vars(log),
        "link_force": None if attributes["link_force"] == "null" else log.link_force or {},
        "scenario": scenario,
        **{name: str(attributes[name]) for name in TEXTS},
        "succeeded": bool(attributes["succeeded"]),
        "not_measured": tuple(json.loads(attributes["not_measured"])),
        "state": _state(attributes),
    }


def check_format(attributes: Mapping[str, Any]) -> None:
    """Refuse what is no trial, or one of another format.

    Args:
        attributes: Of a Dataset.

    Raises:
        ValueError: If they are no trial's that this version reads.
    """
    if MARK not in attributes:
        raise ValueError("it is no trial of laticauda.")
    if attributes[MARK] != FORMAT:
        raise ValueError(
            f"it has format {attributes[MARK]}, and this version of laticauda reads format {FORMAT}: read it with the "
            f"one that wrote it, {attributes.get('version')} of {str(attributes.get('created'))[:10]}."
        )


def packed(values: AnyArray) -> dict[str, Any]:
    """An array of any shape and kind of numbers as data for JSON, bit for bit.

    Args:
        values: The array.
    """
    content = base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
    return {"dtype": values.dtype.str, "shape": values.shape, "bytes": content}


def _attributes(trial: Contents) -> dict[str, str | int]:
    """Everything of a trial that is no time series, as texts and numbers."""
    return {
        MARK: FORMAT,
        "Conventions": "CF-1.11",
        "title": f"Trial of {trial.robot.name}",
        "source": f"laticauda {trial.version}",
        **{name: getattr(trial, name) for name in TEXTS},
        "succeeded": int(trial.succeeded),
        "scenario": scenarios.run_to_toml(trial.scenario),
        "has_electrical_work": int(trial.electrical_work is not None),
        "link_force": json.dumps(None if trial.link_force is None else list(trial.link_force)),
        "signals": json.dumps(list(trial.signals)),
        "not_measured": json.dumps(trial.not_measured),
        "state": json.dumps({name: packed(values) for name, values in trial.state.items()}),
    }


def _state(attributes: Mapping[str, Any]) -> dict[str, AnyArray]:
    stored: dict[str, Any] = json.loads(attributes["state"])
    return {
        name: np.frombuffer(base64.b64decode(one["bytes"]), one["dtype"]).reshape(one["shape"])
        for name, one in stored.items()
    }
