"""`fit_chain`: one fit of all frames of a film by a chain of links, with weights that the film itself decides.

The unknowns make the posterior density greatest: Gauss-Newton with an analytic Jacobian. Around each step
the weights are renewed so that their marginal likelihood, in Laplace's approximation, grows:

- of the third derivatives of position, heading and joints, by Fellner's and Schall's step (Wood and Fasiolo,
  Biometrics 73, 2017): (rank - weight tr(H^-1 R)) / x^T R x, with H the information of the posterior;
- of the harmonics, one for each order and group, by expectation and maximization;
- of the noise of every point, from its residuals, less the freedoms that it took;
- of outliers: a place belongs to the noise or is anywhere along the body, with the odds of a mixture.

The traces are means over draws of the posterior, the same ones in every step.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.arrow import ArrowFactor
from laticauda.film.chain.basis import Harmonics, SplineBasis
from laticauda.film.chain.equations import (
    GROUPS,
    FilmModel,
    Linearized,
    Prior,
    Unknowns,
    Weights,
)
from laticauda.film.chain.first_guess import NORMAL_MEDIAN, fill_gaps, guess_coordinates
from laticauda.film.chain.frequency import find_frequency
from laticauda.film.chain.geometry import N_ROOT, ChainGeometry, PointPlaces
from laticauda.film.chain.result import ChainFit
from laticauda.film.chain.scipy_parts import load_scipy
from laticauda.film.points import TrackedPoints
from laticauda.robot import Robot
from laticauda.values import BadArgument, check_choice, check_instance, check_whole_number

KNOTS_PER_CYCLE = 12
"""Knots of the splines in a period of the gait."""
FEWEST_FRAMES = 3
"""Frames in which a point must have been seen."""
FEWEST_INTERVALS = 8
"""Intervals of the splines, at least."""
USUAL_INTERVALS = 30
"""Intervals in a film without a gait."""
FEWEST_CYCLES = 1.5
"""Cycles that a film must hold for its harmonics to be told from splines."""
USUAL_HARMONICS = 3
"""Harmonics whose weights the film decides."""
FIRST_CUTOFF = 3.0
"""Frequency up to which the splines are free at first, by that of the gait."""
FIRST_BEND = 0.3
"""Standard deviation of the harmonics of an angle at first [rad]."""
SMALLEST_BEND = 1e-3
"""Least deviation of joint angles about straight [rad]."""
LARGEST_BEND = 1.0
"""Greatest deviation of joint angles about straight [rad]."""
LARGEST_CHANGE = 10.0
"""Factor by which a weight changes in one step, at most."""
STIFFEST = 1e10
"""Largest weight of roughness, by what the film says of a spline: beyond it, rounding rules."""
N_PROBES = 32
"""Draws that stand for a trace."""
MOST_STEPS = 40
"""Steps, at most."""
SETTLED = 0.01
"""Relative change of noise and degrees of freedom in a step at which the weights have settled."""
SMALL_STEP = 1e-5
"""Change of a place, by the length of the body, at which the search is over."""
FIRST_OUTLIERS = 0.02
"""Share of outliers at first."""
FEWEST_FREEDOMS = 0.1
"""Share of a point's numbers that the noise has left, at least."""


def fit_chain(
    points: TrackedPoints,
    robot: Robot,
    places: PointPlaces,
    *,
    harmonics: int | None = None,
    seed: int = 0,
    on_progress: Callable[[float], object] | None = None,
) -> ChainFit:
    """Fit a chain of links of fixed lengths to all frames of a film at once.

    Points need not sit on joints, may be lost in any frame, and may jump: places that fit nowhere are
    taken for what they are. The weight of smoothness is found from the film, not chosen.

    Args:
        points: Tracked points, in m.
        robot: What swims; pitch joints are held.
        places: Where the points sit on its body.
        harmonics: Number of harmonics of the gait that may repeat in every cycle; None: three if the film
            holds at least one and a half cycles, else none.
        seed: Seed of the draws that stand for traces.
        on_progress: Called with the share of the steps that are done, at most.

    Returns:
        The fit, from which whole motions are drawn.

    Raises:
        ValueError: If the points are in px, or too few were seen.
    """
    check_instance("points", points, TrackedPoints)
    check_instance("robot", robot, Robot)
    _check_points(points, places)
    check_whole_number("seed", seed, 0)
    if harmonics is not None:
        check_whole_number("harmonics", harmonics, 0, 10)
    geometry = ChainGeometry.of(robot.planar(), places)
    is_seen = np.all(np.isfinite(points.position), axis=2)
    x = points.position[..., 0]
    y = points.position[..., 1]
    observed = np.where(is_seen, x + 1j * y, 0.0)
    filled = fill_gaps(points.time, observed, is_seen)
    guess = guess_coordinates(geometry, places, filled)
    frequency = find_frequency(points.time, guess)
    model = FilmModel(
        geometry=geometry,
        places=places,
        time=points.time,
        is_seen=is_seen,
        observed=observed,
        basis=_choose_basis(points.time, frequency),
        harmonics=_choose_harmonics(points.time, frequency, harmonics),
    )
    state = _Search.begin(model, guess, frequency, seed)
    for step in range(MOST_STEPS):
        state = state.step()
        if on_progress is not None:
            on_progress((step + 1) / MOST_STEPS)
        if state.is_over:
            break
    return state.result(points)


