from dataclasses import replace
from math import radians

import numpy as np
import pytest

import laticauda as lc
from laticauda.errors import SimulationFailed
from laticauda.paper import Coefficients, swimmers
from laticauda.paper.runs import Runs, long_enough
from laticauda.scenarios import Planar, model_of


def test_the_swimmers_are_those_of_table_2():
    found = swimmers()
    assert [one.name for one in found] == [
        "lateral undulation, without fin",
        "lateral undulation, with fin",
        "eel-like motion, without fin",
        "eel-like motion, with fin",
    ]
    assert [one.robot.name for one in found] == ["mamba", "mamba-fin", "mamba", "mamba-fin"]
    assert [one.environment.name for one in found] == ["paper-lateral", "paper-lateral", "paper-eel", "paper-eel"]
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
    assert [one.environment.name for one in found] == ["paper-vortex"] * 2 + ["published-2015"] * 2


def test_a_swimmer_is_a_scenario_that_swim_knows():
    swimmer = replace(swimmers()[0], duration=2.0, model=Planar(offset_bandwidth=4.0))
    trial = Runs(model=Planar(), progress=None).swim("this one", swimmer)
    assert np.array_equal(trial.center_of_mass, lc.swim(swimmer).center_of_mass)
    assert trial.scenario.model.offset_bandwidth == 4.0


def test_a_run_that_blows_up_is_named():
    swimmer = replace(swimmers()[0], motion=replace(swimmers()[0].gait, frequency=1e9), duration=3.0)
    with pytest.raises(SimulationFailed, match=r"^this one: "):
        Runs(model=Planar(), progress=None).swim("this one", swimmer)


def test_how_runs_were_made_leaves_the_controller_out_and_all_are_counted():
    told = []
    runs = Runs(model=Planar(), n_runs=2, progress=lambda *what: told.append(what))
    for swimmer in swimmers()[:2]:
        runs.swim("one", replace(swimmer, duration=0.5, model=model_of("planar", joints="pd")))
    assert set(runs.how) == {"model", "joints", "dt", "offset_bandwidth", "loop_delay", "ramp"}
    assert runs.how["joints"] == "pd"
    assert told == [(1, 2), (2, 2)]


def test_a_duration_must_hold_its_cycles():
    slowest = swimmers()[0]  # its cycle takes 4 s
    assert long_enough("duration", 12.0, (slowest,), 3.0) == 12.0
    with pytest.raises(ValueError, match="`duration` must be between 12 and 100000 s, got 11"):
        long_enough("duration", 11.0, (slowest,), 3.0)
