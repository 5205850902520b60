"""Conversion of a trial to an xarray Dataset and back, and the file formats that store it.

Every time series is a variable with its dimensions, unit and long name. Everything else is an
attribute: a text (TOML or JSON, which keep all digits of floats) or a number, so that any tool can
display it.

A format is one class in one module, selected by the file extension. A file is written completely or
not at all, and replaces an older file of the same name: see `laticauda.values.files.write`.
"""

import base64
import datetime
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda import scenarios
from laticauda.trials.arrays import AnyArray
from laticauda.trials.contents import Contents
from laticauda.values import (
    DIRECTIONS,
    LINK_FORCE,
    OPTIONAL_SERIES,
    REQUESTED_SERIES,
    SERIES,
    SIGNAL,
    BadArgument,
    Extensible,
    Series,
    codec,
    log_of,
    write,
)

if TYPE_CHECKING:
    import xarray

FORMAT = 2
"""Version number of this layout; another number means an older or newer version of laticauda."""
MARK = "laticauda_trial"
"""The attribute that makes a Dataset a trial; its value is `FORMAT`."""
AXES = ("x", "y", "z")
"""World axes."""
INDEX = {
    "link": "number of the link, 0 is the tail",
    "joint": "number of the joint, tail first",
    "axis": "world axis",
    "direction": "axis of the link: along it to the head, to its left, up",
}
"""Meaning of the values of every dimension except time."""
TEXTS = ("version", "created", "status")
"""Fields of a trial that are stored as attributes of the same name."""

ELECTRICAL = "electrical_work"
HAS_LOADS = "has_loads"
"""Attribute of a trial with `REQUESTED_SERIES`; others lack it."""
PLAIN = tuple(name for name in SERIES if name not in ("work", *OPTIONAL_SERIES))
"""Time series stored as single arrays, exactly as in `Trial`."""
WORK = {
    "work_absolute": "mechanical work of the joints, sum of |u phi'|",
    "work_net": "mechanical work of the joints, sum of u phi'",
    "work_positive": "mechanical work of the joints, sum of max(u phi', 0)",
}
"""Columns of `Trial.work`."""


SIGNALS = {
    "heading_ref": ("rad", "heading commanded by guidance"),
    "heading_used": ("rad", "heading used by the controller"),
    "cross_track_error": ("m", "distance from the path, positive to the left"),
    "along_track_distance": ("m", "length of the path up to the nearest point"),
    "path_tangential_angle": ("rad", "direction of the path at the nearest point"),
    "offset": ("rad", "offset of all joints, commanded by steering"),
    "is_saturated": ("1", "whether the offset is at its limit: 0 or 1"),
    "orientation_w": ("1", "quaternion of module 0 to the world axes, w"),
    "orientation_x": ("1", "quaternion of module 0 to the world axes, x"),
    "orientation_y": ("1", "quaternion of module 0 to the world axes, y"),
    "orientation_z": ("1", "quaternion of module 0 to the world axes, z"),
    "drift_x": ("m/s", "estimated velocity with which the robot is carried, along x"),
    "drift_y": ("m/s", "estimated velocity with which the robot is carried, along y"),
    "drift_x_std": ("m/s", "standard deviation of that velocity along x"),
    "drift_y_std": ("m/s", "standard deviation of that velocity along y"),
    "crab_angle": (
        "rad",
        "angle by which the robot is to point upstream of its course, positive to the right",
    ),
    "is_crab_limited": ("1", "whether the current is too strong for that: 0 or 1"),
    "frequency": ("rad/s", "commanded frequency of the gait"),
    "solver_iterations": ("1", "solver iterations of the plan"),
    "is_fallback": ("1", "whether there was no plan and line of sight took over: 0 or 1"),
    "climb_ref": ("rad", "climb commanded by guidance"),
    "climb_used": ("rad", "climb used by the controller"),
    "height_error": ("m", "distance from the path in profile, positive above"),
    "path_climb": ("rad", "climb of the path at the nearest point"),
    "climb_offset": ("rad", "offset commanded for climbing, positive upward"),
    "climb_is_saturated": ("1", "whether that offset is at its limit: 0 or 1"),
    "pitch": ("rad", "mean pitch of the links, positive downward"),
}
"""Unit and meaning of the signals of `laticauda.control` and of spatial runs; other sources may add more."""


def describe_series(name: str) -> Series:
    """Return the description of a time series.

    Args:
        name: Name of the series, as in the file.

    Raises:
        KeyError: If no trial has a series of that name.
    """
    if name.startswith(LINK_FORCE):
        component = name.removeprefix(LINK_FORCE).replace("_", " ")
        meaning = f"force of the {component} on each link, world axes"
        return Series("N", meaning, ("time", "link", "axis"))
    if name.startswith(SIGNAL):
        signal = name.removeprefix(SIGNAL)
        unknown = "SI", f"signal {signal} of the controller"
        return Series(*SIGNALS.get(signal, unknown))
    if name in WORK:
        return Series("J", WORK[name])
    return SERIES[name]


