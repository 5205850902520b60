"""The table of claims and misprints, `claims.toml`."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from laticauda.values import read_toml

Entry = Mapping[str, Any]
"""A claim or a misprint, by the names of its fields there."""


@cache
def read_claims_table() -> Mapping[str, Sequence[Entry]]:
    """Return the content of `claims.toml`; white space in texts is reduced to single spaces."""
    table = read_toml(Path(__file__).with_name("claims.toml"))
    joined: dict[str, Sequence[Entry]] = {}
    for section, entries in table.items():
        joined[section] = [_join_lines(entry) for entry in entries]
    return joined


def _join_lines(entry: Entry) -> Entry:
    """Return an entry with its texts on one line each."""
    joined: dict[str, Any] = {}
    for name, value in entry.items():
        joined[name] = value
        if isinstance(value, str):
            joined[name] = " ".join(value.split())
    return joined
