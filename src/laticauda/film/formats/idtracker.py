"""Files of idtracker.ai: `trajectories.csv` with `attributes.json` beside it, or `trajectories.npy`.

They hold one point for every individual, its centroid, in px.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np
from jaxtyping import Float

from laticauda.film.formats import contents
from laticauda.film.formats.format import PointFormat, PointsFile, TrackedIndividual
from laticauda.values import files
from laticauda.values.tables import build_table, parse_sheet

POINT = "centroid"
"""Name of the only point of an individual."""
X_COLUMN = re.compile(r"x(\d+)")
TIME_COLUMNS = ("time", "seconds")
"""Names of the column of times, in releases from 5 and before."""
ATTRIBUTES = "attributes.json"
"""File beside the CSV that states the frame rate."""


class Idtracker(PointFormat):
    """Trajectories of individuals; a body of which only the centroid is known has a path, but no shape."""

    called: ClassVar[str] = "idtracker"
    title: ClassVar[str] = "idtracker.ai trajectories, CSV or NPY"

    @staticmethod
    def recognizes(path: Path) -> bool:
        """Return whether it is an array of NumPy, or has columns `x1` and `y1`; see `PointFormat`."""
        if contents.begins_with(path, contents.NUMPY_SIGNATURE):
            return True
        with path.open("rb") as file:
            line = file.readline(1 << 16).decode("utf-8-sig", errors="replace")
        names = {name.strip('" \r\n') for name in re.split("[,;\t]", line)}
        return {"x1", "y1"} <= names

    @staticmethod
    def read(path: Path) -> PointsFile:
        """Read the points in a file; see `PointFormat.read`."""
        if contents.begins_with(path, contents.NUMPY_SIGNATURE):
            return _read_array(path)
        return _read_csv(path)


def _read_array(path: Path) -> PointsFile:
    session_object = contents.read_pickled_array(path)
    if not isinstance(session_object, dict) or "trajectories" not in session_object:
        raise ValueError("it must be the `trajectories.npy` of idtracker.ai, with `trajectories`.")
    session = cast("dict[str, Any]", session_object)
    trajectories = np.asarray(session["trajectories"], dtype=float)
    probabilities = np.full(trajectories.shape[:2], np.nan)
    if isinstance(session.get("id_probabilities"), np.ndarray):
        probabilities = np.reshape(session["id_probabilities"], trajectories.shape[:2])
    labels = session.get("identities_labels")
    return _build(trajectories, probabilities, session, labels)


def _read_csv(path: Path) -> PointsFile:
    table = build_table(parse_sheet(files.read_bytes(path)))
    numbers = sorted(int(match[1]) for name in table.columns if (match := X_COLUMN.fullmatch(name)))
    x = np.stack([table[f"x{number}"] for number in numbers], axis=1)
    y = np.stack([table[f"y{number}"] for number in numbers], axis=1)
    trajectories = np.stack((x, y), axis=-1)
    attributes: Mapping[str, Any] = {}
    beside = path.with_name(ATTRIBUTES)
    if beside.is_file():
        attributes = _read_attributes(beside)
    stated = dict(attributes)
    names = [name for name in TIME_COLUMNS if name in table.columns]
    if names and "frames_per_second" not in stated and table.n_rows > 1:
        step = float(np.median(np.diff(table[names[0]])))
        if step > 0.0:
            stated["frames_per_second"] = 1.0 / step
    probabilities = np.full(trajectories.shape[:2], np.nan)
    return _build(trajectories, probabilities, stated, stated.get("identities_labels"))


def _read_attributes(path: Path) -> Mapping[str, Any]:
    try:
        attributes: object = json.loads(files.read_text(path))
    except (ValueError, RecursionError) as error:
        raise ValueError(f"`{ATTRIBUTES}` beside it is not JSON: {error}") from None
    if not isinstance(attributes, dict):
        raise ValueError(f"`{ATTRIBUTES}` beside it must be a table.")
    return cast("dict[str, Any]", attributes)


def _build(
    trajectories: Float[np.ndarray, "..."],
    probabilities: Float[np.ndarray, "..."],
    stated: Mapping[str, Any],
    labels: object,
) -> PointsFile:
    """Return what was read, with everyone's centroid."""
    if trajectories.ndim != 3 or trajectories.shape[-1] != 2:
        raise ValueError(
            "its `trajectories` must have the axes frame, individual and x or y, "
            f"got the shape {trajectories.shape}."
        )
    n_frames, n_individuals, _ = trajectories.shape
    names = [str(i + 1) for i in range(n_individuals)]
    if isinstance(labels, list | tuple) and len(cast("list[Any]", labels)) == n_individuals:
        names = [str(label) for label in cast("list[Any]", labels)]
    position = np.where(np.isfinite(trajectories), trajectories, np.nan)
    position[np.isnan(position).any(axis=-1)] = np.nan
    individuals = [
        TrackedIndividual(
            name=name,
            points=(POINT,),
            position=position[:, i, np.newaxis],
            likelihood=np.clip(probabilities[:, i, np.newaxis], 0.0, 1.0),
        )
        for i, name in enumerate(names)
    ]
    return PointsFile(
        tracker="idtracker.ai",
        frame=np.arange(float(n_frames)),
        individuals=tuple(individuals),
        frame_rate=_number(stated, "frames_per_second"),
        body_length=_number(stated, "body_length"),
    )


def _number(stated: Mapping[str, Any], name: str) -> float | None:
    """Return a number > 0 that a file states; None if it states none."""
    value = stated.get(name)
    if not isinstance(value, int | float | np.integer | np.floating):
        return None
    number = float(cast("float", value))
    if number > 0.0:
        return number
    return None
