"""Files that somebody sends to the page: bounded while they come, and read by another process."""

import asyncio
import contextlib
import sys
import threading
import time
from types import SimpleNamespace

import msgspec
import pytest

import laticauda as lc
from laticauda.show.cockpit import files, runs, server, uploads
from laticauda.values.access import ServerAccess
from laticauda.values.errors import LaticaudaError, TrialFileError

viser = pytest.importorskip("viser")
websockets = pytest.importorskip("websockets")
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="needs limits of the system")


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / "run.nc"
    lc.swim(
        "mamba", lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7), 2.0
    ).save(path)
    return path


def test_what_another_process_has_read_is_the_trial_bit_for_bit(saved):
    assert files.load_uploaded_trial(saved, "mine.nc").equals(lc.load_trial(saved))


@LINUX
def test_a_file_that_needs_too_much_memory_is_refused_and_the_page_goes_on(saved, monkeypatch):
    monkeypatch.setattr(
        files, "MEMORY_LIMIT", 1 << 20
    )  # less than it has already: whatever it asks for next, it does not get
    with pytest.raises(
        TrialFileError, match=r"Cannot load mine\.nc: its reader ended at once, or exceeded 1 MiB\."
    ):
        files.load_uploaded_trial(saved, "mine.nc")


def test_a_file_that_takes_too_long_is_refused(saved, monkeypatch):
    monkeypatch.setattr(files, "TIME_LIMIT", 0.01)
    with pytest.raises(
        TrialFileError, match=r"Cannot load mine\.nc: reading it takes longer than 0\.01 s\."
    ):
        files.load_uploaded_trial(saved, "mine.nc")


CAMERA = msgspec.msgpack.encode(
    {
        "type": "ViewerCameraMessage",
        **dict.fromkeys(("position", "up_direction"), (0.0, 0.0, 1.0)),
        "look_at": (0.0, 1.0, 0.0),
        **dict.fromkeys(("fov", "near", "far"), 1.0),
        **{"wxyz": (1.0, 0.0, 0.0, 0.0), "image_height": 1, "image_width": 1},
    }
)


@pytest.fixture
def sending(monkeypatch):
    """What a page sends of files, and how many bytes the server keeps of it then."""
    monkeypatch.setattr(uploads, "MOST_UPLOADED", 100_000)
    monkeypatch.setattr(uploads, "PART_COST", 100)
    viser_server = server.start_server(ServerAccess.of("127.0.0.1"), 0)
    got = []
    button = viser_server.gui.add_upload_button("send")
    button.on_upload(lambda event: got.append(len(event.target.value.content)))
    kept = viser_server.gui._current_file_upload_states

    async def talk(said):
        where = f"ws://127.0.0.1:{viser_server.get_port()}"
        async with websockets.connect(
            where, subprotocols=[f"viser-v{viser.__version__}"], max_size=None
        ) as wire:
            await wire.send(CAMERA)  # or it is no page yet
            for kind, fields in said:
                fields = {"source_component_uuid": button._impl.uuid} | fields
                await wire.send(msgspec.msgpack.encode({"type": f"FileTransfer{kind}", **fields}))
            with contextlib.suppress(
                websockets.ConnectionClosedError
            ):  # viser ends it over words for numbers
                await (await wire.ping())
            end, held = time.monotonic() + 1.0, 0
            while time.monotonic() < end and not got:
                held = sum(
                    state["transferred_bytes"] + len(state["parts"]) for state in kept.values()
                )
                await asyncio.sleep(0.05)
            return held

    yield SimpleNamespace(send=lambda said: asyncio.run(talk(said)), got=got, server=viser_server)
    server.stop_server(viser_server)


def begun(name, parts, size):
    said = {
        "transfer_uuid": name,
        "filename": "run.nc",
        "mime_type": "",
        "part_count": parts,
        "size_bytes": size,
    }
    return "StartUpload", said


def part(name, index, size):
    return "Part", {"transfer_uuid": name, "part_index": index, "content": b"x" * size}


def test_a_file_within_the_bound_comes(sending):
    sending.send([begun("a", 2, 90_000), part("a", 0, 45_000), part("a", 1, 45_000)])
    assert sending.got == [90_000]


@pytest.mark.parametrize(
    "said",
    [
        [
            begun("a", 3, 150_000),
            *(part("a", i, 50_000) for i in range(2)),
        ],  # one that is too large
        [begun("a", 9, 9), *(part("a", i, 50_000) for i in range(8))],  # one that lies about it
        [one for k in "abcde" for one in (begun(k, 3, 99_999), part(k, 0, 49_000))],  # several
        [begun("a", 10_000, 9), *(part("a", i, 0) for i in range(2000))],  # parts of nothing
    ],
)
def test_what_is_sent_beyond_the_bound_is_not_kept(sending, said):
    assert sending.send(said) <= 100_000
    assert sending.got == []


def test_what_pages_were_told_of_their_files_is_not_kept_for_ever(sending):
    kept = sending.server._websock_server.get_message_buffer().message_from_id
    for name in "abc":
        sending.send([begun(name, 50, 9), *(part(name, i, 0) for i in range(49))])
    told = [one for one in kept.values() if type(one).__name__ == "FileTransferPartAck"]
    assert len(told) <= 49


def test_only_buttons_for_files_take_files_and_names_and_sizes_have_to_be_some(sending):
    gui = sending.server.gui
    number = gui.add_number("number", initial_value=1.0)
    kind, fields = begun("a", 0, 0)
    for change in (
        {"source_component_uuid": number._impl.uuid},
        {"source_component_uuid": None},
        {"filename": "x" * 10_000},
        {"transfer_uuid": "x" * 10_000},
        {"size_bytes": "many", "part_count": 3},
        {"part_count": -1},
    ):
        sending.send([(kind, fields | change)])
    assert sending.got == []
    assert number.value == 1.0
    assert gui._current_file_upload_states == {}


def test_while_a_file_is_read_another_one_is_refused_at_once(monkeypatch):
    reading, read = threading.Event(), threading.Event()

    def load(path, name):
        reading.set()
        read.wait(20.0)
        raise TrialFileError("It was read.")

    monkeypatch.setattr(runs, "load_uploaded_trial", load)
    owner, said = object.__new__(runs.Runs), []
    owner._reading = threading.Lock()
    page = SimpleNamespace(add_notification=lambda title, text, **how: said.append(text))
    file = SimpleNamespace(name="run.nc", content=b"")
    event = SimpleNamespace(client=page, target=SimpleNamespace(value=file))
    first = threading.Thread(target=owner._load, args=[event])
    first.start()
    assert reading.wait(20.0)
    for _ in range(100):
        owner._load(event)
    assert said == ["Another file is being read or written: try again in a moment."] * 100
    read.set()
    first.join()
    assert said[100:] == ["It was read."]


def test_a_page_that_does_not_take_its_files_is_sent_no_more_of_them():
    unsent = dict.fromkeys(range(runs.MOST_UNSENT + 1))
    buffer = SimpleNamespace(message_from_id=unsent)
    wire = SimpleNamespace(get_message_buffer=lambda: buffer)
    with pytest.raises(LaticaudaError, match=r"^This page has not yet received the files before"):
        runs._send_file(SimpleNamespace(_websock_connection=wire), "run.nc", b"")
