"""The memory of an optimization: one file with every point that was tried, and what it came to.

A search is determined by its seed and by the figures that it is given, and a trial by its point. So the points and
their figures are all that must be kept: a search that was stopped is asked the same again, is given from the file what
it was given before, and goes on as if nothing had happened, to the same bits. Nothing in the file is executed.

The file is written beside its place and moved there, so it is always that of a whole generation.
"""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import BadArgument
from laticauda.files import write
from laticauda.studies.folder import check_same, storage
from laticauda.studies.optimization import VIOLATION
from laticauda.studies.trials import QUANTITIES, Column, Table

CHECKPOINT, JOB = "checkpoint.npz", "optimization"
DEFINITION, POINTS = "definition", "points"
COLUMNS = (*QUANTITIES, VIOLATION)


@dataclass(kw_only=True)
class Checkpoint:
    """Every point that was tried so far, in the order of the search; in a folder, or in memory alone."""

    definition: Mapping[str, Any]
    """What the points depend on."""
    n_names: int
    """Number of parameters."""
    folder: Path | None = None
    """Where the file is; None keeps nothing."""
    points: Table = field(init=False)
    """As the search asked for them."""
    found: dict[str, Column] = field(init=False)
    """What they came to, by name."""

    def __post_init__(self) -> None:
        """Begin with none."""
        self.points = np.empty((0, self.n_names))
        self.found = {name: np.empty(0, dtype=bool if name == "succeeded" else float) for name in COLUMNS}

    def load(self) -> None:
        """Take over what is stored, if anything.

        Raises:
            ValueError: If the folder holds something else, or another optimization: the message names what differs.
        """
        if self.folder is None or not (self.folder / CHECKPOINT).exists():
            return
        try:
            content = io.BytesIO((self.folder / CHECKPOINT).read_bytes())
            with np.load(content, allow_pickle=False) as file:
                stored: Any = json.loads(str(file[DEFINITION]))
                points, columns = file[POINTS], {name: file[name] for name in COLUMNS}
        except (ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
            raise BadArgument("folder", f"must hold a readable `{CHECKPOINT}`, got {self.folder}: {error}") from error
        check_same(self.folder, JOB, stored, self.definition)
        if points.ndim != 2 or any(len(column) != len(points) for column in columns.values()):
            raise BadArgument("folder", f"must hold a whole `{CHECKPOINT}`, got {self.folder}")
        self.points, self.found = points, columns

    def first(self, count: int) -> tuple[Table, dict[str, Column]]:
        """The points that were tried first, and what they came to.

        Args:
            count: How many of them.
        """
        return self.points[:count], {name: column[:count] for name, column in self.found.items()}

    def add(self, points: Table, found: dict[str, Column]) -> None:
        """Take a generation in, and store it.

        Args:
            points: As the search asked for them.
            found: What they came to.

        Raises:
            StorageFailed: If the file cannot be written; the older one stays.
        """
        before = len(self.points)
        self.points = np.concatenate((self.points, points))
        self.found = {name: np.concatenate((column, found[name])) for name, column in self.found.items()}
        if self.folder is None:
            return
        arrays: Any = {DEFINITION: np.array(json.dumps(self.definition)), POINTS: self.points, **self.found}
        with storage(self.folder, f"{before} trials are stored"):
            write(self.folder / CHECKPOINT, lambda path: np.savez(path, allow_pickle=False, **arrays))
