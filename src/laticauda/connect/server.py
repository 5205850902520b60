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
from laticauda.values import BadArgument, LaticaudaError, ServerAccess, check_whole_number

LOOPBACK = "127.0.0.1"
"""Address at which only programs on this computer reach a server."""
PORT = 5055
"""Port to listen on by default."""
MOST_CLIENTS = 16
"""Clients at a time by default [-]."""
LARGEST_PORT = 65535
"""Largest number of a port."""
RECEIVE_BYTES = 1 << 16
"""Bytes that are received at a time [byte]."""
SENDING_TIMEOUT = 30.0
"""Time that a client may take to read an answer [s]."""
IDLE_TIMEOUT = 600.0
"""Time that a client may stay silent [s]."""
GREETING_TIMEOUT = 10.0
"""Time within which a client must send the token, if there is one [s]."""
MOST_STRANGERS = 64
"""Clients at a time of which no token has been seen yet; for one more, the one that came first has to leave [-]."""
DRAINING_TIME = 1.0
"""Time during which excess input is still received, so that the client can read the reason [s]."""
RETRY_INTERVAL = 0.05
"""Time between two attempts to accept a client, for example while out of file descriptors [s]."""
CLOSING_TIMEOUT = 5.0
"""Time that `Server.close` waits for the thread of the server [s]."""


class ServerFailed(LaticaudaError, OSError):
    """Raised if the server cannot start; the message gives the address and the reason."""


