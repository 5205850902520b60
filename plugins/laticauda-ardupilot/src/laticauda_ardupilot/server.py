"""The UDP socket behind which a robot waits for ArduPilot."""

import socket
import threading

from laticauda.values import BadArgument
from laticauda_ardupilot.lock_step import LockStep
from laticauda_ardupilot.packets import LONGEST_PACKET

PORT = 9002
"""Port to which ArduPilot's JSON backend sends."""
LISTENS = 0.2
"""Time after which the server looks whether it is to end [s]."""


class Server:
    """Answers packets on a UDP port until it is closed.

    Args:
        lock_step: Answers the packets.
        host: Address to listen on; 127.0.0.1 is reached from this computer only.
        port: Port; 0 takes a free one.

    Raises:
        ValueError: If the address cannot be used.
    """

    def __init__(self, lock_step: LockStep, host: str = "127.0.0.1", port: int = PORT) -> None:
        self._lock_step = lock_step
        self._closed = threading.Event()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(LISTENS)
        try:
            self._socket.bind((host, port))
        except OSError as error:
            self._socket.close()
            rule = f"must be free on {host}, got {port}: {error.strerror}"
            raise BadArgument("port", rule) from error
        self.host, self.port = self._socket.getsockname()
        """Address it listens on."""

    def run(self) -> None:
        """Answer packets until `close` is called, from any thread.

        Raises:
            SimulationFailed: If the motion diverged.
        """
        with self._socket:
            while not self._closed.is_set():
                self._answer_one()

    def _answer_one(self) -> None:
        """Answer the next packet, if one comes soon."""
        try:
            data, sender = self._socket.recvfrom(LONGEST_PACKET + 1)
        except TimeoutError:
            return
        except ConnectionError:  # some systems report here that an answer found nobody
            return
        answer = self._lock_step.answer(data, sender)
        if answer is not None:
            self._socket.sendto(answer, sender)

    def close(self) -> None:
        """End `run`."""
        self._closed.set()
