"""A server of the QTM real-time protocol, complete enough for the vendor's own client package to stream from it."""

import asyncio
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from laticauda.tank.lab.instruments import BODY, MARKERS
from laticauda.tank.protocol import MocapFrame, ProtocolError, qtm
from laticauda.values.checks import check_hostname
from laticauda.values.errors import LaticaudaError

LOOPBACK = "127.0.0.1"
MOST_CLIENTS = 16
MOST_WAITING = 1 << 20  # bytes that a client may leave unread before it misses frames
OLDEST, NEWEST = (1, 8), (1, 25)
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
    components: tuple[qtm.Component, ...] = ()  # of its stream; empty: it has no stream
    divisor: int = 1
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
        self.rate, self.host, self.port = rate, check_hostname("host", host), port
        self._latest: MocapFrame | None = None
        self._clients: set[_Client] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._server: asyncio.Server | None = None
        self._commands: dict[str, Callable[[_Client, Sequence[str]], bytes]] = {
            "version": self._version,
            "getstate": lambda client, words: qtm.encode_event(qtm.Event.CONNECTED),
            "getparameters": self._parameters,
            "getcurrentframe": self._current_frame,
            "streamframes": self._stream_frames,
        }

    def start(self) -> None:
        """Start listening.

        Raises:
            ServerFailed: If it cannot listen.
        """
        loop = self._loop = asyncio.new_event_loop()
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
        loop, self._loop = self._loop, None
        if loop is None or self._thread is None:
            return
        asyncio.run_coroutine_threadsafe(self._close(), loop).result(5.0)
        loop.call_soon_threadsafe(loop.stop)
        self._thread.join(5.0)
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
            waits = client.writer.transport.get_write_buffer_size() > MOST_WAITING
            if client.components and frame.number % client.divisor == 0 and not waits:
                client.send(qtm.encode_frame(frame, client.components, MARKERS))

    async def _close(self) -> None:
        if self._server is not None:
            self._server.close()
        for client in list(self._clients):
            client.send(qtm.encode_event(qtm.Event.SHUTTING_DOWN))
            client.writer.close()
        others = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        await asyncio.wait(others, timeout=1.0) if others else None

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        client = _Client(writer)
        if len(self._clients) >= MOST_CLIENTS:
            writer.close()
            return
        self._clients.add(client)
        client.send(qtm.encode_text(qtm.BANNER))
        try:
            while data := await reader.read(65536):
                for kind, payload in client.reader.feed(data):
                    self._answer(client, kind, qtm.decode_text(payload))
                await writer.drain()  # a client that asks and does not read gets no further answers
        except (ProtocolError, OSError):
            pass  # clients that speak something else are disconnected
        finally:
            self._clients.discard(client)
            writer.close()

    def _answer(self, client: _Client, kind: int, text: str) -> None:
        word, *rest = text.split() or [""]
        answer, word = PARSE_ERROR, word.lower()
        if kind == qtm.PacketType.COMMAND and word in ANSWERS:
            answer = qtm.encode_text(ANSWERS[word])
        elif kind == qtm.PacketType.COMMAND and word in self._commands:
            answer = self._commands[word](client, rest)
        client.send(answer)

    def _version(self, client: _Client, words: Sequence[str]) -> bytes:
        if not words:
            return qtm.encode_text(f"Version is {NEWEST[0]}.{NEWEST[1]}")
        parts = words[0].split(".")
        if len(parts) == 2 and all(p.isascii() and p.isdigit() and len(p) < 5 for p in parts):
            if OLDEST <= (int(parts[0]), int(parts[1])) <= NEWEST:
                return qtm.encode_text(f"Version set to {words[0]}")
        return qtm.encode_text("Version NOT supported", qtm.PacketType.ERROR)

    def _parameters(self, client: _Client, words: Sequence[str]) -> bytes:
        names = {word.lower() for word in words}
        asked = {"general", "6d", "3d", "skeleton"} if "all" in names else names
        return qtm.encode_text(
            qtm.answer_parameters(self.rate, {BODY: MARKERS}, asked), qtm.PacketType.XML
        )

    def _current_frame(self, client: _Client, words: Sequence[str]) -> bytes:
        components = _components(words)
        if components is None:
            return PARSE_ERROR
        if self._latest is None:
            return qtm.encode_packet(qtm.PacketType.NO_MORE_DATA, b"")
        return qtm.encode_frame(self._latest, components, MARKERS)

    def _stream_frames(self, client: _Client, words: Sequence[str]) -> bytes:
        if not words:
            return PARSE_ERROR
        rate, *rest = (word.lower() for word in words)
        if rate == "stop":
            client.components = ()
            return b""
        components, divisor = _components(rest), self._divisor(rate)
        if components is None or divisor is None:
            return PARSE_ERROR
        client.components, client.divisor = components, divisor
        return b""  # the first frame is the answer

    def _divisor(self, word: str) -> int | None:
        """Return the interval, in frames, at which one is to be sent; None if the word does not give it."""
        name, _, number = word.partition(":")
        if word == "allframes":
            return 1
        if name not in ("frequency", "frequencydivisor") or not (
            number.isascii() and number.isdigit()
        ):
            return None
        if not 1 <= int(number[:9]) < 10**6:
            return None
        return int(number) if name == "frequencydivisor" else max(1, round(self.rate / int(number)))


def _components(words: Sequence[str]) -> tuple[qtm.Component, ...] | None:
    """Return the components of a frame that a client wants and that we have; None if there are none."""
    return (
        tuple(qtm.COMPONENTS[word.lower()] for word in words if word.lower() in qtm.COMPONENTS)
        or None
    )
