"""Water for any MuJoCo model: `attach` it, and the model's own steps feel it.

    model = water.compiled(spec)                  # or mujoco.MjModel.from_xml_path(...)
    element = water.geom_element(model, "hull", coefficients)
    handle = water.attach(model, [element], density=1000.0, surface=0.0)
    mujoco.mj_step(model, data)                   # with drag, exact added mass, buoyancy

The loads are one compiled passive callback. Callbacks belong to the whole process, so there is one for all models: it
looks the model up and leaves those without water alone. It runs in threads (`mujoco.rollout`, `mujoco.batch`), for its
scratch memory is the data's own stack.
"""

import ctypes
import math
import secrets
import warnings
import weakref
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from threading import Lock
from typing import Any

import numpy as np

from laticauda.errors import finite, one_of, positive
from laticauda.fluid import laws
from laticauda.spatial import loads, native
from laticauda.spatial.door import engine
from laticauda.spatial.elements import Element, GeomCoefficients, lamb
from laticauda.spatial.functions import Current, FluidLaw, compiled_current, compiled_law

__all__ = ["Element", "GeomCoefficients", "Water", "attach", "compiled", "geom_element", "stable_step"]

FORMS = ("relative", "kirchhoff", "classic")
INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
_lock = Lock()


@dataclass(frozen=True, kw_only=True, eq=False)
class Water:
    """Water that is attached to a model; made by `attach`. It stays as long as the model lives, or until `detach`."""

    model: Any
    """The `mujoco.MjModel`; weakly held."""
    elements: tuple[Element, ...]
    """What the water sees, in the order that they were given."""
    table: np.ndarray
    """Addresses and offsets for the compiled code; see `loads`."""
    numbers: dict[str, np.ndarray]
    """What the table points to."""
    fluid_law: FluidLaw
    """Drag on one element in one plane."""
    mark: int
    """By which the compiled code knows the model and its copies."""

    def detach(self) -> None:
        """Take the water away, from the model and from all copies of it."""
        with _lock:
            _forget(self.mark)

    @property
    def active(self) -> bool:
        """Whether the callback is in place: another package may have put its own there."""
        return _current_callback() == _callback_address()

    def set_current(self, velocity: Sequence[float]) -> None:
        """Let the water move with `velocity` from now on.

        Args:
            velocity: World axes [m/s].
        """
        x, y, z = (finite(f"velocity[{i}]", v, "m/s") for i, v in enumerate(velocity))
        self.numbers["water"][[loads.V_X, loads.V_Y, loads.V_Z]] = x, y, z

    def forces(self, data: Any) -> dict[str, np.ndarray]:
        """Loads on every element at the state in `data`, which is evaluated anew (`mj_forward`).

        The part of the added mass that goes with acceleration is not a force here: it is in the inertia.

        Args:
            data: A `mujoco.MjData` of the model.

        Returns:
            Arrays of shape (n_elements, 3), world axes: `drag`, `added_mass` (its velocity part) and `buoyancy` [N],
            and `torque` of all three about the element's middle [N m].
        """
        out = np.zeros((len(self.elements), loads.OUT_SIZE))
        with _lock:
            self.table[loads.OUT] = out.ctypes.data
            try:
                engine().mj_forward(self._live(), data)
            finally:
                self.table[loads.OUT] = 0
        names = ("drag", "added_mass", "buoyancy", "torque")
        return {name: out[:, 3 * i : 3 * i + 3].copy() for i, name in enumerate(names)}

    def _live(self) -> Any:
        model = self.model()
        if model is None:
            raise ValueError("`model` must still exist, but the model of this water is gone.")
        return model


