"""The memory of an optimization: one file with every point that was tried, and what it came to.

A search is determined by its seed and by what it is told, and a trial by its point. So the points and their figures are
all that must be kept: a search that was stopped is asked the same again, is told from the file what it was told before,
and goes on as if nothing had happened, to the same bits. Nothing in the file is executed when it is read.

The file is written beside its place and moved there, so it is always that of a whole generation.
"""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from laticauda.studies.ownership import NEW, list_of_differences
from laticauda.studies.problem import VIOLATION
from laticauda.studies.store import locked, spoken
from laticauda.studies.trials import QUANTITIES, Column, Table

CHECKPOINT = "checkpoint.npz"
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
    points: list[Table] = field(default_factory=list[Table])
    """By generation, as the search asked for them."""
    found: list[dict[str, Column]] = field(default_factory=list[dict[str, Column]])
    """By generation, what they came to."""

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
            raise ValueError(f"`folder` must hold a readable `{CHECKPOINT}`, got {self.folder}: {error}.") from error
        listed = list_of_differences(stored, json.loads(json.dumps(self.definition)))
        if listed:
            raise ValueError(
                f"`folder` must be empty, or hold this optimization, got {self.folder} with another one: {listed}."
            )
        if points.ndim != 2 or any(len(column) != len(points) for column in columns.values()):
            raise ValueError(f"`folder` must hold a whole `{CHECKPOINT}`, got {self.folder}.")
        self.points, self.found = [points], [columns]

    @property
    def n_points(self) -> int:
        """How many points there are."""
        return sum(len(points) for points in self.points)

    def all(self, most: int | None = None) -> tuple[Table, dict[str, Column]]:
        """All points and figures as one table each.

        Args:
            most: How many of them, from the first; None for all.
        """
        if len(self.points) != 1:
            empty = {name: np.empty(0, dtype=bool if name == "succeeded" else float) for name in COLUMNS}
            parts = [empty, *self.found]
            self.found = [{name: np.concatenate([part[name] for part in parts]) for name in COLUMNS}]
            self.points = [np.concatenate([np.empty((0, self.n_names)), *self.points])]
        return self.points[0][:most], {name: column[:most] for name, column in self.found[0].items()}

    def add(self, points: Table, found: dict[str, Column]) -> None:
        """Take a generation in, and store it.

        Args:
            points: As the search asked for them.
            found: What they came to.

        Raises:
            StorageFailed: If the file cannot be written; the older one stays.
        """
        before = self.n_points
        self.points.append(points)
        self.found.append({name: found[name] for name in COLUMNS})
        if self.folder is None:
            return
        table, columns = self.all()
        with spoken(self.folder, f"{before} trials are stored"):
            new = self.folder / (CHECKPOINT + NEW)
            arrays = {DEFINITION: np.array(json.dumps(self.definition)), POINTS: table, **columns}
            with new.open("wb") as file:
                np.savez(file, allow_pickle=False, **cast("Any", arrays))
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, self.folder / CHECKPOINT)


@contextmanager
def own(folder: Path | None) -> Generator[None]:
    """Have a folder for oneself; it is made if need be.

    Args:
        folder: Where the files go; None for nowhere.

    Raises:
        ValueError: If it is a file, holds files of somebody else, or another process writes to it.
        StorageFailed: If it cannot be made.
    """
    if folder is None:
        yield
        return
    if folder.exists() and not folder.is_dir():
        raise ValueError(f"`folder` must be a folder, got the file {folder}.")
    with spoken(folder, "0 trials are stored"):
        folder.mkdir(parents=True, exist_ok=True)
    if not (folder / CHECKPOINT).exists():
        others = sorted(file.name for file in folder.iterdir() if file.name != CHECKPOINT + NEW)
        if others:
            raise ValueError(f"`folder` must be empty, or hold this optimization, got {folder} with {others[0]}.")
    with locked(folder):
        yield
