"""The stability maps for readers: figure, tables, and what their chapter of the report speaks of."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.datasets import to_dataset
from laticauda.paper.report.chapter import PaperChapter
from laticauda.paper.stability import SETTLED, SWINGS, Loops, StabilityMap, StabilityStudy
from laticauda.reports.chapter import Chapter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEADINGS = {"cycle_mean": "mean heading", "raw": "raw heading"}


def stability_chapter(study: StabilityStudy) -> Chapter:
    """What the stability maps put into the folder and the report.

    Args:
        study: What `run_stability` returned.
    """
    from pandas import DataFrame

    return PaperChapter(
        name="stability",
        values={
            "study": study,
            "settings": study.settings,
            "at_the_papers_gains": _at_the_papers_gains(study),
            "rule": _rule_of_thumb(study),
            "shortest": _shortest(study),
            "speeds": _speeds(study),
        },
        tables={"stability-boundary": DataFrame(_boundary(study)), "stability": DataFrame(_points(study))},
        n_figures=1,
        figures=lambda: stability_figures(study),
        data={"stability.nc": lambda: to_dataset(study)},
    )


def stability_figures(study: StabilityStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The maps in one figure: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_stability` returned.
    """
    from laticauda.paper.figures.stability import stability_sheet

    settings = study.settings
    title = "Line of sight over look-ahead distance and gain: where the loop settles on the path"
    caption = (
        f"{title}. Numbers: root mean square of the cycle-mean cross-track error over the last third of "
        f"{settings.duration:g} s [cm]; below {100.0 * settings.tolerance:g} cm a loop has settled. The dashed line is "
        "the rule of thumb, two lengths of the robot with its fin; the frames are the paper's gains."
    )
    start = f"start {settings.initial_cross_track_error:g} m beside the path, {settings.duration:g} s"
    note = f"numbers: rms of the mean error, last third [cm]; {start}"
    yield "stability", caption, stability_sheet(study.maps, title, settings.paper, note)


# ---- tables --------------------------------------------------------------------------------------------------------


def _boundary(study: StabilityStudy) -> list[dict[str, Any]]:
    """How long a look-ahead distance each gain takes."""
    return [
        {
            "swimmer": found.swimmer.name,
            "heading": HEADINGS[kind],
            "gain [-]": gain,
            "shortest look-ahead distance [m]": distance,
            "in robot lengths [-]": None if distance is None else distance / found.swimmer.length,
        }
        for found, kind, loops in _all_loops(study)
        for gain, distance in zip(loops.gains.tolist(), loops.shortest, strict=True)
    ]


def _points(study: StabilityStudy) -> list[dict[str, Any]]:
    """Every point of every map."""
    return [
        {
            "swimmer": found.swimmer.name,
            "heading": HEADINGS[kind],
            "look-ahead distance [m]": distance,
            "gain [-]": gain,
            "behavior": loops.behaviors[i][j],
            "rms of the mean error, last third [m]": loops.rms[i, j],
            "rms of the mean error, second third [m]": loops.rms_before[i, j],
            "v [m/s]": loops.forward_velocity[i, j],
        }
        for found, kind, loops in _all_loops(study)
        for i, distance in enumerate(study.settings.look_ahead_distances)
        for j, gain in enumerate(loops.gains.tolist())
    ]


def _all_loops(study: StabilityStudy) -> Iterator[tuple[StabilityMap, str, Loops]]:
    for found in study.maps:
        yield found, "cycle_mean", found.cycle_mean
        yield found, "raw", found.raw


# ---- findings ------------------------------------------------------------------------------------------------------


def _at_the_papers_gains(study: StabilityStudy) -> dict[str, list[tuple[str, str, float]]]:
    """By heading, what the loop of each swimmer does with the paper's pair, and its error [m]."""
    distances, (distance, gain) = np.array(study.settings.look_ahead_distances), study.settings.paper
    said: dict[str, list[tuple[str, str, float]]] = {words: [] for words in HEADINGS.values()}
    for found, kind, loops in _all_loops(study):
        for i in np.flatnonzero(distances == distance).tolist():
            for j in np.flatnonzero(np.isclose(loops.gains, gain)).tolist():
                said[HEADINGS[kind]].append((found.swimmer.name, loops.behaviors[i][j], float(loops.rms[i, j])))
    return {words: loops for words, loops in said.items() if loops}


def _rule_of_thumb(study: StabilityStudy) -> dict[str, int]:
    """Whether two robot lengths are enough, and whether they are needed: loops with the mean heading, counted."""
    counts = {"n_above": 0, "swinging_above": 0, "n_below": 0, "settled_below": 0}
    for found in study.maps:
        pairs = zip(study.settings.look_ahead_distances, found.cycle_mean.behaviors, strict=True)
        for distance, behaviors in pairs:
            above = distance >= 2.0 * found.swimmer.length * (1.0 - 1e-9)
            counts["n_above" if above else "n_below"] += len(behaviors)
            counts["swinging_above"] += behaviors.count(SWINGS) if above else 0
            counts["settled_below"] += 0 if above else behaviors.count(SETTLED)
    return counts


def _shortest(study: StabilityStudy) -> list[tuple[str, float | None]]:
    """By swimmer, the shortest look-ahead distance that settles at the paper's gain with the mean heading [m]."""
    settings = study.settings
    return [
        (found.swimmer.name, found.cycle_mean.shortest[j])
        for j, gain in enumerate(settings.gains)
        if math.isclose(gain, settings.paper[1])
        for found in study.maps
    ]


def _speeds(study: StabilityStudy) -> list[tuple[str, list[float], list[float]]]:
    """By swimmer that has both, the speeds of loops that settle and of those in a limit cycle [m/s]."""
    found: list[tuple[str, list[float], list[float]]] = []
    for one in study.maps:
        behaviors, speeds = np.array(one.cycle_mean.behaviors), one.cycle_mean.forward_velocity
        settled, swinging = (speeds[behaviors == which].tolist() for which in (SETTLED, SWINGS))
        if settled and swinging:
            found.append((one.swimmer.name, settled, swinging))
    return found
