"""The numbers of the side trials that claims refer to: sensitivities, and twice the links."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from laticauda.motion import gaits
from laticauda.paper.claims.printed_numbers import Numbers
from laticauda.paper.side_trials import (
    ROBOT,
    SAME_PHASE_SHIFT,
    SAME_WAVES,
    SHALLOW,
    SideTrials,
)


class DoublingRow(NamedTuple):
    """What twice as many links change with one gait."""

    gait: str
    """The gait, in words."""
    velocity_change: float
    """Change of the forward velocity [%]."""
    power_factor: float
    """Factor of the mechanical power [-]."""


def collect_side_numbers(study: SideTrials) -> Numbers:
    """Return the findings of the side trials: changes [%], and factors for twice the links [-].

    Args:
        study: Result of `run_side_trials`.
    """
    first_gait = study.settings.doubled[0]
    same_phase_shift = _list_doublings(study, SAME_PHASE_SHIFT)
    return {
        "joints": study.trial_settings["joints"],
        "settings": study.settings,
        "shallow": SHALLOW,
        "by_depth": _name_gaits_in_words(study.by_depth),
        "by_added_inertia": _name_gaits_in_words(study.by_added_inertia),
        "inertia_changes": [*study.by_added_inertia.values()],
        "optimum": math.degrees(study.pd_optimum),
        "robot": ROBOT,
        "amplitude": math.degrees(first_gait.amplitude),
        "frequency": math.degrees(first_gait.frequency),
        "phase_shift": math.degrees(first_gait.phase_shift),
        "same_phase_shift": same_phase_shift,
        "same_waves": _list_doublings(study, SAME_WAVES),
        "velocity_change": [row.velocity_change for row in same_phase_shift],
        "power_factor": [row.power_factor for row in same_phase_shift],
    }


def _name_gaits_in_words(changes: Mapping[str, float]) -> dict[str, float]:
    return {gaits.GAIT_WORDS[kind]: change for kind, change in changes.items()}


def _list_doublings(study: SideTrials, in_common: str) -> list[DoublingRow]:
    rows: list[DoublingRow] = []
    for doubling in study.doublings:
        if doubling.in_common != in_common:
            continue
        gait = doubling.shorter.gait
        assert gait is not None
        rows.append(DoublingRow(gait.words, doubling.velocity_change, doubling.power_factor))
    return rows
