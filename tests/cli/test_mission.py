"""`laticauda mission`: what it lists, runs, draws and refuses."""

import json
import shutil

import pytest

from laticauda.cli import main


def test_without_a_name_it_lists_the_missions(capsys):
    assert main(["mission"]) == 0
    assert capsys.readouterr().out.split() == ["net-inspection", "tank-inspection"]


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_a_short_run_tells_where_it_ended_and_draws_map_and_phases(model, tmp_path, capsys):
    if model == "spatial":
        pytest.importorskip("mujoco")
    pictures = [str(tmp_path / "map.png"), str(tmp_path / "phases.png")]
    words = ["mission", "net-inspection", "--model", model, "--duration", "2", "--json"]
    assert main([*words, "--plot", pictures[0], "--diagram", pictures[1]]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert not facts["docked"] and facts["last_phase"] == "undock"
    assert facts["duration"] == pytest.approx(2.0)
    assert all((tmp_path / name).stat().st_size > 10_000 for name in ("map.png", "phases.png"))


def test_a_run_and_the_worst_runs_of_a_campaign_are_filmed(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    short = ["mission", "net-inspection", "--duration", "2", "--speed", "60"]
    assert main([*short, "--video", "run.webp"]) == 0
    assert (tmp_path / "run.webp").read_bytes()[8:12] == b"WEBP"
    if shutil.which("ffmpeg") is None:
        pytest.skip("no ffmpeg")
    capsys.readouterr()
    assert main([*short, "--runs", "2", "--table", "rows.csv", "--films", "1", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    worst = facts["worst"][0]
    assert facts["films"] == [f"rows-{worst}.mp4"]
    assert b"ftyp" in (tmp_path / f"rows-{worst}.mp4").read_bytes()[:12]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["net-inspektion"],
            "laticauda: NAME must be `net-inspection`, `tank-inspection`, or a file",
        ),
        (["net-inspektion"], "did you mean `net-inspection`?"),
        (["net-inspection", "--runs", "2"], "--runs must be given together with --table FILE.csv."),
        (
            ["net-inspection", "--runs", "2", "--table", "a.csv", "--plot", "a.png"],
            "--plot must be left out with --runs: it is for one run only.",
        ),
        (["net-inspection", "--table", "a.csv"], "--table must be given together with --runs."),
        (
            ["net-inspection", "--speed", "6"],
            "--speed must be given together with --video or --films.",
        ),
        (["net-inspection", "--films", "2"], "--films must be given together with --runs."),
        (
            ["net-inspection", "--diagram", "a.png", "--merge"],
            "--merge must be given together with --runs.",
        ),
        (
            ["net-inspection", "--runs", "2", "--table", "a.csv", "--share", "1/2", "--films", "1"],
            "--films must be left out with --share, and given with --merge.",
        ),
        (
            ["net-inspection", "--video", "a.avi"],
            "--video must be a file that ends in .mp4 or .webp or .gif, got a.avi.",
        ),
        (["net-inspection", "--seed", "-1"], "--seed must be a whole number >= 0, got -1."),
    ],
)
def test_what_no_mission_can_do_is_refused(words, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["mission", *words]) == 2
    assert message in capsys.readouterr().err
