"""A robot behind ros2_control as the modules' bus: `JointState` come from it, and arrays of positions go to it.

ros2_control has no states of modules, so they are kept here: a joint holds when references stay
away, and is limp a second later. It is so by a second controller, which switches the motors;
without one, nothing could make it limp.
"""

import math
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

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
from laticauda_ros2.node import PATIENCE, TOPIC, Node, name_and_domain, wait_until

STATES = "joint_states"
"""Topic of what the joints measure."""
GOALS = "forward_position_controller/commands"
"""Topic of the joints' positions that are asked for."""
MOTORS = "forward_motor_controller/commands"
"""Topic that switches the joints' motors: 1 is on, 0 is limp."""
IDLE = 0.05
"""Time between two cycles at most [s, wall clock]."""
BEAT = 0.1
"""Time between two heartbeats of a joint [s]."""
HOLD_AFTER = 0.2
"""Time without references after which a joint holds its position [s]."""
LIMP_AFTER = 1.2
"""Time without references after which a joint is limp [s]."""
SILENT = 0.5
"""A joint of which nothing came for so long is not well [s]."""
ARRIVES = 1.0
"""How long it waits, at the end, until the message that switches the motors off has arrived [s, wall clock]."""
JOINTS_PER_GROUP = 4
"""How many joints a `References` message speaks of."""


@dataclass
class Joint:
    """What is known of a joint."""

    state: NodeState = NodeState.READY
    zero: float = 0.0
    """Its position where the joint's angle is 0 [rad]."""
    position: float = math.nan
    """[rad]."""
    stamp: float = -math.inf
    """Time of that position by the robot's clock [s]."""
    heard_at: float = -math.inf
    """When it came by our clock [s]."""
    goal: float = math.nan
    """Position that it is to have [rad]."""
    referred_at: float = -math.inf
    """When its last reference came [s]."""
    is_stopped: bool = False
    """By an emergency stop."""
    n_beats: int = 0
    """How many heartbeats were sent for it."""


class Measurement(NamedTuple):
    """What a message says of a joint; nan where it says nothing."""

    position: float
    """[rad]."""
    rate: float
    """[rad/s]."""
    torque: float
    """[N m]."""


class RobotAddress(NamedTuple):
    """What the address says."""

    space: str
    """Namespace of the topics; "" is none."""
    joints: list[str]
    """Names of the joints, tail first."""
    domain: int
    """Of DDS."""


def parse_address(address: str) -> RobotAddress:
    """Return what an address says.

    Args:
        address: JOINT,JOINT,... or NAMESPACE/JOINT,JOINT,...; and :DOMAIN.

    Raises:
        ValueError: If the domain is none.
    """
    name, domain = name_and_domain(address)
    space, _, joints = name.rpartition("/")
    return RobotAddress(space, joints.split(","), domain)


