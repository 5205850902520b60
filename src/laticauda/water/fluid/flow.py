"""Water that moves in space and time: flows that own their numbers.

A flow is a frozen value derived from `Flow`: its fields are its numbers, its `__call__` gives the
motion of the water at a point and a time. It is part of the water: `Water.current`. Python calls it
directly, and the kernels compile it (`laticauda.values.formulas`). A user's flow is a class like those in
the neighboring modules, or a `FunctionFlow`.

A flow is the sum of its `parts`, each with a formula and up to `formulas.MOST_NUMBERS` numbers: a
flow with a formula is its own only part, a sea consists of many waves. The numbers of parts are
therefore rows of the kernels, like those of drag laws, and sums of flows are flows.

Formulas are compiled, so this module and those of flows avoid jaxtyping, whose checker wraps
functions.

Axes are world axes: z is up, and 0 at the mean surface. Formulas work for floats, complex numbers,
lanes and arrays, as those of drag laws do (`laticauda.water.fluid.laws`).
"""

from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import (
    BadArgument,
    Extensible,
    Formula,
    Law,
    OfFunction,
    describe_fields,
    name_of,
    option,
    value_class,
)

STEP = 1e-4
"""Step of differences, in m and s; errors: (k STEP)^2 / 6 for waves of number k, and 1e-12 / STEP of the velocity."""
EXAMPLE = (0.1, 0.2, -0.3, 0.4)
"""x, y, z [m] and t [s] at which a formula is called to see what it returns."""


class Motion(NamedTuple):
    """Motion of the water at a point, world axes; the result of a formula."""

    u: float
    """Velocity along x [m/s]."""
    v: float
    """Velocity along y [m/s]."""
    w: float
    """Velocity upward [m/s]."""
    u_t: float
    """Rate of change of u at the fixed point [m/s^2]."""
    v_t: float
    w_t: float
    u_x: float
    """Derivative of u with respect to x [1/s]."""
    u_y: float
    u_z: float
    v_x: float
    v_y: float
    v_z: float
    w_x: float
    w_y: float
    w_z: float
    elevation: float
    """Elevation of the surface above its mean [m]."""


class LocalFlow(NamedTuple):
    """Motion of the water as it acts on a small body, world axes; each field is one component."""

    u: float
    """Velocity of the water [m/s]."""
    v: float
    w: float
    a_x: float
    """Material acceleration Du/Dt [m/s^2]."""
    a_y: float
    a_z: float
    s_x: float
    """Rotation of the water, half its vorticity [rad/s]."""
    s_y: float
    s_z: float
    elevation: float
    """Elevation of the surface above its mean [m]."""


def local_flow(motion: Motion) -> LocalFlow:
    """Return velocity, material acceleration and rotation: Du/Dt = u_t + (u . grad) u, curl u / 2.

    Args:
        motion: Motion of the water at a point.
    """
    u, v, w, u_t, v_t, w_t, u_x, u_y, u_z, v_x, v_y, v_z, w_x, w_y, w_z, elevation = motion
    a_x = u_t + u * u_x + v * u_y + w * u_z
    a_y = v_t + u * v_x + v * v_y + w * v_z
    a_z = w_t + u * w_x + v * w_y + w * w_z
    s_x = 0.5 * (w_y - v_z)
    s_y = 0.5 * (u_z - w_x)
    s_z = 0.5 * (v_x - u_y)
    return LocalFlow(u, v, w, a_x, a_y, a_z, s_x, s_y, s_z, elevation)


