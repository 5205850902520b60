"""What is in a trial: arrays, what swam and how, how it ended.

Each check of an array or a text returns the value as it is kept, or raises a ValueError naming the field.
"""

import dataclasses
import datetime
from collections.abc import Mapping
from typing import TypeAlias, cast

import numpy as np
from jaxtyping import Float, Shaped

from laticauda import gaits, scenarios, series
from laticauda.errors import BadArgument, flag, instance, text
from laticauda.robot import Ground, Robot, Water

# The shapes of a trial's arrays. `Trial` takes them from here and checks them itself, whatever it is given.
Samples: TypeAlias = Float[np.ndarray, " n_samples"]
FinJoints: TypeAlias = Float[np.ndarray, "n_samples n_fin_joints"]
Forces: TypeAlias = Float[np.ndarray, "n_samples n_links n_axes"]
Axes: TypeAlias = Float[np.ndarray, " n_axes"]
Setting: TypeAlias = str | float | bool | None
AnyArray: TypeAlias = Shaped[np.ndarray, "..."]


def floats(name: str, values: object, shape: tuple[int | None, ...]) -> Float[np.ndarray, "..."]:
    """`values` as a read-only float64 array of that shape; None stands for any length."""
    try:
        given = np.asarray(values)
    except ValueError:  # rows of different lengths
        given = np.empty((), dtype=object)
    if given.dtype.kind not in "iuf":
        raise BadArgument(name, f"must be an array of numbers, got {type(values).__name__} of {given.dtype}")
    array = np.asarray(given, dtype=np.float64, order="C")
    wanted = tuple("any" if n is None else str(n) for n in shape)
    if array.ndim != len(shape) or any(n not in (None, size) for n, size in zip(shape, array.shape, strict=True)):
        raise BadArgument(name, f"must have shape ({', '.join(wanted)}), got {array.shape}")
    if not np.all(np.isfinite(array)):
        row = int(np.argwhere(~np.isfinite(array))[0][0])
        raise BadArgument(name, f"must hold finite numbers only, got {array[row]} at sample {row}")
    return _read_only(array, values)


def times(name: str, values: object) -> Samples:
    """`values` as read-only moments, at least one, strictly increasing."""
    time = floats(name, values, (None,))
    if time.size < 1:
        raise BadArgument(name, "must have at least 1 sample, got 0")
    increases = np.diff(time) > 0.0
    if not np.all(increases):
        i = int(np.argmin(increases))
        raise BadArgument(name, f"must increase strictly, got {time[i]} s and then {time[i + 1]} s")
    return time


def forces(value: object, shape: tuple[int, ...]) -> dict[str, Forces] | None:
    """The force of each component as a read-only array of that shape."""
    if value is None:
        return None
    return {key: floats(f"link_force[{key!r}]", force, shape) for key, force in mapping("link_force", value).items()}


def signals(value: object, n_samples: int) -> dict[str, Samples]:
    """Each signal as a read-only array, one value per sample."""
    return {key: floats(f"signals[{key!r}]", signal, (n_samples,)) for key, signal in mapping("signals", value).items()}


def mapping(name: str, value: object) -> Mapping[str, object]:
    """`value` as a mapping from names that can be those of variables in a file."""
    if not isinstance(value, Mapping):
        raise BadArgument(name, f"must map names to values, got {type(value).__name__}")
    items = cast("Mapping[object, object]", value)
    return {_key(name, key): item for key, item in items.items()}


def state_array(name: str, value: object) -> AnyArray:
    """`value` as a read-only array of its own kind of number, in the machine's byte order."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf" or array.dtype.itemsize > 8 or array.dtype == np.float16:
        raise ValueError(f"`state[{name!r}]` must be an array of numbers or truth values, got {array.dtype}.")
    return _read_only(np.asarray(array, dtype=array.dtype.newbyteorder("="), order="C"), value)


def names(name: str, value: object, choices: tuple[str, ...]) -> tuple[str, ...]:
    """`value` as some of the names in `choices`, in their order."""
    given = tuple(cast("list[object]", value)) if isinstance(value, tuple | list) else (value,)
    for one in given:
        if one not in choices:
            raise BadArgument(name, f"must hold only {', '.join(choices)}, got {one!r}")
    return tuple(choice for choice in choices if choice in given)


def same(one: object, other: object) -> bool:
    """Whether two contents are the same, arrays bit for bit."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        a, b = cast("AnyArray", one), cast("AnyArray", other)
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(one, dict) and isinstance(other, dict):
        a, b = cast("dict[str, object]", one), cast("dict[str, object]", other)
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    plain = cast("object", one)
    # Texts of values tell 1 from True and 0 from -0.
    return type(plain) is type(other) and plain == other and repr(plain) == repr(other)


def _key(field: str, name: object) -> str:
    if not isinstance(name, str) or not name.isidentifier():
        raise BadArgument(field, f"must have names of letters, digits and underscores as keys, got {name!r}")
    return name


def _read_only(array: AnyArray, value: object) -> AnyArray:
    # Its maker must neither change it later nor find it locked. So what is not fresh is copied, unless it is locked.
    is_fresh = array is not value and array.flags.owndata
    is_locked = not array.flags.writeable and array.flags.owndata
    if not (is_fresh or is_locked):
        array = array.copy()
    array.flags.writeable = False
    return array


# ---- what a trial holds ----------------------------------------------------------------------------------------------


