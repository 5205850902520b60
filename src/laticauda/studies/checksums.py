"""Checksums of the files that a sweep's folder gets once: its definition, and what the arrays are.

They are listed in a file in the form that `sha256sum --check` reads. Results are not among them:
they grow, and every chunk of them carries a checksum of its own (see `damage`).
"""

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from laticauda.values import read_text, write

CHECKSUMS = "checksums.sha256"
"""Name of the file."""
LINE = re.compile(r"([0-9a-f]{64})  (.+)")
"""A line of the file: the SHA-256 of a file, and its name within the folder."""


def checksum_of(content: bytes) -> str:
    """Return the SHA-256 of a file's content."""
    return hashlib.sha256(content).hexdigest()


def write_checksums(path: Path, names: Iterable[str]) -> None:
    """Write the checksums of some files.

    Args:
        path: Their folder.
        names: Their names within the folder, with slashes.

    Raises:
        StorageFailed: If the file cannot be written.
    """
    lines: list[str] = []
    for name in sorted(names):
        checksum = checksum_of((path / name).read_bytes())
        lines.append(f"{checksum}  {name}\n")
    write(path / CHECKSUMS, "".join(lines))


def read_checksums(path: Path) -> Mapping[str, str]:
    """Return the checksums by name of the file; lines that cannot be read are left out.

    Args:
        path: The folder.

    Raises:
        StorageFailed: If the file is not a text.
    """
    matches = map(LINE.fullmatch, read_text(path / CHECKSUMS).split("\n"))
    return {match[2]: match[1] for match in matches if match is not None}


def find_damaged_files(path: Path, names: Iterable[str]) -> list[str]:
    """Return which files are not as they were written, the list of checksums itself included.

    Args:
        path: Their folder; one of an older release has no checksums, and nothing is found in it.
        names: Names of the files that must have a checksum.
    """
    if not (path / CHECKSUMS).exists():
        return []
    try:
        checksums = read_checksums(path)
    except OSError:
        return [CHECKSUMS]
    damaged = [name for name in checksums if _read(path / name) != checksums[name]]
    if not checksums.keys() >= set(names):
        damaged.append(CHECKSUMS)
    return damaged


def _read(file: Path) -> str:
    """Return the checksum that a file has now; "" if it cannot be read."""
    try:
        return checksum_of(file.read_bytes())
    except (OSError, ValueError):
        return ""
