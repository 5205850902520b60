"""Odd words, cells and values: wrong nearly everywhere, and in all kinds of ways."""

import math
import random
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

HUGE = 10**9
Drawn = TypeVar("Drawn")

WORDS = (
    "-1",
    "0",
    "nan",
    "inf",
    "1e400",
    "x",
    "",
    "1,2",
    "[1]",
    "9" * 400,
    "-0",
    "1e308",
    "1e-308",
    "none",
    "1e6",
    "3.7",
    "\udcff",
    "\u202e",
    "--",
    "=",
    "name=1",
    "mamba",
    "trial.nc",
    "%s%n",
)
"""Words on a command line."""
CELLS = (
    "nan",
    "inf",
    "",
    "x",
    "1e400",
    "1e308",
    "-1",
    "0",
    "9" * 400,
    '"',
    "1,5",
    "\u202e",
    "0x1",
    "30 deg",
)
"""Cells of tables."""
LEAVES: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -1,
    0,
    1e308,
    1e-308,
    10**30,
    "",
    "x",
    "\x00",
    True,
    [],
    {},
    [[1]],
    ["a"],
    {"a": 1},
    "{",
)
"""Values in TOML files."""
JSON_VALUES: tuple[Any, ...] = (
    *LEAVES,
    None,
    False,
    -0.0,
    0.5,
    3,
    [1, 2],
    [0.1, 0.2, 0.3],
    [None],
    [[]] * 3,
    ["x"] * 1000,
    "mamba",
    "\ud800",
    "a" * 10_000,
    {"kind": "x"},
    {"kind": None},
    {"kind": "eel-like", "amplitude_deg": 1e300},
    {"": {}},
    [[[[[[1]]]]]],
)
"""Values in JSON messages."""
VALUES: tuple[Callable[[], Any], ...] = (
    lambda: None,
    lambda: 3,
    lambda: -1.5,
    lambda: 0,
    lambda: math.nan,
    lambda: math.inf,
    lambda: 1e300,
    lambda: 2**70,
    lambda: "x",
    lambda: "",
    lambda: b"x",
    lambda: (),
    lambda: (0, 1),
    lambda: [1.0, [2.0]],
    lambda: {},
    lambda: {"x": 1},
    object,
    lambda: np.zeros(3),
    lambda: np.zeros((0, 2)),
    lambda: np.array(2.0),
    lambda: np.zeros((2, 2), dtype=complex),
    lambda: np.array(["a"]),
    lambda: np.array([None]),
    lambda: iter([1]),
    lambda: (k for k in "ab"),
    lambda: range(HUGE),
    lambda: True,
    lambda: int,
    lambda: 1j,
    lambda: Path("nowhere/at/all"),
)
"""Makers of odd arguments of calls."""


def draw_in_turn(rng: random.Random, things: Sequence[Drawn]) -> Iterator[Drawn]:
    """Yield these without end in a random order, each once before any comes again.

    Args:
        rng: Source of the order.
        things: What is drawn.
    """
    while True:
        yield from rng.sample(things, len(things))