def _check_points(points: TrackedPoints, places: PointPlaces) -> None:
    """Refuse points in px, points without a place, and points that were hardly ever seen."""
    check_choice("points.unit", points.unit, ("m",))
    n_points = len(points.names)
    if places.along.size != n_points:
        rule = f"must have a place for each of {n_points} tracked points"
        raise BadArgument("places", f"{rule}, got {places.along.size}")
    is_seen = np.all(np.isfinite(points.position), axis=2)
    n_frames = is_seen.sum(axis=0)
    if np.any(n_frames < FEWEST_FRAMES):
        point = int(np.argmin(n_frames))
        rule = "must have been seen in at least three frames"
        raise BadArgument(f"points.{points.names[point]}", f"{rule}; leave it out")


def _choose_basis(time: Float[np.ndarray, " n_frames"], frequency: float) -> SplineBasis:
    """Return splines that follow the third harmonic, with no more intervals than frames."""
    begin = float(time[0])
    duration = float(time[-1] - time[0])
    n_cycles = duration * frequency / (2.0 * math.pi)
    n_knots = max(math.ceil(KNOTS_PER_CYCLE * n_cycles), USUAL_INTERVALS)
    n_intervals = max(FEWEST_INTERVALS, min(n_knots, time.size - 1))
    return SplineBasis(begin=begin, step=duration / n_intervals, n_intervals=n_intervals)


def _choose_harmonics(
    time: Float[np.ndarray, " n_frames"], frequency: float, n_orders: int | None
) -> Harmonics:
    duration = float(time[-1] - time[0])
    n_cycles = duration * frequency / (2.0 * math.pi)
    middle = 0.5 * float(time[0] + time[-1])
    if n_orders is None:
        n_orders = USUAL_HARMONICS
        if n_cycles < FEWEST_CYCLES:
            n_orders = 0
    if frequency == 0.0:
        n_orders = 0
    return Harmonics(
        n_orders=n_orders,
        middle=middle,
        frequency=frequency,
        frequency_deviation=math.pi / duration,
    )


