"""Co-simulation server: sockets for sessions, a thread per client, and limits that protect clients from each other."""

import socket
import threading
import time
from collections.abc import Mapping
from contextlib import suppress

from laticauda.connect.budget import Budget
from laticauda.connect.messages import MESSAGE_BYTES, read_message, write_message
from laticauda.connect.session import Session
from laticauda.robot import Robot
from laticauda.values.access import ServerAccess
from laticauda.values.checks import check_whole_number
from laticauda.values.errors import BadArgument, LaticaudaError

LOOPBACK, PORT, MOST_CLIENTS = "127.0.0.1", 5055, 16
PIECE = 1 << 16  # bytes read at a time
SENDING = 30.0  # s that a client may take to read an answer
IDLE = 600.0  # s that a client may stay silent
GREETING = 10.0  # s within which the client must send the token, if there is one
DRAINING = (
    1.0  # s during which excess input is still received, so that the client can read the reason
)


class ServerFailed(LaticaudaError, OSError):
    """Raised if the server cannot start; the message gives the address and the reason."""


class Server:
    """TCP server for any number of worlds, one per client; see docs/cosim-protocol.md.

    Args:
        host: Address to listen on; the default is this computer only. For others, the first request
            must hold a token.
        port: Port to listen on; 0: any free port.
        max_clients: Maximum number of clients; further clients are told to try later.
        own_robots: Robots, by name, that clients may request in addition to the presets.

    Raises:
        ValueError: If an argument is out of range.

    Example:
        >>> with Server(port=0) as server:
        ...     server.host
        '127.0.0.1'
    """

    def __init__(
        self,
        host: str = LOOPBACK,
        port: int = PORT,
        *,
        max_clients: int = MOST_CLIENTS,
        own_robots: Mapping[str, Robot] | None = None,
    ) -> None:
        if check_whole_number("port", port, 0) > 65535:
            raise BadArgument("port", f"must be between 0 and 65535, got {port}")
        self.host, self.port, self.door = host, port, ServerAccess.of(host)
        """Access control for clients."""
        self.max_clients = check_whole_number("max_clients", max_clients, 1)
        self._own_robots, self._budget = dict(own_robots or {}), Budget().shared(max_clients)
        self._socket: socket.socket | None = None
        self._clients: set[socket.socket] = set()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def open(self) -> None:
        """Start listening, and set `port` to the actual port.

        Raises:
            ServerFailed: If the server cannot listen there.
        """
        try:
            family, _, _, _, address = socket.getaddrinfo(
                self.host, self.port, type=socket.SOCK_STREAM
            )[0]
            self._socket = socket.create_server((str(address[0]), self.port), family=family)
        except OSError as error:
            raise ServerFailed(
                f"The server cannot listen at {self.host}:{self.port}: {error}."
            ) from error
        self.port = int(self._socket.getsockname()[1])

    def run(self) -> None:
        """Serve clients until `close` is called or Ctrl-C is pressed."""
        listening = self._socket
        assert listening is not None, "open() first"
        while True:
            try:
                wire, _ = listening.accept()
            except OSError:
                if self._socket is None:
                    return
                time.sleep(0.05)  # for example, out of file descriptors; connected clients continue
                continue
            threading.Thread(target=self._serve, args=(wire,), daemon=True).start()

    def close(self) -> None:
        """Close all connections and stop listening."""
        listening, self._socket = self._socket, None
        if listening is not None:
            _shut(listening)
        with self._lock:
            clients = list(self._clients)
        for wire in clients:
            _shut(wire)
        if self._thread is not None:
            self._thread.join(5.0)

    def __enter__(self) -> "Server":
        """Start listening, and serve clients in a separate thread."""
        self.open()
        self._thread = threading.Thread(target=self.run, name="laticauda-server", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Call `close`."""
        self.close()

    def _serve(self, wire: socket.socket) -> None:
        """Serve one client from its first line to its last, whatever it does."""
        try:
            with self._lock:
                welcome = len(self._clients) < self.max_clients
                if welcome:
                    self._clients.add(wire)
            wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            wire.setsockopt(
                socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1
            )  # detects clients that left without closing
            if welcome:
                self._talk(wire)
            else:
                _dismiss(
                    wire,
                    f"The server already has {self.max_clients} clients, its maximum; try again later.",
                )
        except OSError:
            pass  # the client has disconnected
        finally:
            with self._lock:
                self._clients.discard(wire)
            _shut(wire)

    def _talk(self, wire: socket.socket) -> None:
        session, is_known = Session(self._own_robots, self._budget), not self.door.token
        greeting = threading.Timer(GREETING, _shut, (wire,))
        greeting.daemon = True
        if not is_known:
            greeting.start()
        wire.settimeout(IDLE)
        with wire.makefile("rb") as stream:
            while (line := stream.readline(MESSAGE_BYTES)).endswith(b"\n"):
                if line := line.strip():
                    if why := self._why_not(line, is_known=is_known):
                        return _dismiss(wire, f"{why} Good-bye.")
                    greeting.cancel()
                    is_known = True
                    wire.settimeout(SENDING)
                    wire.sendall(session.answer(line))
                    wire.settimeout(IDLE)
        if len(line) == MESSAGE_BYTES:
            _dismiss(
                wire,
                f"A message must be {MESSAGE_BYTES} bytes or shorter; this one is longer. Good-bye.",
            )

    def _why_not(self, line: bytes, *, is_known: bool) -> str:
        """Return why a line is rejected and its client disconnected; "" if the line is accepted."""
        if not line.startswith(b"{"):  # for example, a web page that speaks HTTP
            return "A message must be a JSON object; this one is not."
        if not is_known:
            with suppress(ValueError):
                is_known = self.door.admits(read_message(line).get("token"))
        return (
            "" if is_known else "The first message must hold the `token` that the server printed."
        )


def _dismiss(wire: socket.socket, why: str) -> None:
    """Send the reason and disconnect; input is read briefly, because otherwise the reason would not arrive."""
    wire.settimeout(DRAINING)
    wire.sendall(write_message({"error": why}))
    wire.shutdown(socket.SHUT_WR)
    end = time.monotonic() + DRAINING
    while time.monotonic() < end and wire.recv(PIECE):
        pass


def _shut(wire: socket.socket) -> None:
    """Close a socket that another thread may be waiting on."""
    with suppress(OSError):  # the other end has already closed it
        wire.shutdown(socket.SHUT_RDWR)
    wire.close()
