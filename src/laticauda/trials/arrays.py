"""Checks of a trial's arrays and texts: each returns the value as stored, or raises a ValueError naming the field."""

import dataclasses
from collections.abc import Collection, Mapping
from typing import TypeAlias, cast

import numpy as np
from jaxtyping import Float, Shaped

from laticauda.values import BadArgument, as_floats, check_choice, check_instance

# Shapes of a trial's arrays. `Trial` imports them from here and checks the arrays itself, whatever
# it is given.
Samples: TypeAlias = Float[np.ndarray, " n_samples"]
FinJoints: TypeAlias = Float[np.ndarray, "n_samples n_fin_joints"]
Setting: TypeAlias = str | float | bool | None
AnyArray: TypeAlias = Shaped[np.ndarray, "..."]


def check_floats(
    name: str, values: object, shape: tuple[int | None, ...], *, may_lack: bool = False
) -> Float[np.ndarray, "..."]:
    """Return `values` as a read-only float64 array of the given shape; None stands for any length.

    Numbers must be finite, but nan is taken as missing with `may_lack`.
    """
    array = as_floats(name, values)
    if not _has_shape(array, shape):
        lengths = ", ".join("any" if length is None else str(length) for length in shape)
        raise BadArgument(name, f"must have shape ({lengths}), got {array.shape}")
    is_right = np.isfinite(array)
    if may_lack:
        is_right |= np.isnan(array)
    if not is_right.all():
        row = int(np.argwhere(~is_right)[0][0])
        raise BadArgument(name, f"must hold finite numbers only, got {array[row]} at sample {row}")
    return _read_only(array, values)


def _has_shape(array: AnyArray, shape: tuple[int | None, ...]) -> bool:
    if array.shape == shape:
        return True
    if array.ndim != len(shape):
        return False
    return all(length in (None, size) for length, size in zip(shape, array.shape, strict=True))


def check_times(name: str, values: object) -> Samples:
    """Return `values` as read-only times, at least one, strictly increasing."""
    time = check_floats(name, values, (None,))
    if time.size < 1:
        raise BadArgument(name, "must have at least 1 sample, got 0")
    increases = np.diff(time) > 0.0
    if not np.all(increases):
        i = int(np.argmin(increases))
        raise BadArgument(name, f"must increase strictly, got {time[i]} s and then {time[i + 1]} s")
    return time


def check_each(
    name: str, value: object, shape: tuple[int, ...], *, may_lack: Collection[str] = ()
) -> dict[str, Float[np.ndarray, "..."]]:
    """Return every value of a mapping as a read-only array of the given shape; nan only under names in `may_lack`."""
    return {
        key: check_floats(f"{name}[{key!r}]", values, shape, may_lack=key in may_lack)
        for key, values in check_mapping(name, value).items()
    }


def check_mapping(name: str, value: object) -> Mapping[str, object]:
    """Return `value` as a mapping whose keys can be names of variables in a file."""
    items = cast("Mapping[object, object]", check_instance(name, value, Mapping))
    for key in items:
        if not isinstance(key, str) or not key.isidentifier():
            raise BadArgument(
                name, f"must have names of letters, digits and underscores as keys, got {key!r}"
            )
    return cast("Mapping[str, object]", items)


def check_state_array(name: str, value: object) -> AnyArray:
    """Return `value` as a read-only array of its own dtype, in native byte order."""
    array = np.asarray(value)
    if array.dtype.kind not in "biuf" or array.dtype.itemsize > 8 or array.dtype == np.float16:
        raise ValueError(
            f"`state[{name!r}]` must be an array of numbers or truth values, got {array.dtype}."
        )
    return _read_only(np.asarray(array, dtype=array.dtype.newbyteorder("="), order="C"), value)


def choose_names(name: str, value: object, choices: tuple[str, ...]) -> tuple[str, ...]:
    """Return those names in `choices` that `value` contains, in the order of `choices`."""
    names: tuple[object, ...] = (value,)
    if isinstance(value, tuple | list):
        names = tuple(cast("list[object]", value))
    for stated_name in names:
        check_choice(name, stated_name, choices)
    return tuple(choice for choice in choices if choice in names)


def are_same(first: object, second: object) -> bool:
    """Return whether two contents are the same, arrays bit for bit."""
    if isinstance(first, np.ndarray) and isinstance(second, np.ndarray):
        return _are_same_arrays(cast("AnyArray", first), cast("AnyArray", second))
    if isinstance(first, dict) and isinstance(second, dict):
        first_items = cast("dict[str, object]", first)
        second_items = cast("dict[str, object]", second)
        if first_items.keys() != second_items.keys():
            return False
        return all(are_same(value, second_items[name]) for name, value in first_items.items())
    value = cast("object", first)
    other = second
    if value is other:
        return True
    if type(value) is not type(other):  # 1 is not True here
        return False
    if isinstance(value, tuple):
        items = cast("tuple[object, ...]", value)
        other_items = cast("tuple[object, ...]", other)
        return len(items) == len(other_items) and all(map(are_same, items, other_items))
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
        return all(are_same(getattr(value, name), getattr(other, name)) for name in names)
    # The texts of numbers distinguish 0 from -0.
    return value == other and repr(value) == repr(other)


def _are_same_arrays(first: AnyArray, second: AnyArray) -> bool:
    if first.dtype != second.dtype or first.shape != second.shape:
        return False
    return first.tobytes() == second.tobytes()


def _read_only(array: AnyArray, value: object) -> AnyArray:
    """Return an array that nobody can change: the same if it is new or already locked, else a copy.

    The caller must neither be able to change it later nor find that of his own locked.
    """
    is_fresh = array is not value and array.flags.owndata
    is_locked = not array.flags.writeable and array.flags.owndata
    if not (is_fresh or is_locked):
        array = array.copy()
    array.flags.writeable = False
    return array
