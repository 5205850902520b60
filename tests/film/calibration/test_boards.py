import cv2
import numpy as np
import pytest
from campaign_scripts import campaign

from laticauda.film.calibration import (
    Checkerboard,
    calibrate_camera,
    calibrate_lens,
    marks_of_board,
)

films = campaign("_rendered_films")
BOARD = Checkerboard(columns=8, rows=5, square=0.1)
SIZE = (640, 480)
EYES = [(0.4, -0.6, 0.9), (-0.4, 0.2, 0.9), (1.2, 0.3, 0.8), (0.3, 0.9, 0.9), (0.9, -0.4, 1.0)]


def camera_at(eye):
    return films.Camera(
        size=SIZE, focal=520.0, k1=-0.08, k2=0.01, eye=eye, target=(0.36, 0.21, 0.0)
    )


def picture_of_board(camera):
    """The board lies with its inner corner (0, 0) at the origin."""
    x, y = np.meshgrid((np.arange(2 * SIZE[0]) - 0.5) / 2, (np.arange(2 * SIZE[1]) - 0.5) / 2)
    places = camera.hit(np.column_stack((x.ravel(), y.ravel())), 0.0)
    cells = np.floor(places / BOARD.square).reshape(2 * SIZE[1], 2 * SIZE[0], 2)
    is_board = (cells[..., 0] >= -1) & (cells[..., 0] < BOARD.columns)
    is_board &= (cells[..., 1] >= -1) & (cells[..., 1] < BOARD.rows)
    gray = np.where(is_board & (cells.sum(axis=-1) % 2 == 1), 30.0, 220.0)
    small = gray.reshape(SIZE[1], 2, SIZE[0], 2).mean(axis=(1, 3))
    return cv2.GaussianBlur(small, (0, 0), 0.6).astype(np.uint8)


def test_a_lens_is_found_from_pictures_of_a_checkerboard():
    lens = calibrate_lens([picture_of_board(camera_at(eye)) for eye in EYES], BOARD)
    assert lens.focal_length == pytest.approx(520.0, rel=0.01)
    assert lens.distortion[0] == pytest.approx(-0.08, abs=0.01)
    assert 0.0 < lens.focal_length_deviation < 0.01


def test_a_checkerboard_in_the_plane_is_as_good_as_tags():
    camera = camera_at((0.4, -0.6, 0.9))
    marks = marks_of_board(picture_of_board(camera), BOARD)
    calibration = calibrate_camera(marks, SIZE)
    ends = camera.project(np.array([[0.0, 0.2, 0.0], [0.7, 0.2, 0.0]]))
    begin, end = calibration.to_plane(ends)
    assert np.linalg.norm(end - begin) == pytest.approx(0.7, rel=2e-3)


def test_pictures_without_a_board_are_refused():
    blank = np.full((480, 640), 200, np.uint8)
    with pytest.raises(ValueError, match="whole checkerboard in at least 5 pictures, got 0 of 5"):
        calibrate_lens([blank] * 5, BOARD)
    with pytest.raises(ValueError, match="must show all 8 x 5 inner corners"):
        marks_of_board(blank, BOARD)
