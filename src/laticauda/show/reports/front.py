"""Results of an optimization for readers: the front as files, and as a figure with its gaits."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import laticauda as lc
from laticauda.models.simulate import environment_prefix
from laticauda.models.simulate.numbers import list_parameters
from laticauda.show.figures import posture, style
from laticauda.studies import LABELS, Front
from laticauda.trials import MeasuredTrial, all_measured

Curve = tuple[Float[np.ndarray, " _"], Float[np.ndarray, " _"]]
Points = Float[np.ndarray, "n_corners 2"]

N_MARKS = 5
SYMBOLS = {
    "amplitude": "$\\alpha$",
    "frequency": "$\\omega$",
    "phase shift": "$\\delta$",
    "n links": "$n$",
}
MOST = 34  # characters per line below a body
# By gait, distinguished by the shape of the marks as well.
KINDS = ((style.BLUE, "o"), (style.ORANGE, "s"))
DOT = 4.0  # size of a marked point [pt]
LETTER: Any = {
    "fontsize": 6.5,
    "color": "white",
    "ha": "center",
    "va": "center",
}  # next to the point
AWAY = 8.0  # distance from the point to its letter, in either direction [pt]
OTHER: Any = {"linestyle": "", "marker": "D", "markersize": 4.0, "markerfacecolor": "white"}
SHEET_HEIGHT = 3.9  # [in]
LINE_HEIGHT = 0.11  # height of a line of text below a body, after the first line [in]
COLUMN = 1.75  # width of a column of bodies [in]
LEFT = 0.04  # space for letters next to the first point, as a fraction of the axis
ROOM = 1.06  # end of the axis, as a multiple of the farthest point
GAP = 0.12  # between two bodies, as a multiple of the longest length
THICK = 0.15  # thickness of a body and the space around it, as a multiple of the longest length
TEXT = 0.1  # height of a line of text, as a multiple of the longest length
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
_TEXT: Any = {"fontsize": style.TICK - 1.0, "ha": "left"}


def write_front_figure(fronts: Sequence[Front], folder: str | Path) -> list[Path]:
    """Write front.png and front.pdf, or nothing if there is no front between two objectives.

    Args:
        fronts: One or two fronts with the same two objectives; those without points are left out.
        folder: Existing folder.

    Returns:
        Paths of the files.
    """
    drawn = [front for front in fronts if len(front) > 1]
    if not drawn:
        return []
    files = [Path(folder, "front.png"), Path(folder, "front.pdf")]
    style.save_figure(front_figure(drawn), *files)
    return files


def front_figure(fronts: Sequence[Front]) -> Figure:
    """Draw the fronts and some of their gaits, with the measured gaits for this robot and kind of gait.

    Args:
        fronts: One or two fronts with the same two objectives.
    """
    sought = fronts[0].optimization
    first, last = map(_words, sought.objectives)
    trials = sum(front.n_trials for front in fronts)
    texts = [[_numbers(one, i) for i in marked(one)] for one in fronts]
    more = max(sum(text.count("\n") for text in column) for column in texts)
    figure = style.new_figure(style.DOUBLE_COLUMN, SHEET_HEIGHT + LINE_HEIGHT * more)
    widths = (style.DOUBLE_COLUMN - COLUMN * len(fronts), *[COLUMN] * len(fronts))
    left, *columns = figure.add_gridspec(1, 1 + len(fronts), width_ratios=widths)
    draw_front(fronts, figure.add_subplot(left))
    letters = iter(LETTERS)
    for one, words, (color, _), column in zip(fronts, texts, KINDS, columns, strict=False):
        draw_bodies(one, words, letters, color, figure.add_subplot(column))
    title = f"{first.capitalize()} against {last}: robot {sought.scenario.robot.name}"
    note = f"{len(sought.names)} parameters free, {trials} trials of {sought.scenario.duration:g} s, {_waters(fronts)}"
    style.add_title(figure, title, note)
    return figure


def marked(front: Front) -> list[int]:
    """Return the points whose gaits are drawn, without the slowest end, where nobody swims and all fronts meet.

    Args:
        front: Result of `optimize`.
    """
    return front.spread(N_MARKS + 1)[1:]


def _waters(fronts: Sequence[Front]) -> str:
    names = list(dict.fromkeys(front.optimization.scenario.environment.name for front in fronts))
    word = environment_prefix(fronts[0].optimization.scenario.environment)
    return (
        f"{word} {names[0]}"
        if len(names) == 1
        else f"each gait with its own {word}: {' and '.join(names)}"
    )


def measured_points(front: Front) -> np.ndarray:
    """Return the objectives of the measured gaits of this kind with this robot, by row: last objective, first one.

    Args:
        front: Result of `optimize`.
    """
    base = front.optimization.scenario
    gaits = [trial.gait for trial in _measured(front)]
    if not gaits:
        return np.empty((0, 2))
    swims = lc.swim_many([replace(base, motion=gait) for gait in gaits])
    first, last = front.optimization.objectives
    points = np.stack((getattr(swims, last), getattr(swims, first)), axis=1)
    return points[np.isfinite(points).all(axis=1)]


def _measured(front: Front) -> list[MeasuredTrial]:
    """Return the published trials of this robot with this kind of gait."""
    base = front.optimization.scenario
    wanted = base.gait.kind, base.robot.name
    return [
        trial
        for one in all_measured()
        for trial in one.trials()
        if (trial.gait.kind, trial.robot) == wanted
    ]


def _numbers(front: Front, i: int) -> str:
    """Return the parameters of a point as text, in one or more lines."""
    known = list_parameters(front.optimization.scenario)
    words: list[tuple[str, str]] = []
    for name, value in zip(front.optimization.names, front.values[i], strict=True):
        unit, angle = known[name].unit, known[name].unit.startswith("rad")
        number = (
            f"{math.degrees(value):.0f}°{unit.removeprefix('rad')}"
            if angle
            else f"{value:.3g} {unit}".strip()
        )
        words.append(
            (_words(name.split(".", 1)[1]).replace(".", " ").removeprefix("caudal "), number)
        )
    lines: list[str] = []
    room = 0
    for word, number in sorted(words, key=lambda pair: pair[0] not in SYMBOLS):
        length = len(f"{'x' if word in SYMBOLS else word} = {number}, ")
        if length > room:
            lines.append("")
            room = MOST
        room -= length
        lines[-1] += f"{', ' if lines[-1] else ''}{SYMBOLS.get(word, word)} = {number}"
    return "\n".join(lines)


def _words(name: str) -> str:
    return name.replace("_", " ")


# ---- the figure ----------------------------------------------------------------------------------


def draw_front(fronts: Sequence[Front], ax: Axes) -> Axes:
    """Draw one or two fronts, with letters at the marked points, together with the measured gaits.

    Args:
        fronts: Fronts with the same two objectives.
        ax: Axes to draw on.
    """
    letters, curves, others = (
        iter(LETTERS),
        [_curve(one) for one in fronts],
        [measured_points(one) for one in fronts],
    )
    for one, (x, y), points, (color, shape) in zip(fronts, curves, others, KINDS, strict=False):
        ax.plot(
            x, y, color=color, linewidth=1.6, label=one.optimization.scenario.gait.words, zorder=3
        )
        ax.plot(*points.T, color=color, **OTHER, zorder=4)
        side = _side((x, y), curves)
        shift = side[0] * AWAY, side[1] * AWAY
        badge = {
            "boxstyle": "circle,pad=0.25",
            "facecolor": color,
            "edgecolor": "white",
            "linewidth": 0.5,
        }
        for at in zip(x[marked(one)].tolist(), y[marked(one)].tolist(), strict=True):
            ax.plot(*at, shape, color=color, markersize=DOT, clip_on=False, zorder=5)
            style.add_note(ax, next(letters), at, shift, bbox=badge, zorder=6, **LETTER)
    if any(map(len, others)):
        sources = " and ".join(dict.fromkeys(trial.source for trial in _measured(fronts[0])))
        ax.plot([], [], color=style.GRAY, **OTHER, label=f"{sources}'s gaits, simulated alike")
    xs, ys = np.concatenate(
        [*(np.stack(curve) for curve in curves), *(points.T for points in others)], axis=1
    )
    ax.set_xlim(min(0.0, float(xs.min())) - LEFT * float(np.ptp(xs)), ROOM * float(xs.max()))
    ax.set_ylim(min(0.0, float(ys.min())), ROOM * float(ys.max()))
    ax.xaxis.set_major_locator(MaxNLocator(6))
    ax.yaxis.set_major_locator(MaxNLocator(6))
    style.add_legend(ax, loc="lower right")
    ylabel, xlabel = (LABELS[name] for name in fronts[0].optimization.objectives)
    return style.style_axes(ax, xlabel=xlabel, ylabel=ylabel)


def _curve(front: Front) -> Curve:
    """Return the last objective of every point, in ascending order, and the first one."""
    y, x = (front.figures[name] for name in front.optimization.objectives)
    return x, y


def _side(curve: Curve, curves: Sequence[Curve]) -> tuple[int, int]:
    """Return the direction away from a front: towards better points, or worse ones if another front lies there."""
    x, y = curve
    rises = (float(y[-1]) - float(y[0])) >= 0.0
    better = (-1, 1) if rises else (-1, -1)
    middle = float(np.median(x))
    here = float(np.interp(middle, x, y))
    for other in curves:
        there = float(np.interp(middle, *other))
        if other is not curve and (there > here if rises else there < here):
            return -better[0], -better[1]
    return better


def draw_bodies(
    front: Front, texts: Sequence[str], letters: Iterator[str], color: str, ax: Axes
) -> Axes:
    """Draw the marked bodies one below the other on one scale, each in the middle of its wave, with its parameters.

    Args:
        front: Front whose marked points are drawn.
        texts: Text below each body.
        letters: Iterator whose next letters are those of the points.
        color: Color of the letters.
        ax: Axes to draw on.
    """
    swims = [front.scenario(i) for i in marked(front)]
    shapes = [_shape(one.robot, one.gait) for one in swims]
    longest = max(float(np.ptp(shape[:, 0])) for shape in shapes)
    top = 0.0
    for one, text, shape in zip(swims, texts, shapes, strict=True):
        low, high = shape.min(axis=0), shape.max(axis=0)
        middle = 0.5 * (low + high)
        height = float(high[1] - low[1]) + THICK * longest
        posture.draw_posture(
            ax, one.robot.planar(), shape - middle + (0.0, top - 0.5 * height), 0.0
        )
        lines = text.count("\n") + 1
        ax.text(
            -0.66 * longest,
            top - height / 2,
            next(letters),
            color=color,
            fontweight="bold",
            **_TEXT,
            va="center",
        )
        ax.text(
            -0.56 * longest,
            top - height,
            text,
            color=style.INK,
            **_TEXT,
            va="top",
            linespacing=1.05,
        )
        top -= height + (TEXT * lines + GAP) * longest
    ax.set_xlim(-0.68 * longest, 0.6 * longest)
    ax.set_ylim(top, 0.02 * longest)
    ax.set_aspect("equal")
    ax.axis("off")
    return ax


def _shape(robot: lc.Robot, gait: lc.Gait) -> Points:
    """Return trailing edge and link ends of a body in its gait, on average along x, when it is straightest."""
    body = robot.planar()
    envelope = np.array(gait.joint_envelope(body.n_links))
    wave = gait.phase_shift * np.arange(envelope.size)
    shapes: list[Points] = []
    for phase in np.linspace(0.0, np.pi, 24, endpoint=False):
        joints = gait.amplitude * envelope * np.sin(phase + wave) + gait.offset
        angles = np.concatenate(([0.0], np.cumsum(joints)))
        center = np.zeros(2)
        angles -= angles.mean()
        shapes.append(posture.posture_outline(body, center, angles))
    return min(shapes, key=lambda shape: float(np.ptp(shape[:, 1])))
