"""Force and torque sensors of a model in water, with the readings of real ones.

MuJoCo computes the load between a body and its parent after it has solved for the accelerations,
from the inertia of the bodies and the forces known to it, which exclude passive forces. The water's
load on a body is a passive force, and that of its added mass is known only then. The force and
torque sensors of a model with water are therefore converted to user sensors, which MuJoCo leaves to
a callback at that stage: the callback subtracts the water's load on a sensor's body and all its
descendants from MuJoCo's result.

A sensor's original type is kept in its `refid`, unused by these two types, so copies and files of
the model have it.
"""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false, reportUntypedFunctionDecorator=false
# pyright: reportWildcardImportFromLibrary=false
# pyright: reportCallIssue=false

import ctypes
from functools import cache
from typing import Any

import numpy as np
from numba import types

from laticauda.compiling import for_c, kernel
from laticauda.compiling.templates import named_after
from laticauda.values import load_mujoco
from laticauda.values.sources import sources_digest
from laticauda.water.mujoco.callback import LAW_SCRATCH, SCRATCH, collect
from laticauda.water.mujoco.native import allocate, call_3, free_stack, library, mark_stack
from laticauda.water.mujoco.registry import (
    PREVIOUS_SENSOR,
    REGISTRY_SIZE,
    registry,
    registry_address,
    table_of,
)
from laticauda.water.mujoco.table import *
from laticauda.water.mujoco.vectors import (
    cross,
    field,
    integers,
    nine,
    numbers,
    plus,
    scaled,
    three,
    to_own,
)

ACCELERATIONS = 3
"""MuJoCo's stage at which accelerations are known, mjSTAGE_ACC."""
COLUMNS = 4
"""Numbers per sensor, see `take_over`."""
_CODES = {"FORCE": -2, "TORQUE": -3}
"""By the name of a sensor's type: `refid` of the user sensor that replaces it."""


def take_over(model: Any) -> np.ndarray:
    """Take over a model's force and torque sensors; those with a history remain MuJoCo's.

    Args:
        model: The `mujoco.MjModel`.

    Returns:
        Per sensor: index of its data, its site, the site's body, and 1 if it senses force, else 0.
    """
    types_of_sensors = load_mujoco().mjtSensor
    tables: list[np.ndarray] = []
    for name, code in _CODES.items():
        type_number = int(getattr(types_of_sensors, f"mjSENS_{name}"))
        is_plain = (model.sensor_type == type_number) & ~_has_history(model)
        sensors = np.flatnonzero(is_plain | _is_taken_over(model, code))
        model.sensor_type[sensors] = int(types_of_sensors.mjSENS_USER)
        model.sensor_refid[sensors] = code
        site = model.sensor_objid[sensors]
        body = model.site_bodyid[site]
        is_force = np.full(sensors.size, name == "FORCE")
        tables.append(np.column_stack((model.sensor_adr[sensors], site, body, is_force)))
    return np.vstack(tables).astype(np.int64).ravel()


def _has_history(model: Any) -> np.ndarray:
    """Return which sensors MuJoCo delays or keeps the past of; versions without such sensors have none."""
    without = np.zeros(2 * model.nsensor)
    history = np.reshape(getattr(model, "sensor_history", without), (-1, 2))
    return history[:, 0] != 0


def _is_taken_over(model: Any, code: int) -> np.ndarray:
    user_type = int(load_mujoco().mjtSensor.mjSENS_USER)
    return (model.sensor_type == user_type) & (model.sensor_refid == code)


def give_back(model: Any) -> None:
    """Restore the sensors that were taken over.

    Args:
        model: The `mujoco.MjModel`.
    """
    for name, code in _CODES.items():
        sensors = _is_taken_over(model, code)
        model.sensor_type[sensors] = int(getattr(load_mujoco().mjtSensor, f"mjSENS_{name}"))
        model.sensor_refid[sensors] = -1


