"""The driver: what `laticauda operate` says to its modules becomes reads and writes of servos' registers.

A servo has no states of a module, so they are kept here: it holds when references stay away, and
limp a second later. If this program dies, the servos' bus watchdog stops them where they are.
"""

import math
import struct
import threading
import time
from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from laticauda.tank.operate.drivers import Bus, Clock, DeviceFailed, Frame
from laticauda.tank.protocol import (
    EVERY_NODE,
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
    hardware,
)
from laticauda.values import BadArgument
from laticauda_dynamixel import packets
from laticauda_dynamixel.packets import BROADCAST, Instruction, Packet, Reader, Register

BAUD_RATE = 1_000_000
ANSWER_TIME = 0.15
"""How long it waits for the answers to a packet [s, wall clock]."""
PING_TIME = 2.0
"""How long it waits for answers to a ping [s, wall clock]."""
SILENCE = 0.3
"""How long it waits for further answers to a ping after the first [s, wall clock]."""
IDLE = 0.05
"""Time between two cycles at most [s, wall clock]."""
BEAT = 0.1
"""Time between two heartbeats of a servo [s]."""
HOLD_AFTER = 0.2
"""Time without references after which a servo holds its position [s]."""
LIMP_AFTER = 1.2
"""Time without references after which a servo is limp [s]."""
WATCHDOG = 25
"""The servos' bus watchdog, in units of `packets.WATCHDOG`: 0.5 s."""
XM430_W350, XM430_W210, XM540_W270, XM540_W150 = 1020, 1030, 1120, 1130
TORQUE = {XM430_W350: 1.78, XM430_W210: 1.30, XM540_W270: 2.41, XM540_W150: 1.66}
"""Torque per current of every model [N m/A]."""
POSITION_MODES = (3, 5)
"""Values of OPERATING_MODE in which a servo follows positions."""
JOINTS_PER_GROUP = 4
"""How many joints a `References` message speaks of."""
TORQUE_OFF = b"\0"
"""Value of TORQUE_ENABLE."""


@dataclass
class Servo:
    """What is known of a servo."""

    torque_per_current: float
    """0 for models that are not known [N m/A]."""
    state: NodeState = NodeState.READY
    zero: float = 0.0
    """Its position where the joint's angle is 0 [rad]."""
    referred_at: float = -math.inf
    """When its last reference came [s]."""
    error: int = 0
    """Its HARDWARE_ERROR."""
    is_stopped: bool = False
    """By an emergency stop."""
    position: float = 0.0
    """[rad]."""
    voltage: float = 0.0
    """[V]."""
    temperature: float = 0.0
    """[degC]."""
    n_beats: int = 0
    """How many heartbeats were sent for it."""


class PortSettings(NamedTuple):
    """What the address says."""

    port: str
    baud_rate: int
    """0 if it is none."""


def parse_address(address: str) -> PortSettings:
    """Return what an address says.

    Args:
        address: PORT or PORT:BAUD_RATE.
    """
    port, _, rate = address.partition(":")
    if not rate:
        return PortSettings(port, BAUD_RATE)
    if not (rate.isascii() and rate.isdigit()):
        return PortSettings(port, 0)
    return PortSettings(port, int(rate))


