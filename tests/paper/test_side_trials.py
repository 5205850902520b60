from dataclasses import replace
from math import degrees

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import SideSettings, run_side_trials


@pytest.fixture(scope="module")
def side():
    settings = SideSettings()
    return run_side_trials(
        replace(settings, phase_shifts=replace(settings.phase_shifts, step=5 * settings.phase_shifts.step))
    )


def test_the_sweep_has_pd_joints_and_the_papers_coefficients(side):
    values = side.settings.phase_shifts.values
    gait = side.settings.phase_shifts.gait("lateral_undulation", values[2])
    trial = lc.swim(lc.load_robot("mamba"), gait, 30.0, joints="pd")
    assert side.pd_velocity[2] == trial.forward_velocity
    assert side.pd_optimum == values[np.argmax(side.pd_velocity)]
    assert degrees(side.pd_optimum) == pytest.approx(25.0, abs=2.5)


def test_sensitivities_are_taken_at_the_fastest_gait_of_table_1(side):
    assert [(gait.kind, round(degrees(gait.frequency))) for gait in side.settings.gaits] == [
        ("lateral_undulation", 150),
        ("eel_like", 150),
    ]
    gait = side.settings.gaits[0]
    deep, shallow = (
        lc.swim(lc.load_robot("mamba"), gait, environment=replace(lc.load_water("paper-lateral"), depth=depth))
        for depth in (None, 0.06)
    )
    expected = 100.0 * (shallow.forward_velocity / deep.forward_velocity - 1.0)
    assert side.by_depth["lateral_undulation"] == pytest.approx(expected)


def test_the_added_inertia_is_of_no_effect(side):
    assert all(abs(change) < 1e-3 for change in side.by_added_inertia.values())
    assert any(change != 0.0 for change in side.by_added_inertia.values())
