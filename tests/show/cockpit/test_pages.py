import asyncio
import contextlib
import threading
from types import SimpleNamespace

import numpy as np
import pytest

from laticauda.show.cockpit.cameras import AHEAD, HOME, PHONE, PageCamera, PageCameras


class Camera:
    """Stands for the camera of a page: remembers in which threads it was moved."""

    def __init__(self):
        self.__dict__.update(
            position=np.array([9.0, 9.0, 9.0]),
            look_at=np.zeros(3),
            threads=set(),
            heard=None,
            aspect=1.8,
        )

    def __setattr__(self, name, value):
        self.threads.add(threading.get_ident())
        self.__dict__[name] = np.array(value)

    def on_update(self, heard):
        self.__dict__["heard"] = heard

    def report(self, position, look_at):
        """What the page says of it."""
        self.__dict__.update(position=np.array(position), look_at=np.array(look_at))
        asyncio.run(self.heard(self))


class Client:
    """Stands for a page."""

    def __init__(self, number=0):
        self.client_id, self.camera, self.gui, self.clicked = number, Camera(), self, None

    def add_folder(self, label):
        return contextlib.nullcontext()

    def add_checkbox(self, label, value):
        return SimpleNamespace(value=value)

    def add_button(self, label):
        return SimpleNamespace(on_click=lambda heard: setattr(self, "clicked", heard))

    def atomic(self):
        return contextlib.nullcontext()


class Server:
    """Stands for the server of the pages."""

    def on_client_connect(self, heard):
        self.welcome = heard

    def on_client_disconnect(self, heard):
        self.forget = heard


@pytest.fixture
def loop():
    """A loop that runs in a thread of its own, as the server's does."""
    found = asyncio.new_event_loop()
    thread = threading.Thread(target=found.run_forever)
    thread.start()
    yield SimpleNamespace(
        thread=thread,
        wait=lambda what: asyncio.run_coroutine_threadsafe(what, found).result(10.0),
        call=found.call_soon_threadsafe,
    )
    found.call_soon_threadsafe(found.stop)
    thread.join()
    found.close()


def test_cameras_are_moved_where_reports_of_the_pages_arrive_so_none_can_come_in_between(loop):
    server, client = Server(), Client()
    cameras = PageCameras(server)
    cameras.show(np.zeros(2))  # nobody is there
    loop.wait(server.welcome(client))
    cameras.show(np.array([2.0, 1.0]))
    loop.wait(asyncio.sleep(0))  # what was called before is done
    assert client.camera.threads == {loop.thread.ident}
    np.testing.assert_allclose(client.camera.look_at, (2.0 + AHEAD, 1.0, 0.0))
    assert len(cameras.all()) == 1
    loop.wait(server.forget(client))
    assert len(cameras.all()) == 0


def test_a_camera_is_brought_home_until_its_page_says_so_and_then_keeps_the_direction_that_somebody_gives_it():
    client = Client()
    view, camera = PageCamera(client), client.camera
    position, look_at = (np.array(value) for value in HOME)
    at = np.array([3.0, -1.0, 0.0])
    camera.report((9.0, 9.0, 9.0), (0.0, 0.0, 0.0))  # from before it was brought here
    assert not view.is_home
    view.show(at[:2])
    np.testing.assert_allclose(camera.position, at + position)
    camera.report(at + position, at + look_at)
    assert view.is_home
    turned = np.array([0.0, 2.0, 3.0])
    for late in (1.0, 0.3):  # a report is old, but direction and distance are right
        camera.report(at - late + look_at + turned, at - late + look_at)
        view.show(at[:2])
        np.testing.assert_allclose(camera.look_at, (at[0] + AHEAD, at[1], 0.0))
        np.testing.assert_allclose(camera.position - camera.look_at, turned)
    view.follows.value = False
    before = camera.position.copy()
    view.show(at[:2] + 1.0)
    np.testing.assert_array_equal(camera.position, before)
    asyncio.run(client.clicked(None))
    view.show(at[:2])
    np.testing.assert_allclose(camera.position, at + position)


def test_the_camera_of_a_phone_stands_further_off_and_looks_below_the_robot():
    client = Client()
    view, camera = PageCamera(client), client.camera
    camera.__dict__["aspect"] = 0.46
    position, look_at = PHONE
    at = np.array([3.0, -1.0, 0.0])
    camera.report(*HOME)  # where every page begins
    assert not view.is_home
    view.show(at[:2])
    np.testing.assert_allclose((camera.position, camera.look_at), (at + position, at + look_at))
    camera.report(at + position, at + look_at)
    assert view.is_home


def test_a_loop_that_is_slower_than_the_frames_shows_the_last_place_once(loop):
    server, client = Server(), Client()
    cameras = PageCameras(server)
    loop.wait(server.welcome(client))
    shown = []
    cameras.all()[0].show = shown.append
    busy = threading.Event()
    loop.call(busy.wait)
    for x in range(50):
        cameras.show(np.array([float(x), 0.0]))
    busy.set()
    loop.wait(asyncio.sleep(0))
    np.testing.assert_array_equal(shown, [[49.0, 0.0]])
