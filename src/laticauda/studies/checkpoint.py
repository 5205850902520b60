"""Checkpoint of an optimization: all points tried so far and their figures, in one file.

A search is determined by its bounds, its seed and the figures returned to it, and a trial by its
point. Therefore only the points and their figures are stored, and none of the search's state: a
search that was stopped is replayed with the figures in the file and then continues as if it had not
been stopped, bit for bit. Nothing in the file is executed. It is written under another name and
then moved into place, so it always holds whole generations.
"""

import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from laticauda.studies.folder import check_same, readable, storage
from laticauda.studies.optimization import VIOLATION
from laticauda.studies.point_trials import QUANTITIES
from laticauda.values import BadArgument, files

CHECKPOINT = "checkpoint.npz"
"""Name of the file."""
JOB = "optimization"
"""What an optimization is called in messages about its folder."""
DEFINITION = "definition"
"""Name of the array with everything that the points depend on."""
POINTS = "points"
"""Name of the array with the points as requested by the search, one per row."""
Columns: TypeAlias = dict[str, Any]
"""Points and results by name."""


def join_columns(before: Columns, after: Columns) -> Columns:
    """Return the points and results of two stretches of a search as one.

    Args:
        before: The earlier ones.
        after: The later ones.
    """
    joined: dict[str, np.ndarray] = {}
    for name, column in before.items():
        joined[name] = np.concatenate((column, after[name]))
    return joined


class Checkpoint:
    """All points tried so far, in the order of the search; in a folder, or in memory only.

    Args:
        definition: Everything that the points depend on.
        n_names: Number of parameters.
        folder: Folder of the file; None stores nothing.
        quantities: Names of what is known of every point besides how far it is from being feasible.
    """

    def __init__(
        self,
        definition: Mapping[str, Any],
        n_names: int,
        folder: Path | None,
        *,
        quantities: Sequence[str] = QUANTITIES,
    ) -> None:
        self.definition = definition
        self.folder = folder
        self._columns = (*quantities, VIOLATION)
        self.tried: Columns = {POINTS: np.empty((0, n_names))}
        """The points as requested by the search, one per row, and their results, by name."""
        for name in self._columns:
            self.tried[name] = np.empty(0, dtype=bool if name == "succeeded" else float)

    def load(self) -> None:
        """Load the stored points, if any.

        Raises:
            ValueError: If the folder holds something else or another optimization; the message
                names the differences.
        """
        if self.folder is None:
            return
        path = self.folder / CHECKPOINT
        if not path.exists():
            return
        with readable(self.folder, CHECKPOINT):
            content = io.BytesIO(path.read_bytes())
            # numpy compares the checksum of every array with that in the file.
            with np.load(content, allow_pickle=False) as file:
                definition = str(file[DEFINITION])
                stored: dict[str, Any] = dict(json.loads(definition))
                # Another optimization may have other columns; it is refused below.
                names = [name for name in (POINTS, *self._columns) if name in file]
                tried = {name: file[name] for name in names}
        check_same(self.folder, JOB, stored, self.definition)
        if not self._is_intact(tried):
            raise BadArgument("folder", f"must hold an intact `{CHECKPOINT}`, got {self.folder}")
        self.tried = tried

    def _is_intact(self, tried: Columns) -> bool:
        """Return whether stored arrays are those that we need, of their kinds, and all of the same length."""
        if tried.keys() != self.tried.keys():
            return False
        for stored_column, column in zip(tried.values(), self.tried.values(), strict=True):
            if stored_column.dtype != column.dtype:
                return False
            if stored_column.ndim != column.ndim:
                return False
            if stored_column.shape[1:] != column.shape[1:]:
                return False
        lengths = {len(column) for column in tried.values()}
        return len(lengths) <= 1

    def add(self, generation: Columns) -> None:
        """Add a generation, and store it.

        Args:
            generation: Its points and their results.

        Raises:
            StorageFailed: If the file cannot be written; the previous one is kept.
        """
        n_before = len(self.tried[POINTS])
        self.tried = join_columns(self.tried, generation)
        if self.folder is None:
            return
        definition = json.dumps(self.definition)
        arrays: Any = {DEFINITION: np.array(definition), **self.tried}
        with storage(self.folder, f"{n_before} trials are stored"):
            files.write(
                self.folder / CHECKPOINT, lambda path: np.savez(path, allow_pickle=False, **arrays)
            )
