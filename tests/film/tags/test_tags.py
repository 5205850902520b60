import re
from dataclasses import replace

import cv2
import numpy as np
import pytest
from film.tag_films import CAMERA, N_FRAMES, rendered, swimmer

import laticauda as lc
from laticauda.film.tags import (
    FloorTag,
    LinkTag,
    TagLayout,
    describe_placing,
    draw_sheet,
    find_tags,
    load_layout,
    marks_of_floor,
    propose_layout,
    save_layout,
    write_sheet,
)
from laticauda.values import TrialFileError


def test_a_layout_has_a_tag_for_every_link_and_some_around_the_area(tmp_path):
    layout = propose_layout(lc.load_robot("mamba"), area=(3.0, 2.0))
    assert [tag.link for tag in layout.links] == list(range(9))
    assert [(tag.x, tag.y) for tag in layout.floor] == [
        (0.0, 0.0),
        (1.5, 0.0),
        (3.0, 0.0),
        (3.0, 2.0),
        (1.5, 2.0),
        (0.0, 2.0),
    ]
    save_layout(layout, tmp_path / "tags.toml")
    assert load_layout(tmp_path / "tags.toml") == layout
    assert "20 on link 0" in " ".join(describe_placing(layout))


def test_a_number_or_a_link_with_two_tags_is_refused():
    with pytest.raises(ValueError, match="must have every number once, got 3 twice"):
        TagLayout(
            floor_size=0.1,
            link_size=0.05,
            floor=(FloorTag(number=3, x=0.0, y=0.0),),
            links=(LinkTag(number=3, link=0),),
        )
    with pytest.raises(ValueError, match="must have one tag for a link, got two on link 0"):
        TagLayout(
            floor_size=0.1,
            link_size=0.05,
            floor=(),
            links=(LinkTag(number=3, link=0), LinkTag(number=4, link=0)),
        )


def test_tags_that_do_not_fit_are_refused_with_what_would():
    robot = lc.load_robot("mamba")
    with pytest.raises(ValueError, match=r"`link_size` must fit .* links of 0\.18 m, got 0\.2 m"):
        propose_layout(robot, link_size=0.2)
    with pytest.raises(ValueError, match=r"`floor_size` must be at most 0\.139 m on this paper"):
        draw_sheet(propose_layout(robot, floor_size=0.3))


def test_the_sheet_is_at_true_scale_and_its_tags_are_found(tmp_path):
    layout = propose_layout(swimmer(), floor_size=0.1)
    assert write_sheet(layout, tmp_path / "tags.pdf") == 9
    content = (tmp_path / "tags.pdf").read_bytes()
    width, height = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", content).groups()
    assert float(width) * 25.4 / 72.0 == pytest.approx(210.0, abs=0.1)
    assert float(height) * 25.4 / 72.0 == pytest.approx(297.0, abs=0.1)
    page = draw_sheet(layout)[1]
    page.savefig(tmp_path / "page.png", dpi=100)
    picture = cv2.imread(str(tmp_path / "page.png"), cv2.IMREAD_GRAYSCALE)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    quads, numbers, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(picture)
    assert 0 in numbers.ravel()
    side = np.linalg.norm(quads[0][0, 1] - quads[0][0, 0]) / 100.0 * 0.0254
    assert side == pytest.approx(0.1, rel=0.02)


def test_tags_of_a_film_are_found_where_they_are():
    film = rendered()
    found = find_tags(film.path, film.layout)
    assert found.image_size == CAMERA.size
    assert found.time == pytest.approx(film.times)
    assert found.share_lost([tag.number for tag in film.layout.links]) <= 0.05
    marks = marks_of_floor(found, film.layout)
    true = CAMERA.project(np.column_stack((marks.places, np.zeros(len(marks.places)))))
    assert np.max(np.linalg.norm(marks.pixels - true, axis=1)) < 1.0


def test_slow_motion_is_timed_by_the_rate_at_which_it_was_taken():
    film = rendered()
    shares = []
    found = find_tags(film.path, film.layout, frame_rate=240.0, on_progress=shares.append)
    assert found.time[-1] == pytest.approx((N_FRAMES - 1) / 240.0)
    assert shares[-1] == 1.0


def test_a_camera_that_moves_is_refused():
    film = rendered()
    found = find_tags(film.path, film.layout)
    shaken = found.corners + np.linspace(0.0, 30.0, N_FRAMES)[:, None, None, None]
    with pytest.raises(ValueError, match="stands still, but tag 0 on the floor moved by"):
        marks_of_floor(replace(found, corners=shaken), film.layout)


def test_a_film_that_shows_no_tags_on_the_floor_is_refused():
    film = rendered()
    found = find_tags(film.path, film.layout)
    lost = np.full_like(found.corners, np.nan)
    with pytest.raises(ValueError, match="at least 3 of the tags 0, 1, 2, 3, 4, 5 on the floor"):
        marks_of_floor(replace(found, corners=lost), film.layout)


def test_a_file_that_is_no_film_is_refused(tmp_path):
    layout = rendered().layout
    with pytest.raises(TrialFileError, match="there is no such file"):
        find_tags(tmp_path / "none.mp4", layout)
    (tmp_path / "text.mp4").write_text("no film")
    with pytest.raises(TrialFileError, match="it is no film that OpenCV reads"):
        find_tags(tmp_path / "text.mp4", layout)