def install() -> None:
    """Install the sensor callback, chaining to an existing one."""
    current = ctypes.c_void_p.in_dll(library(), "mjcb_sensor")
    address = int(callback().address)
    if current.value != address:
        registry[PREVIOUS_SENSOR] = current.value or 0
        current.value = address


@kernel
def triangle_index(row, column):
    """Return the index of an element of a symmetric 3 x 3 matrix whose upper triangle is stored row by row."""
    if row <= column:
        return (row * (5 - row)) // 2 + column
    return (column * (5 - column)) // 2 + row


@kernel
def water_below(T, data, S):
    """Replace every body's load with the total on it and its descendants, at the accelerations found."""
    n = T[N_BODIES]
    parent = integers(T[PARENT], n)
    cacc = field(data, T[AT.cacc], 6 * n)
    for b in range(n - 1, 0, -1):
        F = 6 * (n + b)
        A = 12 * n + 21 * b
        a = S[6 * b : 6 * b + 6]
        # The part due to joint accelerations; MuJoCo's start from the world's, which is -g.
        for k in range(6):
            a[k] = cacc[6 * b + k] - cacc[k] - a[k]
        for row in range(3):
            for column in range(3):
                K = A + triangle_index(row, column)
                B = A + 6 + 3 * row + column
                B_T = A + 6 + 3 * column + row
                N = K + 15
                S[F + row] -= S[K] * a[column] + S[B] * a[3 + column]
                S[F + 3 + row] -= S[B_T] * a[column] + S[N] * a[3 + column]
        if parent[b] > 0:
            for k in range(6):
                S[6 * (n + parent[b]) + k] += S[F + k]


@kernel
def sense(model, data, table):
    """Compute the readings of one model's force and torque sensors."""
    T = integers(table, TABLE_SIZE)
    n = T[N_BODIES]
    if T[N_SENSORS] == 0:
        return
    mark_stack(data)
    n_scratch = SCRATCH * n + LAW_SCRATCH
    S = numbers(allocate(data, n_scratch), n_scratch)
    collect(T, model, data, S)
    water_below(T, data, S)
    com = field(data, T[AT.subtree_com], 3 * n)
    inner = field(data, T[AT.cfrc_int], 6 * n)
    sensors = integers(T[SENSORS], COLUMNS * T[N_SENSORS])
    root = integers(T[ROOT], n)
    for i in range(T[N_SENSORS]):
        first = COLUMNS * i
        at = sensors[first]
        site = sensors[first + 1]
        body = sensors[first + 2]
        is_force = sensors[first + 3]
        place = three(field(data, T[AT.site_xpos], 3 * site + 3), 3 * site)
        R = field(data, T[AT.site_xmat], 9 * site + 9)
        force = plus(three(inner, 6 * body + 3), scaled(-1.0, three(S, 6 * (n + body) + 3)))
        load = force
        if is_force == 0:
            torque = plus(three(inner, 6 * body), scaled(-1.0, three(S, 6 * (n + body))))
            arm = plus(place, scaled(-1.0, three(com, 3 * root[body])))
            load = plus(torque, cross(force, arm))
        x, y, z = to_own(nine(R, 9 * site), load)
        readings = field(data, T[AT.sensordata], at + 3)
        readings[at] = x
        readings[at + 1] = y
        readings[at + 2] = z
    free_stack(data)


def _sensors(model, data, stage):
    table = table_of(model)
    if stage == ACCELERATIONS and table != 0:
        sense(model, data, table)
    previous = integers(registry_address(), REGISTRY_SIZE)[PREVIOUS_SENSOR]
    if previous != 0:
        call_3(previous, model, data, np.int64(stage))


@cache
def callback() -> Any:
    """Return the sensor callback for all models with water: a compiled function of model, data and stage."""
    return for_c(
        types.void(types.int64, types.int64, types.int32),
        named_after(sources_digest(__name__), _sensors),
    )
