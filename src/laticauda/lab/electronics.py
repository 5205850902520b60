"""Motors, sensors and supply of all modules at once: from what is so to what the nodes read."""

import math

import numpy as np
from jaxtyping import Bool, Float

from laticauda.actuation.laws import Drive, Servo
from laticauda.lab import nodes, virtual_robot
from laticauda.lab.settings import LabSettings
from laticauda.robot import Robot

GRAVITY = 9.81  # m/s^2
# How gently the play of a gear is taken up; assumptions that keep it from rattling in steps of the lab's clock.
PLAY_TORQUE, PLAY_TIME = 0.2, 0.03  # N m, s


class Electronics:
    """What has a memory between body and firmware: heat, play of the gears, accelerometers, the supply.

    Args:
        robot: With all of its joints, and those of its fin.
        settings: The tank's numbers.
        random: Where the noise comes from.
        servos: The law of the joints.
    """

    def __init__(self, robot: Robot, settings: LabSettings, random: np.random.Generator, servos: Servo) -> None:
        actuators = [joint.actuator for joint in robot.driven_joints]
        self.settings, self._random, self._servos = settings, random, servos
        self._drives = [Drive(*(getattr(a, name) for name in Drive._fields)) for a in actuators]
        self._stall_torque = np.array([a.stall_torque for a in actuators])
        self._no_load_speed = np.array([a.no_load_speed for a in actuators])
        self._stall_current = np.array([a.stall_current for a in actuators])
        self._voltage = np.array([a.voltage for a in actuators])
        self._idle = robot.idle_power
        n = len(actuators)
        self._modules = [*range(robot.n_joints), 0][:n]  # that carry the nodes; a driven fin's is in the last one
        self.zero_error = random.uniform(-1.0, 1.0, n) * settings.nodes.zero_error
        self.play = np.zeros(n)
        self.duty, self.current = np.zeros(n), np.zeros(n)
        self.temperature = np.full(n, settings.water_temperature)
        self.voltage = settings.supply.voltage
        self.supply_current = self._idle / settings.supply.voltage
        self._acceleration = np.tile([0.0, 0.0, GRAVITY], (n, 1))
        self._positions: list[Float[np.ndarray, "n 3"]] = []
        self._work = 0.0

    def offset(self, zero: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
        """What the nodes read above the joint angles that are so, noise aside [rad]."""
        return self.zero_error + self.play + zero

    def advance(
        self,
        truth: virtual_robot.Truth,
        reference: Float[np.ndarray, " n"],
        on: Bool[np.ndarray, " n"],
        jammed: Bool[np.ndarray, " n"],
        dt: float,
    ) -> None:
        """Let `dt` pass.

        Args:
            truth: At its end.
            reference: Where the motors are to go, by joint angles that are so [rad].
            on: Which of them are on.
            jammed: Which joints cannot turn; the plant's work does not know of their motors.
            dt: [s].
        """
        # The sensor is on the motor's side, which leads by half the play wherever the motor pulls.
        leads = 0.5 * self.settings.nodes.backlash * np.tanh(truth.joint_torque / PLAY_TORQUE)
        self.play = self.play + (leads - self.play) * (1.0 - math.exp(-dt / PLAY_TIME))
        motion = zip(truth.joint_angle, truth.joint_rate, reference, self._drives, strict=True)
        self.duty = np.where(on, [self._servos.duty(*one) for one in motion], 0.0)
        self.current = np.where(on, self._stall_current * (self.duty - truth.joint_rate / self._no_load_speed), 0.0)
        self._heat(dt)
        extra = np.sum((self._voltage * np.maximum(self.duty * self.current, 0.0))[jammed])
        power = self._idle + float(extra) + (truth.electrical_work - self._work) / dt
        self._work = truth.electrical_work
        supply = self.settings.supply
        # Of the two roots of P = (V - R I) I, the one that a supply works at; beyond its limit, it gives what it can.
        most = supply.voltage**2 / (4.0 * supply.cable_resistance) if supply.cable_resistance else np.inf
        root = np.sqrt(1.0 - min(power / most, 1.0))
        self.voltage = 0.5 * supply.voltage * (1.0 + float(root))
        self.supply_current = power / self.voltage

    def accelerate(self, truth: virtual_robot.Truth, dt: float) -> None:
        """See the modules at the end of a step of the regular clock, for the accelerometers."""
        poses = truth.modules
        self._positions = [*self._positions[-2:], poses.position[self._modules]]
        if len(self._positions) == 3:
            before, middle, now = self._positions
            felt = (now - 2.0 * middle + before) / dt**2 + np.array([0.0, 0.0, GRAVITY])
            self._acceleration = np.einsum("nij,ni->nj", poses.rotation[self._modules], felt)

    def forget(self, truth: virtual_robot.Truth) -> None:
        """The robot was carried elsewhere: no acceleration comes from that, and no work."""
        self._positions = []
        self._work = truth.electrical_work

    def read(self, truth: virtual_robot.Truth, leaks: Bool[np.ndarray, " n"]) -> list[nodes.Senses]:
        """What every node reads now.

        Args:
            truth: What is so.
            leaks: Which modules have water inside.
        """
        s, n = self.settings.nodes, self.duty.size
        noise = self._random.standard_normal((7, n))
        angle = truth.joint_angle + self.zero_error + self.play + s.angle_noise * noise[0]
        if s.angle_step > 0.0:
            angle = s.angle_step * np.rint(angle / s.angle_step)
        rate = truth.joint_rate + s.rate_noise * noise[1]
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
        return [nodes.Senses(**dict(zip(columns, row, strict=True)), voltage=self.voltage) for row in rows]

    def _heat(self, dt: float) -> None:
        """C dT/dt = R I^2 - (T - T_water) / R_th, with R = V / I_stall."""
        s = self.settings.nodes
        resistance = self._voltage / self._stall_current
        cooling = (self.temperature - self.settings.water_temperature) / s.thermal_resistance
        self.temperature = self.temperature + dt / s.heat_capacity * (resistance * self.current**2 - cooling)
