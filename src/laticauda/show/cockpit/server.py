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

from laticauda.show.cockpit.uploads import limit_uploads
from laticauda.values import LaticaudaError, ServerAccess, optional_import

POLICY = "connect-src 'self' data: blob:; frame-ancestors 'none'"
"""A page connects only to its own server (viser's would follow an address in the link), and cannot be embedded."""
MOST_RECEIVED = 4 << 20
"""Largest size of one message from a page [bytes]."""


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
