import re
from pathlib import Path

import pytest

from laticauda import reports
from laticauda.reports import reproduce as command
from laticauda.reports.efficiency import efficiency_figures, efficiency_section
from laticauda.reports.page import Paragraph, Picture, Points

module = reports.reproduce.__module__


@pytest.fixture
def short(study, monkeypatch):
    """A reproduction of a study that has been run already."""
    import sys

    def run(**settings):
        settings["progress"](1, 1)
        return study

    monkeypatch.setattr(sys.modules[module], "run_efficiency", run)


def test_one_folder_holds_report_figures_tables_and_data(short, tmp_path: Path):
    told = []
    done = command(tmp_path / "a" / "b", progress=lambda *what: told.append(what))
    assert sorted(done.files) == sorted(file.name for file in done.folder.iterdir())
    pictures = [f"figure-{number:02d}{end}" for number in range(4, 12) for end in (".png", ".pdf")]
    assert set(pictures) < set(done.files)
    assert {"report.html", "efficiency.nc", "table1.csv", "errors.csv"} < set(done.files)
    assert told[0] == ("trials", 1, 1)
    assert told[-1] == ("figures", 8, 8)

    report = (done.folder / "report.html").read_text(encoding="utf-8")
    assert report.count("data:image/png;base64,") == 8
    # Nothing is loaded from anywhere, and nothing runs.
    assert not re.search(r"https?:|<script|<link|url\(|@import", report)
    assert all(source.startswith("data:") for source in re.findall(r'src="([^"]{0,20})', report))


@pytest.mark.usefixtures("short")
def test_a_folder_can_be_used_again_and_what_else_is_in_it_is_left_alone(tmp_path: Path, monkeypatch):
    import sys

    monkeypatch.setattr(sys.modules[module], "efficiency_figures", lambda study: ())
    (tmp_path / "mine.txt").write_text("kept")
    (tmp_path / "report.html").write_text("old")
    done = command(tmp_path, progress=lambda *what: None)
    assert (tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert (done.folder / "mine.txt").read_text() == "kept"


def test_a_folder_that_cannot_be_written_is_refused_before_anything_runs(tmp_path: Path, monkeypatch):
    import sys

    monkeypatch.setattr(sys.modules[module], "run_efficiency", lambda **settings: pytest.fail("it ran"))
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="`folder` must be a folder, got the file"):
        command(tmp_path / "file")
    with pytest.raises(ValueError, match=r"`folder` must be a folder that can be written, got .*: not a directory"):
        command(tmp_path / "file" / "folder")
    with pytest.raises(ValueError, match="`only` must be one of `efficiency`, got 'eficiency'; did you mean"):
        command(tmp_path, only="eficiency")


def test_the_section_says_what_was_run_and_what_came_out(study):
    section = efficiency_section(study, {"figure-04": ("Velocity.", b"")})
    words = " ".join(
        text
        for part in section.parts
        for text in (part.texts if isinstance(part, Points) else [part.text] if isinstance(part, Paragraph) else [])
    )
    for said in (
        f"{study.settings.n_runs} trials of 30 s",
        "joints: prescribed",
        "Time step 0.05 s",
        "over the first 1 s",
        "10 rad/s",
        "paper-eel (C_f 0.17, C_D 1.75, C_A 1.5",
        "quadratic drag only",
        "The fin makes lateral undulation faster by 47 to 83 % as measured",
        "The fin makes eel-like motion faster by 34 to 89 % as measured",
        "case 3, change of power printed +10.11 %, recomputed from the table +4.79 %",
        "constant + fin + eel, 3 numbers fitted to these rows) 6.2 %, and 7.3 %",
    ):
        assert said in words
    assert sum(isinstance(part, Picture) for part in section.parts) == 1


def test_every_figure_marks_the_measured_rows_of_its_sweep(study):
    name, caption, figure = next(efficiency_figures(study))
    assert name == "figure-04"
    assert "Forward velocity: lateral undulation, without fin" in caption
    marked = [sorted(float(x) for line in ax.lines[2:] for x in line.get_xdata()) for ax in figure.axes]
    assert marked == [pytest.approx([36]), pytest.approx([130, 150]), pytest.approx([35])]
