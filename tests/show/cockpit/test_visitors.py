"""Who is answered by the page's server, over real sockets."""

import asyncio
import gc
import http.client
import logging
import socket

import msgspec
import pytest
from patience import until

from laticauda.show.cockpit import server
from laticauda.values.access import ServerAccess

viser = pytest.importorskip("viser")
websockets = pytest.importorskip("websockets")
PROTOCOL = f"viser-v{viser.__version__}"


CAMERA = {
    "type": "ViewerCameraMessage",
    **dict.fromkeys(("position", "up_direction"), (0.0, 0.0, 1.0)),
    **dict.fromkeys(("fov", "near", "far"), 1.0),
    **{"look_at": (0.0, 1.0, 0.0), "wxyz": (1.0, 0.0, 0.0, 0.0)},
    **{"image_height": 1, "image_width": 1},
}


class Served:
    """A server of empty pages, and what it answers."""

    def __init__(self, host):
        self.door = ServerAccess.of(host)
        self.server = server.start_server(self.door, 0)
        self.port = self.server.get_port()
        self.host = f"127.0.0.1:{self.port}"

    def get(self, path="/", **headers):
        wire = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20.0)
        wire.putrequest("GET", path, skip_host=True)
        for name, word in {"Host": self.host, **headers}.items():
            wire.putheader(name.replace("_", "-"), word)
        wire.endheaders()
        answer = wire.getresponse()
        answer.text = answer.read().decode()
        wire.close()
        return answer

    def messages(self, path="/", sends=None, protocol=PROTOCOL, **headers):
        """Whether a websocket gets messages; with something to send, how it is hung up on."""

        async def talk():
            where = f"ws://{headers.pop('Host', self.host)}{path}"
            way = {
                "host": "127.0.0.1",
                "port": self.port,
                "subprotocols": [protocol],
                "additional_headers": headers,
            }
            try:
                async with websockets.connect(where, **way) as wire:
                    got = len(await asyncio.wait_for(wire.recv(), 20.0)) > 0
                    while sends is not None:
                        await wire.send(sends)
                        await asyncio.wait_for(wire.recv(), 20.0)
                    return got
            except websockets.exceptions.InvalidStatus as error:
                return error.response.status_code
            except websockets.exceptions.ConnectionClosed as error:
                return error.rcvd.code

        return asyncio.run(talk())


@pytest.fixture(scope="module")
def own():
    served = Served("127.0.0.1")
    yield served
    server.stop_server(served.server)


def test_its_own_page_is_answered_and_stands_in_no_other_and_talks_to_its_server_alone(own):
    answer = own.get()
    assert answer.status == 200 and "<html" in answer.text
    policy = answer.headers["Content-Security-Policy"]
    assert "frame-ancestors 'none'" in policy and "connect-src 'self'" in policy
    assert own.messages() is True
    assert own.messages(Origin=f"http://{own.host}") is True


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "http://127.0.0.1:1"},
        {"Origin": "null"},
        {"Host": "evil.example"},
        {"Host": "evil.example", "Origin": "http://evil.example"},
    ],
)
def test_pages_of_others_get_nothing(own, headers):
    assert own.get(**headers).status == 403
    assert own.messages(**headers) == 403


@pytest.fixture(scope="module")
def public():
    served = Served("0.0.0.0")
    yield served
    server.stop_server(served.server)


def test_beyond_this_computer_a_page_is_answered_that_has_the_token_and_nobody_else(
    public, caplog, capfd
):
    token = public.door.token
    with caplog.at_level(logging.INFO):
        for path in ("/", "/index.html", f"/?{token}", f"/{token[::-1]}/"):
            assert public.get(path).status == public.messages(path) == 403
        for path in (f"/{token}/", f"/{token}", f"/{token}/?darkMode"):
            assert "<html" in public.get(path).text
            assert public.messages(path) is True
        assert public.get(f"/{token}/../../setup.py").status == 404
        assert public.messages(f"/{token}/", Origin="http://evil.example") == 403
    assert public.get(f"/{token}/").headers["Referrer-Policy"] == "no-referrer"
    assert token not in caplog.text + "".join(capfd.readouterr())


JUNK = (b"junk", "junk", b"", b"\x81\xa4type\xa4nope", b"\x81\xa4type\xb3GuiUpdateMessage")


@pytest.mark.parametrize("junk", JUNK, ids=range(len(JUNK)))
def test_junk_leaves_one_line_and_no_traceback(own, caplog, capfd, junk):
    with caplog.at_level(logging.INFO):
        assert own.messages(sends=junk) == 1011
    (record,) = [one for one in caplog.records if one.levelno >= logging.WARNING]
    assert record.getMessage().startswith("A page was disconnected: ") and record.exc_info is None
    assert "\n" not in record.getMessage()
    assert "Traceback" not in "".join(capfd.readouterr())
    assert own.messages() is True


