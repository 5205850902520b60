"""Water attached to a MuJoCo model.

The loads are computed by one compiled passive callback. Callbacks belong to the whole process, so
one serves all models: it looks up the model and ignores those without water. It can run in threads
(`mujoco.rollout`, `mujoco.batch`), because its scratch memory is the data's own stack.
"""

import copyreg
import hashlib
import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass, replace
from pathlib import Path
from threading import Lock
from typing import Any, TypeAlias

import numpy as np

from laticauda.compiling.formulas import digest_of
from laticauda.compiling.templates import load, sources_digest
from laticauda.values import (
    BadArgument,
    Formula,
    check_choice,
    check_finite,
    check_instance,
    check_positive,
    load_mujoco,
)
from laticauda.water.fluid.flow import Flow, FunctionFlow, rows_of
from laticauda.water.fluid.laws import DragLaw
from laticauda.water.mujoco import callback, hydrostatics, native, sensors, table as rows
from laticauda.water.mujoco.checks import body_of, check_model, element_pose, make_room, warn_of
from laticauda.water.mujoco.elements import Element, geom_elements
from laticauda.water.mujoco.ground import Terrain

Current: TypeAlias = (
    Flow | Callable[[float, float, float, float], tuple[float, ...]] | Sequence[float]
)
FORMS = ("relative", "kirchhoff", "classic")
_lock = Lock()  # one evaluation of forces at a time: their destination is in the table


@dataclass(frozen=True, kw_only=True, eq=False)
class Water:
    """Water attached to a model; created by `attach`. It stays as long as the model lives, or until `detach`."""

    model: Any
    """Weak reference to the `mujoco.MjModel`."""
    elements: tuple[Element, ...]
    """The elements, in the order in which they were given."""
    options: dict[str, Any]
    """The other arguments of `attach`."""
    table: np.ndarray
    """Addresses and offsets for the compiled code; see `table`."""
    numbers: dict[str, Any]
    """Arrays that the table points to."""

    def detach(self) -> None:
        """Remove the water from the model; copies of it keep theirs."""
        model = self._live()
        callback.remove_mark(model)
        sensors.give_back(model)

    @property
    def active(self) -> bool:
        """Whether the callback is installed: another package may have replaced it."""
        return callback.is_installed()

    def set_current(self, current: Current | None) -> None:
        """Set the motion of the water of this model, and of copies made of it later.

        Args:
            current: Velocity, world axes [m/s], a flow, or a function of x, y, z [m] and t [s] like
                one; None: as attached. A water keeps the last 64 flows that it was given; a copy
                whose flow is no longer among them is rejected.
        """
        self._live().opt.o_friction[:4] = _motion(
            self.numbers, self.options["current"] if current is None else current
        )

    @property
    def current(self) -> Current:
        """Current motion of the water of this model: a flow or a function, or its velocity [m/s]."""
        *velocity, number = self._live().opt.o_friction[:4].tolist()
        return self.numbers["given"][int(number)][0] if number else tuple(velocity)

    def forces(self, data: Any) -> dict[str, np.ndarray]:
        """Return the loads on every element at the state in `data`, which is evaluated again (`mj_forward`).

        Args:
            data: A `mujoco.MjData` of the model.

        Returns:
            Arrays of shape (n_elements, 3), world axes: `drag`, `added_mass` (with the force of
            accelerating water on the displaced volume), `buoyancy` and `effector` (thrust, tether,
            wake, plate) [N]. `added_mass` is that for the accelerations in `data` after the call.
        """
        out = np.zeros((len(self.elements), rows.OUT_SIZE))
        model = self._live()
        with _lock:
            self.table[rows.OUT] = out.ctypes.data
            try:
                load_mujoco().mj_forward(model, data)
            finally:
                self.table[rows.OUT] = 0
        names = ("drag", "added_mass", "buoyancy", "effector")
        found = {name: out[:, 3 * i : 3 * i + 3].copy() for i, name in enumerate(names)}
        found["added_mass"] -= self._carried(model, data) * out[:, 12:]
        return found

    def _carried(self, model: Any, data: Any) -> np.ndarray:
        """Return added mass times the acceleration of every element's center due to the joints' accelerations [N]."""
        mujoco = load_mujoco()
        force, jacobian = np.zeros((len(self.elements), 3)), np.zeros((3, model.nv))
        for i, element in enumerate(self.elements):
            body, place, axes = element_pose(model, data, element)
            mujoco.mj_jac(model, data, jacobian, None, place, body)
            force[i] = axes @ (np.array(element.added_mass) * (axes.T @ (jacobian @ data.qacc)))
        return force

    def _live(self) -> Any:
        model = self.model()
        if model is None:
            raise BadArgument("model", "must still exist, but the model of this water is gone")
        return model


