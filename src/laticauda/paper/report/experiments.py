"""What a reproduction runs: its studies, and the settings of all of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from laticauda.paper import runs, settings, side_trials
from laticauda.paper.efficiency import run_efficiency
from laticauda.paper.path_following import run_path_following
from laticauda.robot import Parameters

RUNS: Mapping[str, Callable[..., Any]] = {
    "path_following": run_path_following,
    "efficiency": run_efficiency,
    "side": side_trials.run_side_trials,
}
"""What runs each study, by its name in `Experiments`; the longest first, which fills workers best."""
HALVES: Mapping[str, tuple[str, ...]] = {
    "efficiency": ("efficiency", "side"),
    "path-following": ("path_following",),
}
"""The studies that belong to each half of the paper."""


@dataclass(frozen=True, kw_only=True)
class Experiments:
    """Settings of every study; by default the paper's where it has any."""

    efficiency: settings.EfficiencySettings = field(default_factory=settings.efficiency_settings)
    """Figs. 4 to 11 and Table 1."""
    side: side_trials.SideSettings = field(default_factory=side_trials.SideSettings)
    """Single facts that claims of the paper rest on."""
    path_following: settings.PathFollowingSettings = field(default_factory=settings.path_following_settings)
    """Figs. 12 to 23 and Table 2."""


def paper_experiments(parameters: Parameters | None = None) -> Experiments:
    """The settings of a whole reproduction.

    Args:
        parameters: Coefficients to use instead of the paper's, and what they change about the robots; the efficiency
            study keeps the paper's, with the robots as they are, beside them. None takes the paper's.
    """
    usual = Experiments()
    if parameters is None:
        return usual
    given = runs.Coefficients.of(parameters)
    others = [one for one in usual.efficiency.models if one.name != given.name]
    return Experiments(
        efficiency=replace(usual.efficiency, models=(given, *others)),
        side=replace(usual.side, coefficients=given),
        path_following=replace(usual.path_following, coefficients=given),
    )
