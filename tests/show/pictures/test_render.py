import math
import shutil
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from rendering import skip_without_rendering

import laticauda as lc
from laticauda.models.spatial.scene import Shore
from laticauda.robot import kinematics
from laticauda.scenarios import Experiment
from laticauda.show.pictures import lines, render, renderer, video
from laticauda.show.pictures.camera import VIEW_DEG, Film, aim_at_trial, remove_ripple
from laticauda.show.pictures.captions import Figure, write_captions
from laticauda.show.pictures.description import describe_run, measure_speed
from laticauda.show.pictures.posture import interpolate_posture, read_posture
from laticauda.show.pictures.shadows import SUN, draw_shadows, find_shadow_casters
from laticauda.show.pictures.stage import Studio
from laticauda.values.errors import MissingExtra, MissingProgram
from laticauda.water.fluid.flow import FunctionFlow

mujoco = pytest.importorskip("mujoco")

SMALL = Film(size=(192, 108))


def swum(name="mamba-fin", *, duration=6.0, sample_interval=0.05, **changes):
    gait = lc.lateral_undulation(
        amplitude=math.radians(30),
        frequency=math.radians(130),
        phase_shift=math.radians(40),
        **changes,
    )
    return lc.swim(lc.load_robot(name), gait, duration=duration, sample_interval=sample_interval)


@pytest.fixture(scope="module")
def trial():
    return swum()


@pytest.fixture
def screen():
    skip_without_rendering()


def go_to(shown, trial, time):
    shown.take(interpolate_posture(trial, time, shown.height))


# ---- postures ------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["mamba", "mamba-fin", "mamba-modules-fin"])
def test_the_replay_is_where_the_trial_was(name):
    trial = swum(name, duration=3.0)
    replay, planar = Studio.of_trial(trial), trial.robot.planar()
    for sample in (0, 17, -1):
        go_to(replay, trial, float(trial.time[sample]))
        center = replay.data.subtree_com[1]
        np.testing.assert_allclose(center, [*trial.center_of_mass[sample], -1.0], atol=1e-9)
        ends = kinematics.Posture(
            planar, trial.center_of_mass[sample], trial.link_angle[sample]
        ).link_ends
        yaw = [0, *(i + 1 for i, joint in enumerate(trial.robot.joints) if joint.axis == "yaw")]
        found = np.array([replay.data.body(f"module_{i}").xpos for i in yaw])
        np.testing.assert_allclose(found[:, :2], ends[:-1], atol=1e-8)
        np.testing.assert_allclose(found[:, 2], -1.0, atol=1e-9)


def test_robots_in_one_scene_are_each_where_their_trials_were():
    start = {"center_of_mass": (0.3, 0.6), "heading": 0.4}
    first, second = swum("mamba-modules", duration=1.0), swum("mamba-fin", duration=1.0)
    studio = Studio.of_trial(first, more_robots=[second.robot])
    postures = [
        interpolate_posture(first, 1.0, -1.0),
        interpolate_posture(lc.swim(second.scenario, start=lc.Start(**start)), 1.0, -1.0),
    ]
    studio.take(*postures)
    for body, posture in zip(("module_0", "robot_1_module_0"), postures, strict=True):
        center = studio.data.subtree_com[studio.model.body(body).id]
        np.testing.assert_allclose(center, posture.center_of_mass, atol=1e-9)


def with_other(trial, **parts):
    return replace(trial, scenario=replace(trial.scenario, **parts))


def without_gait(trial):
    return replace(trial, scenario=Experiment(robot=trial.robot, environment=trial.environment))


def test_between_samples_it_is_where_a_finer_log_has_it():
    coarse, fine = swum(sample_interval=0.1), swum(sample_interval=0.01)
    for sample in (1, 55, 234, 599):
        found = interpolate_posture(coarse, float(fine.time[sample]), 0.0)
        np.testing.assert_allclose(found.joint_angle, fine.joint_angle[sample], atol=1e-4)
        np.testing.assert_allclose(found.center_of_mass[:2], fine.center_of_mass[sample], atol=1e-4)


