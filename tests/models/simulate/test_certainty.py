"""How far a run's figures go as far as its coefficients may."""

from dataclasses import replace

import pytest

import laticauda as lc
from laticauda.models.simulate import figure_intervals, intervals_of
from laticauda.robot import textbook_water

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)


@pytest.fixture(scope="module")
def trial():
    return lc.swim(lc.load_robot("chain", n_links=5), GAIT, 6.0)


def test_the_figures_lie_in_their_interval(trial):
    low, high = figure_intervals(trial)["forward_velocity"]
    assert low < trial.forward_velocity < high
    assert high - low < 0.5 * trial.forward_velocity


def test_each_number_adds_to_it_in_quadrature(trial):
    every = intervals_of(trial.scenario)
    alone = [
        figure_intervals(trial, {name: pair})["forward_velocity"] for name, pair in every.items()
    ]
    low, high = figure_intervals(trial, every)["forward_velocity"]
    v = trial.forward_velocity
    assert (v - low) ** 2 == pytest.approx(sum((v - one) ** 2 for one, _ in alone))
    assert (high - v) ** 2 == pytest.approx(sum((one - v) ** 2 for _, one in alone))


def test_without_an_interval_there_is_none(trial):
    number = trial.environment.normal_drag
    assert (
        figure_intervals(trial, {"water.normal_drag": (number, number)})["forward_velocity"]
        == (trial.forward_velocity,) * 2
    )


def test_a_number_that_somebody_has_changed_is_known(trial):
    measured = replace(trial.environment, tangential_friction=0.05)
    assert "water.tangential_friction" not in intervals_of(
        replace(trial.scenario, environment=measured)
    )
    assert intervals_of(trial.scenario) == textbook_water(trial.robot).intervals


def test_water_that_is_not_the_textbooks_has_no_intervals():
    with pytest.raises(ValueError, match=r"`water` must be the textbook's, .* got 'paper-lateral'"):
        intervals_of(lc.build_scenario("mamba", GAIT))
