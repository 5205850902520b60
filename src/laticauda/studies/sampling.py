"""Points of a sweep: a grid, rows of a list, or low-discrepancy samples.

The points are generated region by region from their indices, never all at once, so ten million
points take no more memory than one region.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias, cast

import numpy as np
from jaxtyping import Float

from laticauda.studies.regions import Block
from laticauda.values import (
    BadArgument,
    check_finite,
    check_instance,
    check_items,
    check_not_empty,
    option,
    optional_import,
    quantity,
    value_class,
)

Values = Float[np.ndarray, " n_values"]
Table = Float[np.ndarray, "n_points n_names"]

TRIAL = "trial"
"""The dimension of lists and samples."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Values:
    """Points given by their values."""

    values: Mapping[str, Any]
    """Values by name of the parameter, in the order of the result's dimensions (SI, radians)."""

    def __post_init__(self) -> None:
        """Check every value."""
        object.__setattr__(self, "values", _check_values(self.values))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the swept parameters."""
        return tuple(self.values)

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value of each parameter."""
        return {
            name: (float(np.min(values)), float(np.max(values)))
            for name, values in self.values.items()
        }


class Grid(_Values):
    """Every combination of the given values of the parameters.

    Raises:
        ValueError: If there is no parameter, or one has no values, a repeated value, or a value
            that is not finite.

    Example:
        >>> Grid(values={"gait.amplitude": [0.2, 0.4, 0.6], "gait.frequency": [1.0, 2.0]}).shape
        (3, 2)
    """

    def __post_init__(self) -> None:
        """Check every value, and that none is repeated."""
        super().__post_init__()
        for name, values in self.values.items():
            if len(set(values)) < len(values):
                raise BadArgument(
                    name, "must have different values in a grid, got one of them twice"
                )

    @property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of the result, one per parameter."""
        return self.names

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each parameter."""
        return tuple(len(values) for values in self.values.values())

    def tables(self, blocks: Iterable[Block], counts: Collection[str] = ()) -> Iterator[Table]:
        """Yield the points of each block, one per row, with the last parameter varying fastest.

        Args:
            blocks: Blocks with one slice per dimension.
            counts: Names of parameters that take whole numbers only; ignored, as the values of a
                grid are given.
        """
        arrays = [np.asarray(values) for values in self.values.values()]
        for block in blocks:
            axes: list[np.ndarray] = []
            for array, part in zip(arrays, block, strict=True):
                axes.append(array[part])
            grids = np.meshgrid(*axes, indexing="ij")
            columns = [grid.ravel() for grid in grids]
            yield np.stack(columns, axis=1)

    def definition(self) -> dict[str, Any]:
        """Return the definition of the points for a file."""
        numbers: dict[str, list[float]] = {}
        for name, values in self.values.items():
            numbers[name] = np.asarray(values).tolist()
        return {"kind": "grid", "values": numbers}