def attach(
    model: Any,
    elements: Iterable[Element] | None = None,
    *,
    density: float = 1000.0,
    current: Current = (0.0, 0.0, 0.0),
    surface: float | None = None,
    form: str = "kirchhoff",
    implicit_drag: bool = False,
    usual_speed: float = 1.0,
    terrain: Terrain | None = None,
) -> Water:
    """Attach water to a model, replacing any water attached before.

    A copy of the model has the water too, with its own current (see `attached`), and so does a
    pickled model when it is loaded. An MJB file contains only the mark of the water: stepping a
    model loaded from it is rejected.

    Args:
        model: A `mujoco.MjModel` from `mujoco` or `compiled`, or an object that holds one as `ptr`,
            as in dm_control.
        elements: Elements on which the water acts; None: `geom_elements`.
        density: Density rho, for the buoyancy [kg/m^3].
        current: Motion of the water: its velocity, world axes [m/s]; or a flow
            (`laticauda.water.fluid.flow.Flow`), or a function of x, y, z [m] and t [s] like one, which
            returns the velocity or the 16 numbers of a `Motion`. Its z is relative to the mean
            surface; its elevation of the surface affects buoyancy and wetting.
        surface: Mean height of the surface [m]; None: everything is submerged.
        form: Velocity terms of the added mass: `kirchhoff` for the complete ones, `relative`
            without the Munk moment, or `classic` for the acceleration alone.
        implicit_drag: Include the drag's slope in the inertia of the step. Stable at any step, and
            of first order in it; for the integrators Euler and implicitfast only. The accelerations
            in the data are then those of the step, and no longer forces over inertia.
        usual_speed: Speed at which the step is checked against the drag [m/s].
        terrain: Ground for elements with a `contact`; None: flat at height 0.

    Returns:
        A handle. The water stays attached without it, for as long as the model lives.

    Raises:
        ValueError: If the model or an argument is not supported; the message gives the reason.
        MissingExtra: If MuJoCo is not installed.
    """
    check_instance("model", model := getattr(model, "ptr", model), load_mujoco().MjModel)
    check_positive("usual_speed", usual_speed, "m/s")
    fitted = elements is None
    make_room(model)
    elements = geom_elements(model, density=density) if elements is None else tuple(elements)
    if not elements or not all(isinstance(e, Element) for e in elements):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadArgument(
            "elements", f"must hold at least one Element, and nothing else, got {elements!r:.60}"
        )
    options = {"density": density, "current": current, "surface": surface, "form": form}
    water = _put(model, elements, {**options, "implicit_drag": implicit_drag, "terrain": terrain})
    warn_of(model, water, None if implicit_drag else usual_speed, fitted)
    return water


def attached(model: Any) -> Water | None:
    """Return the water of `model`, be it the original model, a copy, or one from a pickle; None: no water.

    Args:
        model: A `mujoco.MjModel`, or an object that holds one as `ptr`.
    """
    check_instance("model", model := getattr(model, "ptr", model), load_mujoco().MjModel)
    water = callback.find_water(model)
    return water and replace(water, model=weakref.ref(model))


