"""An identification whose trials run on the workers of a cluster."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from clusters import worker_processes
from identify.trials import DRAG, FRICTION, ROBOT, WATER, gaits, speeds

import laticauda as lc
from laticauda.identify import Measurement, fit
from laticauda.identify.tasks import Task
from laticauda.identify.unknowns import as_unknowns
from laticauda.identify.validation import validate
from laticauda.values.errors import ClusterFailed


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """A client of a cluster whose two workers are processes of their own."""
    from distributed import Client

    with worker_processes(2) as address, Client(address, set_as_default=False) as client:
        yield client


def paths() -> list[Measurement]:
    """Paths of different durations, in groups, each with a start of its own to identify."""
    measurements: list[Measurement] = []
    for i, gait in enumerate(gaits(5)):
        duration = 4.0 + i % 2
        trial = lc.swim(ROBOT, gait, duration, environment=WATER)
        time = np.arange(0.0, duration, 0.5)
        path = trial.center_of_mass[::10][: time.size]
        noise = 0.003 * np.random.default_rng(i).standard_normal(path.shape)
        measurements.append(
            Measurement(
                name=f"trial {i}",
                scenario=lc.build_scenario(ROBOT, gait, duration, environment=WATER),
                time=time,
                series={"center_of_mass": (path + noise, 0.003)},
                group=f"day {i % 2}",
            )
        )
    return measurements


def check_same_bits(found: Any, expected: Any) -> None:
    for name in ("best", "covariance", "correlations", "predictions", "widening"):
        values = (getattr(found, name), getattr(expected, name))
        assert np.array_equal(*values, equal_nan=True), name
    assert [search.cost for search in found.searches] == [
        search.cost for search in expected.searches
    ]
    assert (found.chi2, found.doubt, found.warnings) == (
        expected.chi2,
        expected.doubt,
        expected.warnings,
    )


@pytest.mark.parametrize("joints", ["prescribed", "pd"])
def test_speeds_are_fitted_on_a_cluster_to_the_same_bits(client: Any, joints: str):
    measurements = speeds(11, noise=0.002, duration=4.0, joints=joints)
    options: Any = {"parameters": [FRICTION, DRAG], "joints": joints, "n_starts": 2}
    here = fit(measurements, threads=1, **options)
    check_same_bits(fit(measurements, client=client, **options), here)


def test_the_twin_in_space_is_fitted_on_a_cluster_to_the_same_bits(client: Any):
    measurements = speeds(3, noise=0.002, duration=2.0)
    options: Any = {"parameters": [FRICTION], "model": "spatial", "n_starts": 1}
    here = fit(measurements, threads=1, **options)
    check_same_bits(fit(measurements, client=client, **options), here)


def test_refits_run_on_the_cluster_too_and_the_fit_outlives_it(client: Any):
    task = Task(
        name="paths",
        title="paths",
        measurements=tuple(paths()),
        unknowns=as_unknowns([FRICTION]),
        options={"n_starts": 1},
    )
    there = validate(task, task.run(client=client), profiles=True, client=client)
    here = validate(task, task.run(threads=1), profiles=True)
    check_same_bits(there.fit, here.fit)
    assert np.array_equal(there.left_out, here.left_out)
    assert there.by_group is not None and here.by_group is not None
    assert np.array_equal(there.by_group.predictions, here.by_group.predictions)
    assert there.profiles == here.profiles
    assert there.fit.problem.client is None
    assert there.by_group.fit.problem.client is None


def test_a_scheduler_that_went_away_ends_the_identification():
    class Closed:
        status = "closed"

    message = "the Dask scheduler went away. An identification cannot be resumed: run the same"
    with pytest.raises(ClusterFailed, match=message):
        fit(speeds(3, duration=2.0), parameters=[FRICTION], client=Closed())