def read_epoch(attributes: Mapping[str, Any]) -> int:
    """Return the wall-clock time of a trial's time 0, for files that must state it [ns since 1970].

    An operated run records when it began; a simulated run is taken to have begun when it was
    created, so that the same trial always gives the same file; a run without this information
    begins in 1970.

    Args:
        attributes: Attributes of the trial's Dataset.
    """
    try:
        moment = datetime.datetime.fromisoformat(str(attributes["created"]))
    except ValueError:
        return 0
    if not moment.tzinfo:
        moment = moment.replace(tzinfo=datetime.UTC)
    since_1970 = moment - datetime.datetime.fromtimestamp(0, datetime.UTC)
    return since_1970 // datetime.timedelta(microseconds=1) * 1000


def to_dataset(trial: Contents) -> "xarray.Dataset":
    """Convert a trial to a Dataset, from which `fields_of` recovers all of it.

    Args:
        trial: The trial to convert.
    """
    import xarray

    variables: dict[str, Any] = {}
    for name, values in _arrays_in_order(trial).items():
        series = describe_series(name)
        attributes = {"units": series.units, "long_name": series.text}
        variables[name] = series.dimensions, values.copy(), attributes
    n_axes = trial.center_of_mass.shape[1]
    index = {
        "link": np.arange(trial.link_angle.shape[1], dtype=np.int32),
        "joint": np.arange(trial.joint_angle.shape[1], dtype=np.int32),
        "axis": np.array(AXES[:n_axes], dtype=object),
    }
    if trial.water_force is not None:
        index["direction"] = np.array(DIRECTIONS, dtype=object)
    coordinates = {
        name: (name, values, {"long_name": INDEX[name]}) for name, values in index.items()
    }
    return xarray.Dataset(variables, coords=coordinates, attrs=_attributes(trial))


def _arrays_in_order(trial: Contents) -> dict[str, AnyArray]:
    """Return the time series of a trial by name: the plain ones, each kind of work, then all others."""
    arrays = trial.series()
    work = dict(zip(WORK, arrays.pop("work").T, strict=True))
    plain = {name: arrays.pop(name) for name in PLAIN}
    return {**plain, **work, **arrays}


def assembled(read: Callable[[str], AnyArray], attributes: Mapping[str, Any]) -> "xarray.Dataset":
    """Assemble the Dataset of a trial from its time series.

    Args:
        read: Returns the array of a time series given its name; its exceptions are passed on.
        attributes: Attributes of the Dataset, as they were stored.

    Raises:
        KeyError: If an attribute is missing.
        ValueError: If the attributes are not those of a trial.
    """
    import xarray

    variables = {
        name: (describe_series(name).dimensions, read(name)) for name in _names(attributes)
    }
    return xarray.Dataset(variables, attrs=dict(attributes))


def _names(attributes: Mapping[str, Any]) -> list[str]:
    """Return the names of a trial's time series, according to its stored attributes."""
    check_format(attributes)
    names = [*PLAIN, *WORK]
    if attributes["has_electrical_work"]:
        names.append(ELECTRICAL)
    if HAS_LOADS in attributes:
        names += REQUESTED_SERIES
    names += [LINK_FORCE + name for name in json.loads(attributes["link_force"]) or ()]
    names += [SIGNAL + name for name in json.loads(attributes["signals"])]
    return names


def fields_of(dataset: "xarray.Dataset") -> dict[str, Any]:
    """Return the contents of a trial from the Dataset made by `to_dataset`, as the fields of `Contents`.

    Args:
        dataset: The Dataset as made by `to_dataset`, or as read by a format.

    Raises:
        KeyError: If a variable or an attribute is missing.
        ValueError: If anything differs from what was written.
    """
    attributes: dict[str, Any] = {str(name): value for name, value in dataset.attrs.items()}
    arrays: dict[str, AnyArray] = {
        name: dataset.variables[name].values for name in _names(attributes)
    }
    log = log_of({**arrays, "work": np.stack([arrays[name] for name in WORK], axis=1)})
    with codec.keys_of("scenario", ValueError):
        scenario = scenarios.run_from_toml(attributes["scenario"])
    link_force = None
    if attributes["link_force"] != "null":
        link_force = log.link_force or {}
    return {
        **vars(log),
        "link_force": link_force,
        "scenario": scenario,
        **{name: str(attributes[name]) for name in TEXTS},
        "succeeded": bool(attributes["succeeded"]),
        "not_measured": tuple(json.loads(attributes["not_measured"])),
        "state": _state(attributes),
    }


