"""A node that serves a scenario: it hears `Twist` or joint references, and tells what a robot with sensors tells."""

import math
import time
from collections.abc import Callable
from typing import Any

from laticauda.connect.vehicle import Vehicle, VehicleStep, count_ranges
from laticauda.connect.vehicle_record import VehicleRecord
from laticauda.robot import Water
from laticauda.scenarios import Command, Scenario
from laticauda_ros2 import messages, reports
from laticauda_ros2.bus import GOALS, STATES
from laticauda_ros2.drive import Drive, Wish
from laticauda_ros2.node import Node

TWIST = "cmd_vel"
ODOMETRY = "odom"
IMU = "imu/data"
PRESSURE = "pressure"
RANGE = "range_{}"
RESET = "reset"
TRANSFORMS = "/tf"
CLOCK = "/clock"
"""Topics of ROS 2 that have no namespace by custom: `TRANSFORMS` and this one."""
FORGOTTEN_AFTER = 0.5
"""Time without a `Twist` after which the robot stops swimming [s, wall clock]."""
FARTHEST_BEHIND = 0.2
"""Delay from which a slow computer is not waited for: time then goes slower [s, wall clock]."""


class Speed:
    """Lets time of the simulation go on with that on the wall.

    Args:
        factor: How much faster; 0: as fast as the computer can.
    """

    def __init__(self, factor: float) -> None:
        self._factor = factor
        self._due = time.monotonic()

    def time_left(self, duration: float) -> float:
        """Return how long to wait before the next step, which is due `duration` after the last [s, wall clock].

        Args:
            duration: Duration of the step [s].
        """
        now = time.monotonic()
        if self._factor == 0.0:
            return 0.0
        self._due = max(self._due + duration / self._factor, now - FARTHEST_BEHIND)
        return max(self._due - now, 0.0)


class VehicleNode:
    """A robot in its scenario, on the topics of a namespace.

    Args:
        scenario: Robot, water, model and start; of its motion, only the gait counts.
        drive: How the robot does what a `Twist` asks for.
        domain: Of DDS.
        space: Namespace of the topics; "" is none.
        rate: Steps, and messages on each topic, per second [Hz].
        is_humble: Whether others are of ROS 2 Humble, whose `Range` has no variance.

    Raises:
        ValueError: If scenario and drive do not fit together.
        DeviceFailed: If the network cannot be used.
    """

    def __init__(
        self,
        scenario: Scenario,
        drive: Drive,
        *,
        domain: int = 0,
        space: str = "",
        rate: float = 50.0,
        is_humble: bool = False,
    ) -> None:
        drive.check(scenario.robot, scenario.model)
        self._vehicle = Vehicle(scenario)
        self._robot = self._vehicle.scenario.robot
        self._gait = scenario.gait
        self._drive = drive
        self._space = space
        self._interval = 1.0 / rate
        self._is_humble = is_humble
        self._command = drive.command(self._gait, self._robot, Wish())
        self._twist_at = -math.inf
        self._has_references = False
        self._joint_names = reports.joint_names(self._robot)
        self._ranges = range(count_ranges(scenario.model))
        self.n_refused = 0
        """How many messages made no sense."""
        self._node = Node(domain)
        self._open_topics()

    def _open_topics(self) -> None:
        hears = {
            TWIST: messages.Twist,
            GOALS: messages.Float64MultiArray,
            RESET: messages.Empty,
        }
        tells = {
            STATES: messages.JointState,
            ODOMETRY: messages.Odometry,
            IMU: messages.Imu,
            PRESSURE: messages.FluidPressure,
        }
        kind_of_range = messages.RangeOfHumble if self._is_humble else messages.Range
        for number in self._ranges:
            tells[RANGE.format(number)] = kind_of_range
        for name, kind in hears.items():
            self._node.read(self._topic(name), kind)
        for name, kind in tells.items():
            self._node.write(self._topic(name), kind)
        self._node.write(TRANSFORMS, messages.TFMessage)
        self._node.write(CLOCK, messages.Clock)

    def _topic(self, name: str) -> str:
        return f"{self._space}/{name}"

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics that it hears, then those that it tells."""
        names = [TWIST, GOALS, RESET, STATES, ODOMETRY, IMU, PRESSURE]
        names += [RANGE.format(number) for number in self._ranges]
        return (*(self._topic(name) for name in names), TRANSFORMS, CLOCK)

    @property
    def record(self) -> VehicleRecord:
        """The run since the last reset."""
        return self._vehicle.record

    def run(self, is_ended: Callable[[], bool], speed: float = 1.0) -> None:
        """Step and tell until the end.

        Args:
            is_ended: Says whether it is to end; asked before every step.
            speed: How much faster than on the wall time goes; 0: as fast as the computer can.

        Raises:
            SimulationFailed: If the motion diverged.
        """
        pace = Speed(speed)
        while not is_ended():
            self._hear()
            step = self._vehicle.step(self._command, self._interval)
            self._tell(step)
            self._wait(pace.time_left(self._interval))

    def _wait(self, duration: float) -> None:
        """Wait for some time, whatever comes meanwhile [s, wall clock]."""
        end = time.monotonic() + duration
        while (left := end - time.monotonic()) > 0.0:
            self._node.wait(left)

    def close(self) -> None:
        """Leave the network."""
        self._node.close()

    # ---- what it hears ---------------------------------------------------------------------------

    def _hear(self) -> None:
        """Take what has come; the last one counts."""
        now = time.monotonic()
        for _ in self._node.taken(self._topic(RESET)):
            self._vehicle.reset()
            self._stop()
        for message in self._node.taken(self._topic(GOALS)):
            self._take_references(message)
        for message in self._node.taken(self._topic(TWIST)):
            self._take_twist(message, now)
        if not self._has_references and now - self._twist_at > FORGOTTEN_AFTER:
            self._stop()

    def _stop(self) -> None:
        self._has_references = False
        self._command = self._drive.command(self._gait, self._robot, Wish())

    def _take_twist(self, message: Any, now: float) -> None:
        if message is None:
            self.n_refused += 1
            return
        wish = Wish(forward=message.linear.x, climb=message.linear.z, turn=message.angular.z)
        if not all(math.isfinite(value) for value in wish):
            self.n_refused += 1
            return
        self._has_references = False
        self._twist_at = now
        self._command = self._drive.command(self._gait, self._robot, wish)

    def _take_references(self, message: Any) -> None:
        """Hold angles of all joints until a `Twist` comes."""
        angles = () if message is None else tuple(float(angle) for angle in message.data)
        command = Command(gait=self._gait, references=angles)
        try:
            command.check_held(self._robot, self._vehicle.scenario.model.joints)
        except ValueError:
            self.n_refused += 1
            return
        self._has_references = True
        self._command = command

    # ---- what it tells ---------------------------------------------------------------------------

    def _tell(self, step: VehicleStep) -> None:
        """Publish everything that belongs to a step."""
        messages_of_step = {
            ODOMETRY: reports.odometry(step),
            STATES: reports.joint_states(step, self._joint_names),
            IMU: reports.imu(step),
        }
        environment = self._vehicle.scenario.environment
        if isinstance(environment, Water):
            messages_of_step[PRESSURE] = reports.pressure(step, environment.density)
        for number in self._ranges:
            messages_of_step[RANGE.format(number)] = reports.distance(
                step, self._robot, number, has_variance=not self._is_humble
            )
        self._node.say(CLOCK, messages.clock(step.motion.time))
        self._node.say(TRANSFORMS, reports.transforms(step.motion))
        for name, message in messages_of_step.items():
            self._node.say(self._topic(name), message)
