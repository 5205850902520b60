"""Twin that learns while the robot swims: the water's coefficients, its current, what has changed.

Every half cycle, a twin in still water whose joints do what the robot's report swims the last
minute anew; so does one more for each unknown coefficient, which is a little larger there. The
robot's deviation from the twin is nearly linear in what is unknown: least squares do the rest. See
docs/theory/learning-twin.md.

The unknowns are kept in one vector: the logarithm of every unknown coefficient, the play of the
joints, the crab angle, and the current along x and y.
"""

import math
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.estimation.digital_twin import STILL, check_plant
from laticauda.control.estimation.learning_state import (
    UNITS,
    Learned,
    LearnerState,
    Learning,
    NamedFault,
    SampleRow,
)
from laticauda.control.estimation.samples import (
    JointSample,
    Mount,
    PoseSample,
    ReferenceSample,
    Sample,
)
from laticauda.control.estimation.stretches import (
    MARGIN,
    TICK,
    Array,
    Stretches,
    TwinComparison,
)
from laticauda.models.dynamics import Plant
from laticauda.motion.joints import Prescribed
from laticauda.robot import Robot, Water
from laticauda.scenarios import Command, Start
from laticauda.values import BadArgument, option, value_class

# Unknowns, and what they may be before anything is known.
PLAY = -4
"""Index of the joints' play among the unknowns."""
CURRENT = slice(-2, None)
"""Indices of the current among the unknowns."""
N_WITHOUT_TWIN = 3
"""Last unknowns, crab angle and current, whose effect is known without a twin of their own."""
PLAY_SCALE = 0.01
"""Scale of the play, and its standard deviation in the beginning [rad]."""
CRAB = 0.005
"""Standard deviation of the angle between the robot and its markers, in the beginning [rad]."""
LARGER = 0.02
"""By which an unknown is larger in its own twin, in its scale [-]."""

# What is left of deviations however much is seen: what repeats in every cycle.
FLOOR = 0.02
"""Of a coefficient, relative [-]."""
FLOOR_PLAY = 0.05
"""Of the play, in its scale [-]."""
FLOOR_AHEAD = 1.2e-3
"""Of the current along the robot [m/s]."""
FLOOR_ASIDE = 0.4e-3
"""Of the current across the robot [m/s]."""

# When samples say something.
GAP = 0.2
"""Longest time between samples [s]."""
SETTLING_STRETCHES = 2
"""Stretches that a twin needs to swim as the robot does; they are not compared [-]."""
LEAST_STRETCHES = 6
"""Stretches beyond these that are needed to say anything, and cycles that make a usual one [-]."""
STILL_SWING = 0.02
"""Swing of a reference below which a joint is not asked to move [rad]."""

# Statistics.
MEDIAN_OF_SQUARE = 0.455
"""Median of the square of a normal number of variance 1 [-]."""
SMALLEST_VARIANCE = 0.1**2
"""Variance that deviations have at least: no sensor is exact [-]."""
STUDENT_FIRST = 1.21
"""Student's t holds 95 % within 1 + 1.21 / n + 1.44 / n^2 times as many standard deviations as the
normal distribution, with n degrees of freedom (Cornish and Fisher's expansion) [-]."""
STUDENT_SECOND = 1.44
"""Second coefficient of that expansion [-]."""

# When a change is reported.
FINLESS_SHARE = 0.5
"""Share of the squares of the last cycle that a robot without its fin may leave [-]."""
N_ODD_CYCLES = 2
"""Cycles in a row, ending half a cycle apart, that do not fit until the water has changed [-]."""
N_WEAK_CYCLES = 3
"""Cycles in a row, ending half a cycle apart, in which a joint is weak until that is reported [-]."""

AT_REST = Command(gait=STILL)


class _Deviations(NamedTuple):
    """Deviations of the robot from its twin in every stretch that counts."""

    values: Array
    """Deviations, shape (n_stretches, n_rows) [units of `Stretches`]."""
    design: Array
    """By how much each unknown brings the robot nearer, shape (n_stretches, n_rows, n_unknowns)."""


