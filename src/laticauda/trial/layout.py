"""How a trial is laid out as named variables and text attributes: the same in its file, in a Dataset and in a CSV.

Every variable has its dimensions, its unit and a long name. Robot, environment, gait and settings are texts (TOML and
JSON), so that any netCDF tool shows them; both write floats with all their digits.
"""

import dataclasses
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from jaxtyping import Float, Shaped

from laticauda.gaits import Gait, Wave
from laticauda.robot import Ground, Robot, Water, from_toml, to_toml
from laticauda.trial.contents import AnyArray
from laticauda.trial.trial import WORK_KINDS, Trial

FORMAT = 1
"""Number of this layout; a file with a larger one comes from a newer laticauda."""
MARK = "laticauda_trial"
"""The attribute that makes a netCDF file a trial; its value is `FORMAT`."""
AXES = ("x", "y", "z")
FORCE = "link_force_"
SIGNAL = "signal_"


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable of the layout."""

    name: str
    """As in `Trial`; one per column or component where `Trial` has several in one array."""
    dimensions: tuple[str, ...]
    """Names of its axes, time first."""
    units: str
    """SI unit, in the notation of UDUNITS."""
    long_name: str
    """What it is, in words."""


PLAIN = (
    Variable(name="time", dimensions=("time",), units="s", long_name="time since the start of the run"),
    Variable(
        name="center_of_mass",
        dimensions=("time", "axis"),
        units="m",
        long_name="position of the center of mass, world axes",
    ),
    Variable(
        name="center_of_mass_velocity",
        dimensions=("time", "axis"),
        units="m s-1",
        long_name="velocity of the center of mass, world axes",
    ),
    Variable(name="heading", dimensions=("time",), units="rad", long_name="mean angle of the body's links, unwrapped"),
    Variable(name="heading_rate", dimensions=("time",), units="rad s-1", long_name="rate of the heading"),
    Variable(
        name="link_angle",
        dimensions=("time", "link"),
        units="rad",
        long_name="angle of each link to the world x axis, counter-clockwise, tail first",
    ),
    Variable(
        name="joint_angle",
        dimensions=("time", "joint"),
        units="rad",
        long_name="joint angle, head side minus tail side, tail first",
    ),
    Variable(name="joint_rate", dimensions=("time", "joint"), units="rad s-1", long_name="rate of the joint angle"),
    Variable(
        name="joint_angle_ref", dimensions=("time", "joint"), units="rad", long_name="joint angle that was asked for"
    ),
    Variable(name="joint_torque", dimensions=("time", "joint"), units="N m", long_name="torque of the joint's drive"),
)
"""The variables that are an array of `Trial` as it stands."""

WORK = tuple(
    Variable(name=f"work_{kind}", dimensions=("time",), units="J", long_name=f"mechanical work of the joints, {words}")
    for kind, words in zip(WORK_KINDS, ("sum of |u phi'|", "sum of u phi'", "sum of max(u phi', 0)"), strict=True)
)
"""The columns of `Trial.work`."""

ELECTRICAL = Variable(
    name="electrical_work", dimensions=("time",), units="J", long_name="electrical work of the robot above idle"
)

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

TEXTS = ("version", "created", "status")


def variables(trial: Trial) -> list[tuple[Variable, Float[np.ndarray, "n_samples ..."]]]:
    """All time series of a trial with their description."""
    series = [(variable, getattr(trial, variable.name)) for variable in PLAIN]
    series += [(variable, trial.work[:, i]) for i, variable in enumerate(WORK)]
    if trial.electrical_work is not None:
        series.append((ELECTRICAL, trial.electrical_work))
    for component, force in (trial.link_force or {}).items():
        series.append((_force(component), force))
    series += [(_signal(name), signal) for name, signal in trial.signals.items()]
    return series


def coordinates(trial: Trial) -> dict[str, Shaped[np.ndarray, " n"]]:
    """The numbers of links and joints, 0 = tail, and the names of the axes."""
    return {
        "link": np.arange(trial.link_angle.shape[1]),
        "joint": np.arange(trial.joint_angle.shape[1]),
        "axis": np.array(AXES[: trial.center_of_mass.shape[1]], dtype=object),
    }


def attributes(trial: Trial) -> dict[str, str | int]:
    """Everything of a trial that is no array, as texts and numbers."""
    gait = None if trial.gait is None else dataclasses.asdict(trial.gait)
    return {
        MARK: FORMAT,
        "Conventions": "CF-1.11",
        "title": f"Trial of {trial.robot.name}",
        "source": f"laticauda {trial.version}",
        **{name: getattr(trial, name) for name in TEXTS},
        "succeeded": int(trial.succeeded),
        "robot": to_toml(trial.robot),
        "environment": to_toml(trial.environment),
        "gait": json.dumps(gait),
        "settings": json.dumps(trial.settings),
        "has_electrical_work": int(trial.electrical_work is not None),
        "link_force": json.dumps(None if trial.link_force is None else list(trial.link_force)),
        "signals": json.dumps(list(trial.signals)),
        "not_measured": json.dumps(trial.not_measured),
        "state": json.dumps({name: value.dtype.str for name, value in trial.state.items()}),
    }


def trial_from(read: Callable[[str], AnyArray], attributes: Mapping[str, Any]) -> Trial:
    """The trial again.

    Args:
        read: Gives the array of a variable by its name; those of the state are named ``state/...``.
        attributes: As `attributes` made them.

    Raises:
        KeyError: If an attribute is missing.
        ValueError: If anything is not as it was written; `read` may raise its own.
    """
    forces = cast("list[str] | None", json.loads(attributes["link_force"]))
    signals = cast("list[str]", json.loads(attributes["signals"]))
    state = cast("dict[str, str]", json.loads(attributes["state"]))
    gait = cast("dict[str, Any] | None", json.loads(attributes["gait"]))
    plain: dict[str, Any] = {variable.name: read(variable.name) for variable in PLAIN}
    texts: dict[str, Any] = {name: str(attributes[name]) for name in TEXTS}
    return Trial(
        **plain,
        work=np.stack([read(variable.name) for variable in WORK], axis=1),
        electrical_work=read(ELECTRICAL.name) if attributes["has_electrical_work"] else None,
        link_force=None if forces is None else {name: read(FORCE + name) for name in forces},
        signals={name: read(SIGNAL + name) for name in signals},
        robot=from_toml(attributes["robot"], Robot),
        gait=None if gait is None else _gait(gait),
        environment=_environment(from_toml(attributes["environment"])),
        settings=json.loads(attributes["settings"]),
        **texts,
        succeeded=bool(attributes["succeeded"]),
        not_measured=tuple(json.loads(attributes.get("not_measured", "[]"))),  # older versions have none
        state={name: read(f"state/{name}").astype(dtype) for name, dtype in state.items()},
    )


def _gait(values: dict[str, Any]) -> Gait:
    pitch, fin = values.pop("pitch", None), values.pop("fin", None)  # trials of older versions have none
    return Gait(**values, pitch=_wave(pitch), fin=_wave(fin))


def _wave(values: dict[str, Any] | None) -> Wave | None:
    return None if values is None else Wave(**values)


def _force(component: str) -> Variable:
    words = component.replace("_", " ")
    return Variable(
        name=FORCE + component,
        dimensions=("time", "link", "axis"),
        units="N",
        long_name=f"force of the {words} on each link, world axes",
    )


def _signal(name: str) -> Variable:
    units, words = SIGNALS.get(name, ("SI", f"signal {name} of the controller"))
    return Variable(name=SIGNAL + name, dimensions=("time",), units=units, long_name=words)


def _environment(read: Robot | Water | Ground) -> Water | Ground:
    if isinstance(read, Robot):
        raise ValueError("`environment` must be water or ground, got a robot.")
    return read


def variable(name: str) -> Variable:
    """The description of a time series by its name.

    Args:
        name: As in the file.

    Raises:
        KeyError: If no trial has one of that name.
    """
    for found in (*PLAIN, *WORK, ELECTRICAL):
        if found.name == name:
            return found
    if name.startswith(FORCE):
        return _force(name.removeprefix(FORCE))
    if name.startswith(SIGNAL):
        return _signal(name.removeprefix(SIGNAL))
    raise KeyError(name)
