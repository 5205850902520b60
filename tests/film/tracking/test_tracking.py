from dataclasses import replace

import numpy as np
import pytest
from film.tag_films import CAMERA, LEVEL, SURFACE, rendered

import laticauda as lc
from laticauda.film import TrackedPoints
from laticauda.film.calibration import Surface, calibrate_by_ruler, calibrate_camera
from laticauda.film.chain import places_at
from laticauda.film.tags import find_tags, marks_of_floor
from laticauda.film.tracking import (
    build_trial,
    draw_over_frames,
    follow_points,
    follow_tags,
    measure_path,
)

WATER = lc.load_water("paper-lateral")


@pytest.fixture(scope="module")
def film():
    return rendered()


@pytest.fixture(scope="module")
def found(film):
    return find_tags(film.path, film.layout)


@pytest.fixture(scope="module")
def camera(film, found):
    marks = replace(marks_of_floor(found, film.layout), place_deviation=0.0003)
    return calibrate_camera(marks, CAMERA.size, surface=Surface(height=SURFACE), plane_height=LEVEL)


def difference(trial, film):
    """Deviations (rms) from the truth: joint angles [deg] and center of mass [mm]."""
    joints = [np.interp(trial.time, film.trial.time, angle) for angle in film.trial.joint_angle.T]
    axes = [np.interp(trial.time, film.trial.time, film.trial.center_of_mass[:, k]) for k in (0, 1)]
    of_joints = trial.joint_angle - np.stack(joints, axis=1)
    of_center = trial.center_of_mass[:, :2] - np.stack(axes, axis=1)
    return np.degrees(np.sqrt(np.mean(of_joints**2))), 1e3 * np.sqrt(np.mean(of_center**2))


@pytest.mark.parametrize(("takes_frames_alone", "largest"), [(False, 0.9), (True, 2.0)])
def test_a_film_of_tags_becomes_a_trial_of_the_true_motion(
    takes_frames_alone, largest, film, found, camera
):
    track = follow_tags(
        found, film.layout, camera, film.robot, takes_frames_alone=takes_frames_alone
    )
    trial = build_trial(track, film.robot, WATER)
    joints, center = difference(trial, film)
    assert joints < largest
    assert center < 3.0
    assert "Tags on the robot were lost in" in trial.status
    assert trial.gait.recorded is not None


def test_a_link_whose_tag_is_never_seen_is_found_by_the_chain(film, found, camera):
    corners = found.corners.copy()
    corners[:, found.numbers.index(21)] = np.nan
    track = follow_tags(replace(found, corners=corners), film.layout, camera, film.robot)
    joints, center = difference(build_trial(track, film.robot, WATER), film)
    assert joints < 3.0
    assert center < 6.0
    assert "Never found: 21." in track.notes[-2]
    assert track.notes[-1].startswith("A chain was fitted to all frames: noise")


def test_a_tag_that_is_lost_for_a_frame_is_a_gap_that_is_filled_and_said(film, found, camera):
    corners = found.corners.copy()
    corners[6, found.numbers.index(22)] = np.nan
    alone = {"takes_frames_alone": True}
    track = follow_tags(replace(found, corners=corners), film.layout, camera, film.robot, **alone)
    trial = build_trial(track, film.robot, WATER)
    assert "1 of 16 samples had gaps in" in trial.status
    corners[:, found.numbers.index(22)] = np.nan
    with pytest.raises(ValueError, match="on every link if frames are taken alone; none was found"):
        follow_tags(replace(found, corners=corners), film.layout, camera, film.robot, **alone)


def test_one_tag_is_enough_for_a_body_that_holds_straight(film, found, camera):
    only = replace(film.layout, links=film.layout.links[1:2])
    track = follow_tags(found, only, camera, film.robot, is_straight=True)
    trial = build_trial(track, film.robot, WATER)
    assert not trial.joint_angle.any()
    assert trial.gait.frequency == 0.0


def test_tags_that_look_too_large_show_a_wrong_height(film, found, camera):
    low = replace(camera, plane_height=0.8, surface=None)
    with pytest.raises(ValueError, match=r"`height` must be right: tags on the robot look 0\.\d+"):
        follow_tags(found, film.layout, low, film.robot)