def attach(
    model: Any,
    elements: Iterable[Element],
    *,
    density: float = 1000.0,
    current: Sequence[float] | Current = (0.0, 0.0, 0.0),
    surface: float | None = None,
    form: str = "relative",
    implicit_drag: bool = False,
    fluid_law: FluidLaw = laws.polynomial_drag,
    usual_speed: float = 1.0,
) -> Water:
    """Put a model under water. What was attached to it before is replaced; copies of the model have its water too.

    Args:
        model: A `mujoco.MjModel`, as `mujoco` or `compiled` makes it.
        elements: What the water sees.
        density: rho, for the buoyancy [kg/m^3].
        current: Velocity that the water moves to, world axes [m/s]; or a function of x, y, z [m] and t [s] that Numba
            can compile and that returns three numbers. Its own acceleration is left out: it must change slowly.
        surface: Height of the flat surface [m]; None: everything is covered.
        form: Velocity terms of the added mass: `relative`, `kirchhoff` (keeps energy and momentum) or `classic`.
        implicit_drag: Take the drag's slope into the inertia of the step. Stable at any step, and of first order in
            it; for the integrators Euler and implicitfast only. The accelerations in the data are then those of the
            step, and no longer forces over inertia.
        fluid_law: Drag on one element in one plane, with the signature of `laticauda.fluid.laws.polynomial_drag`.
        usual_speed: At which the step is checked against the drag [m/s].

    Returns:
        A handle. The water stays without it, for as long as the model lives.

    Raises:
        ValueError: If the model or an argument cannot be worked with; the message says why.
        MissingExtra: If MuJoCo is not installed.
    """
    mujoco = engine()
    if not isinstance(model, mujoco.MjModel):
        raise ValueError(f"`model` must be a mujoco.MjModel, got {type(model).__name__}.")
    elements = tuple(elements)
    if not elements or not all(isinstance(e, Element) for e in elements):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"`elements` must hold one Element at least, and nothing else, got {elements!r:.60}.")
    one_of("form", form, FORMS)
    water = np.zeros(loads.WATER_SIZE)
    water[loads.DENSITY] = positive("density", density, "kg/m^3")
    water[loads.LEVEL] = 0.0 if surface is None else finite("surface", surface, "m")
    water[loads.OWN_VELOCITY], water[loads.KIRCHHOFF] = form != "classic", form == "kirchhoff"
    bodies = np.array([_body(model, element) for element in elements])
    inertia = implicit_drag or any(any(e.added_mass) or any(e.added_inertia) for e in elements)
    _check_model(model, set(bodies.tolist()) if inertia else set(), implicit_drag)
    table, arrays = _table(model, elements, bodies, water)
    table[loads.HAS_INERTIA], table[loads.IMPLICIT_DRAG] = inertia, implicit_drag
    table[loads.HAS_SURFACE] = surface is not None
    law = compiled_law(fluid_law)
    table[loads.LAW] = law.address
    keep: list[Any] = [law]
    if callable(current):
        flow = compiled_current(current)
        table[loads.CURRENT] = flow.address
        keep.append(flow)
    else:
        if len(current) != 3:
            raise ValueError(f"`current` must be a function or 3 numbers, got {current!r}.")
        water[[loads.V_X, loads.V_Y, loads.V_Z]] = [finite(f"current[{i}]", v, "m/s") for i, v in enumerate(current)]
    positive("usual_speed", usual_speed, "m/s")
    _install()
    mark = _register(model, table, (arrays, keep))
    handle = Water(model=weakref.ref(model), elements=elements, table=table, numbers=arrays, fluid_law=fluid_law, mark=mark)
    _warn(model, handle, elements, bodies, implicit_drag, usual_speed)
    return handle


def compiled(spec: Any) -> Any:
    """Compile a `mujoco.MjSpec` so that every body can have added mass.

    MuJoCo stores nothing but the diagonal of the inertia of a free body whose frame is that of its inertia. Added mass
    needs all of it, so the inertia's frame is moved aside while the model is compiled, and back afterward.

    Args:
        spec: A model; it is left as it was.

    Returns:
        A `mujoco.MjModel`.
    """
    model = spec.compile()
    simple = [b for b in range(1, model.nbody) if model.body_simple[b] and model.body_dofnum[b]]
    if not simple:
        return model
    spec = spec.copy()
    for b in simple:
        body = spec.bodies[b]
        body.explicitinertial = True
        body.mass, body.inertia = model.body_mass[b], model.body_inertia[b]
        body.iquat, body.ipos = model.body_iquat[b], model.body_ipos[b] + np.array([1e-3, 2e-3, 3e-3])
    full = spec.compile()
    for name in ("body_ipos", "body_iquat", "body_inertia", "body_mass"):
        getattr(full, name)[:] = getattr(model, name)
    data = engine().MjData(full)
    engine().mj_setConst(full, data)
    return full