def _put(model: Any, elements: tuple[Element, ...], options: dict[str, Any]) -> Water:
    check_choice("form", options["form"], FORMS)
    water = np.zeros(rows.WATER_SIZE)
    water[rows.DENSITY] = check_positive("density", options["density"], "kg/m^3")
    water[rows.LEVEL] = (
        0.0 if options["surface"] is None else check_finite("surface", options["surface"], "m")
    )
    water[rows.OWN_VELOCITY], water[rows.KIRCHHOFF] = (
        options["form"] != "classic",
        options["form"] == "kirchhoff",
    )
    terrain = options["terrain"] or Terrain()
    water[rows.TERRAIN : rows.TERRAIN + 4] = terrain.profile
    bodies = np.array([body_of(model, element.body) for element in elements])
    implicit_drag = options["implicit_drag"]
    inertia = implicit_drag or any(any(e.added_mass) or any(e.added_inertia) for e in elements)
    check_model(model, set(bodies.tolist()) if inertia else set(), implicit_drag)
    table, numbers = _table(model, elements, bodies, water)
    table[rows.HAS_INERTIA], table[rows.IMPLICIT_DRAG] = inertia, implicit_drag
    table[rows.HAS_SURFACE] = options["surface"] is not None
    table[rows.FIRST_ORDER] = model.opt.integrator != load_mujoco().mjtIntegrator.mjINT_RK4
    numbers["nodes"] = terrain.nodes
    table[rows.GRID], table[rows.GRID_SIZE] = numbers["nodes"].ctypes.data, numbers["nodes"].size
    numbers["flows"], numbers["given"] = np.zeros(3 * rows.MOST_FLOWS, dtype=np.int64), {}
    table[rows.FLOWS], table[rows.FLOW_LOST] = numbers["flows"].ctypes.data, callback.LOST_FLOW
    moving = _motion(numbers, options["current"])
    numbers["sensors"] = sensors.take_over(model)
    table[rows.SENSORS], table[rows.N_SENSORS] = (
        numbers["sensors"].ctypes.data,
        numbers["sensors"].size // 4,
    )
    if numbers["sensors"].size:
        sensors.install()
    callback.install()
    copyreg.pickle(load_mujoco().MjModel, _reduced)
    handle = Water(
        model=weakref.ref(model), elements=elements, options=options, table=table, numbers=numbers
    )
    callback.enter(model, handle)
    model.opt.o_friction[:4] = moving
    return handle


def _motion(numbers: dict[str, Any], current: Current) -> tuple[float, float, float, float]:
    """Return what a model stores: a velocity [m/s], or 0 and the number of a flow, which is kept."""
    velocity = (current.constant or current) if isinstance(current, Flow) else current
    if not callable(velocity):
        if len(velocity) != 3:
            rule = "must be a flow, a function of x, y, z and t, or 3 numbers"
            raise BadArgument("current", f"{rule}, got {velocity!r}")
        x, y, z = (check_finite(f"current[{i}]", v, "m/s") for i, v in enumerate(velocity))
        return x, y, z, 0.0
    given = numbers["given"]
    with _lock:
        number = next((k for k, one in given.items() if one[0] is velocity), None)
        if number is None:
            flow = velocity if isinstance(velocity, Flow) else FunctionFlow(function=velocity)
            parts, number = rows_of(flow), 1 + max(given, default=0)
            entry = _entry(flow, parts.kinds, flow=parts.kinds)
            record = number, entry.address, parts.numbers.ctypes.data
            given[number] = velocity, entry, parts
            numbers["flows"].reshape(-1, 3)[number % rows.MOST_FLOWS] = record
            given.pop(number - rows.MOST_FLOWS, None)
    return 0.0, 0.0, 0.0, float(number)


def _reduced(model: Any) -> Any:
    """Return the reduced form of a model for pickle, including its water."""
    water = callback.find_water(model)
    if water is None:
        return model.__reduce_ex__(2)
    current = replace(water, model=weakref.ref(model)).current
    return _restored, (model.__getstate__(), water.elements, water.options, current)


def _restored(
    state: bytes, elements: tuple[Element, ...], options: dict[str, Any], current: Current
) -> Any:
    model = load_mujoco().MjModel.__new__(load_mujoco().MjModel)
    model.__setstate__(state)
    _put(model, elements, options).set_current(current)
    return model


def compile_spec(spec: Any) -> Any:
    """Compile a `mujoco.MjSpec` so that every body can have added mass.

    MuJoCo stores only the diagonal of the inertia of a free body whose frame is its inertial frame.
    Added mass needs the whole matrix, so the inertial frame is moved aside while the model is
    compiled, and restored afterward.

    Args:
        spec: A model; it is not modified.

    Returns:
        A `mujoco.MjModel`.
    """
    check_instance("spec", spec, load_mujoco().MjSpec)
    model = spec.compile()
    simple = [b for b in range(1, model.nbody) if model.body_simple[b] and model.body_dofnum[b]]
    if not simple:
        return model
    spec = spec.copy()
    for b in simple:
        body = spec.bodies[b]
        body.explicitinertial = True
        body.mass, body.inertia = model.body_mass[b], model.body_inertia[b]
        body.iquat, body.ipos = (
            model.body_iquat[b],
            model.body_ipos[b] + np.array([1e-3, 2e-3, 3e-3]),
        )
    full = spec.compile()
    for name in ("body_ipos", "body_iquat", "body_inertia", "body_mass"):
        getattr(full, name)[:] = getattr(model, name)
    data = load_mujoco().MjData(full)
    load_mujoco().mj_setConst(full, data)
    return full


