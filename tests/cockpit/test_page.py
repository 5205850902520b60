"""The page in a browser: what somebody does on it, and what comes of it."""

import math
import time

import numpy as np
import pytest
from cockpit_browser import browser, on_screen, open_page, shots

import laticauda as lc
from laticauda.cockpit import Cockpit, Live, Setting
from laticauda.cockpit.gait_map import gait_map

pytestmark = pytest.mark.slow
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


@pytest.fixture
def cockpit():
    pytest.importorskip("viser")
    served = Cockpit(Live(Setting(robot=lc.load_robot("mamba"), gait=GAIT)), port=0)
    served.open()
    yield served
    served.close()


def until(condition, patience=40.0):
    """Wait until a condition holds; whether it did."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.1)
    return bool(condition())


def choose(page, present, wanted):
    page.locator(f"input[value={present}]").first.click()
    page.get_by_role("option", name=wanted, exact=True).click()


def picture(page):
    """The 3D picture, without the panel."""
    import io

    from matplotlib.image import imread

    return imread(io.BytesIO(page.screenshot(clip={"x": 320, "y": 0, "width": 540, "height": 800})))


def test_what_is_done_on_the_page_acts_at_once_and_is_seen(cockpit, tmp_path):
    live, folder = cockpit.live, shots(tmp_path)
    gait_map(live.setting)  # compiles, where nobody waits for it
    with browser() as found:
        page = open_page(found, cockpit.address)
        assert until(lambda: page.get_by_text("m/s").count() > 0)
        assert until(lambda: (live.numbers().cycle_velocity or 0.0) > 0.1)
        page.screenshot(path=folder / "1-swims.png")
        before, speed = picture(page), live.numbers().cycle_velocity

        # A slider: the gait, the speed and the picture change.
        thumb = page.get_by_role("slider").nth(1)
        for _ in range(10):
            thumb.press("ArrowLeft")
        assert until(lambda: math.degrees(live.setting.gait.frequency) == pytest.approx(80.0))
        assert until(lambda: live.numbers().time > 8.0)
        assert live.numbers().cycle_velocity < 0.8 * speed
        shown = f"{live.numbers().cycle_velocity:.2f}"
        assert until(lambda: page.get_by_text(shown).count() > 0)
        assert np.abs(picture(page) - before).max() > 0.2

        # The fin.
        choose(page, "none", "rigid")
        assert until(lambda: live.setting.robot.caudal_fin is not None)
        time.sleep(3.0)
        page.screenshot(path=folder / "2-fin.png")

        # A rigidity that cannot be is refused in the words of the API, and the field goes back.
        choose(page, "rigid", "elastic")
        assert until(lambda: live.setting.robot.caudal_fin.n_hinges == 3)
        field = page.get_by_role("textbox").filter(has_not_text="x").locator("xpath=self::*[@value='0.2']").first
        field.fill("-1")
        field.press("Enter")
        message = "`flexural_rigidity` must be > 0 N m^2, got -1"
        assert until(lambda: page.get_by_text(message).count() > 0)
        page.screenshot(path=folder / "3-refused.png")
        assert live.setting.robot.caudal_fin.flexural_rigidity == 0.2
        choose(page, "elastic", "none")

        # A click on the map.
        page.get_by_role("tab", name="Map").click()
        page.get_by_text("show the map").click()
        assert until(lambda: cockpit._board._frame is not None)
        time.sleep(4.0)
        live.paused = True
        time.sleep(3.0)
        page.screenshot(path=folder / "4-map.png")
        (client,) = cockpit._server.get_clients().values()
        wanted = (40.0, 160.0)
        page.mouse.click(*on_screen(client.camera, cockpit._board.place_of(*wanted)))
        assert until(lambda: live.setting.gait.amplitude != GAIT.amplitude)
        gait = live.setting.gait
        assert (math.degrees(gait.amplitude), math.degrees(gait.frequency)) == pytest.approx(wanted)
        page.get_by_text("show the map").click()
        live.paused = False

        # A path: the error falls.
        page.get_by_role("tab", name="Swim").click()
        page.get_by_text("follow a path").click()
        assert until(lambda: live.setting.path is not None)
        first = abs(live.numbers().cross_track_error)
        live.speed = 4.0
        assert first > 0.3
        assert until(lambda: abs(live.numbers().cross_track_error) < 0.3 * first)
        live.speed = 1.0
        time.sleep(3.0)
        page.screenshot(path=folder / "5-path.png")
        page.get_by_role("tab", name="Plots").click()
        time.sleep(3.0)
        page.screenshot(path=folder / "6-plots.png")
        page.get_by_role("tab", name="Run").click()
        time.sleep(2.0)
        page.screenshot(path=folder / "7-run.png")


def test_a_broken_file_says_what_is_wrong_and_a_whole_one_swims_as_a_ghost(cockpit, tmp_path):
    live = cockpit.live
    (tmp_path / "broken.nc").write_bytes(b"no netCDF")
    lc.swim(live.setting.robot, GAIT, 5.0).save(tmp_path / "run.nc")
    with browser() as found:
        page = open_page(found, cockpit.address)
        page.get_by_role("tab", name="Run").click()
        with page.expect_file_chooser() as chooser:
            page.get_by_text("play back a trial").click()
        chooser.value.set_files(tmp_path / "broken.nc")
        assert until(lambda: page.get_by_text("Cannot load broken.nc").count() > 0)
        with page.expect_file_chooser() as chooser:
            page.get_by_text("play back a trial").click()
        chooser.value.set_files(tmp_path / "run.nc")
        assert until(lambda: cockpit._runs._ghost is not None)
        time.sleep(3.0)
        page.screenshot(path=shots(tmp_path) / "8-ghost.png")
        with page.expect_download() as download:
            page.get_by_text("save the run").click()
        download.value.save_as(tmp_path / "saved.nc")
    assert lc.load_trial(tmp_path / "saved.nc").robot == live.setting.robot


def test_pages_keep_their_own_view_and_one_that_vanishes_harms_nothing(cockpit):
    with browser() as found:
        one, two = open_page(found, cockpit.address), open_page(found, cockpit.address)
        assert until(lambda: len(cockpit._follows) == 2)
        one.get_by_text("camera follows").click()
        assert until(lambda: sorted(box.value for box in cockpit._follows.values()) == [False, True])
        cockpit.live.speed = 8.0
        stays, goes = (
            next(c for n, c in cockpit._server.get_clients().items() if cockpit._follows[n].value is follows)
            for follows in (False, True)
        )
        before = np.array(stays.camera.position)
        assert until(lambda: cockpit.live.latest()["center_of_mass"][0] > 2.0)
        np.testing.assert_allclose(stays.camera.position, before, atol=1e-3)
        assert goes.camera.position[0] > before[0] + 1.0
        for handle in (one, two):
            handle.context.close()
        assert until(lambda: cockpit.pages == 0)
        ticks = cockpit.live.world.ticks
        assert until(lambda: cockpit.live.world.ticks > ticks + 20)
        assert cockpit._follows == {}
