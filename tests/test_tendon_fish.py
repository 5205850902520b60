"""A fish robot that nobody fitted: what the textbook's water makes of a broad fin, as far as the docs say it."""

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.trials import describe_edge

fish = campaign_scripts.campaign("tendon_fish")
SWIMS = fish.swims()
FAST = SWIMS[-1]


def test_its_strides_grow_and_it_slips_far_more_than_animals_do():
    strides = [swim.speed / swim.frequency for swim in SWIMS]
    assert strides == sorted(strides)
    assert all(1.7 < 2.0 * swim.tip * swim.frequency / swim.speed < 3.5 for swim in SWIMS)


def test_its_wave_travels_from_head_to_tail():
    for swim in SWIMS[1:]:
        lag = np.unwrap(np.angle(swim.joints))
        assert np.all(np.diff(lag) > 0.0)  # tail first: each joint leads the one behind it


def test_a_fin_with_the_coefficients_of_the_body_and_missing_bars_made_it_twice_as_fast():
    bare, barred = fish.without_bars(), fish.with_rectangle()
    as_body = fish.textbook(FAST, bare, trailing_edge="elongated", **fish.AS_A_BODY)
    before = fish.steady_speed(FAST, fish.run(FAST, as_body, bare))
    assert before / FAST.speed == pytest.approx(3.65, rel=0.02)
    plates = fish.textbook(FAST, barred, trailing_edge="elongated")
    assert fish.steady_speed(FAST, fish.run(FAST, plates, barred)) / FAST.speed == pytest.approx(
        1.75, rel=0.02
    )


def test_the_shape_of_its_fin_changes_little_and_the_tail_ahead_of_it_slows_it_down():
    speeds = []
    for robot in (fish.with_rectangle(), fish.with_free_fin(), lc.load_robot("tendon-fish")):
        trial = fish.run(FAST, fish.textbook(FAST, robot), robot)
        speeds.append(fish.steady_speed(FAST, trial) / FAST.speed)
    assert speeds == pytest.approx([2.51, 2.52, 2.40], rel=0.01)


def test_the_textbook_is_too_fast_without_its_edge_too_slow_and_says_that_it_may_be():
    trial = fish.run(FAST, fish.textbook(FAST))
    assert trial.environment.trailing_edge == "finite-span"
    assert "outside its law and may be wrong by 50%" in describe_edge(trial)
    assert np.degrees(trial.edge_incidence) == pytest.approx(47.0, abs=2.0)
    assert fish.steady_speed(FAST, trial) / FAST.speed == pytest.approx(2.40, rel=0.02)
    clipped = fish.speed(FAST, fish.textbook(FAST, edge_clip=0.2))
    assert clipped / FAST.speed == pytest.approx(1.63, rel=0.02)
    bare = fish.speed(FAST, fish.textbook(FAST, trailing_edge="none"))
    assert bare / FAST.speed == pytest.approx(0.60, rel=0.02)


def test_models_without_hydrodynamics_miss_it_too():
    for name, speed in fish.null_models(FAST).items():
        assert speed > 2.4 * FAST.speed, name


def test_a_row_is_what_the_markers_say(tmp_path):
    """Markers made from known joints, in pixels, are reduced to these joints."""
    time = np.arange(300) / fish.RATE
    phase = 2.0 * np.pi * 1.2 * time
    joints = 0.15 * np.exp(1j * np.array([0.6, 0.3, 0.0, -0.3, -0.6]))  # head first
    lean = np.cumsum(np.real(joints * np.exp(1j * phase)[:, None]), axis=1)
    step = np.diff(fish.JOINTS) * np.exp(1j * lean[:, :-1])
    joint = np.concatenate((np.zeros((300, 1)), np.cumsum(step, axis=1)), axis=1) + fish.JOINTS[0]
    tail = np.concatenate((joint, joint[:, -1:]), axis=1) + fish.BEHIND * np.exp(
        1j * np.column_stack((lean, lean[:, -1]))
    )
    body = np.tile([-fish.NOSE, fish.HEAD - fish.NOSE, 0.28], (300, 1))
    places = (np.column_stack((body, tail)) - 0.2 * time[:, None]) * np.exp(0.4j) * 1000.0
    pixels = np.stack((places.real, -places.imag), axis=2).reshape(300, -1)
    np.savetxt(tmp_path / "markers_1_20.csv", pixels, delimiter=",")
    reduced = fish.reduce_markers("1_20", tmp_path)
    assert reduced.frequency == pytest.approx(1.2, abs=1e-3)
    assert reduced.speed == pytest.approx(0.2, rel=1e-3)
    turn = sum(reduced.joints) / -sum(joints)  # the row's phases count from the fin's tip
    expected = -joints[::-1] * turn / abs(turn)
    np.testing.assert_allclose(reduced.joints, expected, atol=0.04)  # evened out between neighbors
    assert abs(turn) == pytest.approx(1.0, abs=0.02)  # which the direction of the fin is not
