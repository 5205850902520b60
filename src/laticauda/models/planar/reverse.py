"""Reverse mode: derivatives of runs with prescribed joints to all their rows, at the price of a few runs.

`adjoint` holds the kernels, `pullbacks` the formulas that they are made of. Here a run is taken apart
into segments: their begins are kept, and of one segment at a time what all of its stages computed.
"""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.planar import rows
from laticauda.models.planar.batch import (
    PATH_ROWS,
    WIDTH,
    Block,
    Run,
    aligned,
    block_of,
    columns_of,
    side_by_side,
)
from laticauda.models.planar.model import TEMPLATES, PlanarPlant
from laticauda.values import Formula
from laticauda.water.fluid import PolynomialDrag

SEGMENT = 1000
"""Steps between two states that are kept of a run: most runs are a single segment, of which everything is kept."""
SEED_ROWS = rows.BASE_ROWS + rows.N_WORKS
"""Numbers of a sample with respect to which a derivative can begin: the base's state, HEADING to EDGE_MEMORY, then
the works."""
SEED_WORK = rows.BASE_ROWS
"""The first work among these numbers."""
ADJOINT_TEMPLATES = {
    **TEMPLATES,
    "kept_run": ("n_lanes", "drag_law", "flow_parts", "joint_law"),
    "adjoint_references": ("n_lanes", "drag_law", "flow_parts", "joint_law", "pullbacks"),
    "adjoint": ("n_lanes", "drag_law", "flow_parts", "joint_law", "pullbacks"),
}
"""Templates of the kernels that go backward, see `model.TEMPLATES`."""


_specialized: dict[tuple[int, str], ModuleType] = {}
"""Kernels by number of lanes and digest of the drag law."""


def seed_of(row: int) -> int:
    """Return the place of a row of the base's state among the SEED_ROWS.

    Args:
        row: One of HEADING to EDGE_MEMORY.
    """
    return row - rows.HEADING


def find_obstacle(plant: PlanarPlant) -> str | None:
    """Return what keeps the runs of a plant from being differentiated backward; None if nothing does.

    Args:
        plant: The plant.

    Raises:
        NotTraceable: If a formula of the model itself does more than arithmetic.
    """
    from laticauda.compiling.pullbacks import NotTraceable
    from laticauda.models.planar.pullbacks import write_pullbacks

    if plant.is_implicit:
        return "its joints are driven, or its fin bends"
    if plant.flow.kinds:
        return "the water has a flow that depends on place or time"
    try:
        specialize(WIDTH, plant.law.formula)
    except NotTraceable as error:
        # A fault in a formula of the model is no fault of the law: it shows with a law of mere arithmetic, too.
        write_pullbacks(PolynomialDrag().formula)
        return f"its drag law is no mere arithmetic: {error}"
    return None


def specialize(width: int, drag_law: Formula) -> ModuleType:
    """Return the kernels that go backward for `width` lanes and one drag law.

    Args:
        width: Number of runs side by side.
        drag_law: Formula of the drag law.

    Raises:
        NotTraceable: If the drag law does more than arithmetic with its numbers.
    """
    # Numba is slow to import.
    from laticauda.compiling.formulas import digest_of
    from laticauda.compiling.templates import specialized
    from laticauda.models.planar.pullbacks import write_pullbacks

    key = width, digest_of(drag_law)
    if key in _specialized:
        return _specialized[key]
    names = {
        "n_lanes": width,
        "drag_law": drag_law,
        "joint_law": None,
        "flow_parts": (),
        "pullbacks": write_pullbacks(drag_law),
    }
    _specialized[key] = specialized("laticauda.models.planar", ADJOINT_TEMPLATES, names)
    return _specialized[key]


class Room:
    """Memory for what is kept of runs; whoever marches back often brings the same to each march.

    New memory has to be cleared by the operating system, which takes as long as a run.
    """

    def __init__(self) -> None:
        self._arrays: dict[str, np.ndarray] = {}

    def array(self, name: str, *shape: int) -> np.ndarray:
        """Return an aligned array of numbers, left over from its last use, until the name is asked for again.

        Args:
            name: Name of the array.
            shape: Its shape.
        """
        size = int(np.prod(shape))
        if name not in self._arrays or self._arrays[name].size < size:
            self._arrays[name] = aligned((size,), float)
        return self._arrays[name][:size].reshape(shape)


def march_back(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    seed: Callable[[Block], Float[np.ndarray, "n_samples n_seeds n_runs"]],
    room: Room | None = None,
) -> Float[np.ndarray, "n_rows n_runs"]:
    """Simulate up to WIDTH runs of one kind side by side, and differentiate a number of each to all its rows.

    Args:
        runs: The runs, of which `batch.kinds_of` makes one kind, and `find_obstacle` finds nothing against.
        duration: Duration of every run [s].
        sample_interval: Time between two samples [s]; adjusted so that it divides `duration`.
        seed: Returns the derivatives of the number of each run to the samples of its log: SEED_ROWS for
            every sample, finite also where a run diverged. The next march overwrites the block.
        room: Memory, used by one march at a time; None: new.
    """
    march = _March(runs, duration, sample_interval, room or Room())
    block = march.run()
    return march.pull_back(seed(block))


