"""Server of the pages, which is viser's, with access control."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import asyncio
import contextlib
import functools
import gc
import io
import itertools
import logging
import socket
from collections.abc import Generator
from http import HTTPStatus
from importlib import import_module
from typing import Any

from laticauda.show.cockpit.cameras import is_camera
from laticauda.show.cockpit.uploads import limit_uploads
from laticauda.values import LaticaudaError, ServerAccess, optional_import

POLICY = "connect-src 'self' data: blob:; frame-ancestors 'none'"
"""A page connects only to its own server (viser's would follow an address in the link), and cannot be embedded."""
MOST_RECEIVED = 4 << 20
"""Largest size of one message from a page [bytes]."""

UNUSED_MESSAGES = (
    "GuiButtonHoldMessage",
    "GuiFormDirtyMessage",
    "GuiFormSubmitMessage",
    "CommandTriggerMessage",
)
"""Messages of viser's pages about controls that the cockpit does not have."""


class PortTaken(LaticaudaError, OSError):
    """Raised if the page cannot be served at the requested address."""


def load_viser() -> Any:
    """Return the module `viser`; handles of its pages are `Any` here, because their types depend on the control.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The cockpit", "viser", "cockpit")


def start_server(door: ServerAccess, port: int) -> Any:
    """Start a page's server on this host and port only; by itself, viser takes the next free port, on all networks.

    Args:
        door: Access control and host of the server.
        port: Port to listen on; 0: any free port.

    Raises:
        MissingExtra: If viser is not installed.
        PortTaken: If something else listens there, or this computer has no such address.
    """
    viser = load_viser()
    port = _free_port(door.host, port)
    with contextlib.redirect_stdout(io.StringIO()), guard_websockets(door):
        server = viser.ViserServer(host=door.host, port=port, label="laticauda", verbose=False)
    # If a page requested it, viser would ask a service for a public address on the internet.
    messages = import_module("viser._messages")
    server._websock_server.unregister_handler(messages.ShareUrlRequest)
    _limit_updates(server, messages)
    limit_uploads(server)
    _limit_messages(server, messages)
    return server


def _limit_updates(server: Any, messages: Any) -> None:
    """Let pages change the values of controls only; viser would set any attribute that one names, for all pages."""
    update = server.gui._handle_gui_updates

    async def update_value(page: int, message: Any) -> None:
        if set(message.updates) == {"value"}:
            await update(page, message)

    sockets = server._websock_server
    sockets.unregister_handler(messages.GuiUpdateMessage)
    sockets.register_handler(messages.GuiUpdateMessage, update_value)


def _limit_messages(server: Any, messages: Any) -> None:
    """Ignore what no page of ours sends: viser would keep it for all pages, however large it is."""
    unused = [getattr(messages, name) for name in UNUSED_MESSAGES]
    uploads = [messages.FileTransferStartUpload, messages.FileTransferPart]
    for message in unused:
        server._websock_server.unregister_handler(message)

    def limit_page(page: Any) -> None:
        # A page's own controls take no files, and these would not be limited.
        for message in (*unused, *uploads):
            page.unregister_handler(message)
        _check_cameras(page, messages.ViewerCameraMessage)

    # viser registers those of a page when it connects; its callback comes before this one.
    server._websock_server.on_client_connect(limit_page)


def _check_cameras(page: Any, report: Any) -> None:
    """Ignore reports of a camera that cannot be: computing with one would stop the cameras of all pages."""
    (take_report,) = page._incoming_handlers[report]

    async def take_valid_report(number: int, message: Any) -> None:
        if is_camera(message):
            await take_report(number, message)

    page.unregister_handler(report)
    page.register_handler(report, take_valid_report)


def _free_port(host: str, port: int) -> int:
    """Return the port, or a free one for port 0, if it is free."""
    try:
        with socket.create_server((host, port)) as probe:
            return int(probe.getsockname()[1])
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise PortTaken(
            f"Cannot serve the cockpit at {host}:{port}: {reason}; `port` 0 takes a free one."
        ) from error


def stop_server(server: Any) -> None:
    """Stop a server without its message on standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


# ---- access control ------------------------------------------------------------------------------

_WIRE = logging.getLogger(f"{__name__}.wire")
_IS_TENTH_PAGE = itertools.cycle((False,) * 9 + (True,))


def _shorten_record(record: logging.LogRecord) -> bool:
    """Reduce errors caused by invalid input to one line, and drop those of clients that have just left."""
    if not record.exc_info:
        return True
    error = record.exc_info[1]
    if error is None:
        return True
    record.msg = f"A page was disconnected: {error!r:.200}"
    record.args = ()
    record.exc_info = None
    has_left = isinstance(error.__cause__, EOFError)
    return not has_left


_WIRE.addFilter(_shorten_record)


def _is_worth_printing(record: logging.LogRecord) -> bool:
    """Return whether asyncio says more than that a page has left while it was written to, once for every write."""
    return record.msg != "socket.send() raised exception."


logging.getLogger("asyncio").addFilter(_is_worth_printing)


@contextlib.contextmanager
def guard_websockets(door: ServerAccess) -> Generator[None]:
    """Apply access control to `websockets` servers created within; viser, which creates one, does not pass any on.

    Args:
        door: Access control.

    Raises:
        LaticaudaError: If no such server was created.
    """
    module: Any = import_module("websockets.asyncio.server")
    original_serve = module.serve
    guarded_hosts: list[str] = []

    def serve(handler: Any, host: str, port: int, *, process_request: Any, **options: Any) -> Any:
        asyncio.get_running_loop().set_exception_handler(_log_failure)
        guarded_hosts.append(host)
        options |= {
            "process_request": functools.partial(_answer_request, door, process_request),
            "logger": _WIRE,
            "max_size": MOST_RECEIVED,
            "select_subprotocol": _select_protocol,
        }
        return original_serve(handler, host, port, **options)

    module.serve = serve
    try:
        yield
    finally:
        module.serve = original_serve
    if not guarded_hosts:
        raise LaticaudaError(
            "This version of viser serves its pages unprotected: install viser 1.1."
        )


def _select_protocol(connection: Any, offered: list[str]) -> str:
    """Return viser's protocol; viser would print what a page of another version offers on standard output.

    Raises:
        NegotiationError: If the page does not offer it.
    """
    protocol = f"viser-v{load_viser().__version__}"
    if protocol in offered:
        return protocol
    raise import_module("websockets").NegotiationError("the page is of another version: reload it")


def _log_failure(loop: Any, context: dict[str, Any]) -> None:
    """Handle an exception that nothing else in the server's event loop handles."""
    _WIRE.error(context["message"], exc_info=context.get("exception"))


def _answer_request(door: ServerAccess, viser_answer: Any, connection: Any, request: Any) -> Any:
    """Return the response to a request; None accepts the requested websocket."""
    refusal = door.refusal(request.path, request.headers.get_all)
    if refusal:
        _WIRE.warning("A request was refused: %s", refusal)
        return connection.respond(HTTPStatus.FORBIDDEN, refusal)
    if door.token:
        request.path = request.path.replace(f"/{door.token}", "", 1) or "/"
    response = viser_answer(connection, request)
    if response is not None:
        response.headers["Content-Security-Policy"] = POLICY
        response.headers["Referrer-Policy"] = "no-referrer"
    elif next(_IS_TENTH_PAGE):
        # A closed page leaves 70 kB in reference cycles, which Python may take hours to collect.
        gc.collect()
    return response
