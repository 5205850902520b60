"""The robot's own sensors in a recording: what a trial and a controller find of them."""

from dataclasses import replace

import numpy as np
import pytest
from tank.operate.tank import record

from laticauda.tank.operate import Decision, read_operation, rerun_controller, trial_of
from laticauda.tank.operate.recording.entries import SensorSample


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("readings") / "run.mcap"
    record(path)
    return read_operation(path)


def with_samples(log, *samples):
    entries = sorted((*samples, *log.entries), key=lambda entry: entry.time)
    return replace(log, entries=tuple(entries))


def compass(time, heading, columns=("heading",)):
    return SensorSample(time=time, sensor="compass", columns=columns, values=np.array([heading]))


def test_a_trial_holds_every_reading_until_the_next_one(recorded):
    begin, _ = recorded.span
    early, late = compass(begin - 0.1, 0.25), compass(begin + 0.5, -0.5)
    trial = trial_of(with_samples(recorded, late, early))
    heading = trial.signals["compass_heading"]
    assert set(heading[trial.time < 0.49]) == {0.25}
    assert set(heading[trial.time > 0.51]) == {-0.5}


def test_what_is_missing_at_some_time_is_in_the_recording_alone(recorded):
    begin, _ = recorded.span
    announced = SensorSample(
        time=begin - 0.2, sensor="beacon", columns=("range",), values=np.empty(0)
    )
    assert not announced.has_values
    sonar = SensorSample(
        time=begin - 0.1,
        sensor="sonar",
        columns=("range_0", "range_1"),
        values=np.array([2.0, np.nan]),
    )
    log = with_samples(recorded, announced, sonar, compass(begin + 0.5, 0.1))
    signals = trial_of(log).signals
    assert set(signals["sonar_range_0"]) == {2.0}
    assert not {"sonar_range_1", "beacon_range", "compass_heading"} & signals.keys()


def test_readings_of_a_sensor_whose_columns_changed_count_from_the_change(recorded):
    begin, _ = recorded.span
    before = SensorSample(
        time=begin - 0.2, sensor="compass", columns=("north",), values=np.array([9.0])
    )
    signals = trial_of(with_samples(recorded, before, compass(begin - 0.1, 0.1))).signals
    assert set(signals["compass_heading"]) == {0.1}
    assert "compass_north" not in signals


def test_a_rerun_controller_is_told_what_the_sensors_had_told(recorded):
    begin, _ = recorded.span
    log = with_samples(recorded, compass(begin - 0.1, 0.25))
    rerun = rerun_controller(log)
    assert len(rerun.recorded) == len(log.of_run(Decision))
    assert rerun.n_different == 0
