"""Do the closed form and the 3D engine agree? The same runs by both, and how the difference falls with the step."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.errors import instance, one_of
from laticauda.extensions import name_of
from laticauda.paper.runs import Runs, Study
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario, model_of

STEPS: dict[str, tuple[float, ...]] = {
    "prescribed": (0.05, 0.025, 0.0125, 0.00625, 0.003125),
    "pd": (0.004, 0.002, 0.001, 0.0005),
    "servo": (0.004, 0.002, 0.001, 0.0005),
}
"""Of the spatial model, by the joints' drive, each half of the one before [s]."""
ORDERS = {"prescribed": 4, "pd": 2, "servo": 2}
"""Of both models' integrators in the step, by the joints' drive."""


@value
class ParityCase(Scenario):
    """One setting in which both models swim; joints, step and duration are those of the comparison."""

    name: str = option("What tables call it")


@dataclass(frozen=True, kw_only=True)
class Parity:
    """How far apart the models are in one case at one step of the spatial one."""

    case: str
    """Name of the case."""
    joints: str
    """prescribed, pd or servo."""
    dt: float
    """Step of the spatial model [s]."""
    path: float
    """Largest distance between the paths after the best rotation about the start, over the distance traveled [-]."""
    rotation: float
    """That rotation [rad]."""
    heading: float
    """Largest difference in heading [rad]."""
    richardson: float | None
    """As `path`, for the path extrapolated from this step and twice it; None if that was not run before [-]."""


def parity_cases() -> tuple[ParityCase, ...]:
    """Lateral undulation, eel-like motion, a turn, the fin, a current."""
    body, fin = lc.load_robot("mamba"), lc.load_robot("mamba-fin")
    water, eel_water = lc.load_water("paper-lateral"), lc.load_water("paper-eel")
    lateral = lc.lateral_undulation(amplitude_deg=30.0, frequency_deg_s=130.0, phase_shift_deg=40.0)
    eel = lc.eel_like(amplitude_deg=48.0, frequency_deg_s=110.0, phase_shift_deg=40.0)
    usual = ParityCase(name="lateral", robot=body, motion=lateral, environment=water)
    return (
        usual,
        replace(usual, name="eel-like", motion=eel, environment=eel_water),
        replace(usual, name="turning", motion=replace(lateral, offset=math.radians(5))),
        replace(usual, name="fin", robot=fin),
        replace(usual, name="current", environment=replace(water, current=(0.05, -0.08))),
    )


@value
class ParitySettings:
    """What is compared."""

    cases: tuple[ParityCase, ...] = option("Settings in which both models swim", default_factory=parity_cases)
    steps: tuple[float, ...] | None = quantity("s", "Of the spatial model, falling; None: `STEPS`", default=None)
    duration: float = quantity("s", "Of every run", default=30.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class ParityStudy(Study[ParitySettings]):
    """How far apart the closed form and the 3D engine are."""

    rows: tuple[Parity, ...]
    """By case and, within, by step."""

    def worst(self, figure: str) -> dict[float, float]:
        """The largest of a figure over the cases, by step [s].

        Args:
            figure: path or heading.
        """
        steps = dict.fromkeys(row.dt for row in self.rows)
        return {dt: max(getattr(row, figure) for row in self.rows if row.dt == dt) for dt in steps}

    usual = ParitySettings
    by_default = "spatial"

    @classmethod
    def by_runs(cls, settings: ParitySettings, runs: Runs) -> "ParityStudy":
        """What comes out of `settings`, of a spatial model of which only the joints are used."""
        one_of("model", name_of(type(runs.model)), ("spatial",))
        joints = one_of("joints", name_of(type(runs.model.joints)), tuple(STEPS))
        steps = STEPS[joints] if settings.steps is None else settings.steps
        runs.n_runs = len(settings.cases) * len(steps)
        rows: list[Parity] = []
        for row in chain(*(parity(case, joints, steps, duration=settings.duration) for case in settings.cases)):
            rows.append(row)
            runs.tell(len(rows))
        return ParityStudy(settings=settings, how={"joints": joints}, rows=tuple(rows))


run_parity = ParityStudy.run


def parity(
    case: ParityCase,
    joints: str,
    steps: Sequence[float],
    *,
    duration: float = 30.0,
    reference_step: float | None = None,
) -> Iterator[Parity]:
    """Compare the models at several steps of the spatial one, planar root and no gravity.

    Args:
        case: What swims where.
        joints: prescribed, pd or servo.
        steps: Of the spatial model, from large to small [s].
        duration: [s].
        reference_step: Of the planar model [s]; None takes a quarter of the smallest of `steps`.

    Yields:
        One row per step.
    """
    instance("case", case, ParityCase)
    fine = min(steps) / 4.0 if reference_step is None else reference_step
    closed, space = (model_of(name, joints=joints) for name in ("planar", "spatial"))
    planar = lc.swim(replace(case, model=replace(closed, dt=fine), duration=duration))
    traveled = planar.path_speed * duration
    before: lc.Trial | None = None
    for dt in steps:
        spatial = lc.swim(replace(case, model=model_of(space, dt=dt, root="planar", gravity=False), duration=duration))
        path = spatial.center_of_mass[:, :2]
        gap, rotation = _apart(path, planar.center_of_mass)
        richardson = None
        if before is not None and math.isclose(float(before.settings["dt"] or 0.0), 2.0 * dt):
            better = path + (path - before.center_of_mass[:, :2]) / (2.0 ** ORDERS[joints] - 1.0)
            richardson = _apart(better, planar.center_of_mass)[0] / traveled
        yield Parity(
            case=case.name,
            joints=joints,
            dt=dt,
            path=gap / traveled,
            rotation=rotation,
            heading=float(np.max(np.abs(spatial.heading - planar.heading))),
            richardson=richardson,
        )
        before = spatial


def _apart(path: Float[np.ndarray, "n 2"], other: Float[np.ndarray, "n 2"]) -> tuple[float, float]:
    """Largest distance between two paths after the best rotation of the first about their start, and that rotation."""
    a, b = path - path[0], other - other[0]
    rotation = math.atan2(float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])), float(np.sum(a * b)))
    c, s = math.cos(rotation), math.sin(rotation)
    turned = a @ np.array([[c, s], [-s, c]])
    return float(np.max(np.linalg.norm(turned - b, axis=1))), rotation
