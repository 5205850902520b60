"""Instruments, from the robot's true state to readings: cameras, the meter in the supply cable, the modules."""

import math
from statistics import fmean

import numpy as np
from jaxtyping import Bool, Float

from laticauda.motion.joints import Drive, Servo
from laticauda.robot import ModulePoses, Robot, from_quaternion, turn
from laticauda.tank.lab import nodes, virtual_robot
from laticauda.tank.lab.settings import (
    LabSettings,
    MocapSettings,
    NodeSettings,
    SupplySettings,
)
from laticauda.tank.protocol import BodyPose, MeterReading, MocapFrame, meter

BODY = "last-module"
# Positions of the five markers on their body: a cross with one arm longer than the others; an
# assumption [m].
MARKERS = (
    (0.0, 0.0, 0.0),
    (0.05, 0.0, 0.0),
    (-0.04, 0.0, 0.0),
    (0.0, 0.04, 0.0),
    (0.0, -0.03, 0.01),
)
ROTATION_JUMP = 0.1
"""Jump of the rotation of a body with a marker mistaken for its mirror image [rad]."""


class Cameras:
    """The cameras and their frames.

    Args:
        settings: Settings of the cameras.
        random: Source of the noise.
    """

    def __init__(self, settings: MocapSettings, random: np.random.Generator) -> None:
        self.settings, self._random = settings, random
        self._turn = turn("yaw", settings.mount_yaw)
        self._frame = turn("yaw", settings.frame_yaw)
        self._number = 0

    def look(self, modules: ModulePoses, time: float, *, hidden: bool = False) -> MocapFrame | None:
        """Return the next frame.

        Args:
            modules: Poses of the robot's modules.
            time: Time of the frame [s].
            hidden: Whether something hides the markers from the cameras.

        Returns:
            The frame, or None if it never arrives.
        """
        s, random = self.settings, self._random
        self._number += 1
        chance = random.random(3)
        noise = random.standard_normal((4, 3))
        if chance[0] < s.drop_share:
            return None
        rotation = modules.rotation[0] @ self._turn
        position = modules.position[0] + modules.rotation[0] @ np.array(s.mount)
        body = None
        if not hidden and chance[1] >= s.lost_share and self.covers(position):
            body = self._measured(position, rotation, float(chance[2]), noise)
        return MocapFrame(timestamp=time, number=self._number, bodies=(body,))

    def covers(self, position: Float[np.ndarray, " 3"]) -> bool:
        """Return whether a place is in the volume that the cameras cover.

        Args:
            position: Position in world axes [m].
        """
        s = self.settings
        return bool(np.all(np.abs(position - np.array(s.middle)) <= 0.5 * np.array(s.size)))

    def _measured(
        self,
        position: Float[np.ndarray, " 3"],
        rotation: Float[np.ndarray, "3 3"],
        chance: float,
        noise: Float[np.ndarray, "4 3"],
    ) -> BodyPose:
        """Return the pose in the cameras' frame, with its errors."""
        s = self.settings
        depth = max(-float(position[2]), 0.0)
        mistaken = chance < s.reflection_share * math.exp(-depth / s.reflection_depth)
        shift, turn = s.position_noise * noise[0], s.rotation_noise * noise[1]
        residual = s.position_noise * float(np.linalg.norm(noise[2])) / math.sqrt(3.0)
        if mistaken:
            shift = shift + s.reflection_jump * noise[3]
            turn = turn + ROTATION_JUMP * noise[2]
            residual += 0.5 * float(np.linalg.norm(s.reflection_jump * noise[3]))
        measured = self._frame.T @ (position + shift - np.array(s.frame))
        return BodyPose(
            position=measured,
            rotation=self._frame.T @ _rotation(turn) @ rotation,
            residual=residual,
        )


def _rotation(vector: Float[np.ndarray, " 3"]) -> Float[np.ndarray, "3 3"]:
    """Return the rotation about a vector by its length [rad]."""
    half = 0.5 * float(np.linalg.norm(vector))
    return from_quaternion(math.cos(half), *(0.5 * float(np.sinc(half / math.pi)) * vector))


IDENTITY = "FLUKE 289,V1.16,00000007"  # model, software, serial number