def _table(
    model: Any, elements: Sequence[Element], bodies: np.ndarray, water: np.ndarray
) -> tuple[np.ndarray, dict[str, Any]]:
    first = np.zeros(model.nbody + 1, dtype=np.int64)
    first[1:] = np.cumsum(model.body_dofnum)
    arrays: dict[str, np.ndarray] = {
        "parent": model.body_parentid.astype(np.int64),
        "first_dof": first,
        "root": model.body_rootid.astype(np.int64),
        "dof_body": model.dof_bodyid.astype(np.int64),
        "dof_parent": model.dof_parentid.astype(np.int64),
        "row_end": (model.M_rowadr + model.M_rownnz - 1).astype(np.int64),
        "row_length": model.M_rownnz.astype(np.int64),
        "element_body": bodies.astype(np.int64),
        "elements": np.concatenate([_record(element) for element in elements]),
        "water": water,
        "laws": np.array(
            [_entry(e.law, [e.law.formula], law=e.law.formula).address for e in elements],
            dtype=np.int64,
        ),
    }
    records = arrays["elements"].reshape(-1, rows.ELEMENT_SIZE)
    rigid = model.body_weldid  # bodies without a joint between them are one rigid body
    loaded = np.bincount(
        rigid[bodies], records[:, rows.MASS : rows.INERTIA + 3].any(axis=1), model.nbody
    )
    own = [
        np.bincount(rigid, x, model.nbody)
        for x in (model.body_mass, model.body_inertia.min(axis=1))
    ]
    records[:, [rows.OWN_MASS, rows.OWN_INERTIA]] = (own / np.maximum(loaded, 1.0)).T[rigid[bodies]]
    table = np.zeros(rows.TABLE_SIZE, dtype=np.int64)
    table[[rows.N_BODIES, rows.N_DOFS, rows.N_ELEMENTS]] = model.nbody, model.nv, len(elements)
    table[rows.PARENT : rows.LAWS + 1] = [a.ctypes.data for a in arrays.values()]
    table[rows.NO_GRAVITY] = int(load_mujoco().mjtDisableBit.mjDSBL_GRAVITY)
    inside = native.model_offsets()
    table[: len(rows.AT)] = native.offsets()
    table[list(rows.IN_MODEL)] = [inside[name] for name in rows.IN_MODEL._fields]
    return table, arrays


def _record(element: Element) -> np.ndarray:
    record = np.zeros(rows.ELEMENT_SIZE)
    other: dict[str, Any] = {"plate": element.plate or (), "own_mass": (), "own_inertia": ()}
    other["shape"] = getattr(hydrostatics, element.shape.upper())
    other["contact"] = astuple(element.contact) if element.contact else ()
    for name, place in zip((*rows.RECORD, "numbers"), rows.PLACES, strict=True):
        source = element.law if name == "numbers" else element
        values = np.ravel(other[name] if name in other else getattr(source, name))
        record[place : place + values.size] = values
    return record


# ---- laws and flows as functions that the callback calls by their address ------------------------

_entries: dict[str, Any] = {}


def _entry(law: DragLaw | Flow, formulas: Sequence[Formula], /, **names: Any) -> Any:
    """Return a cfunc of two addresses, for a law or flow, which is checked unless its formulas are known.

    The first address holds the `table.LOADS` numbers that a law takes, followed by its loads; or
    position and time, followed by the flow felt there. The second holds the law's own numbers, or
    those of a flow's parts. `names` are the bindings of law_entry.py.
    """
    made_of = [
        *names,
        *map(digest_of, formulas),
        sources_digest("laticauda.water.mujoco.law_entry"),
    ]
    key = hashlib.sha256(" ".join(made_of).encode()).hexdigest()[:16]
    if key not in _entries:
        law.check()
        _entries[key] = load(Path(__file__).with_name("law_entry.py"), key, names).call
    return _entries[key]
