"""Beyond the paper: a current across the path, a curved path, and open-loop turning. Simulation only."""

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, within
from laticauda.paper.runs import Runs, Study, Swimmer
from laticauda.paper.settings import swimmers
from laticauda.paper.steered import CurvedRun, CurvedSettings, DriftRun, DriftSettings, curved_run, drift_run
from laticauda.quantities import option, quantity, value

Numbers = Float[np.ndarray, " n_offsets"]
CURVES = ("turning_rate", "path_speed", "mechanical_power")


@value
class TurningSettings:
    """Every offset, for every swimmer."""

    offsets: tuple[float, ...] = quantity(
        "rad", "phi_0, rising", gt=0.0, default=tuple(math.radians(value) for value in range(2, 21, 2))
    )
    duration: float = quantity("s", "Of every run, which begins straight and at rest", gt=0.0, default=60.0)
    swimmers: tuple[Swimmer, ...] = option("Who swims: a curve each", default_factory=swimmers)

    def __post_init__(self) -> None:
        """Check what has a range."""
        offsets = self.offsets
        if not offsets or any(after <= before for before, after in pairwise(offsets)):
            raise BadArgument("offsets", f"must hold at least one value [rad] and rise, got {self.offsets}")
        # A turning rate takes two cycles after the transient, which is 10 s or a third of the run.
        longest = max((2.0 * math.pi / one.gait.frequency for one in self.swimmers), default=1.0)
        within("duration", self.duration, max(10.0 + 2.0 * longest, 3.0 * longest), 1e5, "s")


@dataclass(frozen=True, kw_only=True, eq=False)
class TurningCurve:
    """How one swimmer turned, by offset."""

    swimmer: Swimmer
    """Who swam."""
    offset: Numbers
    """phi_0, rising [rad]."""
    turning_rate: Numbers
    """Slope of the cycle-mean heading over the steady part, positive to the left [rad/s]."""
    path_speed: Numbers
    """Length of the center of mass's path / time [m/s]."""
    mechanical_power: Numbers
    """Mean of sum |u phi'| [W]."""

    @property
    def radius(self) -> Numbers:
        """Of the turn, path speed / |turning rate| [m]."""
        return self.path_speed / np.abs(self.turning_rate)


def turning_curve(settings: TurningSettings, swimmer: Swimmer, runs: Runs) -> TurningCurve:
    """One swimmer at every offset.

    Args:
        settings: What is run.
        swimmer: Who swims.
        runs: What runs it.

    Raises:
        SimulationFailed: If a run blows up; the message says which.
    """
    usual = replace(swimmer, model=runs.model, duration=settings.duration)
    turns = {offset: replace(usual, motion=replace(swimmer.gait, offset=offset)) for offset in settings.offsets}
    trials = [runs.swim(f"{swimmer.name}, offset {math.degrees(at):.3g} deg", turn) for at, turn in turns.items()]
    found = {name: np.array([getattr(one, name) for one in trials]) for name in CURVES}
    return TurningCurve(swimmer=swimmer, offset=np.array(settings.offsets), **found)


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
        turns = len(self.turning.offsets) * len(self.turning.swimmers)
        return len(self.drift.laws) + len(self.curved.swimmers) + turns


@dataclass(frozen=True, kw_only=True, eq=False)
class BeyondStudy(Study[BeyondSettings]):
    """What was run beyond the paper, and what came out."""

    drift: tuple[DriftRun, ...]
    """One per law."""
    curved: tuple[CurvedRun, ...]
    """One per swimmer."""
    turning: tuple[TurningCurve, ...]
    """One per swimmer."""

    usual = BeyondSettings

    @classmethod
    def by_runs(cls, settings: BeyondSettings, runs: Runs) -> "BeyondStudy":
        """What comes out of `settings`, swum by `runs`."""
        runs.n_runs = settings.n_runs
        return BeyondStudy(
            settings=settings,
            how=runs.how,
            drift=tuple(drift_run(settings.drift, law, runs) for law in settings.drift.laws),
            curved=tuple(curved_run(settings.curved, one, runs) for one in settings.curved.swimmers),
            turning=tuple(turning_curve(settings.turning, one, runs) for one in settings.turning.swimmers),
        )


run_beyond = BeyondStudy.run
