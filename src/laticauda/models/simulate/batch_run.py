"""Running a batch: block by block on all cores, and only a few numbers of each run are kept."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Inexact

from laticauda.models.dynamics.samples import check_size
from laticauda.models.planar.batch import Block, Device, Run, march_many
from laticauda.models.simulate import batch_figures
from laticauda.models.simulate.runner import Progress, silent
from laticauda.trials import REACHED_END
from laticauda.values import check_choice, check_whole_number

CPU = "cpu"
"""Name of the device that needs no further package."""

BlockObserver: TypeAlias = Callable[[Sequence[Run], Block], None]
"""Receives the runs of a block and their results, before the next block overwrites them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BatchResult:
    """All figures of a batch; complex if its runs carry derivatives (see `Run`)."""

    figures: Mapping[str, Inexact[np.ndarray, " n_runs"]]
    """Figures by name, nan where a run has none."""
    succeeded: Bool[np.ndarray, " n_runs"]
    """Whether the run reached its end."""
    status: tuple[str, ...]
    """How each run ended."""


def run_batch(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    threads: int | None,
    progress: Progress,
    weights: Inexact[np.ndarray, " n_runs"] | None = None,
    device: str = CPU,
    observe: BlockObserver = silent,
    with_joints: bool = False,
    with_loads: bool = False,
    march: Callable[..., Iterator[int]] | None = None,
) -> BatchResult:
    """Run a batch, and return the figures of all blocks in the order of the runs.

    Args:
        runs: The runs of the batch.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        weights: Weights of the robots, see `carried_weight` [N]; complex if their runs carry
            derivatives.
        device: cpu, or a device provided by an installed package, such as cuda.
        observe: Called once per block, in the computing threads, before the next block overwrites
            its log; cpu only.
        with_joints: Whether the log that `observe` receives includes the motion of the joints.
        with_loads: Whether the blocks that `observe` receives have loads; cpu only.
        march: Function that simulates the runs, with the arguments of `march_many`, if it is not that
            of the device.
    """
    check_size(duration, sample_interval)
    if threads is not None:
        check_whole_number("threads", threads, 1)
    if march is None:
        march = _march_on(device)
    facts = batch_figures.RunFacts.of(runs)
    if weights is not None:
        facts = facts._replace(weight=weights)
    n_intervals = max(1, round(duration / sample_interval))
    sample_times = np.linspace(0.0, duration, n_intervals + 1)
    kept_runs = _KeptRuns(
        runs=runs,
        sample_times=sample_times,
        steady=batch_figures.Steady.of(runs, sample_times),
        numbers=np.full(
            (batch_figures.N_SAMPLED_NUMBERS, len(runs)), np.nan, dtype=facts.weight.dtype
        ),
        succeeded=np.zeros(len(runs), dtype=bool),
        status=[REACHED_END] * len(runs),
    )

    def keep(block: Block) -> int:
        observe([runs[int(i)] for i in block.index], block)
        kept_runs.add(block)
        return block.index.size

    n_finished = 0
    for n_runs in march(
        runs,
        duration,
        sample_interval,
        keep,
        threads=threads,
        with_joints=with_joints,
        with_loads=with_loads,
    ):
        n_finished += n_runs
        progress(n_finished / len(runs))
    figures = batch_figures.compute_figures(facts, kept_runs.numbers, steady=kept_runs.steady)
    return BatchResult(
        figures={
            name: np.where(kept_runs.succeeded, values, np.nan) for name, values in figures.items()
        },
        succeeded=kept_runs.succeeded,
        status=tuple(kept_runs.status),
    )


@dataclass(frozen=True, kw_only=True)
class _KeptRuns:
    """What is kept of every run; the blocks fill it in, each its own columns."""

    runs: Sequence[Run]
    sample_times: Float[np.ndarray, " n_samples"]
    """Times of the samples of every run [s]."""
    steady: batch_figures.Steady
    """Start of the steady part of every run."""
    numbers: Inexact[np.ndarray, "n_numbers n_runs"]
    """Numbers from which the figures are computed, see `batch_figures.sample_block`."""
    succeeded: Bool[np.ndarray, " n_runs"]
    """Whether the run reached its end."""
    status: list[str]
    """How each run ended."""

    def add(self, block: Block) -> None:
        """Keep what is needed of a block."""
        last_before = self.steady.before[block.index]
        block_runs = [self.runs[int(i)] for i in block.index]
        self.numbers[:, block.index] = batch_figures.sample_block(block_runs, block, last_before)
        reached_end = block.n_samples == self.sample_times.size
        self.succeeded[block.index] = reached_end
        failed_runs = block.index[~reached_end]
        for i, n_samples in zip(failed_runs, block.n_samples[~reached_end], strict=True):
            self.status[i] = self.runs[int(i)].plant.describe_divergence(
                self._time_after(int(n_samples))
            )

    def _time_after(self, n_samples: int) -> float:
        """Return the time that a run of `n_samples` reached, which failed after the last [s]."""
        duration = float(self.sample_times[-1])
        return float(n_samples) * duration / (self.sample_times.size - 1)


def _march_on(device: str) -> Callable[..., Iterator[int]]:
    """Return the function that runs a batch on a device."""
    if check_choice("device", device, (CPU, *Device.names())) == CPU:
        return march_many
    return Device.named(device)().march_many