def test_a_trial_in_space_is_shown_with_its_height_and_its_tilt(trial):
    n = trial.time.size
    pad = np.linspace(-1.0, -2.0, n)[:, None]
    robot = trial.robot
    turned = {"w": math.cos(0.2), "x": math.sin(0.2), "y": 0.0, "z": 0.0}
    spatial = replace(
        trial,
        center_of_mass=np.hstack((trial.center_of_mass, pad)),
        center_of_mass_velocity=np.hstack(
            (trial.center_of_mass_velocity, np.full((n, 1), -1.0 / trial.duration))
        ),
        signals={f"orientation_{part}": np.full(n, value) for part, value in turned.items()},
    )
    assert spatial.joint_angle.shape[1] == robot.n_joints
    replay = Studio.of_trial(spatial)
    go_to(replay, spatial, float(spatial.time[-1]))
    np.testing.assert_allclose(replay.data.subtree_com[1], spatial.center_of_mass[-1], atol=1e-9)
    up = replay.data.body("module_0").xmat.reshape(3, 3)[:, 2]
    np.testing.assert_allclose(up, [0.0, -math.sin(0.4), math.cos(0.4)], atol=1e-9)
    assert replay.floor == pytest.approx(-2.45)


def test_the_water_has_its_depth_and_the_ground_its_height(trial):
    assert (
        Studio.of_trial(with_other(trial, environment=replace(trial.environment, depth=0.3))).height
        == -0.3
    )
    deep = with_other(trial, environment=replace(trial.environment, depth=7.0))
    assert Studio.of_trial(deep).floor < -7.0
    on_land = Studio.of_trial(with_other(trial, environment=lc.load_ground("coulomb")))
    assert (on_land.height, on_land.floor) == (0.055, 0.0)
    names = {on_land.model.geom(i).name for i in range(on_land.model.ngeom)}
    assert "ground" in names and "floor" not in names  # two planes at one height would flicker


def test_on_the_ramp_there_is_one_floor_one_sun_and_one_surface(trial):
    model = Studio.of_trial(
        with_other(trial, model=lc.Spatial(scene=Shore(ground=lc.load_ground("coulomb"))))
    ).model
    names = [model.geom(i).name for i in range(model.ngeom)]
    assert names.count("floor") == names.count("ramp") == 1
    assert model.nlight == 1
    assert model.geom("water").rgba[3] == 0.0


def test_waves_are_the_surface_of_a_picture_and_arrows_the_way_of_the_water(trial):
    def waves(x, y, z, t):
        return (
            0.2 * np.cos(3.0 * x - 2.0 * t),
            0.1 + 0.0 * x,
            *(0.0 * x,) * 13,
            0.1 * np.cos(3.0 * x - 2.0 * t),
        )

    moving = replace(trial.environment, current=FunctionFlow(function=waves), depth=0.5)
    studio = Studio.of_trial(with_other(trial, environment=moving))
    go_to(studio, trial, 3.0)
    mesh, placed = studio.model.mesh("waves"), studio.data.geom("surface")
    np.testing.assert_allclose(placed.xpos, 0.0, atol=1e-9)
    np.testing.assert_allclose(placed.xmat, np.eye(3).ravel(), atol=1e-9)
    first = mesh.vertadr[0]
    x, y, z = studio.model.mesh_vert[first : first + mesh.vertnum[0]].T
    np.testing.assert_allclose(z, 0.1 * np.cos(3.0 * x - 6.0), atol=1e-5)
    center = studio.data.subtree_com[1]
    assert np.ptp(x) == np.ptp(y) > 20.0 and abs(np.median(x) - center[0]) < 1e-5
    scene = mujoco.MjvScene(studio.model, maxgeom=500)
    studio.water.draw(scene, center, 3.0)
    arrows = scene.geoms[: scene.ngeom]
    tails, along = (
        np.array([arrow.pos for arrow in arrows]),
        np.array([arrow.mat[:, 2] for arrow in arrows]),
    )
    long = np.array([arrow.size[2] for arrow in arrows])[:, None]
    velocity = moving.velocity((tails + 0.5 * long * along)[:, :2], 3.0)
    assert len(arrows) > 20 and np.allclose(tails[:, 2], -0.5)
    ratio = np.linalg.norm(long * along, axis=1) / np.linalg.norm(velocity, axis=1)
    np.testing.assert_allclose(ratio, np.median(ratio), rtol=1e-4)
    np.testing.assert_allclose(
        (long * along)[:, :2], velocity * np.median(ratio), rtol=1e-3, atol=1e-4
    )
    level = Studio.of_trial(trial)
    assert level.model.nmesh == studio.model.nmesh - 1 and not level.water.captions
    at_surface = replace(
        moving, depth=None
    )  # a robot of which no depth is said feels the water there
    assert Studio.of_trial(with_other(trial, environment=at_surface)).height == 0.0


