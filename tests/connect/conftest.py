"""A server in this process, and clients that speak to it over real sockets."""

from collections.abc import Callable, Iterator

import pytest
from cosim_client import Client

from laticauda.connect import Server


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
