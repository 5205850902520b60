"""Beyond the paper: a current across the path, a curved path, and open-loop turning. Simulation only."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from laticauda.packaging import __version__
from laticauda.paper.curved import CurvedRun, CurvedSettings, curved_run
from laticauda.paper.drift import DriftRun, DriftSettings, drift_run
from laticauda.paper.swimmers import how_made
from laticauda.paper.turning import TurningCurve, TurningSettings, turning_curve
from laticauda.studies.progress import Progress
from laticauda.trial.contents import Setting


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
class BeyondStudy:
    """What was run beyond the paper, and what came out."""

    settings: BeyondSettings
    """What was run."""
    how: Mapping[str, Setting]
    """How every run was computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s]."""
    version: str
    """Version of laticauda that ran it."""
    drift: tuple[DriftRun, ...]
    """One per law."""
    curved: tuple[CurvedRun, ...]
    """One per swimmer."""
    turning: tuple[TurningCurve, ...]
    """One per swimmer."""


def run_beyond(
    settings: BeyondSettings | None = None,
    *,
    model: str = "planar",
    joints: str = "prescribed",
    offset_bandwidth: float = 10.0,
    progress: Progress | None = None,
) -> BeyondStudy:
    """Run what the paper did not: a cross current, a curved path, open-loop turning.

    Args:
        settings: None takes the defaults.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        progress: Called after every run with the number of runs done, and of all.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a run blows up; the message says which.
    """
    settings = settings or BeyondSettings()
    how: dict[str, Setting] = {}
    n_done = 0

    def done(made: Mapping[str, Setting]) -> None:
        nonlocal n_done
        how.update(made)
        n_done += 1
        if progress is not None:
            progress(n_done, settings.n_runs)

    drift: list[DriftRun] = []
    for law in settings.drift.laws:
        drift.append(drift_run(settings.drift, law, model=model, joints=joints, offset_bandwidth=offset_bandwidth))
        done(how_made(drift[-1].trial))
    curved: list[CurvedRun] = []
    for swimmer in settings.curved.swimmers:
        curved.append(
            curved_run(settings.curved, swimmer, model=model, joints=joints, offset_bandwidth=offset_bandwidth)
        )
        done(how_made(curved[-1].trial))
    turning = tuple(
        turning_curve(settings.turning, one, done, model=model, joints=joints, offset_bandwidth=offset_bandwidth)
        for one in settings.turning.swimmers
    )
    return BeyondStudy(
        settings=settings, how=how, version=__version__, drift=tuple(drift), curved=tuple(curved), turning=turning
    )