# ---- the camera ----------------------------------------------------------------------------------


@pytest.mark.parametrize("camera", ["follow", "side", "top", "fixed"])
@pytest.mark.parametrize("offset", [0.0, 0.1, -0.1])
@pytest.mark.parametrize("name", ["mamba", "mamba-fin", "chain"])
def test_the_whole_robot_is_in_the_picture_all_the_time(name, offset, camera):
    trial = swum(name, duration=12.0, offset=offset)
    aspect, film = 16.0 / 9.0, Film(camera=camera)
    up_most = math.tan(math.radians(0.5 * VIEW_DEG))
    for k in range(0, trial.time.size, 10):
        seen = aim_at_trial(trial, float(trial.time[k]), -1.0, film)
        azimuth, elevation = math.radians(seen.azimuth), math.radians(seen.elevation)
        flat = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        forward = math.cos(elevation) * flat + [0.0, 0.0, math.sin(elevation)]
        right = np.cross(flat, [0.0, 0.0, 1.0])
        eye = seen.lookat - seen.distance * forward
        center, angle = trial.center_of_mass[k], trial.link_angle[k]
        edge = kinematics.Posture(trial.robot, center, angle).trailing_edge
        points = np.vstack((edge, kinematics.Posture(trial.robot, center, angle).link_ends))
        ray = np.column_stack((points, np.full(len(points), -1.0))) - eye
        depth = ray @ forward
        assert np.all(np.abs(ray @ right) < 0.97 * depth * up_most * aspect)
        assert np.all(np.abs(ray @ np.cross(right, forward)) < 0.85 * depth * up_most)


def test_calm_keeps_straight_lines_and_takes_the_ripple_away():
    time = np.linspace(0.0, 10.0, 201)
    line = np.stack((1.0 + 2.0 * time, -time), axis=1)
    for at in (0.0, 3.3, 10.0):
        np.testing.assert_allclose(
            remove_ripple(time, line, at, 1.0), [1.0 + 2.0 * at, -at], atol=1e-9
        )
    ripple = np.sin(2.0 * np.pi * time)
    assert abs(float(remove_ripple(time, ripple, 5.2, 1.0))) < 1e-3
    assert float(remove_ripple(time[:1], ripple[:1], 0.0, 1.0)) == 0.0


# ---- the place -----------------------------------------------------------------------------------


@pytest.mark.parametrize("place", ["floor", "shore"])
def test_a_shadow_lies_on_the_ground_where_the_sun_puts_it(trial, place):
    mujoco = pytest.importorskip("mujoco")
    shown = with_other(trial, model=lc.Spatial(scene="shore")) if place == "shore" else trial
    studio = Studio.of_trial(shown)
    go_to(studio, shown, 2.0)
    if place == "shore":
        studio.data.qpos[:3] += (3.5, 0.0, 1.5)  # over the slope
        mujoco.mj_kinematics(studio.model, studio.data)
    scene, found = mujoco.MjvScene(studio.model, 500), find_shadow_casters(studio.model)
    draw_shadows(scene, studio.model, studio.data, found)
    assert scene.ngeom == found.size > trial.robot.n_links
    ramp = studio.model.geom("ramp" if place == "shore" else "floor").id
    up = studio.data.geom_xmat[ramp].reshape(3, 3)[:, 2]
    height = studio.data.geom_xpos[ramp] @ up + (
        studio.model.geom_size[ramp, 2] if place == "shore" else 0.0
    )
    for shape, caster in zip(scene.geoms[: scene.ngeom], found, strict=True):
        turned, middle = studio.data.geom_xmat[caster].reshape(3, 3), studio.data.geom_xpos[caster]
        for corner in np.vstack((np.zeros(3), 0.05 * np.eye(3))):
            real, flat = middle + turned @ corner, shape.pos + shape.mat @ corner
            there = real + SUN * (
                (height - real @ up) / (up @ SUN)
            )  # along the light, to the ground
            np.testing.assert_allclose(flat, there, atol=8e-3)


