"""Table 1 of the paper as what it is, the maxima of sweeps, and what the fin changes: measured against simulated."""

from dataclasses import dataclass

import numpy as np

from laticauda.paper.efficiency import Case, EfficiencyStudy, SweepResult
from laticauda.paper.settings import Group

PRINTED_TO = 0.02  # the printed changes come from unrounded speeds [%]


@dataclass(frozen=True, kw_only=True)
class Maximum:
    """The fastest point of one sweep of one group: one of the 12 starred entries of Table 1."""

    group: Group
    """Gait and configuration."""
    parameter: str
    """What was swept."""
    measured_at: float
    """Where the robot was fastest [rad, rad/s]."""
    measured_velocity: float
    """How fast; the best of several noisy values, so biased upward [m/s]."""
    simulated_at: tuple[float, ...]
    """By model, where the simulation is fastest [rad, rad/s]."""
    simulated_velocity: tuple[float, ...]
    """By model, how fast [m/s]."""
    at_the_end: tuple[bool, ...]
    """By model, whether that is the first or the last value of the sweep, so that the maximum may lie beyond."""


@dataclass(frozen=True, kw_only=True)
class FinGain:
    """What the fin changes at one setting of Table 1, in percent of the robot without it."""

    without: Case
    """The row without the fin."""
    with_fin: Case
    """The row with it."""
    simulated_velocity: tuple[float, ...]
    """By model [%]."""
    measured_velocity: float | None
    """Recomputed from the table's speeds; None if one is missing [%]."""
    measured_power: float | None
    """The same for the electrical power [%]."""
    printed_velocity: float | None
    """As printed [%]."""
    printed_power: float | None
    """As printed [%]."""

    @property
    def misprints(self) -> tuple[str, ...]:
        """What is printed and does not follow from the table's own numbers: velocity, power."""
        pairs = {
            "velocity": (self.printed_velocity, self.measured_velocity),
            "power": (self.printed_power, self.measured_power),
        }
        return tuple(name for name, (printed, found) in pairs.items() if is_misprint(printed, found))


def maxima(study: EfficiencyStudy) -> tuple[Maximum, ...]:
    """The starred entries of Table 1 beside the maxima of the simulated sweeps, group by group.

    Args:
        study: What `run_efficiency` returned.
    """
    groups = study.settings.groups
    found = [_maximum(study, sweep, place) for place in range(len(groups)) for sweep in study.sweeps]
    return tuple(entry for entry in found if entry is not None)


def fin_gains(study: EfficiencyStudy) -> tuple[FinGain, ...]:
    """What the fin changes at every setting that Table 1 has with and without it.

    Args:
        study: What `run_efficiency` returned.
    """
    bare = {case.gait: case for case in study.cases if not case.group.has_fin}
    return tuple(_gain(bare[case.gait], case) for case in study.cases if case.group.has_fin and case.gait in bare)


def percent_change(before: float, after: float) -> float:
    """By how much something grew [%].

    Args:
        before: Not zero.
        after: In the same unit.
    """
    return 100.0 * (after / before - 1.0)


def is_misprint(printed: float | None, found: float | None) -> bool:
    """Whether a printed change is another one than the paper's own numbers give.

    Args:
        printed: As printed [%].
        found: As recomputed [%].
    """
    return printed is not None and found is not None and abs(printed - found) > PRINTED_TO


def _maximum(study: EfficiencyStudy, sweep: SweepResult, place: int) -> Maximum | None:
    group = study.settings.groups[place]
    parameter = sweep.settings.parameter
    cases = [case for case in study.measured if case.group == group and case.starred == parameter]
    if not cases or cases[0].measured_velocity is None:
        return None
    best = np.argmax(sweep.forward_velocity[:, place], axis=1)
    last = sweep.values.size - 1
    return Maximum(
        group=group,
        parameter=parameter,
        measured_at=getattr(cases[0].gait, parameter),
        measured_velocity=cases[0].measured_velocity,
        simulated_at=tuple(map(float, sweep.values[best])),
        simulated_velocity=tuple(float(curve[place, i]) for curve, i in zip(sweep.forward_velocity, best, strict=True)),
        at_the_end=tuple(bool(i in (0, last)) for i in best),
    )


def _gain(without: Case, with_fin: Case) -> FinGain:
    simulated = zip(without.forward_velocity, with_fin.forward_velocity, strict=True)
    return FinGain(
        without=without,
        with_fin=with_fin,
        simulated_velocity=tuple(percent_change(before, after) for before, after in simulated),
        measured_velocity=_known_change(without.measured_velocity, with_fin.measured_velocity),
        measured_power=_known_change(without.measured_power, with_fin.measured_power),
        printed_velocity=with_fin.group.printed_velocity_change[with_fin.index],
        printed_power=with_fin.group.printed_power_change[with_fin.index],
    )


def _known_change(before: float | None, after: float | None) -> float | None:
    return None if before is None or after is None else percent_change(before, after)
