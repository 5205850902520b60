"""The firmware of one joint module: its states, its answers on the bus, and what its motor does.

The servo itself (`actuation.Servo` or `SpeedServo`) controls the joint; the node sets its
reference, switches its motor on and off, and monitors it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from laticauda.tank.lab.settings import NodeSettings
from laticauda.tank.protocol import EVERY_NODE, FAULTS, NodeState, Order, Result, messages

SETTLED = (NodeState.READY, NodeState.LIMP)
"""States in which a motor is off and a zero may be set."""
STUCK_SMOOTHING = 0.05
"""Time over which the angle is smoothed, so that sensor noise does not count as travel; an assumption [s]."""


@dataclass(kw_only=True)
class Senses:
    """Readings of a node's sensors at one moment."""

    angle: float = 0.0
    """Angle of the joint, from a sensor whose zero is not known [rad]."""
    rate: float = 0.0
    """Rate of the joint [rad/s]."""
    current: float = 0.0
    """Current of the motor [A]."""
    duty: float = 0.0
    """Duty of the motor [-]."""
    torque: float = 0.0
    """Torque of the motor at the joint, from its current [N m]."""
    load: float = 0.0
    """Torque from the force/torque sensor [N m]."""
    force: tuple[float, float, float] | None = None
    """Force from the force/torque sensor: along, left, up; None if it provides none [N]."""
    acceleration: Sequence[float] = (0.0, 0.0, 0.0)
    """Acceleration from the accelerometer [m/s^2]."""
    temperature: float = 20.0
    """Temperature of the motor [deg C]."""
    voltage: float = 35.0
    """Voltage of the supply [V]."""
    leak: bool = False
    """Whether there is water inside [-]."""