def test_the_surface_is_shown_to_those_who_swim_near_it_and_the_air_over_it_is_bright(
    trial, tmp_path, screen
):
    pictures = []
    for depth in (0.056, 0.6):
        shown = with_other(trial, environment=replace(trial.environment, depth=depth))
        names = [
            geom.name
            for geom in map(
                Studio.of_trial(shown).model.geom, range(Studio.of_trial(shown).model.ngeom)
            )
        ]
        assert ("surface" in names) is (depth < 0.1)
        render.write_still(
            shown, tmp_path / "a.png", Film(size=(320, 180), camera="side"), time=3.0
        )
        pictures.append(np.asarray(Image.open(tmp_path / "a.png")).astype(int))
    near, deep = pictures
    assert near[40:60].mean() > 150 > 80 > deep[40:60].mean()
    yellow = [np.count_nonzero((one[..., 0] > 190) & (one[..., 2] < 90)) for one in pictures]
    assert yellow[0] < 0.6 * yellow[1]  # through the surface, colors fade


def test_the_trail_is_seen_from_the_start(trial):
    mujoco = pytest.importorskip("mujoco")
    scene = mujoco.MjvScene(Studio.of_trial(trial).model, 50)
    lines.draw_trail(scene, trial, 0.3, -1.0, 3.0)
    pieces = scene.geoms[: scene.ngeom]
    assert len(pieces) == 2
    assert all(piece.rgba[3] == 1.0 and piece.pos[2] > -0.95 for piece in pieces)


# ---- lines ---------------------------------------------------------------------------------------


def test_the_path_that_was_followed_is_seen_as_dashes():
    gait = lc.lateral_undulation(
        amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
    )
    controller = lc.PathFollowing(
        gait=gait,
        path=lc.Polyline(waypoints=((0.0, 0.5), (50.0, 0.5))),
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        heading=lc.HeadingController(gain=0.4, max_offset=0.3),
    )
    followed = lc.run(
        lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral")), controller, 15.0
    )
    dashes, dash = lines.dash_path(followed, -1.0), lines.DASH * followed.robot.length
    ends = np.array(dashes).reshape(-1, 3)
    assert len(dashes) == pytest.approx(
        np.ptp(followed.signals["along_track_distance"]) / (2.0 * dash), abs=1.0
    )
    np.testing.assert_allclose(ends[:, 1], 0.5, atol=1e-3)
    np.testing.assert_allclose(np.diff(ends[:, 0])[:-1], dash, atol=1e-3)
    assert np.all(ends[:, 2] < -1.0 - 0.055)


def test_a_run_without_a_path_has_none(trial):
    assert lines.dash_path(trial, -1.0) == []


def test_the_trail_keeps_its_corners_where_they_were(trial):
    early, late = lines.trace_center(trial, 3.03, -1.0), lines.trace_center(trial, 5.98, -1.0)
    np.testing.assert_array_equal(early[:-1], late[: len(early) - 1])
    np.testing.assert_allclose(late[-1], [*lines.interpolate_centers(trial, [5.98])[0], -1.0])


# ---- pictures ------------------------------------------------------------------------------------


def test_words_stand_on_the_picture_and_elsewhere_it_stays_what_it_was():
    empty = np.full((216, 384, 3), 60, dtype=np.uint8)
    written = write_captions(empty, [Figure("12.3", "s")], ["mamba"])
    changed = np.argwhere(np.any(written != empty, axis=2))
    assert changed.size and not np.any(empty != 60)
    middle = written[54:150]
    assert np.all(middle == 60)
    assert np.all(written[:, 250:] == 60)


def test_a_still_shows_the_robot_its_head_and_the_water(trial, tmp_path, screen):
    render.write_still(trial, tmp_path / "still.png", film=Film(size=(640, 360)), time=3.0)
    picture = np.asarray(Image.open(tmp_path / "still.png")).astype(int)
    assert picture.shape == (360, 640, 3)
    red, green, blue = np.moveaxis(picture, 2, 0)
    orange = (red > 150) & (green < 0.6 * red) & (blue < 60)
    assert 100 < np.count_nonzero(orange) < 5000
    assert np.argwhere(orange)[:, 1].mean() > 320  # the head is on the right
    assert np.count_nonzero((blue > red + 20) & (green > red + 20)) > 0.6 * red.size
    dark = red + green + blue < 110
    assert np.count_nonzero(dark) > 1000


