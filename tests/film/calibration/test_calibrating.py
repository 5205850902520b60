from dataclasses import replace

import numpy as np
import pytest
from campaign_scripts import campaign

from laticauda.film import TrackedPoints
from laticauda.film.calibration import (
    Lens,
    Marks,
    Surface,
    calibrate_by_ruler,
    calibrate_camera,
    load_calibration,
    load_lens,
    points_on_plane,
    save_calibration,
)
from laticauda.values import TrialFileError

films = campaign("_rendered_films")
SIZE = (1280, 720)
PLACES = [(0.3, 0.2), (2.0, 0.1), (3.7, 0.2), (3.6, 1.9), (2.1, 2.0), (0.4, 1.9)]
OBLIQUE = films.Camera(size=SIZE)
WIDE = replace(OBLIQUE, focal=800.0, k1=-0.10, k2=0.015)
WATER = replace(OBLIQUE, surface=0.35)


def marks_of(camera, noise=0.0, places=PLACES, height=0.0):
    generator = np.random.default_rng(1)
    corners = np.concatenate([films.corners(place, 0.1 * i, 0.2) for i, place in enumerate(places)])
    pixels = camera.project(np.column_stack((corners, np.full(len(corners), height))))
    return Marks(
        pixels=pixels + noise * generator.normal(size=pixels.shape),
        places=corners,
        groups=[f"tag {i}" for i in range(len(places)) for _ in range(4)],
        place_deviation=0.0005,
    )


def errors(calibration, camera, height):
    """Distances of places from the true ones over the tank [m]."""
    x, y = np.meshgrid(np.linspace(0.6, 3.4, 8), np.linspace(0.3, 1.8, 6))
    true = np.column_stack((x.ravel(), y.ravel()))
    pixels = camera.project(np.column_stack((true, np.full(len(true), height))))
    return np.linalg.norm(calibration.to_plane(pixels) - true, axis=1)


@pytest.mark.parametrize("camera", [OBLIQUE, WIDE], ids=["pinhole", "distorted"])
@pytest.mark.parametrize("height", [0.0, 0.1])
def test_lens_and_pose_come_from_the_tags_alone(camera, height):
    calibration = calibrate_camera(marks_of(camera), SIZE, plane_height=height)
    assert calibration.residual < 0.05
    assert np.max(errors(calibration, camera, height)) < 2e-3


def test_rays_are_bent_at_the_surface_of_the_water():
    surface = Surface(height=0.35)
    calibration = calibrate_camera(marks_of(WATER), SIZE, surface=surface, plane_height=0.1)
    assert np.max(errors(calibration, WATER, 0.1)) < 2e-3
    dry = calibrate_camera(marks_of(WATER), SIZE, plane_height=0.1)
    assert np.max(errors(dry, WATER, 0.1)) > 1e-2


def test_a_body_above_the_surface_is_seen_straight():
    calibration = calibrate_camera(
        marks_of(WATER), SIZE, surface=Surface(height=0.35), plane_height=0.45
    )
    assert np.max(errors(calibration, WATER, 0.45)) < 3e-3


def test_a_window_bends_rays_by_snell_s_law():
    window = Surface(height=1.0, normal=(0.0, -2.0, 0.0))
    assert window.normal == (0.0, -1.0, 0.0)
    from laticauda.film.calibration.optics import refract

    slanted = np.array([[np.sin(0.5), np.cos(0.5), 0.0]])
    bent = refract(slanted, np.array(window.normal), window.index)
    assert np.linalg.norm(bent) == pytest.approx(1.0)
    assert bent[0, 0] == pytest.approx(np.sin(0.5) / 1.333)


def test_the_stated_deviations_are_those_of_noisy_marks():
    scales = []
    stated = []
    for seed in range(5):
        marks = marks_of(OBLIQUE)
        noise = np.random.default_rng(seed).normal(0.0, 0.5, marks.pixels.shape)
        calibration = calibrate_camera(
            replace(marks, pixels=marks.pixels + noise), SIZE, plane_height_deviation=0.0
        )
        ends = OBLIQUE.project(np.array([[1.0, 1.0, 0.0], [3.0, 1.0, 0.0]]))
        begin, end = calibration.to_plane(ends)
        scales.append(np.linalg.norm(end - begin) / 2.0 - 1.0)
        stated.append(calibration.scale_deviation)
    found = np.sqrt(np.mean(np.square(scales)))
    assert 1.0 < np.mean(stated) / found < 8.0


def test_an_uncertain_height_makes_lengths_uncertain_by_its_share_of_the_distance():
    calibration = calibrate_camera(
        marks_of(OBLIQUE), SIZE, plane_height=0.1, plane_height_deviation=0.03
    )
    assert 0.006 < calibration.scale_deviation < 0.012


def test_a_tag_in_the_wrong_place_is_named():
    marks = marks_of(OBLIQUE)
    places = marks.places.copy()
    places[8:12] += 0.1
    with pytest.raises(ValueError, match=r"but tag 2 is .* px off; measure its place"):
        calibrate_camera(replace(marks, places=places), SIZE)


