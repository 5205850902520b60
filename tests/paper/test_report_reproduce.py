import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from pathlib import Path

import pytest

from laticauda.motion.gaits import eel_like
from laticauda.paper import Experiments, SideSettings, plan_experiments, reproduce
from laticauda.paper.report import reproduce as module
from laticauda.paper.report.chapter import build_paper_chapter
from laticauda.paper.report.reproduce import CHAPTERS, HALVES, RUNS
from laticauda.robot import Parameters, load_parameters, load_robot, load_water
from laticauda.show.reports.chapter import Chapter


@pytest.fixture(scope="session")
def small() -> Experiments:
    """Every study, cut down to seconds."""
    whole = plan_experiments()
    sweeps = tuple(replace(sweep, step=10 * sweep.step) for sweep in whole.efficiency.sweeps)
    return Experiments(
        efficiency=replace(whole.efficiency, sweeps=sweeps, models=whole.efficiency.models[:1]),
        side=replace(SideSettings(), phase_shifts=sweeps[2], duration=10.0),
        path_following=replace(
            whole.path_following,
            duration=16.0,
            joint_laws=("prescribed",),
            offset_bandwidths=(10.0,),
        ),
    )


def with_one_figure(chapter: Callable[..., Chapter]) -> Callable[..., Chapter]:
    """A chapter that draws its first figure only; what the others look like is tested with each chapter."""

    def short(*args, **kwargs):
        whole = chapter(*args, **kwargs)
        return replace(whole, n_figures=1, figures=lambda: islice(whole.figures(), 1))

    return short


def told_to(told: list):
    return lambda *what: told.append(what)


