"""Side trials: the few runs that the paper's claims need beside the studies.

Lateral undulation over the phase shift with the joint law of the published simulations, and how much the speed depends
on the added inertia and on the depth.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Unpack

import numpy as np
from jaxtyping import Float

from laticauda.actuation import JointLaw
from laticauda.gaits import Gait
from laticauda.paper.measured import percent_change
from laticauda.paper.runs import Coefficients, Runs, Study
from laticauda.paper.settings import SweepSettings, efficiency_settings, paper_coefficients
from laticauda.scenarios import Model, ModelChanges, model_of
from laticauda.studies.progress import Progress

ROBOT = "mamba"
SHALLOW = 0.06  # depth of the axis with the back just covered; a is 0.055 m [m]


def _phase_shifts() -> SweepSettings:
    return next(sweep for sweep in efficiency_settings().sweeps if sweep.parameter == "phase_shift")


def _fast() -> tuple[Gait, ...]:
    found = [row.gait for group in efficiency_settings().groups for row in group.cases if not group.has_fin]
    highest = max(gait.frequency for gait in found)
    return tuple(gait for gait in found if gait.frequency == highest)


@dataclass(frozen=True, kw_only=True)
class SideSettings:
    """What the side trials run."""

    phase_shifts: SweepSettings = field(default_factory=_phase_shifts)
    """The sweep over the phase shift."""
    gaits: tuple[Gait, ...] = field(default_factory=_fast)
    """What sensitivities are taken at; by default the highest frequency of Table 1."""
    duration: float = 30.0
    """Of every trial [s]."""
    coefficients: Coefficients = field(default_factory=paper_coefficients)
    """The water by gait; by default the paper's."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SideTrials(Study[SideSettings]):
    """What the side trials found; all without fin. `how` leaves the sweep out."""

    pd_velocity: Float[np.ndarray, " n_values"]
    """Forward velocity of lateral undulation over the phase shifts with pd joints [m/s]."""
    by_added_inertia: Mapping[str, float]
    """By gait, change of the forward velocity when the added inertia C_M is 0 instead of the water's [%]."""
    by_depth: Mapping[str, float]
    """By gait, change of the forward velocity just below the surface, against deep water [%]."""

    @property
    def pd_optimum(self) -> float:
        """The phase shift at which lateral undulation is fastest with pd joints [rad]."""
        return float(self.settings.phase_shifts.values[np.argmax(self.pd_velocity)])


def run_side_trials(
    settings: SideSettings | None = None,
    model: Model | str = "planar",
    *,
    progress: Progress | None = None,
    **changes: Unpack[ModelChanges],
) -> SideTrials:
    """Run the side trials.

    Args:
        settings: None takes those of the paper.
        model: By which model, or its name; the sweep over the phase shift has pd joints all the same.
        progress: Called after every trial with the number of trials done, and of all.
        changes: What differs from the model's defaults.

    Returns:
        Speeds and their changes.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a trial blows up; the message says which.
    """
    settings = settings or SideSettings()
    by, sweep = model_of(model, **changes), settings.phase_shifts
    gaits = {gait.kind: gait for gait in settings.gaits}
    runs = Runs(n_runs=sweep.values.size + 3 * len(gaits), progress=progress)

    def speed(gait: Gait, how: Model, **others: float) -> float:
        swimmer = settings.coefficients.swimmer(ROBOT, gait, model=how, duration=settings.duration)
        changed = replace(swimmer, environment=replace(swimmer.environment, **others))
        return runs.swim(f"{ROBOT}, {gait.kind}, side trial", changed).forward_velocity

    pd = replace(by, joints=JointLaw.of("pd"), dt=None)
    swept = [speed(sweep.gait("lateral_undulation", at), pd) for at in sweep.values]
    usual = {kind: speed(gait, by) for kind, gait in gaits.items()}

    def changed_by(**others: float) -> dict[str, float]:
        return {kind: percent_change(usual[kind], speed(gait, by, **others)) for kind, gait in gaits.items()}

    return SideTrials(
        settings=settings,
        how=runs.how,
        pd_velocity=np.array(swept),
        by_added_inertia=changed_by(added_inertia=0.0),
        by_depth=changed_by(depth=SHALLOW),
    )
