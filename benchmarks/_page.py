"""A page of the cockpit without a picture: it takes everything that comes, and says where its camera is.

    python benchmarks/_page.py http://127.0.0.1:8080

It prints a line with the bytes it got for every second.
"""

import dataclasses
import sys
import time

import msgspec
import viser
from viser._messages import ViewerCameraMessage
from websockets.sync.client import connect

from laticauda.show.cockpit.cameras import HOME

REPORT = 0.1
"""Time between two reports of the camera, as of a page whose camera goes along [s]."""


def camera_report() -> bytes:
    """What a page of a browser says of its camera."""
    position, look_at = HOME
    message = ViewerCameraMessage(
        wxyz=(1.0, 0.0, 0.0, 0.0),
        position=position,
        fov=1.0,
        near=0.01,
        far=1000.0,
        image_height=800,
        image_width=1280,
        look_at=look_at,
        up_direction=(0.0, 0.0, 1.0),
    )
    return msgspec.msgpack.encode({"type": "ViewerCameraMessage", **dataclasses.asdict(message)})


def main(address: str) -> None:
    report = camera_report()
    report_due = 0.0
    n_bytes = 0
    second_ends = time.monotonic() + 1.0
    with connect(
        address.replace("http", "ws"),
        subprotocols=[f"viser-v{viser.__version__}"],
        max_size=None,
        compression=None,
    ) as page:
        while True:
            n_bytes += len(page.recv())
            now = time.monotonic()
            if now > report_due:
                page.send(report)
                report_due = now + REPORT
            if now > second_ends:
                print(n_bytes, flush=True)
                n_bytes = 0
                second_ends = now + 1.0


if __name__ == "__main__":
    main(sys.argv[1])
