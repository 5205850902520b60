"""Water attached to a MuJoCo model.

The loads are computed by one compiled passive callback. Callbacks belong to the whole process, so
one serves all models: it looks up the model and ignores those without water. It can run in threads
(`mujoco.rollout`, `mujoco.batch`), because its scratch memory is the data's own stack.
"""

import copyreg
import weakref
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import BadArgument, check_choice, check_instance, check_positive, load_mujoco
from laticauda.water.mujoco import callback, registry, sensors, table as rows
from laticauda.water.mujoco.advice import warn_of_mistakes
from laticauda.water.mujoco.bodies import element_pose
from laticauda.water.mujoco.checks import make_room
from laticauda.water.mujoco.currents import Current, FlowStore, read_motion, write_motion
from laticauda.water.mujoco.elements import Element
from laticauda.water.mujoco.filling import fill_table
from laticauda.water.mujoco.flexes import flex_elements
from laticauda.water.mujoco.geoms import geom_elements
from laticauda.water.mujoco.ground import Terrain
from laticauda.water.mujoco.radiation import with_radiation
from laticauda.water.mujoco.specs import compile_file, compile_spec

FORMS = ("relative", "kirchhoff", "classic")
"""Velocity terms of the added mass, see `attach`."""
OUTPUTS = ("drag", "added_mass", "buoyancy", "effector")
"""Loads of an element in the order in which the compiled code writes them, three numbers each."""
WET_SHARE = 3 * len(OUTPUTS)
"""Place of the submerged share, which follows them."""
LOST = (
    "must be that of the water, but another callback has replaced it; unset that "
    "(`mujoco.set_mjcb_passive(None)`) and attach the water again"
)
"""What is wrong when the water does not act."""
_force_lock = Lock()
"""One evaluation of forces at a time: their destination is in the table."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Water:
    """Water attached to a model; created by `attach`. It stays as long as the model lives, or until `detach`."""

    model: Any
    """Call it to get the `mujoco.MjModel`: a weak reference, unless `attach` compiled the model."""
    elements: tuple[Element, ...]
    """The elements, in the order in which they were given."""
    options: dict[str, Any]
    """The other arguments of `attach`."""
    table: np.ndarray
    """Addresses and offsets for the compiled code; see `table`."""
    numbers: dict[str, np.ndarray]
    """Arrays that the table points to, by name; see `filling`."""
    flows: FlowStore
    """Flows that this water and its copies were given."""

    def detach(self) -> None:
        """Remove the water from the model; copies of it keep theirs."""
        model = self._live()
        registry.remove_mark(model)
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
        model = self._live()
        as_attached: Current = self.options["current"]
        motion = self.flows.store(current if current is not None else as_attached)
        write_motion(model, motion)

    @property
    def current(self) -> Current:
        """Current motion of the water of this model: a flow or a function, or its velocity [m/s]."""
        motion = read_motion(self._live())
        if motion.flow_number:
            return self.flows.find_flow(int(motion.flow_number))
        return motion.u, motion.v, motion.w

    def forces(self, data: Any) -> dict[str, np.ndarray]:
        """Return the loads on every element at the state in `data`, which is evaluated again (`mj_forward`).

        Args:
            data: A `mujoco.MjData` of the model.

        Returns:
            Arrays of shape (n_elements, 3), world axes: `drag`, `added_mass` (with the force of
            accelerating water on the displaced volume), `buoyancy` and `effector` (thrust, tether,
            wake, plate) [N]. `added_mass` is that for the accelerations in `data` after the call.

        Raises:
            ValueError: If the water does not act, because another package has replaced the
                callback.
        """
        out = np.full((len(self.elements), rows.OUT_SIZE), np.nan)
        model = self._live()
        with _force_lock:
            self.table[rows.OUT] = out.ctypes.data
            try:
                load_mujoco().mj_forward(model, data)
            finally:
                self.table[rows.OUT] = 0
        if not self.active and np.all(np.isnan(out)):
            raise BadArgument("mjcb_passive", LOST)
        out[np.isnan(out).all(axis=1)] = 0.0  # elements that are dry
        loads = {name: out[:, 3 * i : 3 * i + 3].copy() for i, name in enumerate(OUTPUTS)}
        loads["added_mass"] -= self._inertial_forces(model, data) * out[:, WET_SHARE:]
        return loads

    def _inertial_forces(self, model: Any, data: Any) -> np.ndarray:
        """Return added mass times the acceleration of every element's center due to the joints' accelerations [N]."""
        mujoco = load_mujoco()
        forces = np.zeros((len(self.elements), 3))
        jacobian = np.zeros((3, model.nv))
        for i, element in enumerate(self.elements):
            pose = element_pose(model, data, element)
            mujoco.mj_jac(model, data, jacobian, None, pose.center, pose.body)
            acceleration = pose.axes.T @ (jacobian @ data.qacc)
            forces[i] = pose.axes @ (np.array(element.added_mass) * acceleration)
        return forces

    def _live(self) -> Any:
        """Return the model, which must still exist."""
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
        model: A file (MJCF or URDF) or a `mujoco.MjSpec`, which is compiled with room for added
            mass: the handle's `model()` is the model. Or a `mujoco.MjModel`, or an object that
            holds one as `ptr`, as in dm_control; some of those have no room for added mass and are
            rejected.
        elements: Elements on which the water acts; None: `geom_elements`, with a surface also with
            the damping by waves that they make, and cylinders along the edges of nets and ropes
            (flexes).
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
        ValueError: If the model or an argument is not supported; the message gives the reason, and
            the model is as before.
        MissingExtra: If MuJoCo is not installed.
    """
    compiled = _compile(model)
    model = _plain_model(model if compiled is None else compiled)
    check_positive("usual_speed", usual_speed, "m/s")
    fitted = elements is None
    if elements is None:
        elements = _fit_elements(model, density, has_surface=surface is not None)
    elements = tuple(elements)
    _check_elements(elements)
    options = {
        "density": density,
        "current": current,
        "surface": surface,
        "form": form,
        "implicit_drag": implicit_drag,
        "terrain": terrain,
    }
    filled = _fill(model, elements, options)
    make_room(model, elements)
    water = _enter(model, elements, options, filled)
    checked_speed = None if implicit_drag else usual_speed
    warn_of_mistakes(model, water, checked_speed, fitted)
    if compiled is None:
        return water
    # No one else may have it. The registry must not hold a model, or it would live forever.
    return replace(water, model=lambda: compiled)


