"""Pages of the cockpit: their server, which is viser's, the camera of each page, and the events from pages.

Cameras are updated in the server's own event loop, where the pages' reports arrive. In another
thread, a report that arrives between two lines would mix a camera's old and new positions, and the
next report would preserve that error.
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

from laticauda.show.cockpit.scene import HOME, PHONE
from laticauda.values.access import ServerAccess
from laticauda.values.errors import LaticaudaError
from laticauda.values.optional import optional_import

NARROW = 0.7  # largest ratio of width to height of a phone held upright [-]
PATIENCE = (
    5.0  # how long a camera is moved to the robot unless its page confirms the move earlier [s]
)
POLICY = "connect-src 'self' data: blob:; frame-ancestors 'none'"
"""A page connects only to its own server (viser's would follow an address in the link), and cannot be embedded."""
MOST_UPLOADED = 128 << 20  # total size of files being uploaded, and size of one [bytes]
MOST_UPLOADS = 8  # files being uploaded at a time
PART_COST = 1000  # overhead of a part of a file, in addition to its content [bytes]
MOST_SAID = 4 << 20  # size of one message from a page [bytes]
Owner = TypeVar("Owner")


class PortTaken(LaticaudaError, OSError):
    """Raised if the page cannot be served at the requested address."""


def load_viser() -> Any:
    """Return the module `viser`; handles of its pages are `Any` here, because their types depend on the control.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The cockpit", "viser", "cockpit")


def serve(door: ServerAccess, port: int) -> Any:
    """Start a page's server on this host and port only; by itself, viser takes the next free port, on all networks.

    Args:
        door: Access control and host of the server.
        port: Port to listen on; 0: any free port.

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
        raise PortTaken(
            f"Cannot serve the cockpit at {host}:{port}: {why}; `port` 0 takes a free one."
        ) from error
    with contextlib.redirect_stdout(io.StringIO()), _guarding(door):
        server = viser.ViserServer(host=host, port=port, label="laticauda", verbose=False)
    # If a page requested it, viser would ask a service for a public address on the internet.
    server._websock_server.unregister_handler(import_module("viser._messages").ShareUrlRequest)
    _limit_uploads(server)
    return server


def _limit_uploads(server: Any) -> None:
    """Discard uploads beyond a limit: viser keeps all data until a file is complete, and acknowledges it."""
    messages, sent = import_module("viser._messages"), server.gui._current_file_upload_states

    def begun(page: int, message: Any) -> None:
        server._websock_server.get_message_buffer().remove_from_buffer(
            lambda one: isinstance(one, messages.FileTransferPartAck)
        )
        if message.size_bytes > MOST_UPLOADED or len(sent) > MOST_UPLOADS:
            sent.pop(message.transfer_uuid, None)
            refused = f"A file must have {MOST_UPLOADED >> 20} MiB or less, and be sent while few others are."
            if page in (there := server.get_clients()):
                there[page].add_notification(
                    "Refused", refused, color="red", auto_close_seconds=12.0
                )

    def came(_: int, message: Any) -> None:
        if (
            sum(one["transferred_bytes"] + PART_COST * len(one["parts"]) for one in sent.values())
            > MOST_UPLOADED
        ):
            sent.pop(message.transfer_uuid, None)

    server._websock_server.register_handler(messages.FileTransferStartUpload, begun)
    server._websock_server.register_handler(messages.FileTransferPart, came)


def stop_server(server: Any) -> None:
    """Stop a server without its message on standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


def time_scale() -> dict[str, Any]:
    """Return the scale of a plot whose x axis is in seconds, which uPlot would interpret as dates."""
    return {"x": import_module("viser.uplot").Scale(time=False)}


# ---- access control ------------------------------------------------------------------------------

_WIRE = logging.getLogger(f"{__name__}.wire")
_IS_TENTH_PAGE = itertools.cycle((False,) * 9 + (True,))


def _in_one_line(record: logging.LogRecord) -> bool:
    """Reduce errors caused by invalid input to one line, and drop those of clients that have just left."""
    error = record.exc_info[1] if record.exc_info else None
    if error is not None:
        record.msg, record.args, record.exc_info = (
            f"A page was disconnected: {error!r:.200}",
            (),
            None,
        )
    return not isinstance(error and error.__cause__, EOFError)


_WIRE.addFilter(_in_one_line)


@contextlib.contextmanager
def _guarding(door: ServerAccess) -> Generator[None]:
    """Apply access control to `websockets` servers created within; viser, which creates one, does not pass any on."""
    module: Any = import_module("websockets.asyncio.server")
    made, usual = list[str](), module.serve

    def serve(handler: Any, host: str, port: int, *, process_request: Any, **rest: Any) -> Any:
        def failed(_: Any, context: dict[str, Any]) -> None:
            _WIRE.error(context["message"], exc_info=context.get("exception"))

        asyncio.get_running_loop().set_exception_handler(failed)
        made.append(host)
        answer = functools.partial(_answered, door, process_request)
        return usual(
            handler,
            host,
            port,
            process_request=answer,
            logger=_WIRE,
            **{**rest, "max_size": MOST_SAID},
        )

    module.serve = serve
    try:
        yield
    finally:
        module.serve = usual
    if not made:
        raise LaticaudaError(
            "This version of viser serves its pages unprotected: install viser 1.1."
        )


def _answered(door: ServerAccess, usual: Any, connection: Any, request: Any) -> Any:
    """Return the response to a request; None accepts the requested websocket."""
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
        # A closed page leaves 70 kB in reference cycles, which Python may take hours to collect.
        gc.collect()
    return response


# ---- cameras -------------------------------------------------------------------------------------


class PageCamera:
    """Camera of one page, with the page's controls for it.

    Args:
        client: The page.
    """

    def __init__(self, client: Any) -> None:
        self._client, self.camera = client, client.camera
        """Camera as last reported by the page, or as moved since."""
        self._until = time.monotonic() + PATIENCE
        with client.gui.add_folder("This page"):
            self.follows = client.gui.add_checkbox("camera follows", True)
            client.gui.add_button("camera to the robot").on_click(self._go_home)
        self.camera.on_update(self._reported)

    @property
    def is_home(self) -> bool:
        """Whether the page has confirmed that its camera is at the home position, or has had the time to."""
        return time.monotonic() >= self._until

    def show(self, at: np.ndarray) -> None:
        """Follow a robot.

        Args:
            at: Position of the robot [m].
        """
        if self.is_home and not self.follows.value:
            return
        position, look_at = self._home
        # Reports of a slow page are outdated, but their direction and distance are correct.
        offset = self.camera.position - self.camera.look_at if self.is_home else position - look_at
        target = look_at + np.array([*at, 0.0][:3], dtype=float)
        with warnings.catch_warnings(), self._client.atomic():
            warnings.simplefilter("ignore", UserWarning)  # a page has just been closed
            self.camera.position, self.camera.look_at = target + offset, target

    @property
    def _home(self) -> np.ndarray:
        """Initial position and target of the camera, relative to the robot [m]."""
        return np.array(PHONE if self.camera.aspect < NARROW else HOME)

    async def _go_home(self, event: Any) -> None:
        self._until = time.monotonic() + PATIENCE

    async def _reported(self, camera: Any) -> None:
        # A page that has just been opened reports where its camera was before it was moved here.
        if np.allclose(camera.position - camera.look_at, np.subtract(*self._home), atol=0.02):
            self._until = 0.0


class PageCameras:
    """Cameras of all open pages.

    Args:
        server: Server of the pages.
    """

    def __init__(self, server: Any) -> None:
        self._cameras: dict[int, PageCamera] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        server.on_client_connect(self._welcome)
        server.on_client_disconnect(self._forget)

    def all(self) -> list[PageCamera]:
        """Return the cameras in the order in which their pages were opened."""
        return list(self._cameras.values())

    def show(self, at: np.ndarray) -> None:
        """Point the cameras that follow at the robot, keeping the offsets set on their pages; return at once.

        Args:
            at: Position of the robot [m].
        """
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._show, at)

    def _show(self, at: np.ndarray) -> None:
        for camera in self._cameras.values():
            camera.show(at)

    # The loop awaits both of these, so no page can be removed before it has been added.

    async def _welcome(self, client: Any) -> None:
        self._loop = asyncio.get_running_loop()
        self._cameras[client.client_id] = PageCamera(client)

    async def _forget(self, client: Any) -> None:
        self._cameras.pop(client.client_id, None)


# ---- events: handled one at a time, in the order in which they arrive ----------------------------


class Event(NamedTuple):
    """Action of a user on a page."""

    client: Any
    """The page."""
    target: Any
    """The control."""
    value: Any
    """Value to which the control was set; it may have been changed since."""


Action = Callable[[Event], None]


def refusing(action: Callable[[Owner, Any], None]) -> Callable[[Owner, Any], None]:
    """Wrap a method that handles an event, so that its errors are shown on the page from which the event came."""

    @functools.wraps(action)
    def answered(owner: Owner, event: Any) -> None:
        try:
            action(owner, event)
        except (ValueError, LaticaudaError) as error:
            event.client.add_notification(
                "Refused", str(error), color="red", auto_close_seconds=12.0
            )

    return answered


class EventQueue:
    """A thread that handles events from pages.

    viser handles events in a pool of threads: two events of a slider that is being dragged may
    overtake each other, and both then read the slider's latest value. Here, values are read on
    arrival, and events are handled one at a time.
    """

    def __init__(self) -> None:
        self._waiting: SimpleQueue[tuple[Action, Callable[[], None] | None, Event] | None] = (
            SimpleQueue()
        )
        self._thread = threading.Thread(target=self._run, name="cockpit-events", daemon=True)
        self._thread.start()

    def handler(
        self,
        action: Action,
        *,
        then: Callable[[], None] | None = None,
        read: Callable[[Any], Any] = lambda event: event.target.value,
    ) -> Callable[[Any], Coroutine[Any, Any, None]]:
        """Return the function that viser calls with an event.

        Args:
            action: Handles the event.
            then: Called afterwards, once for all waiting events, to update the pages. Updating them
                in between would reset a control that a user is still moving.
            read: Reads the value of the event.
        """

        async def enqueue(
            event: Any,
        ) -> None:  # awaited by the server, so that events stay in order
            if event.client is not None:  # otherwise the program itself set the control
                self._waiting.put((action, then, Event(event.client, event.target, read(event))))

        return enqueue

    def close(self) -> None:
        """Handle the waiting events, and end the thread."""
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
    """Call a function and log its errors: a bug, or a value that no page sends, must not disable the controls."""
    try:
        call()
    except Exception as error:
        logging.getLogger(__name__).error("A control of the cockpit failed: %r", error)
