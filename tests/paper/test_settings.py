from dataclasses import replace
from math import radians

import numpy as np
import pytest

from laticauda.paper import PARAMETERS, load_efficiency_settings
from laticauda.paper.measured import find_measured_trial, read_efficiency_trials

SETTINGS = load_efficiency_settings()


def test_the_groups_hold_every_measured_trial_of_table_1_once():
    found = [
        find_measured_trial(row.gait, group.has_fin)
        for group in SETTINGS.groups
        for row in group.cases
    ]
    assert len(found) == 22
    assert [trial for trial in found if trial is not None] == list(read_efficiency_trials())


@pytest.mark.parametrize("group", SETTINGS.groups, ids=lambda group: group.name)
def test_every_group_stars_one_case_per_parameter_and_it_is_the_fastest_measured_on_that_sweep(
    group,
):
    stars = {row.starred: row for row in group.cases if row.starred}
    assert set(stars) == set(PARAMETERS)
    assert (
        sum(row.starred is not None for row in group.cases)
        == sum(row.is_maximum for row in group.cases)
        == 3
    )
    for sweep in SETTINGS.sweeps:
        on_sweep = [row for row in group.cases if sweep.contains(row.gait)]
        speeds = {
            row.case: row.forward_velocity for row in on_sweep if row.forward_velocity is not None
        }
        assert max(speeds, key=lambda case: speeds[case]) == stars[sweep.parameter].case


def test_every_figure_from_4_to_11_has_one_place():
    numbers = [number for group in SETTINGS.groups for number in group.figures]
    assert sorted(numbers) == list(range(4, 12))


@pytest.mark.parametrize("sweep", SETTINGS.sweeps, ids=lambda sweep: sweep.parameter)
def test_a_sweep_meets_both_ends_of_its_range_and_every_whole_setting_of_the_table(sweep):
    values = sweep.values
    assert values[0] == sweep.low
    assert values[-1] == pytest.approx(sweep.high, abs=1e-12)
    assert np.all(np.diff(values) > 0.0)
    for group in SETTINGS.groups:
        for row in group.cases:
            if sweep.contains(row.gait):
                assert np.min(np.abs(values - getattr(row.gait, sweep.parameter))) < 1e-9


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"step": 0.0}, "`step` must be > 0 rad, got 0.0"),
        ({"low": 2.0, "high": 1.0}, "`low` must be > 0 and <= `high`, got 2.0 and 1.0"),
        ({"parameter": "amplitud"}, "did you mean `amplitude`"),
        ({"fixed": {"frequency": 1.0}}, "`fixed` must hold the parameters that are not swept"),
    ],
)
def test_a_sweep_that_makes_no_sense_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(SETTINGS.sweeps[0], **change)


def test_a_study_without_models_or_time_is_refused():
    with pytest.raises(ValueError, match="`models` must hold at least one entry"):
        replace(SETTINGS, models=())
    with pytest.raises(ValueError, match="`duration` must be > 0 s, got -1"):
        replace(SETTINGS, duration=-1.0)


def test_the_range_of_a_sweep_need_not_be_a_multiple_of_its_step():
    sweep = replace(SETTINGS.sweeps[0], low=radians(10), high=radians(14.9), step=radians(2))
    assert np.degrees(sweep.values) == pytest.approx([10, 12, 14])
