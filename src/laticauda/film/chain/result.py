"""`ChainFit`: what a fit of all frames found, and draws of whole motions from it."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Complex, Float

from laticauda.film.chain.arrow import ArrowFactor
from laticauda.film.chain.equations import FilmModel, Unknowns, Weights
from laticauda.film.chain.geometry import N_ROOT, PointPlaces
from laticauda.film.chain.motion import ChainMotion
from laticauda.film.points import TrackedPoints
from laticauda.robot import Robot
from laticauda.values import check_whole_number

LARGEST_CORRELATION = 0.95
"""Correlation of noise in consecutive frames, at most: at 1 a film would say nothing."""
SURE = 0.5
"""Odds below which a place is taken for an outlier."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ChainFit:
    """A chain fitted to all frames of a film, with its uncertainty."""

    model: FilmModel
    """Film, chain and functions of time."""
    points: TrackedPoints
    """The tracked points."""
    vector: Float[np.ndarray, " n_all"]
    """All unknowns."""
    weights: Weights
    """Strengths of priors and noise, found from the film."""
    factor: ArrowFactor
    """Cholesky factor of the posterior's information."""
    membership: Float[np.ndarray, "n_frames n_points"]
    """Odds that a place belongs to the chain and is no outlier; 0 where it was lost [-]."""
    freedoms: float
    """Effective degrees of freedom: how many numbers the motion took from the film."""
    log_evidence: float
    """Logarithm of the marginal likelihood, to compare fits of one film."""
    has_settled: bool
    """Whether the weights settled."""
    n_steps: int
    """Steps that it took."""

    def __repr__(self) -> str:
        """Return one line: frames, points, noise and frequency."""
        n_frames, n_points = self.membership.shape
        noise = 1e3 * float(np.median(self.weights.noise))
        return (
            f"<ChainFit of {self.robot.name}: {n_frames} frames, {n_points} points, "
            f"noise {noise:.2g} mm, {self.frequency:.3g} Hz>"
        )

    @property
    def robot(self) -> Robot:
        """What swims, without pitch joints."""
        return self.model.geometry.robot

    @property
    def unknowns(self) -> Unknowns:
        """The unknowns by name."""
        return self.model.split(self.vector)

    @property
    def frequency(self) -> float:
        """Frequency of the gait; 0 without harmonics [Hz]."""
        return self.unknowns.frequency / (2.0 * math.pi)

    @property
    def noise(self) -> Float[np.ndarray, " n_points"]:
        """Standard deviation of every point's noise along one axis [m]."""
        return self.weights.noise

    @property
    def n_outliers(self) -> int:
        """Number of places that were seen and belong elsewhere."""
        return int(np.sum(self.model.is_seen & (self.membership < SURE)))

    @property
    def places(self) -> PointPlaces:
        """Where the points sit, as found."""
        places = self.model.places
        shift = self.unknowns.shift
        along = places.along + np.real(shift)
        left = places.left + np.imag(shift)
        return replace(places, along=along, left=left)

    @cached_property
    def residuals(self) -> Complex[np.ndarray, "n_frames n_points"]:
        """Seen minus fitted places, x + i y; 0 where a point was lost [m]."""
        return self.model.residuals(self.unknowns)

    @cached_property
    def noise_correlation(self) -> float:
        """Correlation of residuals of regular places in consecutive frames, 0 if it is not above chance [-]."""
        residuals = np.where(self.membership > SURE, self.residuals / self.noise, 0.0)
        products = np.real(residuals[1:] * residuals[:-1].conj())
        n_pairs = np.count_nonzero(products)
        if n_pairs == 0:
            return 0.0
        variance = float(np.mean(np.abs(residuals[residuals != 0.0]) ** 2))
        correlation = float(np.sum(products)) / (n_pairs * variance)
        # Without any correlation, the mean of two numbers a pair has this deviation.
        deviation_by_chance = 1.0 / math.sqrt(2.0 * n_pairs)
        if correlation < 2.0 * deviation_by_chance:
            return 0.0
        return min(correlation, LARGEST_CORRELATION)

    @property
    def widening(self) -> float:
        """Factor of all deviations for noise that is correlated from frame to frame, as of a process of order 1."""
        correlation = self.noise_correlation
        return math.sqrt((1.0 + correlation) / (1.0 - correlation))

    def motion(self, time: Float[np.ndarray, " n_times"]) -> ChainMotion:
        """Return the most probable motion.

        Args:
            time: Times within the film [s].
        """
        return self._motions(time, self.vector[:, np.newaxis])[0]

    def draw(
        self, n_draws: int, time: Float[np.ndarray, " n_times"], *, seed: int = 0
    ) -> ChainMotion:
        """Draw whole motions from what the film leaves open.

        Args:
            n_draws: Number of motions.
            time: Times within the film [s].
            seed: Seed of the draws.

        Returns:
            The motions; the first axis is that of draws.

        Raises:
            ValueError: If `n_draws` or `seed` is no whole number in its range.
        """
        check_whole_number("n_draws", n_draws, 1)
        check_whole_number("seed", seed, 0)
        white = np.random.default_rng(seed).standard_normal((self.vector.size, n_draws))
        changes = self.widening * self.factor.whiten_back(white)
        return self._motions(time, self.vector[:, np.newaxis] + changes)

    def _motions(
        self, time: Float[np.ndarray, " n_times"], vectors: Float[np.ndarray, "n_all n_draws"]
    ) -> ChainMotion:
        """Return the motions of vectors of unknowns in columns."""
        time = np.asarray(time, dtype=float)
        matrices = [self.model.basis.matrix(time, order) for order in range(3)]
        harmonics = self.model.harmonics
        n_draws = vectors.shape[1]
        derivatives = np.empty((3, n_draws, time.size, self.model.n_coordinates))
        for draw, vector in enumerate(vectors.T):
            unknowns = self.model.split(vector)
            for order, matrix in enumerate(matrices):
                waves = harmonics.values(time, unknowns.frequency, order)
                periodic = waves @ unknowns.harmonics
                derivatives[order, draw] = matrix @ unknowns.splines + periodic
        return ChainMotion(
            time=time,
            coordinates=derivatives[0],
            rates=derivatives[1],
            accelerations=derivatives[2],
        )

    @cached_property
    def joint_deviation(self) -> Float[np.ndarray, " n_joints"]:
        """Standard deviation of every joint angle, mean square over the frames [rad]."""
        draws = self.draw(64, self.model.time)
        spread = np.var(draws.coordinates[..., N_ROOT:], axis=0)
        return np.sqrt(np.mean(spread, axis=0))