class _Draws(NamedTuple):
    """Draws of the unknowns about 0, by name."""

    splines: Float[np.ndarray, "n_splines n_coordinates n_probes"]
    """Coefficients of the splines."""
    harmonics: Float[np.ndarray, "n_coefficients n_probes"]
    """Coefficients of the harmonics, those of one function after the other."""

    @classmethod
    def of(cls, model: FilmModel, probes: Float[np.ndarray, "n_all n_probes"]) -> "_Draws":
        """Return the parts of draws.

        Args:
            model: The model.
            probes: The draws, one in every column.
        """
        n_coordinates = model.n_coordinates
        n_probes = probes.shape[1]
        end_of_splines = model.basis.size * n_coordinates
        end_of_harmonics = end_of_splines + model.harmonics.size * n_coordinates
        # The order in memory is that of the sums over draws, and decides their last digit.
        splines = np.ascontiguousarray(probes[:end_of_splines])
        return cls(
            splines=splines.reshape(model.basis.size, n_coordinates, n_probes),
            harmonics=probes[end_of_splines:end_of_harmonics],
        )

    def traces_of_roughness(self, basis: SplineBasis) -> Float[np.ndarray, " n_coordinates"]:
        """Return tr(H^-1 R) of every coordinate, as a mean over the draws.

        Args:
            basis: The splines.
        """
        _, n_coordinates, n_probes = self.splines.shape
        columns = self.splines.reshape(basis.size, -1)
        rough = np.sum(columns * (basis.roughness @ columns), axis=0)
        return rough.reshape(n_coordinates, n_probes).mean(axis=1)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Search:
    """The state of a fit between two steps."""

    model: FilmModel
    vector: Float[np.ndarray, " n_all"]
    weights: Weights
    white: Float[np.ndarray, "n_all n_probes"]
    freedoms: float = 0.0
    """Effective degrees of freedom at the last step."""
    is_over: bool = False
    n_steps: int = 0

    @classmethod
    def begin(
        cls,
        model: FilmModel,
        guess: Float[np.ndarray, "n_frames n_coordinates"],
        frequency: float,
        seed: int,
    ) -> "_Search":
        """Return the state before the first step."""
        splines = _smooth(model, guess, _first_roughness(model))
        n_coefficients = model.harmonics.size * model.n_coordinates
        border = np.zeros(n_coefficients + model.n_frequencies)
        if model.n_frequencies:
            border[-1] = frequency
        shifts = np.zeros(model.n_shifts)
        vector = np.concatenate((splines.ravel(), border, shifts))
        weights = _first_weights(model, model.split(vector))
        white = np.random.default_rng(seed).standard_normal((vector.size, N_PROBES))
        return cls(model=model, vector=vector, weights=weights, white=white)

    @property
    def unknowns(self) -> Unknowns:
        """The unknowns by name."""
        return self.model.split(self.vector)

    def membership(self) -> Float[np.ndarray, "n_frames n_points"]:
        """Return the odds that a place is noise about the chain and not anywhere; 0 where it was lost."""
        regular, anywhere = self._densities()
        return self.model.is_seen * regular / (regular + anywhere)

    def _densities(self) -> tuple[Float[np.ndarray, "n_frames n_points"], float]:
        """Return the density of every place as noise about the chain, and that of a place anywhere [1/m^2]."""
        noise = self.weights.noise
        share = self.weights.outlier_share
        scaled = np.abs(self.model.residuals(self.unknowns)) / noise
        peak = (1.0 - share) / (2.0 * math.pi * noise**2)
        anywhere = share / self.model.geometry.robot.length**2
        return peak * np.exp(-0.5 * scaled**2), anywhere

    def factor(self) -> tuple[Linearized, ArrowFactor]:
        """Return the linearized model and the factor of the posterior's information."""
        linearized = Linearized.of(self.model, self.unknowns)
        information = linearized.information(self.membership() / self.weights.noise**2)
        prior = Prior(model=self.model, weights=self.weights)
        return linearized, prior.added_to(information).factor()

    def step(self) -> "_Search":
        """Return the state after one step of the unknowns, and one of the weights."""
        linearized, factor = self.factor()
        change = self._change(linearized, factor)
        probes = factor.whiten_back(self.white)
        moved = replace(self, vector=self.vector + change[:, 0], n_steps=self.n_steps + 1)
        weights = moved.renewed_weights(linearized, probes)
        freedoms = _count_freedoms(linearized, self.membership(), probes, self.weights)
        change_of_places = math.sqrt(float(np.max(linearized.spread_of_places(change))))
        length = self.model.geometry.robot.length
        has_stopped = change_of_places < SMALL_STEP * length
        is_over = self._has_settled(weights, freedoms) and has_stopped
        return replace(moved, weights=weights, freedoms=freedoms, is_over=bool(is_over))

    def _change(self, linearized: Linearized, factor: ArrowFactor) -> Float[np.ndarray, "n_all 1"]:
        """Return the change of the unknowns in a step, as a column."""
        residuals = self.model.residuals(self.unknowns)
        prior = Prior(model=self.model, weights=self.weights)
        pull = linearized.pull(self.membership() / self.weights.noise**2, residuals)
        pull += prior.pull(self.unknowns)
        return factor.solve(pull[:, np.newaxis])

    def _has_settled(self, weights: Weights, freedoms: float) -> bool:
        """Return whether noise and degrees of freedom are nearly those of the step before."""
        noise_changes = np.abs(weights.noise / self.weights.noise - 1.0)
        change_of_freedoms = abs(freedoms / max(self.freedoms, 1e-9) - 1.0)
        return bool(max(change_of_freedoms, np.max(noise_changes)) < SETTLED)

    def renewed_weights(
        self, linearized: Linearized, probes: Float[np.ndarray, "n_all n_probes"]
    ) -> Weights:
        """Return the weights after a step.

        Args:
            linearized: The model about the unknowns before the step.
            probes: Draws of the posterior about 0, one in every column.
        """
        draws = _Draws.of(self.model, probes)
        membership = self.membership()
        return Weights(
            roughness=self._renew_roughness(linearized, draws),
            harmonic_deviation=self._renew_harmonics(draws),
            bend_deviation=self._renew_bend(draws),
            noise=self._renew_noise(membership, linearized.spread_of_places(probes)),
            outlier_share=self._renew_outlier_share(membership),
        )

    def _renew_roughness(
        self, linearized: Linearized, draws: _Draws
    ) -> Float[np.ndarray, " n_coordinates"]:
        """Return the weights of roughness after a step of Fellner and Schall."""
        basis = self.model.basis
        splines = self.unknowns.splines
        rough = np.sum(splines * (basis.roughness @ splines), axis=0)
        traces = draws.traces_of_roughness(basis)
        stiffest = _stiffest(linearized, self.weights)
        roughness = np.empty(self.model.n_coordinates)
        for group in GROUPS.values():
            old = self.weights.roughness[group]
            straightness = 0.0
            if group.start == N_ROOT:
                straightness = self.weights.bend_deviation**-2
            rank = _count_free(basis, old, straightness)
            freedoms = rank - float(np.sum(old * traces[group]))
            unlimited = max(freedoms, 1e-3) / float(np.sum(rough[group]))
            lowest = old / LARGEST_CHANGE
            highest = np.minimum(old * LARGEST_CHANGE, stiffest[group])
            roughness[group] = np.minimum(np.maximum(unlimited, lowest), highest)
        return roughness

    def _renew_harmonics(self, draws: _Draws) -> Float[np.ndarray, "n_functions n_coordinates"]:
        """Return the deviations of harmonics: expected rms of their coefficients, by order and group."""
        harmonics = self.unknowns.harmonics
        variances = np.mean(draws.harmonics**2, axis=1)
        squares = harmonics**2 + variances.reshape(harmonics.shape)
        deviation = np.empty_like(self.weights.harmonic_deviation)
        for order in range(self.model.harmonics.n_orders):
            cosine_and_sine = slice(2 * order, 2 * order + 2)
            for group in GROUPS.values():
                squares_of_group = squares[cosine_and_sine, group]
                total = float(np.sum(squares_of_group))
                deviation[cosine_and_sine, group] = math.sqrt(total / squares_of_group.size)
        return deviation

    def _renew_bend(self, draws: _Draws) -> float:
        """Return the deviation of joint angles about straight after a step of the kind of the roughness."""
        deviation = self.weights.bend_deviation
        precision = deviation**-2
        joint_roughness = self.weights.roughness[N_ROOT:]
        stiffness = np.outer(joint_roughness, self.model.basis.roughness_sizes)
        if stiffness.size == 0:
            return deviation
        bends = self.unknowns.splines[:, N_ROOT:]
        size = float(np.sum(bends**2))
        variances = np.mean(draws.splines[:, N_ROOT:] ** 2, axis=2)
        rank = float(np.sum(precision / (stiffness + precision)))
        freedoms = rank - precision * float(np.sum(variances))
        unlimited = max(freedoms, 1e-3) / size
        lowest = precision / LARGEST_CHANGE
        highest = precision * LARGEST_CHANGE
        renewed = min(max(unlimited, lowest), highest)
        return min(max(renewed**-0.5, SMALLEST_BEND), LARGEST_BEND)

    def _renew_noise(
        self,
        membership: Float[np.ndarray, "n_frames n_points"],
        spread_of_places: Float[np.ndarray, "n_frames n_points"],
    ) -> Float[np.ndarray, " n_points"]:
        """Return the noise of every point: its residuals, over the numbers that the motion did not take."""
        squares = membership * np.abs(self.model.residuals(self.unknowns)) ** 2
        spread = np.sum(membership * spread_of_places, axis=0)
        n_numbers = 2.0 * np.sum(membership, axis=0)
        n_left = n_numbers - spread / self.weights.noise**2
        n_left = np.maximum(n_left, FEWEST_FREEDOMS * n_numbers)
        noise = np.sqrt(np.sum(squares, axis=0) / n_left)
        # Exact points must not make the equations singular.
        return np.maximum(noise, 1e-7 * self.model.geometry.robot.length)

    def _renew_outlier_share(self, membership: Float[np.ndarray, "n_frames n_points"]) -> float:
        """Return the share of outliers; half a place more, so that it is never 0."""
        n_seen = int(np.sum(self.model.is_seen))
        n_outliers = n_seen - float(np.sum(membership))
        return (n_outliers + 0.5) / (n_seen + 1.0)

    def log_evidence(self, factor: ArrowFactor) -> float:
        """Return the logarithm of the marginal likelihood (Laplace), up to what no weight changes."""
        regular, anywhere = self._densities()
        likelihood = float(np.sum(np.log(regular + anywhere)[self.model.is_seen]))
        prior = Prior(model=self.model, weights=self.weights).log_density(self.unknowns)
        return likelihood + prior - 0.5 * factor.log_determinant

    def result(self, points: TrackedPoints) -> ChainFit:
        """Return the fit."""
        linearized, factor = self.factor()
        membership = self.membership()
        probes = factor.whiten_back(self.white)
        return ChainFit(
            model=self.model,
            points=points,
            vector=self.vector,
            weights=self.weights,
            factor=factor,
            membership=membership,
            freedoms=_count_freedoms(linearized, membership, probes, self.weights),
            log_evidence=self.log_evidence(factor),
            has_settled=self.is_over,
            n_steps=self.n_steps,
        )


