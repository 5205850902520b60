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
    check_choice("points.unit", points.unit, ("m",))
    n_points = len(points.names)
    if places.along.size != n_points:
        rule = f"must have a place for each of {n_points} tracked points"
        raise BadArgument("places", f"{rule}, got {places.along.size}")
    if harmonics is not None:
        check_whole_number("harmonics", harmonics, 0, 10)
    geometry = ChainGeometry.of(robot.planar(), places)
    seen = np.all(np.isfinite(points.position), axis=2)
    if np.any(seen.sum(axis=0) < 3):
        point = int(np.argmin(seen.sum(axis=0)))
        rule = "must have been seen in at least three frames"
        raise BadArgument(f"points.{points.names[point]}", f"{rule}; leave it out")
    observed = np.where(seen, points.position[..., 0] + 1j * points.position[..., 1], 0.0)
    filled = fill_gaps(points.time, observed, seen)
    guess = guess_coordinates(geometry, places, filled)
    frequency = find_frequency(points.time, guess)
    model = FilmModel(
        geometry=geometry,
        places=places,
        time=points.time,
        seen=seen,
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


def _choose_basis(time: Float[np.ndarray, " n_frames"], frequency: float) -> SplineBasis:
    """Return splines that follow the third harmonic, with no more intervals than frames."""
    begin, duration = float(time[0]), float(time[-1] - time[0])
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
        n_orders = USUAL_HARMONICS if n_cycles >= FEWEST_CYCLES else 0
    if frequency == 0.0:
        n_orders = 0
    return Harmonics(
        n_orders=n_orders,
        middle=middle,
        frequency=frequency,
        frequency_deviation=math.pi / duration,
    )


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
        n_orders, m = model.harmonics.n_orders, model.n_coordinates
        duration = float(model.time[-1] - model.time[0])
        cutoff = FIRST_CUTOFF * (frequency or 2.0 * math.pi * 5.0 / duration)
        frame_rate = (model.time.size - 1) / duration
        splines = _smooth(model, guess, frame_rate * cutoff**-6.0)
        border = np.zeros(2 * n_orders * m + min(n_orders, 1))
        if n_orders:
            border[-1] = frequency
        n_shifts = (model.places.along_deviation > 0.0) + (model.places.left_deviation > 0.0)
        shifts = np.zeros(n_shifts * model.n_points)
        vector = np.concatenate((splines.ravel(), border, shifts))
        unknowns = model.split(vector)
        residuals = np.abs(model.residuals(unknowns))[model.seen]
        noise = NORMAL_MEDIAN * float(np.median(residuals)) / math.sqrt(2.0)
        noise = max(noise, 1e-6 * model.geometry.robot.length)
        jacobian = Linearized.of(model, unknowns).by_coordinate
        sensitivity = np.mean(np.sum(jacobian**2, axis=1), axis=0) / noise**2
        scale = np.full(m, FIRST_BEND)
        scale[:2] *= 0.3 * model.geometry.robot.length
        weights = Weights(
            roughness=_shared(sensitivity * frame_rate * cutoff**-6.0),
            harmonic_deviation=np.tile(scale, (2 * n_orders, 1)),
            bend_deviation=FIRST_BEND,
            noise=np.full(model.n_points, noise),
            outlier_share=FIRST_OUTLIERS,
        )
        white = np.random.default_rng(seed).standard_normal((vector.size, N_PROBES))
        return cls(model=model, vector=vector, weights=weights, white=white)

    @property
    def unknowns(self) -> Unknowns:
        """The unknowns by name."""
        return self.model.split(self.vector)

    def membership(self) -> Float[np.ndarray, "n_frames n_points"]:
        """Return the odds that a place is noise about the chain and not anywhere; 0 where it was lost."""
        regular, anywhere = self._densities()
        return self.model.seen * regular / (regular + anywhere)

    def _densities(self) -> tuple[Float[np.ndarray, "n_frames n_points"], float]:
        """Return the density of every place as noise about the chain, and that of a place anywhere [1/m^2]."""
        noise, share = self.weights.noise, self.weights.outlier_share
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
        residuals = self.model.residuals(self.unknowns)
        prior = Prior(model=self.model, weights=self.weights)
        pull = linearized.pull(self.membership() / self.weights.noise**2, residuals)
        pull += prior.pull(self.unknowns)
        change = factor.solve(pull[:, np.newaxis])
        moved = replace(self, vector=self.vector + change[:, 0], n_steps=self.n_steps + 1)
        probes = factor.whiten_back(self.white)
        weights = moved.renewed_weights(linearized, probes)
        way = math.sqrt(float(np.max(linearized.spread_of_places(change))))
        freedoms = _count_freedoms(linearized, self.membership(), probes, self.weights)
        noise_changes = np.abs(weights.noise / self.weights.noise - 1.0)
        changes = max(abs(freedoms / max(self.freedoms, 1e-9) - 1.0), np.max(noise_changes))
        is_over = changes < SETTLED and way < SMALL_STEP * self.model.geometry.robot.length
        return replace(moved, weights=weights, freedoms=freedoms, is_over=bool(is_over))

    def renewed_weights(
        self, linearized: Linearized, probes: Float[np.ndarray, "n_all n_probes"]
    ) -> Weights:
        """Return the weights after a step."""
        model, unknowns, old = self.model, self.unknowns, self.weights
        m, basis = model.n_coordinates, model.basis
        n_splines, n_harmonics = basis.size * m, model.harmonics.size * m
        rough = np.sum(unknowns.splines * (basis.roughness @ unknowns.splines), axis=0)
        drawn = probes[:n_splines].reshape(basis.size, -1)
        traces = np.sum(drawn * (basis.roughness @ drawn), axis=0).reshape(m, -1).mean(axis=1)
        roughness, deviation = np.empty(m), np.empty_like(old.harmonic_deviation)
        spread = np.mean(probes[n_splines : n_splines + n_harmonics] ** 2, axis=1)
        squares = unknowns.harmonics**2 + spread.reshape(model.harmonics.size, m)
        stiffest = _stiffest(linearized, old)
        for group in GROUPS.values():
            now = old.roughness[group]
            straightness = 0.0
            if group.start == N_ROOT:
                straightness = old.bend_deviation**-2
            free = _count_free(basis, now, straightness)
            freedoms = free - float(np.sum(now * traces[group]))
            unlimited = max(freedoms, 1e-3) / float(np.sum(rough[group]))
            lowest = now / LARGEST_CHANGE
            highest = np.minimum(now * LARGEST_CHANGE, stiffest[group])
            roughness[group] = np.minimum(np.maximum(unlimited, lowest), highest)
            for order in range(model.harmonics.n_orders):
                pair = slice(2 * order, 2 * order + 2)
                of_pair = squares[pair, group]
                deviation[pair, group] = math.sqrt(float(np.sum(of_pair)) / of_pair.size)
        bends = unknowns.splines[:, N_ROOT:]
        bend_spread = np.mean(drawn.reshape(basis.size, m, -1)[:, N_ROOT:] ** 2, axis=2)
        bend = _renew_bend(old, basis, float(np.sum(bends**2)), float(np.sum(bend_spread)))
        membership = self.membership()
        square = membership * np.abs(model.residuals(unknowns)) ** 2
        spread = np.sum(membership * linearized.spread_of_places(probes), axis=0)
        numbers = 2.0 * np.sum(membership, axis=0)
        freedoms_left = np.maximum(numbers - spread / old.noise**2, FEWEST_FREEDOMS * numbers)
        noise = np.sqrt(np.sum(square, axis=0) / freedoms_left)
        n_seen = int(np.sum(model.seen))
        share = (n_seen - float(np.sum(membership)) + 0.5) / (n_seen + 1.0)
        return Weights(
            roughness=roughness,
            harmonic_deviation=deviation,
            bend_deviation=bend,
            noise=np.maximum(noise, 1e-7 * model.geometry.robot.length),
            outlier_share=share,
        )

    def log_evidence(self, factor: ArrowFactor) -> float:
        """Return the logarithm of the marginal likelihood (Laplace), up to what no weight changes."""
        regular, anywhere = self._densities()
        likelihood = float(np.sum(np.log(regular + anywhere)[self.model.seen]))
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


def _smooth(
    model: FilmModel, guess: Float[np.ndarray, "n_frames n_coordinates"], weight: float
) -> Float[np.ndarray, "n_splines n_coordinates"]:
    """Return splines through the first guess, with a given weight of their roughness."""
    values, n = model.spline_values, model.basis.size
    sparse, linalg = load_scipy("sparse"), load_scipy("sparse.linalg")
    matrix = values.T @ values + weight * model.basis.roughness + 1e-9 * sparse.eye_array(n)
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


def _renew_bend(old: Weights, basis: SplineBasis, size: float, spread: float) -> float:
    """Return the deviation of joint angles about straight after a step of the kind of the roughness.

    Args:
        old: Weights before the step.
        basis: The splines.
        size: Sum of the squared coefficients of all joints [rad^2].
        spread: The same of their variances [rad^2].
    """
    precision = old.bend_deviation**-2
    stiffness = np.outer(old.roughness[N_ROOT:], basis.roughness_sizes)
    if stiffness.size == 0:
        return old.bend_deviation
    freedoms = float(np.sum(precision / (stiffness + precision))) - precision * spread
    unlimited = max(freedoms, 1e-3) / size
    renewed = min(max(unlimited, precision / LARGEST_CHANGE), precision * LARGEST_CHANGE)
    return min(max(renewed**-0.5, SMALLEST_BEND), LARGEST_BEND)


def _stiffest(linearized: Linearized, weights: Weights) -> Float[np.ndarray, " n_coordinates"]:
    """Return the largest weights of roughness with which the equations can be solved."""
    basis = linearized.model.basis
    root_weight = np.tile(1.0 / weights.noise, 2)[:, np.newaxis]
    information = np.sum((root_weight * linearized.by_coordinate) ** 2, axis=(0, 1)) / basis.size
    diagonal: np.ndarray = basis.roughness.diagonal()
    return _shared(STIFFEST * basis.size * information / float(np.sum(diagonal)))
