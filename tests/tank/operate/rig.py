"""The simplest robot that an operation can be run on without any connection: modules that do as they are told.

Its joints follow with a lag, it moves along its heading while they move, and everything that can be
lost or wrong is a switch. The virtual tank does it properly; this one is for laws that need
thousands of ticks.
"""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.robot import Robot
from laticauda.robot.kinematics import Posture, link_angles
from laticauda.tank.operate import Event, PowerReading
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import Inputs, OperatorState, Outputs
from laticauda.tank.operate.recording.entries import Measurement
from laticauda.tank.operate.safety.supervisor import TRANSITIONS
from laticauda.tank.protocol import (
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    NodeState,
    Order,
    References,
    Sync,
)

CAMERAS_AHEAD = 12.5  # their clock against ours [s]


@dataclass
class Rig:
    """A robot whose state is changed by `advance`."""

    robot: Robot
    position: np.ndarray = field(default_factory=lambda: np.array([1.0, 0.5]))
    heading: float = 0.1
    speed: float = 0.1
    time: float = 0.0
    states: list[NodeState] = field(default_factory=list)
    angle: np.ndarray = field(default_factory=lambda: np.zeros(0))
    asked: np.ndarray = field(default_factory=lambda: np.zeros(0))
    waiting: np.ndarray = field(default_factory=lambda: np.zeros(0))
    asked_at: float = -1.0
    # Switches.
    dead: set[int] = field(default_factory=set)
    stuck: set[int] = field(default_factory=set)
    lazy: set[int] = field(default_factory=set)  # do not switch on
    leak: set[int] = field(default_factory=set)
    temperature: float = 25.0
    current: float = 0.3
    sees: bool = True
    measures: bool = True
    hears: bool = True
    last_beat: float = -1.0

    def __post_init__(self) -> None:
        n = len(self.robot.driven_joints)
        self.states = [NodeState.READY] * n
        self.angle, self.asked, self.waiting = np.zeros(n), np.zeros(n), np.zeros(n)

    @property
    def is_limp(self) -> bool:
        return not any(
            state in (NodeState.ACTIVE, NodeState.HOLD) and k not in self.dead
            for k, state in enumerate(self.states)
        )

    def advance(self, dt: float, messages: tuple[Any, ...]) -> Inputs:
        """What the devices say after `dt`, when these messages were sent at its beginning."""
        answers: list[Any] = []
        for message in messages if self.hears else ():
            answers += self._told(message)
        gone = self.time - self.asked_at
        for k, state in enumerate(self.states):
            if state == NodeState.ACTIVE and gone > 0.2:
                self.states[k] = NodeState.HOLD
            if self.states[k] == NodeState.HOLD and gone > 1.2:
                self.states[k] = NodeState.LIMP
        moves = np.array(
            [s == NodeState.ACTIVE and k not in self.stuck for k, s in enumerate(self.states)]
        )
        self.angle = np.where(
            moves, self.angle + (self.asked - self.angle) * (1 - np.exp(-40.0 * dt)), self.angle
        )
        if np.any(np.abs(self.asked) > 0.05) and not self.is_limp:
            self.position = self.position + self.speed * dt * np.array(
                [np.cos(self.heading), np.sin(self.heading)]
            )
        self.time += dt
        if self.time - self.last_beat >= 0.1 - 1e-9 and self.hears:
            self.last_beat = self.time
            answers += [self._beat(k + 1) for k in range(len(self.states)) if k not in self.dead]
        readings = (
            PowerReading(time=self.time, current=1.18 + (0.0 if self.is_limp else 1.0)),
        ) * self.measures
        return Inputs(
            messages=tuple((self.time, answer) for answer in answers),
            frames=((self.time, self._frame()),) if self.sees else (),
            readings=readings,
        )

    def _told(self, message: Any) -> list[Any]:
        n = len(self.states)
        if isinstance(message, EmergencyStop):
            self.states = [NodeState.FAULT] * n
        if isinstance(message, References):
            start = 4 * message.group
            self.waiting[start : start + 4] = message.angles[: max(min(4, n - start), 0)]
            self.asked_at = self.time
        if isinstance(message, NodeCommand):
            turn = {
                Order.ENABLE: NodeState.ACTIVE,
                Order.DISABLE: NodeState.READY,
                Order.CLEAR: NodeState.READY,
            }
            for k, state in enumerate(self.states):
                if message.order == Order.ENABLE and k in self.lazy:
                    continue
                if message.order in turn and (
                    state != NodeState.FAULT or message.order == Order.CLEAR
                ):
                    self.states[k] = turn[message.order]
                    self.asked_at = self.time
        if isinstance(message, Sync):
            self.asked = self.waiting.copy()
            currents = [self.current] * n
            return [
                JointState(
                    node=k + 1,
                    angle=float(self.angle[k]),
                    rate=0.0,
                    current=currents[k],
                    torque=0.1,
                )
                for k in range(n)
                if k not in self.dead
            ]
        return []

    def _beat(self, node: int) -> Heartbeat:
        beat = Heartbeat(node=node, state=self.states[node - 1], temperature=self.temperature)
        return replace(beat, leak=node - 1 in self.leak, not_calibrated=True)

    def _frame(self) -> PoseSample:
        chain = self.robot.planar()
        theta = link_angles(
            self.angle[: self.robot.n_joints][[j.axis == "yaw" for j in self.robot.joints]],
            angle=self.heading,
        )
        tail = Posture(chain, self.position, theta).link_centers[0]
        c, s = np.cos(theta[0]), np.sin(theta[0])
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return PoseSample(
            time=self.time - CAMERAS_AHEAD,
            position=np.array([*tail, -0.15]),
            rotation=rotation,
            residual=0.0005,
        )


@dataclass
class Run:
    """An operation on a rig, tick by tick."""

    operator: Operator
    rig: Rig
    state: OperatorState
    outputs: Outputs = field(default_factory=Outputs)
    inputs: Inputs = field(default_factory=Inputs)
    events: list[Event] = field(default_factory=list)
    samples: list[Any] = field(default_factory=list)

    def tick(self, n: int = 1, **events: str) -> None:
        dt = 1.0 / self.operator.operation.rate
        for _ in range(n):
            inputs = replace(self.rig.advance(dt, self.outputs.messages), events=events)
            before = self.state
            self.state, self.outputs = self.operator.tick(before, self.rig.time, inputs)
            assert follows(before, self.state), "no row of the table of transitions"
            self.events += self.outputs.events
            self.samples += [
                entry for entry in self.outputs.entries if isinstance(entry, Measurement)
            ]

    def until(self, phase: str, patience: float = 60.0) -> None:
        end = self.rig.time + patience
        while self.state.phase != phase:
            assert phase == "done" or not self.state.is_done, self.state.failure or [
                e.message for e in self.events
            ]
            assert self.rig.time < end, (
                f"stays in {self.state.phase}: {[e.message for e in self.events]}"
            )
            self.tick()

    @property
    def log(self) -> list[str]:
        return [event.data.get("event", event.kind) for event in self.events]


def follows(before: OperatorState, after: OperatorState) -> bool:
    """Whether rows of the table lead from one to the other; at one tick, phase and supervisor may both move on."""
    reached = {(before.phase, before.supervisor.state)}
    for _ in range(2):
        reached |= {
            (row.next_phase, row.next_state)
            for row in TRANSITIONS
            if (row.phase, row.state) in reached
        }
    return (after.phase, after.supervisor.state) in reached


def run_of(operator: Operator, **rig: Any) -> Run:
    return Run(operator=operator, rig=Rig(robot=operator.robot, **rig), state=operator.init())
