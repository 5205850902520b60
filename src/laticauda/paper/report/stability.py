"""The stability maps for readers: figure, tables, and their section of the report."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from laticauda.paper.report.swimmers import swimmers_in_words
from laticauda.paper.stability import Loops, StabilityMap, StabilityStudy
from laticauda.paper.stability_dataset import write_stability_netcdf
from laticauda.reports.chapter import Chapter, Pictures
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section
from laticauda.reports.tables import Cell, Column, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEADINGS = {"cycle_mean": "mean heading", "raw": "raw heading"}
FIGURE = "stability"


def stability_chapter(study: StabilityStudy) -> Chapter:
    """What the stability maps put into the folder and the report.

    Args:
        study: What `run_stability` returned.
    """
    return Chapter(
        section=lambda pictures: stability_section(study, pictures),
        tables=(boundary_table(study), stability_table(study)),
        n_figures=1,
        figures=lambda: stability_figures(study),
        data={"stability.nc": lambda path: write_stability_netcdf(study, path)},
    )


def stability_figures(study: StabilityStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The maps in one figure: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_stability` returned.
    """
    from laticauda.paper.figures.stability import StabilityPanel, stability_sheet

    settings = study.settings
    panels = [
        StabilityPanel(
            title=found.swimmer.name,
            look_ahead_distances=np.array(settings.look_ahead_distances),
            gains=found.cycle_mean.gains,
            raw_gains=found.raw.gains,
            rms=np.hstack((found.cycle_mean.rms, found.raw.rms)),
            behaviors=tuple(
                (*mean, *raw) for mean, raw in zip(found.cycle_mean.behaviors, found.raw.behaviors, strict=True)
            ),
            rule=2.0 * found.swimmer.length,
            paper=settings.paper,
        )
        for found in study.maps
    ]
    title = "Line of sight over look-ahead distance and gain: where the loop settles on the path"
    caption = (
        f"{title}. Numbers: root mean square of the cycle-mean cross-track error over the last third of "
        f"{settings.duration:g} s [cm]; below {100.0 * settings.tolerance:g} cm a loop has settled. The dashed line is "
        "the rule of thumb, two lengths of the robot with its fin; the frames are the paper's gains."
    )
    start = f"start {settings.initial_cross_track_error:g} m beside the path, {settings.duration:g} s"
    yield FIGURE, caption, stability_sheet(panels, title, f"numbers: rms of the mean error, last third [cm]; {start}")


def stability_section(study: StabilityStudy, pictures: Pictures) -> Section:
    """The study's part of the report.

    Args:
        study: What was run.
        pictures: By name of the figure, its caption and the content of its PNG file.
    """
    parts: list[Part] = [
        Heading(text="What was run"),
        Paragraph(text=_what(study)),
        Points(texts=(*_settings(study),)),
        Heading(text="What came out"),
        Points(texts=(*_findings(study),)),
        boundary_table(study),
        *(
            Picture(png=png, caption=caption, description=f"{caption} The numbers are in stability.csv.")
            for _, (caption, png) in sorted(pictures.items())
        ),
    ]
    return Section(name="stability", title="Stability of path following", parts=tuple(parts))


# ---- tables --------------------------------------------------------------------------------------------------------


def boundary_table(study: StabilityStudy) -> Table:
    """How long a look-ahead distance each gain takes.

    Args:
        study: What `run_stability` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for found, kind, loops in _all_loops(study):
        shortest = loops.shortest(study.settings.look_ahead_distances)
        for gain, distance in zip(loops.gains.tolist(), shortest, strict=True):
            lengths = None if distance is None else distance / found.swimmer.length
            rows.append((found.swimmer.name, HEADINGS[kind], gain, distance, lengths))
    return Table(
        name="stability-boundary",
        grouped=True,
        caption="The shortest look-ahead distance of the map that settles and is longer than all that swing in a limit "
        "cycle, by gain; in lengths of the robot with its fin too. NA: none settles.",
        columns=(
            Column(name="swimmer"),
            Column(name="heading"),
            Column(name="gain [-]"),
            Column(name="shortest look-ahead distance [m]"),
            Column(name="in robot lengths [-]", form=".2f"),
        ),
        rows=tuple(rows),
    )


def stability_table(study: StabilityStudy) -> Table:
    """Every point of every map, a row each.

    Args:
        study: What `run_stability` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for found, kind, loops in _all_loops(study):
        for i, distance in enumerate(study.settings.look_ahead_distances):
            for j, gain in enumerate(loops.gains.tolist()):
                numbers = (grid[i, j] for grid in (loops.rms, loops.rms_before, loops.forward_velocity))
                row = (found.swimmer.name, HEADINGS[kind], distance, gain, loops.behaviors[i][j])
                rows.append((*row, *map(float, numbers)))
    return Table(
        name="stability",
        caption="Every point of the stability maps.",
        columns=(
            Column(name="swimmer"),
            Column(name="heading"),
            Column(name="look-ahead distance [m]"),
            Column(name="gain [-]"),
            Column(name="behavior"),
            Column(name="rms of the mean error, last third [m]", form=".4f"),
            Column(name="rms of the mean error, second third [m]", form=".4f"),
            Column(name="v [m/s]", form=".4f"),
        ),
        rows=tuple(rows),
    )


