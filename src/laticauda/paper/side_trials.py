"""Side trials: the few runs that the paper's claims need beside the studies.

Lateral undulation over the phase shift with the joint law of the published simulations; how much the speed depends on
the added inertia and on the depth; and, as the paper sets the gain by the fin beside that of a robot of twice the
length, what twice as many links bring in speed, and cost in power.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from jaxtyping import Float

from laticauda.actuation import JointLaw
from laticauda.errors import BadArgument, one_of
from laticauda.gaits import Gait, envelope_of
from laticauda.paper.measured import percent_change
from laticauda.paper.runs import Coefficients, Runs, Study
from laticauda.paper.settings import SweepSettings, efficiency_settings, paper_coefficients
from laticauda.quantities import option, quantity, value
from laticauda.robot import load_robot
from laticauda.scenarios import Model
from laticauda.trial import Trial

ROBOT = "mamba"
SHALLOW = 0.06  # depth of the axis with the back just covered; a is 0.055 m [m]


def _phase_shifts() -> SweepSettings:
    return next(sweep for sweep in efficiency_settings().sweeps if sweep.parameter == "phase_shift")


def _fast() -> tuple[Gait, ...]:
    found = [row.gait for group in efficiency_settings().groups for row in group.cases if not group.has_fin]
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
class SideTrials(Study[SideSettings]):
    """What the side trials found; all without fin. `how` leaves the sweep out."""

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

    usual = SideSettings

    @classmethod
    def by_runs(cls, settings: SideSettings, runs: Runs) -> "SideTrials":
        """What comes out of `settings`, swum by `runs`."""
        by, sweep = runs.model, settings.phase_shifts
        gaits = {gait.kind: gait for gait in settings.gaits}
        runs.n_runs = sweep.values.size + 3 * len(gaits)

        def speed(gait: Gait, how: Model, **others: float) -> float:
            swimmer = settings.coefficients.scenario(ROBOT, gait, model=how, duration=settings.duration)
            changed = replace(swimmer, environment=replace(swimmer.environment, **others))
            return runs.swim(f"{ROBOT}, {gait.kind}, side trial", changed).forward_velocity

        pd = replace(by, joints=JointLaw.of("pd"), dt=None)
        swept = [speed(sweep.gait("lateral_undulation", at), pd) for at in sweep.values]
        usual = {kind: speed(gait, by) for kind, gait in gaits.items()}

        def changed_by(**others: float) -> dict[str, float]:
            return {kind: percent_change(usual[kind], speed(gait, by, **others)) for kind, gait in gaits.items()}

        return SideTrials(
            settings=settings,
            how=runs.how,
            pd_velocity=np.array(swept),
            by_added_inertia=changed_by(added_inertia=0.0),
            by_depth=changed_by(depth=SHALLOW),
        )


run_side_trials = SideTrials.run

KEPT = ("phase shift", "number of waves")
"""What the longer robot has in common with the shorter one, besides amplitude and frequency."""


@value
class LinksSettings:
    """What the links study runs; amplitude and frequency are those that the paper's sweeps hold."""

    robot: str = option("Whose link is repeated (`load_robot`)", default="mamba")
    n_links: tuple[int, int] = quantity("", "Links of the shorter and the longer robot", ge=2, default=(10, 20))
    gaits: tuple[str, ...] = option("Kinds of gait", default=("lateral_undulation", "eel_like"))
    amplitude: float = quantity("rad", "alpha", default=math.radians(30.0))
    frequency: float = quantity("rad/s", "omega", default=math.radians(110.0))
    phase_shift: float = quantity("rad", "delta of the shorter robot", default=math.radians(40.0))
    duration: float = quantity("s", "Of every trial", gt=0.0, default=30.0)
    coefficients: Coefficients = option("The water by gait; by default the paper's", default_factory=paper_coefficients)

    def __post_init__(self) -> None:
        """Check what has a range."""
        if self.n_links[0] >= self.n_links[1]:
            raise BadArgument("n_links", f"must be two rising numbers, got {self.n_links}")

    def gait(self, kind: str, n_links: int, kept: str) -> Gait:
        """The gait of one run.

        Args:
            kind: The gait's kind.
            n_links: Of the robot.
            kept: One of `KEPT`: with the same number of waves on the body, the phase shift of the longer robot is the
                smaller, by the ratio of the numbers of links.
        """
        one_of("kept", kept, KEPT)
        share = self.n_links[0] / n_links if kept == "number of waves" else 1.0
        return Gait(
            envelope=envelope_of(kind),
            amplitude=self.amplitude,
            frequency=self.frequency,
            phase_shift=share * self.phase_shift,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Doubling:
    """A robot and a longer one with the same gait."""

    kept: str
    """One of `KEPT`."""
    shorter: Trial
    """Of the robot with fewer links."""
    longer: Trial
    """Of the one with more."""

    @property
    def velocity_change(self) -> float:
        """Of the longer robot against the shorter one [%]."""
        return percent_change(self.shorter.forward_velocity, self.longer.forward_velocity)

    @property
    def power_factor(self) -> float:
        """Mechanical power of the longer robot over that of the shorter one [-]."""
        return self.longer.mechanical_power / self.shorter.mechanical_power


@dataclass(frozen=True, kw_only=True, eq=False)
class LinksStudy(Study[LinksSettings]):
    """What the links study ran, and what came out."""

    doublings: tuple[Doubling, ...]
    """By gait and, within, by what was kept."""

    usual = LinksSettings

    @classmethod
    def by_runs(cls, settings: LinksSettings, runs: Runs) -> "LinksStudy":
        """What comes out of `settings`, swum by `runs`."""
        wanted = [*product(settings.gaits, KEPT)]
        runs.n_runs = 2 * len(wanted)

        def swum(kind: str, kept: str, n: int) -> Trial:
            gait, name = settings.gait(kind, n, kept), f"{settings.robot} with {n} links"
            robot = load_robot(settings.robot, n_links=n)
            swimmer = settings.coefficients.scenario(robot, gait, model=runs.model, duration=settings.duration)
            return runs.swim(f"{name}, {kind}", replace(swimmer, robot=replace(swimmer.robot, name=name)))

        few, many = settings.n_links
        found = [
            Doubling(kept=kept, shorter=swum(kind, kept, few), longer=swum(kind, kept, many)) for kind, kept in wanted
        ]
        return LinksStudy(settings=settings, how=runs.how, doublings=tuple(found))


run_links = LinksStudy.run
