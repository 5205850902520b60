"""How much of what it offers every joint uses, in many runs side by side."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from laticauda.models.simulate.batch_figures import Block, Run, joint_shares
from laticauda.models.simulate.batch_scenarios import runs_of
from laticauda.models.simulate.run_table import Columns, scenarios_at
from laticauda.models.simulate.runner import silent
from laticauda.models.simulate.steered import run_mixed_batch
from laticauda.scenarios import Scenario

N_SHARES = 7
"""Rows of the shares of a joint."""


def run_joint_shares(
    scenario: Scenario, columns: Columns, *, n_windows: int, threads: int | None
) -> Float[np.ndarray, "n_windows 7 n_driven n_runs"]:
    """Return how much of its angle, speed, torque and room every driven joint uses in runs of a scenario.

    The rows are those of `laticauda.trials.feasibility.compute_joint_shares`, in windows of time; they are
    meaningless where a run diverged.

    Args:
        scenario: What all runs share, of the planar model.
        columns: Values by the name of a parameter, one per run, as `check_columns` returns them.
        n_windows: Number of windows of equal length.
        threads: Number of threads; None uses all cores that this process may use.
    """
    points = np.stack(list(columns.values()), axis=1)
    runs = runs_of(scenarios_at(scenario, tuple(columns), points), steered=True)
    n_driven = len(runs[0].plant.robot.driven_joints)
    shares = np.full((n_windows, N_SHARES, n_driven, len(runs)), np.nan)

    def keep_shares(block_runs: Sequence[Run], block: Block) -> None:
        shares[..., block.index] = joint_shares(block_runs, block, n_windows)

    run_mixed_batch(
        runs,
        scenario.duration,
        scenario.sample_interval,
        threads=threads,
        progress=silent,
        observe=keep_shares,
        with_joints=True,
    )
    return shares
