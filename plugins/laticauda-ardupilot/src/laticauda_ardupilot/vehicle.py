"""A scenario that is stepped by servo outputs, and read by the sensors of an autopilot."""

from dataclasses import replace

import numpy as np

from laticauda.connect import vehicle
from laticauda.connect.vehicle import VehicleStep, count_ranges
from laticauda.scenarios import Command, Scenario
from laticauda.values import BadArgument, to_quaternion
from laticauda_ardupilot.attitude import euler_angles, flip_rotation, flip_vector
from laticauda_ardupilot.battery import Discharge
from laticauda_ardupilot.mixing import Mixing
from laticauda_ardupilot.packets import MOST_RANGES, SensorReading


class Vehicle:
    """A robot in its scenario, at its start until the first step.

    Args:
        scenario: Robot, water, model and start; of its motion, only the gait counts.
        mixing: What the servo outputs do.

    Raises:
        ValueError: If they do not fit together.
    """

    def __init__(self, scenario: Scenario, mixing: Mixing) -> None:
        n_ranges = count_ranges(scenario.model)
        if n_ranges > MOST_RANGES:
            rule = f"must measure {MOST_RANGES} distances or fewer, as ArduPilot has rangefinders"
            raise BadArgument(
                "model", f"{rule}; rays, beams and altimeters together are {n_ranges}"
            )
        mixing.check(scenario.robot, scenario.model)
        self.robot = vehicle.Vehicle(scenario, of_head=mixing.attitude == "head")
        """What is stepped."""
        self._mixing = mixing
        self.reset()

    def reset(self) -> None:
        """Put the robot back to its start, with a full battery."""
        self.robot.reset()
        self.command = Command(gait=self.robot.scenario.gait)
        """Command of the last step."""
        self._pwm: tuple[int, ...] | None = None
        self._discharge: Discharge | None = None
        if self._mixing.battery is not None:
            self._discharge = Discharge(self._mixing.battery)

    def step(self, pwm: tuple[int, ...], duration: float) -> SensorReading:
        """Hold the servo outputs for one frame, and return what the sensors read at its end.

        Args:
            pwm: Width of the pulse of every output, 0 without one [us].
            duration: Duration of the frame [s].

        Raises:
            SimulationFailed: If the motion diverged.
        """
        if pwm != self._pwm:
            scenario = self.robot.scenario
            self.command = self._mixing.command(scenario.gait, scenario.robot, pwm)
            self._pwm = pwm
        step = self.robot.step(self.command, duration)
        reading = _read(step)
        if self._discharge is not None:
            self._discharge.draw(step.power, duration)
            reading = replace(
                reading, voltage=self._discharge.voltage, current=self._discharge.current
            )
        return reading


def _read(step: VehicleStep) -> SensorReading:
    """Return what the sensors tell, in the autopilot's axes."""
    rotation = flip_rotation(step.motion.rotation)
    return SensorReading(
        time=step.motion.time,
        gyro=flip_vector(step.inertial.angular_velocity),
        acceleration=flip_vector(step.inertial.specific_force),
        position=flip_vector(step.motion.position),
        velocity=flip_vector(step.motion.velocity),
        attitude=euler_angles(rotation),
        quaternion=np.array(to_quaternion(rotation)),
        ranges=step.ranges,
    )
