"""The pages: their server, which is viser's, what every page has for itself, its camera, and what people do on them.

What cameras do happens in the server's own loop, where the pages' reports arrive. In another thread, a report that
comes in between two lines would mix where the camera was with where it is, and one that follows would keep that error.
"""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnknownLambdaType=false

import asyncio
import contextlib
import functools
import gc
import io
import itertools
import logging
import socket
import threading
import time
import warnings
from collections.abc import Callable, Coroutine, Generator
from http import HTTPStatus
from importlib import import_module
from queue import SimpleQueue
from typing import Any, NamedTuple, TypeVar

import numpy as np

from laticauda.access import Door
from laticauda.cockpit.scene import HOME, PHONE
from laticauda.errors import LaticaudaError, optional_import

NARROW = 0.7  # width to height of a phone that is held upright, or less [-]
PATIENCE = 5.0  # how long a camera is brought to the robot until its page says that it is there [s]
POLICY = "connect-src 'self' data: blob:; frame-ancestors 'none'"
"""The page talks to its own server alone (viser's would follow an address in the link), and stands in no other one."""
MOST_UPLOADED = 128 << 20  # of files that pages are sending, and of one [bytes]
MOST_UPLOADS = 8  # that pages are sending at a time
PART_COST = 1000  # of a part of a file, beside its content [bytes]
MOST_SAID = 4 << 20  # of one message of a page [bytes]
Owner = TypeVar("Owner")


class PortTaken(LaticaudaError, OSError):
    """The page cannot be served where it was asked for."""


def load_viser() -> Any:
    """The module `viser`. Handles of its pages are `Any` here: their types change with the control.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The cockpit", "viser", "cockpit")


def serve(door: Door, port: int) -> Any:
    """A page's server, on this host and port alone: viser by itself would take the next free port, on all networks.

    Args:
        door: Whom it answers, and where.
        port: Its port; 0: any free one.

    Raises:
        MissingExtra: If viser is not installed.
        PortTaken: If something else listens there, or this computer has no such address.
    """
    viser, host = load_viser(), door.host
    try:
        with socket.create_server((host, port)) as probe:
            port = int(probe.getsockname()[1])
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise PortTaken(f"Cannot serve the cockpit at {host}:{port}: {why}; `port` 0 takes a free one.") from error
    with contextlib.redirect_stdout(io.StringIO()), _guarding(door):
        server = viser.ViserServer(host=host, port=port, label="laticauda", verbose=False)
    # viser would ask a service for an address on the internet, if a page wanted that.
    server._websock_server.unregister_handler(import_module("viser._messages").ShareUrlRequest)
    _limit_uploads(server)
    return server


def _limit_uploads(server: Any) -> None:
    """Throw away what pages send beyond a bound: viser keeps all of it until it is whole, and says that it has come."""
    messages, sent = import_module("viser._messages"), server.gui._current_file_upload_states

    def begun(page: int, message: Any) -> None:
        server._websock_server.get_message_buffer().remove_from_buffer(
            lambda one: isinstance(one, messages.FileTransferPartAck)
        )
        if message.size_bytes > MOST_UPLOADED or len(sent) > MOST_UPLOADS:
            sent.pop(message.transfer_uuid, None)
            refused = f"A file must have {MOST_UPLOADED >> 20} MiB or less, and come when few others do."
            if page in (there := server.get_clients()):
                there[page].add_notification("Refused", refused, color="red", auto_close_seconds=12.0)

    def came(_: int, message: Any) -> None:
        if sum(one["transferred_bytes"] + PART_COST * len(one["parts"]) for one in sent.values()) > MOST_UPLOADED:
            sent.pop(message.transfer_uuid, None)

    server._websock_server.register_handler(messages.FileTransferStartUpload, begun)
    server._websock_server.register_handler(messages.FileTransferPart, came)


def stop(server: Any) -> None:
    """Stop a server; it would say so on the standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


def time_scale() -> dict[str, Any]:
    """Of a plot whose x axis is seconds: uPlot would take it for dates."""
    return {"x": import_module("viser.uplot").Scale(time=False)}