def geom_element(model: Any, geom: str | int, coefficients: GeomCoefficients, *, density: float = 1000.0) -> Element:
    """The element that fits a geom: a sphere, capsule, ellipsoid, cylinder or box.

    Args:
        model: A `mujoco.MjModel`.
        geom: Its name or number.
        coefficients: What the water does to it.
        density: rho [kg/m^3].

    Raises:
        ValueError: If there is no such geom, it has no volume, or it is of another type.
    """
    mujoco = engine()
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, geom) if isinstance(geom, str) else geom
    if not 0 <= number < model.ngeom:
        raise ValueError(f"`geom` must be a geom of the model, got {geom!r}.")
    name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, number) or f"geom {number}"
    kind = mujoco.mjtGeom(model.geom_type[number]).name.removeprefix("mjGEOM_").lower()
    size = [float(s) for s in model.geom_size[number]]
    turn = (1.0, 0.0, 0.0, 0.0)
    if kind in ("cylinder", "capsule"):  # MuJoCo's axis is z, ours x
        half, turn = (size[1] + (size[0] if kind == "capsule" else 0.0), size[0], size[0]), (0.5**0.5, 0.0, -(0.5**0.5), 0)
        volume = 2.0 * math.pi * size[0] ** 2 * size[1]
        volume += 4.0 / 3.0 * math.pi * size[0] ** 3 if kind == "capsule" else 0.0
    elif kind in ("sphere", "ellipsoid"):
        half = (size[0],) * 3 if kind == "sphere" else (size[0], size[1], size[2])
        volume = 4.0 / 3.0 * math.pi * half[0] * half[1] * half[2]
    elif kind == "box":
        half, volume = (size[0], size[1], size[2]), 8.0 * size[0] * size[1] * size[2]
    else:
        raise ValueError(f"`geom` must be a sphere, capsule, ellipsoid, cylinder or box, got `{name}`, a {kind}.")
    if not volume > 0.0:
        raise ValueError(f"`geom` must have a volume, got `{name}`, whose size is {size}.")
    positive("density", density, "kg/m^3")
    share, turning = lamb(half)
    mass = coefficients.added_mass * density * volume
    block = 4.0 if kind == "box" else math.pi
    round_ = 4.0 if kind in ("box", "cylinder", "capsule") else math.pi
    area = (block * half[1] * half[2], round_ * half[0] * half[2], round_ * half[0] * half[1])
    c = tuple(0.5 * density * k * a for k, a in zip(coefficients.drag, area, strict=True))
    spread = coefficients.rotational_drag
    across = (0.0, c[2], c[1])  # rotation about y is resisted by the drag along z, and the other way around
    rotation = _product(model.geom_quat[number], turn)
    return Element(
        body=model.body(int(model.geom_bodyid[number])).name,
        position=tuple(float(x) for x in model.geom_pos[number]),
        orientation=rotation,
        drag=(c[0], c[1], c[2]),
        torque_linear=tuple(spread * x * half[0] ** 2 / 3.0 for x in across),
        torque_quadratic=tuple(spread * x * half[0] ** 3 / 4.0 for x in across),
        added_mass=tuple(float(mass * k) for k in share),
        added_inertia=tuple(float(mass * k) for k in turning),
        volume=volume,
        shape="box" if kind == "box" else "ellipsoid" if kind in ("sphere", "ellipsoid") else "cylinder",
        half_size=half,
        reference_speed=coefficients.reference_speed,
    )


