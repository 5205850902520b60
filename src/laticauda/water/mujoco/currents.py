"""How the water of a model moves: where a model stores it, and how its copies find it again.

A model belongs to MuJoCo and has no field for a flow. Copies of the model must have the motion too, and
each may get another one later. The motion is therefore stored in four numbers of the model that
MuJoCo reads only for contact overrides, which models with water cannot use (`checks`):
`opt.o_friction[:4]` holds a constant velocity, or 0 and the number of a flow in the water's
`FlowStore`, which all copies share. Kernels read these numbers (`element_loads.flow_at`).
"""

from collections.abc import Callable, Sequence
from threading import Lock
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from laticauda.values import BadArgument, check_finite
from laticauda.water.fluid.flow import Flow, FunctionFlow, Rows, rows_of
from laticauda.water.mujoco.law_functions import compile_flow
from laticauda.water.mujoco.table import FLOW_COLUMNS, MOST_FLOWS

FlowFunction: TypeAlias = Callable[[float, float, float, float], tuple[float, ...]]
Current: TypeAlias = Flow | FlowFunction | Sequence[float]


class StoredMotion(NamedTuple):
    """The four numbers in a model that say how its water moves."""

    u: float
    """Velocity along x [m/s]; 0 if there is a flow."""
    v: float
    """Velocity along y [m/s]."""
    w: float
    """Velocity upward [m/s]."""
    flow_number: float
    """Number of the flow in the water's `FlowStore`; 0: none, but a constant velocity."""


def write_motion(model: Any, motion: StoredMotion) -> None:
    """Store the motion of the water in a model.

    Args:
        model: The `mujoco.MjModel`.
        motion: Motion of the water.
    """
    model.opt.o_friction[:4] = motion


def read_motion(model: Any) -> StoredMotion:
    """Return the motion of the water that a model stores.

    Args:
        model: The `mujoco.MjModel`.
    """
    return StoredMotion(*model.opt.o_friction[:4].tolist())


class _StoredFlow(NamedTuple):
    """A flow with everything whose address the compiled code has."""

    current: Flow | FlowFunction
    """The flow or function, as the user gave it."""
    function: Any
    """Its compiled function, see `law_entry`."""
    parts: Rows
    """Its formulas and numbers."""


class FlowStore:
    """The last flows that a water and its copies were given; older ones are forgotten."""

    def __init__(self) -> None:
        self.rows = np.zeros((MOST_FLOWS, FLOW_COLUMNS), dtype=np.int64)
        """For compiled code, per flow: its number, the address of its function, and that of its numbers."""
        self._flows: dict[int, _StoredFlow] = {}
        self._lock = Lock()

    def __len__(self) -> int:
        """Return the number of flows that are kept."""
        return len(self._flows)

    def find_flow(self, number: int) -> Flow | FlowFunction:
        """Return the flow of a number.

        Args:
            number: Number of the flow, as stored in a model.
        """
        return self._flows[number].current

    def store(self, current: Current) -> StoredMotion:
        """Return what a model stores for a motion of the water; a flow is kept under a number.

        Args:
            current: Velocity [m/s], a flow, or a function like one.

        Raises:
            ValueError: If it is none of these, or the flow cannot be compiled.
        """
        if isinstance(current, Flow) and current.constant is not None:
            return _constant_motion(current.constant)
        if not callable(current):
            return _constant_motion(current)
        with self._lock:
            return StoredMotion(u=0.0, v=0.0, w=0.0, flow_number=float(self._number_of(current)))

    def _number_of(self, current: Flow | FlowFunction) -> int:
        """Return the number of a flow, which is stored if it is new."""
        for number, stored in self._flows.items():
            if stored.current is current:
                return number
        flow = current
        if not isinstance(flow, Flow):
            flow = FunctionFlow(function=flow)
        parts = rows_of(flow)
        function = compile_flow(flow, parts)
        number = 1 + max(self._flows, default=0)
        self._flows[number] = _StoredFlow(current=current, function=function, parts=parts)
        row = number, function.address, parts.numbers.ctypes.data
        self.rows[number % MOST_FLOWS] = row
        self._flows.pop(number - MOST_FLOWS, None)
        return number


def _constant_motion(velocity: Sequence[float]) -> StoredMotion:
    if len(velocity) != 3:
        rule = "must be a flow, a function of x, y, z and t, or 3 numbers"
        raise BadArgument("current", f"{rule}, got {velocity!r}")
    u, v, w = (
        check_finite(f"current[{i}]", component, "m/s") for i, component in enumerate(velocity)
    )
    return StoredMotion(u=u, v=v, w=w, flow_number=0.0)
