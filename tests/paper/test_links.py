import math
from dataclasses import replace
from unittest.mock import Mock

import pytest

import laticauda as lc
from laticauda.paper import Coefficients, LinksSettings, run_links
from laticauda.trial import Trial


@pytest.fixture(scope="module")
def links():
    return run_links()


def test_every_run_is_what_swim_gives_for_that_many_links(links):
    assert len(links.doublings) == 4
    for doubling in links.doublings:
        assert (doubling.shorter.robot.n_links, doubling.longer.robot.n_links) == (10, 20)
        for run in (doubling.shorter, doubling.longer):
            n_links = run.robot.n_links
            trial = lc.swim(lc.load_robot("mamba", n_links=n_links), run.gait, 30.0)
            assert run.forward_velocity == trial.forward_velocity
            assert run.mechanical_power == trial.mechanical_power
            assert run.robot.length == pytest.approx(0.18 * n_links)


def test_what_is_kept_is_the_phase_shift_or_the_number_of_waves(links):
    for doubling in links.doublings:
        ratio = doubling.longer.gait.phase_shift / doubling.shorter.gait.phase_shift
        assert ratio == pytest.approx(1.0 if doubling.kept == "phase shift" else 0.5)
        assert doubling.longer.gait.amplitude == doubling.shorter.gait.amplitude


def test_changes_are_those_of_speed_and_power(links):
    one = links.doublings[0]
    speed, power = one.shorter.forward_velocity, one.shorter.mechanical_power
    twice = replace(one, longer=Mock(spec=Trial, forward_velocity=2 * speed, mechanical_power=5 * power))
    assert twice.velocity_change == pytest.approx(100.0)
    assert twice.power_factor == pytest.approx(5.0)


def test_joints_water_and_progress_reach_the_runs():
    told: list[tuple[int, int]] = []
    waters = Coefficients(
        name="mine", title="mine", waters={"eel_like": replace(lc.load_water("paper-eel"), density=900)}
    )
    settings = LinksSettings(n_links=(3, 4), gaits=("eel_like",), duration=20.0, coefficients=waters)
    study = run_links(settings, joints="pd", progress=lambda *what: told.append(what))
    assert study.how["joints"] == "pd"
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    shorter = study.doublings[0].shorter
    water = waters.water("eel_like")
    trial = lc.swim(lc.load_robot("mamba", n_links=3), shorter.gait, 20.0, environment=water, joints="pd")
    assert shorter.forward_velocity == trial.forward_velocity


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"n_links": (20, 10)}, r"`n_links` must be two rising numbers, got \(20, 10\)"),
        ({"n_links": (1, 10)}, r"`n_links\[0\]` must be a whole number >= 2, got 1"),
        ({"duration": 0}, "`duration` must be > 0 s, got 0"),
    ],
)
def test_settings_that_make_no_sense_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        LinksSettings(**change)


def test_other_names_of_what_is_kept_are_refused():
    with pytest.raises(ValueError, match="`kept` must be one of `phase shift`, `number of waves`, got 'waves'"):
        LinksSettings().gait("eel_like", 20, "waves")
    assert LinksSettings().gait("eel_like", 20, "number of waves").phase_shift == pytest.approx(math.radians(20))