def stable_step(model: Any, handle: Water, speed: float) -> float:
    """Largest step at which the drag may be treated explicitly, in the model's reference pose.

    Args:
        model: The model that the water is attached to.
        handle: The water.
        speed: At which all elements move, along all axes at once [m/s].

    Returns:
        2 over the largest eigenvalue of (M + A)^-1 D, D the slope of the drag [s]; infinite without drag.
    """
    mujoco = engine()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    D = np.zeros_like(M)
    linear, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for element in handle.elements:
        body = _body(model, element)
        R = data.xmat[body].reshape(3, 3) @ element.rotation
        at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ np.array(element.position)
        mujoco.mj_jac(model, data, linear, turning, at, body)
        slope, slope_2 = _slopes(handle.fluid_law, element, speed)
        J, K = R.T @ linear, R.T @ turning
        D += J.T @ (slope[:, np.newaxis] * J) + K.T @ (slope_2[:, np.newaxis] * K)
    fastest = float(np.max(np.real(np.linalg.eigvals(np.linalg.solve(M, D))))) if model.nv else 0.0
    return 2.0 / fastest if fastest > 0.0 else math.inf


def _slopes(law: FluidLaw, element: Element, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Steepest slope of the drag between rest and a speed, along and about the element's axes."""
    water = (element.reference_speed, float(element.reference_speed > 0.0), float(element.quadratic))
    spin = speed / max(element.half_size)
    near = 1e-6

    def slope(v: float, c: float) -> float:
        return (law(v - near, 0.0, 0.0, c, 0.0, 0.0, 0.0, *water)[0] - law(v + near, 0.0, 0.0, c, 0.0, 0.0, 0.0, *water)[0])

    def slope_2(w: float, a: float, b: float) -> float:
        return law(0.0, 0.0, w - near, 0.0, 0.0, a, b, *water)[2] - law(0.0, 0.0, w + near, 0.0, 0.0, a, b, *water)[2]

    along = [max(slope(0.0, c), slope(speed, c)) for c in element.drag]
    pairs = zip(element.torque_linear, element.torque_quadratic, strict=True)
    about = [max(slope_2(0.0, a, b), slope_2(spin, a, b)) for a, b in pairs]
    return np.array(along) / (2.0 * near), np.array(about) / (2.0 * near)


def _body(model: Any, element: Element) -> int:
    mujoco = engine()
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, element.body)
    if body < 0:
        raise ValueError(f"`body` of an element must be a body of the model, got {element.body!r}.")
    if body == 0:
        raise ValueError("`body` of an element must move, got the world.")
    return int(body)


def _check_model(model: Any, heavy: set[int], implicit_drag: bool) -> None:
    """Refuse what added mass in the passive callback does not hold for."""
    mujoco = engine()
    option = model.opt
    names = {getattr(mujoco.mjtIntegrator, f"mjINT_{name.upper()}"): name for name in INTEGRATORS}
    integrator = names.get(option.integrator)
    if option.density > 0.0 or option.viscosity > 0.0:
        raise ValueError(
            "`model` must have option density and viscosity 0, or MuJoCo's own fluid model would act as well, got "
            f"{option.density:g} and {option.viscosity:g}."
        )
    if option.disableflags & mujoco.mjtDisableBit.mjDSBL_SPRING and option.disableflags & mujoco.mjtDisableBit.mjDSBL_DAMPER:
        raise ValueError("`model` must have passive forces, but springs and dampers are both disabled.")
    if integrator is None:
        raise ValueError(f"`model` must have one of the integrators {', '.join(INTEGRATORS)}, got {option.integrator}.")
    if implicit_drag and integrator not in ("Euler", "implicitfast"):
        raise ValueError(f"`implicit_drag` must go with the integrator Euler or implicitfast, got {integrator}.")
    if option.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        raise ValueError("`model` must not override contact parameters: the mark of its water stands in `o_margin`.")
    if not heavy:
        return
    if option.solver == mujoco.mjtSolver.mjSOL_PGS:
        raise ValueError(
            "`model` must have the solver Newton or CG: PGS sees the constraints before the added mass is there."
        )
    if option.enableflags & getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", 0):
        raise ValueError("`model` must not have sleeping bodies enabled: their inertia is not computed anew.")
    if model.ntendon and np.any(model.tendon_armature > 0.0):
        raise ValueError("`model` must not have tendons with armature.")
    for body in heavy:
        dofs = _dofs_above(model, body)
        if any(model.M_rownnz[j] != n + 1 for n, j in enumerate(dofs)):
            raise ValueError(
                f"`model` must store the whole inertia matrix of body `{model.body(body).name}`, but keeps its "
                "diagonal only; compile its MjSpec with `laticauda.spatial.water.compiled`."
            )


