"""A scenario that is stepped from outside, by servo outputs, and read by the sensors of an autopilot."""

from dataclasses import replace
from typing import Any

from laticauda.models.simulate import build_plant
from laticauda.scenarios import Command, Scenario, Spatial, Start
from laticauda.values import BadArgument, Log, SimulationFailed
from laticauda_ardupilot.battery import Discharge
from laticauda_ardupilot.mixing import Mixing
from laticauda_ardupilot.packets import MOST_RANGES, SensorReading
from laticauda_ardupilot.sensing import Motion, MotionSensor, read_motion


class Vehicle:
    """A robot in its scenario, at its start until the first step.

    Args:
        scenario: Robot, water, model and start; of its motion, only the gait counts.
        mixing: What the servo outputs do.

    Raises:
        ValueError: If they do not fit together.
    """

    def __init__(self, scenario: Scenario, mixing: Mixing) -> None:
        _check(scenario)
        mixing.check(scenario.robot, scenario.model)
        self.plant: Any = build_plant(scenario)
        """The plant that is stepped."""
        self._gait = scenario.gait
        self._start = scenario.start
        self._mixing = mixing
        simulated = replace(scenario, robot=self.plant.robot, model=self.plant.settings)
        self._sensor = MotionSensor(simulated, of_head=mixing.attitude == "head")
        self._has_rays = isinstance(scenario.model, Spatial) and bool(scenario.model.rays)
        self.reset()

    def reset(self) -> None:
        """Put the robot back to its start, with a full battery."""
        command = Command(gait=self._gait)
        self.state: Any = self.plant.init(self._start, command)
        """State of the plant."""
        self.command = command
        """Command of the last step."""
        self._pwm: tuple[int, ...] | None = None
        self._motion: Motion | None = None
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
            self.command = self._mixing.command(self._gait, self.plant.robot, pwm)
            self._pwm = pwm
        advance = self.plant.advance(self.state, self.command, duration, duration)
        if advance.failure is not None:
            raise SimulationFailed(advance.failure)
        self.state = advance.state
        log = self.plant.log([advance.stretch])
        before = self._motion or self._sensor.motion(log, 0)
        self._motion = self._sensor.motion(log, -1, before)
        reading = read_motion(before, self._motion)
        if self._has_rays:
            ranges = self.plant.observe(self.state).ranges
            reading = replace(reading, ranges=tuple(ranges.tolist()))
        if self._discharge is not None:
            power = self._drawn_power(log, duration)
            self._discharge.draw(power, duration)
            reading = replace(
                reading, voltage=self._discharge.voltage, current=self._discharge.current
            )
        return reading

    def _drawn_power(self, log: Log, duration: float) -> float:
        """Return the power that the robot drew in the last step [W].

        That of its power model, or else of its joints, with what it draws at rest; thrusters have none.
        """
        work = log.electrical_work
        if work is None:
            work = log.work[:, 0]
        power = float(work[-1] - work[0]) / duration
        return power + (self.plant.robot.electronics_power or 0.0)


def _check(scenario: Scenario) -> None:
    """Reject a scenario that an autopilot cannot drive."""
    model = scenario.model
    if model.loop_delay > 0.0:
        rule = "must be 0: an autopilot brings the delay of its own loop"
        raise BadArgument("model.loop_delay", f"{rule}; got {model.loop_delay:g} s")
    if not isinstance(scenario.start, Start):
        rule = "must be a start at rest or with a speed, to which a reset can return"
        raise BadArgument("start", f"{rule}; got the end of another run")
    if isinstance(model, Spatial) and len(model.rays) > MOST_RANGES:
        rule = f"must be {MOST_RANGES} or fewer, as ArduPilot has rangefinders"
        raise BadArgument("model.rays", f"{rule}; got {len(model.rays)}")
