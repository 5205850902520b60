"""Open-loop turning: how fast, and how tightly, a constant offset of all joints turns the swimmer."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, within
from laticauda.paper.runs import Runs, Swimmer
from laticauda.paper.settings import swimmers
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Model

Numbers = Float[np.ndarray, " n_offsets"]


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

    @property
    def n_runs(self) -> int:
        """How many runs it takes [-]."""
        return len(self.offsets) * len(self.swimmers)


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


def turning_curve(settings: TurningSettings, swimmer: Swimmer, model: Model, runs: Runs) -> TurningCurve:
    """One swimmer at every offset.

    Args:
        settings: What is run.
        swimmer: Who swims.
        model: By which model.
        runs: What runs it.

    Raises:
        SimulationFailed: If a run blows up; the message says which.
    """
    found: list[tuple[float, float, float]] = []
    for offset in settings.offsets:
        turn = replace(swimmer, motion=replace(swimmer.gait, offset=offset), model=model, duration=settings.duration)
        trial = runs.swim(f"{swimmer.name}, offset {math.degrees(offset):.3g} deg", turn)
        found.append((trial.turning_rate, trial.path_speed, trial.mechanical_power))
    rate, speed, power = np.array(found).T
    curves = {"turning_rate": rate, "path_speed": speed, "mechanical_power": power}
    return TurningCurve(swimmer=swimmer, offset=np.array(settings.offsets), **curves)
