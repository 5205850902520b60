"""Looking on while somebody else operates the robot: what its modules and the cameras say, and where it is by that.

Everything is taken by the time at which it came, so nothing has to be known about the clocks of others, nor how fast
the time of a virtual tank goes. Rates are then by our clock, too.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from laticauda.operate.estimate import Estimate, Mount
from laticauda.operate.kinematic import KinematicEstimator, KinematicState
from laticauda.operate.modules import Modules, heard, no_modules
from laticauda.operate.samples import JointSample, PoseSample
from laticauda.protocol import CanMessage, Heartbeat, JointState
from laticauda.robot import Robot

SILENT = 2.0  # who says nothing for so long is silent [s]
STRAIGHT_AFTER = 0.5  # modules that have not told their angles by then are taken for straight [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class View:
    """What has been seen and heard so far."""

    modules: Modules
    """What the modules say."""
    posture: KinematicState
    """Of the kinematics."""
    begun: float
    """When looking on began [s]."""
    largest_node: int = 0
    """Greatest number of a module that was heard; the robot may have fewer [-]."""
    framed: float = -math.inf
    """When the cameras sent their last frame [s]."""
    seen: float = -math.inf
    """When they saw the robot last [s]."""


@dataclass(frozen=True, kw_only=True)
class Onlooker:
    """From what goes over the wires to center of mass and link angles, by kinematics as in the paper, tank frame.

    Raises:
        ValueError: If the robot has no module that carries the markers.
    """

    robot: Robot
    """What is operated; CAN node k is its joint k - 1."""
    mount: Mount = field(default_factory=Mount)
    """Where the marker body sits."""

    def __post_init__(self) -> None:
        """Check every field once, by the kinematics."""
        object.__setattr__(self, "kinematics", KinematicEstimator(robot=self.robot, mount=self.mount))

    kinematics: KinematicEstimator = field(init=False)
    """What says where the robot is."""

    def init(self, now: float) -> View:
        """Nothing seen yet, at the time `now` [s]."""
        return View(modules=no_modules(self.robot.n_joints), posture=self.kinematics.init(), begun=now)

    def step(
        self,
        view: View,
        now: float,
        messages: Iterable[tuple[float, CanMessage]],
        frames: Iterable[tuple[float, PoseSample]],
    ) -> View:
        """What is known after some more messages and frames.

        Args:
            view: As the last call returned it, or `init`.
            now: [s].
            messages: From the bus, oldest first, with the times of their arrival [s].
            frames: From the cameras, likewise; their own times do not count.
        """
        messages = tuple(messages)
        told = [message.node for _, message in messages if isinstance(message, Heartbeat | JointState)]
        view = replace(view, largest_node=max([view.largest_node, *told]))
        for cycle in _cycles(messages):
            view = replace(view, modules=heard(view.modules, cycle))
            if any(isinstance(message, JointState) for _, message in cycle):
                view = self._bent(view, cycle[-1][0], view.modules.angle)
        if not view.posture.joints and now - view.begun > STRAIGHT_AFTER:
            view = self._bent(view, now, np.zeros(self.robot.n_joints))
        for arrival, frame in frames:
            posture = self.kinematics.step(view.posture, replace(frame, time=arrival))
            seen = view.seen if frame.is_lost else arrival
            view = replace(view, posture=posture, framed=arrival, seen=seen)
        return view

    def estimate(self, view: View, now: float) -> Estimate | None:
        """Where the robot is; None before the cameras have seen it.

        Args:
            view: What has been seen.
            now: [s].
        """
        return self.kinematics.estimate(view.posture, now)

    def complaint(self, view: View, now: float) -> str:
        """What is missing from the picture, in a sentence; "" if nothing is.

        Args:
            view: What has been seen.
            now: [s].
        """
        if now - view.begun < STRAIGHT_AFTER:
            return ""
        modules, n = view.modules, self.robot.n_joints
        if view.largest_node > n:
            return (
                f"Module {view.largest_node} is heard, and {self.robot.name} has {n} joints: choose the robot that is "
                "in the tank."
            )
        silent = modules.silent(now, SILENT)
        if len(silent) == n:
            return "No module is heard on the bus: check that the lab runs, or the robot's power."
        if now - view.framed > SILENT:
            return "The motion capture sends no frames: check that it measures."
        if now - view.seen > SILENT:
            return "The cameras do not see the robot: it is drawn where they saw it last."
        if silent:
            return f"Module {', '.join(map(str, silent))} is not heard: its joint is drawn as it was last."
        if now - float(np.max(modules.angle_time)) > SILENT:
            drawn = "as they were last" if np.isfinite(modules.angle).all() else "straight"
            return f"Nobody operates the robot: its modules tell their angles only when asked; drawn {drawn}."
        return ""

    def _bent(self, view: View, time: float, angle: np.ndarray) -> View:
        return replace(view, posture=self.kinematics.step(view.posture, JointSample(time=time, angle=angle)))


def _cycles(messages: tuple[tuple[float, CanMessage], ...]) -> list[list[tuple[float, CanMessage]]]:
    """The messages in pieces in which every module tells its angle once at most."""
    pieces: list[list[tuple[float, CanMessage]]] = []
    told: set[int] = set()
    for time, message in messages:
        again = isinstance(message, JointState) and message.node in told
        if again or not pieces:
            pieces.append([])
            told = set()
        if isinstance(message, JointState):
            told.add(message.node)
        pieces[-1].append((time, message))
    return pieces