FORCE_COMPONENTS = ("drag", "added_mass", "effector")
_NEEDED = ("time", "center_of_mass", "center_of_mass_velocity", "electrical_work")
NOT_NEEDED = tuple(name for name in series.SERIES if name not in _NEEDED)
"""What a measured trial may lack; where the robot was is what every trial has."""


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def shapes_of(robot: Robot, n_samples: int, n_axes: int) -> dict[str, tuple[int, ...]]:
    """Shapes of the arrays of a trial by name.

    Args:
        robot: What swims.
        n_samples: How many samples there are.
        n_axes: 2 in the plane, 3 in space.
    """
    n_links = (robot if n_axes == 3 else robot.planar()).n_links
    n = {"time": n_samples, "axis": n_axes, "link": n_links, "joint": n_links - 1, "3": 3}
    return {name: tuple(n[of] for of in one.dimensions) for name, one in series.SERIES.items()}


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Contents(series.Log):
    """What a trial holds, a log and what made it, checked; `Trial` adds what follows from it.

    All arrays are float64, finite and read-only. A log in the plane has one column per link of `robot.planar()`, a log
    in space (three columns in `center_of_mass`) one per module of `robot`. Nothing about a trial can be changed:
    `dataclasses.replace` makes another one.

    Raises:
        ValueError: If an array has the wrong shape, holds something else than finite numbers, or time does not
            increase.
    """

    scenario: scenarios.Scenario | scenarios.Experiment
    """What swam, how, where and by which model: `laticauda.swim` makes the same trial of a scenario again. An
    experiment says what is known of a run that was measured, or steered by hand."""
    version: str
    """Version of laticauda that made the run."""
    created: str = dataclasses.field(default_factory=_now)
    """When it was made: date and time of day with its zone, ISO 8601."""
    status: str = "The run reached its end."
    """How the run ended: a sentence, with advice where it failed."""
    succeeded: bool = True
    """Whether the run reached its end."""
    not_measured: tuple[str, ...] = ()
    """Arrays that nobody measured, see `NOT_NEEDED`: they hold zeros, and figures that need them refuse."""
    state: Mapping[str, AnyArray] = dataclasses.field(default_factory=dict[str, AnyArray])
    """The plant's final state, from which the run can go on; empty where there is none."""

    def __post_init__(self) -> None:
        """Check everything and freeze every array, once."""
        instance("scenario", self.scenario, scenarios.Scenario, scenarios.Experiment)
        flag("succeeded", self.succeeded)
        for name in ("version", "created", "status"):
            text(name, getattr(self, name))
        for name, value in self._clean().items():
            object.__setattr__(self, name, value)
        object.__setattr__(self, "not_measured", names("not_measured", self.not_measured, NOT_NEEDED))

    @property
    def robot(self) -> Robot:
        """What swam."""
        return self.scenario.robot

    @property
    def gait(self) -> gaits.Gait | None:
        """What the joints were asked for, at first where it was steered; None where no gait was."""
        return self.scenario.gait

    @property
    def environment(self) -> Water | Ground:
        """What it swam or crawled in."""
        return self.scenario.environment

    @property
    def settings(self) -> Mapping[str, Setting]:
        """How the run was made, in texts and numbers: controller and model, or what is known of an experiment."""
        return self.scenario.settings

    @property
    def period(self) -> float | None:
        """Period of the gait, 2 pi / frequency [s]; None without a gait, or if it stands still."""
        return 2.0 * np.pi / self.gait.frequency if self.gait is not None and self.gait.frequency > 0.0 else None

    @property
    def chain(self) -> Robot:
        """The robot whose links the columns of `link_angle` are."""
        return self.robot if self.center_of_mass.shape[1] == 3 else self.robot.planar()

    @property
    def fin_angle(self) -> FinJoints:
        """Angles of the joints of a fin that is driven or bends, from its root on; 0 where it lacks them [rad]."""
        return self._of_fin("fin_angle")

    @property
    def fin_rate(self) -> FinJoints:
        """Their rates [rad/s]."""
        return self._of_fin("fin_rate")

    def _of_fin(self, name: str) -> FinJoints:
        joints, nothing = self.robot.fin_joints, np.zeros(self.time.size)
        return np.array([self.signals.get(f"{name}_{k}", nothing) for k in joints]).reshape(-1, self.time.size).T

    def _clean(self) -> dict[str, object]:
        """Arrays and mappings as they are kept."""
        clean: dict[str, object] = {"time": times("time", self.time)}
        center = floats("center_of_mass", self.center_of_mass, (len(self.time), None))
        n_axes = center.shape[1]
        if n_axes not in (2, 3):
            raise BadArgument("center_of_mass", f"must have 2 or 3 columns, got {n_axes}")
        shapes = shapes_of(self.robot, len(self.time), n_axes)
        for name, shape in shapes.items():
            if name != "time" and getattr(self, name) is not None:
                clean[name] = floats(name, getattr(self, name), shape)
        clean["link_force"] = forces(self.link_force, (*shapes["link_angle"], n_axes))
        clean["signals"] = signals(self.signals, len(self.time))
        state = mapping("state", self.state)
        clean["state"] = {key: state_array(key, value) for key, value in state.items()}
        return clean

    def equals(self, other: object) -> bool:
        """Whether `other` is a trial that holds the same, bit for bit: every array, setting and text."""
        if not isinstance(other, Contents):
            return False
        names = (field.name for field in dataclasses.fields(self))
        return all(same(getattr(self, name), getattr(other, name)) for name in names)

    def need(self, purpose: str, *names: str) -> None:
        """Refuse a measured trial that lacks something.

        Args:
            purpose: What it is needed for, in words.
            names: Of arrays, as in `not_measured`.

        Raises:
            ValueError: If one of them was not measured.
        """
        for name in names:
            if name in self.not_measured:
                raise ValueError(f"The trial must have a measured `{name}` for {purpose}, and it has none.")
