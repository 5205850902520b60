"""Campaigns: killed at any byte, in shares, on a cluster, always the same table; and what is refused."""

import subprocess
import sys
from dataclasses import replace

import pytest
from clusters import worker_processes

from laticauda.cli import main
from laticauda.missions import Conditions, load_mission, merge_campaign, run_campaign
from laticauda.missions.campaign_table import read_rows
from laticauda.models.simulate import connected
from laticauda.studies import Share
from laticauda.values import locked

SEEDS = range(4)
WORDS = "mission net-inspection --duration 1 --runs 4 --table rows.csv"
CONDITIONS = Conditions(
    failing=("sonar", "compass", "inertial", "velocity", "water_velocity", "beacon")
)


@pytest.fixture(scope="module")
def mission():
    return replace(load_mission("net-inspection"), duration=1.0)


@pytest.fixture(scope="module")
def whole(mission, tmp_path_factory):
    """The table of a campaign that ran in one go."""
    path = tmp_path_factory.mktemp("whole") / "rows.csv"
    run_campaign(mission, CONDITIONS, SEEDS, path)
    return path.read_bytes()


def test_a_table_cut_short_at_any_byte_has_the_rows_before(whole, tmp_path):
    path = tmp_path / "rows.csv"
    n_lines = 0
    for n_bytes, byte in enumerate(whole):
        path.write_bytes(whole[:n_bytes])
        assert [row.seed for row in read_rows(path)] == list(range(max(n_lines - 1, 0)))
        n_lines += byte == ord("\n")


@pytest.mark.parametrize("n_bytes_missing", [1, 30])
def test_a_campaign_goes_on_with_a_table_that_was_cut_short(
    n_bytes_missing, mission, whole, tmp_path
):
    path = tmp_path / "rows.csv"
    path.write_bytes(whole[:-n_bytes_missing])
    run_campaign(mission, CONDITIONS, SEEDS, path)
    assert path.read_bytes() == whole


def test_shares_run_by_processes_of_their_own_are_merged_to_the_same_table(
    whole, tmp_path, monkeypatch, capsys
):
    command = [sys.executable, "-m", "laticauda", *WORDS.split()]
    shares = [
        subprocess.Popen([*command, "--share", f"{number}/2"], cwd=tmp_path) for number in (1, 2)
    ]
    assert [share.wait() for share in shares] == [0, 0]
    monkeypatch.chdir(tmp_path)
    assert main([*WORDS.split(), "--merge"]) == 0
    assert capsys.readouterr().out.startswith("docked       0 of 4")
    assert (tmp_path / "rows.csv").read_bytes() == whole


def test_workers_of_a_cluster_compute_the_same_table(mission, whole, tmp_path):
    path = tmp_path / "rows.csv"
    with worker_processes(2) as address, connected(address) as client:
        run_campaign(mission, CONDITIONS, SEEDS, path, client=client, at_once=1)
    assert path.read_bytes() == whole


def test_a_merger_tells_which_shares_are_missing(mission, whole, tmp_path):
    path = tmp_path / "rows.csv"
    run_campaign(mission, CONDITIONS, SEEDS, path, share=Share(number=2, count=2))
    merged = merge_campaign(path, SEEDS)
    assert merged.n_done == 2
    assert [str(share) for share in merged.unfinished] == ["1/2"]
    run_campaign(mission, CONDITIONS, SEEDS, path)
    assert path.read_bytes() == whole


def test_the_command_tells_which_shares_are_missing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*WORDS.split(), "--share", "2/3"]) == 0
    assert capsys.readouterr().out.startswith(
        "Share 2/3: 1 of 4 runs are in rows.share-2-of-3.csv."
    )
    assert main([*WORDS.split(), "--merge"]) == 1
    message = "1 of 4 runs are in rows.csv: not finished yet are the shares 1/3, 3/3."
    assert capsys.readouterr().out.startswith(message)


# ---- what is refused -----------------------------------------------------------------------------


def test_a_table_that_another_process_writes_to_is_refused(mission, tmp_path):
    path = tmp_path / "rows.csv"
    message = r"`table` must be one that no other process is writing to, got .*rows\.csv"
    with locked(path, wait=False), pytest.raises(ValueError, match=message):
        run_campaign(mission, CONDITIONS, SEEDS, path)


def test_a_table_of_another_mission_or_of_other_conditions_is_refused(mission, whole, tmp_path):
    path = tmp_path / "rows.csv"
    path.write_bytes(whole)
    message = r"`table` must be a new file, or of the same mission under the same conditions, got .*rows\.csv of"
    with pytest.raises(ValueError, match=message):
        run_campaign(replace(mission, duration=2.0), CONDITIONS, SEEDS, path)
    with pytest.raises(ValueError, match=message):
        run_campaign(mission, replace(CONDITIONS, current=0.05), SEEDS, path)
    assert path.read_bytes() == whole


def test_shares_of_two_campaigns_are_not_merged(mission, tmp_path):
    for number, duration in ((1, 1.0), (2, 2.0)):
        share = Share(number=number, count=2)
        changed = replace(mission, duration=duration)
        run_campaign(changed, CONDITIONS, range(2), tmp_path / "rows.csv", share=share)
    with pytest.raises(ValueError, match="of the same mission under the same conditions"):
        merge_campaign(tmp_path / "rows.csv", range(2))


@pytest.mark.parametrize("content", ["time,speed\n0,1\n", "time,speed\n0,1", "time"])
def test_another_table_is_refused_and_stays_as_it_is(content, mission, tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text(content)
    message = r"`table` must be a table of a campaign of missions, got .*rows\.csv"
    with pytest.raises(ValueError, match=message):
        run_campaign(mission, CONDITIONS, SEEDS, path)
    assert path.read_text() == content


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--share 1/2 --merge", "--share must not be given together with --merge"),
        ("--share 3/2", "--share must be between 1/2 and 2/2, got 3/2"),
        ("--merge --scheduler nowhere", "--scheduler must not be given with --merge"),
        ("--merge", "--table must have shares beside it, such as rows.share-1-of-4.csv"),
    ],
)
def test_ways_of_running_that_contradict_each_other_are_refused(
    words, message, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main([*WORDS.split(), *words.split()]) == 2
    assert message in capsys.readouterr().err


def test_ways_of_running_belong_to_campaigns(capsys):
    assert main(["mission", "net-inspection", "--share", "1/2"]) == 2
    message = "--share must be given together with --runs."
    assert message in capsys.readouterr().err
