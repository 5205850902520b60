"""Markers on the body, beside tracks of them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.robot.kinematics import Posture
from laticauda.trials.markers import Track, marker_distance, marker_places
from laticauda.values.errors import TrialFileError

ALONG = [0.42, 0.33, 0.2, 0.0]
CHAIN = lc.load_robot("chain", n_links=3)
TRIAL = lc.swim(CHAIN, lc.eel_like(amplitude=0.5, frequency=3.0, phase_shift=0.9), 3.0, dt=0.05)
SEEN = Track(time=TRIAL.time, place=marker_places(TRIAL, ALONG))


def test_markers_on_the_ends_and_joints_are_where_these_are():
    places = marker_places(TRIAL, [0.0, 0.14, 0.28, 0.42])
    np.testing.assert_allclose(
        places, Posture(CHAIN, TRIAL.center_of_mass, TRIAL.link_angle).link_ends, atol=1e-14
    )


@settings(max_examples=25, deadline=None)
@given(angle=st.floats(-3.0, 3.0), x=st.floats(-5.0, 5.0), y=st.floats(-5.0, 5.0))
def test_where_the_cameras_stand_makes_no_difference(angle, x, y):
    c, s = np.cos(angle), np.sin(angle)
    place = SEEN.place @ np.array([[c, s], [-s, c]]) + (x, y)
    _, distance = marker_distance(TRIAL, replace(SEEN, place=place), ALONG, fitted=(0.0, 0.5))
    np.testing.assert_allclose(distance, 0.0, atol=1e-12)


def test_the_distance_is_the_root_of_the_mean_square_and_lost_markers_do_not_count():
    place = SEEN.place.copy()
    place[-1] += np.array([[0.3, 0.0], [0.0, 0.1], [0.0, 0.0], [np.nan, 0.0]])
    time, distance = marker_distance(TRIAL, replace(SEEN, place=place), ALONG, fitted=(0.0, 1.0))
    assert distance[-1] == pytest.approx(np.sqrt((0.09 + 0.01) / 3.0))
    assert time[-1] == TRIAL.time[-1]
    assert distance[:-1] == pytest.approx(0.0, abs=1e-12)


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="`along` must have one distance per marker, 4, got 1"):
        marker_distance(TRIAL, SEEN, [0.1], fitted=(0.0, 1.0))
    with pytest.raises(ValueError, match="`fitted` must be a span in which markers were seen"):
        marker_distance(TRIAL, SEEN, ALONG, fitted=(8.0, 9.0))


def test_a_track_is_read_from_a_table(tmp_path):
    path = tmp_path / "track.csv"
    path.write_text(
        "# a note\ntime_s,a_x_m,a_y_m,b_x_m,b_y_m\n0,1,2,3,4\n1,,,5,6\n", encoding="utf-8"
    )
    found = Track.read(path)
    np.testing.assert_array_equal(found.place, [[[1, 2], [3, 4]], [[np.nan, np.nan], [5, 6]]])
    path.write_text("time_s,a_x_m\n0,1\n", encoding="utf-8")
    with pytest.raises(TrialFileError, match="must have columns `time_s`, `NAME_x_m`, `NAME_y_m`"):
        Track.read(path)
    path.write_text("time_s,a_x_m,a_y_m\n0,1\n", encoding="utf-8")
    with pytest.raises(TrialFileError, match="row 2 must have 3 cells, as row 1 has, got 2"):
        Track.read(path)
