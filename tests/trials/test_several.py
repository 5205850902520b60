import dataclasses
import math

import numpy as np
import pytest

from laticauda.robot import load_robot
from laticauda.trials import Trial, compare, joined


def by_name(rows):
    return {row.figure.name: row for row in rows}


def test_differences_are_percent_of_the_first_trial(make_trial):
    rows = by_name(compare([make_trial(), make_trial(speed=0.18), make_trial(duration=2.0)]))
    assert rows["forward_velocity"].values == pytest.approx((0.15, 0.18, 0.15))
    assert rows["forward_velocity"].differences_percent == pytest.approx((0.0, 20.0, 0.0), abs=1e-9)
    assert rows["steady_velocity"].values[2] is None
    assert rows["steady_velocity"].differences_percent[2] is None


def test_a_figure_that_no_trial_has_is_left_out(make_trial):
    assert "electrical_power" not in by_name(compare([make_trial(), make_trial()]))


def test_angles_have_no_difference_in_percent(make_trial):
    rows = by_name(compare(make_trial(direction=0.1), make_trial(direction=0.2)))  # or a list
    assert rows["course"].values == pytest.approx((0.1, 0.2))
    assert rows["course"].differences == pytest.approx((0.0, 0.1))
    assert rows["course"].differences_percent == (None, None)


def test_the_difference_of_directions_goes_the_short_way_round(make_trial):
    rows = by_name(compare([make_trial(direction=3.1), make_trial(direction=-3.1)]))
    assert rows["course"].differences[1] == pytest.approx(2.0 * math.pi - 6.2)


@pytest.mark.parametrize("speed", [1e-9, 1e-3])
def test_beside_next_to_nothing_a_difference_has_no_percent(make_trial, speed):
    rows = by_name(compare([make_trial(speed=speed), make_trial()]))
    assert rows["forward_velocity"].differences_percent == (None if speed < 1e-6 else 0.0, None)
    assert rows["forward_velocity"].differences == pytest.approx((0.0, 0.15 - speed))


def test_mechanical_and_electrical_power_are_never_set_against_each_other(make_trial):
    mechanical = make_trial()
    rows = by_name(compare([mechanical, make_trial(electrical_work=90.0 * mechanical.time)]))
    assert not {"mean_power", "cost_of_transport", "joules_per_meter"} & rows.keys()
    assert rows["mechanical_power"].values == pytest.approx((3.0, 3.0))
    assert rows["electrical_power"].differences_percent == (None, None)


def test_one_trial_is_not_enough_to_compare(make_trial):
    with pytest.raises(
        ValueError, match=r"`trials` must hold at least 2 trials to compare, got 1\."
    ):
        compare([make_trial()])
    with pytest.raises(ValueError, match=r"`trials\[1\]` must be of class Trial, got str\."):
        compare([make_trial(), "run.nc"])


def test_what_is_no_sequence_of_trials_is_not_compared():
    with pytest.raises(ValueError, match="`trials` must hold at least 2 trials to compare, got 1"):
        compare(iter([]))


def cut(trial, begin, end, *, restart_clock=False):
    """The samples from `begin` to `end`, as if they were a run of their own."""
    part = {}
    for field in dataclasses.fields(Trial):
        value = getattr(trial, field.name)
        if isinstance(value, np.ndarray):
            part[field.name] = value[begin:end]
    if trial.link_force is not None:
        part["link_force"] = {name: force[begin:end] for name, force in trial.link_force.items()}
    part["signals"] = {name: signal[begin:end] for name, signal in trial.signals.items()}
    if restart_clock:
        part |= {"time": part["time"] - part["time"][0], "work": part["work"] - part["work"][0]}
    return dataclasses.replace(trial, **part)


@pytest.fixture
def whole(make_trial):
    plain = make_trial(duration=4.0)
    force = np.random.default_rng(1).normal(size=(201, 9, 2))
    return make_trial(
        duration=4.0,
        created="then",
        electrical_work=2.0 * plain.time,
        link_force={"drag": force},
        signals={"offset": np.sin(plain.time)},
    )


def with_other(trial, **parts):
    return dataclasses.replace(trial, scenario=dataclasses.replace(trial.scenario, **parts))


def test_two_halves_joined_are_the_whole_to_the_last_bit(whole):
    assert joined(cut(whole, 0, 101), cut(whole, 100, 201)).equals(whole)


def test_a_second_run_that_counted_from_zero_is_counted_on(whole):
    together = joined(cut(whole, 0, 101), cut(whole, 100, 201, restart_clock=True))
    np.testing.assert_allclose(together.time, whole.time, atol=1e-12)
    np.testing.assert_allclose(together.work, whole.work, atol=1e-12)


def test_how_the_second_run_ended_is_how_the_whole_ended(whole):
    second = dataclasses.replace(
        cut(whole, 100, 201), succeeded=False, status="It stopped.", state={"x": np.array([3.0])}
    )
    together = joined(cut(whole, 0, 101), second)
    assert (together.succeeded, together.status) == (False, "It stopped.")
    np.testing.assert_array_equal(together.state["x"], [3.0])


def test_what_does_not_follow_is_not_joined(whole):
    first, second = cut(whole, 0, 101), cut(whole, 100, 201)
    with pytest.raises(ValueError, match="`second` must be of class Trial, got str"):
        joined(first, "run.nc")
    with pytest.raises(
        ValueError, match=r"must begin where `first` ends, but `center_of_mass` jumps by 0\.\d+"
    ):
        joined(first, cut(whole, 110, 201))
    with pytest.raises(
        ValueError, match="`first` must have reached its end, got a failed run: It blew up"
    ):
        joined(dataclasses.replace(first, succeeded=False, status="It blew up."), second)
    with pytest.raises(ValueError, match="must have the same `gait` as `first`"):
        joined(first, with_other(second, gait=None))
    with pytest.raises(ValueError, match="must have the same `robot` as `first`"):
        joined(first, with_other(second, robot=load_robot("mamba-thruster")))
    with pytest.raises(ValueError, match="`second` must log the same as `first`"):
        joined(first, dataclasses.replace(second, electrical_work=None))
    with pytest.raises(
        ValueError,
        match="`second` must log the same as `first`, including electrical work, link forces and signals",
    ):
        joined(first, dataclasses.replace(second, signals={}))


def test_at_the_joint_a_signal_is_what_the_second_run_decided(whole):
    first = cut(whole, 0, 101)
    held = dataclasses.replace(
        first, signals={"offset": np.append(first.signals["offset"][:-1], 9.0)}
    )
    assert joined(held, cut(whole, 100, 201)).equals(whole)
