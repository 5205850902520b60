import itertools
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.studies import Grid, Rows, Samples
from laticauda.studies.regions import block_shape, divide_regions

BOX = {"gait.amplitude": (0.2, 0.8), "robot.n_links": (5.0, 8.0), "water.normal_drag": (1.0, 2.0)}


@given(shape=st.lists(st.integers(1, 12), min_size=1, max_size=4), size=st.integers(1, 50))
def test_regions_cover_every_point_once(shape: list[int], size: int):
    regions = divide_regions(tuple(shape), size)
    seen = np.zeros(shape, dtype=int)
    for index in range(regions.count):
        seen[regions.at(index)] += 1
        assert regions.n_points(index) == np.prod(block_shape(regions.at(index))) <= size
    assert np.all(seen == 1)


def test_regions_are_whole_rows_in_nearly_equal_pieces():
    assert divide_regions((100, 100, 100), 4096).block == (1, 34, 100)
    assert divide_regions((10_000_000,), 4096).block == (4096,)


def points_of(points: Grid | Rows | Samples, size: int, **how) -> np.ndarray:
    regions = divide_regions(points.shape, size)
    table = np.full((*points.shape, len(points.names)), np.nan)
    blocks = list(map(regions.at, range(regions.count)))
    for block, part in zip(blocks, points.tables(blocks, **how), strict=True):
        table[block] = part.reshape(*block_shape(block), -1)
    return table.reshape(-1, len(points.names))


def test_a_grid_is_every_combination_whatever_the_regions():
    values = {"a": [1.0, 2.0, 3.0], "b": [4.0, 5.0], "c": [6.0, 7.0, 8.0, 9.0]}
    expected = np.array(list(itertools.product(*values.values())))
    for size in (1, 3, 5, 100):
        assert np.array_equal(points_of(Grid(values=values), size), expected)


def test_rows_are_taken_side_by_side():
    rows = Rows(values={"a": [1.0, 2.0, 3.0], "b": [6.0, 5.0, 4.0]})
    assert np.array_equal(points_of(rows, 2), [[1.0, 6.0], [2.0, 5.0], [3.0, 4.0]])


@pytest.mark.parametrize("size", [1, 7, 64])
def test_samples_do_not_depend_on_the_regions(size: int):
    samples = Samples(ranges=BOX, n_points=64, seed=3)
    assert np.array_equal(points_of(samples, size), points_of(samples, 1000))


def test_samples_are_the_same_when_regions_are_left_out():
    samples = Samples(ranges=BOX, n_points=50, seed=3)
    (late,) = samples.tables([(slice(40, 50),)])
    assert np.array_equal(late, points_of(samples, 50)[40:])


def test_samples_fill_their_box_more_evenly_than_random_numbers():
    from scipy.stats import qmc

    unit = (points_of(Samples(ranges=BOX, n_points=256), 256) - [0.2, 5.0, 1.0]) / [0.6, 3.0, 1.0]
    assert 0.0 <= unit.min() and unit.max() <= 1.0
    random = [qmc.discrepancy(np.random.default_rng(seed).random((256, 3))) for seed in range(10)]
    assert qmc.discrepancy(unit) < 0.2 * min(random)


def test_another_seed_gives_other_samples():
    one, other = (points_of(Samples(ranges=BOX, n_points=9, seed=seed), 9) for seed in (0, 1))
    assert not np.any(one == other)


def test_whole_numbers_have_equal_shares_of_the_samples():
    table = points_of(Samples(ranges=BOX, n_points=400), 400, counts=["robot.n_links"])
    found, shares = np.unique(table[:, 1], return_counts=True)
    assert found.tolist() == [5.0, 6.0, 7.0, 8.0]
    assert np.all(abs(shares - 100) <= 4)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Grid(values={}), "`values` must hold at least one parameter, got none"),
        (
            lambda: Grid(values={"gait.offset": []}),
            "`gait.offset` must hold at least one value, got none",
        ),
        (
            lambda: Grid(values={"gait.offset": 0.1}),
            "`gait.offset` must be a list of numbers, got 0.1",
        ),
        (
            lambda: Grid(values={"gait.offset": "12"}),
            "`gait.offset` must be a list of numbers, got '12'",
        ),
        (
            lambda: Grid(values={"gait.offset": [0.1, "x"]}),
            r"`gait.offset\[1\]` must be a number, got 'x'",
        ),
        (
            lambda: Grid(values={"gait.offset": [0.1, np.nan]}),
            r"`gait.offset\[1\]` must be a finite number, got nan",
        ),
        (
            lambda: Grid(values={"gait.offset": [0.1, 0.1]}),
            "`gait.offset` must have different values in a grid",
        ),
        (
            lambda: Rows(values={"a": [1, 2], "b": [1]}),
            "equally many values of every parameter, got 2 of a, 1 of b",
        ),
        (
            lambda: Samples(ranges={}, n_points=3),
            "`ranges` must hold at least one parameter, got none",
        ),
        (
            lambda: Samples(ranges={"a": (2, 1)}, n_points=3),
            "`ranges` must have low < high, got 2 and 1 for `a`",
        ),
        (lambda: Samples(ranges=BOX, n_points=0), "`n_points` must be a whole number >= 1, got 0"),
        (
            lambda: Samples(ranges=BOX, n_points=1, seed=-1),
            "`seed` must be a whole number >= 0, got -1",
        ),
    ],
)
def test_points_that_make_no_sense_are_refused(make, message: str):
    with pytest.raises(ValueError, match=message):
        make()


def test_values_that_are_no_mapping_are_refused_where_nobody_checks_types():
    code = "from laticauda.studies import Grid; Grid(values=[0.1])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.endswith("BadArgument: `values` must be of class Mapping, got list.\n")