def _dofs_above(model: Any, body: int) -> list[int]:
    """Degrees of freedom that move a body, from the root on."""
    while body and model.body_dofnum[body] == 0:
        body = int(model.body_parentid[body])
    if body == 0:
        return []
    dof = int(model.body_dofadr[body] + model.body_dofnum[body] - 1)
    found: list[int] = []
    while dof >= 0:
        found.append(dof)
        dof = int(model.dof_parentid[dof])
    return found[::-1]


def _table(
    model: Any, elements: Sequence[Element], bodies: np.ndarray, water: np.ndarray
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
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
    }
    table = np.zeros(loads.TABLE_SIZE, dtype=np.int64)
    table[[loads.N_BODIES, loads.N_DOFS, loads.N_ELEMENTS]] = model.nbody, model.nv, len(elements)
    table[loads.PARENT : loads.WATER + 1] = [a.ctypes.data for a in arrays.values()]
    inside = native.model_offsets()
    names = ("gravity", "timestep", "dof_armature")
    table[loads.AT_GRAVITY : loads.AT_ARMATURE + 1] = [inside[name] for name in names]
    names = ("mj_factorM", "mj_markStack", "mj_freeStack", "mj_stackAllocNum")
    table[loads.FACTOR_M : loads.ALLOCATE + 1] = [native.address(name) for name in names]
    where = native.offsets()
    fields = ("qvel", "qacc", "xpos", "xmat", "subtree_com", "cdof", "cdof_dot", "cvel", "crb", "M")
    fields += ("qfrc_passive", "qfrc_fluid", "time")
    table[loads.AT_QVEL : loads.AT_TIME + 1] = [where[name] for name in fields]
    return table, arrays


def _record(element: Element) -> np.ndarray:
    record = np.zeros(loads.ELEMENT_SIZE)
    for at, values in (
        (loads.POSITION, element.position),
        (loads.ROTATION, element.rotation.ravel()),
        (loads.DRAG, element.drag),
        (loads.TORQUE_LINEAR, element.torque_linear),
        (loads.TORQUE_QUADRATIC, element.torque_quadratic),
        (loads.MASS, element.added_mass),
        (loads.INERTIA, element.added_inertia),
        (loads.HALF, element.half_size),
        (loads.THRUST, element.thrust),
    ):
        record[at : at + len(values)] = values
    record[loads.VOLUME], record[loads.SHAPE] = element.volume, element.shape_number
    record[loads.REFERENCE_SPEED] = element.reference_speed
    record[loads.LINEAR], record[loads.QUADRATIC] = element.reference_speed > 0.0, element.quadratic
    return record


@cache
def _callback() -> Any:
    return loads.callback()


def _callback_address() -> int:
    return int(_callback().address)


def _current_callback() -> int:
    return ctypes.c_void_p.in_dll(native.library(), "mjcb_passive").value or 0


def _install() -> None:
    """Put the callback in place, in front of one that is there already if that one is compiled too."""
    mujoco = engine()
    with _lock:
        before = _current_callback()
        if before == _callback_address():
            return
        there = mujoco.get_mjcb_passive()
        if there is not None and not hasattr(there, "argtypes"):
            raise ValueError("mjcb_passive must be free or hold a compiled function, but a Python function is set there.")
        loads.registry[0] = before
        _previous[:] = [there]
        mujoco.set_mjcb_passive(_callback().ctypes)


