"""A robot behind ros2_control as the modules' bus: `JointState` come from it, and arrays of positions go to it.

ros2_control has no states of modules, so they are kept here: a joint holds when references stay
away, and is limp a second later. It is so by a second controller, which switches the motors;
without one, nothing could make it limp.
"""

import math
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from cyclonedds.core import DDSException

from laticauda.tank.operate.drivers import Bus, Clock, DeviceFailed, Frame
from laticauda.tank.protocol import (
    EVERY_NODE,
    N_NODES,
    CanMessage,
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    NodeState,
    Order,
    References,
    Sync,
    encode,
)
from laticauda.values import BadArgument
from laticauda_ros2 import messages
from laticauda_ros2.node import PATIENCE, TOPIC, Node, name_and_domain, waited

STATES, GOALS, MOTORS = (
    "joint_states",
    "forward_position_controller/commands",
    "forward_motor_controller/commands",
)
IDLE = 0.05  # the longest between two cycles [s, wall clock]
BEAT = 0.1  # [s]
HOLD_AFTER, LIMP_AFTER = 0.2, 1.2  # without references [s]
SILENT = 0.5  # a joint of which nothing came for so long is not well [s]
ARRIVES = 1.0  # that motors are to go off, at the end [s, wall clock]
PER_GROUP = 4


@dataclass
class Joint:
    """What is known of one of them."""

    state: NodeState = NodeState.READY
    zero: float = 0.0
    """What its position means more than the joint's angle [rad]."""
    position: float = math.nan
    """[rad]."""
    stamp: float = -math.inf
    """Of that position, the robot's clock [s]."""
    heard: float = -math.inf
    """When it came, our clock [s]."""
    goal: float = math.nan
    """Of its position [rad]."""
    referred: float = -math.inf
    """When its last reference came [s]."""
    is_stopped: bool = False
    """By an emergency stop."""
    beats: int = 0
    """How many heartbeats were sent for it."""


