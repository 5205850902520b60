"""Sweeps in shares: disjoint and complete, merged to the bits of a sweep in one go, and what is refused."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from studies.sweeps import GAIT, small

from laticauda.cli import main
from laticauda.studies import Grid, Rows, Share, merge_shares, open_sweep, run_sweep
from laticauda.studies.regions import divide_regions
from laticauda.studies.sharing import parse_share, region_size_for, regions_of_share
from laticauda.values import locked

POINTS = Grid(values={"gait.amplitude": [0.1, 0.2, 0.3, 0.4], "gait.frequency": [1.0, 1.5, 2.0]})


def sweep_of_12():
    return small(points=POINTS)


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        file.relative_to(folder).as_posix(): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


@given(st.integers(1, 400), st.integers(1, 50), st.integers(1, 20))
def test_every_region_belongs_to_exactly_one_share(n_points, size, count):
    regions = divide_regions((n_points,), size)
    shares = [Share(number=number, count=count) for number in range(1, count + 1)]
    taken = [index for share in shares for index in regions_of_share(share, regions)]
    assert sorted(taken) == list(range(regions.count))


def test_merged_shares_are_the_sweep_that_ran_in_one_go_file_by_file(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "whole", region_size=region_size_for(sweep, 3))
    for number in (3, 1, 2):
        run_sweep(sweep, tmp_path / "merged", share=Share(number=number, count=3))
    merged = merge_shares(sweep, tmp_path / "merged")
    assert (merged.n_done, merged.unfinished) == (12, ())
    assert files_of(tmp_path / "merged") == files_of(tmp_path / "whole")


def test_lists_of_points_are_shared_too(tmp_path: Path):
    sweep = small(points=Rows(values={"gait.amplitude": np.linspace(0.1, 0.4, 7)}))
    whole = run_sweep(sweep, tmp_path / "whole")
    for number in (1, 2):
        run_sweep(sweep, tmp_path / "merged", share=Share(number=number, count=2))
    results = merge_shares(sweep, tmp_path / "merged").results
    assert np.array_equal(results["gait.amplitude"], whole["gait.amplitude"])
    assert results.forward_velocity.to_numpy() == pytest.approx(whole.forward_velocity.to_numpy())


def test_what_is_missing_is_named_and_follows_later(tmp_path: Path):
    sweep = sweep_of_12()
    for number in (1, 4):
        run_sweep(sweep, tmp_path / "a", share=Share(number=number, count=4))
    merged = merge_shares(sweep, tmp_path / "a")
    assert [share.number for share in merged.unfinished] == [2, 3]
    assert merged.n_done == 6
    assert merged.results.attrs["n_finished"] == 6
    for number in (2, 3):
        run_sweep(sweep, tmp_path / "a", share=Share(number=number, count=4))
    assert merge_shares(sweep, tmp_path / "a").unfinished == ()


def test_a_sweep_that_was_merged_too_early_does_the_rest_itself(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "a", share=Share(number=1, count=2))
    merge_shares(sweep, tmp_path / "a")
    assert run_sweep(sweep, tmp_path / "a").attrs["n_finished"] == 12


def test_shares_that_run_at_the_same_time_in_processes_of_their_own_are_merged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    words = "sweep --duration 1 --vary amplitude-deg=10:50:4 frequency-deg-s=60,120 --output big"
    command = [sys.executable, "-m", "laticauda", *words.split()]
    shares = [
        subprocess.Popen([*command, "--share", f"{number}/2"], cwd=tmp_path) for number in (1, 2)
    ]
    assert [share.wait() for share in shares] == [0, 0]
    monkeypatch.chdir(tmp_path)
    assert main([*words.split(), "--merge"]) == 0
    assert capsys.readouterr().out.startswith("All 8 trials reached their end.")
    assert open_sweep(tmp_path / "big").attrs["n_finished"] == 8


# ---- what is refused -----------------------------------------------------------------------------


def test_a_folder_without_shares_beside_it_is_refused(tmp_path: Path):
    with pytest.raises(
        ValueError, match=r"must have shares beside it, such as a\.share-1-of-4, got .*/a without"
    ):
        merge_shares(sweep_of_12(), tmp_path / "a")


def test_shares_of_another_sweep_are_refused_with_the_difference(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "a", share=Share(number=1, count=2))
    other = small(points=POINTS, motion=replace(GAIT, offset=0.1))
    with pytest.raises(
        ValueError, match=r"a\.share-1-of-2 with another one: motion\.offset is nothing there"
    ):
        merge_shares(other, tmp_path / "a")


def test_a_share_that_is_still_being_written_is_refused(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "a", share=Share(number=1, count=2))
    with (
        locked(tmp_path / "a.share-1-of-2", wait=False),
        pytest.raises(ValueError, match=r"no other process is writing to, got .*a\.share-1-of-2"),
    ):
        merge_shares(sweep, tmp_path / "a")


def test_a_damaged_share_is_refused(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "a", share=Share(number=1, count=2))
    chunks = (tmp_path / "a.share-1-of-2/results.zarr/forward_velocity/c").rglob("*")
    chunk = next(path for path in chunks if path.is_file())
    content = bytearray(chunk.read_bytes())
    content[-6] ^= 1
    chunk.write_bytes(content)
    with pytest.raises(ValueError, match=r"readable `results\.zarr`, got .*a\.share-1-of-2"):
        merge_shares(sweep, tmp_path / "a")


def test_shares_of_other_regions_are_refused(tmp_path: Path):
    sweep = sweep_of_12()
    run_sweep(sweep, tmp_path / "a", share=Share(number=1, count=2), region_size=6)
    with pytest.raises(ValueError, match=r"give the `region_size` of the shares"):
        merge_shares(sweep, tmp_path / "a")


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("3", "must be NUMBER/COUNT, such as 3/16, got 3"),
        ("0/4", "must be between 1/4 and 4/4, got 0/4"),
        ("5/4", "must be between 1/4 and 4/4, got 5/4"),
        ("1/0", "must be"),
    ],
)
def test_a_share_that_cannot_be_is_refused(text, rule):
    with pytest.raises(ValueError, match=f"`share` {rule}"):
        parse_share(text)
    with pytest.raises(ValueError, match="`number` must be at most `count`, 4, got 5"):
        Share(number=5, count=4)
