"""A twin that learns while the robot swims: the water's coefficients, its current, and what has changed.

Every half cycle a twin in still water, whose joints do what the robot's report, swims the last
minute anew; beside it one for each unknown coefficient, which is a little larger there. How far the
robot's way is off the twin's is nearly linear in what is unknown: least squares do the rest. See
docs/theory/learning-twin.md.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np

from laticauda.control.estimation.digital_twin import STILL, check_plant
from laticauda.control.estimation.samples import (
    JointSample,
    Mount,
    PoseSample,
    ReferenceSample,
    Sample,
)
from laticauda.control.estimation.stretches import MARGIN, TICK, Array, Stretches
from laticauda.models.dynamics import Plant
from laticauda.motion.joints import Prescribed
from laticauda.robot import Robot, Water
from laticauda.scenarios import Command, Start
from laticauda.values import BadArgument, option, quantity, value_class

Row: TypeAlias = tuple[float, ...]
Coefficient: TypeAlias = Literal[
    "normal_drag", "tangential_friction", "added_mass", "added_inertia", "tangential_added_mass"
]

LARGER = 0.02  # by which an unknown is larger in its own twin, in its scale
GAP = 0.2  # between samples at most [s]
UNTOLD, LEAST = (
    2,
    6,
)  # stretches that a twin needs to swim as the robot does; beyond them, to say anything
MEDIAN, FINEST = (
    0.455,
    0.1**2,
)  # of the square of a normal number; variance that deviations have at least
# Standard deviations to either side that hold 95 %; by Student's t 1 + 1.21 / n + 1.44 / n^2 times
# as many (Cornish and Fisher's expansion).
WITHIN, STUDENT = 1.96, (1.21, 1.44)
PLAY, CRAB = (
    0.01,
    0.005,
)  # of joints, and by which the robot points elsewhere than is seen, in the beginning [rad]
FLOOR, FLOOR_PLAY = 0.02, 0.05  # of deviations: what repeats in every cycle [-]
FLOOR_AHEAD, FLOOR_ASIDE = (
    1.2e-3,
    0.4e-3,
)  # likewise, of a current along the robot and across it [m/s]
FINLESS, ODD, WEAK = (
    0.5,
    2,
    3,
)  # share of the squares that a robot without fin leaves; stretches until it is said
STILL_SWING = 0.02  # of a joint that is not asked to move [rad]
UNITS = {"play": "rad", "crab": "rad", "current_x": "m/s", "current_y": "m/s"}
REST = Command(gait=STILL)


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
    """The coefficients [-], the joints' `play` and the `crab` angle [rad], `current_x` and `current_y` [m/s]."""
    deviation: Mapping[str, float]
    """Their standard deviations: 95 % of all intervals of 1.96 to either side are to hold the truth."""
    changes: tuple[str, ...] = ()
    """What has just been found to have happened, in sentences."""

    @property
    def line(self) -> str:
        """Every value with its interval of 95 %, for people."""
        return ", ".join(
            f"{name.replace('_', ' ')} {mean:.4f} ± {WITHIN * self.deviation[name]:.4f} {UNITS.get(name, '')}".rstrip()
            for name, mean in self.value.items()
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnerState:
    """What a learner remembers."""

    plant: Plant[Any]
    """The robot and its water as they are thought to be, in still water; what is learnt counts from there."""
    mean: Array
    """Logarithms of the coefficients; play in `PLAY`, crab angle [rad] and current [m/s]."""
    deviation: Array
    """Of `mean`."""
    samples: Mapping[type[Any], tuple[Row, ...]]
    """What the last minute's samples said, by their class."""
    bounds: tuple[float, ...] = ()
    """Where stretches begin and the last one ends [s]."""
    swings: tuple[Array, ...] = ()
    """Of every joint in each cycle so far, as shares of what it was asked for [-]."""
    n_weak: int = 0
    """Cycles in a row in which a joint was weak [-]."""
    n_odd: int = 0
    """Cycles in a row that do not fit to those before [-]."""
    named: frozenset[tuple[int, str]] = frozenset()
    """Which joints were named, and as what."""
    changes: tuple[str, ...] = ()
    """What has happened in this stretch."""
    learned: Learned | None = None
    """What is known, if the last sample ended a stretch that said so."""


@value_class
class Learner:
    """From samples, one by one, to what they say of robot and water; samples come in the order of their times.

    Raises:
        ValueError: If the plant cannot be the robot's twin, or is on the ground.
    """

    settings: Learning = option("what is learned", default=Learning())
    robot: Robot = option("the robot as built, with the joints of the samples")
    plant: Plant[Any] = option("the assumed robot, in water whose unknown coefficients are a guess")
    mount: Mount = option("where the marker body sits", default_factory=Mount)

    def __post_init__(self) -> None:
        """Refuse what nothing can be learnt from."""
        check_plant(self.plant, self.robot)
        water = self.plant.environment
        if not isinstance(water, Water):
            raise BadArgument(
                "plant",
                f"must be in water for anything to be learned, got the ground `{water.name}`",
            )
        self.mount.on_link(self.robot)

    @cached_property
    def _opening(self) -> Array:
        """How far off everything unknown may be in the beginning, in its scale."""
        told, n = self.settings, len(self.settings.unknown)
        return np.array([told.coefficient] * n + [1.0, CRAB, told.current, told.current])

    def _floor(self, seen: Stretches) -> Array:
        """What is left of deviations however much is seen, likewise."""
        ahead = np.exp(1j * seen.seen[2]).mean()
        x, y = abs(ahead.real / ahead), abs(ahead.imag / ahead)
        current = [
            math.hypot(FLOOR_AHEAD * x, FLOOR_ASIDE * y),
            math.hypot(FLOOR_AHEAD * y, FLOOR_ASIDE * x),
        ]
        return np.array([FLOOR] * len(self.settings.unknown) + [FLOOR_PLAY, CRAB, *current])

    def init(self) -> LearnerState:
        """The state before the first sample. The plant is compiled, which may take seconds."""
        water: Any = self.plant.environment
        model = replace(self.plant.settings, joints=Prescribed(), dt=None)
        plant: Plant[Any] = replace(self.plant, environment=water.still, settings=model)
        none: dict[type[Any], tuple[Row, ...]] = {
            kind: () for kind in (PoseSample, JointSample, ReferenceSample)
        }
        plant.march(plant.init(Start(), REST), REST, TICK, TICK)
        return LearnerState(
            plant=plant, mean=0.0 * self._opening, deviation=self._opening, samples=none
        )

    def step(self, state: LearnerState, sample: Sample) -> LearnerState:
        """The state after one more sample; its `learned` is what is known anew, at the end of a stretch, or None.

        Args:
            state: As the last call returned it, or `init`.
            sample: What came in.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        state, row = replace(state, learned=None), self._row(sample)
        if row is not None:
            kept = state.samples[type(sample)]
            state = replace(
                state, samples={**state.samples, type(sample): (*kept, (sample.time, *row))}
            )
        if not isinstance(sample, ReferenceSample):
            return state if state.bounds else _since(state, sample.time)
        if sample.frequency == 0.0:
            return _since(state, math.inf)
        if not state.bounds:
            return replace(state, bounds=(sample.time + MARGIN,))
        end = state.bounds[-1] + math.pi / sample.frequency
        return (
            state
            if sample.time <= end + MARGIN
            else self._learnt(replace(state, bounds=(*state.bounds, end)))
        )

    def _row(self, sample: Sample) -> Row | None:
        """What counts of a sample; None: nothing."""
        if isinstance(sample, PoseSample):
            if sample.is_lost or sample.rotation is None:
                return None
            return (*sample.position[:2].tolist(), self.mount.link_yaw(sample.rotation))
        angle = self.robot.yaw_joints("angle", sample.angle)
        if isinstance(sample, ReferenceSample):
            return tuple(angle.tolist())
        torque = (
            angle * 0.0 if sample.torque is None else self.robot.yaw_joints("torque", sample.torque)
        )
        return (
            (*angle.tolist(), *np.nan_to_num(torque).tolist()) if np.isfinite(angle).all() else None
        )

    def _learnt(self, state: LearnerState) -> LearnerState:
        """What the stretches say, after one more; nothing as long as they are few, or if samples are missing."""
        state = _since(state, state.bounds[-1] - self.settings.window)
        poses, joints, sent = (np.array(one).T for one in state.samples.values())
        if not all(
            _covers(one, state.bounds[-2] - MARGIN, state.bounds[-1] + MARGIN)
            for one in (poses, joints)
        ):
            return _since(state, math.inf)
        state = self._with_swings(replace(state, changes=()), joints, sent)
        if len(state.bounds) > UNTOLD + LEAST:
            bounds = np.array(state.bounds)
            seen = Stretches(
                robot=self.robot, mount=self.mount, bounds=bounds, poses=poses, joints=joints
            )
            state = self._fitted(state, seen)
        elif not state.changes:
            return state
        return replace(state, learned=self._known(state))

    def _known(self, state: LearnerState) -> Learned:
        """The same with names and units."""
        names = self.settings.unknown
        water = [getattr(self._water(state, state.mean), name) for name in names]
        scale = np.array([*water, PLAY, 1.0, 1.0, 1.0])
        found = [*water, *(scale * state.mean)[len(names) :].tolist()]
        named = [
            dict(zip((*names, *UNITS), one, strict=True))
            for one in (found, (scale * state.deviation).tolist())
        ]
        return Learned(
            time=state.bounds[-1], value=named[0], deviation=named[1], changes=state.changes
        )

    # ---- what fits -------------------------------------------------------------------------------

    def _fitted(self, state: LearnerState, seen: Stretches) -> LearnerState:
        """Two steps of Gauss and Newton, with the first guess as a prior; or what the last cycle says has changed."""
        off, design = self._compared(state, seen)
        finless = self._without_fin(state, seen, off)
        state = replace(state, n_odd=state.n_odd + 1 if self._is_odd(off, design) else 0)
        if finless is not None:
            return self._reopened(replace(state, plant=finless), "The fin is gone.")
        if state.n_odd == ODD:
            return self._reopened(state, "The water is not what it was.")
        state = replace(state, mean=state.mean + self._step(state, off, design)[0])
        off, design = self._compared(state, seen)
        step, told, size = self._step(state, off, design)
        cycles = _cycles(_pull(off - design @ step, design) / size)
        free = len(cycles) - 1
        wider = (1.0 + 1.0 / free) * (1.0 + STUDENT[0] / free + STUDENT[1] / free**2) ** 2
        spread = wider * cycles.T @ cycles + np.diag(self._opening**-2.0)
        back = np.linalg.inv(told)
        deviation = np.sqrt(np.diag(back @ spread @ back) + self._floor(seen) ** 2)
        return replace(state, mean=state.mean + step, deviation=deviation)

    def _step(self, state: LearnerState, off: Array, design: Array) -> tuple[Any, Array, float]:
        """A step of the mean, the matrix of the normal equations, and the size of the noise, squared."""
        size, prior = _size(off), self._opening**-2.0
        told: Array = np.einsum("kij,kil->jl", design, design) / size + np.diag(prior)
        pull: Array = _pull(off, design).sum(axis=0) / size - prior * state.mean
        return np.linalg.solve(told, pull), told, size

    def _compared(self, state: LearnerState, seen: Stretches) -> tuple[Array, Array]:
        """How far the robot is off the twin in every stretch, and how much nearer each unknown brings them."""
        off, way = self._off(state, state.mean, seen)
        larger = [state.mean + LARGER * one for one in np.eye(state.mean.size)[:-3]]
        nearer = [(off - self._off(state, mean, seen)[0]) / LARGER for mean in larger]
        rows = seen.compared([off, *nearer], way)[UNTOLD:]
        return rows[..., 0], rows[..., 1:]

    def _off(self, state: LearnerState, mean: Array, seen: Stretches) -> tuple[Array, Array]:
        """See `Stretches.off`, if the unknown is so."""
        plant = replace(state.plant, environment=self._water(state, mean))
        return seen.off(plant, PLAY * float(mean[-4]), mean[-2:])

    def _water(self, state: LearnerState, mean: Array) -> Water:
        """The water, if the unknown is so."""
        shares = zip(self.settings.unknown, np.exp(mean).tolist(), strict=False)
        water: Any = state.plant.environment
        return replace(water, **{name: getattr(water, name) * share for name, share in shares})

    # ---- what has changed ------------------------------------------------------------------------

    def _without_fin(self, state: LearnerState, seen: Stretches, off: Array) -> Plant[Any] | None:
        """The plant without its fin, if the last cycle is rather that one's."""
        if state.plant.robot.caudal_fin is None:
            return None
        plant = replace(state.plant, robot=replace(state.plant.robot, caudal_fin=None))
        without, way = self._off(replace(state, plant=plant), state.mean, seen)
        rows = seen.compared([without], way)[-2:, :, 0]
        return plant if np.sum(rows**2) < FINLESS * np.sum(off[-2:] ** 2) else None

    def _is_odd(self, off: Array, design: Array) -> bool:
        """Whether the last cycle pulls elsewhere than those before it and the noise would."""
        cycles = _cycles(_pull(off, design))
        before, last = cycles[:-1], cycles[-1:]
        if len(before) < LEAST:
            return False
        size, told = _size(off), np.einsum("kij,kil->jl", design, design) / len(off)
        noise = 2.0 * size * told + size**2 * np.diag(self._opening**-2.0)
        usual: Array = (np.einsum("ki,kj->ij", before, before) + LEAST * noise) / (
            len(before) + LEAST
        )
        return (last @ np.linalg.solve(usual, last.T)).item() > self.settings.doubt**2

    def _reopened(self, state: LearnerState, change: str) -> LearnerState:
        """Nothing from before the last cycle is known any more, but what was learnt is the guess."""
        plant, n = (
            replace(state.plant, environment=self._water(state, state.mean)),
            len(self.settings.unknown),
        )
        mean = np.append(np.zeros(n), state.mean[n:])
        changes = (*state.changes, change)
        state = replace(
            state, plant=plant, mean=mean, deviation=self._opening, n_odd=0, changes=changes
        )
        return _since(state, state.bounds[-3])

    def _with_swings(self, state: LearnerState, joints: Array, sent: Array) -> LearnerState:
        """Joints that swing less over the last cycle than they did, as shares of what they are asked for, are named."""
        bounds = state.bounds[-3:]
        if len(bounds) < 3:
            return state
        swing, asked = (
            one[1 : len(sent), (one[0] > bounds[0]) & (one[0] <= bounds[-1])].std(axis=1)
            for one in (joints, sent)
        )
        if asked.min() < STILL_SWING:
            return state
        swings = (*state.swings, swing / asked)
        share = swings[-1] / np.median(swings[:-2] or swings, axis=0)
        worst = int(share.argmin())
        n_weak = state.n_weak + 1 if share[worst] < self.settings.weak else 0
        state = replace(state, swings=swings, n_weak=n_weak)
        word = (
            "is stuck"
            if share[worst] < self.settings.stuck
            else "is weak"
            if n_weak == WEAK
            else ""
        )
        if not word or (worst, word) in state.named or (word == "is weak" and state.named):
            return state
        change = f"Joint {worst + 1} {word}: it swings {100.0 * share[worst]:.0f} % of what it did."
        return replace(state, named=state.named | {(worst, word)}, changes=(change,))


def _since(state: LearnerState, begin: float) -> LearnerState:
    """The state with nothing but what is from `begin` [s] on."""
    oldest = begin - 2.0 * MARGIN
    kept = {
        kind: tuple(row for row in rows if row[0] >= oldest) for kind, rows in state.samples.items()
    }
    return replace(state, samples=kept, bounds=tuple(one for one in state.bounds if one >= begin))


def _covers(samples: Array, begin: float, end: float) -> bool:
    """Whether samples reach from one time to another, without a gap that would matter."""
    time = np.clip(samples[:1].ravel(), begin, end)
    return bool(np.diff(time, prepend=begin, append=end).max() < GAP)


def _size(off: Array) -> float:
    """Variance of the noise; single large deviations do not count, and no sensor is exact."""
    return max(float(np.median(off * off)) / MEDIAN, FINEST)


def _pull(off: Array, design: Array) -> Array:
    """What every stretch wants the unknown to be changed by, times how much it knows."""
    return np.einsum("kij,ki->kj", design, off)


def _cycles(pull: Array) -> Array:
    """Sums over pairs of stretches, the last one with the one before it."""
    return pull[len(pull) % 2 :].reshape(-1, 2, pull.shape[1]).sum(axis=1)
