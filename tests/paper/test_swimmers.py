from dataclasses import replace
from math import radians

import pytest

import laticauda as lc
from laticauda.errors import SimulationFailed
from laticauda.interfaces import Command
from laticauda.paper import Coefficients
from laticauda.paper.swimmers import how_made, in_water, long_enough, run_named, swimmers


def test_the_swimmers_are_those_of_table_2():
    found = swimmers()
    assert [one.name for one in found] == [
        "lateral undulation, without fin",
        "lateral undulation, with fin",
        "eel-like motion, without fin",
        "eel-like motion, with fin",
    ]
    assert [one.robot for one in found] == ["mamba", "mamba-fin", "mamba", "mamba-fin"]
    assert [one.water.name for one in found] == ["paper-lateral", "paper-lateral", "paper-eel", "paper-eel"]
    assert [round(one.gait.amplitude / radians(1), 6) for one in found] == [30, 30, 40, 40]
    assert {round(one.gait.frequency / radians(1), 6) for one in found} == {90}


def test_a_robots_length_holds_its_fin():
    without, with_fin = swimmers()[:2]
    fin = lc.load_robot("mamba-fin").caudal_fin
    assert fin is not None
    assert without.length == pytest.approx(18 * 0.09)
    assert with_fin.length == pytest.approx(without.length + fin.length)


def test_other_coefficients_reach_the_water():
    waters = {"lateral_undulation": "paper-vortex", "eel_like": "published-2015"}
    found = swimmers(Coefficients(name="other", title="other", waters=waters))
    assert [one.water.name for one in found] == ["paper-vortex"] * 2 + ["published-2015"] * 2


def test_the_current_reaches_the_water_and_nothing_else_changes():
    swimmer = swimmers()[0]
    body = in_water(swimmer, model="planar", joints="prescribed", offset_bandwidth=4.0, current=(0.1, 0.2))
    assert body.environment == replace(swimmer.water, current=(0.1, 0.2))
    assert body.settings.offset_bandwidth == 4.0


def test_a_run_that_blows_up_is_named():
    swimmer = replace(swimmers()[0], gait=replace(swimmers()[0].gait, frequency=1e9))
    body = in_water(swimmer, model="planar", joints="prescribed", offset_bandwidth=10.0)
    with pytest.raises(SimulationFailed, match=r"^this one: "):
        run_named("this one", body, lc.OpenLoop(command=Command(gait=swimmer.gait)), 3.0)


def test_how_a_run_was_made_leaves_the_controller_out():
    swimmer = swimmers()[0]
    body = in_water(swimmer, model="planar", joints="pd", offset_bandwidth=10.0)
    trial = run_named("one", body, lc.OpenLoop(command=Command(gait=swimmer.gait)), 0.5)
    assert set(how_made(trial)) == {"model", "joints", "dt", "offset_bandwidth", "ramp"}
    assert how_made(trial)["joints"] == "pd"


def test_a_duration_must_hold_its_cycles():
    gait = swimmers()[0].gait  # 4 s
    assert long_enough("duration", 12.0, (gait,), 3.0) == 12.0
    with pytest.raises(ValueError, match="`duration` must be between 12 and 100000 s, got 11"):
        long_enough("duration", 11.0, (gait,), 3.0)
