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
from typing import Any

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
ANSWER_TIME = 0.15  # for the answers to a packet [s, wall clock]
PING_TIME, SILENCE = 2.0, 0.3  # for answers to a ping, and after the last of them [s, wall clock]
IDLE = 0.05  # the longest between two cycles [s, wall clock]
BEAT = 0.1  # [s]
HOLD_AFTER, LIMP_AFTER = 0.2, 1.2  # without references [s]
WATCHDOG = 25  # of the servos, 0.5 s
TORQUE = {
    1020: 1.78,
    1030: 1.30,
    1120: 2.41,
    1130: 1.66,
}  # XM430-W350, -W210, XM540-W270, -W150 [N m/A]
POSITION_MODES = (3, 5)
PER_GROUP = 4


@dataclass
class Servo:
    """What is known of one of them."""

    torque: float
    """Per current; 0 for models that are not known [N m/A]."""
    state: NodeState = NodeState.READY
    zero: float = 0.0
    """What its position means more than the joint's angle [rad]."""
    referred: float = -math.inf
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
    beats: int = 0
    """How many heartbeats were sent for it."""


class Dynamixel(Bus):
    """Servos of the X series with the numbers 1, 2, ... from the tail on; the address is PORT or PORT:BAUD_RATE."""

    def __init__(self, address: str, clock: Clock) -> None:
        super().__init__(address, clock)
        self._orders: deque[CanMessage] = deque()
        self._pending: dict[int, float] = {}  # references that no Sync followed yet
        self._asked: deque[dict[int, float]] = deque(maxlen=1)
        self._wake = threading.Event()
        self._reader, self._beat_due = Reader(), 0.0
        port, baud_rate = self._parts(address)
        try:
            self._port: Any = hardware("pyserial", "serial").Serial(
                port, baud_rate, timeout=0.001, write_timeout=1.0
            )
        except (OSError, ValueError) as error:
            raise DeviceFailed(f"The servos' port {address} cannot be opened: {error}.") from error
        try:
            self._servos = self._found_servos()
            self._write(BROADCAST, Register.TORQUE_ENABLE, b"\0")
            self._arm()
        except OSError:
            self.release()
            raise
        self._start()

    @classmethod
    def check(cls, address: str) -> None:
        """See `laticauda.tank.operate.drivers.base.Driver.check`."""
        super().check(address)
        if cls._parts(address)[1] <= 0:
            raise BadArgument("address", f"must be PORT or PORT:BAUD_RATE, got {address!r}")

    @staticmethod
    def _parts(address: str) -> tuple[str, int]:
        port, _, rate = address.partition(":")
        return port, BAUD_RATE if not rate else int(
            rate
        ) if rate.isascii() and rate.isdigit() else 0

    def _found_servos(self) -> dict[int, Servo]:
        """Who answers a ping to all."""
        answers = self._asked_for(Packet(BROADCAST, Instruction.PING, b""), None, PING_TIME)
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
        if wrong := [number for number, mode in modes.items() if mode[0] not in POSITION_MODES]:
            raise DeviceFailed(
                f"Servos {wrong} must be in a position-control mode, {POSITION_MODES}."
            )
        models = {number: struct.unpack_from("<H", answers[number])[0] for number in numbers}
        return {number: Servo(torque=TORQUE.get(models[number], 0.0)) for number in numbers}

    # ---- what the loop calls ---------------------------------------------------------------------

    @property
    def bus_off(self) -> str:
        """See `Bus`."""
        return self.trouble

    def send(self, messages: Iterable[CanMessage]) -> tuple[Frame, ...]:
        """See `Bus`; the thread does what they say. Frames are recorded as the CAN bus would have them."""
        found: list[Frame] = []
        for message in messages:
            if isinstance(message, References):
                first = PER_GROUP * message.group + 1
                self._pending |= dict(enumerate(message.angles, first))
            elif isinstance(message, Sync):
                self._asked.append(self._pending)
                self._pending = {}
            else:
                self._orders.append(message)
            found.append(Frame(self._clock.now(), *encode(message), is_ours=True, message=message))
        self._wake.set()
        return tuple(found)

    # ---- what the thread does --------------------------------------------------------------------

    def work(self) -> None:
        """One cycle: orders, references, what the servos measure; ten times a second, how they are."""
        self._wake.wait(IDLE)
        self._wake.clear()
        now = self._clock.now()
        while self._orders:
            self._obey(self._orders.popleft(), now)
        asked = self._asked.popleft() if self._asked else {}
        goals: dict[int, bytes] = {}
        for number, servo in self._servos.items():
            if number in asked and servo.state.is_on:
                servo.state, servo.referred = NodeState.ACTIVE, now
                steps = (
                    round((asked[number] + servo.zero) * packets.TURN / (2.0 * math.pi))
                    + packets.MIDDLE
                )
                goals[number] = struct.pack("<i", steps)
            elif servo.state.is_on and now - servo.referred > LIMP_AFTER:
                self._switch(number, False, NodeState.LIMP)
            elif servo.state.is_on and now - servo.referred > HOLD_AFTER:
                servo.state = NodeState.HOLD
        if goals:
            self._sync_write(Register.GOAL_POSITION, goals)
        self._measure()
        if now >= self._beat_due:
            self._beat_due = now + BEAT
            self._beat()

    def _obey(self, message: CanMessage, now: float) -> None:
        """Do what an order says."""
        if isinstance(message, EmergencyStop):
            self._write(BROADCAST, Register.TORQUE_ENABLE, b"\0")
            for servo in self._servos.values():
                servo.state, servo.is_stopped = NodeState.FAULT, True
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
                servo.referred = now
                self._switch(number, True, NodeState.ACTIVE)
            elif message.order == Order.DISABLE:
                self._switch(number, False, NodeState.READY)
            elif message.order == Order.SET_ZERO and not servo.state.is_on:
                servo.zero = servo.position - message.angle

    def _switch(self, number: int, on: bool, state: NodeState) -> None:
        """Torque on, from where the joint stands, or off."""
        if on:
            steps = (
                round(self._servos[number].position * packets.TURN / (2.0 * math.pi))
                + packets.MIDDLE
            )
            self._write(number, Register.GOAL_POSITION, struct.pack("<i", steps))
        self._write(number, Register.TORQUE_ENABLE, bytes([on]))
        self._servos[number].state = state

    def _clear(self, number: int, servo: Servo) -> None:
        """Forget faults whose cause is gone; an error of the hardware goes by a reboot alone."""
        servo.is_stopped = False
        if servo.error:
            self._asked_for(Packet(number, Instruction.REBOOT, b""), {number})
        if servo.state == NodeState.FAULT:
            servo.state = NodeState.READY
        self._arm()

    def _arm(self) -> None:
        """The servos stop by themselves if nobody speaks to them; 0 forgets that it was so."""
        for value in (0, WATCHDOG):
            self._write(BROADCAST, Register.BUS_WATCHDOG, bytes([value]))

    def _measure(self) -> None:
        """What all servos measure; one that does not answer is not heard."""
        read = self._read(Register.PRESENT_CURRENT, packets.MEASURED.size, self._servos)
        now = self._clock.now()
        for number, data in read.items():
            servo = self._servos[number]
            current, rate, position, voltage, temperature = packets.MEASURED.unpack(data)
            servo.position = (position - packets.MIDDLE) * 2.0 * math.pi / packets.TURN
            servo.voltage, servo.temperature = voltage * packets.VOLTAGE, float(temperature)
            amperes = current * packets.CURRENT
            self._say(
                now,
                JointState(
                    node=number,
                    angle=servo.position - servo.zero,
                    rate=rate * packets.VELOCITY,
                    current=abs(amperes),
                    torque=amperes * servo.torque,
                ),
            )

    def _beat(self) -> None:
        """How every servo is."""
        first, last = Register.TORQUE_ENABLE, Register.BUS_WATCHDOG
        for number, data in self._read(first, last - first + 1, self._servos).items():
            servo = self._servos[number]
            servo.error = data[Register.HARDWARE_ERROR - first]
            is_lost = data[last - first] == packets.TRIPPED
            if servo.error or servo.is_stopped:
                servo.state = NodeState.FAULT
            elif is_lost:
                self._switch(number, False, NodeState.LIMP)
                self._arm()
            beat = Heartbeat(
                node=number,
                state=servo.state,
                over_temperature=bool(servo.error & packets.OVERHEATING),
                over_current=bool(servo.error & packets.OVERLOAD),
                references_lost=is_lost,
                emergency_stopped=servo.is_stopped,
                temperature=servo.temperature,
                voltage=servo.voltage,
                counter=servo.beats % 256,
            )
            servo.beats += 1
            self._say(self._clock.now(), beat)

    def _say(self, now: float, message: CanMessage) -> None:
        self._received.append(Frame(now, *encode(message), is_ours=False, message=message))

    def release(self) -> None:
        """Switch all torque off, and close the port."""
        try:
            self._write(BROADCAST, Register.TORQUE_ENABLE, b"\0")
            self._port.flush()
        except OSError:
            pass  # the port is gone
        self._port.close()

    # ---- the line --------------------------------------------------------------------------------

    def _write(self, number: int, register: int, data: bytes) -> None:
        packet = Packet(number, Instruction.WRITE, struct.pack("<H", register) + data)
        self._asked_for(packet, set() if number == BROADCAST else {number})

    def _sync_write(self, register: int, data: Mapping[int, bytes]) -> None:
        parts = b"".join(bytes([number]) + one for number, one in data.items())
        size = len(next(iter(data.values())))
        self._asked_for(
            Packet(BROADCAST, Instruction.SYNC_WRITE, struct.pack("<HH", register, size) + parts),
            set(),
        )

    def _read(self, register: int, size: int, numbers: Iterable[int]) -> dict[int, bytes]:
        """The same registers of several servos; those that do not answer are missing."""
        words = struct.pack("<HH", register, size) + bytes(numbers)
        found = self._asked_for(Packet(BROADCAST, Instruction.SYNC_READ, words), set(numbers))
        return {number: data for number, data in found.items() if len(data) == size}

    def _asked_for(
        self, packet: Packet, who: set[int] | None, patience: float = 0.0
    ) -> dict[int, bytes]:
        """Send a packet, and wait for the answers of these servos, or of any (None): data without errors."""
        if self._port.in_waiting:
            self._port.reset_input_buffer()
        self._port.write(packets.encoded(packet))
        found: dict[int, bytes] = {}
        end = time.monotonic() + (patience or ANSWER_TIME)
        while (who is None or not who <= found.keys()) and time.monotonic() < end:
            for answer in self._reader.feed(self._port.read(max(self._port.in_waiting, 1))):
                if answer.instruction == Instruction.STATUS and answer.data:
                    found[answer.number] = answer.data[1:]
                    end = min(end, time.monotonic() + SILENCE) if who is None else end
        return found
