"""The stability maps for readers: figure, tables, and what their chapter of the report speaks of."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.datasets import to_dataset
from laticauda.paper.report.chapter import paper_chapter
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
    return paper_chapter(
        "stability",
        values={
            "study": study,
            "settings": study.settings,
            "at_the_papers_gains": _at_the_papers_gains(study),
            "rule": _rule_of_thumb(study),
            "shortest": _shortest(study),
            "speeds": _speeds(study),
        },
        tables={"stability-boundary": _boundary(study), "stability": _points(study)},
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
            "behavior": str(loops.behaviors[i, j]),
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
    distance, gain = study.settings.paper
    said: dict[str, list[tuple[str, str, float]]] = {words: [] for words in HEADINGS.values()}
    for found, kind, loops in _all_loops(study):
        here = np.ix_(loops.look_ahead_distances == distance, np.isclose(loops.gains, gain))
        for name, rms in zip(loops.behaviors[here].flat, loops.rms[here].flat, strict=True):
            said[HEADINGS[kind]].append((found.swimmer.name, str(name), float(rms)))
    return {words: loops for words, loops in said.items() if loops}


def _rule_of_thumb(study: StabilityStudy) -> dict[str, int]:
    """Whether two robot lengths are enough, and whether they are needed: loops with the mean heading, counted."""
    counts: dict[str, int] = dict.fromkeys(("n_above", "swinging_above", "n_below", "settled_below"), 0)
    for found in study.maps:
        loops, behaviors = found.cycle_mean, found.cycle_mean.behaviors
        above = loops.look_ahead_distances >= 2.0 * found.swimmer.length * (1.0 - 1e-9)
        counts["n_above"] += behaviors[above].size
        counts["n_below"] += behaviors[~above].size
        counts["swinging_above"] += int(np.sum(behaviors[above] == SWINGS))
        counts["settled_below"] += int(np.sum(behaviors[~above] == SETTLED))
    return counts


def _shortest(study: StabilityStudy) -> list[tuple[str, float | None]]:
    """By swimmer, the shortest look-ahead distance that settles at the paper's gain with the mean heading [m]."""
    at = [j for j, gain in enumerate(study.settings.gains) if math.isclose(gain, study.settings.paper[1])]
    return [(found.swimmer.name, found.cycle_mean.shortest[j]) for j in at for found in study.maps]


def _speeds(study: StabilityStudy) -> list[tuple[str, list[float], list[float]]]:
    """By swimmer that has both, the speeds of loops that settle and of those in a limit cycle [m/s]."""
    found: list[tuple[str, list[float], list[float]]] = []
    for one in study.maps:
        behaviors, speeds = one.cycle_mean.behaviors, one.cycle_mean.forward_velocity
        settled, swinging = (speeds[behaviors == which].tolist() for which in (SETTLED, SWINGS))
        if settled and swinging:
            found.append((one.swimmer.name, settled, swinging))
    return found