class Dynamixel(Bus):
    """Servos of the X series with the numbers 1, 2, ... from the tail on; the address is PORT or PORT:BAUD_RATE."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._orders: deque[CanMessage] = deque()
        self._pending: dict[int, float] = {}  # references that no Sync followed yet
        self._references: deque[dict[int, float]] = deque(maxlen=1)
        self._wake = threading.Event()
        self._reader = Reader()
        self._beat_due = 0.0
        serial = hardware("pyserial", "serial")
        settings = parse_address(address)
        try:
            self._port: Any = serial.Serial(
                settings.port, settings.baud_rate, timeout=0.001, write_timeout=1.0
            )
        except (OSError, ValueError) as error:
            raise DeviceFailed(f"The servos' port {address} cannot be opened: {error}.") from error
        try:
            self._servos = self._find_servos()
            self._write(BROADCAST, Register.TORQUE_ENABLE, TORQUE_OFF)
            self._arm_watchdogs()
        except OSError:
            self.release()
            raise
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        super().check(address)
        if parse_address(address).baud_rate <= 0:
            raise BadArgument("address", f"must be PORT or PORT:BAUD_RATE, got {address!r}")

    def _find_servos(self) -> dict[int, Servo]:
        """Return all servos that answer a ping, by their numbers."""
        answers = self._ping_all()
        numbers = sorted(answers)
        if not numbers:
            raise DeviceFailed(
                f"No servo answers at {self._address}: check power and cable, and that the baud rate is this."
            )
        if numbers != list(range(1, len(numbers) + 1)):
            raise DeviceFailed(
                f"The servos must be numbered 1, 2, ... from the tail on, got {numbers}."
            )
        modes = self._read(Register.OPERATING_MODE, 1, numbers)
        wrong = [number for number, mode in modes.items() if mode[0] not in POSITION_MODES]
        if wrong:
            raise DeviceFailed(
                f"Servos {wrong} must be in a position-control mode, {POSITION_MODES}."
            )
        servos = dict[int, Servo]()
        for number in numbers:
            (model,) = struct.unpack_from("<H", answers[number])
            servos[number] = Servo(torque_per_current=TORQUE.get(model, 0.0))
        return servos

    # ---- what the loop calls ---------------------------------------------------------------------

    @property
    def bus_off(self) -> str:
        """See `Bus`."""
        return self.trouble

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
        self._wake.set()
        return tuple(frames)

    # ---- what the thread does --------------------------------------------------------------------

    def work(self) -> None:
        """One cycle: orders, references, what the servos measure; ten times a second, how they are."""
        self._wake.wait(IDLE)
        self._wake.clear()
        now = self._clock.now()
        while self._orders:
            self._obey(self._orders.popleft(), now)
        references = dict[int, float]()
        if self._references:
            references = self._references.popleft()
        self._follow(references, now)
        self._measure()
        if now >= self._beat_due:
            self._beat_due = now + BEAT
            self._beat()

    def _follow(self, references: Mapping[int, float], now: float) -> None:
        """Move all servos to their references [rad]; those without one hold, and are limp later."""
        goals: dict[int, bytes] = {}
        for number, servo in self._servos.items():
            if not servo.state.is_on:
                continue
            if number in references:
                servo.state = NodeState.ACTIVE
                servo.referred_at = now
                steps = packets.steps_of_angle(references[number] + servo.zero)
                goals[number] = struct.pack("<i", steps)
            elif now - servo.referred_at > LIMP_AFTER:
                self._switch_off(number, NodeState.LIMP)
            elif now - servo.referred_at > HOLD_AFTER:
                servo.state = NodeState.HOLD
        if goals:
            self._sync_write(Register.GOAL_POSITION, goals)

    def _obey(self, message: CanMessage, now: float) -> None:
        """Do what an order says."""
        if isinstance(message, EmergencyStop):
            self._write(BROADCAST, Register.TORQUE_ENABLE, TORQUE_OFF)
            for servo in self._servos.values():
                servo.state = NodeState.FAULT
                servo.is_stopped = True
        if not isinstance(message, NodeCommand):
            return
        for number, servo in self._servos.items():
            if message.node not in (EVERY_NODE, number):
                continue
            if message.order == Order.CLEAR:
                self._clear(number, servo)
            elif servo.state == NodeState.FAULT:
                continue
            elif message.order == Order.ENABLE and not servo.state.is_on:
                self._switch_on(number, now)
            elif message.order == Order.DISABLE:
                self._switch_off(number, NodeState.READY)
            elif message.order == Order.SET_ZERO and not servo.state.is_on:
                servo.zero = servo.position - message.angle

    def _switch_on(self, number: int, now: float) -> None:
        """Let a servo hold the joint where it stands."""
        servo = self._servos[number]
        steps = packets.steps_of_angle(servo.position)
        self._write(number, Register.GOAL_POSITION, struct.pack("<i", steps))
        self._write(number, Register.TORQUE_ENABLE, b"\1")
        servo.referred_at = now
        servo.state = NodeState.ACTIVE

    def _switch_off(self, number: int, state: NodeState) -> None:
        self._write(number, Register.TORQUE_ENABLE, TORQUE_OFF)
        self._servos[number].state = state

    def _clear(self, number: int, servo: Servo) -> None:
        """Forget faults whose cause is gone; an error of the hardware goes by a reboot alone."""
        servo.is_stopped = False
        if servo.error:
            self._request(Packet(number, Instruction.REBOOT, b""), {number})
        if servo.state == NodeState.FAULT:
            servo.state = NodeState.READY
        self._arm_watchdogs()

    def _arm_watchdogs(self) -> None:
        """Let the servos stop by themselves if nobody speaks to them; 0 forgets that they did."""
        for value in (0, WATCHDOG):
            self._write(BROADCAST, Register.BUS_WATCHDOG, bytes([value]))

    def _measure(self) -> None:
        """Report what all servos measure; of one that does not answer, nothing."""
        answers = self._read(Register.PRESENT_CURRENT, packets.MEASURED.size, self._servos)
        now = self._clock.now()
        for number, data in answers.items():
            servo = self._servos[number]
            current, rate, position, voltage, temperature = packets.MEASURED.unpack(data)
            servo.position = packets.angle_of_steps(position)
            servo.voltage = voltage * packets.VOLTAGE
            servo.temperature = float(temperature)
            amperes = current * packets.CURRENT
            state = JointState(
                node=number,
                angle=servo.position - servo.zero,
                rate=rate * packets.VELOCITY,
                current=abs(amperes),
                torque=amperes * servo.torque_per_current,
            )
            self._report(now, state)

    def _beat(self) -> None:
        """Report how every servo is."""
        first, last = Register.TORQUE_ENABLE, Register.BUS_WATCHDOG
        answers = self._read(first, last - first + 1, self._servos)
        for number, data in answers.items():
            servo = self._servos[number]
            servo.error = data[Register.HARDWARE_ERROR - first]
            is_lost = data[last - first] == packets.TRIPPED
            if servo.error or servo.is_stopped:
                servo.state = NodeState.FAULT
            elif is_lost:
                self._switch_off(number, NodeState.LIMP)
                self._arm_watchdogs()
            heartbeat = Heartbeat(
                node=number,
                state=servo.state,
                over_temperature=bool(servo.error & packets.OVERHEATING),
                over_current=bool(servo.error & packets.OVERLOAD),
                references_lost=is_lost,
                emergency_stopped=servo.is_stopped,
                temperature=servo.temperature,
                voltage=servo.voltage,
                counter=servo.n_beats % 256,
            )
            servo.n_beats += 1
            self._report(self._clock.now(), heartbeat)

    def _report(self, now: float, message: CanMessage) -> None:
        self._received.append(Frame(now, *encode(message), is_ours=False, message=message))

    def release(self) -> None:
        """Switch all torque off, and close the port."""
        try:
            self._write(BROADCAST, Register.TORQUE_ENABLE, TORQUE_OFF)
            self._port.flush()
        except OSError:
            pass  # the port is gone
        self._port.close()

    # ---- the line --------------------------------------------------------------------------------

    def _write(self, number: int, register: int, data: bytes) -> None:
        packet = Packet(number, Instruction.WRITE, struct.pack("<H", register) + data)
        answering = set[int]()
        if number != BROADCAST:
            answering.add(number)
        self._request(packet, answering)

    def _sync_write(self, register: int, values: Mapping[int, bytes]) -> None:
        size = len(next(iter(values.values())))
        data = struct.pack("<HH", register, size)
        for number, value in values.items():
            data += bytes([number]) + value
        self._send_packet(Packet(BROADCAST, Instruction.SYNC_WRITE, data))

    def _read(self, register: int, size: int, numbers: Iterable[int]) -> dict[int, bytes]:
        """Return the same registers of several servos; those that do not answer are missing."""
        data = struct.pack("<HH", register, size) + bytes(numbers)
        answers = self._request(Packet(BROADCAST, Instruction.SYNC_READ, data), set(numbers))
        return {number: data for number, data in answers.items() if len(data) == size}

    def _request(self, packet: Packet, answering: set[int]) -> dict[int, bytes]:
        """Send a packet, and return the data without errors that servos answer, once all of these did."""
        self._send_packet(packet)
        answers: dict[int, bytes] = {}
        end = time.monotonic() + ANSWER_TIME
        while not answering <= answers.keys() and time.monotonic() < end:
            answers |= self._read_answers()
        return answers

    def _ping_all(self) -> dict[int, bytes]:
        """Return the data that servos answer to a ping."""
        self._send_packet(Packet(BROADCAST, Instruction.PING, b""))
        answers: dict[int, bytes] = {}
        end = time.monotonic() + PING_TIME
        while time.monotonic() < end:
            more = self._read_answers()
            answers |= more
            if more:
                end = min(end, time.monotonic() + SILENCE)
        return answers

    def _send_packet(self, packet: Packet) -> None:
        """Send a packet; what the servos said before is no answer to it."""
        if self._port.in_waiting:
            self._port.reset_input_buffer()
        self._port.write(packets.encode_packet(packet))

    def _read_answers(self) -> dict[int, bytes]:
        """Return the data of the answers that are complete by now."""
        answers: dict[int, bytes] = {}
        for packet in self._reader.feed(self._port.read(max(self._port.in_waiting, 1))):
            if packet.instruction == Instruction.STATUS and packet.data:
                answers[packet.number] = packet.data[1:]
        return answers
