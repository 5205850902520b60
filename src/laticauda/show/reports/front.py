"""Results of an optimization for readers: a figure of the front, with the bodies of some of its gaits."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from laticauda.models.simulate import environment_prefix
from laticauda.show.figures import style
from laticauda.show.reports.front_axes import FRONT_MARKS, choose_marked_points, draw_fronts
from laticauda.show.reports.front_bodies import describe_point, draw_bodies, name_in_words
from laticauda.studies import COSTS, Front
from laticauda.values import renamed_names

__getattr__ = renamed_names(__name__, {"front_figure": ":draw_front_sheet"})

SHEET_HEIGHT = 4.05
"""Height of the figure, without further lines of text below bodies [in]."""
LINE_HEIGHT = 0.11
"""Height of a line of text below a body, after the first line [in]."""
BODIES_WIDTH = 1.75
"""Width of a column of bodies [in]."""


def write_front_figure(fronts: Sequence[Front], folder: str | Path) -> list[Path]:
    """Write front.png and front.pdf, or nothing if there is no front between two objectives.

    Args:
        fronts: One or two fronts with the same two objectives; those without points are left out.
        folder: Existing folder.

    Returns:
        Paths of the files.
    """
    drawn_fronts = [front for front in fronts if len(front) > 1]
    if not drawn_fronts:
        return []
    files = [Path(folder, "front.png"), Path(folder, "front.pdf")]
    style.save_figure(draw_front_sheet(drawn_fronts), *files)
    return files


def draw_front_sheet(fronts: Sequence[Front]) -> Figure:
    """Draw the fronts and some of their gaits, with the measured gaits for this robot and kind of gait.

    Args:
        fronts: One or two fronts with the same two objectives.
    """
    texts_of_fronts: list[list[str]] = []
    n_extra_lines = 0
    for front in fronts:
        texts = [describe_point(front, point) for point in choose_marked_points(front)]
        texts_of_fronts.append(texts)
        line_breaks = sum(text.count("\n") for text in texts)
        n_extra_lines = max(n_extra_lines, line_breaks)
    height = SHEET_HEIGHT + LINE_HEIGHT * n_extra_lines
    figure = style.new_figure(style.DOUBLE_COLUMN, height)
    fronts_width = style.DOUBLE_COLUMN - BODIES_WIDTH * len(fronts)
    widths = [fronts_width, *[BODIES_WIDTH] * len(fronts)]
    columns = figure.add_gridspec(1, len(widths), width_ratios=widths)
    draw_fronts(fronts, figure.add_subplot(columns[0]))
    n_letters = 0
    for number, front in enumerate(fronts):
        texts = texts_of_fronts[number]
        draw_bodies(
            front,
            texts,
            figure.add_subplot(columns[number + 1]),
            first_letter=n_letters,
            color=FRONT_MARKS[number].color,
        )
        n_letters += len(texts)
    note = "\n".join([*_describe_limits(fronts), _write_note(fronts)])
    style.add_title(figure, _write_title(fronts[0]), note)
    return figure


def _write_title(front: Front) -> str:
    first, last = front.optimization.objectives
    objectives = f"{name_in_words(first).capitalize()} against {name_in_words(last)}"
    return f"{objectives}: robot {front.optimization.scenario.robot.name}"


def _describe_limits(fronts: Sequence[Front]) -> list[str]:
    """Return what limits the point of each front that is best in the first objective."""
    lines: list[str] = []
    for front in fronts:
        limits = front.limits(_best_point(front))
        if limits:
            subject = name_in_words(front.optimization.objectives[0])
            if len(fronts) > 1:
                subject += f" in {front.optimization.scenario.gait.words}"
            lines.append(f"{subject.capitalize()} limited by: {', '.join(limits)}")
    return lines


def _best_point(front: Front) -> int:
    """Return the point that is best in the first objective."""
    first, _ = front.optimization.objectives
    values = front.figures[first]
    if first in COSTS:
        return int(np.argmin(values))
    return int(np.argmax(values))


def _write_note(fronts: Sequence[Front]) -> str:
    optimization = fronts[0].optimization
    n_parameters = len(optimization.names)
    n_trials = sum(front.n_trials for front in fronts)
    duration = f"{optimization.scenario.duration:g} s"
    return (
        f"{n_parameters} parameters free, {n_trials} trials of {duration}, {_name_waters(fronts)}"
    )


def _name_waters(fronts: Sequence[Front]) -> str:
    """Return in which water or on which ground the gaits of the fronts move."""
    environments = [front.optimization.scenario.environment for front in fronts]
    names = list(dict.fromkeys(environment.name for environment in environments))
    prefix = environment_prefix(environments[0])
    if len(names) == 1:
        return f"{prefix} {names[0]}"
    return f"each gait with its own {prefix}: {' and '.join(names)}"
