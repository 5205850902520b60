from dataclasses import replace

import numpy as np
import pytest

from laticauda.paper import find_fin_gains, find_maxima


def test_there_are_12_maxima_and_each_is_that_of_its_sweep(study):
    found = find_maxima(study)
    assert len(found) == 12
    for entry in found:
        place = study.settings.groups.index(entry.group)
        (sweep,) = (sweep for sweep in study.sweeps if sweep.settings.parameter == entry.parameter)
        for i in range(len(study.models)):
            curve = sweep.forward_velocity[i, place]
            assert entry.simulated_velocity[i] == np.max(curve)
            assert curve[sweep.values == entry.simulated_at[i]] == [np.max(curve)]
            assert entry.at_the_end[i] == (
                entry.simulated_at[i] in (sweep.values[0], sweep.values[-1])
            )


def test_the_measured_maxima_are_those_that_the_paper_stars(study):
    stars = {
        (entry.group.name, entry.parameter): (
            round(np.degrees(entry.measured_at)),
            entry.measured_velocity,
        )
        for entry in find_maxima(study)
    }
    assert stars["lateral undulation, without fin", "amplitude"] == (36, 0.1361)
    assert stars["lateral undulation, without fin", "frequency"] == (130, 0.1514)
    assert stars["lateral undulation, with fin", "phase_shift"] == (20, 0.2654)
    assert stars["eel-like motion, with fin", "amplitude"] == (50, 0.2018)


def test_the_planar_model_is_faster_the_faster_it_undulates(study):
    over_frequency = [entry for entry in find_maxima(study) if entry.parameter == "frequency"]
    assert all(all(entry.at_the_end) for entry in over_frequency)


def test_the_fin_gains_follow_from_the_speeds_of_the_table(study):
    gains = find_fin_gains(study.cases)
    assert len(gains) == 11
    for gain in gains:
        before, after = gain.without.forward_velocity[0], gain.with_fin.forward_velocity[0]
        assert gain.without.measured.gait == gain.with_fin.measured.gait
        change = gain.simulated_change(lambda case: case.forward_velocity[0])
        assert before * (1.0 + change / 100.0) == pytest.approx(after)


def test_what_the_paper_prints_follows_from_its_table_but_for_one_misprint(study):
    changes = [gain.measured for gain in find_fin_gains(study.cases)]
    ((row, misprints),) = [
        (change.with_fin, change.misprints) for change in changes if change.misprints
    ]
    assert (row.group, row.case) == ("lateral undulation, with fin", 3)
    assert misprints == {"power": (10.11, pytest.approx(4.79, abs=0.005))}
    assert sum(change.velocity is not None for change in changes) == 9


def test_a_gain_without_a_measurement_is_missing_but_simulated(study):
    gait = study.cases[3].measured.gait
    (gain,) = (gain for gain in find_fin_gains(study.cases) if gain.with_fin.measured.gait == gait)
    assert gain.measured.velocity is None
    assert np.isfinite(gain.simulated_change(lambda case: case.forward_velocity[0]))


def test_a_sweep_whose_maximum_was_not_measured_has_no_entry(study):
    lost = tuple(
        replace(case, measured=replace(case.measured, forward_velocity=None))
        for case in study.cases
    )
    assert find_maxima(replace(study, cases=lost)) == ()
