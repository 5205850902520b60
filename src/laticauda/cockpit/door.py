"""The door of viser: where it is loaded, the page's server, and the sentence for those who do not have it."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import contextlib
import io
import socket
import warnings
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from laticauda.errors import LaticaudaError, MissingExtra

LOCAL = ("127.0.0.1", "localhost", "::1")


class PortTaken(LaticaudaError, OSError):
    """The page cannot be served where it was asked for."""


@cache
def library() -> Any:
    """The module `viser`. Handles of its pages are `Any` here: their types change with the control.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        return import_module("viser")
    except ImportError as error:
        raise MissingExtra("The cockpit", "viser", "cockpit") from error


def server(host: str, port: int) -> Any:
    """A page's server, on this host and port alone: viser by itself would take the next free port, on all networks.

    Raises:
        MissingExtra: If viser is not installed.
        PortTaken: If something else listens there, or this computer has no such address.
    """
    viser = library()
    try:
        with socket.create_server((host, port)) as probe:
            port = int(probe.getsockname()[1])
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise PortTaken(
            f"Cannot serve the cockpit at {host}:{port}: {why}; `port` 0 takes any that is free."
        ) from error
    with contextlib.redirect_stdout(io.StringIO()):
        return viser.ViserServer(host=host, port=port, label="laticauda", verbose=False)


def stop(page: Any) -> None:
    """Stop a page's server; it would say so on the standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        page.stop()


def move(page: Any, position: np.ndarray, look_at: np.ndarray) -> None:
    """Move a page's camera; a page that has just vanished is no reason to say anything.

    Args:
        page: Whose camera.
        position: Where to [m].
        look_at: What it looks at then [m].
    """
    with warnings.catch_warnings(), page.atomic():
        warnings.simplefilter("ignore", UserWarning)
        page.camera.position = position
        page.camera.look_at = look_at


def time_scale() -> dict[str, Any]:
    """Of a plot whose x axis is seconds: uPlot would take it for dates."""
    return {"x": import_module("viser.uplot").Scale(time=False)}