_previous: list[Any] = []
_kept: dict[int, Any] = {}  # what the compiled code reads, by the mark of its model
_gone: list[int] = []  # marks of models that no longer exist; copies of them may


def _register(model: Any, table: np.ndarray, keep: Any) -> int:
    """Enter a table into the registry, and set its mark in the model."""
    rows = loads.registry[2:].reshape(-1, 2)
    with _lock:
        free = np.flatnonzero(rows[1:, 0] == 0) + 1
        if not free.size and _gone:
            _forget(_gone[0])
            free = np.flatnonzero(rows[1:, 0] == 0) + 1
        if not free.size:
            raise ValueError(f"`model` must be one of less than {loads.MOST_MODELS} models with water at a time.")
        place = int(free[0])
        mark = secrets.randbits(52 - loads.PLACE_BITS) << loads.PLACE_BITS | place
        rows[place] = mark, table.ctypes.data
        _kept[mark] = (table, keep)
        loads.registry[1] = native.model_offsets()["o_margin"]
    # A margin of less than 1e-307 m is none, should anyone use it; it goes with every copy of the model.
    model.opt.o_margin = np.int64(mark).view(np.float64)
    weakref.finalize(model, _gone.append, mark)
    return mark


def _forget(mark: int) -> None:
    row = loads.registry[2:].reshape(-1, 2)[mark & (loads.MOST_MODELS - 1)]
    if row[0] == mark:
        row[:] = 0
    _kept.pop(mark, None)
    if mark in _gone:
        _gone.remove(mark)


def _warn(
    model: Any, handle: Water, elements: Sequence[Element], bodies: np.ndarray, implicit_drag: bool, speed: float
) -> None:
    """Warn of what is likely not meant: nothing floats, nothing is stable, or nothing stays upright."""
    mujoco = engine()
    free = {int(model.jnt_bodyid[j]) for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_FREE}
    roots = {int(model.body_rootid[b]) for b in bodies}
    for root in sorted(roots - free):
        if not any(_dofs_above(model, int(b)) for b in bodies if model.body_rootid[b] == root):
            warnings.warn(f"body `{model.body(root).name}` is in the water but cannot move: it has no joint", stacklevel=3)
        elif any(e.volume > 0.0 for e in elements):
            name = model.body(root).name
            warnings.warn(f"body `{name}` has buoyancy but no free joint, so it does not float freely", stacklevel=3)
    for root in sorted(roots & free):
        _warn_upright(model, root, elements, bodies)
    if implicit_drag:
        return
    limit = stable_step(model, handle, speed)
    if model.opt.timestep > limit:
        warnings.warn(
            f"`timestep` {model.opt.timestep:g} s is too large for the drag: at {speed:g} m/s it is stable up to "
            f"{limit:.2g} s; take a smaller one, or `implicit_drag`",
            stacklevel=3,
        )


def _warn_upright(model: Any, root: int, elements: Sequence[Element], bodies: np.ndarray) -> None:
    mujoco = engine()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    volume, moment = 0.0, np.zeros(3)
    for element, body in zip(elements, bodies, strict=True):
        if model.body_rootid[body] == root and element.volume > 0.0:
            at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ np.array(element.position)
            volume, moment = volume + element.volume, moment + element.volume * at
    if volume > 0.0 and moment[2] / volume <= data.subtree_com[root][2] and np.any(model.opt.gravity):
        warnings.warn(
            f"body `{model.body(root).name}` floats freely with its center of buoyancy at or below its center of mass: "
            "nothing keeps it upright",
            stacklevel=3,
        )


def _product(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Product of two quaternions."""
    result = np.zeros(4)
    engine().mju_mulQuat(result, np.asarray(a, dtype=float), np.asarray(b, dtype=float))
    w, x, y, z = (float(q) for q in result)
    return w, x, y, z
