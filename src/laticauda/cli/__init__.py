"""The command `laticauda`: text in, one call, text out."""

from laticauda.cli.app import main

__all__ = ["main"]
