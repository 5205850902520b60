import json
import sys
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from laticauda.errors import SimulationFailed
from laticauda.reports import reproduce as _reproduce
from laticauda.reports.efficiency import efficiency_figures
from laticauda.studies import efficiency_settings, run_efficiency

MODULE = sys.modules[_reproduce.__module__]


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch):
    """The study with coarse sweeps and one of its figures."""
    settings = efficiency_settings()
    coarse = replace(settings, sweeps=tuple(replace(sweep, step=10 * sweep.step) for sweep in settings.sweeps))
    monkeypatch.setattr(MODULE, "run_efficiency", lambda **how: run_efficiency(coarse, **how))
    monkeypatch.setattr(MODULE, "efficiency_figures", lambda study: islice(efficiency_figures(study), 1))


@pytest.mark.usefixtures("short")
def test_the_command_writes_a_folder_and_prints_the_errors(run, folder: Path):
    done = run("reproduce --only efficiency")
    assert (done.status, done.err) == (0, "")
    assert "null model: constant + fin + eel" in done.out
    assert done.out.rstrip().endswith("open reproduction/report.html")
    assert (folder / "reproduction" / "report.html").stat().st_size > 100_000

    # The folder can be used again.
    done = run("reproduce --json --output reproduction --joints prescribed")
    assert done.status == 0
    found = json.loads(done.out)
    assert found["efficiency"]["errors"]["planar"]["mape_percent"] == pytest.approx(15.7, abs=0.1)
    assert found["settings"]["joints"] == "prescribed"
    assert set(found["files"]) == {file.name for file in (folder / "reproduction").iterdir()}
    assert found["status"]


def test_a_folder_that_cannot_be_written_is_bad_input(run, folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(MODULE, "run_efficiency", lambda **how: pytest.fail("it ran"))
    (folder / "file").write_text("")
    done = run("reproduce --output file")
    assert (done.status, done.out) == (2, "")
    assert done.err == "laticauda: --output must be a folder, got the file file.\n"


def test_a_study_that_does_not_exist_is_bad_input(run):
    assert run("reproduce --only everything").status == 2
    assert run("reproduce --joints magic").status == 2


def test_a_trial_that_blows_up_ends_with_status_1(run, monkeypatch: pytest.MonkeyPatch):
    def fail(**how):
        raise SimulationFailed("mamba: the run blew up at 3 s.")

    monkeypatch.setattr(MODULE, "run_efficiency", fail)
    done = run("reproduce")
    assert (done.status, done.out, done.err) == (1, "", "mamba: the run blew up at 3 s.\n")
