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
from laticauda.paper.settings import (
    SweepSettings,
    load_efficiency_settings,
    load_paper_coefficients,
)
from laticauda.scenarios import Model, Scenario
from laticauda.values import BadArgument, option, quantity, value_class

ROBOT = "mamba"
"""Robot of all side trials: without fin."""
SHALLOW = 0.06
"""Depth of the axis with the back just covered: half the height of the body is 0.055 m [m]."""
SAME_PHASE_SHIFT = "phase shift"
SAME_WAVES = "number of waves"
KEPT = (SAME_PHASE_SHIFT, SAME_WAVES)
"""What a longer robot may have in common with a shorter one, besides amplitude and frequency."""


def _paper_phase_shifts() -> SweepSettings:
    sweeps = load_efficiency_settings().sweeps
    return next(sweep for sweep in sweeps if sweep.parameter == "phase_shift")


def _fastest_gaits() -> tuple[lc.Gait, ...]:
    """Return the gaits of the highest frequency in Table 1 without fin."""
    gaits: list[lc.Gait] = []
    for group in load_efficiency_settings().groups:
        if not group.has_fin:
            gaits += [row.gait for row in group.cases]
    highest_frequency = max(gait.frequency for gait in gaits)
    return tuple(gait for gait in gaits if gait.frequency == highest_frequency)


def _central_gaits() -> tuple[lc.Gait, ...]:
    """Return the gait that all sweeps of the paper go through, of both kinds."""
    lateral = lc.lateral_undulation(amplitude_deg=30.0, frequency_deg_s=110.0, phase_shift_deg=40.0)
    return lateral, replace(lateral, envelope=lc.EelLike())


@value_class
class SideSettings:
    """Settings of the side trials."""

    phase_shifts: SweepSettings = option(
        "The sweep over the phase shift", default_factory=_paper_phase_shifts
    )
    gaits: tuple[lc.Gait, ...] = option(
        "Of sensitivities; the fastest of Table 1 if omitted", default_factory=_fastest_gaits
    )
    n_links: tuple[int, int] = quantity(
        "", "Links of the shorter and the longer robot", ge=2, default=(10, 20)
    )
    doubled: tuple[lc.Gait, ...] = option(
        "Gaits of the shorter robot; the paper's if omitted", default_factory=_central_gaits
    )
    duration: float = quantity("s", "Duration of every trial", gt=0.0, default=30.0)
    coefficients: Coefficients = option(
        "Water by gait; the paper's if omitted", default_factory=load_paper_coefficients
    )

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.n_links[0] >= self.n_links[1]:
            raise BadArgument("n_links", f"must be two increasing numbers, got {self.n_links}")


@dataclass(frozen=True, kw_only=True, eq=False)
class Doubling:
    """A robot and a longer one with the same gait."""

    in_common: str
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
    """Results of the side trials, all without fin; `trial_settings` does not describe the sweep."""

    pd_velocity: Float[np.ndarray, " n_values"]
    """Forward velocity of lateral undulation over the phase shifts with pd joints [m/s]."""
    by_added_inertia: Mapping[str, float]
    """By gait, change of the forward velocity when the added inertia C_M is 0 [%]."""
    by_depth: Mapping[str, float]
    """By gait, change of the forward velocity just below the surface [%]."""
    doublings: tuple[Doubling, ...]
    """Doublings, ordered by gait and then by what they have in common."""

    @property
    def pd_optimum(self) -> float:
        """The phase shift at which lateral undulation is fastest with pd joints [rad]."""
        return float(self.settings.phase_shifts.values[np.argmax(self.pd_velocity)])

    default_settings = SideSettings

    @classmethod
    def from_runs(cls, settings: SideSettings, runs: Runs) -> "SideTrials":
        """Run the trials of `settings` by `runs`, and return the study."""
        side_runs = _SideRuns(settings=settings, runs=runs)
        n_doublings = len(KEPT) * len(settings.doubled)
        n_sensitivities = 3 * len(side_runs.gait_of_kind)
        runs.n_runs = settings.phase_shifts.values.size + n_sensitivities + 2 * n_doublings

        # The sweep comes first, so that `runs.trial_settings` are not those of its pd joints.
        pd_velocity = side_runs.sweep_with_pd_joints()
        usual_velocity = side_runs.measure_velocities()
        without_added_inertia = side_runs.measure_velocities(added_inertia=0.0)
        shallow = side_runs.measure_velocities(depth=SHALLOW)
        doublings: list[Doubling] = []
        for gait in settings.doubled:
            for in_common in KEPT:
                doublings.append(side_runs.double_links(gait, in_common))
        return SideTrials(
            settings=settings,
            pd_velocity=pd_velocity,
            by_added_inertia=_percent_changes(usual_velocity, without_added_inertia),
            by_depth=_percent_changes(usual_velocity, shallow),
            doublings=tuple(doublings),
            trial_settings=runs.trial_settings,
        )


run_side_trials = SideTrials.run


@dataclass(frozen=True, kw_only=True)
class _SideRuns:
    """Runs all side trials."""

    settings: SideSettings
    """Settings of the side trials."""
    runs: Runs
    """Runner, with the model."""

    @property
    def gait_of_kind(self) -> dict[str, lc.Gait]:
        """Gaits of the sensitivities, by kind."""
        return {gait.kind: gait for gait in self.settings.gaits}

    def sweep_with_pd_joints(self) -> Float[np.ndarray, " n_values"]:
        """Return the forward velocity over the phase shifts with pd joints [m/s]."""
        model = replace(self.runs.model, joints=lc.JointLaw.of("pd"), dt=None)
        sweep = self.settings.phase_shifts
        velocities: list[float] = []
        for value in sweep.values:
            scenario = self._scenario(sweep.gait("lateral_undulation", value), model=model)
            velocities.append(self._swim(scenario).forward_velocity)
        return np.array(velocities)

    def measure_velocities(self, **water_changes: Any) -> dict[str, float]:
        """Return the forward velocity of every gait of the sensitivities in changed water [m/s]."""
        velocities: dict[str, float] = {}
        for kind, gait in self.gait_of_kind.items():
            scenario = self._scenario(gait)
            water = replace(scenario.environment, **water_changes)
            velocities[kind] = self._swim(replace(scenario, environment=water)).forward_velocity
        return velocities

    def double_links(self, gait: lc.Gait, in_common: str) -> Doubling:
        """Swim with fewer and with more links."""
        n_few, n_many = self.settings.n_links
        phase_shift = gait.phase_shift
        if in_common == SAME_WAVES:
            phase_shift *= n_few / n_many
        longer_gait = replace(gait, phase_shift=phase_shift)
        return Doubling(
            in_common=in_common,
            shorter=self._swim(self._scenario(gait, n_links=n_few)),
            longer=self._swim(self._scenario(longer_gait, n_links=n_many)),
        )

    def _scenario(
        self, gait: lc.Gait, *, model: Model | None = None, n_links: int | None = None
    ) -> Scenario:
        return self.settings.coefficients.build_scenario(
            lc.load_robot(ROBOT, n_links=n_links),
            gait,
            model=model if model is not None else self.runs.model,
            duration=self.settings.duration,
        )

    def _swim(self, scenario: Scenario) -> lc.Trial:
        n_links = scenario.robot.n_links
        kind = scenario.gait.kind
        return self.runs.swim(f"{ROBOT} with {n_links} links, {kind}, side trial", scenario)


def _percent_changes(before: Mapping[str, float], after: Mapping[str, float]) -> dict[str, float]:
    return {kind: percent_change(before[kind], after[kind]) for kind in before}
