"""Side trials: the few runs that the paper's claims need beside the studies.

Lateral undulation over the phase shift with the joint law of the published simulations, and how much the speed depends
on the added inertia and on the depth.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from laticauda.gaits import Gait
from laticauda.packaging import __version__
from laticauda.paper.settings import Coefficients, SweepSettings, efficiency_settings, paper_coefficients
from laticauda.robot import load_robot
from laticauda.simulate import swim
from laticauda.studies.progress import Progress

ROBOT = "mamba"
SHALLOW = 0.06  # depth of the axis with the back just covered; a is 0.055 m [m]


def _phase_shifts() -> SweepSettings:
    return next(sweep for sweep in efficiency_settings().sweeps if sweep.parameter == "phase_shift")


def _fast() -> tuple[Gait, ...]:
    found = [gait for group in efficiency_settings().groups for gait in group.cases if not group.has_fin]
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
class SideTrials:
    """What the side trials found; all without fin."""

    settings: SideSettings
    """What was run."""
    joints: str
    """How the joints followed the gait, apart from the sweep."""
    version: str
    """Version of laticauda that ran it."""
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
    *,
    model: str = "planar",
    joints: str = "prescribed",
    progress: Progress | None = None,
) -> SideTrials:
    """Run the side trials.

    Args:
        settings: None takes those of the paper.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`; the sweep over the phase shift has pd joints all the same.
        progress: Called after every trial with the number of trials done, and of all.

    Returns:
        Speeds and their changes.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a trial blows up.
    """
    settings = settings or SideSettings()
    sweep = settings.phase_shifts
    gaits = {gait.kind: gait for gait in settings.gaits}
    n_done, n_trials = 0, sweep.values.size + 3 * len(gaits)

    def speed(gait: Gait, law: str, **changes: float) -> float:
        nonlocal n_done
        water = replace(settings.coefficients.water(gait.kind), **changes)
        robot = settings.coefficients.robot(load_robot(ROBOT), gait.kind)
        done = swim(robot, gait, settings.duration, environment=water, model=model, joints=law, throw=True)
        n_done += 1
        if progress is not None:
            progress(n_done, n_trials)
        return done.forward_velocity

    pd = [speed(sweep.gait("lateral_undulation", value), "pd") for value in sweep.values]
    usual = {kind: speed(gait, joints) for kind, gait in gaits.items()}
    return SideTrials(
        settings=settings,
        joints=joints,
        version=__version__,
        pd_velocity=np.array(pd),
        by_added_inertia={
            kind: 100.0 * (speed(gait, joints, added_inertia=0.0) / usual[kind] - 1.0) for kind, gait in gaits.items()
        },
        by_depth={
            kind: 100.0 * (speed(gait, joints, depth=SHALLOW) / usual[kind] - 1.0) for kind, gait in gaits.items()
        },
    )