def check_format(attributes: Mapping[str, Any]) -> None:
    """Reject a Dataset that is not a trial or has another format.

    Args:
        attributes: Attributes of a Dataset.

    Raises:
        ValueError: If they are not those of a trial that this version can read.
    """
    if MARK not in attributes:
        raise ValueError("it is not a trial of laticauda.")
    if attributes[MARK] != FORMAT:
        fault = (
            f"it has format {attributes[MARK]}, but this version of laticauda reads format {FORMAT}"
        )
        date = str(attributes.get("created"))[:10]
        writer = f"the one that wrote it, {attributes.get('version')} of {date}"
        raise ValueError(f"{fault}: read it with {writer}.")


def pack_array(values: AnyArray) -> dict[str, Any]:
    """Encode a numeric array of any shape and dtype as JSON-compatible data, bit for bit.

    Args:
        values: The array to encode.
    """
    content = base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
    return {"dtype": values.dtype.str, "shape": values.shape, "bytes": content}


def _attributes(trial: Contents) -> dict[str, str | int]:
    """Return everything in a trial that is not a time series, as texts and numbers."""
    loads: dict[str, int] = {}
    if trial.water_force is not None:
        loads[HAS_LOADS] = 1
    return {
        MARK: FORMAT,
        "Conventions": "CF-1.11",
        "title": f"Trial of {trial.robot.name}",
        "source": f"laticauda {trial.version}",
        "history": f"{trial.created} made by laticauda {trial.version}",
        **{name: getattr(trial, name) for name in TEXTS},
        "succeeded": int(trial.succeeded),
        "scenario": scenarios.run_to_toml(trial.scenario),
        "has_electrical_work": int(trial.electrical_work is not None),
        "link_force": json.dumps(None if trial.link_force is None else list(trial.link_force)),
        **loads,
        "signals": json.dumps(list(trial.signals)),
        "not_measured": json.dumps(trial.not_measured),
        "state": json.dumps({name: pack_array(values) for name, values in trial.state.items()}),
    }


def _state(attributes: Mapping[str, Any]) -> dict[str, AnyArray]:
    packed_arrays: dict[str, Any] = json.loads(attributes["state"])
    return {name: _unpack_array(packed) for name, packed in packed_arrays.items()}


def _unpack_array(packed: Mapping[str, Any]) -> AnyArray:
    """Return the array from which `pack_array` made the data."""
    content = base64.b64decode(packed["bytes"])
    return np.frombuffer(content, packed["dtype"]).reshape(packed["shape"])


# ---- files ---------------------------------------------------------------------------------------


class Format(Extensible, group="formats"):
    """Writer and reader of a trial's Dataset for files with one extension.

    class Zarr(Format):          # registered by an entry point in the group `laticauda.formats`, or when imported
        called = "zarr"          # the file extension, without its dot
    """

    title: ClassVar[str] = ""
    """Description of the format, in words."""
    is_whole: ClassVar[bool] = True
    """Whether all of a trial is kept, so that it can be read back."""

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial to an empty file.

        Args:
            dataset: The trial, see `Trial.to_dataset`.
            path: The file; its name need not have the format's extension.

        Raises:
            MissingExtra: If a package is not installed.
            OSError: If the file cannot be written.
        """
        raise NotImplementedError

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read back the Dataset that was written, with all its numbers and attributes.

        Args:
            path: The file.

        Raises:
            MissingExtra: If a package is not installed.
            TrialFileError: If the file does not have this format.
            KeyError: If something is missing from it.
            ValueError: If the content is not a trial, or is damaged.
            OSError: If it cannot be read.
        """
        raise NotImplementedError

    @classmethod
    def of(cls, path: Path) -> "type[Format]":
        """Return the format for a file's extension; netCDF if no format has that extension.

        Args:
            path: The file; it need not exist.
        """
        ending = path.suffix.lower().removeprefix(".")
        return cls.named(ending if ending in cls.names() else "nc")

    @classmethod
    def endings(cls) -> tuple[str, ...]:
        """Return the extensions of all formats, such as ".nc"."""
        return tuple(f".{name}" for name in cls.names())


def save(dataset: "xarray.Dataset", path: Path) -> None:
    """Write a trial to a file.

    Args:
        dataset: The trial.
        path: The file; its extension sets the format, and netCDF needs none.

    Raises:
        ValueError: If no format has the extension.
        StorageFailed: If the file cannot be written; the message gives its name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    if path.suffix and path.suffix.lower() not in Format.endings():
        raise BadArgument("path", f"must end in {' or '.join(Format.endings())}, got {path.name}")
    file_format = Format.of(path)
    write(path, lambda temporary_path: file_format.write(dataset, temporary_path))