class _Segment(NamedTuple):
    """A part of a run, in sample intervals."""

    begin: int
    """Intervals before it."""
    length: int
    """Intervals of it."""
    is_last: bool
    """Whether the run ends with it."""


class _March:
    """Runs side by side, forward and then backward, segment by segment."""

    def __init__(
        self, runs: Sequence[Run], duration: float, sample_interval: float, room: Room
    ) -> None:
        plant = runs[0].plant
        self._n_runs = len(runs)
        self._n_intervals = max(1, round(duration / sample_interval))
        self._every = plant.steps_in(duration / self._n_intervals)
        self._dt = duration / self._n_intervals / self._every
        self._chain = plant.layout.chain
        self._advance = plant.kernels_of(WIDTH).run
        self._kernels = specialize(WIDTH, plant.law.formula)
        self._rows = side_by_side(columns_of(runs))
        intervals = min(max(1, SEGMENT // self._every), self._n_intervals)
        self._segments = [
            _Segment(
                begin=begin,
                length=min(intervals, self._n_intervals - begin),
                is_last=begin + intervals >= self._n_intervals,
            )
            for begin in range(0, self._n_intervals, intervals)
        ]
        self._states: list[np.ndarray] = []
        """States at the begin of the segments."""
        n_samples, n_steps = 1 + self._n_intervals, intervals * self._every
        kept_run = self._kernels.kept_run
        self._log = room.array("log", n_samples, PATH_ROWS, WIDTH)
        self._seeds = room.array("seeds", n_samples, SEED_ROWS, WIDTH)
        self._stages = room.array(
            "stages", 1 + n_steps, kept_run.RK5_STAGES, kept_run.STAGE_ROWS, WIDTH
        )
        self._moments = room.array(
            "moments", n_steps, kept_run.MOMENTS, kept_run.MOMENT_ROWS, WIDTH
        )

    def run(self) -> Block:
        """Run forward, and keep the states at the begin of all segments, and everything of the last one."""
        n, is_well, n_samples = self._n_runs, np.full(WIDTH, True), np.zeros(WIDTH, dtype=int)
        for segment in self._segments:
            self._states.append(self._rows[HEADER_STATE].copy())
            if segment.is_last:
                self._run_and_keep(segment)
            else:
                self._run_fast(segment)
            n_written = self._rows[rows.SAMPLES].astype(int)
            # The first sample of a further segment is the last one of the segment before.
            n_repeated = 0 if segment.begin == 0 else 1
            n_samples += is_well * np.maximum(n_written - n_repeated, 0)
            is_well &= n_written == segment.length + 1
        return block_of(np.arange(n), self._log[..., :n], self._rows[:, :n], n_samples[:n])

    def _run_fast(self, segment: _Segment) -> None:
        """Run a segment, and keep nothing of it but its log."""
        self._advance(
            self._rows,
            *self._chain,
            False,
            segment.length * self._every,
            self._dt,
            self._every,
            self._log_of(segment),
        )

    def _run_and_keep(self, segment: _Segment) -> None:
        """Run a segment, and keep what going back needs of it."""
        self._kernels.kept_run.run_and_keep(
            self._rows,
            *self._chain,
            segment.length * self._every,
            self._dt,
            self._every,
            segment.is_last,
            self._log_of(segment),
            self._stages,
            self._moments,
        )

    def _log_of(self, segment: _Segment) -> np.ndarray:
        return self._log[segment.begin : segment.begin + segment.length + 1]

    def pull_back(
        self, seeds: Float[np.ndarray, "n_samples n_seeds n_runs"]
    ) -> Float[np.ndarray, "n_rows n_runs"]:
        """Return the derivatives to all rows, from those to the samples of the log."""
        self._seeds[..., : self._n_runs] = seeds
        self._seeds[..., self._n_runs :] = 0.0
        with_work = bool(np.any(seeds[:, SEED_WORK:]))
        bars = aligned(self._rows.shape, float)
        for segment, state in reversed(list(zip(self._segments, self._states, strict=True))):
            if not segment.is_last:
                self._rows[HEADER_STATE] = state
                self._run_and_keep(segment)
            self._kernels.pull_segment(
                self._rows,
                bars,
                *self._chain,
                segment.length * self._every,
                self._dt,
                self._every,
                segment.begin * self._every,
                segment.is_last,
                with_work,
                self._stages,
                self._moments,
                self._seeds,
            )
        return bars[:, : self._n_runs]


HEADER_STATE = slice(rows.TIME, rows.TIME + rows.LOG_STATE)
"""Rows of the state of a run whose joints are prescribed."""
