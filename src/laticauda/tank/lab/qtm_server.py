"""A server of the QTM real-time protocol, complete enough for the vendor's own client package to stream from it."""

import asyncio
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from laticauda.tank.lab.instruments import BODY, MARKERS
from laticauda.tank.protocol import MocapFrame, ProtocolError, qtm
from laticauda.values import LaticaudaError, check_hostname

LOOPBACK = "127.0.0.1"
"""Address that only this computer reaches."""
MOST_CLIENTS = 16
"""Clients at a time."""
MOST_UNREAD_BYTES = 1 << 20
"""Bytes that a client may leave unread before it misses frames."""
OLDEST_VERSION = (1, 8)
"""Oldest version of the protocol that a client may ask for."""
NEWEST_VERSION = (1, 25)
"""Newest one."""
STOP_TIMEOUT = 5.0
"""How long stopping may take [s]."""
CLOSE_TIMEOUT = 1.0
"""How long clients may take to be told [s]."""
ANSWERS = {
    "qtmversion": "QTM Version is that of laticauda's virtual tank",
    "byteorder": "Byte order is little endian",
    "releasecontrol": "You are now a regular client",
    "new": "Already connected",
    "start": "Starting measurement",
    "stop": "Stopping measurement",
    "close": "Closing connection",
    "takecontrol": "You are now master",
}
"""Answers to commands that change nothing here."""
PARSE_ERROR = qtm.encode_text("Parse error", qtm.PacketType.ERROR)


class ServerFailed(LaticaudaError, OSError):
    """A server of the lab cannot start; the message says where, and why."""


@dataclass(eq=False)
class _Client:
    """One connection."""

    writer: asyncio.StreamWriter
    components: tuple[qtm.Component, ...] = ()
    """Components of its stream; empty: it has no stream."""
    has_asked: bool = False
    """Whether it has sent anything that is a packet."""
    divisor: int = 1
    """Interval of its stream, in frames."""
    reader: qtm.PacketReader = field(default_factory=qtm.PacketReader)

    def send(self, packet: bytes) -> None:
        if not self.writer.is_closing():
            self.writer.write(packet)


