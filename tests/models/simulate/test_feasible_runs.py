"""A run that the robot cannot do: said once in Python, whatever is done with its figures."""

import warnings

import pytest

import laticauda as lc

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
EASY = lc.lateral_undulation(amplitude_deg=10, frequency_deg_s=30, phase_shift_deg=60)


def test_a_run_that_the_robot_cannot_do_warns_with_where_to_read_why():
    with pytest.warns(
        lc.InfeasibleWarning, match="mamba-fin cannot do this: see `trial.feas"
    ) as seen:
        trial = lc.swim("mamba-fin", GAIT, 8.0)
    assert [warning.filename for warning in seen] == [__file__]
    assert "The robot cannot do it: joint" in repr(trial)


def test_many_gaits_of_a_robot_warn_once():
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("default")
        for _ in range(3):
            lc.swim("mamba-fin", GAIT, 8.0)
    assert len(seen) == 1


@pytest.mark.parametrize(
    ("gait", "changes"),
    [
        (EASY, {"environment": "paper-lateral"}),
        (GAIT, {"joints": "servo"}),
        (GAIT, {"parameters": "mamba-identified"}),
    ],
)
def test_a_run_that_the_robot_can_do_warns_of_nothing(gait, changes):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trial = lc.swim("mamba-fin", gait, 8.0, **changes)
    assert not trial.feasibility.problems
    assert "cannot" not in repr(trial)


def test_a_robot_whose_motor_is_not_stated_is_not_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lc.swim("amphibot", GAIT, 8.0)
