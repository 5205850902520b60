import json
from pathlib import Path

import pytest

from laticauda.paper.command import as_text, facts_of
from laticauda.paper.report import reproduce as MODULE  # noqa: N812
from laticauda.paper.report.reproduce import Reproduction
from laticauda.values.errors import SimulationFailed


@pytest.mark.usefixtures("short_reproduction")
def test_the_command_writes_a_folder_and_prints_the_errors_and_the_verdicts(run, folder: Path):
    done = run("reproduce --workers 1")
    assert (done.status, done.err) == (0, "")
    assert "null model: constant + fin + eel" in done.out
    assert "Mean error of the forward velocity over the paper's Table 2" in done.out
    assert "The paper's claims: " in done.out
    assert done.out.rstrip().endswith("open reproduction/report.html")
    assert all(len(line) < 120 for line in done.out.splitlines())
    assert (folder / "reproduction" / "report.html").stat().st_size > 20_000

    # The folder can be used again.
    done = run(
        "reproduce --only efficiency --json --output reproduction --joints prescribed --workers 1"
    )
    assert done.status == 0
    found = json.loads(done.out)
    assert found["efficiency"]["errors"]["analytical-set"]["mape_percent"] == pytest.approx(
        15.7, abs=0.1
    )
    assert found["efficiency"]["settings"]["joints"] == "prescribed"
    assert "path_following" not in found
    assert sum(found["claims"].values()) > 20
    assert set(found["files"]) < {file.name for file in (folder / "reproduction").iterdir()}
    assert found["status"]


@pytest.mark.usefixtures("short_reproduction")
def test_coefficients_and_repeated_measurements_come_from_files(run, folder: Path):
    (folder / "mine.toml").write_text(
        'kind = "parameters"\nname = "mine"\ntitle = "my fit"\n[water]\ntangential_friction = 0.2\nnormal_drag = 1.7\n'
        "added_mass = 1.5\n[actuator]\ntracking = 0.5\n"
    )
    (folder / "repeats.csv").write_text(
        "gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s\nLU,nofin,30,130,40,0.15\nLU,nofin,30,130,40,0.16\n"
    )
    done = run(
        "reproduce --only efficiency --parameters mine.toml --repeats repeats.csv --workers 1 --json"
    )
    assert done.status == 0
    errors = json.loads(done.out)["efficiency"]["errors"]
    assert "mine" in errors
    report = (folder / "reproduction" / "report.html").read_text(encoding="utf-8")
    assert "Coefficients: my fit." in report
    assert "repeats.csv" in json.loads(done.out)["files"]


def test_the_summary_of_one_half_leaves_the_other_out(following):
    half = Reproduction(
        folder=Path("out"), files=("report.html",), results={"path_following": following}, claims=()
    )
    facts = facts_of(half)
    assert "efficiency" not in facts
    assert len(facts["path_following"]["trials"]) == 12
    assert facts["files"] == ("report.html",)
    text = as_text(half)
    assert text.startswith("Path following, prescribed joints")
    assert "rows left out" not in text


def test_bad_files_are_refused_before_anything_runs(
    run, folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(MODULE, "run_studies", lambda *args: pytest.fail("it ran"))
    done = run("reproduce --parameters nothing.toml")
    assert (done.status, done.out) == (2, "")
    assert "nothing.toml" in done.err
    (folder / "repeats.csv").write_text("gait,config\nLU,nofin\n")
    done = run("reproduce --repeats repeats.csv")
    assert (done.status, done.out) == (2, "")
    assert "repeats.csv" in done.err


def test_a_folder_that_cannot_be_written_is_bad_input(
    run, folder: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(MODULE, "run_studies", lambda *args: pytest.fail("it ran"))
    (folder / "file").write_text("")
    done = run("reproduce --output file")
    assert (done.status, done.out) == (2, "")
    assert done.err == "laticauda: --output must be a folder, got the file file.\n"


def test_a_study_that_does_not_exist_is_bad_input(run):
    assert run("reproduce --only everything").status == 2
    assert run("reproduce --joints magic").status == 2
    done = run("reproduce --workers 0")
    assert (done.status, done.err) == (
        2,
        "laticauda: --workers must be a whole number >= 1, got 0.\n",
    )


def test_a_trial_that_blows_up_ends_with_status_1(
    run, folder: Path, monkeypatch: pytest.MonkeyPatch
):
    def fail(*args):
        raise SimulationFailed("mamba: the run blew up at 3 s.")

    monkeypatch.setattr(MODULE, "run_studies", fail)
    done = run("reproduce")
    assert (done.status, done.out, done.err) == (
        1,
        "",
        "laticauda: mamba: the run blew up at 3 s.\n",
    )
