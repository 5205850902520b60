"""A client that speaks to a server over real sockets."""

import json
import socket
from typing import Any


class Client:
    def __init__(
        self, port: int, timeout: float = 120.0
    ) -> None:  # kernels may have to be compiled first
        self.wire = socket.create_connection(("127.0.0.1", port), timeout=timeout)
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
