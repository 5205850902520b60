"""What links and joints bear in each of many trials: kept block by block while the trials are run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.sampled_loads import FORCES, LEFT, SampledLoads
from laticauda.models.planar.batch import Block, Run
from laticauda.models.simulate.batch_figures import find_period
from laticauda.models.simulate.run_figures import Figure
from laticauda.robot import Water
from laticauda.trials import LOAD_FIGURES, Trial, compute_load_figure, side_areas
from laticauda.trials.feasibility import find_settled_samples
from laticauda.values import DIRECTIONS


@dataclass(frozen=True, kw_only=True, eq=False)
class TrialLoads:
    """What links and joints bear in a trial, each as in a `Trial` that was run with `link_forces`."""

    time: Float[np.ndarray, " n_samples"]
    """Times of the samples [s]."""
    joint_force: Float[np.ndarray, "n_samples n_joints 3"]
    """Force in every joint: along, left, up [N]."""
    joint_moment: Float[np.ndarray, "n_samples n_joints 3"]
    """Moment in every joint, about the same axes [N m]."""
    water_force: Float[np.ndarray, "n_samples n_links 3"]
    """Force of the water on every link: along, left, up [N]."""
    link_force: Mapping[str, Float[np.ndarray, "n_samples n_links n_axes"]]
    """Force on every link by component, world axes [N]."""
    pressure_difference: Float[np.ndarray, "n_samples n_links"] | None
    """Mean pressure on the right side of every link less that on its left; None on ground [Pa]."""

    def __repr__(self) -> str:
        """Return one line: how much there is of what."""
        n_samples, n_joints = self.joint_force.shape[: len(DIRECTIONS) - 1]
        return f"<TrialLoads of {n_joints} joints at {n_samples} samples>"

    @classmethod
    def of_trial(cls, trial: Trial) -> "TrialLoads | None":
        """Return the loads of a trial; None if it has none.

        Args:
            trial: The trial.
        """
        if trial.joint_force is None or trial.joint_moment is None or trial.water_force is None:
            return None
        pressure_difference = None
        if isinstance(trial.environment, Water):
            pressure_difference = trial.pressure_difference
        return cls(
            time=trial.time,
            joint_force=trial.joint_force,
            joint_moment=trial.joint_moment,
            water_force=trial.water_force,
            link_force=dict(trial.link_force or {}),
            pressure_difference=pressure_difference,
        )

    @classmethod
    def of_run(cls, run: Run, time: np.ndarray, loads: SampledLoads) -> "TrialLoads":
        """Return the loads of a run of a batch.

        Args:
            run: The run.
            time: Times of its samples [s].
            loads: Its loads, in lanes that it shares with others.
        """
        alone = SampledLoads(*(values.copy() for values in loads))
        pressure_difference = None
        if isinstance(run.plant.environment, Water):
            areas = side_areas(run.plant.robot)
            pressure_difference = alone.water_force[:, :, LEFT] / areas
        return cls(
            time=time,
            joint_force=alone.joint_force,
            joint_moment=alone.joint_moment,
            water_force=alone.water_force,
            link_force=dict(zip(FORCES, alone.link_force, strict=True)),
            pressure_difference=pressure_difference,
        )


class KeptLoads:
    """What is kept of the loads of a batch; nan and None where a run diverged.

    Args:
        n_runs: Number of runs.
        with_series: Whether to keep all samples, not only the figures.
    """

    def __init__(self, n_runs: int, *, with_series: bool) -> None:
        self.figures: dict[str, Figure] = {name: np.full(n_runs, np.nan) for name in LOAD_FIGURES}
        """The figures of `laticauda.trials.LOAD_FIGURES`."""
        self.series: list[TrialLoads | None] = [None] * n_runs
        """Loads of every run at all samples, if they are kept."""
        self._with_series = with_series

    def add(self, runs: Sequence[Run], block: Block) -> None:
        """Keep what is needed of a block.

        Args:
            runs: Its runs.
            block: Their results, with loads.
        """
        assert block.loads is not None
        time = block.time.copy()
        for run, index, n_samples, loads in zip(
            runs, block.index.tolist(), block.n_samples, block.loads, strict=True
        ):
            if n_samples < time.size:
                continue
            counts = find_settled_samples(time, find_period(run.command.gait))
            for name, values in self.figures.items():
                values[index] = compute_load_figure(
                    name, loads.joint_force, loads.joint_moment, counts
                )
            if self._with_series:
                self.series[index] = TrialLoads.of_run(run, time, loads)
