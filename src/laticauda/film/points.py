"""Points tracked on one body in a film: where each was seen in every frame, and how surely."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from laticauda.values import BadArgument, check_choice, check_label, check_text

UNITS = ("px", "m")
"""Units of positions: pixels of the film (x right, y down), or metres in a plane (right handed)."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class TrackedPoints:
    """Points tracked on one body in a film.

    In px, x points right and y down from the upper left corner of the picture. In m, the axes lie in
    the plane of motion and are right handed, seen from above.

    Raises:
        ValueError: If the fields do not fit together; the message names the field.
    """

    time: Float[np.ndarray, " n_frames"]
    """Time of every frame, strictly increasing [s]."""
    names: tuple[str, ...]
    """Name of every point, each once."""
    position: Float[np.ndarray, "n_frames n_points 2"]
    """Position of every point in every frame; nan where it was lost [px or m]."""
    likelihood: Float[np.ndarray, "n_frames n_points"]
    """How sure the tracker was, from 0 to 1; nan where the file does not say [-]."""
    unit: str
    """Unit of the positions, `px` or `m`."""
    individual: str = ""
    """Name of the individual; empty if there is only one."""
    source: str = ""
    """What was read, in one line."""
    notes: tuple[str, ...] = ()
    """What a reader of the figures should know, a sentence each: points taken for lost, gaps."""

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        self._check_time()
        self._check_names()
        shape = (self.time.size, len(self.names))
        if self.position.shape != (*shape, 2):
            rule = f"must have a place for each of {shape[0]} frames, {shape[1]} points and 2 axes"
            raise BadArgument("position", f"{rule}, got the shape {self.position.shape}")
        if self.likelihood.shape != shape:
            rule = f"must have a number for each of {shape[0]} frames and {shape[1]} points"
            raise BadArgument("likelihood", f"{rule}, got the shape {self.likelihood.shape}")
        if np.any(np.isinf(self.position)):
            raise BadArgument("position", "must be finite, or nan where a point was lost, got inf")
        if np.any(np.isnan(self.position[..., 0]) != np.isnan(self.position[..., 1])):
            raise BadArgument("position", "must lack both x and y where a point was lost, not one")
        if np.any((self.likelihood < 0.0) | (self.likelihood > 1.0)):
            raise BadArgument("likelihood", "must lie between 0 and 1, or be nan where unknown")
        check_choice("unit", self.unit, UNITS)
        for name in ("individual", "source"):
            check_text(name, getattr(self, name))

    def __repr__(self) -> str:
        """Return one line: points, frames, their rate, and the unit."""
        film = f"{self.n_frames} frames at {self.frame_rate:.4g} 1/s"
        return f"<TrackedPoints: {self.n_points} points in {film}, {self.unit}>"

    def _check_time(self) -> None:
        if self.time.ndim != 1 or self.time.size < 2:
            raise BadArgument("time", f"must hold at least two frames, got {self.time.size}")
        if not np.all(np.isfinite(self.time)):
            raise BadArgument("time", "must hold finite numbers in s, one for each frame")
        steps = np.diff(self.time)
        if np.any(steps <= 0.0):
            frame = int(np.argmax(steps <= 0.0)) + 1
            now, before = self.time[frame], self.time[frame - 1]
            rule = f"must increase from frame to frame, got {now:.6g} s after {before:.6g} s"
            raise BadArgument("time", f"{rule} in frame {frame}")

    def _check_names(self) -> None:
        if not self.names:
            raise BadArgument("names", "must name at least one point, got none")
        for i, name in enumerate(self.names):
            check_label(f"names[{i}]", name)
            if name in self.names[:i]:
                raise BadArgument("names", f"must name every point once, got `{name}` twice")

    @property
    def n_frames(self) -> int:
        """Number of frames."""
        return self.time.size

    @property
    def n_points(self) -> int:
        """Number of points."""
        return len(self.names)

    @property
    def is_seen(self) -> Bool[np.ndarray, "n_frames n_points"]:
        """Where each point was seen."""
        return np.isfinite(self.position[..., 0])

    @property
    def frame_rate(self) -> float:
        """Frames per second: the most usual step between frames, inverted [1/s]."""
        return float(1.0 / np.median(np.diff(self.time)))

    def index_of(self, name: str) -> int:
        """Return the index of a point.

        Args:
            name: Its name.

        Raises:
            ValueError: If there is no such point; the message lists those that there are.
        """
        return self.names.index(check_choice("point", name, self.names))

    def only(self, names: tuple[str, ...]) -> "TrackedPoints":
        """Return some of the points, in this order.

        Args:
            names: Their names.

        Raises:
            ValueError: If there is no such point.
        """
        columns = [self.index_of(name) for name in names]
        return replace(
            self,
            names=names,
            position=self.position[:, columns],
            likelihood=self.likelihood[:, columns],
        )

    def with_notes(self, *notes: str) -> "TrackedPoints":
        """Return the same points with further notes.

        Args:
            notes: Sentences for a reader of the figures.
        """
        return replace(self, notes=(*self.notes, *notes))