def test_the_same_moment_is_the_same_picture_and_another_is_not(trial, tmp_path, screen):
    for name, time in (("a", 2.0), ("b", 2.0), ("c", 2.5)):
        render.write_still(trial, tmp_path / f"{name}.png", film=SMALL, time=time)
    a, b, c = ((tmp_path / f"{name}.png").read_bytes() for name in "abc")
    assert a == b != c


def test_a_trial_of_one_sample_can_be_shown(trial, tmp_path, screen):
    series = {
        name: value[:1]
        for name, value in vars(trial).items()
        if getattr(value, "shape", (0,))[0] > 1
    }
    one = replace(trial, **series, state={})
    assert one.time.size == one.link_angle.shape[0] == 1
    render.write_still(one, tmp_path / "one.png", SMALL)


def test_the_speed_in_the_picture_is_the_trials():
    trial = swum("mamba", duration=20.0)
    assert measure_speed(trial, 0.0) == 0.0
    assert measure_speed(trial, 20.0) == pytest.approx(trial.steady_velocity, rel=0.01)


def test_the_words_say_who_swims_and_how(trial):
    assert describe_run(trial) == [
        "mamba-fin",
        "lateral undulation, 30°, 130°/s, phase shift 40°",
    ]
    assert describe_run(trial, 2.0)[0] == "mamba-fin  (shown at 2 times its speed)"
    assert describe_run(without_gait(trial)) == ["mamba-fin"]


# ---- films ---------------------------------------------------------------------------------------


def test_a_film_has_the_trials_length_and_a_format_that_every_player_plays(trial, tmp_path, screen):
    seen = []
    slow = replace(SMALL, frames_per_second=5.0)
    render.render_film(trial, tmp_path / "film.mp4", slow, speed=2.0, progress=seen.append)
    words = ["ffmpeg", "-i", str(tmp_path / "film.mp4"), "-f", "null", "-"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stderr
    assert "h264" in said and "yuv420p" in said and "192x108" in said and "5 fps" in said
    assert len(seen) == 16  # 6 s at twice the speed, both ends
    assert seen[0] == 0.0 and seen[-1] == 6.0
    assert "frame=   16" in said
    assert [file.name for file in tmp_path.iterdir()] == ["film.mp4"]


def test_a_film_that_breaks_off_leaves_the_old_file_alone(tmp_path, screen):
    def pictures():
        yield np.zeros((64, 64, 3), dtype=np.uint8)
        raise ZeroDivisionError

    (tmp_path / "film.mp4").write_text("old")
    with pytest.raises(ZeroDivisionError):
        video.write_video(pictures(), tmp_path / "film.mp4", size=(64, 64), frames_per_second=10.0)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]


def test_what_ffmpeg_complains_about_is_passed_on(tmp_path, screen):
    empty = iter([np.zeros((63, 63, 3), dtype=np.uint8)] * 3)
    with pytest.raises(video.VideoFailed, match=r"ffmpeg could not write .*film\.mp4: "):
        video.write_video(empty, tmp_path / "film.mp4", size=(63, 63), frames_per_second=10.0)
    assert not list(tmp_path.iterdir())


def test_bad_sizes_and_speeds_are_refused(trial, tmp_path):
    with pytest.raises(ValueError, match=r"`size` must be even for a video, got \(101, 64\)\."):
        render.render_film(trial, tmp_path / "a.mp4", Film(size=(101, 64)))
    with pytest.raises(ValueError, match=r"`size\[1\]` must be between 64 and 4096, got 5000\."):
        Film(size=(640, 5000))
    with pytest.raises(ValueError, match=r"`end` must be between 2 and 6 s, got 1"):
        render.render_film(trial, tmp_path / "a.mp4", Film(begin=2.0, end=1.0))
    with pytest.raises(ValueError, match=r"`speed` must be > 0, got 0"):
        render.render_film(trial, tmp_path / "a.mp4", speed=0)
    with pytest.raises(ValueError, match=r"`time` must be between 0 and 6 s, got 7"):
        render.write_still(trial, tmp_path / "a.png", time=7)


# ---- what is missing -----------------------------------------------------------------------------