class QtmServer:
    """Server for up to `MOST_CLIENTS` clients, in a separate thread.

    Args:
        rate: Frame rate of the cameras [Hz].
        host: Host address at which it listens; by default, only this computer.
        port: Port at which it listens; 0: any free one.
    """

    def __init__(self, rate: float, host: str = LOOPBACK, port: int = qtm.PORT) -> None:
        self.rate = rate
        self.host = check_hostname("host", host)
        self.port = port
        self._latest: MocapFrame | None = None
        self._clients: dict[_Client, None] = {}
        """In the order in which they came."""
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._server: asyncio.Server | None = None
        self._commands: dict[str, Callable[[_Client, Sequence[str]], bytes]] = {
            "version": self._version,
            "getstate": self._state,
            "getparameters": self._parameters,
            "getcurrentframe": self._current_frame,
            "streamframes": self._stream_frames,
        }

    def start(self) -> None:
        """Start listening.

        Raises:
            ServerFailed: If it cannot listen.
        """
        loop = asyncio.new_event_loop()
        self._loop = loop
        self._thread = threading.Thread(target=loop.run_forever, name="qtm-server", daemon=True)
        self._thread.start()
        opening = asyncio.start_server(self._serve, self.host, self.port)
        try:
            self._server = asyncio.run_coroutine_threadsafe(opening, loop).result()
        except OSError as error:
            self.stop()
            raise ServerFailed(
                f"The cameras' server cannot listen at {self.host}:{self.port}: {error}."
            ) from error
        self.port = int(self._server.sockets[0].getsockname()[1])

    def stop(self) -> None:
        """End all connections and the thread."""
        loop = self._loop
        self._loop = None
        if loop is None or self._thread is None:
            return
        asyncio.run_coroutine_threadsafe(self._close(), loop).result(STOP_TIMEOUT)
        loop.call_soon_threadsafe(loop.stop)
        self._thread.join(STOP_TIMEOUT)
        loop.close()

    def publish(self, frame: MocapFrame) -> None:
        """Send `frame` to all clients that stream; may be called from any thread.

        Args:
            frame: Poses of the bodies, and when they were seen.
        """
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._publish, frame)

    def _publish(self, frame: MocapFrame) -> None:
        self._latest = frame
        for client in self._clients:
            unread = client.writer.transport.get_write_buffer_size()
            is_due = frame.number % client.divisor == 0
            if client.components and is_due and unread <= MOST_UNREAD_BYTES:
                client.send(qtm.encode_frame(frame, client.components, MARKERS))

    async def _close(self) -> None:
        if self._server is not None:
            self._server.close()
        for client in list(self._clients):
            client.send(qtm.encode_event(qtm.Event.SHUTTING_DOWN))
            client.writer.close()
        other_tasks = asyncio.all_tasks() - {asyncio.current_task()}
        if other_tasks:
            await asyncio.wait(other_tasks, timeout=CLOSE_TIMEOUT)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        client = _Client(writer)
        if len(self._clients) >= MOST_CLIENTS and not self._drop_silent_client():
            writer.close()
            return
        self._clients[client] = None
        client.send(qtm.encode_text(qtm.BANNER))
        try:
            while data := await reader.read(65536):
                for kind, payload in client.reader.feed(data):
                    client.has_asked = True
                    self._answer(client, kind, qtm.decode_text(payload))
                await writer.drain()  # a client that asks and does not read gets no further answers
        except (ProtocolError, OSError):
            pass  # clients that speak something else are disconnected
        finally:
            self._clients.pop(client, None)
            writer.close()

    def _drop_silent_client(self) -> bool:
        """Disconnect the first client that has never asked for anything; return whether there was one."""
        for client in self._clients:
            if not client.has_asked:
                del self._clients[client]
                client.writer.transport.abort()
                return True
        return False

    def _answer(self, client: _Client, kind: int, text: str) -> None:
        if kind != qtm.PacketType.COMMAND or not text.split():
            client.send(PARSE_ERROR)
            return
        command, *arguments = text.split()
        command = command.lower()
        if command in ANSWERS:
            client.send(qtm.encode_text(ANSWERS[command]))
        elif command in self._commands:
            client.send(self._commands[command](client, arguments))
        else:
            client.send(PARSE_ERROR)

    def _state(self, client: _Client, arguments: Sequence[str]) -> bytes:
        return qtm.encode_event(qtm.Event.CONNECTED)

    def _version(self, client: _Client, arguments: Sequence[str]) -> bytes:
        if not arguments:
            major, minor = NEWEST_VERSION
            return qtm.encode_text(f"Version is {major}.{minor}")
        version = _parse_version(arguments[0])
        if version is not None and OLDEST_VERSION <= version <= NEWEST_VERSION:
            return qtm.encode_text(f"Version set to {arguments[0]}")
        return qtm.encode_text("Version NOT supported", qtm.PacketType.ERROR)

    def _parameters(self, client: _Client, arguments: Sequence[str]) -> bytes:
        sections = {argument.lower() for argument in arguments}
        if "all" in sections:
            sections = {"general", "6d", "3d", "skeleton"}
        text = qtm.answer_parameters(self.rate, {BODY: MARKERS}, sections)
        return qtm.encode_text(text, qtm.PacketType.XML)

    def _current_frame(self, client: _Client, arguments: Sequence[str]) -> bytes:
        components = _parse_components(arguments)
        if not components:
            return PARSE_ERROR
        if self._latest is None:
            return qtm.encode_packet(qtm.PacketType.NO_MORE_DATA, b"")
        return qtm.encode_frame(self._latest, components, MARKERS)

    def _stream_frames(self, client: _Client, arguments: Sequence[str]) -> bytes:
        if not arguments:
            return PARSE_ERROR
        rate, *component_names = arguments
        if rate.lower() == "stop":
            client.components = ()
            return b""
        components = _parse_components(component_names)
        divisor = self._parse_divisor(rate.lower())
        if not components or divisor is None:
            return PARSE_ERROR
        client.components = components
        client.divisor = divisor
        return b""  # the first frame is the answer

    def _parse_divisor(self, rate: str) -> int | None:
        """Return the interval, in frames, at which one is to be sent; None if the text does not give it."""
        if rate == "allframes":
            return 1
        name, _, number = rate.partition(":")
        if name not in ("frequency", "frequencydivisor"):
            return None
        if not (number.isascii() and number.isdigit()) or not 1 <= int(number[:9]) < 10**6:
            return None
        if name == "frequencydivisor":
            return int(number)
        return max(1, round(self.rate / int(number)))


def _parse_version(text: str) -> tuple[int, int] | None:
    """Return the two numbers of a version; None if the text is none."""
    parts = text.split(".")
    if len(parts) != 2:
        return None
    if not all(part.isascii() and part.isdigit() and len(part) < 5 for part in parts):
        return None
    major, minor = map(int, parts)
    return major, minor


def _parse_components(names: Sequence[str]) -> tuple[qtm.Component, ...]:
    """Return the components of a frame that a client wants and that we have."""
    lower_names = [name.lower() for name in names]
    return tuple(qtm.COMPONENTS[name] for name in lower_names if name in qtm.COMPONENTS)