def _cutoff(model: FilmModel) -> float:
    """Return the angular frequency up to which the splines are free at first [rad/s]."""
    frequency = model.harmonics.frequency
    if frequency == 0.0:
        frequency = 2.0 * math.pi * 5.0 / model.duration
    return FIRST_CUTOFF * frequency


def _first_roughness(model: FilmModel) -> float:
    """Return the weight of roughness, for places of deviation 1, with which splines bend off at the cutoff."""
    # The third derivative of a wave is larger than the wave by its frequency cubed. The integral of its square
    # stands against a sum over frames.
    return model.frame_rate * _cutoff(model) ** -6.0


def _first_weights(model: FilmModel, unknowns: Unknowns) -> Weights:
    """Return the weights before the first step, with noise as large as the residuals of the first guess."""
    length = model.geometry.robot.length
    residuals = np.abs(model.residuals(unknowns))[model.is_seen]
    noise = NORMAL_MEDIAN * float(np.median(residuals)) / math.sqrt(2.0)
    noise = max(noise, 1e-6 * length)
    jacobian = Linearized.of(model, unknowns).by_coordinate
    sensitivity = np.mean(np.sum(jacobian**2, axis=1), axis=0) / noise**2
    scale = np.full(model.n_coordinates, FIRST_BEND)
    scale[:2] *= 0.3 * length
    return Weights(
        roughness=_shared(sensitivity * model.frame_rate * _cutoff(model) ** -6.0),
        harmonic_deviation=np.tile(scale, (model.harmonics.size, 1)),
        bend_deviation=FIRST_BEND,
        noise=np.full(model.n_points, noise),
        outlier_share=FIRST_OUTLIERS,
    )


