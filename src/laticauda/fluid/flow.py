"""Water that moves in space and time: flows that own their numbers.

A flow is a frozen value below `Flow`: its fields are its numbers, its `__call__` says how the water moves at a place
and a time. It stands in the water: `Water.current`. Python calls it as it stands, and the kernels compile it
(`laticauda.formulas`); one's own is a class like those of the modules beside this one, or a `FunctionFlow`.

A flow is the sum of its `parts`, each with a formula and up to `formulas.MOST_NUMBERS` numbers: of itself where it has
a formula, of many waves where it is a sea. So the numbers of parts are rows of the kernels, like those of drag laws,
and sums of flows are flows.

Formulas are compiled, so this module and those of flows do without jaxtyping, whose checker wraps functions.

Axes are the world's: z is up, and 0 the mean surface. Formulas hold for floats, complex numbers, lanes and arrays as
those of drag laws do (`laticauda.fluid.laws`).
"""

from collections.abc import Callable
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from laticauda.errors import BadArgument
from laticauda.extensions import Extensible, name_of
from laticauda.formulas import Formula, Law, OfFunction
from laticauda.quantities import option, told, value

STEP = 1e-4
"""Of differences, in m and s: right to (k STEP)^2 / 6 for waves of number k, and to 1e-12 / STEP of the velocity."""


class Motion(NamedTuple):
    """How the water moves at a place, world axes; what a formula returns."""

    u: float
    """Velocity along x [m/s]."""
    v: float
    """Along y [m/s]."""
    w: float
    """Upward [m/s]."""
    u_t: float
    """Rate of u where it is [m/s^2]."""
    v_t: float
    w_t: float
    u_x: float
    """Change of u with x [1/s]."""
    u_y: float
    u_z: float
    v_x: float
    v_y: float
    v_z: float
    w_x: float
    w_y: float
    w_z: float
    elevation: float
    """Of the surface above its mean [m]."""


class Felt(NamedTuple):
    """What a small body meets there, world axes; each of these is a component."""

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
    """Of the surface above its mean [m]."""


def felt(motion: Motion) -> Felt:
    """Velocity, material acceleration and rotation: Du/Dt = u_t + (u . grad) u, curl u / 2.

    Args:
        motion: Of the water at a place.
    """
    u, v, w, u_t, v_t, w_t, u_x, u_y, u_z, v_x, v_y, v_z, w_x, w_y, w_z, elevation = motion
    a_x = u_t + u * u_x + v * u_y + w * u_z
    a_y = v_t + u * v_x + v * v_y + w * v_z
    a_z = w_t + u * w_x + v * w_y + w * w_z
    return Felt(u, v, w, a_x, a_y, a_z, 0.5 * (w_y - v_z), 0.5 * (u_z - w_x), 0.5 * (v_x - u_y), elevation)


class Flow(Law, Extensible, group="flows"):
    """Base of flows: a value whose fields are its numbers.

    Example:
        >>> from laticauda.fluid.flow import FunctionFlow
        >>> flow = FunctionFlow(function=lambda x, y, z, t: (0.1 * y, 0.0, 0.0))
        >>> round(flow.felt(0.0, 2.0, 0.0, 0.0).u, 9)
        0.2
    """

    def __call__(self, x: float, y: float, z: float, t: float) -> tuple[float, ...]:
        """The motion of the water at a place and a time.

        Args:
            x: World axes [m].
            y: The same [m].
            z: The same, above the mean surface [m].
            t: Since the start of the run [s].

        Returns:
            The 16 numbers of a `Motion`, or u, v and w alone: then the others are central differences, and the surface
            stays level.
        """
        return self.motion(x, y, z, t)

    @property
    def parts(self) -> tuple["Flow", ...]:
        """What it is the sum of: flows with formulas."""
        return (self,)

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """Its velocity, if that is the same everywhere at all times [m/s]."""
        return None

    def at_height(self, z: float) -> "Flow":
        """The same at one height [m], where it is asked for at no other: a part may be cheaper there."""
        return self

    def __add__(self, other: "Flow") -> "Sum":
        """Both at once."""
        return Sum(flows=(*getattr(self, "flows", (self,)), *getattr(other, "flows", (other,))))

    def motion(self, x: Any, y: Any, z: Any, t: Any) -> Motion:
        """All that is known of the water's motion at a place, or at arrays of them, in plain Python.

        Args:
            x: World axes [m].
            y: The same [m].
            z: The same, above the mean surface [m].
            t: Since the start of the run [s].
        """
        found: Any = (0.0,) * len(Motion._fields)
        for part in self.parts:
            own: Any = part.formula.function(part, x, y, z, t)
            if type(own) not in (tuple, Motion) or len(own) != len(Motion._fields):
                own = part.moving.function(part, x, y, z, t)
            found = tuple(a + b for a, b in zip(found, own, strict=True))
        return Motion(*found)

    def felt(self, x: Any, y: Any, z: Any, t: Any) -> Felt:
        """What a small body meets there, see `motion`."""
        return felt(self.motion(x, y, z, t))

    def velocity(self, points: np.ndarray, t: Any) -> np.ndarray:
        """Velocity of the water at many points.

        Args:
            points: World axes, shape (..., 3) [m].
            t: Since the start of the run, one for all or one for each [s].

        Returns:
            Of the same shape [m/s].
        """
        x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
        return np.stack(np.broadcast_arrays(*self.motion(x, y, z, t)[:3], x)[:3], axis=-1)

    @property
    def moving(self) -> Formula:
        """The formula with all 16 numbers, derivatives by differences if its own has the velocity alone.

        Raises:
            ValueError: If it returns neither 3 nor 16 numbers.
        """
        formula = self.formula
        found: Any = formula.function(self, 0.1, 0.2, -0.3, 0.4)
        count = len(found) if type(found) in (tuple, Motion) else 1
        if count == len(Motion._fields):
            return formula
        if count != 3:
            rule = f"must return 3 numbers (u, v, w) or the {len(Motion._fields)} of a `Motion`"
            raise ValueError(f"`{formula.name}` {rule}, got {found!r}.")
        return Formula(name=formula.name, function=differentiated(formula.function), fields=formula.fields)

    def check(self) -> None:
        """Refuse a flow that kernels cannot compile.

        Raises:
            ValueError: With the reason.
        """
        from laticauda.compiling.formulas import check  # Numba is slow to import

        for part in {type(part): part for part in self.parts}.values():
            check(part.moving, part.numbers, None, (0.1, 0.2, -0.3, 0.4), len(Motion._fields), "those of a `Motion`")

    @property
    def limits(self) -> str:
        """For what places and times alone it is known, in words; "": for all."""
        return " and ".join(filter(None, (flow.limits for flow in getattr(self, "flows", ()))))

    @property
    def words(self) -> str:
        """What it is, for people: its name and its numbers that are not 0, with their units, angles in degrees."""
        parts = [f"{name.replace('_', ' ')} {one}" for name, one in told(self).items()]
        return ", ".join([name_of(type(self)).replace("-", " "), *parts])