def test_without_ffmpeg_the_message_says_what_to_install(trial, tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(
        MissingProgram,
        match=r"Writing a video needs the program ffmpeg; .*`apt-get install ffmpeg`",
    ):
        render.render_film(trial, tmp_path / "a.mp4")


@pytest.mark.parametrize(
    "error", [AttributeError("'NoneType' object has no attribute 'eglQueryString'"), ImportError()]
)
def test_without_egl_the_message_says_what_to_install(trial, tmp_path, monkeypatch, error):
    def fail(name):
        raise error

    monkeypatch.setattr(renderer, "import_module", fail)
    with pytest.raises(
        MissingProgram, match=r"Rendering without a screen needs EGL .*apt-get install libegl1 "
    ):
        render.write_still(trial, tmp_path / "a.png")


def test_without_pyopengl_the_extra_is_named(trial, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenGL", None)
    with pytest.raises(
        MissingExtra, match=r'Rendering needs PyOpenGL; run `pip install .*\[spatial\]"`'
    ):
        render.write_still(trial, tmp_path / "a.png")


def test_rendering_is_loaded_only_when_it_is_used():
    code = (
        "import sys, laticauda.cli.trial, laticauda.cli.swim; "
        "sys.exit('mujoco' in sys.modules or 'PIL' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_spatial_run_says_how_it_was_turned_and_is_shown_so():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    trial = lc.swim(lc.load_robot("mamba-modules-fin"), gait, duration=2.0, model="spatial")
    turned = np.stack([trial.signals[f"orientation_{part}"] for part in "wxyz"], axis=1)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1.0, atol=1e-6)
    replay = Studio.of_trial(trial)
    go_to(replay, trial, 2.0)
    for i, angle in enumerate(trial.link_angle[-1]):
        forward = replay.data.body(f"module_{i}").xmat.reshape(3, 3)[:, 0]
        assert math.atan2(forward[1], forward[0]) == pytest.approx(angle, abs=1e-6)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_state_of_a_plant_is_a_picture_without_a_trial(screen, model):
    """As environments show themselves; it is the posture that the log of the same run has there."""
    scenario = lc.build_scenario(
        "mamba-modules-fin", lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7), model=model
    )
    plant = lc.build_plant(scenario)
    command = lc.Command(gait=scenario.gait)
    state, log, _ = plant.march(plant.init(scenario.start, command), command, 1.0, 0.1)
    posture = read_posture(plant, state)
    np.testing.assert_allclose(
        posture.center_of_mass[: log.center_of_mass.shape[1]], log.center_of_mass[-1], atol=1e-9
    )
    with closing(Studio.of(plant, size=(128, 72))) as studio:
        studio.take(posture)
        tail = studio.data.body("module_0").xmat.reshape(3, 3)
        assert math.atan2(tail[1, 0], tail[0, 0]) == pytest.approx(log.link_angle[-1, 0], abs=1e-6)
        first, again = (studio.picture(posture) for _ in range(2))
    assert first.shape == (72, 128, 3) and first.dtype == np.uint8
    np.testing.assert_array_equal(first, again)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 100


NET = """<mujoco><worldbody><flexcomp name="net" type="grid" count="4 4 1" spacing=".05 .05 .05" radius=".003"
 dim="2" mass=".3" pos="1.05 0 -.5" euler="0 90 0"><edge equality="true"/></flexcomp>
<body name="leaf" pos="3 0 -.5"><joint type="slide" damping="1"/><geom size=".05"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("root", ["planar", "free"])
def test_what_moves_in_a_scene_is_shown_where_it_is_nets_included(tmp_path, root):
    (tmp_path / "net.xml").write_text(NET)
    scene = str(tmp_path / "net.xml")
    settings = {"model": "spatial", "scene": scene, "root": root}
    moving = replace(lc.load_water("paper-lateral"), current=(0.5, 0.2))
    plant = lc.build_plant("mamba", moving, **settings)
    command = lc.Command(gait=lc.lateral_undulation(amplitude=0.3, frequency=3.0, phase_shift=0.7))
    first = plant.init(lc.Start(), command)
    later = plant.step(first, command, 0.3)
    studio = Studio.of(plant)
    places = []
    for state in (first, later):
        studio.take(read_posture(plant, state))
        shown, right = studio.data, plant.data(state)
        knots = np.array([right.body(f"net_{k}").xpos for k in range(16)])
        np.testing.assert_allclose(shown.flexvert_xpos, knots, atol=1e-12)
        leaf = shown.body("leaf").xpos
        np.testing.assert_allclose(leaf, right.body("leaf").xpos, atol=1e-12)
        places.append(knots)
    assert np.max(np.abs(places[1] - places[0])) > 1e-3
