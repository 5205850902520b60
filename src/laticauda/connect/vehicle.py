"""A scenario that another program steps, with its own commands, and sees as a vehicle with sensors."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.connect.vehicle_motion import (
    Inertial,
    MotionTracker,
    VehicleMotion,
    measure_inertial,
)
from laticauda.connect.vehicle_record import VehicleRecord
from laticauda.models import simulate
from laticauda.scenarios import Command, Model, Observation, Scenario, Spatial, Start
from laticauda.sensing import Altimeter, Reading, Sonar, senses_of
from laticauda.values import BadArgument, Log, SimulationFailed

RANGEFINDERS = (Sonar, Altimeter)
"""Sensors whose values are distances."""


@dataclass(frozen=True, kw_only=True)
class VehicleStep:
    """What sensors tell at the end of a step."""

    motion: VehicleMotion
    """Place, attitude and velocity of the body as a whole, or of its head."""
    inertial: Inertial
    """Means of the inertial unit over the step."""
    ranges: tuple[float, ...]
    """Distances that rangefinders tell, see `count_ranges`; infinite without an echo [m]."""
    readings: Mapping[str, Reading]
    """What each sensor of the model last told, by its name."""
    power: float
    """Power that joints and electronics drew, on average; thrusters draw none [W]."""
    log: Log
    """Samples at the begin and at the end of the step."""


class Vehicle:
    """A robot in its scenario, at its start until the first step.

    Args:
        scenario: Robot, water, model and start; of its motion, only the gait counts.
        of_head: Whether attitude and place are those of the head, or of the body as a whole.

    Raises:
        ValueError: If the scenario cannot be stepped from outside.
    """

    def __init__(self, scenario: Scenario, *, of_head: bool = False) -> None:
        _check(scenario)
        self.plant: Any = simulate.build_plant(scenario)
        """The plant that is stepped."""
        self.scenario = replace(
            scenario,
            robot=self.plant.robot,
            model=self.plant.settings,
        )
        """The scenario, with robot and model as they are simulated."""
        self._tracker = MotionTracker(self.scenario, of_head=of_head)
        model = scenario.model
        self._needs_observation = bool(model.sensors) or count_ranges(model) > 0
        self.reset()

    def reset(self) -> None:
        """Put the robot back to its start."""
        scenario = self.scenario
        command = Command(gait=scenario.gait)
        self.state: Any = self.plant.init(scenario.start, command)
        """State of the plant."""
        self._motion: VehicleMotion | None = None
        self._senses = senses_of(self.plant.settings, self.plant.environment)
        self.record = VehicleRecord(self.scenario)
        """The run since the last reset."""

    def step(self, command: Command, duration: float) -> VehicleStep:
        """Hold a command for some time, and return what sensors tell at its end.

        Args:
            command: The command.
            duration: Duration [s].

        Raises:
            ValueError: If the robot cannot follow the command.
            SimulationFailed: If the motion diverged.
        """
        advance = self.plant.advance(self.state, command, duration, duration)
        if advance.failure is not None:
            raise SimulationFailed(advance.failure)
        self.state = advance.state
        log = self.plant.log([advance.stretch])
        self.record.add(log)
        before = self._motion
        if before is None:
            before = self._tracker.motion(log, 0)
        now = self._tracker.motion(log, -1, before)
        self._motion = now
        ranges: tuple[float, ...] = ()
        readings: Mapping[str, Reading] = {}
        if self._needs_observation:
            observation = self._observe(command)
            ranges = _list_ranges(self.scenario.model, observation)
            readings = observation.readings
        return VehicleStep(
            motion=now,
            inertial=measure_inertial(before, now),
            ranges=ranges,
            readings=readings,
            power=self._drawn_power(log, duration),
            log=log,
        )

    def _observe(self, command: Command) -> Observation:
        """Return the observation of the state after a command, with what its sensors tell."""
        observation = self.plant.observe_under(self.state, command)
        if self._senses is None:
            return observation
        readings = self._senses.read(observation)
        return observation.with_readings(readings)

    def _drawn_power(self, log: Log, duration: float) -> float:
        """Return the power drawn in a step: by the power model, else by the joints, and by the electronics [W]."""
        work = log.electrical_work
        if work is None:
            work = log.work[:, 0]
        power = float(work[-1] - work[0]) / duration
        at_rest = self.plant.robot.electronics_power
        if at_rest is None:
            return power
        return power + at_rest


def count_ranges(model: Model) -> int:
    """Return how many distances are told: one per ray of the head, per beam of every sonar, per altimeter.

    Args:
        model: The model's settings.
    """
    n_ranges = 0
    if isinstance(model, Spatial):
        n_ranges += len(model.rays)
    for sensor in model.sensors:
        if isinstance(sensor, RANGEFINDERS):
            n_ranges += len(sensor.columns)
    return n_ranges


def _list_ranges(model: Model, observation: Observation) -> tuple[float, ...]:
    """Return all distances, in the order in which `count_ranges` counts them [m]."""
    ranges: list[float] = []
    if observation.ranges is not None:
        ranges += observation.ranges.tolist()
    for sensor in model.sensors:
        if isinstance(sensor, RANGEFINDERS):
            values = observation.readings[sensor.name].values
            ranges += np.nan_to_num(values, nan=np.inf).tolist()
    return tuple(ranges)


def _check(scenario: Scenario) -> None:
    """Reject a scenario that cannot be stepped from outside."""
    delay = scenario.model.loop_delay
    if delay > 0.0:
        rule = "must be 0: the program that steps the robot brings the delay of its own loop"
        raise BadArgument("model.loop_delay", f"{rule}; got {delay:g} s")
    if not isinstance(scenario.start, Start):
        rule = "must be a start at rest or with a speed, to which a reset can return"
        raise BadArgument("start", f"{rule}; got the end of another run")
