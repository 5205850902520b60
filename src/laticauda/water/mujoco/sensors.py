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
from laticauda.compiling.templates import named_after, sources_digest
from laticauda.values import load_mujoco
from laticauda.water.mujoco.callback import (
    REGISTRY_SIZE,
    SCRATCH,
    collect,
    registry,
    registry_address,
    table_of,
)
from laticauda.water.mujoco.native import allocate, call_3, free_stack, library, mark_stack
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

ACCELERATIONS = 3  # MuJoCo's stage, mjSTAGE_ACC
_KINDS = {"FORCE": -2, "TORQUE": -3}  # by type name: `refid` of the user sensor that replaces it


def take_over(model: Any) -> np.ndarray:
    """Take over a model's force and torque sensors; those with a history remain MuJoCo's.

    Args:
        model: The `mujoco.MjModel`.

    Returns:
        Per sensor: index of its data, its site, the site's body, and 1 if it senses force, else 0.
    """
    kinds, found = load_mujoco().mjtSensor, np.zeros((0, 4), dtype=np.int64)
    history = np.reshape(getattr(model, "sensor_history", np.zeros(2 * model.nsensor)), (-1, 2))[
        :, 0
    ]
    for name, sign in _KINDS.items():
        plain = (model.sensor_type == int(getattr(kinds, f"mjSENS_{name}"))) & (history == 0)
        own = np.flatnonzero(plain | _taken(model, sign))
        model.sensor_type[own], model.sensor_refid[own] = int(kinds.mjSENS_USER), sign
        site = model.sensor_objid[own]
        rows = (
            model.sensor_adr[own],
            site,
            model.site_bodyid[site],
            np.full(own.size, name == "FORCE"),
        )
        found = np.vstack([found, np.column_stack(rows)])
    return found.ravel()


def _taken(model: Any, sign: int) -> np.ndarray:
    return (model.sensor_type == int(load_mujoco().mjtSensor.mjSENS_USER)) & (
        model.sensor_refid == sign
    )


def give_back(model: Any) -> None:
    """Restore the sensors that were taken over.

    Args:
        model: The `mujoco.MjModel`.
    """
    for name, sign in _KINDS.items():
        own = _taken(model, sign)
        model.sensor_type[own], model.sensor_refid[own] = (
            int(getattr(load_mujoco().mjtSensor, f"mjSENS_{name}")),
            -1,
        )


def install() -> None:
    """Install the sensor callback, chaining to an existing one."""
    there, own = ctypes.c_void_p.in_dll(library(), "mjcb_sensor"), int(callback().address)
    if there.value != own:
        registry[REGISTRY_SIZE - 1] = there.value or 0
        there.value = own


@kernel
def water_below(T, data, S):
    """Replace every body's load with the total on it and its descendants, at the accelerations found."""
    n = T[N_BODIES]
    parent, cacc = integers(T[PARENT], n), field(data, T[AT.cacc], 6 * n)
    for b in range(n - 1, 0, -1):
        F, A = 6 * (n + b), 12 * n + 21 * b
        a = S[6 * b : 6 * b + 6]
        for k in range(
            6
        ):  # the part due to joint accelerations; MuJoCo's start from the world's, which is -g
            a[k] = cacc[6 * b + k] - cacc[k] - a[k]
        for row in range(3):
            for column in range(3):
                K = (
                    A + (row * (5 - row)) // 2 + column
                    if row <= column
                    else A + (column * (5 - column)) // 2 + row
                )
                S[F + row] -= S[K] * a[column] + S[A + 6 + 3 * row + column] * a[3 + column]
                S[F + 3 + row] -= (
                    S[A + 6 + 3 * column + row] * a[column] + S[K + 15] * a[3 + column]
                )
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
    S = numbers(allocate(data, SCRATCH * n + 16), SCRATCH * n + 16)
    collect(T, model, data, S)
    water_below(T, data, S)
    com, inner = field(data, T[AT.subtree_com], 3 * n), field(data, T[AT.cfrc_int], 6 * n)
    sensors, root = integers(T[SENSORS], 4 * T[N_SENSORS]), integers(T[ROOT], n)
    for i in range(T[N_SENSORS]):
        at, site, body = sensors[4 * i], sensors[4 * i + 1], sensors[4 * i + 2]
        place = three(field(data, T[AT.site_xpos], 3 * site + 3), 3 * site)
        R = field(data, T[AT.site_xmat], 9 * site + 9)
        force = plus(three(inner, 6 * body + 3), scaled(-1.0, three(S, 6 * (n + body) + 3)))
        found = force
        if sensors[4 * i + 3] == 0:
            torque = plus(three(inner, 6 * body), scaled(-1.0, three(S, 6 * (n + body))))
            found = plus(
                torque, cross(force, plus(place, scaled(-1.0, three(com, 3 * root[body]))))
            )
        x, y, z = to_own(nine(R, 9 * site), found)
        readings = field(data, T[AT.sensordata], at + 3)
        readings[at], readings[at + 1], readings[at + 2] = x, y, z
    free_stack(data)


def _sensors(model, data, stage):
    table = table_of(model)
    if stage == ACCELERATIONS and table != 0:
        sense(model, data, table)
    before = integers(registry_address(), REGISTRY_SIZE)[REGISTRY_SIZE - 1]
    if before != 0:
        call_3(before, model, data, np.int64(stage))


@cache
def callback() -> Any:
    """Return the sensor callback for all models with water: a compiled function of model, data and stage."""
    return for_c(
        types.void(types.int64, types.int64, types.int32),
        named_after(sources_digest(__name__), _sensors),
    )
