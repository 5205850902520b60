"""The virtual tank without wires: modules, cameras and meter around one body, in steps, all from one seed.

Nothing here waits or runs by itself: the user of a `Tank` advances time, passes in received frames,
and takes out the frames to send. A campaign therefore runs as fast as it can, and the same calls
give the same answers.
"""

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from laticauda.scenarios import Start
from laticauda.tank.lab import instruments, nodes, quiet
from laticauda.tank.lab.faults import KINDS, Fault, Faults, fault_from_words
from laticauda.tank.lab.sensor_server import MeasuredReading
from laticauda.tank.lab.settings import LabSettings
from laticauda.tank.lab.virtual_robot import Truth, VirtualRobot
from laticauda.tank.protocol import N_NODES, CanMessage, MocapFrame, Sync, decode, encode, from_node
from laticauda.values import BadArgument

SHORTEST_STEP = 1e-4
"""Time that is worth a step of the plant, at least [s]."""
Wire = tuple[int, bytes]
"""A frame as the bus carries it: identifier and data."""


class Tank:
    """The tank with its robot.

    Args:
        body: The robot in the water.
        settings: Settings of the devices.
        faults: Faults that are to occur, with their times.

    Raises:
        ValueError: If the robot has more joints than the bus has nodes.
    """

    def __init__(
        self, body: VirtualRobot, settings: LabSettings | None = None, faults: Iterable[Fault] = ()
    ) -> None:
        joints = body.robot.driven_joints
        if not 1 <= len(joints) <= N_NODES:
            raise BadArgument(
                "robot",
                f"must have 1 to {N_NODES} joints, a driven fin's included, got {len(joints)}",
            )
        self.settings = settings or LabSettings()
        self.body = body
        self.faults = Faults()
        self._plant_without_faults = body.plant
        for fault in faults:
            self.inject(fault)
        streams = np.random.SeedSequence(self.settings.seed).spawn(5)
        motors, cameras, supply, self._wire, forces = map(np.random.default_rng, streams)
        self.electronics = instruments.Electronics(
            body.robot, self.settings, motors, body.plant.settings.joints
        )
        self.force_sensors = instruments.ForceSensors(self.settings.nodes, len(joints), forces)
        self.cameras = instruments.Cameras(self.settings.mocap, cameras)
        self.meter = instruments.Multimeter(self.settings.supply, supply)
        self.nodes = [
            nodes.Node(i + 1, self.settings.nodes, joint.limit) for i, joint in enumerate(joints)
        ]
        self.time = 0.0
        self._ticks = self._frames = 0
        self._leaks = np.zeros(len(joints), dtype=bool)
        self._jammed: dict[int, float] = {}
        self._altering: tuple[Fault, ...] = ()
        self._slipped = np.zeros(len(joints))
        self._mistakes = quiet.CameraErrors(self.cameras, self._wire)
        self._silent = [False] * len(joints)  # off the bus, or without power
        self._dead = [False] * len(joints)
        self._senses = self._read()
        self._outbox: list[Wire] = []
        self._captured: list[MocapFrame] = []
        self._sensed: list[MeasuredReading] = []
        self._late: list[tuple[float, Wire]] = []

    @property
    def truth(self) -> Truth:
        """True state of the robot now."""
        return self.body.truth

    def inject(self, fault: Fault) -> None:
        """Let a `fault` happen; one in the past has no effect.

        Args:
            fault: Fault, with its place and time.

        Raises:
            ValueError: If it cannot happen to this robot in this environment.
        """
        quiet.check(fault, self._plant_without_faults)
        self.faults.add(fault)

    def carry(self, start: Start) -> None:
        """Take the robot out, straighten it, and put it back at rest at `start`.

        Args:
            start: Place and heading at which it is put.
        """
        self.body.carry(start)
        self.electronics.forget(self.truth)
        self._senses = self._read()

    def sent(self) -> list[Wire]:
        """Take out the frames that the nodes sent since the last call."""
        sent = self._outbox
        self._outbox = []
        return sent

    def captured(self) -> list[MocapFrame]:
        """Take out the frames that the cameras captured since the last call."""
        captured = self._captured
        self._captured = []
        return captured

    def sensed(self) -> list[MeasuredReading]:
        """Take out the readings of the robot's own sensors that arrived since the last call."""
        sensed = self._sensed
        self._sensed = []
        return sensed

    def answer(self, line: str) -> bytes:
        """Return the meter's answer to `line`; nothing while it is silent.

        Args:
            line: Query, without the end of the line.
        """
        if self.faults.on("meter_silent"):
            return b""
        return self.meter.answer(line)

    @property
    def next_tick(self) -> float:
        """Time at which the devices next look at the world [s]."""
        return (self._ticks + 1) * self.settings.step

    def advance(self, dt: float) -> None:
        """Advance time by `dt` [s].

        Args:
            dt: Time step [s].
        """
        self.advance_to(self.time + dt)

    def advance_to(self, time: float) -> None:
        """Advance to a time.

        Args:
            time: Time to advance to; nothing happens if it is in the past [s].

        Raises:
            SimulationFailed: If the body's motion diverges.
        """
        while self.next_tick <= time + 1e-9:
            self._deliver_late(self.next_tick)
            self._march(self.next_tick)
            self._ticks += 1
            self._tick()
        if time - self.time >= SHORTEST_STEP:
            self._march(time)

    def receive(self, identifier: int, data: bytes, time: float | None = None) -> None:
        """Receive a frame from the bus; those of our own nodes, which a bus may return, are ignored.

        Args:
            identifier: Identifier of the frame.
            data: Bytes of the frame, which may be anything.
            time: Time of arrival; None: now [s].
        """
        if from_node(identifier):
            return
        late = self.faults.on("late_computer")
        if late is not None:
            arrival = max(self.time, time or 0.0) + late.delay
            self._late.append((arrival, (identifier, bytes(data))))
            return
        self._deliver(identifier, bytes(data), time)

    def _deliver(self, identifier: int, data: bytes, time: float | None) -> None:
        message = decode(identifier, data)
        if isinstance(message, Sync):  # all others can wait for their moment
            if time is not None:
                self.advance_to(time)
            self._senses = self._read()
        for i, node in enumerate(self.nodes):
            if self._silent[i]:
                continue
            received = message
            if self.faults.present:
                if self._is_hit("frame_loss", node.number):
                    continue
                if self._is_hit("frame_corruption", node.number):  # this node hears something else
                    received = decode(identifier, self._wire.bytes(len(data)))
            if received is not None:
                self._transmit(node, node.receive(received, self.time, self._senses[i]))

    def _deliver_late(self, time: float) -> None:
        """Deliver the frames of a late computer whose time has come."""
        due = [wire for arrival, wire in self._late if arrival <= time]
        self._late = [(arrival, wire) for arrival, wire in self._late if arrival > time]
        for identifier, data in due:
            self._deliver(identifier, data, None)

    def _transmit(self, node: nodes.Node, messages: Iterable[CanMessage]) -> None:
        for message in messages:
            wire = encode(message)
            if self.faults.present:
                if self._silent[node.number - 1] or self._is_hit("frame_loss", node.number):
                    continue
                if self._is_hit("frame_corruption", node.number):
                    identifier, data = wire
                    wire = (identifier, self._wire.bytes(len(data)))
            self._outbox.append(wire)

    def _march(self, time: float) -> None:
        """Advance the body to `time`."""
        dt = time - self.time
        n = len(self.nodes)
        reference = np.fromiter((node.reference for node in self.nodes), float, n)
        zero = np.fromiter((node.zero for node in self.nodes), float, n)
        on = np.fromiter(
            (node.is_on and not dead for node, dead in zip(self.nodes, self._dead, strict=True)),
            bool,
            n,
        )
        reference = reference - self.electronics.offset(zero)
        joint_reference = reference.copy()
        jammed = np.zeros(n, dtype=bool)
        for i, angle in self._jammed.items():  # a jammed joint is held where it stands
            joint_reference[i] = angle
            jammed[i] = True
        self.body.advance(joint_reference, on, dt, jammed=jammed)
        self.time = time
        self.electronics.advance(self.truth, reference, on, jammed, dt)
        self.meter.advance(self.electronics.supply_current, dt)

    def _tick(self) -> None:
        """Let all devices read the body."""
        self.faults.look(self.time)
        self._apply_faults()
        self.electronics.accelerate(self.truth, self.settings.step)
        self._senses = self._read()
        for i, node in enumerate(self.nodes):
            if not self._dead[i]:
                if node.is_sensing(self.time):
                    self._senses[i].force = self.force_sensors.read(self.body.joint_force, i)
                self._transmit(node, node.tick(self.time, self._senses[i]))
        if self.time * self.settings.mocap.rate >= self._frames + 1 - 1e-6:
            self._frames = math.floor(self.time * self.settings.mocap.rate + 1e-6)
            hidden = self.faults.on("body_lost") is not None
            frame = self.cameras.look(self.truth.modules, self.time, hidden=hidden)
            if frame is not None and not self.faults.on("mocap_silent"):
                self._captured.append(self._mistakes.instead(frame, self.faults, self.time))
        for name, reading in self.body.read_sensors().items():
            if reading.is_new:
                values = tuple(map(float, reading.values))
                self._sensed.append(MeasuredReading(name, reading.time, values))

    def _apply_faults(self) -> None:
        """Apply the present faults to the modules, to the whole robot, and to the water."""
        faults = self.faults
        altering = tuple(fault for fault in faults.present if fault.kind in quiet.OF_PLANT)
        if altering != self._altering:
            self._altering = altering
            self.body.plant = quiet.plant_with_faults(self.body, self._plant_without_faults, faults)
        for i, node in enumerate(self.nodes):
            self._apply_power_and_bus(i, node)
            self._apply_slip(i, node)
            self._leaks[i] = faults.on("leak", node.number) is not None
            hot = faults.on("over_temperature", node.number)
            if hot is not None:
                temperature = self.electronics.temperature[i]
                self.electronics.temperature[i] = max(temperature, hot.temperature)
            if faults.on("stuck_servo", node.number) is None:
                self._jammed.pop(i, None)
            else:
                self._jammed.setdefault(i, float(self.truth.joint_angle[i]))

    def _apply_power_and_bus(self, i: int, node: nodes.Node) -> None:
        """Cut a module's power or its bus, and start it anew when power comes back."""
        is_dead = self.faults.on("dead_module", node.number) is not None
        if self._dead[i] and not is_dead:
            node.power_on(self.time)
        is_off_bus = self.faults.on("bus_off", node.number) is not None
        if is_off_bus:
            node.error_count = 255
        elif node.error_count:
            node.error_count = 0
            node.flags.add("bus_errors")
        self._dead[i] = is_dead
        self._silent[i] = is_dead or is_off_bus

    def _apply_slip(self, i: int, node: nodes.Node) -> None:
        """Let a horn slip on its shaft: its sensor's zero moves toward the angle of the fault."""
        slip = self.faults.on("slipped_zero", node.number)
        step = 0.0
        if slip is not None:
            share = -math.expm1(-self.settings.step / quiet.SLIP_TIME)
            step = share * (slip.angle - self._slipped[i])
        self._slipped[i] += step
        self.electronics.zero_error[i] -= step
        self.electronics.slip_rate[i] = -step / self.settings.step

    def _read(self) -> list[nodes.Senses]:
        return self.electronics.read(self.truth, self._leaks)

    def _is_hit(self, kind: str, number: int) -> bool:
        fault = self.faults.on(kind, number)
        return fault is not None and self._wire.random() < fault.share


