import dataclasses
import json

import numpy as np
import pytest

import laticauda as lc
from laticauda.trials import FIGURES, Trial


def test_every_figure_is_a_documented_property_with_its_unit():
    for figure in FIGURES:
        text = getattr(Trial, figure.name).__doc__
        assert f"[{figure.unit or '-'}]" in text.splitlines()[0], figure.name


def test_a_summary_is_json_and_holds_every_figure_in_order(make_trial):
    summary = make_trial().summary()
    assert json.loads(json.dumps(summary, allow_nan=False)) == summary
    names = list(summary)
    assert names[:6] == ["status", "succeeded", "robot", "gait", "environment", "mean_power_kind"]
    assert names[6:-1] == [figure.name for figure in FIGURES]
    assert summary["forward_velocity"] == pytest.approx(0.15)
    assert list(summary["not_available"]) == ["electrical_power", "total_power"]


def test_a_short_run_leaves_out_what_it_cannot_know_and_says_why(make_trial):
    summary = make_trial(duration=2.0).summary()
    assert summary["forward_velocity"] == pytest.approx(0.15)
    assert summary["steady_velocity"] is None
    assert "must span at least 12.5 s" in summary["not_available"]["steady_velocity"]


def test_a_run_that_failed_at_once_has_a_summary_too(make_trial):
    summary = make_trial(
        duration=0.0, succeeded=False, status="It blew up at 0 s. Try smaller gains."
    ).summary()
    assert summary["succeeded"] is False
    assert summary["forward_velocity"] is None
    assert summary["not_available"]["forward_velocity"] == (
        "A run that failed has no figures: It blew up at 0 s. Try smaller gains."
    )
    json.dumps(summary, allow_nan=False)


def test_a_figure_that_is_not_finite_is_none_and_its_reason_stands_beside_it(make_trial):
    summary = make_trial(speed=1e200).summary()
    assert summary["path_speed"] is None
    assert "`path_speed` must be a finite number" in summary["not_available"]["path_speed"]
    json.dumps(summary, allow_nan=False)


def plain(thing):
    return thing._repr_html_().replace(' style="text-align:left"', "")


def test_a_notebook_shows_a_trial_with_its_figures_in_words():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    trial = lc.swim("mamba", gait, 5.0)
    assert f", {trial.forward_velocity:.3g} m/s; " in repr(trial)
    shown = plain(trial)
    assert shown.startswith('<img alt="Trial of mamba: lateral_undulation, 5 s in 101 samples')
    assert shown.count("<table>") == 1 and len(shown) < 60_000
    assert f"<th>path length over time</th><td>{trial.path_speed:.4g} m/s</td>" in shown
    assert (
        f"<th>largest joint angle, first cycle left out</th><td>{np.degrees(trial.peak_joint_angle):.4g} deg</td>"
        in shown
    )
    for one in (trial.robot, trial.gait, trial.scenario):
        assert one._repr_html_().startswith("<table><caption>")
    assert "<th>amplitude</th><td>28.6479 deg</td>" in plain(trial.gait)
    assert "<th>robot</th><td>mamba: 9 links" in plain(trial.scenario)
    assert "<th>modules 0-8</th><td>length 0.18 m, mass 0.8 kg" in plain(trial.robot)
    assert "<th>joints 0-7</th><td>limit 90 deg</td>" in plain(trial.robot)
    assert "<th>actuators 0-7</th><td>proportional_gain 20 N m/rad" in plain(trial.robot)
    assert len(repr(trial.robot).splitlines()) == 1 and len(repr(trial.robot)) < 100
    assert repr(trial.scenario) == (
        "<Scenario of mamba: lateral undulation 28.65 deg, 131.8 deg/s, 40.11 deg, 5 s in paper-lateral, "
        "planar model, prescribed joints>"
    )
    long_name = dataclasses.replace(trial.robot, name="mamba " * 100)
    assert len(repr(dataclasses.replace(trial.scenario, robot=long_name))) <= 200
