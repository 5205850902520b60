"""Files of the benchmark: tables that are told apart by the digests of their contents."""

import hashlib
from pathlib import Path
from typing import Any, NamedTuple

from laticauda.values import parse_toml


class ChallengeFile(NamedTuple):
    """A TOML file of the benchmark."""

    table: dict[str, Any]
    """What it says."""
    sha256: str
    """SHA-256 of the file with the line ends of Unix."""


def read_challenge_file(path: Path) -> ChallengeFile:
    """Read a file of the benchmark.

    Args:
        path: The file.
    """
    content = path.read_bytes().replace(b"\r\n", b"\n")
    return ChallengeFile(
        table=parse_toml(content.decode(), path), sha256=hashlib.sha256(content).hexdigest()
    )
