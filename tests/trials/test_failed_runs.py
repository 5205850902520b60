"""A run that failed gives no figure, by whatever door one asks."""

import dataclasses
import inspect
import json
import math
from typing import Any

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect.session import Session
from laticauda.control.averaged_fit import fit_averaged
from laticauda.identify import from_trial
from laticauda.models.simulate import figure_intervals, swim_many
from laticauda.scenarios import limit_case
from laticauda.trials import FIGURES, following
from laticauda.values import RunFailed

SLOW = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
GAIT = dataclasses.replace(SLOW, frequency=130.0)
"""Meant in deg/s; at 130 rad/s, the run diverges."""


@pytest.fixture(scope="module")
def diverged() -> lc.Trial:
    with limit_case():
        trial = lc.swim("mamba", GAIT, 5.0)
    assert not trial.succeeded and trial.time.size > 2
    return trial


def test_every_figure_of_a_diverged_run_raises_the_sentence_of_its_status(diverged: lc.Trial):
    sentence = f"A run that failed has no figures: {diverged.status}"
    for figure in FIGURES:
        with pytest.raises(RunFailed) as refusal:
            getattr(diverged, figure.name)
        assert str(refusal.value) == sentence
    values, reasons = diverged.figures()
    assert set(values.values()) == {None}
    assert set(reasons.values()) == {sentence}


def test_no_public_number_of_a_diverged_run_can_be_read_but_by_its_series(diverged: lc.Trial):
    properties = [name for name, _ in inspect.getmembers(lc.Trial, inspect.isdatadescriptor)]
    for name in (*properties, *(figure.name for figure in FIGURES)):
        if name.startswith("_") or name == "period":  # of the gait
            continue
        try:
            value = getattr(diverged, name)
        except RunFailed:
            continue
        assert not isinstance(value, float), name


def test_what_a_diverged_run_logged_stays_readable(diverged: lc.Trial):
    assert np.all(np.isfinite(diverged.center_of_mass))
    assert np.linalg.norm(diverged.center_of_mass_velocity[-1]) > 0.0
    assert diverged.feasibility.problems
    assert repr(diverged).endswith(f"; FAILED: {diverged.status}>")
    html = diverged._repr_html_()
    assert "<th>FAILED</th>" in html.replace(' style="text-align:left"', "")
    assert "m/s" not in html.split("<table>")[1]
    copy = dataclasses.replace(diverged, succeeded=True)
    assert math.isfinite(copy.forward_velocity)  # for those who insist


def test_a_diverged_run_identifies_nothing(diverged: lc.Trial):
    with pytest.raises(RunFailed, match="A run that failed has no figures: The run diverged at"):
        from_trial(diverged, name="run", series={"center_of_mass": 0.005})
    with pytest.raises(ValueError, match=r"`trials\[0\]` must not be of a run that failed: The"):
        fit_averaged([diverged])
    with pytest.raises(RunFailed, match="The run diverged at"):
        figure_intervals(diverged)


def test_a_failed_run_along_a_path_has_no_figures_of_following():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    whole = lc.swim("mamba", lc.control.Following().controller(gait), 20.0)
    failed = dataclasses.replace(whole, succeeded=False, status="It was cut.")
    assert set(following.summarize_following(failed).values()) == {None}
    assert following.summarize_following(whole)["saturated_share"] is not None


def test_a_comparison_says_which_trial_failed_and_in_what_else_the_trials_differ(
    diverged: lc.Trial,
):
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    found = lc.compare(lc.swim("mamba-fin", gait, 2.0), diverged)
    assert all(row.values[1] is None for row in found)
    assert found.notes == (
        f"FAILED: trial 1 has no figures. {diverged.status}",
        "Different robots: trial 0 mamba-fin; trial 1 mamba.",
        "Different gaits: trial 0 lateral undulation 28.65 deg, 131.8 deg/s, 40.11 deg; "
        "trial 1 eel-like motion 28.65 deg, 7448 deg/s, 40.11 deg.",
        "Different surroundings: trial 0 paper-lateral; trial 1 paper-eel.",
        "Different durations: trial 0 2 s; trial 1 0.6 s.",
    )
    assert repr(found).startswith("FAILED: trial 1 has no figures.")
    same = lc.swim("mamba-fin", gait, 2.0)
    assert lc.compare(same, same).notes == ()
    lighter = dataclasses.replace(same.robot, modules=same.robot.modules[:1] * 9)
    heavier = [dataclasses.replace(module, mass=1.0) for module in lighter.modules]
    other = lc.swim(dataclasses.replace(lighter, modules=tuple(heavier)), gait, 2.0)
    assert lc.compare(same, other).notes == (
        "Different robots: each is mamba-fin, but with other numbers.",
    )


def test_a_server_answers_a_diverged_run_with_its_status_and_no_number():
    request = {
        "do": "run",
        "robot": "mamba",
        "gait": {"kind": "eel_like", "amplitude": 0.5, "frequency": 130.0, "phase_shift": 0.7},
        "duration": 5.0,
    }
    figures = json.loads(Session().answer(json.dumps(request).encode()))["figures"]
    assert not figures["succeeded"] and figures["status"].startswith("The run diverged at")
    assert [figures[figure.name] for figure in FIGURES] == [None] * len(FIGURES)


@pytest.mark.usefixtures("limit_case")
@pytest.mark.filterwarnings("ignore:`timestep`")
@pytest.mark.parametrize("changes", [{}, {"model": "spatial", "dt": 0.02}])
def test_a_batch_has_nan_and_the_status_where_a_run_diverged(changes: dict[str, Any]):
    good = lc.build_scenario("mamba", SLOW, 2.0, **changes)
    syrup = dataclasses.replace(good.environment, normal_drag=1e5)
    bad = dataclasses.replace(good, environment=syrup)
    if not changes:
        bad = dataclasses.replace(good, motion=GAIT)
    found = swim_many([good, bad])
    assert found.succeeded.tolist() == [True, False]
    assert found.status[1].startswith("The run diverged at")
    for name, values in vars(found).items():
        if name not in ("succeeded", "status") and values is not None:
            assert np.all(np.isnan(values[1])), name
    assert np.isfinite(found.forward_velocity[0])
