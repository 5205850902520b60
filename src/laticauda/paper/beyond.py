"""Beyond the paper: a current across the path, a curved path, and open-loop turning. Simulation only."""

from dataclasses import dataclass, field
from typing import Unpack

from laticauda.paper.curved import CurvedRun, CurvedSettings, curved_run
from laticauda.paper.drift import DriftRun, DriftSettings, drift_run
from laticauda.paper.runs import Runs, Study
from laticauda.paper.turning import TurningCurve, TurningSettings, turning_curve
from laticauda.scenarios import Model, ModelChanges, model_of
from laticauda.studies.progress import Progress


@dataclass(frozen=True, kw_only=True)
class BeyondSettings:
    """What is run beyond the paper."""

    drift: DriftSettings = field(default_factory=DriftSettings)
    """A current across the path."""
    curved: CurvedSettings = field(default_factory=CurvedSettings)
    """A curved path."""
    turning: TurningSettings = field(default_factory=TurningSettings)
    """Turns with a constant offset."""

    @property
    def n_runs(self) -> int:
        """How many runs all of it takes [-]."""
        return self.drift.n_runs + self.curved.n_runs + self.turning.n_runs


@dataclass(frozen=True, kw_only=True, eq=False)
class BeyondStudy(Study[BeyondSettings]):
    """What was run beyond the paper, and what came out."""

    drift: tuple[DriftRun, ...]
    """One per law."""
    curved: tuple[CurvedRun, ...]
    """One per swimmer."""
    turning: tuple[TurningCurve, ...]
    """One per swimmer."""


def run_beyond(
    settings: BeyondSettings | None = None,
    model: Model | str = "planar",
    *,
    progress: Progress | None = None,
    **changes: Unpack[ModelChanges],
) -> BeyondStudy:
    """Run what the paper did not: a cross current, a curved path, open-loop turning.

    Args:
        settings: None takes the defaults.
        model: By which model, or its name.
        progress: Called after every run with the number of runs done, and of all.
        changes: What differs from the model's defaults.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a run blows up; the message says which.
    """
    settings = settings or BeyondSettings()
    by, runs = model_of(model, **changes), Runs(n_runs=settings.n_runs, progress=progress)
    return BeyondStudy(
        settings=settings,
        how=runs.how,
        drift=tuple(drift_run(settings.drift, law, by, runs) for law in settings.drift.laws),
        curved=tuple(curved_run(settings.curved, one, by, runs) for one in settings.curved.swimmers),
        turning=tuple(turning_curve(settings.turning, one, by, runs) for one in settings.turning.swimmers),
    )
