"""What the caudal fin changes: pairs of cases of a table, without and with the fin."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from laticauda.motion import gaits
from laticauda.paper.efficiency import Case, EfficiencyStudy
from laticauda.paper.measured import PrintedChange, find_printed_changes, percent_change
from laticauda.paper.path_following import FollowingCase

AnyCase = TypeVar("AnyCase", Case, FollowingCase)


@dataclass(frozen=True, kw_only=True)
class FinGain(Generic[AnyCase]):
    """Changes due to the fin between two cases of a table.

    In Table 2 the two cases start from different places, so the change includes that effect.
    """

    without: AnyCase
    """The case without the fin."""
    with_fin: AnyCase
    """The case with the fin."""

    @property
    def measured(self) -> PrintedChange:
        """Measured changes: as printed, and from the table's own numbers."""
        return PrintedChange(without=self.without.measured, with_fin=self.with_fin.measured)

    def simulated_change(self, figure: Callable[[AnyCase], float]) -> float:
        """Return the change of a simulated figure [%].

        Args:
            figure: Function that returns the figure of a case.
        """
        return percent_change(figure(self.without), figure(self.with_fin))


def find_fin_gains(cases: Sequence[AnyCase]) -> tuple[FinGain[AnyCase], ...]:
    """Return the changes due to the fin, for every case that has a counterpart without it.

    Args:
        cases: Cases of a study.
    """
    case_of_row = {id(case.measured): case for case in cases}
    changes = find_printed_changes([case.measured for case in cases])
    return tuple(
        FinGain(without=case_of_row[id(change.without)], with_fin=case_of_row[id(change.with_fin)])
        for change in changes
    )


# ---- in Table 1 ----------------------------------------------------------------------------------


class VelocityGains(NamedTuple):
    """How much faster the fin makes the robot with one gait, at every setting that was measured."""

    measured: list[float]
    """As measured [%]."""
    by_model: dict[str, list[float]]
    """As simulated, by model [%]."""


def find_velocity_gains(study: EfficiencyStudy) -> dict[str, VelocityGains]:
    """Return by kind of gait how much faster the fin makes the robot where measured.

    Args:
        study: Result of `run_efficiency`.
    """
    gains_by_gait: dict[str, VelocityGains] = {}
    for kind in gaits.GAIT_WORDS:
        measured: list[float] = []
        gains_of_kind: list[FinGain[Case]] = []
        for gain in find_fin_gains(study.cases):
            velocity = gain.measured.velocity
            if velocity is not None and gain.with_fin.group.gait == kind:
                measured.append(velocity)
                gains_of_kind.append(gain)
        by_model = {
            name: simulate_velocity_gains(gains_of_kind, index)
            for index, name in enumerate(study.models)
        }
        gains_by_gait[kind] = VelocityGains(measured=measured, by_model=by_model)
    return gains_by_gait


def simulate_velocity_gains(gains: Sequence[FinGain[Case]], model: int) -> list[float]:
    """Return how much faster the fin makes the simulated robot, setting by setting [%].

    Args:
        gains: Pairs of cases of Table 1.
        model: Index of the model.
    """
    return [gain.simulated_change(lambda case: case.forward_velocity[model]) for gain in gains]


# ---- in Table 2 ----------------------------------------------------------------------------------


def simulate_band_gains(gain: FinGain[FollowingCase]) -> list[float]:
    """Return how much faster the fin makes the robot, for every combination in the band [%].

    Args:
        gain: Change from a case of Table 2 to the case with the fin.
    """
    changes: list[float] = []
    for run_without, run_with in zip(gain.without.band, gain.with_fin.band, strict=True):
        change = percent_change(run_without.forward_velocity, run_with.forward_velocity)
        changes.append(change)
    return changes
