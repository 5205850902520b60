"""What was run beyond the paper, for readers: figures, tables, and what its chapter of the report speaks of."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.beyond import BeyondStudy, TurningCurve
from laticauda.paper.datasets import to_dataset
from laticauda.paper.report.chapter import degrees, paper_chapter
from laticauda.reports.chapter import Chapter
from laticauda.trial.cycles import CycleMean

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DRIFT, CURVED, TURNING = "beyond-cross-current", "beyond-curved-path", "beyond-turning"


def beyond_chapter(study: BeyondStudy) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_beyond` returned.
    """
    settings = study.settings
    tightest = settings.curved.tightest_radius
    needed = {curve.swimmer.name: _offset_for(curve, settings.turning.offsets, tightest) for curve in study.turning}
    return paper_chapter(
        "beyond",
        values={
            "study": study,
            "settings": settings,
            "needed": {name: offset for name, offset in needed.items() if offset is not None},
            "turns": [_turns(curve, settings.turning.offsets) for curve in study.turning],
        },
        tables={DRIFT: _drift(study), CURVED: _curved(study), TURNING: _turning(study)},
        n_figures=3,
        figures=lambda: beyond_figures(study),
        data={"beyond.nc": lambda: to_dataset(study)},
    )


def beyond_figures(study: BeyondStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The study's figures, one after the other: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_beyond` returned.
    """
    yield DRIFT, *_drift_figure(study)
    yield CURVED, *_curved_figure(study)
    yield TURNING, *_turning_figure(study)


# ---- tables and findings -------------------------------------------------------------------------------------------


def _drift(study: BeyondStudy) -> list[dict[str, Any]]:
    """The cross current, law by law."""
    return [
        {
            "law": run.law.name,
            "look-ahead distance Delta [m]": run.law.guidance.look_ahead_distance,
            "gain [-]": run.law.gain,
            "integral gain [m/s]": getattr(run.law.guidance, "integral_gain", None),
            "mean e, last third [m]": run.mean_error,
            "rms of e, last third [m]": run.rms_error,
            "largest e [m]": run.largest_error,
            "e at the end [m]": run.final_error,
            "sideslip [deg]": math.degrees(run.trial.sideslip),
            "Delta tan(sideslip) [m]": run.geometric_error,
            "v [m/s]": run.trial.forward_velocity,
            "holds the path": run.holds,
        }
        for run in study.drift
    ]


def _curved(study: BeyondStudy) -> list[dict[str, Any]]:
    """The curved path, swimmer by swimmer."""
    length = study.settings.curved.path.length
    return [
        {
            "swimmer": run.swimmer.name,
            "rms of the mean error [m]": run.rms,
            "largest mean error [m]": run.largest,
            "reached the end": run.reached_end,
            "after [s]": run.trial.duration,
            "progress [m/s]": length / run.trial.duration if run.reached_end else None,
            "path speed [m/s]": run.trial.path_speed,
            "mechanical power [W]": run.trial.mechanical_power,
        }
        for run in study.curved
    ]


def _turning(study: BeyondStudy) -> list[dict[str, Any]]:
    """Open-loop turning, offset by offset."""
    return [
        {
            "swimmer": curve.swimmer.name,
            "offset [deg]": degrees(offset),
            "turning rate [deg/s]": math.degrees(curve.turning_rate[i]),
            "radius [m]": curve.radius[i],
            "radius in robot lengths [-]": curve.radius[i] / curve.swimmer.length,
            "path speed [m/s]": curve.path_speed[i],
            "mechanical power [W]": curve.mechanical_power[i],
        }
        for curve in study.turning
        for i, offset in enumerate(study.settings.turning.offsets)
    ]


def _turns(curve: TurningCurve, offsets: tuple[float, ...]) -> dict[str, Any]:
    """How fast and how tightly one swimmer turns."""
    return {
        "name": curve.swimmer.name,
        "rates": np.degrees(curve.turning_rate[[0, -1]]).tolist(),
        "radii": curve.radius[[0, -1]].tolist(),
        "per_offset": [rate / offset for rate, offset in zip(curve.turning_rate.tolist(), offsets, strict=True)],
        "tightest": float(curve.radius[-1]) / curve.swimmer.length,
        "slowed": 100.0 * (1.0 - float(curve.path_speed[-1] / curve.path_speed[0])),
    }


def _offset_for(curve: TurningCurve, offsets: tuple[float, ...], radius: float) -> float | None:
    """The offset [rad] that turns at a radius [m], between two that were run; None outside."""
    found = curve.radius
    if not (np.all(np.diff(found) < 0.0) and found[-1] <= radius <= found[0]):
        return None
    return float(np.interp(-math.log(radius), -np.log(found), offsets))


# ---- figures -------------------------------------------------------------------------------------------------------


def _drift_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.beyond import runs_sheet

    settings = study.settings.drift
    title = (
        f"{settings.swimmer.name.capitalize()} in a current of {math.hypot(*settings.current):g} m/s across the path"
    )
    lines = [(run.law.name, run.error) for run in study.drift]
    figure = runs_sheet(
        [(run.law.name, run.trial) for run in study.drift[:2]],
        lines,
        title,
        xlabel="time [s]",
        tolerance=settings.tolerance,
    )
    return f"{title}: the way, and the cycle-mean cross-track error. Simulation only.", figure


def _curved_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.beyond import runs_sheet

    title = f"A curved path, line of sight with {study.settings.curved.law.name}"
    lines = [(run.swimmer.name, CycleMean(run.along, run.error.value)) for run in study.curved]
    shown = [(run.swimmer.name, run.trial) for run in study.curved[:2]]
    figure = runs_sheet(shown, lines, title, xlabel="distance along the path [m]")
    return f"{title}: the way, and the cycle-mean cross-track error. Simulation only.", figure


def _turning_figure(study: BeyondStudy) -> tuple[str, "Figure"]:
    from laticauda.paper.figures.beyond import turning_sheet

    title = "Turning with a constant offset of all joints"
    return f"{title}: turning rate, radius and path speed. Simulation only.", turning_sheet(study.turning, title)