def attached(model: Any) -> Water | None:
    """Return the water of `model`, be it the original model, a copy, or one from a pickle; None: no water.

    Args:
        model: A `mujoco.MjModel`, or an object that holds one as `ptr`.
    """
    model = _plain_model(model)
    water = registry.find_water(model)
    if water is None:
        return None
    return replace(water, model=weakref.ref(model))


def _fit_elements(model: Any, density: float, *, has_surface: bool) -> tuple[Element, ...]:
    """Return elements for all geoms and flexes; a model may consist of flexes alone."""
    of_flexes = flex_elements(model, density=density)
    try:
        of_geoms = geom_elements(model, density=density)
    except BadArgument:
        if not of_flexes:
            raise
        return of_flexes
    if not has_surface:
        return of_geoms + of_flexes
    return with_radiation(model, of_geoms, density=density) + of_flexes


def _compile(model: Any) -> Any:
    """Return the compiled model of a file or `MjSpec`; None: it is neither."""
    if isinstance(model, (str, Path)):
        return compile_file(model)
    if isinstance(model, load_mujoco().MjSpec):
        return compile_spec(model)
    return None


def _plain_model(model: Any) -> Any:
    """Return MuJoCo's model, which dm_control holds as `ptr`."""
    model = getattr(model, "ptr", model)
    check_instance("model", model, load_mujoco().MjModel)
    return model


def _check_elements(elements: tuple[Any, ...]) -> None:
    if not elements or not all(isinstance(element, Element) for element in elements):
        raise BadArgument(
            "elements", f"must hold at least one Element, and nothing else, got {elements!r:.60}"
        )


class _Filled(NamedTuple):
    """What the compiled code needs, before the model refers to it."""

    table: np.ndarray
    """Addresses and offsets."""
    arrays: dict[str, np.ndarray]
    """Arrays that the table points to, by name."""
    flows: FlowStore
    """Flows that the water has."""
    motion: Any
    """How its current is written into the model."""


def _fill(model: Any, elements: tuple[Element, ...], options: dict[str, Any]) -> _Filled:
    """Prepare water with all arguments of `attach` but one; whatever is rejected is rejected here."""
    check_choice("form", options["form"], FORMS)
    table, arrays = fill_table(model, elements, options)
    flows = FlowStore()
    table[rows.FLOWS] = flows.rows.ctypes.data
    motion = flows.store(options["current"])
    callback.install()
    return _Filled(table=table, arrays=arrays, flows=flows, motion=motion)


def _enter(
    model: Any, elements: tuple[Element, ...], options: dict[str, Any], filled: _Filled
) -> Water:
    """Let a model have the water that was prepared for it."""
    table = filled.table
    arrays = filled.arrays
    arrays["sensors"] = sensors.take_over(model)
    table[rows.SENSORS] = arrays["sensors"].ctypes.data
    table[rows.N_SENSORS] = arrays["sensors"].size // sensors.COLUMNS
    if arrays["sensors"].size:
        sensors.install()
    copyreg.pickle(load_mujoco().MjModel, _reduce_model)
    water = Water(
        model=weakref.ref(model),
        elements=elements,
        options=options,
        table=table,
        numbers=arrays,
        flows=filled.flows,
    )
    registry.enter(model, water)
    write_motion(model, filled.motion)
    return water


def _reduce_model(model: Any) -> Any:
    """Return the reduced form of a model for pickle, including its water."""
    water = registry.find_water(model)
    if water is None:
        return model.__reduce_ex__(2)
    current = replace(water, model=weakref.ref(model)).current
    return _restore_model, (model.__getstate__(), water.elements, water.options, current)


def _restore_model(
    state: bytes, elements: tuple[Element, ...], options: dict[str, Any], current: Current
) -> Any:
    """Return the model of a reduced form, with its water."""
    model_class = load_mujoco().MjModel
    model = model_class.__new__(model_class)
    model.__setstate__(state)
    filled = _fill(model, elements, options)
    _enter(model, elements, options, filled).set_current(current)
    return model