class Multimeter:
    """The multimeter: its display and its answers.

    Args:
        settings: Settings of the meter.
        random: Source of the noise.
    """

    def __init__(self, settings: SupplySettings, random: np.random.Generator) -> None:
        self.settings, self._random = settings, random
        self._charge, self._elapsed, self._time = 0.0, 0.0, 0.0
        self._live: float | None = None
        self._began: float | None = None
        self._shown: list[float] = []  # since it began

    def advance(self, current: float, dt: float) -> None:
        """Advance time by `dt` [s] at a `current` [A]."""
        self._time += dt
        self._charge += current * dt
        self._elapsed += dt
        if self._elapsed >= self.settings.meter_interval - 1e-9:
            noise = self.settings.current_noise * float(self._random.standard_normal())
            self._live = round(self._charge / self._elapsed + noise, 4)  # it shows four decimals
            self._charge = self._elapsed = 0.0
            if self._began is not None:
                self._shown.append(self._live)

    @property
    def reading(self) -> MeterReading | None:
        """Reading on the display; None: nothing yet."""
        if self._live is None:
            return None
        if self._began is None or not self._shown:
            return MeterReading(live=self._live)
        ends = {"minimum": min(self._shown), "maximum": max(self._shown)}
        return MeterReading(
            live=self._live, average=fmean(self._shown), **ends, duration=self._time - self._began
        )

    def answer(self, line: str) -> bytes:
        """Return the answer to a line, as bytes on the wire."""
        question = " ".join(line.upper().split())
        if question == meter.IDENTITY:
            return meter.encode_answer(IDENTITY)
        if question == meter.RESTART:
            self._began = self._time
            self._shown = []
            return meter.encode_answer()
        if question not in (meter.MEASURE, meter.DISPLAYED):
            return meter.encode_answer(acknowledgment=meter.Acknowledgment.SYNTAX_ERROR)
        reading = self.reading
        if reading is None:
            return meter.encode_answer(acknowledgment=meter.Acknowledgment.NO_DATA)
        if question == meter.MEASURE:
            return meter.encode_answer(meter.live_text(reading.live))
        return meter.encode_answer(meter.displayed_text(reading, self._time))


# ---- in the modules: motors, sensors and supply of all of them at once ---------------------------


GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""
PLAY_TORQUE = 0.2
"""Torque at which gear play is taken up; an assumption that keeps it from rattling in the lab's steps [N m]."""
PLAY_TIME = 0.03
"""Time in which gear play is taken up, likewise [s]."""


class ForceSensors:
    """Force part of the force/torque sensors of all modules: strain gauges, with noise and a zero that is off.

    Args:
        settings: Settings of the modules.
        n_nodes: Number of modules with a sensor.
        random: Source of the noise.
    """

    def __init__(self, settings: NodeSettings, n_nodes: int, random: np.random.Generator) -> None:
        self._noise = settings.force_noise
        self._random = random
        self._zero = random.uniform(-1.0, 1.0, (n_nodes, 3)) * settings.force_zero_error

    def read(
        self, force: Float[np.ndarray, "n_nodes 3"], node: int
    ) -> tuple[float, float, float] | None:
        """Return the reading of a sensor along, to the left, up [N]; None if its force is not known.

        Args:
            force: True forces at all sensors [N].
            node: Index of the sensor.
        """
        noise = self._noise * self._random.standard_normal(3)
        if np.isnan(force[node, 0]):
            return None
        along, left, up = (force[node] + self._zero[node] + noise).tolist()
        return along, left, up


