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
    seen: Bool[np.ndarray, "n_frames n_points"]
    """Where a point was seen."""
    observed: Complex[np.ndarray, "n_frames n_points"]
    """Where it was seen; 0 where it was lost [m]."""
    basis: SplineBasis
    """The splines."""
    harmonics: Harmonics
    """The harmonics."""

    @cached_property
    def spline_values(self) -> Any:
        """The splines at the frames, sparse."""
        return self.basis.matrix(self.time)

    @cached_property
    def spline_products(self) -> list[Any]:
        """Products of two splines at the frames by their distance, each as a sparse matrix of splines and frames."""
        sparse = load_scipy("sparse")
        padded = self.spline_values.toarray()
        products: list[Any] = []
        for offset in range(DEGREE + 1):
            ahead = np.zeros_like(padded)
            ahead[:, : padded.shape[1] - offset] = padded[:, offset:]
            products.append(sparse.csr_array((padded * ahead).T))
        return products

    @property
    def n_coordinates(self) -> int:
        """Number of coordinates of the chain."""
        return self.geometry.n_coordinates

    @property
    def n_points(self) -> int:
        """Number of points."""
        return self.seen.shape[1]

    def split(self, vector: Float[np.ndarray, " n_all"]) -> Unknowns:
        """Return the parts of one vector of unknowns, or of a change of them.

        Args:
            vector: The vector.
        """
        m = self.n_coordinates
        sizes = [self.basis.size * m, self.harmonics.size * m, min(self.harmonics.size, 1)]
        splines, harmonics, frequency, shifts = np.split(vector, np.cumsum(sizes))
        along, left = np.zeros(self.n_points), np.zeros(self.n_points)
        if self.places.along_deviation > 0.0:
            along = shifts[: self.n_points]
        if self.places.left_deviation > 0.0:
            left = shifts[-self.n_points :]
        return Unknowns(
            splines=splines.reshape(-1, m),
            harmonics=harmonics.reshape(self.harmonics.size, m),
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
        return np.where(self.seen, self.observed - fitted, 0.0)


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
        geometry, places = model.geometry, model.places
        coordinates = model.coordinates(unknowns)
        jacobian = geometry.jacobian(coordinates, unknowns.shift)
        extra: list[np.ndarray] = []
        if model.harmonics.size:
            slopes = model.harmonics.slopes(model.time, unknowns.frequency) @ unknowns.harmonics
            extra.append(np.matmul(jacobian, slopes[..., np.newaxis]))
        along_link = geometry.directions(coordinates)[:, geometry.link]
        own = along_link[..., np.newaxis] * np.eye(model.n_points)
        if places.along_deviation > 0.0:
            extra.append(own)
        if places.left_deviation > 0.0:
            extra.append(1j * own)
        border = np.zeros((*jacobian.shape[:2], 0), dtype=complex)
        border = np.concatenate([border, *extra], axis=2)
        return cls(
            model=model,
            by_coordinate=np.concatenate((np.real(jacobian), np.imag(jacobian)), axis=1),
            by_extra=np.concatenate((np.real(border), np.imag(border)), axis=1),
            harmonic_values=model.harmonic_values(unknowns),
        )

    def information(self, weight: Float[np.ndarray, "n_frames n_points"]) -> ArrowMatrix:
        """Return what the places say of the unknowns: J^T W J.

        Args:
            weight: Weight of every place [1/m^2].
        """
        model, m = self.model, self.model.n_coordinates
        n_frames = len(weight)
        root = np.sqrt(np.tile(weight, 2))[..., np.newaxis]
        coordinate, extra = root * self.by_coordinate, root * self.by_extra
        per_frame = _transposed(coordinate) @ coordinate
        flat = per_frame.reshape(n_frames, m * m)
        blocks = [(products @ flat).reshape(-1, m, m) for products in model.spline_products]
        cross = _transposed(coordinate) @ extra
        values, splines = self.harmonic_values, model.spline_values
        n_functions, n_extra = values.shape[1], extra.shape[2]
        tied = values[:, :, np.newaxis] * flat[:, np.newaxis, :]
        with_harmonics = splines.T @ tied.reshape(n_frames, n_functions * m * m)
        with_extra = splines.T @ cross.reshape(n_frames, m * n_extra)
        n_splines = model.basis.size
        by_harmonic = with_harmonics.reshape(n_splines, n_functions, m, m).transpose(0, 2, 1, 3)
        n = n_splines * m
        border = np.concatenate(
            (by_harmonic.reshape(n, n_functions * m), with_extra.reshape(n, n_extra)), axis=1
        )
        squares = values[:, :, np.newaxis] * values[:, np.newaxis, :]
        corner_1 = squares.reshape(n_frames, n_functions * n_functions).T @ flat
        corner_1 = corner_1.reshape(n_functions, n_functions, m, m).transpose(0, 2, 1, 3)
        corner_1 = corner_1.reshape(n_functions * m, n_functions * m)
        corner_2 = values.T @ cross.reshape(n_frames, m * n_extra)
        corner_2 = corner_2.reshape(n_functions * m, n_extra)
        all_extra = extra.reshape(extra.shape[0] * extra.shape[1], n_extra)
        corner = np.block([[corner_1, corner_2], [corner_2.T, all_extra.T @ all_extra]])
        return ArrowMatrix(band=fill_band(np.array(blocks)), border=border, corner=corner)

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
        numbers = np.concatenate((weight * np.real(residual), weight * np.imag(residual)), axis=1)
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
        model, m = self.model, self.model.n_coordinates
        n_splines, n_harmonics = model.basis.size * m, model.harmonics.size * m
        n_draws = changes.shape[1]
        splines = changes[:n_splines].reshape(model.basis.size, m * n_draws)
        harmonics = changes[n_splines : n_splines + n_harmonics]
        harmonics = harmonics.reshape(model.harmonics.size, m * n_draws)
        moved = model.spline_values @ splines + self.harmonic_values @ harmonics
        numbers = self.by_coordinate @ moved.reshape(-1, m, n_draws)
        numbers += self.by_extra @ changes[n_splines + n_harmonics :]
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
        for deviation in (model.places.along_deviation, model.places.left_deviation):
            if deviation > 0.0:
                parts.append(np.full(model.n_points, deviation**-2.0))
        return np.concatenate(parts)

    @property
    def _frequency_precision(self) -> Float[np.ndarray, " n_frequencies"]:
        harmonics = self.model.harmonics
        return np.full(min(harmonics.size, 1), harmonics.frequency_deviation**-2.0)

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
        return -np.concatenate((splines.ravel(), self._border_precision * self._border(unknowns)))

    def log_density(self, unknowns: Unknowns) -> float:
        """Return the logarithm of the prior's density, but for what no weight changes.

        Args:
            unknowns: Where it is asked for.
        """
        splines, basis = unknowns.splines, self.model.basis
        rough = np.sum(splines * (basis.roughness @ splines), axis=0)
        bends = np.sum(self._bend_precision * splines**2)
        border = self._border(unknowns)
        squares = np.sum(self.weights.roughness * rough) + bends
        squares += np.sum(self._border_precision * border**2)
        logarithms = basis.n_penalized * np.sum(np.log(self.weights.roughness[:N_ROOT]))
        precision = np.outer(self.weights.roughness[N_ROOT:], basis.roughness_sizes)
        logarithms += np.sum(np.log(precision + self.weights.bend_deviation**-2))
        logarithms -= 2.0 * np.sum(np.log(self.weights.harmonic_deviation))
        return 0.5 * float(logarithms - squares)

    def _border(self, unknowns: Unknowns) -> Float[np.ndarray, " n_border"]:
        """Return the unknowns of the border, the frequency as its distance from the first guess."""
        model = self.model
        difference = unknowns.frequency - model.harmonics.frequency
        frequencies = np.full(min(model.harmonics.size, 1), difference)
        parts = [unknowns.harmonics.ravel(), frequencies]
        if model.places.along_deviation > 0.0:
            parts.append(np.real(unknowns.shift))
        if model.places.left_deviation > 0.0:
            parts.append(np.imag(unknowns.shift))
        return np.concatenate(parts)