def _smooth(
    model: FilmModel, guess: Float[np.ndarray, "n_frames n_coordinates"], weight: float
) -> Float[np.ndarray, "n_splines n_coordinates"]:
    """Return splines through the first guess, with a given weight of their roughness."""
    sparse = load_scipy("sparse")
    linalg = load_scipy("sparse.linalg")
    values = model.spline_values
    matrix = values.T @ values + weight * model.basis.roughness
    matrix = matrix + 1e-9 * sparse.eye_array(model.basis.size)
    return np.asarray(linalg.splu(matrix.tocsc()).solve(values.T @ guess))


def _shared(values: Float[np.ndarray, " n_coordinates"]) -> Float[np.ndarray, " n_coordinates"]:
    """Return the geometric mean of every group of coordinates, for each of its members."""
    shared = np.empty_like(values)
    for group in GROUPS.values():
        if values[group].size:
            shared[group] = math.exp(float(np.mean(np.log(values[group]))))
    return shared


def _count_freedoms(
    linearized: Linearized,
    membership: Float[np.ndarray, "n_frames n_points"],
    probes: Float[np.ndarray, "n_all n_probes"],
    weights: Weights,
) -> float:
    """Return how many numbers the unknowns take from the film: the trace of H^-1 J^T W J."""
    spread = np.sum(membership * linearized.spread_of_places(probes), axis=0)
    return float(np.sum(spread / weights.noise**2))


def _count_free(
    basis: SplineBasis, roughness: Float[np.ndarray, " n_members"], straightness: float
) -> float:
    """Return the trace of the prior's covariance times the weighted roughness, for coordinates of one group."""
    if straightness == 0.0:
        return float(roughness.size * basis.n_penalized)
    stiffness = np.outer(roughness, basis.roughness_sizes)
    return float(np.sum(stiffness / (stiffness + straightness)))


def _stiffest(linearized: Linearized, weights: Weights) -> Float[np.ndarray, " n_coordinates"]:
    """Return the largest weights of roughness with which the equations can be solved."""
    basis = linearized.model.basis
    root_weight = np.tile(1.0 / weights.noise, 2)[:, np.newaxis]
    squares = (root_weight * linearized.by_coordinate) ** 2
    information = np.sum(squares, axis=(0, 1)) / basis.size
    diagonal: np.ndarray = basis.roughness.diagonal()
    return _shared(STIFFEST * basis.size * information / float(np.sum(diagonal)))