def test_bytes_that_are_no_http_leave_one_line_and_no_bytes_leave_none(own, caplog):
    for junk in (b"\x16\x03\x01junk\r\n\r\n", b""):
        with socket.create_connection(("127.0.0.1", own.port), timeout=20.0) as wire:
            wire.sendall(junk)
            wire.shutdown(socket.SHUT_WR)
            while wire.recv(1000):
                pass
    assert own.get().status == 200
    assert [one.exc_info for one in caplog.records if one.levelno >= logging.WARNING] == [None]


def test_a_page_changes_values_of_controls_and_nothing_else_of_them(own):
    number = own.server.gui.add_number("number", initial_value=1.0)
    changes = [{"removed": True}, {"label": "mine"}, {"value": 2.0, "visible": False}]

    async def send(updates):
        way = {"host": "127.0.0.1", "port": own.port, "subprotocols": [PROTOCOL]}
        async with websockets.connect(f"ws://{own.host}/", **way) as wire:
            message = {"type": "GuiUpdateMessage", "uuid": number._impl.uuid, "updates": updates}
            await wire.send(msgspec.msgpack.encode(message))
            await asyncio.sleep(0.3)

    for change in changes:
        asyncio.run(send(change))
    assert (number.value, number.label, number.visible) == (1.0, "number", True)
    assert not number._impl.removed
    asyncio.run(send({"value": 3.0}))
    until(lambda: number.value == 3.0)
    assert number.value == 3.0
    number.remove()


def send_and_wait(own, *messages):
    """Send messages from a page, and look once they have been handled."""

    async def talk():
        way = {"host": "127.0.0.1", "port": own.port, "subprotocols": [PROTOCOL]}
        async with websockets.connect(f"ws://{own.host}/", **way, max_size=None) as wire:
            for message in (CAMERA, *messages):
                await wire.send(msgspec.msgpack.encode(message))
            await asyncio.sleep(0.3)
            pages = own.server.get_clients().values()
            return [(page.camera.position, page.camera.aspect) for page in pages]

    return asyncio.run(talk())


@pytest.mark.parametrize(
    "change",
    [
        {"image_height": 0},
        {"position": (float("nan"), 0.0, 0.0)},
        {"position": (1e308, 0.0, 0.0), "look_at": (-1e308, 0.0, 0.0)},
        {"look_at": (0.0, 0.0, 1.0)},
        {"wxyz": (0.0, 0.0, 0.0, 0.0)},
    ],
    ids=str,
)
def test_a_camera_that_cannot_be_is_ignored(own, change, caplog):
    ((position, aspect),) = send_and_wait(own, CAMERA | change)
    assert position.tolist() == [0.0, 0.0, 1.0] and aspect == 1.0
    assert caplog.records == []


def test_nothing_is_kept_of_messages_that_no_page_sends(own):
    kept = own.server._websock_server.get_message_buffer().message_from_id
    dirty = [{"type": "GuiFormDirtyMessage", "uuid": f"{k}" + "x" * 1000} for k in range(9)]
    send_and_wait(own, *dirty)
    assert not [message for message in kept.values() if "x" * 100 in getattr(message, "uuid", "")]


def test_a_page_of_another_version_is_refused_and_nothing_of_it_is_printed(own, capfd):
    for protocol in ("viser-v9.9.9", "viser-v" + "x" * 500):
        assert own.messages(protocol=protocol) == 400
    assert capfd.readouterr().out == ""


def test_pages_that_leave_while_they_are_written_to_are_not_counted_on_the_screen(own, caplog):
    logging.getLogger("asyncio").warning("socket.send() raised exception.")
    logging.getLogger("asyncio").warning("something else")
    assert [record.getMessage() for record in caplog.records] == ["something else"]


def test_no_page_can_ask_for_an_address_on_the_internet(own):
    from viser._messages import ShareUrlRequest

    assert ShareUrlRequest not in own.server._websock_server._incoming_handlers


def test_a_viser_that_would_serve_everybody_is_refused(monkeypatch):
    import websockets.asyncio.server as module

    usual = module.serve
    with (
        pytest.raises(server.LaticaudaError, match=r"install viser 1\.1"),
        server.guard_websockets(ServerAccess.of("127.0.0.1")),
    ):
        pass  # a viser that makes its server otherwise
    assert module.serve is usual


def test_what_pages_leave_behind_is_collected_though_python_does_not_look_for_it(own):
    def connections():
        return sum(type(one).__name__ == "ServerConnection" for one in gc.get_objects())

    gc.collect()
    gc.disable()
    try:
        before = connections()
        for _ in range(30):
            assert own.messages() is True
        assert connections() - before <= 11
    finally:
        gc.enable()
