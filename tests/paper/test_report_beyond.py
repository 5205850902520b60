import math

import numpy as np
import pytest
from paper.reading import said

from laticauda.paper import BeyondSettings, CurvedSettings, DriftSettings, TurningSettings, run_beyond
from laticauda.paper.report.beyond import beyond_chapter
from laticauda.paper.settings import swimmers


@pytest.fixture(scope="module")
def study():
    return run_beyond(
        BeyondSettings(
            drift=DriftSettings(duration=60.0, control_interval=0.2),
            curved=CurvedSettings(swimmers=swimmers()[:2], waypoints=((0.0, 0.0), (1.0, 0.4), (2.0, 0.0))),
            turning=TurningSettings(offsets=tuple(math.radians(value) for value in (4, 8, 12)), duration=30.0),
        )
    )


def test_the_chapter_is_honest_about_what_stands_behind_it(study):
    assert said(beyond_chapter(study)).startswith("None of this was measured. The tank had no current")


def test_the_section_says_what_was_run_and_what_came_out(study):
    text = said(beyond_chapter(study))
    plain, integral, _ = study.drift
    curved = study.settings.curved
    for expected in (
        "along the x axis for 60 s from the path itself",
        "the water moves with (0, 0.05) m/s",
        f"Line of sight: a mean error of {100 * plain.mean_error:+.1f} cm over the last third, not below 5 cm",
        f"rms {100 * integral.rms(2.0):.1f} cm",
        "A smooth curve through (0, 0), (1, 0.4), (2, 0) m",
        f"tightest radius {curved.tightest_radius:.2f} m",
        "2 of 2 come to the end",
        f"{study.curved[0].swimmer.name} {100 * study.curved[0].rms():.1f} cm rms",
        "3 offsets from 4 to 12 deg, 30 s each",
        f"radius {study.turning[3].radius[0]:.2f} to {study.turning[3].radius[-1]:.2f} m",
    ):
        assert expected in text


def test_the_offset_for_a_turn_as_tight_as_the_curve_lies_between_those_that_were_run(study):
    text = said(beyond_chapter(study))
    tightest = study.settings.curved.tightest_radius
    for curve in study.turning:
        inside = curve.radius[-1] <= tightest <= curve.radius[0]
        assert (f"{curve.swimmer.name} " in text.partition("takes an offset of:")[2]) == inside
    assert any(curve.radius[-1] <= tightest <= curve.radius[0] for curve in study.turning)


def test_the_tables_hold_every_run(study):
    drift, curved, turning = beyond_chapter(study).tables.values()
    assert list(drift["law"]) == [run.law.name for run in study.drift]
    assert np.array_equal(drift["integral gain [m/s]"], [np.nan, 0.12, np.nan], equal_nan=True)
    assert list(drift["mean e, last third [m]"]) == [run.mean_error for run in study.drift]
    assert list(drift["holds the path"]) == [study.settings.drift.holds(run) for run in study.drift]
    for row, run in zip(curved.to_dict("records"), study.curved, strict=True):
        assert row["swimmer"] == run.swimmer.name
        assert (row["rms of the mean error [m]"], row["largest mean error [m]"]) == (run.rms(), abs(run.largest))
        assert row["progress [m/s]"] == pytest.approx(study.settings.curved.path.length / run.trial.duration)
    assert len(turning) == 4 * 3
    second = turning.iloc[1]
    assert second["offset [deg]"] == 8.0
    rate = second["turning rate [deg/s]"]
    assert rate == pytest.approx(math.degrees(study.turning[0].turning_rate[1]))
    assert second["radius [m]"] == pytest.approx(second["path speed [m/s]"] / math.radians(rate))


def test_the_figures_show_ways_errors_and_turns(study):
    chapter = beyond_chapter(study)
    found = {name: (caption, figure) for name, caption, figure in chapter.figures()}
    assert list(found) == ["beyond-cross-current", "beyond-curved-path", "beyond-turning"]
    assert len(found) == chapter.n_figures
    assert all("Simulation only." in caption for caption, _ in found.values())
    assert [len(figure.axes) for _, figure in found.values()] == [3, 3, 3]
    assert chapter.html({name: (caption, b"") for name, (caption, _) in found.items()}).count("<img ") == 3
