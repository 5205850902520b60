"""What was run beyond the paper, for readers: figures, and its section of the report."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from laticauda.paper.beyond import BeyondStudy
from laticauda.paper.beyond_dataset import write_beyond_netcdf
from laticauda.paper.report.beyond_tables import beyond_tables, curved_table, drift_table, turning_table
from laticauda.paper.report.swimmers import swimmers_in_words
from laticauda.paper.turning import TurningCurve
from laticauda.reports.chapter import Chapter, Pictures
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section
from laticauda.reports.tables import in_digits

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DRIFT, CURVED, TURNING = "beyond-cross-current", "beyond-curved-path", "beyond-turning"


def beyond_chapter(study: BeyondStudy) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_beyond` returned.
    """
    return Chapter(
        section=lambda pictures: beyond_section(study, pictures),
        tables=beyond_tables(study),
        n_figures=3,
        figures=lambda: beyond_figures(study),
        data={"beyond.nc": lambda path: write_beyond_netcdf(study, path)},
    )


def beyond_figures(study: BeyondStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The study's figures, one after the other: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_beyond` returned.
    """
    yield DRIFT, *_drift_figure(study)
    yield CURVED, *_curved_figure(study)
    yield TURNING, *_turning_figure(study)


def beyond_section(study: BeyondStudy, pictures: Pictures) -> Section:
    """The study's part of the report.

    Args:
        study: What was run.
        pictures: By name of the figure, its caption and the content of its PNG file.
    """
    swimmers = [curve.swimmer for curve in study.turning]
    parts: list[Part] = [
        Paragraph(
            text="None of this was measured. The tank had no current, and the paper's paths are straight: what follows "
            "is simulation only, with coefficients that were identified on straight runs, and no experiment stands "
            "behind it."
        ),
        Points(texts=(*swimmers_in_words(swimmers, study.how),)),
        Heading(text="A current across the path"),
        Points(texts=(*_drift_words(study),)),
        drift_table(study),
        *_picture(pictures, DRIFT),
        Heading(text="A curved path"),
        Points(texts=(*_curved_words(study),)),
        curved_table(study),
        *_picture(pictures, CURVED),
        Heading(text="Turning with a constant offset"),
        Points(texts=(*_turning_words(study),)),
        turning_table(study),
        *_picture(pictures, TURNING),
    ]
    return Section(name="beyond", title="Beyond the paper (simulation only)", parts=tuple(parts))


def _picture(pictures: Pictures, name: str) -> Iterator[Picture]:
    if name in pictures:
        caption, png = pictures[name]
        yield Picture(png=png, caption=caption, description=f"{caption} The numbers are in {name}.csv and beyond.nc.")


# ---- figures -------------------------------------------------------------------------------------------------------


def _drift_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.drift import ErrorLine, runs_sheet

    settings = study.settings.drift
    title = (
        f"{settings.swimmer.name.capitalize()} in a current of {math.hypot(*settings.current):g} m/s across the path"
    )
    lines = [ErrorLine(label=run.law.name, at=run.error.time, error=run.error.value) for run in study.drift]
    figure = runs_sheet(
        [(run.law.name, run.trial) for run in study.drift[:2]],
        lines,
        title,
        xlabel="time [s]",
        tolerance=settings.tolerance,
    )
    return f"{title}: the way, and the cycle-mean cross-track error. Simulation only.", figure


def _curved_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.drift import ErrorLine, runs_sheet

    title = f"A curved path, line of sight with {study.settings.curved.law.name}"
    lines = [ErrorLine(label=run.swimmer.name, at=run.along, error=run.error.value) for run in study.curved]
    shown = [(run.swimmer.name, run.trial) for run in study.curved[:2]]
    figure = runs_sheet(shown, lines, title, xlabel="distance along the path [m]")
    return f"{title}: the way, and the cycle-mean cross-track error. Simulation only.", figure


def _turning_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.turning import TurningLine, turning_sheet

    title = "Turning with a constant offset of all joints"
    lines = [
        TurningLine(
            label=curve.swimmer.name,
            is_eel_like=curve.swimmer.gait.kind == "eel_like",
            has_fin=curve.swimmer.has_fin,
            offset=np.array(study.settings.turning.offsets),
            turning_rate=curve.turning_rate,
            radius=curve.radius,
            path_speed=curve.path_speed,
        )
        for curve in study.turning
    ]
    return f"{title}: turning rate, radius and path speed. Simulation only.", turning_sheet(lines, title)


# ---- words ---------------------------------------------------------------------------------------------------------


def _drift_words(study: BeyondStudy) -> Iterator[str]:
    settings = study.settings.drift
    x, y = (in_digits(part, "g") for part in settings.current)
    yield (
        f"{settings.swimmer.name.capitalize()}, along the x axis for {settings.duration:g} s from the path itself, at "
        f"rest; the water moves with ({x}, {y}) m/s; raw heading, offset asked for every {settings.control_interval:g} "
        "s."
    )
    limit = 100.0 * settings.tolerance
    for run in study.drift:
        verdict = f"below {limit:g} cm" if run.holds else f"not below {limit:g} cm"
        yield (
            f"{run.law.name[0].upper()}{run.law.name[1:]}: a mean error of "
            f"{in_digits(100.0 * run.mean_error, '+.1f')} cm over the last third, {verdict}; "
            f"rms {100.0 * run.rms_error:.1f} cm; "
            f"{in_digits(100.0 * run.final_error, '+.1f')} cm at the end."
        )
    yield (
        "Line of sight without the integral has to stay beside the path, for only an error makes it point upstream; "
        "a short look-ahead distance makes that error small. The integral takes it off, but swings about the path on "
        "the way: its figures depend on start and duration."
    )


def _curved_words(study: BeyondStudy) -> Iterator[str]:
    settings = study.settings.curved
    law = settings.law
    points = ", ".join(f"({in_digits(x, 'g')}, {in_digits(y, 'g')})" for x, y in settings.waypoints)
    yield (
        f"A smooth curve through {points} m: {settings.path.length:.2f} m long, tightest radius "
        f"{settings.tightest_radius:.2f} m. Line of sight with {law.name} ({law.guidance.look_ahead_distance:g} m, "
        f"{law.gain:g}), {law.heading_estimate.replace('_', '-')} heading, from its begin to its end or "
        f"{settings.most_duration:g} s, offset asked for every {settings.control_interval:g} s."
    )
    ended = sum(run.reached_end for run in study.curved)
    errors = "; ".join(
        f"{run.swimmer.name} {100.0 * run.rms:.1f} cm rms, at most {100.0 * run.largest:.1f} cm" for run in study.curved
    )
    yield f"{ended} of {len(study.curved)} come to the end. Cycle-mean error: {errors}."
    yield (
        "The law knows nothing of the path's curvature: an offset that bends the way takes an error of the heading, "
        "so the swimmer runs wide on the outer side of every bend."
    )


def _turning_words(study: BeyondStudy) -> Iterator[str]:
    settings = study.settings.turning
    low, high = (f"{math.degrees(value):.3g}" for value in (settings.offsets[0], settings.offsets[-1]))
    yield (
        f"{len(settings.offsets)} offsets from {low} to {high} deg, {settings.duration:g} s each, straight and at rest "
        "at first; nothing is controlled."
    )
    for curve in study.turning:
        yield _turning_finding(curve, settings.offsets)
    tightest = study.settings.curved.tightest_radius
    needed = [(curve, _offset_for(curve, settings.offsets, tightest)) for curve in study.turning]
    said = [f"{curve.swimmer.name} {math.degrees(offset):.1f} deg" for curve, offset in needed if offset is not None]
    if said:
        yield f"A turn as tight as the curve above, {tightest:.2f} m, takes an offset of: {', '.join(said)}."


def _turning_finding(curve: TurningCurve, offsets: tuple[float, ...]) -> str:
    first, last = (math.degrees(rate) for rate in curve.turning_rate[[0, -1]].tolist())
    wide, tight = curve.radius[[0, -1]].tolist()
    per_offset = [rate / offset for rate, offset in zip(curve.turning_rate.tolist(), offsets, strict=True)]
    slowed = 100.0 * (1.0 - float(curve.path_speed[-1] / curve.path_speed[0]))
    return (
        f"{curve.swimmer.name.capitalize()}: {first:.1f} to {last:.1f} deg/s, {min(per_offset):.2f} to "
        f"{max(per_offset):.2f} deg/s per degree of offset; radius {wide:.2f} to {tight:.2f} m, the tightest "
        f"{tight / curve.swimmer.length:.2f} robot lengths; the largest offset swims {slowed:.0f} % slower than the "
        "smallest."
    )


def _offset_for(curve: TurningCurve, offsets: tuple[float, ...], radius: float) -> float | None:
    """The offset [rad] that turns at a radius [m], between two that were run; None outside."""
    found = curve.radius
    if not (np.all(np.diff(found) < 0.0) and found[-1] <= radius <= found[0]):
        return None
    return float(np.interp(-math.log(radius), -np.log(found), offsets))
