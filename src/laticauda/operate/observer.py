"""A passive observer of a robot that somebody else operates: what modules and cameras say, and where it is by that.

Everything is taken by the time at which it came, so nothing has to be known about the clocks of others, nor how fast
the time of a virtual tank goes. Rates are then by our clock, too.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from laticauda.estimation import Estimate, JointSample, KinematicEstimator, KinematicState, Mount, PoseSample
from laticauda.operate import loop, settings
from laticauda.operate.safety.limits import Modules, no_reports, updated
from laticauda.protocol import CanMessage, Heartbeat, JointState, can, worker
from laticauda.quantities import option, value
from laticauda.robot import Robot

SILENT = 2.0  # who says nothing for so long is silent [s]
LOOK = 0.04  # between two looks at what came in [s]
WAITING = "Connecting ..."
STRAIGHT_AFTER = 0.5  # modules that have not told their angles by then are taken for straight [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class ObserverState:
    """What the modules and cameras have said so far."""

    modules: Modules
    """What the modules say."""
    posture: KinematicState
    """Of the kinematics."""
    begun: float
    """When observing began [s]."""
    largest_node: int = 0
    """Greatest number of a module that was heard; the robot may have fewer [-]."""
    frame_time: float = -np.inf
    """When the cameras sent their last frame [s]."""
    tracked_time: float = -np.inf
    """When they saw the robot last [s]."""


@value
class PassiveObserver:
    """From what goes over the wires to center of mass and link angles, by kinematics as in the paper, tank frame.

    Raises:
        ValueError: If the robot has no module that carries the markers.
    """

    robot: Robot = option("what is operated; CAN node k is its joint k - 1")
    mount: Mount = option("where the marker body sits", default_factory=Mount)

    def __post_init__(self) -> None:
        """Refuse a mount that is not on the robot."""
        _ = self.kinematics

    @cached_property
    def kinematics(self) -> KinematicEstimator:
        """What says where the robot is."""
        return KinematicEstimator(robot=self.robot, mount=self.mount)

    @property
    def _n_nodes(self) -> int:
        return len(self.robot.driven_joints)

    def init(self, now: float) -> ObserverState:
        """Before any message and frame, at the time `now` [s]."""
        return ObserverState(modules=no_reports(self._n_nodes), posture=self.kinematics.init(), begun=now)

    def step(
        self,
        state: ObserverState,
        now: float,
        messages: Iterable[tuple[float, CanMessage]],
        frames: Iterable[tuple[float, PoseSample]],
    ) -> ObserverState:
        """What is known after some more messages and frames.

        Args:
            state: As the last call returned it, or `init`.
            now: [s].
            messages: From the bus, oldest first, with the times of their arrival [s].
            frames: From the cameras, likewise; their own times do not count.
        """
        messages = tuple(messages)
        nodes = [message.node for _, message in messages if isinstance(message, Heartbeat | JointState)]
        state = replace(state, largest_node=max([state.largest_node, *nodes]))
        for cycle in _cycles(messages):
            state = replace(state, modules=updated(state.modules, cycle))
            if any(isinstance(message, JointState) for _, message in cycle):
                state = self._with_joints(state, cycle[-1][0], state.modules.angle)
        if not state.posture.joints and now - state.begun > STRAIGHT_AFTER:
            state = self._with_joints(state, now, np.zeros(self._n_nodes))
        for arrival, frame in frames:
            posture = self.kinematics.step(state.posture, replace(frame, time=arrival))
            tracked = state.tracked_time if frame.is_lost else arrival
            state = replace(state, posture=posture, frame_time=arrival, tracked_time=tracked)
        return state

    def estimate(self, state: ObserverState, now: float) -> Estimate | None:
        """Where the robot is; None before the cameras have seen it.

        Args:
            state: As `step` returned it.
            now: [s].
        """
        return self.kinematics.estimate(state.posture, now)

    def fin_angle(self, state: ObserverState) -> float:
        """Of a driven fin in `state`, as its module said last; 0 before that, and without one [rad]."""
        return float(np.nan_to_num(state.modules.angle[self.robot.n_joints :]).sum())

    def complaint(self, state: ObserverState, now: float) -> str:
        """What is missing from the picture, in a sentence; "" if nothing is.

        Args:
            state: As `step` returned it.
            now: [s].
        """
        if now - state.begun < STRAIGHT_AFTER:
            return ""
        modules, n = state.modules, self._n_nodes
        if state.largest_node > n:
            return (
                f"Module {state.largest_node} is heard, and {self.robot.name} has {n} joints: choose the robot that is "
                "in the tank."
            )
        silent = modules.silent(now, SILENT)
        if len(silent) == n:
            return "No module is heard on the bus: check that the lab runs, or the robot's power."
        if now - state.frame_time > SILENT:
            return "The motion capture sends no frames: check that it measures."
        if now - state.tracked_time > SILENT:
            return "The cameras do not see the robot: it is drawn where they saw it last."
        if silent:
            return f"Module {', '.join(map(str, silent))} is not heard: its joint is drawn as it was last."
        if now - float(np.max(modules.angle_time)) > SILENT:
            drawn = "as they were last" if np.isfinite(modules.angle).all() else "straight"
            return f"Nobody operates the robot: its modules tell their angles only when asked; drawn {drawn}."
        return ""

    def _with_joints(self, state: ObserverState, time: float, angle: np.ndarray) -> ObserverState:
        return replace(state, posture=self.kinematics.step(state.posture, JointSample(time=time, angle=angle)))


def _cycles(messages: tuple[tuple[float, CanMessage], ...]) -> list[list[tuple[float, CanMessage]]]:
    """The messages in pieces in which every module tells its angle once at most."""
    pieces, reports = dict[int, list[tuple[float, CanMessage]]](), Counter[int]()
    for time, message in messages:
        reports.update([message.node] if isinstance(message, JointState) else ())
        pieces.setdefault(max(reports.values(), default=1), []).append((time, message))
    return list(pieces.values())


# ---- on wires --------------------------------------------------------------------------------------------------------


class Sight(NamedTuple):
    """What a listener knows now."""

    estimate: Estimate | None
    """Where the robot is; None before that is known."""
    trouble: str
    """What is wrong, in a sentence, or ""."""
    fin_angle: float = 0.0
    """Of a driven fin [rad]."""


class Listener(worker.Worker[None]):
    """Where the robot is, as far as listening tells. A tank that is not there yet, or that goes away, is waited for.

    Args:
        connection: Where bus and cameras are; the power meter is left alone, for it answers to one only.
        robot: What is operated.
        mount: Where the marker body sits.

    Raises:
        ValueError: If the robot has no module that carries the markers.
        MissingExtra: If a library is not installed.
    """

    def __init__(self, connection: settings.Connection, robot: Robot, mount: Mount | None = None) -> None:
        super().__init__("observer")
        can.python_can()
        worker.hardware("qtm-rt", "qtm_rt")
        self.robot = robot
        self._connection, self._clock = connection, worker.Clock()
        self._observer = PassiveObserver(robot=robot, mount=mount or Mount())
        self._sight = Sight(None, WAITING)
        self._start()

    def look(self) -> Sight:
        """What is known now."""
        trouble = f"{self.trouble} It is tried again and again." if self.trouble else self._sight.trouble
        return self._sight._replace(trouble=trouble)

    def close(self) -> None:
        """Listen no more; a connection that is being made ends a little later."""
        self._ended.set()

    def join(self, timeout: float) -> None:
        """Wait until all is closed, for at most `timeout` [s]."""
        self._thread.join(timeout)

    def work(self) -> None:
        """One connection, from its begin to its end."""
        with loop.connected(self._connection, self._clock) as devices:
            self._trouble = ""
            self._listen(devices, self._clock)

    def _listen(self, devices: loop.Devices, clock: worker.Clock) -> None:
        observer, state = self._observer, self._observer.init(clock.now())
        while not self._ended.wait(LOOK):
            now = clock.now()
            inputs, _ = devices.receive()
            state = observer.step(state, now, inputs.messages, inputs.frames)
            trouble = (devices.can.bus_off or devices.mocap.trouble).rstrip(".")
            sentence = f"{trouble[:1].upper()}{trouble[1:]}." if trouble else observer.complaint(state, now)
            self._sight = Sight(observer.estimate(state, now), sentence, observer.fin_angle(state))
