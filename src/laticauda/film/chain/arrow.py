"""Equations of one fit: a band, because a spline meets its neighbors alone, with a border of what meets all.

The matrix is ((A, B), (B^T, C)): A is banded, of the splines' coefficients knot by knot; B and C belong
to harmonics, frequency and places of points. With the Cholesky factors L L^T = A and R R^T = C - Y^T Y,
Y = L^-1 B, a solution and a random draw with the inverse as covariance cost no more than two sweeps.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.scipy_parts import load_scipy


class ArrowMatrix(NamedTuple):
    """A symmetric matrix: a band and its border."""

    band: Float[np.ndarray, "n_diagonals n"]
    """Lower diagonals of A, the main one first."""
    border: Float[np.ndarray, "n n_border"]
    """B."""
    corner: Float[np.ndarray, "n_border n_border"]
    """C."""

    def factor(self) -> "ArrowFactor":
        """Return its Cholesky factor.

        Raises:
            numpy.linalg.LinAlgError: If the matrix is not positive definite.
        """
        linalg = load_scipy("linalg")
        lower = linalg.cholesky_banded(self.band, lower=True)
        behind = _solve_lower(lower, self.border)
        corner = self.corner - behind.T @ behind
        if corner.size:
            corner = linalg.cholesky(corner, lower=True)
        return ArrowFactor(lower=lower, behind=behind, corner=corner)


@dataclass(frozen=True, kw_only=True, eq=False)
class ArrowFactor:
    """Cholesky factor of an `ArrowMatrix`."""

    lower: Float[np.ndarray, "n_diagonals n"]
    """L, as lower diagonals."""
    behind: Float[np.ndarray, "n n_border"]
    """Y."""
    corner: Float[np.ndarray, "n_border n_border"]
    """R."""

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the matrix."""
        diagonals = np.concatenate((self.lower[0], np.diag(self.corner)))
        return 2.0 * float(np.sum(np.log(diagonals)))

    def solve(self, right: Float[np.ndarray, "n_all n_columns"]) -> np.ndarray:
        """Return the solution for right-hand sides in columns, those of the border last.

        Args:
            right: The right-hand sides.
        """
        n = self.lower.shape[1]
        inner = _solve_lower(self.lower, right[:n])
        outer = self._solve_corner(right[n:] - self.behind.T @ inner, "N")
        return self.whiten_back(np.concatenate((inner, outer)))

    def whiten_back(self, white: Float[np.ndarray, "n_all n_columns"]) -> np.ndarray:
        """Return vectors whose covariance is the inverse of the matrix.

        Args:
            white: Independent standard normal numbers in columns.
        """
        n = self.lower.shape[1]
        outer = self._solve_corner(white[n:], "T")
        inner = _solve_upper(self.lower, white[:n] - self.behind @ outer)
        return np.concatenate((inner, outer))

    def _solve_corner(self, right: np.ndarray, trans: Literal["N", "T"]) -> np.ndarray:
        """Return R^-1 or R^-T times columns."""
        if self.corner.size == 0:
            return right
        solve_triangular = load_scipy("linalg").solve_triangular
        return np.asarray(solve_triangular(self.corner, right, lower=True, trans=trans))


def _solve_lower(lower: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return L^-1 times columns."""
    if right.shape[1] == 0:
        return right  # LAPACK must not see an empty array
    solution, _ = load_scipy("linalg.lapack").dtbtrs(lower, right, uplo="L", trans="N")
    return np.asarray(solution)


def _solve_upper(lower: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return L^-T times columns."""
    solution, _ = load_scipy("linalg.lapack").dtbtrs(lower, right, uplo="L", trans="T")
    return np.asarray(solution)


def fill_band(blocks: Float[np.ndarray, "n_offsets n_knots m m"]) -> Float[np.ndarray, "n_diag n"]:
    """Return the lower diagonals of a matrix of blocks.

    Args:
        blocks: Block (k + a, k) by the offset a from the diagonal, then k; blocks beyond the last row
            are not read.
    """
    n_offsets, n_knots, m, _ = blocks.shape
    band = np.zeros((n_offsets * m, n_knots * m))
    columns = np.array([[m * k] for k in range(n_knots)])
    for offset in range(n_offsets):
        n_blocks = n_knots - offset
        for q in range(m):
            first = 0
            if offset == 0:
                first = q  # a block on the diagonal is stored from there on
            begin = offset * m - q
            diagonals = np.array(range(begin + first, begin + m))
            band[diagonals, columns[:n_blocks] + q] = blocks[offset, :n_blocks, first:, q]
    return band
