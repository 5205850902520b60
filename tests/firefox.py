"""Headless Firefox by WebDriver BiDi, the protocol that it speaks itself; for campaigns."""

import base64
import contextlib
import itertools
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FIREFOX = shutil.which("firefox") or shutil.which("firefox-esr")


class Firefox:
    """One page of it."""

    def __init__(self, wire: Any) -> None:
        self._wire, self._numbers = wire, itertools.count(1)
        self._ask("session.new", capabilities={})
        self._page = self._ask("browsingContext.create", type="tab")["context"]

    def _ask(self, method: str, **params: Any) -> dict[str, Any]:
        number = next(self._numbers)
        self._wire.send(json.dumps({"id": number, "method": method, "params": params}))
        while (said := json.loads(self._wire.recv(timeout=60))).get("id") != number:
            pass  # events
        assert said["type"] == "success", said
        return said["result"]

    def size(self, width: int, height: int) -> None:
        """Set that of the page [px]."""
        size = {"width": width, "height": height}
        self._ask("browsingContext.setViewport", context=self._page, viewport=size)

    def open(self, address: str) -> None:
        """Go there, and wait until all is loaded."""
        self._ask(
            "browsingContext.navigate", context=self._page, url="about:blank", wait="complete"
        )
        self._ask("browsingContext.navigate", context=self._page, url=address, wait="complete")

    def evaluate(self, expression: str) -> Any:
        """What an expression in JavaScript gives, as JSON has it; a promise is waited for."""
        text = f"Promise.resolve({expression}).then(JSON.stringify)"
        target = {"context": self._page}
        said = self._ask("script.evaluate", expression=text, target=target, awaitPromise=True)
        assert said["type"] == "success", said
        return json.loads(said["result"].get("value", "null"))

    def screenshot(self, path: Path) -> None:
        """Take a picture of what is seen."""
        path.write_bytes(
            base64.b64decode(
                self._ask("browsingContext.captureScreenshot", context=self._page)["data"]
            )
        )

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Press at a place, and let go at another [px]."""
        moves = [{"type": "pointerMove", "x": round(x), "y": round(y)} for x, y in (begin, end)]
        actions = [
            moves[0],
            {"type": "pointerDown", "button": 0},
            moves[1],
            {"type": "pointerUp", "button": 0},
        ]
        mouse = {"type": "pointer", "id": "mouse", "actions": actions}
        self._ask("input.performActions", context=self._page, actions=[mouse])


@contextlib.contextmanager
def firefox() -> Iterator[Firefox]:
    """A headless Firefox of its own, with a new profile."""
    from websockets.sync.client import connect

    assert FIREFOX is not None
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        words = [
            FIREFOX,
            "--headless",
            "--no-remote",
            "--profile",
            profile,
            "--remote-debugging-port",
            "0",
        ]
        process = subprocess.Popen(
            [*words, "about:blank"], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
        )
        try:
            assert process.stderr is not None
            lines = (re.search(r"ws://[\d.:]+", line) for line in process.stderr)
            address = next(found.group() for found in lines if found)
            with connect(f"{address}/session", max_size=None) as wire:
                yield Firefox(wire)
        finally:
            process.terminate()
            process.wait(20)
