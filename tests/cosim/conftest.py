"""A server in this process, and clients that speak to it over real sockets."""

import json
import socket
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from laticauda.cosim import Server


class Client:
    def __init__(self, port: int) -> None:
        self.wire = socket.create_connection(("127.0.0.1", port), timeout=20.0)
        self.stream = self.wire.makefile("rwb")

    def line(self, line: bytes) -> dict[str, Any]:
        self.stream.write(line + b"\n")
        self.stream.flush()
        return self.heard()

    def heard(self) -> dict[str, Any]:
        return json.loads(self.stream.readline())

    def ask(self, request: str, **fields: Any) -> dict[str, Any]:
        return self.line(json.dumps({"do": request, **fields}).encode())

    def is_let_go(self) -> bool:
        return self.stream.readline() == b""

    def close(self) -> None:
        self.stream.close()
        self.wire.close()


@pytest.fixture
def server() -> Iterator[Server]:
    with Server(port=0, max_clients=6) as server:
        yield server


@pytest.fixture
def connect(server: Server) -> Iterator[Callable[[], Client]]:
    clients: list[Client] = []

    def connect() -> Client:
        clients.append(Client(server.port))
        return clients[-1]

    yield connect
    for client in clients:
        try:
            client.close()
        except OSError:
            pass
