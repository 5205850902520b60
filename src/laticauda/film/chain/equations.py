"""The equations of one fit of all frames: what the points say, and what is known of the motion beforehand.

Residuals of all frames are linearized at once. The unknowns stand in one vector: coefficients of the
splines knot by knot, then those of the harmonics, the frequency, and by how much points sit elsewhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Complex, Float

from laticauda.film.chain.arrow import ArrowMatrix, fill_band
from laticauda.film.chain.basis import DEGREE, Harmonics, SplineBasis
from laticauda.film.chain.geometry import N_ROOT, ChainGeometry, PointPlaces
from laticauda.film.chain.scipy_parts import load_scipy

GROUPS = {"position": slice(0, 2), "heading": slice(2, 3), "joints": slice(3, None)}
"""Coordinates that share a weight."""


class Unknowns(NamedTuple):
    """What a fit determines."""

    splines: Float[np.ndarray, "n_splines n_coordinates"]
    """x."""
    harmonics: Float[np.ndarray, "n_functions n_coordinates"]
    """z."""
    frequency: float
    """Angular frequency of the harmonics; unused without any [rad/s]."""
    shift: Complex[np.ndarray, " n_points"]
    """By how much points sit elsewhere than given, headward + i leftward [m]."""


class Weights(NamedTuple):
    """How strong priors and noise are: found from the film itself."""

    roughness: Float[np.ndarray, " n_coordinates"]
    """Weight of the squared third derivative of every coordinate."""
    harmonic_deviation: Float[np.ndarray, "n_functions n_coordinates"]
    """Standard deviation of the coefficients of harmonics."""
    bend_deviation: float
    """Standard deviation of joint angles about straight, harmonics not counted [rad]."""
    noise: Float[np.ndarray, " n_points"]
    """Standard deviation of a point's noise along one axis [m]."""
    outlier_share: float
    """Share of places that are somewhere else altogether."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FilmModel:
    """Film, chain and functions of time of one fit."""

    geometry: ChainGeometry
    """The chain with its points."""
    places: PointPlaces
    """Where the points sit, and how surely."""
    time: Float[np.ndarray, " n_frames"]
    """Times of the frames [s]."""
    is_seen: Bool[np.ndarray, "n_frames n_points"]
    """Where a point was seen."""
    observed: Complex[np.ndarray, "n_frames n_points"]
    """Where it was seen; 0 where it was lost [m]."""
    basis: SplineBasis
    """The splines."""
    harmonics: Harmonics
    """The harmonics."""

    @property
    def duration(self) -> float:
        """Time from the first frame to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def frame_rate(self) -> float:
        """Mean number of frames in a second [1/s]."""
        return (self.time.size - 1) / self.duration

    @cached_property
    def spline_values(self) -> Any:
        """The splines at the frames, sparse."""
        return self.basis.matrix(self.time)

    @cached_property
    def spline_products(self) -> list[Any]:
        """Products of two splines at the frames by their distance, each as a sparse matrix of splines and frames."""
        sparse = load_scipy("sparse")
        values = self.spline_values.toarray()
        n_splines = values.shape[1]
        products: list[Any] = []
        for offset in range(DEGREE + 1):
            values_ahead = np.zeros_like(values)
            values_ahead[:, : n_splines - offset] = values[:, offset:]
            products.append(sparse.csr_array((values * values_ahead).T))
        return products

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates of the chain."""
        return self.geometry.n_coordinates

    @property
    def n_points(self) -> int:
        """Number of points."""
        return self.is_seen.shape[1]

    @property
    def n_frequencies(self) -> int:
        """Number of unknown frequencies: one if there are harmonics."""
        return min(self.harmonics.size, 1)

    @property
    def shift_deviations(self) -> list[float]:
        """Deviations of unknown shifts of points, those along the body before those to the left [m]."""
        deviations = (self.places.along_deviation, self.places.left_deviation)
        return [deviation for deviation in deviations if deviation > 0.0]

    @property
    def n_shifts(self) -> int:
        """Number of unknown shifts of all points."""
        return len(self.shift_deviations) * self.n_points

    def split(self, vector: Float[np.ndarray, " n_all"]) -> Unknowns:
        """Return the parts of one vector of unknowns, or of a change of them.

        Args:
            vector: The vector.
        """
        sizes = [
            self.basis.size * self.n_coordinates,
            self.harmonics.size * self.n_coordinates,
            self.n_frequencies,
        ]
        splines, harmonics, frequency, shifts = np.split(vector, np.cumsum(sizes))
        along = np.zeros(self.n_points)
        left = np.zeros(self.n_points)
        if self.places.along_deviation > 0.0:
            along = shifts[: self.n_points]
        if self.places.left_deviation > 0.0:
            left = shifts[-self.n_points :]
        return Unknowns(
            splines=splines.reshape(self.basis.size, self.n_coordinates),
            harmonics=harmonics.reshape(self.harmonics.size, self.n_coordinates),
            frequency=float(frequency.sum()),
            shift=along + 1j * left,
        )

    def harmonic_values(self, unknowns: Unknowns) -> Float[np.ndarray, "n_frames n_functions"]:
        """Return the harmonics at the frames.

        Args:
            unknowns: Where the frequency is.
        """
        return self.harmonics.values(self.time, unknowns.frequency)

    def coordinates(self, unknowns: Unknowns) -> Float[np.ndarray, "n_frames n_coordinates"]:
        """Return the coordinates of the chain in every frame.

        Args:
            unknowns: The unknowns.
        """
        periodic = self.harmonic_values(unknowns) @ unknowns.harmonics
        return self.spline_values @ unknowns.splines + periodic

    def residuals(self, unknowns: Unknowns) -> Complex[np.ndarray, "n_frames n_points"]:
        """Return seen minus fitted places, 0 where a point was lost [m].

        Args:
            unknowns: The unknowns.
        """
        fitted = self.geometry.points(self.coordinates(unknowns), unknowns.shift)
        return np.where(self.is_seen, self.observed - fitted, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Linearized:
    """A `FilmModel` about given unknowns: real derivatives of all places, x of every point before y."""

    model: FilmModel
    """The model."""
    by_coordinate: Float[np.ndarray, "n_frames n_numbers n_coordinates"]
    """Derivatives by the coordinates in the same frame."""
    by_extra: Float[np.ndarray, "n_frames n_numbers n_extra"]
    """Derivatives by frequency and shifts of points."""
    harmonic_values: Float[np.ndarray, "n_frames n_functions"]
    """Harmonics at the frames."""

    @classmethod
    def of(cls, model: FilmModel, unknowns: Unknowns) -> "Linearized":
        """Return the model about given unknowns.

        Args:
            model: The model.
            unknowns: Where it is linearized.
        """
        coordinates = model.coordinates(unknowns)
        jacobian = model.geometry.jacobian(coordinates, unknowns.shift)
        n_frames, n_points, _ = jacobian.shape
        no_extra = np.zeros((n_frames, n_points, 0), dtype=complex)
        by_frequency = cls._by_frequency(model, unknowns, jacobian)
        by_shift = cls._by_shift(model, coordinates)
        by_extra = np.concatenate((no_extra, *by_frequency, *by_shift), axis=2)
        return cls(
            model=model,
            by_coordinate=np.concatenate((np.real(jacobian), np.imag(jacobian)), axis=1),
            by_extra=np.concatenate((np.real(by_extra), np.imag(by_extra)), axis=1),
            harmonic_values=model.harmonic_values(unknowns),
        )

    @staticmethod
    def _by_frequency(
        model: FilmModel,
        unknowns: Unknowns,
        jacobian: Complex[np.ndarray, "n_frames n_points n_coordinates"],
    ) -> list[np.ndarray]:
        """Return the derivatives of places by the frequency of the harmonics, if there are any."""
        if not model.n_frequencies:
            return []
        slopes = model.harmonics.slopes(model.time, unknowns.frequency) @ unknowns.harmonics
        return [np.matmul(jacobian, slopes[..., np.newaxis])]

    @staticmethod
    def _by_shift(
        model: FilmModel, coordinates: Float[np.ndarray, "n_frames n_coordinates"]
    ) -> list[np.ndarray]:
        """Return the derivatives of places by those shifts of points that are unknown: each moves its own point."""
        directions = model.geometry.directions(coordinates)
        along_link = directions[:, model.geometry.link]
        by_along = along_link[..., np.newaxis] * np.eye(model.n_points)
        derivatives: list[np.ndarray] = []
        if model.places.along_deviation > 0.0:
            derivatives.append(by_along)
        if model.places.left_deviation > 0.0:
            derivatives.append(1j * by_along)
        return derivatives

    def information(self, weight: Float[np.ndarray, "n_frames n_points"]) -> ArrowMatrix:
        """Return what the places say of the unknowns: J^T W J.

        Args:
            weight: Weight of every place [1/m^2].
        """
        root_weight = np.sqrt(np.tile(weight, 2))[..., np.newaxis]
        coordinate = root_weight * self.by_coordinate
        extra = root_weight * self.by_extra
        # Frame by frame: derivatives by two coordinates, and by a coordinate and an extra unknown.
        squares = _transposed(coordinate) @ coordinate
        cross = _transposed(coordinate) @ extra
        return ArrowMatrix(
            band=self._spline_band(squares),
            border=self._border(squares, cross),
            corner=self._corner(squares, cross, extra),
        )

    def _spline_band(self, squares: Float[np.ndarray, "n_frames m m"]) -> np.ndarray:
        """Return the band of the splines: blocks of coordinates for every two splines that overlap."""
        n_frames, m, _ = squares.shape
        flat = squares.reshape(n_frames, m * m)
        blocks: list[np.ndarray] = []
        for products in self.model.spline_products:
            blocks.append((products @ flat).reshape(-1, m, m))
        return fill_band(np.array(blocks))

    def _border(
        self,
        squares: Float[np.ndarray, "n_frames m m"],
        cross: Float[np.ndarray, "n_frames m n_extra"],
    ) -> Float[np.ndarray, "n_spline_unknowns n_border"]:
        """Return the border: splines with harmonics, and splines with extra unknowns."""
        n_frames, m, n_extra = cross.shape
        n_functions = self.harmonic_values.shape[1]
        n_splines = self.model.basis.size
        splines = self.model.spline_values
        flat = squares.reshape(n_frames, m * m)
        by_harmonic = self.harmonic_values[:, :, np.newaxis] * flat[:, np.newaxis, :]
        with_harmonics = splines.T @ by_harmonic.reshape(n_frames, n_functions * m * m)
        with_harmonics = with_harmonics.reshape(n_splines, n_functions, m, m)
        with_extra = splines.T @ cross.reshape(n_frames, m * n_extra)
        return np.concatenate(
            (
                # Rows are splines by coordinates, columns harmonics by coordinates.
                with_harmonics.transpose(0, 2, 1, 3).reshape(n_splines * m, n_functions * m),
                with_extra.reshape(n_splines * m, n_extra),
            ),
            axis=1,
        )

    def _corner(
        self,
        squares: Float[np.ndarray, "n_frames m m"],
        cross: Float[np.ndarray, "n_frames m n_extra"],
        extra: Float[np.ndarray, "n_frames n_numbers n_extra"],
    ) -> Float[np.ndarray, "n_border n_border"]:
        """Return the corner: harmonics and extra unknowns among themselves."""
        n_frames, m, n_extra = cross.shape
        values = self.harmonic_values
        n_functions = values.shape[1]
        n_harmonics = n_functions * m
        flat = squares.reshape(n_frames, m * m)
        of_functions = values[:, :, np.newaxis] * values[:, np.newaxis, :]
        harmonics = of_functions.reshape(n_frames, n_functions * n_functions).T @ flat
        harmonics = harmonics.reshape(n_functions, n_functions, m, m).transpose(0, 2, 1, 3)
        harmonics = harmonics.reshape(n_harmonics, n_harmonics)
        mixed = values.T @ cross.reshape(n_frames, m * n_extra)
        mixed = mixed.reshape(n_harmonics, n_extra)
        flat_extra = extra.reshape(n_frames * extra.shape[1], n_extra)
        return np.block([[harmonics, mixed], [mixed.T, flat_extra.T @ flat_extra]])

    def pull(
        self,
        weight: Float[np.ndarray, "n_frames n_points"],
        residual: Complex[np.ndarray, "n_frames n_points"],
    ) -> Float[np.ndarray, " n_all"]:
        """Return J^T W r: where the places pull the unknowns.

        Args:
            weight: Weight of every place [1/m^2].
            residual: Seen minus fitted places [m].
        """
        weighted_x = weight * np.real(residual)
        weighted_y = weight * np.imag(residual)
        numbers = np.concatenate((weighted_x, weighted_y), axis=1)
        by_frame = (numbers[:, np.newaxis, :] @ self.by_coordinate)[:, 0]
        by_extra = np.einsum("fk,fkc->c", numbers, self.by_extra)
        of_splines = self.model.spline_values.T @ by_frame
        of_harmonics = self.harmonic_values.T @ by_frame
        return np.concatenate((of_splines.ravel(), of_harmonics.ravel(), by_extra))

    def spread_of_places(
        self, changes: Float[np.ndarray, "n_all n_draws"]
    ) -> Float[np.ndarray, "n_frames n_points"]:
        """Return the mean square by which draws move every place, both axes together [m^2].

        Args:
            changes: Changes of the unknowns, a draw in every column.
        """
        model = self.model
        m = model.n_coordinates
        n_draws = changes.shape[1]
        end_of_splines = model.basis.size * m
        end_of_harmonics = end_of_splines + model.harmonics.size * m
        splines = changes[:end_of_splines].reshape(model.basis.size, m * n_draws)
        harmonics = changes[end_of_splines:end_of_harmonics]
        harmonics = harmonics.reshape(model.harmonics.size, m * n_draws)
        coordinates = model.spline_values @ splines + self.harmonic_values @ harmonics
        numbers = self.by_coordinate @ coordinates.reshape(-1, m, n_draws)
        numbers += self.by_extra @ changes[end_of_harmonics:]
        squares = np.mean(numbers**2, axis=2)
        return squares[:, : model.n_points] + squares[:, model.n_points :]


def _transposed(stack: np.ndarray) -> np.ndarray:
    return np.swapaxes(stack, 1, 2)


@dataclass(frozen=True, kw_only=True, eq=False)
class Prior:
    """What is known of the unknowns beforehand, with given weights."""

    model: FilmModel
    """The model."""
    weights: Weights
    """Strengths."""

    @cached_property
    def _bend_precision(self) -> Float[np.ndarray, " n_coordinates"]:
        precision = np.zeros(self.model.n_coordinates)
        precision[N_ROOT:] = self.weights.bend_deviation**-2
        return precision

    @cached_property
    def _border_precision(self) -> Float[np.ndarray, " n_border"]:
        model = self.model
        parts: list[Sequence[float] | np.ndarray] = [
            self.weights.harmonic_deviation.ravel() ** -2.0,
            self._frequency_precision,
        ]
        for deviation in model.shift_deviations:
            parts.append(np.full(model.n_points, deviation**-2.0))
        return np.concatenate(parts)

    @property
    def _frequency_precision(self) -> Float[np.ndarray, " n_frequencies"]:
        precision = self.model.harmonics.frequency_deviation**-2.0
        return np.full(self.model.n_frequencies, precision)

    def added_to(self, information: ArrowMatrix) -> ArrowMatrix:
        """Return the information with that of the prior.

        Args:
            information: What the film says.
        """
        m = self.model.n_coordinates
        band = information.band.copy()
        roughness = self.model.basis.roughness
        for offset in range(DEGREE + 1):
            diagonal = roughness.diagonal(-offset)
            added = np.outer(diagonal, self.weights.roughness).ravel()
            band[offset * m, : added.size] += added
        band[0] += np.tile(self._bend_precision, self.model.basis.size)
        corner = information.corner + np.diag(self._border_precision)
        return ArrowMatrix(band=band, border=information.border, corner=corner)

    def pull(self, unknowns: Unknowns) -> Float[np.ndarray, " n_all"]:
        """Return where the prior pulls the unknowns: minus its gradient.

        Args:
            unknowns: Where they are.
        """
        splines = self.model.basis.roughness @ unknowns.splines * self.weights.roughness
        splines += self._bend_precision * unknowns.splines
        border = self._border_precision * self._border(unknowns)
        return -np.concatenate((splines.ravel(), border))

    def log_density(self, unknowns: Unknowns) -> float:
        """Return the logarithm of the prior's density, but for what no weight changes.

        Args:
            unknowns: Where it is asked for.
        """
        return 0.5 * float(self._log_precision() - self._squares(unknowns))

    def _log_precision(self) -> float:
        """Return the logarithm of the determinant of the precision, but for what no weight changes."""
        basis = self.model.basis
        of_root = self.weights.roughness[:N_ROOT]
        of_joints = np.outer(self.weights.roughness[N_ROOT:], basis.roughness_sizes)
        logarithm = basis.n_penalized * np.sum(np.log(of_root))
        logarithm += np.sum(np.log(of_joints + self.weights.bend_deviation**-2))
        logarithm -= 2.0 * np.sum(np.log(self.weights.harmonic_deviation))
        return logarithm

    def _squares(self, unknowns: Unknowns) -> float:
        """Return the sum of squares of all unknowns, each by its deviation."""
        splines = unknowns.splines
        rough = np.sum(splines * (self.model.basis.roughness @ splines), axis=0)
        bends = np.sum(self._bend_precision * splines**2)
        border = self._border(unknowns)
        squares = np.sum(self.weights.roughness * rough) + bends
        squares += np.sum(self._border_precision * border**2)
        return squares

    def _border(self, unknowns: Unknowns) -> Float[np.ndarray, " n_border"]:
        """Return the unknowns of the border, the frequency as its distance from the first guess."""
        model = self.model
        difference = unknowns.frequency - model.harmonics.frequency
        frequencies = np.full(model.n_frequencies, difference)
        parts = [unknowns.harmonics.ravel(), frequencies]
        if model.places.along_deviation > 0.0:
            parts.append(np.real(unknowns.shift))
        if model.places.left_deviation > 0.0:
            parts.append(np.imag(unknowns.shift))
        return np.concatenate(parts)