class _NormalEquations(NamedTuple):
    """Least squares of the deviations, with the first guess as a prior."""

    step: Array
    """Change of the unknowns that minimizes the sum of squares."""
    matrix: Array
    """Matrix of the normal equations."""
    noise_variance: float
    """Variance of the noise of the deviations."""


class _SampleArrays(NamedTuple):
    """Samples as arrays, with one column per sample, whose first row is the time [s]."""

    poses: Array
    joints: Array
    references: Array


@value_class
class Learner:
    """From samples, one by one, to what they say of robot and water.

    Samples come in the order of their times.

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
            rule = "must be in water for anything to be learned"
            raise BadArgument("plant", f"{rule}, got the ground `{water.name}`")
        self.mount.on_link(self.robot)

    @cached_property
    def _initial_std(self) -> Array:
        """Standard deviations of the unknowns before anything is known, in their scales."""
        settings = self.settings
        coefficients = [settings.coefficient] * len(settings.unknown)
        return np.array([*coefficients, 1.0, CRAB, settings.current, settings.current])

    def _remaining_std(self, stretches: Stretches) -> Array:
        """Return what is left of the standard deviations however much is seen."""
        direction = np.exp(1j * stretches.marker[2]).mean()
        x = abs(direction.real / direction)
        y = abs(direction.imag / direction)
        coefficients = [FLOOR] * len(self.settings.unknown)
        current_x = math.hypot(FLOOR_AHEAD * x, FLOOR_ASIDE * y)
        current_y = math.hypot(FLOOR_AHEAD * y, FLOOR_ASIDE * x)
        return np.array([*coefficients, FLOOR_PLAY, CRAB, current_x, current_y])

    def init(self) -> LearnerState:
        """Return the state before the first sample.

        The plant is compiled, which may take seconds.
        """
        water: Any = self.plant.environment
        model = replace(self.plant.settings, joints=Prescribed(), dt=None)
        plant: Plant[Any] = replace(self.plant, environment=water.still, settings=model)
        plant.march(plant.init(Start(), AT_REST), AT_REST, TICK, TICK)
        return LearnerState(
            plant=plant,
            mean=0.0 * self._initial_std,
            deviation=self._initial_std,
            samples={PoseSample: (), JointSample: (), ReferenceSample: ()},
        )

    def step(self, state: LearnerState, sample: Sample) -> LearnerState:
        """Return the state after one more sample.

        Its `learned` is what is known anew, at the end of a stretch, or None.

        Args:
            state: As the last call returned it, or `init`.
            sample: What came in.

        Raises:
            ValueError: If the sample does not fit the robot.
        """
        state = self._remember(replace(state, learned=None), sample)
        if not isinstance(sample, ReferenceSample):
            if state.bounds:
                return state
            return state.since(sample.time)
        if sample.frequency == 0.0:
            return state.since(math.inf)
        if not state.bounds:
            return replace(state, bounds=(sample.time + MARGIN,))
        end_of_stretch = state.bounds[-1] + math.pi / sample.frequency
        if sample.time <= end_of_stretch + MARGIN:
            return state
        return self._learn(replace(state, bounds=(*state.bounds, end_of_stretch)))

    # ---- samples ---------------------------------------------------------------------------------

    def _remember(self, state: LearnerState, sample: Sample) -> LearnerState:
        """Add what counts of a sample."""
        values = self._values_of(sample)
        if values is None:
            return state
        kind = type(sample)
        rows = (*state.samples[kind], SampleRow(sample.time, values))
        return replace(state, samples={**state.samples, kind: rows})

    def _values_of(self, sample: Sample) -> tuple[float, ...] | None:
        """Return the values that count, see `SampleRow`; None if there are none."""
        if isinstance(sample, PoseSample):
            if sample.is_lost or sample.rotation is None:
                return None
            x, y = sample.position[:2].tolist()
            return x, y, self.mount.link_yaw(sample.rotation)
        angle = self.robot.yaw_joints("angle", sample.angle)
        if isinstance(sample, ReferenceSample):
            return tuple(angle.tolist())
        if not np.isfinite(angle).all():
            return None
        torque = angle * 0.0
        if sample.torque is not None:
            torque = self.robot.yaw_joints("torque", sample.torque)
        return (*angle.tolist(), *np.nan_to_num(torque).tolist())

    # ---- results ---------------------------------------------------------------------------------

    def _learn(self, state: LearnerState) -> LearnerState:
        """Learn from the stretches, after one more.

        Nothing is learnt as long as they are few, or if samples are missing.
        """
        state = state.since(state.bounds[-1] - self.settings.window)
        samples = _SampleArrays(
            poses=_stack(state.samples[PoseSample]),
            joints=_stack(state.samples[JointSample]),
            references=_stack(state.samples[ReferenceSample]),
        )
        begin = state.bounds[-2] - MARGIN
        end = state.bounds[-1] + MARGIN
        if not (_covers(samples.poses, begin, end) and _covers(samples.joints, begin, end)):
            return state.since(math.inf)
        state = self._watch_swings(replace(state, changes=()), samples)
        if len(state.bounds) > SETTLING_STRETCHES + LEAST_STRETCHES:
            stretches = Stretches(
                robot=self.robot,
                mount=self.mount,
                bounds=np.array(state.bounds),
                poses=samples.poses,
                joints=samples.joints,
            )
            state = self._fit(state, stretches)
        elif not state.changes:
            return state
        return replace(state, learned=self._summarize(state))

    def _summarize(self, state: LearnerState) -> Learned:
        """Return what is known, with names and units."""
        coefficients = self.settings.unknown
        names = (*coefficients, *UNITS)
        water = self._water_of(state, state.mean)
        learned_coefficients = [getattr(water, name) for name in coefficients]
        scale = np.array([*learned_coefficients, PLAY_SCALE, 1.0, 1.0, 1.0])
        further_values = (scale * state.mean)[len(coefficients) :].tolist()
        values = [*learned_coefficients, *further_values]
        deviations = (scale * state.deviation).tolist()
        return Learned(
            time=state.bounds[-1],
            value=dict(zip(names, values, strict=True)),
            deviation=dict(zip(names, deviations, strict=True)),
            changes=state.changes,
        )

    # ---- fit -------------------------------------------------------------------------------------

    def _fit(self, state: LearnerState, stretches: Stretches) -> LearnerState:
        """Fit the unknowns, or find what has changed in the last cycle.

        Two steps of Gauss and Newton, with the first guess as a prior.
        """
        deviations = self._compare(state, stretches)
        finless = self._plant_without_fin(state, stretches, deviations)
        n_odd = 0
        if self._is_odd(deviations.values, deviations.design):
            n_odd = state.n_odd + 1
        state = replace(state, n_odd=n_odd)
        if finless is not None:
            return self._start_again(replace(state, plant=finless), "The fin is gone.")
        if n_odd == N_ODD_CYCLES:
            return self._start_again(state, "The water is not what it was.")
        first = self._solve(state, deviations)
        state = replace(state, mean=state.mean + first.step)
        deviations = self._compare(state, stretches)
        second = self._solve(state, deviations)
        covariance = self._covariance(deviations, second)
        remaining = self._remaining_std(stretches)
        deviation = np.sqrt(np.diag(covariance) + remaining**2)
        return replace(state, mean=state.mean + second.step, deviation=deviation)

    def _solve(self, state: LearnerState, deviations: _Deviations) -> _NormalEquations:
        """Solve for a step of the unknowns."""
        design = deviations.design
        noise_variance = _noise_variance(deviations.values)
        prior = self._initial_std**-2.0
        information: Array = np.einsum("kij,kil->jl", design, design)
        matrix = information / noise_variance + np.diag(prior)
        pulls = _pull_of_stretches(deviations.values, design)
        pull: Array = pulls.sum(axis=0) / noise_variance - prior * state.mean
        step: Any = np.linalg.solve(matrix, pull)
        return _NormalEquations(step, matrix, noise_variance)

    def _covariance(self, deviations: _Deviations, equations: _NormalEquations) -> Array:
        """Return the covariance of the unknowns, from the scatter of the cycles' pulls.

        Deviations within a cycle depend on each other, so their number says little; the pulls of
        whole cycles are independent. As these are few, the spread is widened as by Student's t.
        """
        residuals = deviations.values - deviations.design @ equations.step
        pulls = _pull_of_stretches(residuals, deviations.design)
        cycles = _sum_over_cycles(pulls / equations.noise_variance)
        n_free = len(cycles) - 1
        student = 1.0 + STUDENT_FIRST / n_free + STUDENT_SECOND / n_free**2
        widening = (1.0 + 1.0 / n_free) * student**2
        spread = widening * cycles.T @ cycles + np.diag(self._initial_std**-2.0)
        inverse = np.linalg.inv(equations.matrix)
        return inverse @ spread @ inverse

    def _compare(self, state: LearnerState, stretches: Stretches) -> _Deviations:
        """Compare the robot with its twin, and with a twin for each unknown that needs one."""
        deviation, twin_motion = self._swim_twin(state, state.mean, stretches)
        columns = [deviation]
        unit_vectors = np.eye(state.mean.size)
        for unit_vector in unit_vectors[:-N_WITHOUT_TWIN]:
            larger = state.mean + LARGER * unit_vector
            deviation_of_larger = self._swim_twin(state, larger, stretches).deviation
            columns.append((deviation - deviation_of_larger) / LARGER)
        rows = stretches.reduce_to_medians(columns, twin_motion)[SETTLING_STRETCHES:]
        return _Deviations(values=rows[..., 0], design=rows[..., 1:])

    def _swim_twin(
        self, state: LearnerState, unknowns: Array, stretches: Stretches
    ) -> TwinComparison:
        """Compare the robot with a twin whose unknowns are these."""
        plant = replace(state.plant, environment=self._water_of(state, unknowns))
        play = PLAY_SCALE * float(unknowns[PLAY])
        return stretches.compare_with_twin(plant, play, unknowns[CURRENT])

    def _water_of(self, state: LearnerState, unknowns: Array) -> Water:
        """Return the water whose unknown coefficients are these."""
        water: Any = state.plant.environment
        factors = np.exp(unknowns).tolist()
        coefficients = {
            name: getattr(water, name) * factor
            for name, factor in zip(self.settings.unknown, factors, strict=False)
        }
        return replace(water, **coefficients)

    # ---- changes ---------------------------------------------------------------------------------

    def _plant_without_fin(
        self, state: LearnerState, stretches: Stretches, deviations: _Deviations
    ) -> Plant[Any] | None:
        """Return the plant without its fin, if that explains the last cycle better; else None."""
        robot = state.plant.robot
        if robot.caudal_fin is None:
            return None
        plant = replace(state.plant, robot=replace(robot, caudal_fin=None))
        deviation, twin_motion = self._swim_twin(replace(state, plant=plant), state.mean, stretches)
        of_last_cycle = stretches.reduce_to_medians([deviation], twin_motion)[-2:, :, 0]
        squares_with_fin = np.sum(deviations.values[-2:] ** 2)
        if np.sum(of_last_cycle**2) < FINLESS_SHARE * squares_with_fin:
            return plant
        return None

    def _is_odd(self, values: Array, design: Array) -> bool:
        """Return whether the last cycle pulls elsewhere than earlier ones and the noise would."""
        cycles = _sum_over_cycles(_pull_of_stretches(values, design))
        before = cycles[:-1]
        last = cycles[-1:]
        n_before = len(before)
        if n_before < LEAST_STRETCHES:
            return False
        noise_variance = _noise_variance(values)
        information = np.einsum("kij,kil->jl", design, design) / len(values)
        initial = noise_variance**2 * np.diag(self._initial_std**-2.0)
        noise = 2.0 * noise_variance * information + initial
        of_cycles = np.einsum("ki,kj->ij", before, before)
        usual: Array = (of_cycles + LEAST_STRETCHES * noise) / (n_before + LEAST_STRETCHES)
        squared_distance = (last @ np.linalg.solve(usual, last.T)).item()
        return squared_distance > self.settings.doubt**2

    def _start_again(self, state: LearnerState, change: str) -> LearnerState:
        """Forget all but the last cycle; the guess is what was learnt so far."""
        plant = replace(state.plant, environment=self._water_of(state, state.mean))
        n_coefficients = len(self.settings.unknown)
        mean = np.append(np.zeros(n_coefficients), state.mean[n_coefficients:])
        state = replace(
            state,
            plant=plant,
            mean=mean,
            deviation=self._initial_std,
            n_odd=0,
            changes=(*state.changes, change),
        )
        return state.since(state.bounds[-3])

    def _watch_swings(self, state: LearnerState, samples: _SampleArrays) -> LearnerState:
        """Add the swings of the last cycle, and report a joint that swings less than it did."""
        bounds = state.bounds[-3:]
        if len(bounds) < 3:
            return state
        n_rows = len(samples.references)
        swing_asked = _measure_swing(samples.references, n_rows, bounds)
        if swing_asked.min() < STILL_SWING:
            return state
        swing = _measure_swing(samples.joints, n_rows, bounds)
        swings = (*state.swings, swing / swing_asked)
        # The cycle before this one shares a stretch with it; without earlier ones, both have to do.
        earlier = swings[:-2] or swings
        share = swings[-1] / np.median(earlier, axis=0)
        worst = int(share.argmin())
        n_weak = 0
        if share[worst] < self.settings.weak:
            n_weak = state.n_weak + 1
        state = replace(state, swings=swings, n_weak=n_weak)
        fault = self._name_fault(float(share[worst]), n_weak)
        if fault is None:
            return state
        named_fault = NamedFault(worst, fault)
        is_overshadowed = fault == "is weak" and bool(state.named)
        if named_fault in state.named or is_overshadowed:
            return state
        change = (
            f"Joint {worst + 1} {fault}: it swings {100.0 * share[worst]:.0f} % of what it did."
        )
        return replace(state, named=state.named | {named_fault}, changes=(change,))

    def _name_fault(self, share: float, n_weak: int) -> str | None:
        """Return what is wrong with a joint that swings by this share; None: not enough."""
        if share < self.settings.stuck:
            return "is stuck"
        if n_weak == N_WEAK_CYCLES:
            return "is weak"
        return None


def _stack(rows: tuple[SampleRow, ...]) -> Array:
    """Return samples as an array with one column per sample; the first row is the time."""
    return np.array([(row.time, *row.values) for row in rows]).T


def _covers(samples: Array, begin: float, end: float) -> bool:
    """Return whether samples reach from one time to another, without a gap that would matter."""
    times = np.clip(samples[:1].ravel(), begin, end)
    intervals = np.diff(times, prepend=begin, append=end)
    return bool(intervals.max() < GAP)


def _measure_swing(samples: Array, n_rows: int, bounds: tuple[float, ...]) -> Array:
    """Return the standard deviation of every joint's angle within bounds [rad]."""
    times = samples[0]
    is_inside = (times > bounds[0]) & (times <= bounds[-1])
    return samples[1:n_rows, is_inside].std(axis=1)


def _noise_variance(values: Array) -> float:
    """Return the variance of the noise of deviations; single large ones do not count."""
    median = float(np.median(values * values))
    return max(median / MEDIAN_OF_SQUARE, SMALLEST_VARIANCE)


def _pull_of_stretches(values: Array, design: Array) -> Array:
    """Return the gradient of every stretch: where it pulls the unknowns, by how much it knows."""
    return np.einsum("kij,ki->kj", design, values)


def _sum_over_cycles(pulls: Array) -> Array:
    """Return sums over pairs of stretches, the last one with the one before it."""
    n_left_out = len(pulls) % 2
    pairs = pulls[n_left_out:].reshape(-1, 2, pulls.shape[1])
    return pairs.sum(axis=1)
