"""Bodies of some gaits of a front, each in the middle of its wave, with the parameters of its point."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

import laticauda as lc
from laticauda.models.simulate import list_parameters
from laticauda.show.figures import posture, style
from laticauda.show.reports.front_axes import LETTERS, choose_marked_points
from laticauda.studies import Front

Outline = Float[np.ndarray, "n_corners 2"]
"""Trailing edge and link ends of a body [m]."""

SYMBOLS = {
    "amplitude": "$\\alpha$",
    "frequency": "$\\omega$",
    "phase shift": "$\\delta$",
    "n links": "$n$",
}
"""Symbols of parameters; others are named in words, after these."""
LINE_LENGTH = 34
"""Characters per line below a body, symbols counted as one [-]."""
GAP = 0.12
"""Gap between two bodies, as a multiple of the longest length [-]."""
THICKNESS = 0.15
"""Thickness of a body and the space around it, as a multiple of the longest length [-]."""
TEXT_HEIGHT = 0.1
"""Height of a line of text, as a multiple of the longest length [-]."""
TEXT_STYLE: Any = {"fontsize": style.TICK - 1.0, "ha": "left"}
N_PHASES = 24
"""Phases of half a cycle at which a body is looked at [-]."""


class LabeledNumber(NamedTuple):
    """A parameter of a point as text."""

    label: str
    """Name in words, without the part of the scenario that it belongs to [-]."""
    text: str
    """Value with its unit [-]."""


def name_in_words(name: str) -> str:
    """Return a name with spaces.

    Args:
        name: Name of a parameter or figure.
    """
    return name.replace("_", " ")


def describe_point(front: Front, point: int) -> str:
    """Return the parameters of a point as text, in one or more lines.

    Args:
        front: Result of `optimize`.
        point: Index of the point.
    """
    parameters = list_parameters(front.optimization.scenario)
    numbers: list[LabeledNumber] = []
    for name, value in zip(front.optimization.names, front.values[point], strict=True):
        _, path = name.split(".", 1)
        label = name_in_words(path).replace(".", " ").removeprefix("caudal ")
        text = _format_with_unit(value, parameters[name].unit)
        numbers.append(LabeledNumber(label=label, text=text))
    numbers.sort(key=lambda number: number.label not in SYMBOLS)
    lines: list[str] = []
    free_length = 0
    for number in numbers:
        symbol = SYMBOLS.get(number.label, number.label)
        equation = f"{symbol} = {number.text}"
        plain_symbol = number.label
        if number.label in SYMBOLS:
            plain_symbol = "x"  # one character, whatever its markup
        length = len(f"{plain_symbol} = {number.text}, ")
        if length > free_length:
            lines.append(equation)
            free_length = LINE_LENGTH
        else:
            lines[-1] += f", {equation}"
        free_length -= length
    return "\n".join(lines)


def _format_with_unit(value: float, unit: str) -> str:
    """Return a number with its unit, angles in degrees."""
    if unit.startswith("rad"):
        return f"{math.degrees(value):.0f}°{unit.removeprefix('rad')}"
    return f"{value:.3g} {unit}".strip()


def draw_bodies(
    front: Front, texts: Sequence[str], ax: Axes, *, first_letter: int, color: str
) -> Axes:
    """Draw the marked bodies one below the other on one scale, each in the middle of its wave, with its parameters.

    Args:
        front: Front whose marked points are drawn.
        texts: Text below each body.
        ax: Axes to draw on.
        first_letter: Index of the first body's letter in `LETTERS`.
        color: Color of the letters.
    """
    scenarios = [front.scenario(point) for point in choose_marked_points(front)]
    outlines = [_straightest_outline(scenario.robot, scenario.gait) for scenario in scenarios]
    longest = max(float(np.ptp(outline[:, 0])) for outline in outlines)
    top = 0.0
    for number, (scenario, text) in enumerate(zip(scenarios, texts, strict=True)):
        outline = outlines[number]
        low = outline.min(axis=0)
        high = outline.max(axis=0)
        middle = 0.5 * (low + high)
        height = float(high[1] - low[1]) + THICKNESS * longest
        centered_outline = outline - middle + (0.0, top - 0.5 * height)
        posture.draw_posture(ax, scenario.robot.planar(), centered_outline, 0.0)
        ax.text(
            -0.66 * longest,
            top - height / 2,
            LETTERS[first_letter + number],
            color=color,
            fontweight="bold",
            va="center",
            **TEXT_STYLE,
        )
        ax.text(
            -0.56 * longest,
            top - height,
            text,
            color=style.INK,
            va="top",
            linespacing=1.05,
            **TEXT_STYLE,
        )
        n_lines = text.count("\n") + 1
        top -= height + (TEXT_HEIGHT * n_lines + GAP) * longest
    ax.set_xlim(-0.68 * longest, 0.6 * longest)
    ax.set_ylim(top, 0.02 * longest)
    ax.set_aspect("equal")
    ax.axis("off")
    return ax


def _straightest_outline(robot: lc.Robot, gait: lc.Gait) -> Outline:
    """Return the outline of a body in its gait, on average along x, when it is straightest."""
    planar_robot = robot.planar()
    envelope = np.array(gait.joint_envelope(planar_robot.n_links))
    phase_of_joint = gait.phase_shift * np.arange(envelope.size)
    center = np.zeros(2)
    outlines: list[Outline] = []
    for phase in np.linspace(0.0, np.pi, N_PHASES, endpoint=False):
        joint_angles = gait.amplitude * envelope * np.sin(phase + phase_of_joint) + gait.offset
        link_angles = np.concatenate(([0.0], np.cumsum(joint_angles)))
        link_angles -= link_angles.mean()
        outlines.append(posture.posture_outline(planar_robot, center, link_angles))
    return min(outlines, key=_width_across)


def _width_across(outline: Outline) -> float:
    """Return how far an outline extends across the x axis [m]."""
    return float(np.ptp(outline[:, 1]))