# ---- who is answered -------------------------------------------------------------------------------------------------

_WIRE = logging.getLogger(f"{__name__}.wire")
_IS_TENTH_PAGE = itertools.cycle((False,) * 9 + (True,))


def _in_one_line(record: logging.LogRecord) -> bool:
    """Of what junk leads to, the sentence: it is no fault of ours, and no news if somebody just left."""
    error = record.exc_info[1] if record.exc_info else None
    if error is not None:
        record.msg, record.args, record.exc_info = f"A page was hung up on: {error!r:.200}", (), None
    return not isinstance(error and error.__cause__, EOFError)


_WIRE.addFilter(_in_one_line)


@contextlib.contextmanager
def _guarding(door: Door) -> Generator[None]:
    """Within it, servers of `websockets` answer whom they may answer: viser, which makes one, passes no rule on."""
    module: Any = import_module("websockets.asyncio.server")
    made, usual = list[str](), module.serve

    def serve(handler: Any, host: str, port: int, *, process_request: Any, **rest: Any) -> Any:
        def failed(_: Any, context: dict[str, Any]) -> None:
            _WIRE.error(context["message"], exc_info=context.get("exception"))

        asyncio.get_running_loop().set_exception_handler(failed)
        made.append(host)
        answer = functools.partial(_answered, door, process_request)
        return usual(handler, host, port, process_request=answer, logger=_WIRE, **{**rest, "max_size": MOST_SAID})

    module.serve = serve
    try:
        yield
    finally:
        module.serve = usual
    if not made:
        raise LaticaudaError("This viser serves its pages by other means, to everybody: install viser 1.1.")


def _answered(door: Door, usual: Any, connection: Any, request: Any) -> Any:
    """What a request is answered with; None: the websocket that it asks for."""
    why = door.refusal(request.path, request.headers.get_all)
    if why:
        _WIRE.warning("A request was refused: %s", why)
        return connection.respond(HTTPStatus.FORBIDDEN, why)
    if door.token:
        request.path = request.path.replace(f"/{door.token}", "", 1) or "/"
    response = usual(connection, request)
    if response is not None:
        response.headers["Content-Security-Policy"] = POLICY
        response.headers["Referrer-Policy"] = "no-referrer"
    elif next(_IS_TENTH_PAGE):
        # What a page leaves behind, 70 kB, holds itself: Python finds it in its own time, which may be hours.
        gc.collect()
    return response


# ---- cameras ---------------------------------------------------------------------------------------------------------


class PageCamera:
    """The camera of one page, with the page's controls of it.

    Args:
        client: The page.
    """

    def __init__(self, client: Any) -> None:
        self._client, self.camera = client, client.camera
        """As the page has reported it last, or as it has been moved since."""
        self._until = time.monotonic() + PATIENCE
        with client.gui.add_folder("This page"):
            self.follows = client.gui.add_checkbox("camera follows", True)
            client.gui.add_button("camera to the robot").on_click(self._go_home)
        self.camera.on_update(self._reported)

    @property
    def is_home(self) -> bool:
        """Whether the page has said that its camera is where it was brought to, or has had the time to."""
        return time.monotonic() >= self._until

    def show(self, at: np.ndarray) -> None:
        """Go along with a robot.

        Args:
            at: Where the robot is [m].
        """
        if self.is_home and not self.follows.value:
            return
        position, look_at = self._home
        # What a slow page reports is old, but its direction and distance are right.
        offset = self.camera.position - self.camera.look_at if self.is_home else position - look_at
        target = look_at + np.array([*at, 0.0][:3], dtype=float)
        with warnings.catch_warnings(), self._client.atomic():
            warnings.simplefilter("ignore", UserWarning)  # that a page has just vanished
            self.camera.position, self.camera.look_at = target + offset, target

    @property
    def _home(self) -> np.ndarray:
        """Where it begins and what it looks at then, from the robot [m]."""
        return np.array(PHONE if self.camera.aspect < NARROW else HOME)

    async def _go_home(self, event: Any) -> None:
        self._until = time.monotonic() + PATIENCE

    async def _reported(self, camera: Any) -> None:
        # A page that has just been opened reports where its camera was before it was brought here.
        if np.allclose(camera.position - camera.look_at, np.subtract(*self._home), atol=0.02):
            self._until = 0.0