class Node:
    """One module's microcontroller.

    Args:
        number: Number of the node, 1 to 19.
        settings: Its times and limits.
        limit: Largest angle of the joint to either side [rad].
    """

    def __init__(self, number: int, settings: NodeSettings, limit: float) -> None:
        self.number = number
        self.settings = settings
        self.limit = limit
        self.power_on(0.0)

    def power_on(self, now: float) -> None:
        """Restart: all memory except that of the program is lost."""
        self.state = NodeState.STARTUP
        self.flags: set[str] = {"not_calibrated"}
        self.zero = 0.0
        self.reference = self.target = 0.0
        self.error_count = 0
        self._pending: float | None = None
        self._since = self._referred = self._ticked = now
        self._heartbeat_due = now
        # Spread over the interval, so that the nodes do not all need the bus at once.
        self._sensors_due = now + self.settings.sensor_interval * self.number / 18.0
        self._counter = 0
        self._current = self._stuck = 0.0
        self._angle = self._stood = math.nan

    @property
    def is_on(self) -> bool:
        """Whether the motor is on."""
        return self.state.is_on

    def is_sensing(self, now: float) -> bool:
        """Return whether the readings of the slow sensors, such as that of force and torque, are due.

        Args:
            now: Current time [s].
        """
        return now >= self._sensors_due - 1e-9 and self.state != NodeState.STARTUP

    def tick(self, now: float, senses: Senses) -> list[messages.CanMessage]:
        """Advance to the current time.

        Args:
            now: Current time [s].
            senses: Current readings of the sensors.

        Returns:
            Messages to send.
        """
        dt = now - self._ticked
        self._ticked = now
        state_before = self.state
        self._watch(dt, senses)
        self._live(now)
        self._follow(dt)
        sent: list[messages.CanMessage] = []
        if self.state != state_before or now >= self._heartbeat_due - 1e-9:
            sent.append(self._heartbeat(now, senses))
        if self.is_sensing(now):
            self._sensors_due = max(self._sensors_due + self.settings.sensor_interval, now)
            along, left, up = senses.acceleration
            sent.append(messages.Loads(node=self.number, force=senses.force, torque=senses.load))
            sent.append(messages.Acceleration(node=self.number, along=along, left=left, up=up))
        return sent

    def receive(
        self, message: messages.CanMessage, now: float, senses: Senses
    ) -> list[messages.CanMessage]:
        """Receive a message, and return the answers.

        Args:
            message: Message from any sender.
            now: Current time [s].
            senses: Current readings of the sensors.
        """
        if isinstance(message, messages.References):
            if message.group == (self.number - 1) // messages.REFERENCES_PER_FRAME:
                self._pending = message.angles[(self.number - 1) % messages.REFERENCES_PER_FRAME]
        elif isinstance(message, messages.Sync):
            return self._synchronize(now, senses)
        elif isinstance(message, messages.NodeCommand):
            if message.node in (EVERY_NODE, self.number):
                return [*self._obey(message, now, senses)]
        elif isinstance(message, messages.EmergencyStop):
            self.flags.add("emergency_stopped")
            state_before = self.state
            self._live(now)
            if self.state != state_before:
                return [self._heartbeat(now, senses)]
        return []

    def _synchronize(self, now: float, senses: Senses) -> list[messages.CanMessage]:
        if self._pending is not None:
            if self.is_on:
                self.target = min(max(self._pending, -self.limit), self.limit)
                self._referred = now
                if self.state == NodeState.HOLD:
                    self.flags.discard("references_lost")
                    self._enter(NodeState.ACTIVE, now)
            self._pending = None
        if self.state == NodeState.STARTUP:
            return []
        return [
            messages.JointState(
                node=self.number,
                angle=senses.angle + self.zero,
                rate=senses.rate,
                current=senses.current,
                torque=senses.torque,
            )
        ]

    def _obey(
        self, command: messages.NodeCommand, now: float, senses: Senses
    ) -> list[messages.CanMessage]:
        if self.state == NodeState.STARTUP:
            return []
        state_before = self.state
        is_done = self._do(command, now, senses)
        result = Result.DONE if is_done else Result.REFUSED
        reply = messages.CommandReply(
            node=self.number, order=command.order, result=result, state=self.state
        )
        if self.state == state_before:
            return [reply]
        return [reply, self._heartbeat(now, senses)]

    def _do(self, command: messages.NodeCommand, now: float, senses: Senses) -> bool:
        """Carry out an order, and return whether it was possible."""
        if command.order == Order.CLEAR:
            return self._clear(now, senses)
        if command.order == Order.SET_ZERO:
            if self.state not in SETTLED:
                return False
            self.zero = command.angle - senses.angle
            self.flags.discard("not_calibrated")
            return True
        if self.state in (NodeState.CALIBRATING, NodeState.FAULT):
            return False
        if command.order == Order.DISABLE:
            self._enter(NodeState.READY, now)
        elif not self.is_on:
            self.reference = self.target = senses.angle + self.zero
            self._referred = now
            self._pending = None
            self.flags.discard("references_lost")
            self._enter(NodeState.ACTIVE, now)
        return True

    def _clear(self, now: float, senses: Senses) -> bool:
        causes = {
            "leak": senses.leak,
            "over_temperature": senses.temperature > self.settings.temperature_again,
        }
        self.flags -= {name for name in (*FAULTS, "references_lost") if not causes.get(name, False)}
        self._current = self._stuck = 0.0
        if self.state == NodeState.FAULT and not self.flags & set(FAULTS):
            self._enter(NodeState.READY, now)
        return self.state != NodeState.FAULT

    def _watch(self, dt: float, senses: Senses) -> None:
        """Check for faults."""
        limits = self.settings
        if senses.leak:
            self.flags.add("leak")
        if senses.temperature > limits.temperature_limit:
            self.flags.add("over_temperature")
        self._current += (abs(senses.current) - self._current) * min(dt / limits.current_time, 1.0)
        if self._current > limits.current_limit:
            self.flags.add("over_current")
        if self._is_stuck(dt, senses):
            self.flags.add("stuck")

    def _is_stuck(self, dt: float, senses: Senses) -> bool:
        """Return whether the joint stays where it is, although the motor keeps pulling as hard as it can.

        Standing still says little: a servo loaded by the water stalls for seconds, and then moves
        on. The time of full pull therefore adds up until the joint has moved away from where it
        stood.
        """
        limits = self.settings
        if math.isnan(self._angle):
            self._angle = senses.angle
        else:
            share = min(dt / STUCK_SMOOTHING, 1.0)
            self._angle += share * (senses.angle - self._angle)
        if not self.is_on or not abs(self._angle - self._stood) <= limits.stuck_travel:
            self._stood = self._angle
            self._stuck = 0.0
        elif abs(senses.duty) >= limits.stuck_duty:
            self._stuck += dt
        return self._stuck > limits.stuck_time

    def _live(self, now: float) -> None:
        """Change the state as time and faults require."""
        limits = self.settings
        if self.state == NodeState.STARTUP:
            if now - self._since >= limits.startup_time:
                self._enter(NodeState.CALIBRATING, now)
            return
        if self.flags.intersection(FAULTS):
            if self.state != NodeState.FAULT:
                self._enter(NodeState.FAULT, now)
        elif self.state == NodeState.CALIBRATING:
            if now - self._since >= limits.calibration_time:
                self._enter(NodeState.READY, now)
        elif self.state == NodeState.ACTIVE and now - self._referred > limits.hold_after:
            self.flags.add("references_lost")
            self._enter(NodeState.HOLD, now)
        elif self.state == NodeState.HOLD and now - self._referred > limits.limp_after:
            self._enter(NodeState.LIMP, now)

    def _follow(self, dt: float) -> None:
        """Move the reference toward the target, no faster than allowed; a node that holds keeps its reference."""
        if self.state == NodeState.ACTIVE:
            largest_step = self.settings.speed_limit * dt
            step = self.target - self.reference
            self.reference += min(max(step, -largest_step), largest_step)

    def _enter(self, state: NodeState, now: float) -> None:
        self.state = state
        self._since = now

    def _heartbeat(self, now: float, senses: Senses) -> messages.Heartbeat:
        self._heartbeat_due = now + self.settings.heartbeat_interval
        self._counter = (self._counter + 1) % 256
        heartbeat = messages.Heartbeat(
            node=self.number,
            state=self.state,
            temperature=senses.temperature,
            voltage=senses.voltage,
            error_count=min(self.error_count, 255),
            counter=self._counter,
            **dict.fromkeys(self.flags, True),
        )
        self.flags.discard("bus_errors")
        return heartbeat
