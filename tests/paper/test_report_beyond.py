import math

import pytest

from laticauda.paper import BeyondSettings, CurvedSettings, DriftSettings, TurningSettings, run_beyond
from laticauda.paper.report.beyond import beyond_chapter
from laticauda.paper.report.beyond_tables import beyond_tables, curved_table, drift_table, turning_table
from laticauda.paper.swimmers import swimmers
from laticauda.reports.page import Paragraph, Picture, Points


@pytest.fixture(scope="module")
def study():
    return run_beyond(
        BeyondSettings(
            drift=DriftSettings(duration=60.0, control_interval=0.2),
            curved=CurvedSettings(swimmers=swimmers()[:2], waypoints=((0.0, 0.0), (1.0, 0.4), (2.0, 0.0))),
            turning=TurningSettings(offsets=tuple(math.radians(value) for value in (4, 8, 12)), duration=30.0),
        )
    )


def words(section) -> str:
    said = [part.text for part in section.parts if isinstance(part, Paragraph)]
    return " ".join([*said, *(text for part in section.parts if isinstance(part, Points) for text in part.texts)])


def test_the_section_is_honest_about_what_stands_behind_it(study):
    section = beyond_chapter(study).section({})
    first = section.parts[0]
    assert isinstance(first, Paragraph)
    assert "None of this was measured" in first.text
    assert "The tank had no current" in first.text
    assert section.title == "Beyond the paper (simulation only)"


def test_the_section_says_what_was_run_and_what_came_out(study):
    said = words(beyond_chapter(study).section({}))
    plain, integral, _ = study.drift
    curved = study.settings.curved
    for expected in (
        "along the x axis for 60 s from the path itself",
        "the water moves with (0, 0.05) m/s",
        f"Line of sight: a mean error of {100 * plain.mean_error:+.1f} cm over the last third, not below 5 cm",
        f"rms {100 * integral.rms_error:.1f} cm",
        "A smooth curve through (0, 0), (1, 0.4), (2, 0) m",
        f"tightest radius {curved.tightest_radius:.2f} m",
        "2 of 2 come to the end",
        f"{study.curved[0].swimmer.name} {100 * study.curved[0].rms:.1f} cm rms",
        "3 offsets from 4 to 12 deg, 30 s each",
        f"radius {study.turning[3].radius[0]:.2f} to {study.turning[3].radius[-1]:.2f} m",
    ):
        assert expected in said


def test_the_offset_for_a_turn_as_tight_as_the_curve_lies_between_those_that_were_run(study):
    said = words(beyond_chapter(study).section({}))
    tightest = study.settings.curved.tightest_radius
    for curve in study.turning:
        inside = curve.radius[-1] <= tightest <= curve.radius[0]
        assert (f"{curve.swimmer.name} " in said.partition("takes an offset of:")[2]) == inside
    assert any(curve.radius[-1] <= tightest <= curve.radius[0] for curve in study.turning)


def test_the_tables_hold_every_run(study):
    assert [table.name for table in beyond_tables(study)] == [
        "beyond-cross-current",
        "beyond-curved-path",
        "beyond-turning",
    ]
    rows = drift_table(study).rows
    assert [row[0] for row in rows] == [run.law.name for run in study.drift]
    assert [row[3] for row in rows] == [None, 0.12, None]
    assert [row[4] for row in rows] == [run.mean_error for run in study.drift]
    assert [row[-1] for row in rows] == [run.holds for run in study.drift]
    for row, run in zip(curved_table(study).rows, study.curved, strict=True):
        assert row[:3] == (run.swimmer.name, run.rms, run.largest)
        assert row[5] == pytest.approx(study.settings.curved.path.length / run.trial.duration)
    turning = turning_table(study).rows
    assert len(turning) == 4 * 3
    assert turning[1][1] == 8.0
    assert turning[1][2] == pytest.approx(math.degrees(study.turning[0].turning_rate[1]))
    assert turning[1][3] == pytest.approx(turning[1][5] / math.radians(turning[1][2]))


def test_the_figures_show_ways_errors_and_turns(study):
    chapter = beyond_chapter(study)
    found = {name: (caption, figure) for name, caption, figure in chapter.figures()}
    assert list(found) == ["beyond-cross-current", "beyond-curved-path", "beyond-turning"]
    assert len(found) == chapter.n_figures
    assert all("Simulation only." in caption for caption, _ in found.values())
    assert [len(figure.axes) for _, figure in found.values()] == [3, 3, 3]
    section = chapter.section({name: (caption, b"") for name, (caption, _) in found.items()})
    assert sum(isinstance(part, Picture) for part in section.parts) == 3