def test_too_few_marks_and_marks_on_a_line_are_refused():
    marks = marks_of(OBLIQUE)
    with pytest.raises(ValueError, match="`marks` must be at least 4 points, got 3"):
        calibrate_camera(
            Marks(pixels=marks.pixels[:3], places=marks.places[:3], groups=["a"] * 3), SIZE
        )
    line = np.column_stack((np.arange(6.0), np.arange(6.0)))
    with pytest.raises(ValueError, match="must not lie on one line"):
        calibrate_camera(Marks(pixels=line, places=line, groups=["a"] * 6), SIZE)


def test_a_calibration_is_the_same_after_it_was_kept_in_a_file(tmp_path):
    calibration = calibrate_camera(
        marks_of(WATER), SIZE, surface=Surface(height=0.35), plane_height=0.1
    )
    path = tmp_path / "camera.toml"
    save_calibration(calibration, path)
    assert load_calibration(path) == calibration
    assert load_lens(path) == calibration.lens
    assert path.stat().st_size < 2000
    ruler = calibrate_by_ruler(SIZE, (100.0, 500.0), (900.0, 500.0), 2.0)
    save_calibration(ruler, path)
    assert load_calibration(path) == ruler
    with pytest.raises(TrialFileError, match='must be one of "lens", "film-camera"'):
        load_lens(path)


def test_a_ruler_gives_the_scale_and_turns_y_up():
    ruler = calibrate_by_ruler(SIZE, (100.0, 500.0), (900.0, 500.0), 2.0)
    assert ruler.metres_per_pixel == pytest.approx(0.0025)
    assert ruler.to_plane(np.array([[400.0, 320.0]])) == pytest.approx(np.array([[1.0, 1.0]]))
    assert ruler.scale_deviation == pytest.approx(np.hypot(np.sqrt(2) / 800, 0.0005))
    with pytest.raises(ValueError, match="`end` must be at least 10 px from `begin`"):
        calibrate_by_ruler(SIZE, (100.0, 500.0), (102.0, 500.0), 2.0)


def points(position):
    return TrackedPoints(
        time=np.arange(2) / 30.0,
        names=("nose",),
        position=position,
        likelihood=np.full((2, 1), np.nan),
        unit="px",
    )


def test_points_in_px_become_points_in_m_and_lost_ones_stay_lost():
    ruler = calibrate_by_ruler(SIZE, (100.0, 500.0), (900.0, 500.0), 2.0)
    pixels = np.array([[[400.0, 320.0]], [[np.nan, np.nan]]])
    moved = points_on_plane(points(pixels), ruler)
    assert moved.unit == "m"
    assert moved.position[0, 0] == pytest.approx([1.0, 1.0])
    assert not moved.is_seen[1, 0]
    assert moved.notes[-1].startswith("Lengths are certain to 0.18%, places to 2.5 mm more")
    with pytest.raises(ValueError, match="must be in px, got m: they need no calibration"):
        points_on_plane(moved, ruler)


def test_points_outside_the_picture_are_of_another_film():
    ruler = calibrate_by_ruler(SIZE, (100.0, 500.0), (900.0, 500.0), 2.0)
    with pytest.raises(ValueError, match=r"got \(1800, 900\) px; was the film scaled\?"):
        points_on_plane(points(np.full((2, 1, 2), (1800.0, 900.0))), ruler)


def test_a_lens_is_scaled_with_the_film_but_not_to_one_that_was_cropped():
    lens = Lens(image_size=(3840, 2160), focal_length=3000.0, center=(1920.0, 1080.0))
    assert lens.scaled_to((1920, 1080)).focal_length == pytest.approx(1500.0)
    with pytest.raises(ValueError, match="must have the ratio of 3840 x 2160"):
        lens.scaled_to((1920, 1440))


def test_tags_on_one_line_are_refused_although_they_have_a_width():
    on_line = [(0.3, 1.0), (1.4, 1.0), (2.6, 1.0), (3.7, 1.0)]
    marks = marks_of(OBLIQUE, places=on_line)
    with pytest.raises(ValueError, match=r"marks.*not all lie on one line.*on both sides"):
        calibrate_camera(marks, SIZE)


def test_a_lens_whose_distortion_has_the_wrong_sign_is_refused():
    right = Lens(
        image_size=SIZE,
        focal_length=1000.0,
        center=(0.5 * (SIZE[0] - 1), 0.5 * (SIZE[1] - 1)),
        distortion=(-0.04, 0.0, 0.0, 0.0, 0.0),
        focal_length_deviation=0.02,
        center_deviation=5.0,
        distortion_deviation=0.005,
    )
    marks = marks_of(replace(OBLIQUE, focal=1000.0, k1=-0.04), noise=0.1)
    assert calibrate_camera(marks, SIZE, lens=right).residual < 0.5
    wrong = replace(right, distortion=(0.04, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match=r"lens.*that of this film.*instead of 0.040"):
        calibrate_camera(marks, SIZE, lens=wrong)


def test_places_that_are_mirrored_as_a_whole_blame_no_single_tag():
    marks = marks_of(OBLIQUE)
    centers = np.repeat(marks.places.reshape(-1, 4, 2).mean(axis=1), 4, axis=0)
    mirrored = centers * [1.0, -1.0] + (marks.places - centers)
    with pytest.raises(ValueError, match=r"no single tag is to blame.*in m.*mirrored"):
        calibrate_camera(replace(marks, places=mirrored), SIZE)
