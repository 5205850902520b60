"""Faults of a Dask cluster. A killed worker is in test_sweep_kills."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from studies.sweeps import small

from laticauda.models.simulate import cluster
from laticauda.studies import open_sweep, run_sweep
from laticauda.values.errors import ClusterFailed

CLUSTER = """\
import asyncio, distributed
async def work():
    async with distributed.Scheduler(port=0, host="127.0.0.1", dashboard_address=":0") as scheduler:
        if {n_workers}:
            worker = await distributed.Worker(scheduler.address, nthreads=1, dashboard_address=":0")
        print(scheduler.address, flush=True)
        await scheduler.finished()
asyncio.run(work())
"""


@contextmanager
def started(n_workers: int) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """A scheduler in a process of its own, with a worker or without, and its address."""
    words = [sys.executable, "-c", CLUSTER.format(n_workers=n_workers)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert process.stdout is not None
    try:
        yield process, process.stdout.readline().strip()
    finally:
        process.kill()
        process.wait(30)
        process.stdout.close()


def test_a_scheduler_that_goes_away_is_an_error_and_costs_nothing(tmp_path: Path):
    with started(n_workers=1) as (process, address):
        client = cluster.connect(address)

        def lose(done: int, total: int) -> None:
            if done >= 4:
                process.kill()
                process.wait(30)

        message = r"the Dask scheduler went away\. Stored results are not lost: run the same"
        with pytest.raises(ClusterFailed, match=message):
            run_sweep(small(), tmp_path / "a", client=client, region_size=2, progress=lose)
        client.close(timeout=1)
    assert 4 <= open_sweep(tmp_path / "a").n_finished < 12
    run_sweep(small(), tmp_path / "whole", region_size=2)
    assert run_sweep(small(), tmp_path / "a").identical(open_sweep(tmp_path / "whole"))


def test_a_cluster_without_workers_is_said_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(cluster, "NO_WORKER_TIMEOUT", 0.1)
    monkeypatch.setattr(cluster, "HEALTH_INTERVAL", 0.05)
    with started(n_workers=0) as (_, address):
        client = cluster.connect(address)
        message = r"the cluster had no worker for 0\.1 s; start some with `dask worker`"
        with pytest.raises(ClusterFailed, match=message):
            run_sweep(small(), tmp_path / "a", client=client)
        client.close(timeout=1)


class LostOnce:
    """A future whose result dies with its worker before it is fetched, and is there later."""

    def __init__(self, value: object, losses: int) -> None:
        self.value, self.losses = value, losses

    def add_done_callback(self, call) -> None:
        call(self)

    def result(self, timeout: float) -> object:
        self.losses -= 1
        if self.losses >= 0:
            raise TimeoutError
        return self.value


class Losing:
    """A client whose workers lose every result a few times."""

    status = "running"

    def __init__(self, losses: int, threads: int = 2) -> None:
        self.losses, self.threads = losses, threads

    def submit(self, work, *arguments, pure: bool, key: str) -> LostOnce:
        return LostOnce(work(*arguments), self.losses)

    def nthreads(self) -> dict[str, int]:
        return {"one": self.threads} if self.threads else {}

    def cancel(self, futures, force: bool) -> None:
        self.cancelled = len(futures)


def test_a_result_that_is_lost_with_its_worker_is_waited_for(tmp_path: Path):
    found = run_sweep(small(), tmp_path / "a", client=Losing(losses=3), region_size=4)
    assert found.identical(run_sweep(small(), tmp_path / "whole", region_size=4))


def test_it_is_not_waited_for_when_no_worker_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(cluster, "NO_WORKER_TIMEOUT", 0.01)
    client = Losing(losses=10**9, threads=0)
    with pytest.raises(ClusterFailed, match="the cluster had no worker"):
        run_sweep(small(), tmp_path / "a", client=client, region_size=4)
    assert client.cancelled == 1


def test_workers_of_another_version_are_refused():
    with pytest.raises(
        ClusterFailed, match=r"the workers must have laticauda 0\.0\.0, as this process does, got "
    ):
        cluster._call_on_worker("0.0.0", len, ((),))


@pytest.mark.parametrize("address", ["nowhere", "tcp://127.0.0.1:1"])
def test_an_address_without_a_scheduler_is_said_so(address: str):
    with pytest.raises(
        ClusterFailed, match=f"no Dask scheduler answers at {address}; is it running"
    ):
        cluster.connect(address)
