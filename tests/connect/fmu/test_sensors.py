"""Sensors of a scenario as outputs of its FMU: the values that they tell in Python, without noise."""

import math

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect.native.tables import build_tables_of_scenario
from laticauda.models.simulate import build_plant
from laticauda.models.simulate.numbers import change_parameters
from laticauda.scenarios import Command, Start
from laticauda.sensing import (
    AcousticPosition,
    BatteryGauge,
    Compass,
    DepthGauge,
    DopplerVelocity,
    InertialUnit,
    Sonar,
    senses_of,
    signals_of_readings,
)

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
SENSORS = (
    Compass(noise=0.0, bias=0.1),
    DepthGauge(noise=0.0),
    DopplerVelocity(noise=0.0),
    AcousticPosition(beacon=(3.0, -4.0, 2.0), range_noise=0.0, angle_noise=0.0),
    AcousticPosition(name="far", beacon=(200.0, 0.0, 0.0)),
    InertialUnit(turn_noise=0.0, turn_bias=0.02),
)
START = Start(center_of_mass=(1.0, -2.0), heading=0.7, velocity=0.1)


@pytest.mark.filterwarnings("ignore:there are no outputs")
@pytest.mark.parametrize(
    "changes", [{}, {"robot.module[7].length": 0.3, "robot.module[2].mass": 2.0}]
)
def test_sensors_tell_in_an_fmu_what_they_tell_in_python(make, slave, changes):
    model = lc.Planar(sensors=SENSORS)
    opened = slave(make("mamba-fin", GAIT, model=model, start=START)).begin(**changes)
    opened.steps([0.1] * 10)
    scenario = lc.build_scenario("mamba-fin", GAIT, 1.0, model=model, start=START)
    plant = build_plant(change_parameters(scenario, changes))
    command = Command(gait=GAIT)
    state = plant.advance(plant.init(START, command), command, 1.0, 0.1).state
    senses = senses_of(model, plant.environment)
    expected = signals_of_readings(SENSORS, senses.read(plant.observe(state)))
    names = [name for name in expected if not name.startswith("inertial_acceleration")]
    told = opened.get(*names)
    np.testing.assert_allclose(told, [expected[name] for name in names], atol=1e-9)
    assert math.isnan(expected["far_range"])


def test_values_that_c_code_cannot_compute_are_named():
    sensors = (Compass(), Sonar(beams=(0.0,)), BatteryGauge(), InertialUnit())
    message = (
        "there are no outputs for sonar_range_0, battery_left, inertial_acceleration_x, .*: C code"
    )
    with pytest.warns(UserWarning, match=message):
        tables = build_tables_of_scenario("mamba", GAIT, model=lc.Planar(sensors=sensors))
    names = [variable.name for variable in tables.variables]
    assert names[-4:] == [
        "compass_heading",
        "inertial_turn_x",
        "inertial_turn_y",
        "inertial_turn_z",
    ]