class Flow(Law, Extensible, group="flows"):
    """Base class of flows: a value whose fields are its numbers.

    Example:
        >>> from laticauda.water.fluid.flow import FunctionFlow
        >>> flow = FunctionFlow(function=lambda x, y, z, t: (0.1 * y, 0.0, 0.0))
        >>> round(flow.felt(0.0, 2.0, 0.0, 0.0).u, 9)
        0.2
    """

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """Return the motion of the water at a point and a time.

        Args:
            x: World coordinate x [m].
            y: World coordinate y [m].
            z: Height above the mean surface [m].
            t: Time since the start of the run [s].

        Returns:
            The 16 numbers of a `Motion`, or only u, v and w: the others are then central
                differences, and the surface stays level.
        """
        return self.motion(x, y, z, t)

    @property
    def parts(self) -> tuple["Flow", ...]:
        """Flows with formulas whose sum this flow is."""
        return (self,)

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """Velocity of the flow if it is the same everywhere at all times [m/s]."""
        return None

    def at_height(self, z: float) -> "Flow":
        """Return an equivalent flow for use at one height only [m], where a part may be cheaper."""
        return self

    def __add__(self, addend: "Flow") -> "Sum":
        """Return the sum of both flows."""
        own_flows: tuple[Flow, ...] = getattr(self, "flows", (self,))
        added_flows: tuple[Flow, ...] = getattr(addend, "flows", (addend,))
        return Sum(flows=(*own_flows, *added_flows))

    def motion(self, x: Any, y: Any, z: Any, t: Any) -> Motion:
        """Return the full motion of the water at a point or at arrays of points, in plain Python.

        Args:
            x: World coordinate x [m].
            y: World coordinate y [m].
            z: Height above the mean surface [m].
            t: Time since the start of the run [s].
        """
        total: Any = (0.0,) * len(Motion._fields)
        for part in self.parts:
            own: Any = part.formula.function(part, x, y, z, t)
            if _count_numbers(own) != len(Motion._fields):
                own = part.moving.function(part, x, y, z, t)
            total = tuple(a + b for a, b in zip(total, own, strict=True))
        return Motion(*total)

    def felt(self, x: Any, y: Any, z: Any, t: Any) -> LocalFlow:
        """Return the motion of the water as it acts on a small body, see `motion`."""
        return local_flow(self.motion(x, y, z, t))

    def velocity(self, points: np.ndarray, t: Any) -> np.ndarray:
        """Return the velocity of the water at many points.

        Args:
            points: Points in world axes, shape (..., 3) [m].
            t: Time since the start of the run, one for all points or one for each [s].

        Returns:
            Velocities, in the shape of `points` [m/s].
        """
        x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
        motion = self.motion(x, y, z, t)
        u, v, w, _ = np.broadcast_arrays(motion.u, motion.v, motion.w, x)
        return np.stack((u, v, w), axis=-1)

    @property
    def moving(self) -> Formula:
        """Formula with all 16 numbers; derivatives are differences if the flow's own formula returns velocity only.

        Raises:
            ValueError: If the formula returns neither 3 nor 16 numbers.
        """
        formula = self.formula
        example: Any = formula.function(self, *EXAMPLE)
        count = _count_numbers(example)
        if count == len(Motion._fields):
            return formula
        if count != 3:
            rule = f"must return 3 numbers (u, v, w) or the {len(Motion._fields)} of a `Motion`"
            raise ValueError(f"`{formula.name}` {rule}, got {example!r}.")
        return Formula(
            name=formula.name, function=differentiated(formula.function), fields=formula.fields
        )

    def check(self) -> None:
        """Reject a flow that the kernels cannot compile.

        Raises:
            ValueError: If the flow cannot be compiled; the message gives the reason.
        """
        part_of_each_class = {type(part): part for part in self.parts}
        for part in part_of_each_class.values():
            if part.moving.is_own:
                continue
            from laticauda.compiling.formulas import check  # Numba is slow to import

            check(
                part.moving,
                part.numbers,
                None,
                EXAMPLE,
                len(Motion._fields),
                "those of a `Motion`",
            )

    @property
    def limits(self) -> str:
        """Description of the places and times to which the flow is limited; "": unlimited."""
        flows: tuple[Flow, ...] = getattr(self, "flows", ())
        return " and ".join(flow.limits for flow in flows if flow.limits)

    @property
    def words(self) -> str:
        """Description of the flow: its name and its nonzero numbers, with their units, angles in degrees."""
        numbers = [
            f"{name.replace('_', ' ')} {description}"
            for name, description in describe_fields(self).items()
        ]
        own_name = name_of(type(self)).replace("-", " ")
        return ", ".join([own_name, *numbers])


@value_class
class Sum(Flow):
    """Sum of several flows: their velocities, gradients and surface elevations are added."""

    flows: tuple[Flow, ...] = option("Flows to add")

    @property
    def parts(self) -> tuple[Flow, ...]:
        """Parts of all flows."""
        return tuple(chain.from_iterable(flow.parts for flow in self.flows))

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """Sum of the velocities if all flows are constant."""
        velocities = [flow.constant for flow in self.flows]
        if any(velocity is None for velocity in velocities):
            return None
        table = np.array(velocities, dtype=float).reshape(-1, 3)
        x, y, z = np.sum(table, axis=0).tolist()
        return x, y, z

    @property
    def words(self) -> str:
        """Descriptions of all flows."""
        return " and ".join(flow.words for flow in self.flows)