class Electronics:
    """Everything between body and firmware that has a memory: heat, gear play, accelerometers, the supply.

    Args:
        robot: Robot with all its joints, and those of its fin.
        settings: Settings of the tank.
        random: Source of the noise.
        servos: Law of the joints.
    """

    def __init__(
        self, robot: Robot, settings: LabSettings, random: np.random.Generator, servos: Servo
    ) -> None:
        actuators = [joint.actuator for joint in robot.driven_joints]
        self.settings, self._random, self._servos = settings, random, servos
        self._drives = [Drive(*(getattr(a, name) for name in Drive._fields)) for a in actuators]
        self._stall_torque = np.array([a.stall_torque for a in actuators])
        self._no_load_speed = np.array([a.no_load_speed for a in actuators])
        self._stall_current = np.array([a.stall_current for a in actuators])
        self._voltage = np.array([a.voltage for a in actuators])
        self._idle = robot.idle_power
        n = len(actuators)
        # Modules with the nodes; that of a driven fin is in the last one.
        self._modules = [*range(robot.n_joints), 0][:n]
        self.zero_error = random.uniform(-1.0, 1.0, n) * settings.nodes.zero_error
        self.play, self.slip_rate = np.zeros(n), np.zeros(n)
        self.duty, self.current = np.zeros(n), np.zeros(n)
        self.temperature = np.full(n, settings.water_temperature)
        self.voltage = settings.supply.voltage
        self.supply_current = self._idle / settings.supply.voltage
        self._acceleration = np.tile([0.0, 0.0, GRAVITY], (n, 1))
        self._positions: list[Float[np.ndarray, "n 3"]] = []
        self._work = 0.0

    def offset(self, zero: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
        """Return by how much the nodes' readings exceed the true joint angles, apart from noise [rad]."""
        return self.zero_error + self.play + zero

    def advance(
        self,
        truth: virtual_robot.Truth,
        reference: Float[np.ndarray, " n"],
        on: Bool[np.ndarray, " n"],
        jammed: Bool[np.ndarray, " n"],
        dt: float,
    ) -> None:
        """Advance time by `dt`.

        Args:
            truth: True state at its end.
            reference: Where the motors are to go, as true joint angles [rad].
            on: Which motors are on.
            jammed: Which joints cannot turn; the plant's work does not include their motors.
            dt: Time step [s].
        """
        # The sensor is on the motor's side, which leads by half the play in the direction of the
        # motor's pull.
        leads = 0.5 * self.settings.nodes.backlash * np.tanh(truth.joint_torque / PLAY_TORQUE)
        self.play = self.play + (leads - self.play) * (1.0 - math.exp(-dt / PLAY_TIME))
        motion = zip(truth.joint_angle, truth.joint_rate, reference, self._drives, strict=True)
        self.duty = np.where(on, [self._servos.duty(*joint) for joint in motion], 0.0)
        self.current = np.where(
            on, self._stall_current * (self.duty - truth.joint_rate / self._no_load_speed), 0.0
        )
        self._heat(dt)
        extra = np.sum((self._voltage * np.maximum(self.duty * self.current, 0.0))[jammed])
        power = self._idle + float(extra) + (truth.electrical_work - self._work) / dt
        self._work = truth.electrical_work
        supply = self.settings.supply
        # Of the two roots of P = (V - R I) I, the one at which a supply works; beyond its limit, it
        # gives what it can.
        largest_power = np.inf
        if supply.cable_resistance:
            largest_power = supply.voltage**2 / (4.0 * supply.cable_resistance)
        root = np.sqrt(1.0 - min(power / largest_power, 1.0))
        self.voltage = 0.5 * supply.voltage * (1.0 + float(root))
        self.supply_current = power / self.voltage

    def accelerate(self, truth: virtual_robot.Truth, dt: float) -> None:
        """Update the accelerometers from the modules at the end of a step of the regular clock."""
        poses = truth.modules
        self._positions = [*self._positions[-2:], poses.position[self._modules]]
        if len(self._positions) == 3:
            before, middle, now = self._positions
            felt = (now - 2.0 * middle + before) / dt**2 + np.array([0.0, 0.0, GRAVITY])
            self._acceleration = np.einsum("nij,ni->nj", poses.rotation[self._modules], felt)

    def forget(self, truth: virtual_robot.Truth) -> None:
        """Ignore that the robot was carried elsewhere: this causes no acceleration and no work."""
        self._positions = []
        self._work = truth.electrical_work

    def read(self, truth: virtual_robot.Truth, leaks: Bool[np.ndarray, " n"]) -> list[nodes.Senses]:
        """Return the current readings of every node.

        Args:
            truth: True state of the robot.
            leaks: Which modules have water inside.
        """
        s, n = self.settings.nodes, self.duty.size
        noise = self._random.standard_normal((7, n))
        angle = truth.joint_angle + self.zero_error + self.play + s.angle_noise * noise[0]
        if s.angle_step > 0.0:
            angle = s.angle_step * np.rint(angle / s.angle_step)
        # Of the same sensor as the angle.
        rate = truth.joint_rate + self.slip_rate + s.rate_noise * noise[1]
        current = self.current + s.current_noise * noise[2]
        torque = self._stall_torque / self._stall_current * current
        load = truth.joint_torque + s.torque_noise * noise[3]
        acceleration = self._acceleration + s.acceleration_noise * noise[4:].T
        columns = {
            "angle": angle,
            "rate": rate,
            "current": current,
            "duty": self.duty,
            "torque": torque,
            "load": load,
            "acceleration": acceleration,
            "temperature": self.temperature,
            "leak": leaks,
        }
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        return [
            nodes.Senses(**dict(zip(columns, row, strict=True)), voltage=self.voltage)
            for row in rows
        ]

    def _heat(self, dt: float) -> None:
        """C dT/dt = R I^2 - (T - T_water) / R_th, with R = V / I_stall."""
        s = self.settings.nodes
        resistance = self._voltage / self._stall_current
        cooling = (self.temperature - self.settings.water_temperature) / s.thermal_resistance
        self.temperature = self.temperature + dt / s.heat_capacity * (
            resistance * self.current**2 - cooling
        )
