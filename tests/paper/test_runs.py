from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate.runner import silent
from laticauda.paper import Coefficients, load_path_following_settings
from laticauda.paper.runs import NamedScenario, Runs
from laticauda.paper.settings import load_paper_coefficients
from laticauda.scenarios import Planar, model_of
from laticauda.values.errors import SimulationFailed

LATERAL = load_path_following_settings().groups[0].path_following_cases[0].gait
EEL = load_path_following_settings().groups[2].path_following_cases[0].gait


def swimmers(coefficients: Coefficients | None = None) -> list[lc.Scenario]:
    chosen = load_paper_coefficients() if coefficients is None else coefficients
    return [
        chosen.build_scenario(robot, gait)
        for gait in (LATERAL, EEL)
        for robot in ("mamba", "mamba-fin")
    ]


def test_coefficients_are_a_water_by_gait():
    assert [one.robot.name for one in swimmers()] == ["mamba", "mamba-fin", "mamba", "mamba-fin"]
    assert [one.environment.name for one in swimmers()] == ["paper-lateral"] * 2 + ["paper-eel"] * 2


def test_other_coefficients_reach_the_water():
    waters = {"lateral_undulation": "paper-vortex", "eel_like": "published-2015"}
    found = swimmers(Coefficients(name="other", title="other", waters=waters))
    assert [one.environment.name for one in found] == ["paper-vortex"] * 2 + ["published-2015"] * 2


def test_a_swimmer_is_a_scenario_that_swim_knows():
    swimmer = replace(swimmers()[0], duration=2.0, model=Planar(offset_bandwidth=4.0))
    trial = Runs(model=Planar(), progress=silent).swim("this one", swimmer)
    assert np.array_equal(trial.center_of_mass, lc.swim(swimmer).center_of_mass)
    assert trial.scenario.model.offset_bandwidth == 4.0


@pytest.mark.usefixtures("limit_case")
def test_a_run_that_blows_up_is_named():
    swimmer = replace(
        swimmers()[0], motion=replace(swimmers()[0].gait, frequency=1e9), duration=3.0
    )
    with pytest.raises(SimulationFailed, match=r"^this one: "):
        Runs(model=Planar(), progress=silent).swim("this one", swimmer)


def test_how_runs_were_made_leaves_the_controller_out_and_all_are_counted():
    told = []
    runs = Runs(model=Planar(), n_runs=2, progress=lambda *what: told.append(what))
    for swimmer in swimmers()[:2]:
        runs.swim("one", replace(swimmer, duration=0.5, model=model_of("planar", joints="pd")))
    assert set(runs.trial_settings) == {
        "model",
        "joints",
        "dt",
        "offset_bandwidth",
        "loop_delay",
        "ramp",
    }
    assert runs.trial_settings["joints"] == "pd"
    assert told == [(1, 2), (2, 2)]


@pytest.mark.usefixtures("limit_case")
def test_a_run_of_many_that_blows_up_is_named():
    swimmer = replace(swimmers()[0], duration=20.0)
    hopeless = replace(swimmer, motion=replace(swimmer.gait, frequency=1e9))
    tasks = [NamedScenario("this one", swimmer), NamedScenario("that one", hopeless)]
    with pytest.raises(SimulationFailed, match=r"^that one: "):
        Runs(model=Planar(), progress=silent).swim_many(tasks)


def test_a_run_of_many_that_is_too_short_for_a_steady_part_is_refused():
    short = replace(swimmers()[0], duration=2.0)
    with pytest.raises(ValueError, match="`time` must span at least"):
        Runs(model=Planar(), progress=silent).swim_many([NamedScenario("this one", short)])