class PageCameras:
    """The cameras of all pages that are open.

    Args:
        server: Of the pages.
    """

    def __init__(self, server: Any) -> None:
        self._cameras: dict[int, PageCamera] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        server.on_client_connect(self._welcome)
        server.on_client_disconnect(self._forget)

    def all(self) -> list[PageCamera]:
        """Of the pages, in the order in which they were opened."""
        return list(self._cameras.values())

    def show(self, at: np.ndarray) -> None:
        """Let the cameras that follow look at the robot, from where their page has put them around it; returns at once.

        Args:
            at: Where the robot is [m].
        """
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._show, at)

    def _show(self, at: np.ndarray) -> None:
        for camera in self._cameras.values():
            camera.show(at)

    # The loop waits for these two, so no page can be forgotten before it was welcomed.

    async def _welcome(self, client: Any) -> None:
        self._loop = asyncio.get_running_loop()
        self._cameras[client.client_id] = PageCamera(client)

    async def _forget(self, client: Any) -> None:
        self._cameras.pop(client.client_id, None)


# ---- events: answered one after the other, in the order in which they came -------------------------------------------


class Event(NamedTuple):
    """What somebody did on a page."""

    client: Any
    """The page."""
    target: Any
    """The control."""
    value: Any
    """What it was set to then; by now somebody may have set it to something else."""


Action = Callable[[Event], None]


def refusing(action: Callable[[Owner, Any], None]) -> Callable[[Owner, Any], None]:
    """A method that answers an event: what it refuses is said on the page where the event comes from."""

    @functools.wraps(action)
    def answered(owner: Owner, event: Any) -> None:
        try:
            action(owner, event)
        except (ValueError, LaticaudaError) as error:
            event.client.add_notification("Refused", str(error), color="red", auto_close_seconds=12.0)

    return answered


class EventQueue:
    """A thread that answers what comes from pages.

    viser answers in a pool of threads: two answers to a slider that is being dragged may overtake each other, and both
    read what the slider shows by then. Here the value is taken as it comes, and one is answered after the other.
    """

    def __init__(self) -> None:
        self._waiting: SimpleQueue[tuple[Action, Callable[[], None] | None, Event] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="cockpit-events", daemon=True)
        self._thread.start()

    def handler(
        self,
        action: Action,
        *,
        then: Callable[[], None] | None = None,
        read: Callable[[Any], Any] = lambda event: event.target.value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """What viser calls with an event.

        Args:
            action: The answer.
            then: What is to be done after it, once for all that waits: bring the pages up to date. To do so in between
                would set a control back that somebody is about to set further.
            read: The value of the event.
        """

        async def enqueue(event: Any) -> None:  # the server waits for it, so events come in their order
            if event.client is not None:  # else the program itself has set the control
                self._waiting.put((action, then, Event(event.client, event.target, read(event))))

        return enqueue

    def close(self) -> None:
        """Answer what waits, and end."""
        self._waiting.put(None)
        self._thread.join(5.0)

    def _run(self) -> None:
        owed: dict[Callable[[], None], None] = {}
        while (waiting := self._waiting.get()) is not None:
            action, then, event = waiting
            _guarded(functools.partial(action, event))
            if then is not None:
                owed[then] = None
            while owed and self._waiting.empty():
                _guarded(owed.popitem()[0])
        for then in owed:
            _guarded(then)


def _guarded(call: Callable[[], None]) -> None:
    """A fault of ours, or a value that no page of ours sends, must not leave the controls dead."""
    try:
        call()
    except Exception as error:
        logging.getLogger(__name__).error("A control of the cockpit failed: %r", error)
