"""Fill the table that the compiled loads of one model read, see `table`."""

from collections.abc import Sequence
from dataclasses import astuple
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import check_finite, check_positive, load_mujoco
from laticauda.water.mujoco import hydrostatics, native, table as rows
from laticauda.water.mujoco.bodies import body_of
from laticauda.water.mujoco.checks import check_model
from laticauda.water.mujoco.elements import Element
from laticauda.water.mujoco.ground import Terrain
from laticauda.water.mujoco.law_functions import compile_law
from laticauda.water.mujoco.registry import LOST_FLOW

ARRAYS = {
    "parent": rows.PARENT,
    "first_dof": rows.FIRST_DOF,
    "root": rows.ROOT,
    "dof_body": rows.DOF_BODY,
    "dof_parent": rows.DOF_PARENT,
    "row_end": rows.ROW_END,
    "row_length": rows.ROW_LENGTH,
    "element_body": rows.ELEMENT_BODY,
    "elements": rows.ELEMENTS,
    "water": rows.WATER,
    "laws": rows.LAWS,
    "nodes": rows.GRID,
}
"""Arrays whose addresses are in the table, and where."""


class FilledTable(NamedTuple):
    """The table of one model, and what it points to."""

    table: np.ndarray
    """Addresses and offsets for the compiled code."""
    arrays: dict[str, np.ndarray]
    """Arrays that the table points to, by name; they must live as long as the table."""


def fill_table(model: Any, elements: Sequence[Element], options: dict[str, Any]) -> FilledTable:
    """Return the table of a model, without its flows and sensors.

    Args:
        model: The `mujoco.MjModel`.
        elements: Its elements.
        options: The other arguments of `attach`.

    Raises:
        ValueError: If the model or an argument is not supported; the message gives the reason.
    """
    water = _numbers_of_water(options)
    bodies = np.array([body_of(model, element.body) for element in elements])
    implicit_drag = options["implicit_drag"]
    has_inertia = implicit_drag or any(_has_inertia(element) for element in elements)
    heavy: set[int] = set()
    if has_inertia:
        heavy = set(bodies.tolist())
    check_model(model, elements, heavy, implicit_drag)

    terrain = options["terrain"] or Terrain()
    arrays = _arrays_of_model(model)
    arrays["element_body"] = bodies.astype(np.int64)
    arrays["elements"] = np.concatenate([_record_of(element) for element in elements])
    arrays["water"] = water
    addresses = [compile_law(element.law).address for element in elements]
    arrays["laws"] = np.array(addresses, dtype=np.int64)
    arrays["nodes"] = terrain.nodes
    _add_own_inertias(model, bodies, arrays["elements"].reshape(-1, rows.ELEMENT_SIZE))

    mujoco = load_mujoco()
    table = np.zeros(rows.TABLE_SIZE, dtype=np.int64)
    _write_offsets(table)
    for name, place in ARRAYS.items():
        table[place] = arrays[name].ctypes.data
    table[rows.GRID_SIZE] = arrays["nodes"].size
    table[rows.N_BODIES] = model.nbody
    table[rows.N_DOFS] = model.nv
    table[rows.N_ELEMENTS] = len(elements)
    table[rows.NO_GRAVITY] = int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    table[rows.HAS_INERTIA] = has_inertia
    table[rows.IMPLICIT_DRAG] = implicit_drag
    table[rows.HAS_SURFACE] = options["surface"] is not None
    table[rows.FIRST_ORDER] = model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4
    table[rows.FLOW_LOST] = LOST_FLOW
    return FilledTable(table=table, arrays=arrays)


def _numbers_of_water(options: dict[str, Any]) -> np.ndarray:
    water = np.zeros(rows.WATER_SIZE)
    water[rows.DENSITY] = check_positive("density", options["density"], "kg/m^3")
    if options["surface"] is not None:
        water[rows.LEVEL] = check_finite("surface", options["surface"], "m")
    water[rows.OWN_VELOCITY] = options["form"] != "classic"
    water[rows.KIRCHHOFF] = options["form"] == "kirchhoff"
    terrain = options["terrain"] or Terrain()
    water[rows.TERRAIN : rows.WATER_SIZE] = terrain.profile
    return water


def _has_inertia(element: Element) -> bool:
    return any(element.added_mass) or any(element.added_inertia)


def _arrays_of_model(model: Any) -> dict[str, np.ndarray]:
    """Return how the bodies, degrees of freedom and inertia matrix of a model are connected."""
    first_dof = np.zeros(model.nbody + 1, dtype=np.int64)
    first_dof[1:] = np.cumsum(model.body_dofnum)
    return {
        "parent": model.body_parentid.astype(np.int64),
        "first_dof": first_dof,
        "root": model.body_rootid.astype(np.int64),
        "dof_body": model.dof_bodyid.astype(np.int64),
        "dof_parent": model.dof_parentid.astype(np.int64),
        "row_end": (model.M_rowadr + model.M_rownnz - 1).astype(np.int64),
        "row_length": model.M_rownnz.astype(np.int64),
    }


def _write_offsets(table: np.ndarray) -> None:
    """Write the offsets of MuJoCo's fields in the data and in the model."""
    table[: len(rows.AT)] = native.offsets()
    offsets_in_model = native.model_offsets()
    for name, place in rows.IN_MODEL._asdict().items():
        table[place] = offsets_in_model[name]


def _add_own_inertias(model: Any, bodies: np.ndarray, records: np.ndarray) -> None:
    """Write what moves with each element without water: its share of the body's mass and least inertia.

    Bodies without a joint between them are one rigid body, whose mass and inertia its elements with
    added mass share evenly.
    """
    rigid = model.body_weldid
    is_loaded = records[:, rows.MASS : rows.INERTIA + 3].any(axis=1)
    n_loaded = np.bincount(rigid[bodies], is_loaded, model.nbody)
    sharing = np.maximum(n_loaded, 1.0)
    mass = np.bincount(rigid, model.body_mass, model.nbody)
    inertia = np.bincount(rigid, model.body_inertia.min(axis=1), model.nbody)
    records[:, rows.OWN_MASS] = (mass / sharing)[rigid[bodies]]
    records[:, rows.OWN_INERTIA] = (inertia / sharing)[rigid[bodies]]


COMPUTED_LATER = ("edge", "edge_memory", "own_mass", "own_inertia")
"""Fields of a record that are no fields of an element."""


def _record_of(element: Element) -> np.ndarray:
    """Return the numbers of an element; what it does not have, and its own inertia, are 0."""
    record = np.zeros(rows.ELEMENT_SIZE)
    for name, start in rows.STARTS.items():
        values = _values_of(element, name)
        record[start : start + values.size] = values
    numbers = element.law.numbers
    record[rows.LAW_NUMBERS : rows.LAW_NUMBERS + len(numbers)] = numbers
    return record


def _values_of(element: Element, name: str) -> np.ndarray:
    """Return the numbers of one field of a record; none if the element does not have it."""
    if name in COMPUTED_LATER:
        return np.zeros(0)
    if name == "shape":
        return np.array([getattr(hydrostatics, element.shape.upper())])
    value = getattr(element, name)
    if value is None:
        return np.zeros(0)
    if name == "contact":
        return np.array(astuple(value))
    return np.ravel(value)