@value
class Sum(Flow):
    """Several flows at once: their velocities, their gradients and what they do to the surface add up."""

    flows: tuple[Flow, ...] = option("What is added up")

    @property
    def parts(self) -> tuple[Flow, ...]:
        """Those of all."""
        return tuple(chain.from_iterable(flow.parts for flow in self.flows))

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """The sum, if all are constant."""
        found = [flow.constant for flow in self.flows]
        if any(one is None for one in found):
            return None
        x, y, z = np.sum(np.array(found, dtype=float).reshape(-1, 3), axis=0).tolist()
        return x, y, z

    @property
    def words(self) -> str:
        """Theirs."""
        return " and ".join(flow.words for flow in self.flows)


@value
class FunctionFlow(OfFunction, Flow):
    """A plain function as a flow: it takes what a flow takes, and what it closes over is compiled into it.

    It has no numbers that could be swept, and no file can say what it is: write a class for that.
    """

    function: Callable[..., tuple[float, ...]] = option("f(x, y, z, t)")


class Rows(NamedTuple):
    """A flow as the kernels take it."""

    kinds: tuple[Formula, ...] = ()
    """The formulas of its parts, once each."""
    parts: tuple[Any, ...] = ()
    """What tells these apart: class, function and shape of what they read, if they have such."""
    counts: tuple[int, ...] = ()
    """How many parts of each kind there are."""
    numbers: np.ndarray = np.zeros(0)
    """For each kind how many parts there are, then the numbers of each."""

    def refuse_tables(self, reader: str) -> None:
        """Refuse a flow on a grid.

        Args:
            reader: What reads no tables, in words.

        Raises:
            ValueError: If a part is one.
        """
        if any(shape is not None for *_, shape in self.parts):
            raise BadArgument("current", f"must not be a gridded flow: {reader} reads no tables; got one")


def rows_of(flow: Flow, height: float | None = None) -> Rows:
    """A flow as the kernels take it.

    Args:
        flow: Which.
        height: At which alone it is asked for [m]; None: at any.
    """
    kinds: dict[Any, list[Flow]] = {}
    for part in flow.parts:
        part = part if height is None else part.at_height(height)
        own = (getattr(part, name, None) for name in ("function", "shape"))
        kinds.setdefault((type(part), *own), []).append(part)
    numbers = [one for parts in kinds.values() for one in (len(parts), *chain(*(part.numbers for part in parts)))]
    formulas = tuple(parts[0].moving for parts in kinds.values())
    return Rows(formulas, (*kinds,), tuple(map(len, kinds.values())), np.array(numbers, dtype=float))


def differentiated(flow: Callable[..., Any]) -> Callable[..., Any]:
    """A formula of the velocity as one of velocity, its rate, its gradient and the elevation, which is 0.

    Args:
        flow: Of `self`, x, y, z [m] and t [s]; it returns u, v, w [m/s].
    """

    def slopes(law: Any, x: float, y: float, z: float, t: float, dx: float, dy: float, dz: float, dt: float) -> Any:
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
