"""Learning twin: its settings, what it remembers, and its results."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple, TypeAlias

from laticauda.control.estimation.samples import Sample
from laticauda.control.estimation.stretches import MARGIN, Array
from laticauda.models.dynamics import Plant
from laticauda.values import option, quantity, value_class

Coefficient: TypeAlias = Literal[
    "normal_drag", "tangential_friction", "added_mass", "added_inertia", "tangential_added_mass"
]

STD_OF_95_PERCENT = 1.96
"""Standard deviations to either side of a mean that hold 95 % of a normal distribution [-]."""
UNITS = {"play": "rad", "crab": "rad", "current_x": "m/s", "current_y": "m/s"}
"""Units of the unknowns that are no coefficients, in their order."""


@value_class
class Learning:
    """What is learnt while a robot swims, and what counts as a change."""

    unknown: tuple[Coefficient, ...] = option(
        "coefficients of the water that are learned", default=("normal_drag", "tangential_friction")
    )
    coefficient: float = quantity(
        "", "their relative uncertainty at the beginning", gt=0.0, default=0.3
    )
    current: float = quantity("m/s", "how fast the water may move", gt=0.0, default=0.05)
    window: float = quantity("s", "how long data are remembered", gt=5.0, default=60.0)
    doubt: float = quantity(
        "", "standard deviations beyond which the water has changed", gt=0.0, default=10.0
    )
    stuck: float = quantity(
        "", "share of its usual swing below which a joint is stuck", gt=0.0, default=0.3
    )
    weak: float = quantity("", "share of it below which a joint is weak", gt=0.0, default=0.88)


@dataclass(frozen=True, kw_only=True)
class Learned:
    """What is known at the end of one stretch, half a cycle of the gait."""

    time: float
    """When it ended [s]."""
    value: Mapping[str, float]
    """The coefficients [-], the joints' `play` and the `crab` angle [rad], `current_x` and
    `current_y` [m/s]."""
    deviation: Mapping[str, float]
    """Their standard deviations.

    95 % of all intervals of 1.96 of them to either side are to hold the truth.
    """
    changes: tuple[str, ...] = ()
    """What has just been found to have happened, in sentences."""

    @property
    def line(self) -> str:
        """Every value with its interval of 95 %, for people."""
        return ", ".join(self._describe(name) for name in self.value)

    def _describe(self, name: str) -> str:
        """Return one value with its interval and unit."""
        label = name.replace("_", " ")
        interval = STD_OF_95_PERCENT * self.deviation[name]
        unit = UNITS.get(name, "")
        return f"{label} {self.value[name]:.4f} ± {interval:.4f} {unit}".rstrip()


class SampleRow(NamedTuple):
    """What counts of one sample."""

    time: float
    """Time of the sample [s]."""
    values: tuple[float, ...]
    """Of a frame: x, y [m] and yaw of the link [rad]. Of joints: all angles [rad], then all torques
    [N m]. Of references: all angles [rad]."""


class NamedFault(NamedTuple):
    """Fault of a joint that was reported."""

    joint: int
    """Index of the joint, from 0 at the tail."""
    fault: str
    """What was reported: "is stuck" or "is weak"."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnerState:
    """What a learner remembers."""

    plant: Plant[Any]
    """The robot and its water as they are thought to be, in still water; what is learnt counts from
    there."""
    mean: Array
    """Unknowns: logarithms of the coefficients, relative to those of `plant`; play in `PLAY_SCALE`,
    crab angle [rad] and current x, y [m/s]."""
    deviation: Array
    """Their standard deviations."""
    samples: Mapping[type[Sample], tuple[SampleRow, ...]]
    """Samples of the last minute, by their class."""
    bounds: tuple[float, ...] = ()
    """Where stretches begin and the last one ends [s]."""
    swings: tuple[Array, ...] = ()
    """Swing of every joint in each cycle so far, per swing of its reference [-]."""
    n_weak: int = 0
    """Cycles in a row in which a joint was weak [-]."""
    n_odd: int = 0
    """Cycles in a row that do not fit to those before [-]."""
    named: frozenset[NamedFault] = frozenset()
    """Faults of joints that were reported."""
    changes: tuple[str, ...] = ()
    """What has happened in this stretch."""
    learned: Learned | None = None
    """What is known, if the last sample ended a stretch that said so."""

    def since(self, time: float) -> "LearnerState":
        """Return the state without what is from before a time; a margin of samples stays.

        Args:
            time: The time; infinite to forget everything [s].
        """
        oldest = time - 2.0 * MARGIN
        samples: dict[type[Sample], tuple[SampleRow, ...]] = {}
        for kind, rows in self.samples.items():
            samples[kind] = tuple(row for row in rows if row.time >= oldest)
        bounds = tuple(bound for bound in self.bounds if bound >= time)
        return replace(self, samples=samples, bounds=bounds)
