"""What the robot's own sensors told, as a controller finds it."""

import math

import numpy as np

from laticauda.tank.operate.procedure.sensed import SensedState, take_in_sensed
from laticauda.tank.operate.recording.entries import SensorSample


def sample(time: float, *values: float) -> SensorSample:
    return SensorSample(time=time, sensor="compass", columns=("heading",), values=np.array(values))


def test_a_sensor_that_has_not_measured_yet_is_known_and_tells_nothing():
    state, _ = take_in_sensed(SensedState(), [(10.0, sample(10.0))])
    reading = state.readings["compass"]
    assert (reading.time, reading.is_new) == (-math.inf, False)
    assert np.isnan(reading.values).tolist() == [True]


def test_a_reading_is_new_until_the_controller_has_decided_and_its_time_is_on_our_clock():
    arrivals = [(10.0, sample(2.0, 0.1)), (10.35, sample(2.3, 0.2))]
    state, samples = take_in_sensed(SensedState(), arrivals)
    assert [round(one.time, 9) for one in samples] == [10.0, 10.3]
    state, _ = take_in_sensed(state, [])
    assert state.readings["compass"].is_new
    assert state.readings["compass"].values.tolist() == [0.2]
    assert not state.after_decision().readings["compass"].is_new
