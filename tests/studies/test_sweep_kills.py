"""A slice of campaigns/sweep_kills.py: a sweep that is killed loses nothing."""

from pathlib import Path

import pytest
from campaign_scripts import campaign

kills = campaign("sweep_kills")
SIZE = 20


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("whole") / "a"
    kills.run_sweep(kills.sweep(SIZE), folder, region_size=kills.REGION_SIZE)
    return kills.contents(folder)


def test_a_sweep_that_is_killed_comes_out_the_same_bit_for_bit(
    tmp_path: Path, expected: dict[str, bytes]
):
    assert kills.kill_at_moments(tmp_path / "a", SIZE, kills=1, seed=1) == 1
    assert kills.contents(tmp_path / "a") == expected


def test_so_does_one_that_is_killed_between_two_files(tmp_path: Path, expected: dict[str, bytes]):
    assert kills.kill_at_operations(tmp_path / "a", SIZE, kills=1, seed=1) == 1
    assert kills.contents(tmp_path / "a") == expected


def test_a_sweep_whose_worker_is_killed_comes_out_the_same(
    tmp_path: Path, expected: dict[str, bytes]
):
    assert kills.kill_workers(tmp_path / "a", SIZE, kills=1, seed=1) == 1
    assert kills.contents(tmp_path / "a") == expected