@pytest.mark.slow
def test_one_folder_holds_report_figures_tables_and_data(
    small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(
        module,
        "CHAPTERS",
        {
            name: chapter._replace(build=with_one_figure(chapter.build))
            for name, chapter in CHAPTERS.items()
        },
    )
    told: list = []
    done = reproduce(tmp_path / "a" / "b", small, progress=told_to(told))
    assert sorted(done.files) == sorted(file.name for file in done.folder.iterdir())
    assert {"figure-04.png", "figure-04.pdf", "table2-speeds.png"} < set(done.files)
    assert {
        "report.html",
        "sweeps.csv",
        "figure-23.nc",
        "figure-23-mamba-identified.nc",
        "table1.csv",
        "table2.csv",
        "claims.csv",
    } < set(done.files)
    assert {what for what, _, _ in told} >= {
        "efficiency",
        "path following",
        "path following: figures",
        "side",
    }
    assert all(0 < count <= total for _, count, total in told)

    report = (done.folder / "report.html").read_text(encoding="utf-8")
    assert report.count("data:image/png;base64,") == sum(
        name.endswith(".png") for name in done.files
    )
    # Nothing is loaded from anywhere, and nothing runs.
    assert not re.search(r"https?:|<script|<link|url\(|@import", report)
    assert all(source.startswith("data:") for source in re.findall(r'src="([^"]{0,20})', report))
    anchors = re.findall(r'<figure id="fig-([\w-]+)"', report)
    assert sorted(f"{name}.png" for name in anchors) == sorted(
        name for name in done.files if name.endswith(".png")
    )
    parts = re.findall(r'<section id="([\w-]+)"', report)
    assert parts == ["claims", "efficiency", "path-following"]


@pytest.mark.slow
def test_two_workers_write_what_one_writes_and_a_used_folder_keeps_what_else_is_in_it(
    small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "mine.txt").write_text("kept")
    (tmp_path / "report.html").write_text("old")
    # Drawing takes longer than the studies: who works alone draws one figure. Workers import
    # everything anew, and draw all.
    chapter = CHAPTERS["efficiency"]
    shorter = chapter._replace(build=with_one_figure(chapter.build))
    monkeypatch.setitem(CHAPTERS, "efficiency", shorter)
    alone = reproduce(tmp_path / "alone", small, only="efficiency")
    told: list = []
    both = reproduce(tmp_path, small, only="efficiency", workers=2, progress=told_to(told))
    assert {"table1.csv", "claims.csv", "sweeps.csv", "figure-04.png"} < set(alone.files)
    more = {name for name in both.files if name.startswith("figure-")} - set(alone.files)
    assert set(both.files) == set(alone.files) | more
    for name in alone.files:
        if not name.endswith((".html", ".pdf")):
            assert (tmp_path / name).read_bytes() == (alone.folder / name).read_bytes(), name
    pages = [
        re.sub(
            r"<figure.*?</figure>\s*",
            "",
            (folder / "report.html").read_text(encoding="utf-8"),
            flags=re.DOTALL,
        )
        for folder in (tmp_path, alone.folder)
    ]
    assert pages[0] == pages[1]
    assert (tmp_path / "mine.txt").read_text() == "kept"
    assert {what for what, _, _ in told} >= {"efficiency", "side"}


def test_every_study_has_a_runner_and_a_half_of_the_paper():
    names = set(Experiments.__dataclass_fields__)
    assert set(RUNS) == names
    assert sorted(name for half in HALVES.values() for name in half) == sorted(names)


def test_one_half_leaves_the_other_out(small, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(
        module, "RUNS", {name: lambda *args, name=name, **how: name for name in RUNS}
    )
    monkeypatch.setattr(module, "CHAPTERS", {})
    monkeypatch.setattr(module, "judge_with_own_models", lambda results: {})
    for name in ("build_claims_chapter", "build_summary_chapter", "build_trust_chapter"):
        monkeypatch.setattr(
            module, name, lambda *found: build_paper_chapter(name="words", values={})
        )
    done = reproduce(tmp_path, small, only="path-following")
    assert set(done.results) == {"path_following"}


def test_what_fails_in_a_worker_fails_here(small, tmp_path: Path):
    hopeless = replace(small.efficiency, duration=1.0)
    with pytest.raises(ValueError, match=r"`time` must span at least 13\.27 s"):
        reproduce(tmp_path, replace(small, efficiency=hopeless), only="efficiency", workers=2)


def test_a_folder_that_cannot_be_written_is_refused_before_anything_runs(
    tmp_path: Path, monkeypatch
):
    monkeypatch.setattr(module, "run_studies", lambda *args: pytest.fail("it ran"))
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="`folder` must be a folder, got the file"):
        reproduce(tmp_path / "file")
    with pytest.raises(
        ValueError, match=r"`folder` must be a folder that can be written, got .*: not a directory"
    ):
        reproduce(tmp_path / "file" / "folder")
    with pytest.raises(
        ValueError, match="`only` must be one of `efficiency`, `path-following`, got 'eficiency'"
    ):
        reproduce(tmp_path, only="eficiency")
    with pytest.raises(ValueError, match="`workers` must be a whole number >= 1, got 0"):
        reproduce(tmp_path, workers=0)


def test_other_coefficients_reach_every_study():
    water = load_water("published-2015")
    changes = {"actuator": {"tracking": 0.5}}
    mine = plan_experiments(
        Parameters(name="mine", title="my numbers", every_gait=water, changes=changes)
    )
    mamba, eel = load_robot("mamba"), eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
    names = [model.name for model in plan_experiments().efficiency.models]
    assert [model.name for model in mine.efficiency.models] == ["mine", *names]
    for coefficients in (mine.side.coefficients, mine.path_following.coefficients):
        assert coefficients.name == "mine"
        there = coefficients.build_scenario(mamba, eel)
        assert there.robot.joints[0].actuator.tracking == 0.5
        assert there.environment == replace(water, name="mine")
    same = plan_experiments(load_parameters("mamba-identified")).efficiency.models
    assert [model.name for model in same] == [
        "mamba-identified",
        *(one for one in names if one != "mamba-identified"),
    ]
    assert (
        mine.efficiency.models[1].build_scenario(mamba, eel).robot is mamba
    )  # the paper's stays beside it as it is


KILLED = """
import os, signal
from laticauda.paper.report import workers as module

module.ProcessPoolExecutor = lambda *args, **more: os.kill(os.getpid(), signal.SIGKILL)
module.run_studies(None, ["efficiency", "side"], 2, None)
"""


@pytest.mark.skipif(os.name != "posix", reason="no such process")
def test_a_reproduction_that_is_ended_at_once_says_nothing_of_what_its_workers_shared():
    done = subprocess.run(
        [sys.executable, "-c", KILLED], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (-signal.SIGKILL, "")