class Server:
    """TCP server for any number of worlds, one per client; see docs/cosim-protocol.md.

    Args:
        host: Address to listen on; the default is this computer only. For others, the first request
            must hold a token.
        port: Port to listen on; 0: any free port.
        max_clients: Maximum number of clients; further clients are told to try later. If a token is
            required, only those count that have sent it.
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
        if check_whole_number("port", port, 0) > LARGEST_PORT:
            raise BadArgument("port", f"must be between 0 and {LARGEST_PORT}, got {port}")
        self.host = host
        self.port = port
        self.access = ServerAccess.of(host)
        """Access control for clients."""
        self.max_clients = check_whole_number("max_clients", max_clients, 1)
        self._own_robots = dict(own_robots or {})
        self._budget = Budget().share_among(max_clients)
        self._socket: socket.socket | None = None
        self._clients: set[socket.socket] = set()
        self._strangers: dict[socket.socket, None] = {}
        """Connections from which no token has come yet, in the order in which they came."""
        self._clients_lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def open(self) -> None:
        """Start listening, and set `port` to the actual port.

        Raises:
            ServerFailed: If the server cannot listen there.
        """
        try:
            addresses = socket.getaddrinfo(self.host, self.port, type=socket.SOCK_STREAM)
            family, _, _, _, address = addresses[0]
            host = str(address[0])
            self._socket = socket.create_server((host, self.port), family=family)
        except OSError as error:
            raise ServerFailed(
                f"The server cannot listen at {self.host}:{self.port}: {error}."
            ) from error
        self.port = int(self._socket.getsockname()[1])

    def run(self) -> None:
        """Serve clients until `close` is called or Ctrl-C is pressed."""
        listening_socket = self._socket
        assert listening_socket is not None, "open() first"
        while True:
            try:
                client, _ = listening_socket.accept()
            except OSError:
                if self._socket is None:
                    return  # it was closed
                time.sleep(RETRY_INTERVAL)  # connected clients continue
                continue
            threading.Thread(target=self._serve, args=(client,), daemon=True).start()

    def close(self) -> None:
        """Close all connections and stop listening."""
        listening_socket = self._socket
        self._socket = None
        if listening_socket is not None:
            _shut(listening_socket)
        with self._clients_lock:
            clients = [*self._clients, *self._strangers]
        for client in clients:
            _shut(client)
        if self._thread is not None:
            self._thread.join(CLOSING_TIMEOUT)

    def __enter__(self) -> "Server":
        """Start listening, and serve clients in a separate thread."""
        self.open()
        self._thread = threading.Thread(target=self.run, name="laticauda-server", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Call `close`."""
        self.close()

    def _serve(self, client: socket.socket) -> None:
        """Serve one client from its first line to its last, whatever it does."""
        try:
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            # Detects clients that left without closing.
            client.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
            if self.access.token:
                self._greet(client)
            elif self._admit(client):
                self._converse(client, is_known=True)
            else:
                self._turn_away(client)
        except OSError:
            pass  # the client has disconnected
        finally:
            with self._clients_lock:
                self._clients.discard(client)
                self._strangers.pop(client, None)
            _shut(client)

    def _greet(self, client: socket.socket) -> None:
        """Converse with a client that has `GREETING_TIMEOUT` to send the token; until then it counts as a stranger."""
        with self._clients_lock:
            self._strangers[client] = None
            if len(self._strangers) > MOST_STRANGERS:
                first_stranger = next(iter(self._strangers))
                del self._strangers[first_stranger]
                _hang_up(first_stranger)
        greeting_timer = threading.Timer(GREETING_TIMEOUT, self._end_greeting, (client,))
        greeting_timer.daemon = True
        greeting_timer.start()
        try:
            self._converse(client, is_known=False)
        finally:
            greeting_timer.cancel()

    def _end_greeting(self, client: socket.socket) -> None:
        """Hang up on a client that is still a stranger."""
        with self._clients_lock:
            if client in self._strangers:
                _hang_up(client)

    def _admit(self, client: socket.socket) -> bool:
        """Return whether there is room for a client, which is then counted."""
        with self._clients_lock:
            if len(self._clients) >= self.max_clients:
                return False
            self._clients.add(client)
            self._strangers.pop(client, None)
            return True

    def _turn_away(self, client: socket.socket) -> None:
        reason = f"The server already has {self.max_clients} clients, its maximum;"
        _dismiss(client, f"{reason} try again later.")

    def _converse(self, client: socket.socket, *, is_known: bool) -> None:
        """Answer a client's lines until it leaves, stays silent or is rejected."""
        session = Session(self._own_robots, self._budget)
        client.settimeout(IDLE_TIMEOUT)
        with client.makefile("rb") as stream:
            while True:
                raw_line = stream.readline(MESSAGE_BYTES)
                if not raw_line.endswith(b"\n"):
                    break
                line = raw_line.strip()
                if not line:
                    continue
                reason = self._reason_to_reject(line, is_known=is_known)
                if reason:
                    _dismiss(client, f"{reason} Good-bye.")
                    return
                if not is_known and not self._admit(client):
                    self._turn_away(client)
                    return
                is_known = True
                client.settimeout(SENDING_TIMEOUT)
                client.sendall(session.answer(line))
                client.settimeout(IDLE_TIMEOUT)
        if len(raw_line) == MESSAGE_BYTES:
            limit = f"A message must be {MESSAGE_BYTES} bytes or shorter; this one is longer."
            _dismiss(client, f"{limit} Good-bye.")

    def _reason_to_reject(self, line: bytes, *, is_known: bool) -> str:
        """Return why a line is rejected and its client disconnected; "" if the line is accepted."""
        if not line.startswith(b"{"):  # for example, a web page that speaks HTTP
            return "A message must be a JSON object; this one is not."
        if is_known or self._holds_token(line):
            return ""
        return "The first message must hold the `token` that the server printed."

    def _holds_token(self, line: bytes) -> bool:
        try:
            message = read_message(line)
        except ValueError:
            return False
        return self.access.admits(message.get("token"))


def _dismiss(client: socket.socket, reason: str) -> None:
    """Send the reason and disconnect; input is read briefly, because otherwise the reason would not arrive."""
    client.settimeout(DRAINING_TIME)
    client.sendall(write_message({"error": reason}))
    client.shutdown(socket.SHUT_WR)
    end = time.monotonic() + DRAINING_TIME
    while time.monotonic() < end and client.recv(RECEIVE_BYTES):
        pass


def _shut(connection: socket.socket) -> None:
    """Close a socket that another thread may be waiting on."""
    _hang_up(connection)
    connection.close()


def _hang_up(connection: socket.socket) -> None:
    """Let the thread that waits on a socket go on, and close it."""
    with suppress(OSError):  # the other end has already closed it
        connection.shutdown(socket.SHUT_RDWR)