@value_class
class FunctionFlow(OfFunction, Flow):
    """A plain function as a flow, with the arguments of a flow; the values it closes over are compiled into it.

    It has no numbers to sweep and cannot be described in a file: write a class for that.
    """

    function: Callable[..., tuple[float, ...]] = option("f(x, y, z, t)")


class PartKind(NamedTuple):
    """What distinguishes parts of a flow that need different kernels."""

    flow_class: type[Flow]
    """Class of the part."""
    function: Any = None
    """Its plain function, if it is one."""
    shape: tuple[int, ...] | None = None
    """Numbers of nodes along the axes of its table, if it reads one."""


class Rows(NamedTuple):
    """A flow in the form that the kernels take."""

    kinds: tuple[Formula, ...] = ()
    """Formulas of the parts, once each."""
    parts: tuple[PartKind, ...] = ()
    """What distinguishes the kinds."""
    counts: tuple[int, ...] = ()
    """Number of parts of each kind."""
    numbers: np.ndarray = np.zeros(0)
    """For each kind, the number of parts, then the numbers of each part."""

    def refuse_tables(self, reader: str) -> None:
        """Reject a flow on a grid.

        Args:
            reader: Description of what cannot read tables.

        Raises:
            ValueError: If a part is a flow on a grid.
        """
        if any(part.shape is not None for part in self.parts):
            raise BadArgument(
                "current", f"must not be a gridded flow: {reader} cannot read its table; got one"
            )


def rows_of(flow: Flow, height: float | None = None) -> Rows:
    """Return a flow in the form that the kernels take.

    Args:
        flow: Flow to convert.
        height: Only height at which the flow is evaluated [m]; None: any.
    """
    parts_by_kind: dict[PartKind, list[Flow]] = {}
    for part in flow.parts:
        if height is not None:
            part = part.at_height(height)
        parts_by_kind.setdefault(_kind_of(part), []).append(part)

    numbers: list[float] = []
    for parts in parts_by_kind.values():
        numbers.append(len(parts))
        for part in parts:
            numbers.extend(part.numbers)

    return Rows(
        kinds=tuple(parts[0].moving for parts in parts_by_kind.values()),
        parts=tuple(parts_by_kind),
        counts=tuple(len(parts) for parts in parts_by_kind.values()),
        numbers=np.array(numbers, dtype=float),
    )


def _kind_of(part: Flow) -> PartKind:
    return PartKind(
        flow_class=type(part),
        function=getattr(part, "function", None),
        shape=getattr(part, "shape", None),
    )


def _count_numbers(result: Any) -> int:
    """Return how many numbers a formula returned."""
    if type(result) in (tuple, Motion):
        return len(result)
    return 1


def differentiated(flow: Callable[..., Any]) -> Callable[..., Any]:
    """Extend a formula of the velocity to one of velocity, its rate, its gradient and the elevation, which is 0.

    Args:
        flow: Function of `self`, x, y, z [m] and t [s]; it returns u, v, w [m/s].
    """

    def slopes(
        law: Any, x: float, y: float, z: float, t: float, dx: float, dy: float, dz: float, dt: float
    ) -> Any:
        u_1, v_1, w_1 = flow(law, x + dx, y + dy, z + dz, t + dt)
        u_0, v_0, w_0 = flow(law, x - dx, y - dy, z - dz, t - dt)
        return 0.5 * (u_1 - u_0) / STEP, 0.5 * (v_1 - v_0) / STEP, 0.5 * (w_1 - w_0) / STEP

    def complete(law: Any, x: float, y: float, z: float, t: float) -> Any:
        u, v, w = flow(law, x, y, z, t)
        u_x, v_x, w_x = slopes(law, x, y, z, t, STEP, 0.0, 0.0, 0.0)
        u_y, v_y, w_y = slopes(law, x, y, z, t, 0.0, STEP, 0.0, 0.0)
        u_z, v_z, w_z = slopes(law, x, y, z, t, 0.0, 0.0, STEP, 0.0)
        u_t, v_t, w_t = slopes(law, x, y, z, t, 0.0, 0.0, 0.0, STEP)
        return u, v, w, u_t, v_t, w_t, u_x, u_y, u_z, v_x, v_y, v_z, w_x, w_y, w_z, 0.0

    complete.__module__ = flow.__module__
    return complete