class Ros2Control(Bus):
    """Joints behind ros2_control; the address is JOINT,JOINT,... or NAMESPACE/JOINT,JOINT,...:DOMAIN, tail first."""

    called = "ros2"

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        space, names, domain = self._parts(address)
        self._states, self._goals, self._motors = (
            f"{space}/{name}" for name in (STATES, GOALS, MOTORS)
        )
        self._joints = {name: Joint() for name in names}
        self._orders: deque[CanMessage] = deque()
        self._pending: dict[int, float] = {}  # references that no Sync followed yet
        self._asked: deque[dict[int, float]] = deque(maxlen=1)
        self._beat_due, self._deaf, self._nonsense = 0.0, "", ""
        self._node = Node(domain)
        try:
            self._node.read(self._states, messages.JointState)
            for topic in (self._goals, self._motors):
                self._node.write(topic, messages.Float64MultiArray)
            self._find_robot()
        except OSError:
            self._node.close()
            raise
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        space, names, _ = cls._parts(address)
        unique = all(names) and len(set(names)) == len(names) <= N_NODES
        if not unique or (space and not TOPIC.fullmatch(space)):
            rule = (
                f"must be JOINT,JOINT,... with up to {N_NODES} names, tail first; "
                "NAMESPACE/ before and :DOMAIN after"
            )
            raise BadArgument("address", f"{rule} are optional, got {address!r}")

    @staticmethod
    def _parts(address: str) -> tuple[str, list[str], int]:
        name, domain = name_and_domain(address)
        space, _, joints = name.rpartition("/")
        return space, joints.split(","), domain

    def _find_robot(self) -> None:
        """Wait for its controllers and all of its joints, and switch its motors off."""
        where = f"in domain {self._node.domain}: check ROS_DOMAIN_ID, and"
        for topic in (self._goals, self._motors):
            if not waited(lambda topic=topic: self._node.is_heard(topic), PATIENCE):
                raise DeviceFailed(
                    f"No node subscribes to {topic} {where} `ros2 control list_controllers` (for {self._address})."
                )

        def are_there() -> bool:
            self._measure(self._clock.now())
            return all(math.isfinite(joint.position) for joint in self._joints.values())

        if not waited(are_there, PATIENCE):
            missing = ", ".join(
                name for name, joint in self._joints.items() if not math.isfinite(joint.position)
            )
            raise DeviceFailed(
                f"No position of {missing} arrives on {self._states} {where} the names of the joints."
            )
        self._switch()

    # ---- what the loop calls ---------------------------------------------------------------------

    @property
    def bus_off(self) -> str:
        """See `Bus`."""
        return self._deaf or self.trouble

    @property
    def trouble(self) -> str:
        """See `Worker`."""
        return self._trouble or self._deaf or self._nonsense

    def send(self, messages: Iterable[CanMessage]) -> tuple[Frame, ...]:
        """See `Bus`; the thread does what they say. Frames are recorded as the CAN bus would have them."""
        found: list[Frame] = []
        for message in messages:
            if isinstance(message, References):
                self._pending |= dict(enumerate(message.angles, PER_GROUP * message.group + 1))
            elif isinstance(message, Sync):
                self._asked.append(self._pending)
                self._pending = {}
            else:
                self._orders.append(message)
            found.append(Frame(self._clock.now(), *encode(message), is_ours=True, message=message))
        self._node.wake()
        return tuple(found)

    # ---- what the thread does --------------------------------------------------------------------

    def work(self) -> None:
        """One cycle: what the joints measure, orders, references; ten times a second, how they are."""
        self._node.wait(IDLE)
        now = self._clock.now()
        self._measure(now)
        before = [joint.state.is_on for joint in self._joints.values()]
        while self._orders:
            self._obey(self._orders.popleft(), now)
        is_asked = bool(self._asked)
        asked = self._asked.popleft() if is_asked else {}
        for number, joint in enumerate(self._joints.values(), start=1):
            if not joint.state.is_on:
                joint.goal = joint.position  # nothing jumps when it is switched on
            elif number in asked:
                joint.state, joint.referred, joint.goal = (
                    NodeState.ACTIVE,
                    now,
                    asked[number] + joint.zero,
                )
            elif now - joint.referred > LIMP_AFTER:
                joint.state = NodeState.LIMP
            elif now - joint.referred > HOLD_AFTER:
                joint.state = NodeState.HOLD
        is_due = now >= self._beat_due
        is_new = is_due or before != [joint.state.is_on for joint in self._joints.values()]
        if is_new or is_asked:
            self._node.say(
                self._goals, messages.numbers(joint.goal for joint in self._joints.values())
            )
        if is_new:
            self._switch()
        if is_due:
            self._beat_due = now + BEAT
            self._beat(now)

    def _measure(self, now: float) -> None:
        """Take what the robot says of its joints; of those that it says nothing of, nothing is heard."""
        for message in self._node.taken(self._states):
            self._nonsense = "" if message is not None else f"invalid message on {self._states}"
            if message is None:
                continue
            stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            columns = (
                _column(one, len(message.name))
                for one in (message.position, message.velocity, message.effort)
            )
            measured = dict(zip(message.name, zip(*columns, strict=True), strict=True))
            for number, (name, joint) in enumerate(self._joints.items(), start=1):
                position, rate, torque = measured.get(name, (math.nan,) * 3)
                if not math.isfinite(position):
                    continue
                dt = stamp - joint.stamp
                slope = (position - joint.position) / dt if 0.0 < dt < SILENT else 0.0
                joint.position, joint.stamp, joint.heard = position, stamp, now
                said = JointState(
                    node=number,
                    angle=position - joint.zero,
                    rate=rate if math.isfinite(rate) else slope,
                    current=0.0,
                    torque=torque if math.isfinite(torque) else 0.0,
                )
                self._received.append(Frame(now, *encode(said), is_ours=False, message=said))

    def _obey(self, message: CanMessage, now: float) -> None:
        """Do what an order says."""
        if isinstance(message, EmergencyStop):
            for joint in self._joints.values():
                joint.state, joint.is_stopped = NodeState.FAULT, True
        if not isinstance(message, NodeCommand):
            return
        for number, joint in enumerate(self._joints.values(), start=1):
            if message.node not in (EVERY_NODE, number):
                continue
            if message.order == Order.CLEAR and joint.is_stopped:
                joint.state, joint.is_stopped = NodeState.READY, False
            elif joint.state == NodeState.FAULT:
                continue
            elif message.order == Order.ENABLE and not joint.state.is_on:
                joint.state, joint.referred, joint.goal = NodeState.ACTIVE, now, joint.position
            elif message.order == Order.DISABLE:
                joint.state = NodeState.READY
            elif message.order == Order.SET_ZERO and not joint.state.is_on:
                joint.zero = joint.position - message.angle

    def _switch(self) -> None:
        """Motors on or off, as the joints' states are; say so, if nobody is there to do it."""
        self._node.say(
            self._motors, messages.numbers(joint.state.is_on for joint in self._joints.values())
        )
        deaf = [topic for topic in (self._goals, self._motors) if not self._node.is_heard(topic)]
        self._deaf = f"no node subscribes to {' and '.join(deaf)} any longer" if deaf else ""

    def _beat(self, now: float) -> None:
        """How every joint is of which something was heard; of voltage and temperature nothing is known."""
        for number, joint in enumerate(self._joints.values(), start=1):
            if now - joint.heard > SILENT:
                continue
            lost = joint.state in (NodeState.HOLD, NodeState.LIMP)
            stopped, count = joint.is_stopped, joint.beats % 256
            said = Heartbeat(
                node=number,
                state=joint.state,
                references_lost=lost,
                emergency_stopped=stopped,
                counter=count,
            )
            joint.beats += 1
            self._received.append(Frame(now, *encode(said), is_ours=False, message=said))

    def release(self) -> None:
        """Switch all motors off, and leave the network."""
        for joint in self._joints.values():
            joint.state = NodeState.READY
        with suppress(DDSException):
            self._switch()
            self._node.has_arrived(self._motors, ARRIVES)
        self._node.close()


def _column(values: Any, n: int) -> list[float]:
    """One of the arrays of a message with n names; nan where it is left out, or not as long as it must be."""
    return list(values) if len(values) == n else [math.nan] * n
