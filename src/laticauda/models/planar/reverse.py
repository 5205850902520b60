"""Reverse mode: derivatives of runs with prescribed joints to all their rows, at the price of a few runs.

`adjoint` holds the kernels, `pullbacks` the formulas that they are made of. Here a run is taken apart
into segments: their begins are kept, and of one segment at a time what all of its stages computed.
"""

from collections.abc import Callable, Sequence
from types import ModuleType

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

SEGMENT = 50
"""Steps between two states that are kept of a run."""
SEED_ROWS = rows.BASE_ROWS + rows.N_WORKS
"""Numbers of a sample with respect to which a derivative can begin: the base's state, HEADING to EDGE_MEMORY, then
the works."""
SEED_WORK = rows.BASE_ROWS
"""The first work among these numbers."""
ADJOINT_TEMPLATES = {
    **TEMPLATES,
    "adjoint": ("n_lanes", "drag_law", "flow_parts", "joint_law", "pullbacks"),
}
"""Templates of the kernels that go backward, see `model.TEMPLATES`."""


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
    """
    from laticauda.compiling.pullbacks import NotTraceable

    if plant.is_implicit:
        return "its joints are driven, or its fin bends"
    if plant.flow.kinds:
        return "the water has a flow that depends on place or time"
    try:
        specialize(WIDTH, plant.law.formula)
    except NotTraceable as error:
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
    from laticauda.compiling.templates import specialized
    from laticauda.models.planar.pullbacks import write_pullbacks

    names = {
        "n_lanes": width,
        "drag_law": drag_law,
        "joint_law": None,
        "flow_parts": (),
        "pullbacks": write_pullbacks(drag_law),
    }
    return specialized("laticauda.models.planar", ADJOINT_TEMPLATES, names)


def march_back(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    seed: Callable[[Block], Float[np.ndarray, "n_samples n_seeds n_runs"]],
) -> Float[np.ndarray, "n_rows n_runs"]:
    """Simulate up to WIDTH runs of one kind side by side, and differentiate a number of each to all its rows.

    Args:
        runs: The runs, of which `batch.kinds_of` makes one kind, and `find_obstacle` finds nothing against.
        duration: Duration of every run [s].
        sample_interval: Time between two samples [s]; adjusted so that it divides `duration`.
        seed: Returns the derivatives of the number of each run to the samples of its log: SEED_ROWS for
            every sample, finite also where a run diverged.
    """
    plant = runs[0].plant
    n_intervals = max(1, round(duration / sample_interval))
    every = plant.steps_in(duration / n_intervals)
    dt = duration / n_intervals / every
    chain = plant.layout.chain
    S = side_by_side(columns_of(runs), runs)
    log = aligned((1 + n_intervals, PATH_ROWS, WIDTH), float)
    advance = plant.kernels_of(WIDTH).run
    states: list[np.ndarray] = []
    is_well = np.full(WIDTH, True)
    n_samples = np.zeros(WIDTH, dtype=int)
    intervals = max(1, SEGMENT // every)
    begins = range(0, n_intervals, intervals)
    for begin in begins:
        count = min(intervals, n_intervals - begin)
        states.append(S[HEADER_STATE].copy())
        part = log[begin : begin + count + 1]
        advance(S, *chain, False, count * every, dt, every, part)
        n_written = S[rows.SAMPLES].astype(int)
        # The first sample of a further segment is the last one of the segment before.
        n_repeated = 0 if begin == 0 else 1
        n_samples += is_well * np.maximum(n_written - n_repeated, 0)
        is_well &= n_written == count + 1
    block = block_of(
        np.arange(len(runs)), log[..., : len(runs)], S[:, : len(runs)], n_samples[: len(runs)]
    )
    seeds = aligned((1 + n_intervals, SEED_ROWS, WIDTH), float)
    seeds[:, :, : len(runs)] = seed(block)
    kernels = specialize(WIDTH, plant.law.formula)
    bars = aligned(S.shape, float)
    n_steps = min(intervals, n_intervals) * every
    stages = aligned((1 + n_steps, kernels.RK5_STAGES, kernels.STAGE_ROWS, WIDTH), float)
    moments = aligned((n_steps, kernels.MOMENTS, kernels.MOMENT_ROWS, WIDTH), float)
    with_work = bool(np.any(seeds[:, rows.BASE_ROWS :]))
    for begin, state in reversed(list(zip(begins, states, strict=True))):
        count = min(intervals, n_intervals - begin)
        S[HEADER_STATE] = state
        is_last = begin + count == n_intervals
        first_step, steps = begin * every, count * every
        kernels.pull_segment(
            S,
            bars,
            *chain,
            steps,
            dt,
            every,
            first_step,
            is_last,
            with_work,
            stages,
            moments,
            seeds,
        )
    return bars[:, : len(runs)]


HEADER_STATE = slice(rows.TIME, rows.TIME + rows.LOG_STATE)
"""Rows of the state of a run whose joints are prescribed."""
