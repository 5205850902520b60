"""Sensors: what they tell is what they state, in both models, alone and in lanes, after storing and reading."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.sensing import (
    AcousticPosition,
    Altimeter,
    BatteryGauge,
    Compass,
    ContactSensor,
    DepthGauge,
    DopplerVelocity,
    InertialUnit,
    Net,
    Seabed,
    SensorFault,
    Sonar,
    Wall,
    surroundings_of,
)

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
PEN = Net(name="pen", center=(4.0, 0.0), radius=1.6)
SENSORS = (Sonar(), Compass(), DepthGauge())


class Watching(lc.Controller):
    """Swims straight, and keeps what it observes."""

    interval = 0.1
    gait = GAIT

    def __init__(self):
        self.observations = []

    def init(self):
        return None

    def step(self, state, observation):
        self.observations.append(observation)
        return None, lc.Command(gait=GAIT)


def watch(sensors, duration=3.0, **changes):
    watching = Watching()
    trial = lc.swim(
        "mamba", watching, duration, sensors=sensors, places=(PEN,), joints="servo", **changes
    )
    return trial, watching.observations


def test_readings_are_in_observations_and_in_the_log():
    trial, observations = watch(SENSORS)
    heading = observations[-1].readings["compass"].values[0]
    assert trial.signals["compass_heading"][-1] == heading
    assert np.isnan(trial.signals["sonar_range_0"]).any()
    ranges = observations[-1].readings["sonar"].values
    to_net = surroundings_of((PEN,)).distances(observations[-1].head.position[np.newaxis])
    assert np.nanmin(ranges) == pytest.approx(to_net[0], abs=0.1)


def test_both_models_tell_the_same_motion_of_the_head():
    pytest.importorskip("mujoco")
    _, in_plane = watch(SENSORS)
    _, in_space = watch(SENSORS, model="spatial")
    for one, other in zip(in_plane, in_space, strict=True):
        assert one.head.position[:2] == pytest.approx(other.head.position[:2], abs=1e-3)
        assert one.head.axes == pytest.approx(other.head.axes, abs=1e-3)
        assert one.head.velocity[:2] == pytest.approx(other.head.velocity[:2], abs=5e-3)
        assert one.head.turn_rate == pytest.approx(other.head.turn_rate, abs=2e-2)
        assert one.energy == pytest.approx(other.energy, abs=0.5)


def test_the_velocity_of_the_head_is_the_derivative_of_its_position():
    _, observations = watch(SENSORS)
    before, now, after = observations[10:13]
    mean = (after.head.position - before.head.position) / (after.time - before.time)
    assert now.head.velocity == pytest.approx(mean, abs=0.02)


def test_a_reading_is_as_old_as_the_latency_says():
    _, observations = watch((Compass(rate=10.0, latency=0.3),))
    assert observations[2].readings["compass"].time == -math.inf
    assert np.isnan(observations[2].readings["compass"].values).all()
    for observation in observations[3:]:
        reading = observation.readings["compass"]
        assert reading.is_new
        assert observation.time - reading.time == pytest.approx(0.3)


def test_a_slow_sensor_keeps_its_last_reading():
    _, observations = watch((Compass(rate=2.0),))
    new = [
        observation.time for observation in observations if observation.readings["compass"].is_new
    ]
    assert new == pytest.approx(np.arange(0.0, 3.0, 0.5))


def test_losses_come_as_often_as_stated():
    _, observations = watch((Compass(dropout=0.3, seed=1),), duration=100.0)
    n_new = sum(observation.readings["compass"].is_new for observation in observations)
    assert n_new / len(observations) == pytest.approx(0.7, abs=0.05)


@pytest.mark.parametrize("kind", ["silent", "frozen", "biased"])
def test_a_fault_lasts_as_long_as_stated(kind):
    fault = SensorFault(begin=1.0, end=2.0, kind=kind, bias=10.0)
    _, observations = watch((Compass(faults=(fault,)),))
    readings = [observation.readings["compass"] for observation in observations]
    during = readings[10:20]
    if kind == "silent":
        assert not any(reading.is_new for reading in during)
    elif kind == "frozen":
        assert {reading.values[0] for reading in during} == {readings[9].values[0]}
    else:
        assert all(reading.values[0] > 5.0 for reading in during)
    assert abs(readings[25].values[0]) < 1.5


def test_the_same_scenario_gives_the_same_readings_again_and_after_storing(tmp_path):
    trial = lc.swim("mamba", _following(), 3.0, sensors=SENSORS, places=(PEN,), joints="servo")
    trial.save(tmp_path / "trial.nc")
    stored = lc.load_trial(tmp_path / "trial.nc")
    assert stored.equals(trial)
    again = lc.swim(stored.scenario)
    for name, values in trial.signals.items():
        assert np.array_equal(values, again.signals[name], equal_nan=True), name


def test_other_seeds_give_other_noise():
    first, _ = watch((Compass(seed=1),))
    second, _ = watch((Compass(seed=2),))
    assert np.std(first.signals["compass_heading"] - second.signals["compass_heading"]) > 0.005


def test_two_sensors_of_one_name_are_refused():
    with pytest.raises(
        ValueError, match="`sensors` must have different names, got `compass` twice"
    ):
        lc.Planar(sensors=(Compass(), Compass()))


def test_a_controller_sees_the_same_in_lanes_as_alone():
    alone, observations = watch(SENSORS)
    controllers = [Watching() for _ in range(3)]
    scenarios = [
        lc.build_scenario("mamba", each, 3.0, sensors=SENSORS, places=(PEN,), joints="servo")
        for each in controllers
    ]
    lc.swim_many(scenarios)
    for each in controllers:
        for seen, expected in zip(each.observations, observations, strict=True):
            for name, reading in expected.readings.items():
                assert np.array_equal(seen.readings[name].values, reading.values, equal_nan=True)
    assert alone.succeeded


def _following():
    return lc.PathFollowing(
        gait=GAIT,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        heading=lc.HeadingController(gain=0.4, max_offset_deg=20),
    )


def test_every_sensor_has_the_noise_that_it_states():
    beacon = AcousticPosition(rate=10.0, beacon=(3.0, 4.0, 0.0))
    sensors = (
        beacon,
        DopplerVelocity(rate=10.0),
        InertialUnit(rate=10.0),
        BatteryGauge(rate=10.0),
        DepthGauge(),
        Compass(),
    )
    noisy, _ = watch(sensors, duration=60.0)
    quiet = tuple(
        replace(sensor, **{name: 0.0 for name in vars(sensor) if name.endswith("noise")})
        for sensor in sensors
    )
    true, _ = watch(quiet, duration=60.0)
    stated = {
        "beacon_range": 0.05,
        "beacon_bearing": math.radians(1.0),
        "velocity_left": 0.01,
        "inertial_turn_z": 0.005,
        "inertial_acceleration_x": 0.05,
        "battery_left": 0.002,
        "depth_depth": 0.01,
        "compass_heading": math.radians(1.0),
    }
    for name, deviation in stated.items():
        difference = (noisy.signals[name] - true.signals[name])[:-1:2]
        n = len(difference)
        assert np.std(difference) == pytest.approx(deviation, rel=4.0 / math.sqrt(2.0 * n)), name
        assert abs(np.mean(difference)) < 4.0 * deviation / math.sqrt(n), name


def test_a_beacon_is_where_range_and_bearing_point():
    sensor = AcousticPosition(rate=10.0, beacon=(3.0, 4.0, 0.0), range_noise=0.0, angle_noise=0.0)
    _, observations = watch((sensor,))
    head = observations[-1].head
    distance, bearing, elevation = observations[-1].readings["beacon"].values
    direction = head.axes @ (math.cos(bearing), math.sin(bearing), 0.0)
    assert head.position + distance * direction == pytest.approx((3.0, 4.0, 0.0), abs=1e-9)
    assert elevation == pytest.approx(0.0)


def test_a_beacon_out_of_range_is_not_heard():
    _, observations = watch((AcousticPosition(beacon=(200.0, 0.0, 0.0)),))
    assert np.isnan(observations[-1].readings["beacon"].values).all()


def test_the_velocity_through_water_lacks_the_current():
    sensors = (
        DopplerVelocity(noise=0.0),
        DopplerVelocity(noise=0.0, name="through_water", through_water=True),
    )
    _, observations = watch(sensors, current=(0.1, -0.2))
    readings = observations[-1].readings
    difference = readings["velocity"].values - readings["through_water"].values
    measured_at = [o for o in observations if o.time == pytest.approx(readings["velocity"].time)]
    assert measured_at[0].head.axes @ difference == pytest.approx((0.1, -0.2, 0.0))


def test_an_inertial_unit_adds_up_to_the_change_of_velocity():
    _, observations = watch((InertialUnit(rate=10.0, acceleration_noise=0.0, turn_noise=0.0),))
    for before, now in itertools.pairwise(observations):
        felt = now.readings["inertial"].values[3:]
        acceleration = now.head.axes @ felt - (0.0, 0.0, 9.81)
        change = (now.head.velocity - before.head.velocity) / (now.time - before.time)
        assert acceleration == pytest.approx(change, abs=1e-9)


def test_an_altimeter_measures_to_the_bed_and_a_contact_sensor_what_touches():
    pytest.importorskip("mujoco")
    watching = Watching()
    lc.swim(
        "mamba",
        watching,
        4.0,
        model="spatial",
        joints="servo",
        sensors=(Altimeter(noise=0.0), ContactSensor(noise=0.0)),
        places=(Seabed(depth=2.0), Wall(name="quay", begin=(1.0, -2.0), end=(1.0, 2.0))),
    )
    first, last = watching.observations[0], watching.observations[-1]
    height = first.readings["altimeter"].values[0]
    assert height == pytest.approx(2.0 + first.head.position[2], abs=1e-6)
    assert first.readings["contact"].values[0] == 0.0
    assert max(o.readings["contact"].values[0] for o in watching.observations) > 0.2
    assert last.readings["contact"].time == pytest.approx(last.time)


@pytest.mark.parametrize("name", ["", "a b", "north-compass", "2nd"])
def test_a_name_that_no_column_of_a_log_can_begin_with_is_refused_before_the_run(name):
    with pytest.raises(ValueError, match=rf"`sensors\[1\].name` must consist of letters.*'{name}'"):
        lc.Planar(sensors=(DepthGauge(), Compass(name=name)))
