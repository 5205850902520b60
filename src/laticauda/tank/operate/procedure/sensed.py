"""What the robot's own sensors told, as a controller finds it in its observation."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from laticauda.sensing import Reading
from laticauda.tank.operate.procedure.clocks import ClockState, update_clock
from laticauda.tank.operate.recording.entries import SensorSample


@dataclass(frozen=True, kw_only=True)
class SensedState:
    """What the robot's own sensors told."""

    clock: ClockState | None = None
    """Offset of their clock from ours."""
    readings: Mapping[str, Reading] = field(default_factory=dict[str, Reading])
    """Last reading of each sensor by its name; new: it arrived after the controller's last decision."""

    def with_sample(self, sample: SensorSample) -> "SensedState":
        """Return the state after a sample.

        Args:
            sample: The sample, on our clock.
        """
        reading = Reading(time=sample.time, values=sample.values, is_new=True)
        if not sample.has_values:
            missing = np.full(len(sample.columns), np.nan)
            reading = Reading(time=-math.inf, values=missing, is_new=False)
        return replace(self, readings={**self.readings, sample.sensor: reading})

    def after_decision(self) -> "SensedState":
        """Return the state after a decision of the controller: it knows all readings."""
        readings = {name: reading._replace(is_new=False) for name, reading in self.readings.items()}
        return replace(self, readings=readings)


def take_in_sensed(
    state: SensedState, arrivals: Iterable[tuple[float, SensorSample]]
) -> tuple[SensedState, tuple[SensorSample, ...]]:
    """Take in what the sensors sent.

    Args:
        state: What they told before.
        arrivals: Samples on their clock, with their times of arrival on ours [s].

    Returns:
        The new state, and the samples on our clock.
    """
    samples: list[SensorSample] = []
    for arrival, sample in arrivals:
        if sample.has_values:
            clock = update_clock(state.clock, arrival, sample.time)
            state = replace(state, clock=clock)
            sample = replace(sample, time=sample.time + clock.offset)
        state = state.with_sample(sample)
        samples.append(sample)
    return state, tuple(samples)