class Ros2Control(Bus):
    """Joints behind ros2_control; the address is JOINT,JOINT,... or NAMESPACE/JOINT,JOINT,...:DOMAIN, tail first."""

    called = "ros2"

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        robot = parse_address(address)
        self._states = f"{robot.space}/{STATES}"
        self._goals = f"{robot.space}/{GOALS}"
        self._motors = f"{robot.space}/{MOTORS}"
        self._joints = {name: Joint() for name in robot.joints}
        self._orders: deque[CanMessage] = deque()
        self._pending: dict[int, float] = {}  # references that no Sync followed yet
        self._references: deque[dict[int, float]] = deque(maxlen=1)
        self._beat_due = 0.0
        self._deaf = ""
        self._nonsense = ""
        self._node = Node(robot.domain)
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
        robot = parse_address(address)
        names = robot.joints
        are_names = all(names) and len(set(names)) == len(names) <= N_NODES
        is_space = not robot.space or TOPIC.fullmatch(robot.space)
        if not are_names or not is_space:
            rule = (
                f"must be JOINT,JOINT,... with up to {N_NODES} names, tail first; "
                "NAMESPACE/ before and :DOMAIN after"
            )
            raise BadArgument("address", f"{rule} are optional, got {address!r}")

    def _find_robot(self) -> None:
        """Wait for its controllers and all of its joints, and switch its motors off."""
        where = f"in domain {self._node.domain}: check ROS_DOMAIN_ID, and"
        for topic in (self._goals, self._motors):
            if not wait_until(lambda topic=topic: self._node.is_heard(topic), PATIENCE):
                raise DeviceFailed(
                    f"No node subscribes to {topic} {where} `ros2 control list_controllers` (for {self._address})."
                )

        def have_come() -> bool:
            self._measure(self._clock.now())
            return not self._silent_joints()

        if not wait_until(have_come, PATIENCE):
            missing = ", ".join(self._silent_joints())
            raise DeviceFailed(
                f"No position of {missing} arrives on {self._states} {where} the names of the joints."
            )
        self._switch()

    def _silent_joints(self) -> list[str]:
        """Return the names of the joints of which no position has come yet."""
        joints = self._joints.items()
        return [name for name, joint in joints if not math.isfinite(joint.position)]

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
        frames: list[Frame] = []
        for message in messages:
            if isinstance(message, References):
                first = JOINTS_PER_GROUP * message.group + 1
                self._pending |= dict(enumerate(message.angles, first))
            elif isinstance(message, Sync):
                self._references.append(self._pending)
                self._pending = {}
            else:
                self._orders.append(message)
            frames.append(Frame(self._clock.now(), *encode(message), is_ours=True, message=message))
        self._node.wake()
        return tuple(frames)

    # ---- what the thread does --------------------------------------------------------------------

    def work(self) -> None:
        """One cycle: what the joints measure, orders, references; ten times a second, how they are."""
        self._node.wait(IDLE)
        now = self._clock.now()
        self._measure(now)
        were_on = self._are_on()
        while self._orders:
            self._obey(self._orders.popleft(), now)
        has_references = bool(self._references)
        references = dict[int, float]()
        if has_references:
            references = self._references.popleft()
        self._follow(references, now)
        is_beat_due = now >= self._beat_due
        must_switch = is_beat_due or self._are_on() != were_on
        if must_switch or has_references:
            goals = [joint.goal for joint in self._joints.values()]
            self._node.say(self._goals, messages.numbers(goals))
        if must_switch:
            self._switch()
        if is_beat_due:
            self._beat_due = now + BEAT
            self._beat(now)

    def _are_on(self) -> list[bool]:
        """Return whether the motor of every joint is on."""
        return [joint.state.is_on for joint in self._joints.values()]

    def _follow(self, references: Mapping[int, float], now: float) -> None:
        """Give all joints their references as goals [rad]; those without one hold, and are limp later."""
        for number, joint in enumerate(self._joints.values(), start=1):
            if not joint.state.is_on:
                joint.goal = joint.position  # nothing jumps when it is switched on
            elif number in references:
                joint.state = NodeState.ACTIVE
                joint.referred_at = now
                joint.goal = references[number] + joint.zero
            elif now - joint.referred_at > LIMP_AFTER:
                joint.state = NodeState.LIMP
            elif now - joint.referred_at > HOLD_AFTER:
                joint.state = NodeState.HOLD

    def _measure(self, now: float) -> None:
        """Take what the robot says of its joints; of those that it says nothing of, nothing is reported."""
        for message in self._node.taken(self._states):
            if message is None:
                self._nonsense = f"invalid message on {self._states}"
                continue
            self._nonsense = ""
            stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
            measurements = _measurements_in(message)
            for number, (name, joint) in enumerate(self._joints.items(), start=1):
                measurement = measurements.get(name)
                if measurement is None or not math.isfinite(measurement.position):
                    continue
                state = _update_joint(joint, number, measurement, stamp)
                joint.heard_at = now
                self._report(now, state)

    def _report(self, now: float, message: CanMessage) -> None:
        self._received.append(Frame(now, *encode(message), is_ours=False, message=message))

    def _obey(self, message: CanMessage, now: float) -> None:
        """Do what an order says."""
        if isinstance(message, EmergencyStop):
            for joint in self._joints.values():
                joint.state = NodeState.FAULT
                joint.is_stopped = True
        if not isinstance(message, NodeCommand):
            return
        for number, joint in enumerate(self._joints.values(), start=1):
            if message.node not in (EVERY_NODE, number):
                continue
            if message.order == Order.CLEAR and joint.is_stopped:
                joint.state = NodeState.READY
                joint.is_stopped = False
            elif joint.state == NodeState.FAULT:
                continue
            elif message.order == Order.ENABLE and not joint.state.is_on:
                joint.state = NodeState.ACTIVE
                joint.referred_at = now
                joint.goal = joint.position
            elif message.order == Order.DISABLE:
                joint.state = NodeState.READY
            elif message.order == Order.SET_ZERO and not joint.state.is_on:
                joint.zero = joint.position - message.angle

    def _switch(self) -> None:
        """Switch motors on or off, as the joints' states are; say so if nobody is there to do it."""
        self._node.say(self._motors, messages.numbers(self._are_on()))
        unheard = [topic for topic in (self._goals, self._motors) if not self._node.is_heard(topic)]
        self._deaf = ""
        if unheard:
            self._deaf = f"no node subscribes to {' and '.join(unheard)} any longer"

    def _beat(self, now: float) -> None:
        """Report how every joint is that is heard of; of voltage and temperature nothing is known."""
        for number, joint in enumerate(self._joints.values(), start=1):
            if now - joint.heard_at > SILENT:
                continue
            heartbeat = Heartbeat(
                node=number,
                state=joint.state,
                references_lost=joint.state in (NodeState.HOLD, NodeState.LIMP),
                emergency_stopped=joint.is_stopped,
                counter=joint.n_beats % 256,
            )
            joint.n_beats += 1
            self._report(now, heartbeat)

    def release(self) -> None:
        """Switch all motors off, and leave the network."""
        for joint in self._joints.values():
            joint.state = NodeState.READY
        with suppress(DDSException):
            self._switch()
            self._node.has_arrived(self._motors, ARRIVES)
        self._node.close()


def _measurements_in(message: Any) -> dict[str, Measurement]:
    """Return what a message says of every joint that it names."""
    n = len(message.name)
    positions = _column(message.position, n)
    rates = _column(message.velocity, n)
    torques = _column(message.effort, n)
    measurements = map(Measurement, positions, rates, torques)
    return dict(zip(message.name, measurements, strict=True))


def _column(values: Any, n: int) -> list[float]:
    """Return an array of a message with n names; nan where it is left out, or not as long as it must be."""
    if len(values) != n:
        return [math.nan] * n
    return list(values)


def _update_joint(joint: Joint, number: int, measurement: Measurement, stamp: float) -> JointState:
    """Return what a joint reports of a measurement, and remember the measurement.

    A rate that is not measured is the slope since the last position, a torque that is not measured is 0.
    """
    rate = measurement.rate
    if not math.isfinite(rate):
        dt = stamp - joint.stamp
        rate = 0.0
        if 0.0 < dt < SILENT:
            rate = (measurement.position - joint.position) / dt
    torque = measurement.torque
    if not math.isfinite(torque):
        torque = 0.0
    joint.position = measurement.position
    joint.stamp = stamp
    return JointState(
        node=number,
        angle=measurement.position - joint.zero,
        rate=rate,
        current=0.0,
        torque=torque,
    )