def test_a_calibration_of_another_size_of_film_is_refused(film, found, camera):
    with pytest.raises(
        ValueError, match="must be of a film of 1920 x 1080 px, got one of 960 x 540"
    ):
        follow_tags(replace(found, image_size=(1920, 1080)), film.layout, camera, film.robot)


def test_a_tag_on_a_link_that_does_not_exist_is_refused(film, found, camera):
    with pytest.raises(ValueError, match="must be of links of mamba, 0 to 1, got 2"):
        follow_tags(found, film.layout, camera, lc.load_robot("mamba", n_links=2))


def test_the_chain_is_drawn_over_frames_of_the_film(film, found, camera, tmp_path):
    track = follow_tags(found, film.layout, camera, film.robot)
    figure = draw_over_frames(track, film.path)
    panels = figure.axes
    assert panels[0].get_title() == "0.00 s"
    assert len(panels) == 6
    chain = panels[0].lines[1].get_xydata()
    assert len(chain) == film.robot.n_links + 1
    ends = CAMERA.project(np.column_stack((np.array(track.center_of_mass[:1]), [LEVEL])))
    assert np.linalg.norm(chain.mean(axis=0) - ends[0]) < 30.0


def tracked(film, unit):
    """Points at the ends of links with 0.5 mm of noise, y up; or in px of a camera right above."""
    from laticauda.robot import kinematics

    trial = film.trial
    ends = kinematics.Posture(film.robot, trial.center_of_mass[:, :2], trial.link_angle).link_ends
    position = ends + np.random.default_rng(0).normal(0.0, 5e-4, ends.shape)
    if unit == "px":
        position = np.stack((position[..., 0] * 500.0, 540.0 - position[..., 1] * 500.0), axis=-1)
    return TrackedPoints(
        time=trial.time,
        names=("tail", "a", "b", "c", "head"),
        position=position,
        likelihood=np.full(position.shape[:2], np.nan),
        unit=unit,
    )


@pytest.mark.parametrize("unit", ["px", "m"])
def test_points_of_a_tracker_become_a_trial(unit, film):
    camera = None
    if unit == "px":
        camera = calibrate_by_ruler((960, 540), (0.0, 0.0), (500.0, 0.0), 1.0)
    places = places_at([0.0, 0.18, 0.36, 0.54, 0.72])
    track = follow_points(tracked(film, unit), places, camera, film.robot)
    joints, center = difference(build_trial(track, film.robot, WATER), film)
    assert joints < 1.0
    assert center < 2.0


def test_points_in_px_need_a_calibration_and_points_in_m_none(film):
    places = places_at([0.0, 0.18, 0.36, 0.54, 0.72])
    with pytest.raises(ValueError, match="`calibration` must be given: the points are in px"):
        follow_points(tracked(film, "px"), places, None, film.robot)
    camera = calibrate_by_ruler((960, 540), (0.0, 0.0), (500.0, 0.0), 1.0)
    with pytest.raises(ValueError, match="must not be given: the points are in m already"):
        follow_points(tracked(film, "m"), places, camera, film.robot)


def test_a_path_is_measured_with_the_noise_of_its_frames_and_the_scale_of_the_film(
    film, found, camera
):
    track = follow_tags(found, film.layout, camera, film.robot, is_straight=True)
    trial = build_trial(track, film.robot, WATER)
    vague = replace(track, calibration=replace(camera, scale_deviation=0.1))
    for body, scale in ((track, camera.scale_deviation), (vague, 0.1)):
        measurement = measure_path(body, trial, interval=0.1)
        places, sigma = measurement.series["center_of_mass"]
        assert len(places) == 8
        away = places - places.mean(axis=0)
        assert sigma == pytest.approx(np.hypot(track.center_deviation, scale * away))
    alone = replace(track, center_deviation=float("nan"))
    with pytest.raises(ValueError, match="must be of two tags at least: one does not show"):
        measure_path(alone, trial)