class Rows(_Values):
    """A list of points: row i takes value i of every parameter.

    Raises:
        ValueError: If there is no parameter, one has no values or a value that is not finite, or
            they have different numbers of values.
    """

    dims: ClassVar[tuple[str, ...]] = (TRIAL,)
    """The only dimension of the result."""

    def __post_init__(self) -> None:
        """Check every value, and that all parameters have the same number of values."""
        super().__post_init__()
        lengths = {name: len(values) for name, values in self.values.items()}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{length} of {name}" for name, length in lengths.items())
            raise BadArgument(
                "values", f"must have equally many values of every parameter, got {listed}"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points."""
        return (len(next(iter(self.values.values()))),)

    def tables(self, blocks: Iterable[Block], counts: Collection[str] = ()) -> Iterator[Table]:
        """Yield the points of each block, one per row.

        Args:
            blocks: Blocks of one slice each.
            counts: Names of parameters that take whole numbers only; ignored, as the values of a
                list are given.
        """
        columns = [np.asarray(values) for values in self.values.values()]
        for (rows,) in blocks:
            columns_of_block = [column[rows] for column in columns]
            yield np.stack(columns_of_block, axis=1)

    def definition(self) -> dict[str, Any]:
        """Return the definition of the points for a file: digests, as a list may be long."""
        import hashlib

        digests = {
            name: hashlib.sha256(np.asarray(values).tobytes())
            for name, values in self.values.items()
        }
        return {
            "kind": "rows",
            "n_points": self.shape[0],
            "sha256": {name: digest.hexdigest() for name, digest in digests.items()},
        }


def check_ranges_of_numbers(argument: str, ranges: Any) -> dict[str, tuple[float, float]]:
    """Check ranges, and return the smallest and largest value of each parameter.

    Args:
        argument: Name of the argument that they come from, for messages.
        ranges: Ranges as given, by name of parameter.

    Raises:
        ValueError: If there is none, or one is not a range.
    """
    check_instance(argument, ranges, Mapping)
    ends_by_name = cast("Mapping[str, Any]", ranges)
    check_not_empty(argument, ends_by_name, "parameter")
    checked: dict[str, tuple[float, float]] = {}
    for name, given_ends in ends_by_name.items():
        ends = check_items(check_finite, "a low and a high value", (), name, given_ends)
        if len(ends) != 2:
            raise BadArgument(
                argument, f"must be a low and a high value of `{name}`, got {len(ends)} numbers"
            )
        low, high = ends
        if not low < high:
            raise BadArgument(
                argument, f"must have low < high, got {low:g} and {high:g} for `{name}`"
            )
        checked[name] = low, high
    return checked


@value_class
class Samples:
    """Points that fill a box evenly: the scrambled Halton sequence.

    Unlike random numbers, they leave no gaps; unlike a grid, they sample every parameter at as many
    values as there are points. The first half of them is as even as the whole.

    References:
        A. B. Owen, A randomized Halton algorithm in R, arXiv:1706.02808, 2017; as in scipy.stats.qmc.

    Raises:
        ValueError: If there is no parameter, or a range, the number of points or the seed is
            invalid.
    """

    dims: ClassVar[tuple[str, ...]] = (TRIAL,)
    """The only dimension of the result."""
    ranges: Mapping[str, tuple[float, float]] = option(
        "Smallest and largest value by name (SI)", check=check_ranges_of_numbers
    )
    n_points: int = quantity("", "Number of points", ge=1)
    seed: int = quantity(
        "", "Seed of the scrambling; another one gives other points", ge=0, default=0
    )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the swept parameters."""
        return tuple(self.ranges)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points."""
        return (self.n_points,)

    def tables(self, blocks: Iterable[Block], counts: Collection[str] = ()) -> Iterator[Table]:
        """Yield the points of each block, one per row.

        Args:
            blocks: Blocks of one slice each, in ascending order: going back would require starting
                over.
            counts: Names of parameters that take whole numbers only.
        """
        qmc = optional_import("A sweep over samples", "scipy", "scale", "scipy.stats.qmc")
        engine = qmc.Halton(len(self.ranges), scramble=True, rng=self.seed)
        n_drawn = 0
        for (rows,) in blocks:
            if rows.start > n_drawn:
                engine.fast_forward(rows.start - n_drawn)
            drawn: Table = engine.random(rows.stop - rows.start)
            n_drawn = rows.stop
            yield self._in_ranges(drawn, counts)

    def _in_ranges(self, drawn: Table, counts: Collection[str]) -> Table:
        """Return points of the unit cube as points of the ranges."""
        ends: Table = np.array(list(self.ranges.values()))
        low = ends[:, 0]
        high = ends[:, 1]
        span = high - low
        # Every whole number in the range has an equal share.
        steps = np.floor(drawn * (span + 1.0))
        counted = low + np.minimum(steps, span)
        measured = low + drawn * span
        is_count = np.array([name in counts for name in self.ranges])
        return np.where(is_count, counted, measured)

    def definition(self) -> dict[str, Any]:
        """Return the definition of the points for a file."""
        return {
            "kind": "samples",
            "ranges": {name: list(limits) for name, limits in self.ranges.items()},
            "n_points": self.n_points,
            "seed": self.seed,
        }


Points: TypeAlias = Grid | Rows | Samples


def _check_values(values: Mapping[str, Any]) -> dict[str, Values]:
    """Return the values of every parameter as an array that cannot be written to."""
    check_instance("values", values, Mapping)
    check_not_empty("values", values, "parameter")
    arrays: dict[str, Values] = {}
    for name, numbers in values.items():
        array = np.array(check_items(check_finite, "a list of numbers", (), name, numbers))
        check_not_empty(name, array, "value")
        array.setflags(write=False)
        arrays[name] = array
    return arrays