HELP = Path(__file__).with_name("help.txt").read_text().strip().format(kinds=", ".join(KINDS))


def assist(tank: Tank, line: str) -> str:
    """Execute the command in a line, and return what was done.

    Args:
        tank: Tank in which it is done.
        line: Command, in the words of `HELP`.

    Raises:
        ValueError: If the command cannot be executed.
    """
    command, *arguments = line.split() or ["help"]
    if command == "help":
        return HELP
    if command == "clear":
        tank.faults.clear()
        return "no faults"
    if command == "carry":
        return _carry(tank, arguments)
    if command == "truth":
        return _describe_truth(tank)
    fault = fault_from_words(line, tank.time)
    tank.inject(fault)
    location = f" at node {fault.node}" if fault.node else ""
    return f"{fault.kind}{location}: {KINDS[fault.kind]}"


def _describe_truth(tank: Tank) -> str:
    truth = tank.truth
    x, y, z = truth.center_of_mass.tolist()
    heading = math.degrees(truth.heading)
    return (
        f"time {tank.time:.2f} s, center of mass {x:.4f} {y:.4f} {z:.4f} m, "
        f"heading {heading:.2f} deg"
    )


def _carry(tank: Tank, arguments: list[str]) -> str:
    try:
        numbers = [float(argument) for argument in arguments]
        x, y, heading, *depths = numbers
    except ValueError:
        text = " ".join(arguments)
        raise BadArgument(
            "carry",
            "must have three numbers, x y [m] and heading [deg], and in space a depth [m], "
            f"got {text!r}",
        ) from None
    depth = depths[0] if depths else None
    tank.carry(Start(center_of_mass=(x, y), heading=math.radians(heading), depth=depth))
    text = f"the robot lies straight at {x:g} {y:g} m, heading {heading:g} deg"
    if depth is not None:
        text += f" depth {depth:g} m"
    return text