def _all_loops(study: StabilityStudy) -> Iterator[tuple[StabilityMap, str, Loops]]:
    for found in study.maps:
        yield found, "cycle_mean", found.cycle_mean
        yield found, "raw", found.raw


# ---- words ---------------------------------------------------------------------------------------------------------


def _what(study: StabilityStudy) -> str:
    settings = study.settings
    return (
        f"{settings.n_runs} runs of line of sight along a straight path: {len(settings.look_ahead_distances)} "
        f"look-ahead distances with {len(settings.gains)} gains for the mean heading over the gait cycle, and with "
        f"{len(settings.raw_gains)} for the raw heading, the paper's (6) as it is. The paper gives one pair. The "
        "mean heading is free of the gait's ripple, but half a gait period late; the maps show what that costs."
    )


def _settings(study: StabilityStudy) -> Iterator[str]:
    settings = study.settings
    yield (
        f"Every run takes {settings.duration:g} s and begins {settings.initial_cross_track_error:g} m beside the path, "
        f"along it and at rest; offset within ±{math.degrees(settings.max_offset):g} deg, asked for every "
        f"{settings.control_interval:g} s."
    )
    yield (
        "Rule, on the cycle-mean cross-track error: settled, if its root mean square over the last third of the run is "
        f"below {100.0 * settings.tolerance:g} cm; else still coming, if its mean square has at least halved since the "
        "second third; else a limit cycle. Another start, duration or joint law moves the boundary."
    )
    yield from swimmers_in_words([found.swimmer for found in study.maps], study.how)


def _findings(study: StabilityStudy) -> Iterator[str]:
    yield from _at_the_papers_gains(study)
    yield from _rule_of_thumb(study)
    yield from _cost_of_swinging(study)


def _at_the_papers_gains(study: StabilityStudy) -> Iterator[str]:
    """What the loop does with the paper's pair, with either heading."""
    settings = study.settings
    distance, gain = settings.paper
    if distance not in settings.look_ahead_distances:
        return
    row = settings.look_ahead_distances.index(distance)
    for kind, words in HEADINGS.items():
        said: list[str] = []
        for found, which, loops in _all_loops(study):
            for j in np.flatnonzero(np.isclose(loops.gains, gain)).tolist() if which == kind else []:
                error = 100.0 * float(loops.rms[row, j])
                said.append(f"{found.swimmer.name}: {loops.behaviors[row][j]}, {error:.1f} cm")
        if said:
            yield f"At the paper's gains ({distance:g} m, {gain:g}) with the {words}: {'; '.join(said)}."


def _rule_of_thumb(study: StabilityStudy) -> Iterator[str]:
    """Whether two robot lengths are enough, and whether they are needed."""
    n_above, swinging_above, n_below, settled_below = 0, 0, 0, 0
    for found in study.maps:
        pairs = zip(study.settings.look_ahead_distances, found.cycle_mean.behaviors, strict=True)
        for distance, behaviors in pairs:
            if distance >= 2.0 * found.swimmer.length * (1.0 - 1e-9):
                n_above += len(behaviors)
                swinging_above += behaviors.count("limit cycle")
            else:
                n_below += len(behaviors)
                settled_below += behaviors.count("settled")
    if n_above:
        yield (
            f"Rule of thumb, a look-ahead distance of two robot lengths or more, mean heading: {swinging_above} of "
            f"{n_above} loops that keep it swing in a limit cycle; of the {n_below} that do not keep it, "
            f"{settled_below} settle all the same."
        )
    for j, gain in enumerate(study.settings.gains):
        distances = [found.cycle_mean.shortest(study.settings.look_ahead_distances)[j] for found in study.maps]
        if math.isclose(gain, study.settings.paper[1]):
            said = (
                f"{found.swimmer.name} {'none' if distance is None else f'{distance:g} m'}"
                for found, distance in zip(study.maps, distances, strict=True)
            )
            yield f"The shortest that settles with the mean heading at a gain of {gain:g}: {', '.join(said)}."


def _cost_of_swinging(study: StabilityStudy) -> Iterator[str]:
    """How much speed limit cycles cost."""
    for found in study.maps:
        speeds: dict[str, list[float]] = {}
        for behaviors, row in zip(found.cycle_mean.behaviors, found.cycle_mean.forward_velocity, strict=True):
            for one, speed in zip(behaviors, row.tolist(), strict=True):
                speeds.setdefault(one, []).append(speed)
        if {"settled", "limit cycle"} <= set(speeds):
            kept, lost = speeds["settled"], speeds["limit cycle"]
            yield (
                f"{found.swimmer.name.capitalize()}, mean heading: loops that settle swim {min(kept):.3f} to "
                f"{max(kept):.3f} m/s (5), those in a limit cycle {min(lost):.3f} to {max(lost):.3f} m/s."
            )
