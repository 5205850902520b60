"""Side trials: the few runs that the paper's claims need in addition to the studies.

They are lateral undulation over the phase shift with the joint law of the published simulations;
the dependence of the speed on added inertia and depth; and, as the paper compares the gain due to
the fin with that of a robot of twice the length, the gain in speed and the cost in power of twice
as many links.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.paper.measured import percent_change
from laticauda.paper.runs import Coefficients, Runs, Study
from laticauda.paper.settings import SweepSettings, efficiency_settings, paper_coefficients
from laticauda.scenarios import Model
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

ROBOT = "mamba"
SHALLOW = 0.06  # depth of the axis with the back just covered; a is 0.055 m [m]
KEPT = ("phase shift", "number of waves")
"""What the longer robot has in common with the shorter one, besides amplitude and frequency."""


def _phase_shifts() -> SweepSettings:
    return next(sweep for sweep in efficiency_settings().sweeps if sweep.parameter == "phase_shift")


def _fast() -> tuple[lc.Gait, ...]:
    found = [
        row.gait
        for group in efficiency_settings().groups
        for row in group.cases
        if not group.has_fin
    ]
    highest = max(gait.frequency for gait in found)
    return tuple(gait for gait in found if gait.frequency == highest)


def _held() -> tuple[lc.Gait, ...]:
    lateral = lc.lateral_undulation(amplitude_deg=30.0, frequency_deg_s=110.0, phase_shift_deg=40.0)
    return lateral, replace(lateral, envelope=lc.EelLike())


@value_class
class SideSettings:
    """Settings of the side trials."""

    phase_shifts: SweepSettings = option(
        "The sweep over the phase shift", default_factory=_phase_shifts
    )
    gaits: tuple[lc.Gait, ...] = option(
        "Of sensitivities; the fastest of Table 1 if omitted", default_factory=_fast
    )
    n_links: tuple[int, int] = quantity(
        "", "Links of the shorter and the longer robot", ge=2, default=(10, 20)
    )
    doubled: tuple[lc.Gait, ...] = option(
        "Gaits of the shorter robot; the paper's if omitted", default_factory=_held
    )
    duration: float = quantity("s", "Duration of every trial", gt=0.0, default=30.0)
    coefficients: Coefficients = option(
        "Water by gait; the paper's if omitted", default_factory=paper_coefficients
    )

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.n_links[0] >= self.n_links[1]:
            raise BadArgument("n_links", f"must be two increasing numbers, got {self.n_links}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Doubling:
    """A robot and a longer one with the same gait."""

    kept: str
    """What the two have in common, one of `KEPT`."""
    shorter: lc.Trial
    """Trial of the robot with fewer links."""
    longer: lc.Trial
    """Trial of the robot with more links."""

    @property
    def velocity_change(self) -> float:
        """Change of the forward velocity from the shorter to the longer robot [%]."""
        return percent_change(self.shorter.forward_velocity, self.longer.forward_velocity)

    @property
    def power_factor(self) -> float:
        """Mechanical power of the longer robot divided by that of the shorter one [-]."""
        return self.longer.mechanical_power / self.shorter.mechanical_power


@dataclass(frozen=True, kw_only=True, eq=False)
class SideTrials(Study[SideSettings]):
    """Results of the side trials, all without fin; `how` does not describe the sweep."""

    pd_velocity: Float[np.ndarray, " n_values"]
    """Forward velocity of lateral undulation over the phase shifts with pd joints [m/s]."""
    by_added_inertia: Mapping[str, float]
    """By gait, change of the forward velocity when the added inertia C_M is 0 instead of the water's [%]."""
    by_depth: Mapping[str, float]
    """By gait, change of the forward velocity just below the surface, relative to deep water [%]."""
    doublings: tuple[Doubling, ...]
    """Doublings, ordered by gait and then by what was kept."""

    @property
    def pd_optimum(self) -> float:
        """The phase shift at which lateral undulation is fastest with pd joints [rad]."""
        return float(self.settings.phase_shifts.values[np.argmax(self.pd_velocity)])

    usual = SideSettings

    @classmethod
    def by_runs(cls, settings: SideSettings, runs: Runs) -> "SideTrials":
        """Run the trials of `settings` by `runs`, and return the study."""
        by, sweep = runs.model, settings.phase_shifts
        gaits = {gait.kind: gait for gait in settings.gaits}
        runs.n_runs = sweep.values.size + 3 * len(gaits) + 2 * len(KEPT) * len(settings.doubled)

        def swum(
            gait: lc.Gait, how: Model = by, n_links: int | None = None, **others: Any
        ) -> lc.Trial:
            robot = lc.load_robot(ROBOT, n_links=n_links)
            one = settings.coefficients.scenario(robot, gait, model=how, duration=settings.duration)
            one = replace(one, environment=replace(one.environment, **others))
            return runs.swim(f"{ROBOT} with {robot.n_links} links, {gait.kind}, side trial", one)

        def changed_by(**others: Any) -> dict[str, float]:
            speeds = {kind: swum(gait, **others).forward_velocity for kind, gait in gaits.items()}
            return {kind: percent_change(usual[kind], speed) for kind, speed in speeds.items()}

        def doubled(gait: lc.Gait, kept: str) -> Doubling:
            few, many = settings.n_links
            share = few / many if kept == "number of waves" else 1.0
            longer = replace(gait, phase_shift=share * gait.phase_shift)
            return Doubling(
                kept=kept, shorter=swum(gait, n_links=few), longer=swum(longer, n_links=many)
            )

        pd = replace(by, joints=lc.JointLaw.of("pd"), dt=None)
        swept = [
            swum(sweep.gait("lateral_undulation", at), pd).forward_velocity for at in sweep.values
        ]
        usual = {kind: swum(gait).forward_velocity for kind, gait in gaits.items()}
        return SideTrials(
            settings=settings,
            pd_velocity=np.array(swept),
            by_added_inertia=changed_by(added_inertia=0.0),
            by_depth=changed_by(depth=SHALLOW),
            doublings=tuple(doubled(gait, kept) for gait in settings.doubled for kept in KEPT),
            how=runs.how,
        )


run_side_trials = SideTrials.run
