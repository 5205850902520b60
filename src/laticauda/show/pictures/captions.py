"""Text on a picture, legible on any background."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from laticauda.show.pictures.stage import Picture

Color = tuple[int, int, int]
"""Red, green and blue, each from 0 to 255."""
MARGIN = 0.045
"""Margin, like the sizes of text, in heights of the picture."""
LARGE = 0.052
"""Size of the figures."""
SMALL = 0.029
"""Size of the lines."""
UNIT_SIZE = 0.62
"""Size of a unit relative to its figure."""
FIGURE_GAP = 0.22
"""Gap between a figure and its unit, in sizes of figures."""
UNIT_GAP = 1.3
"""Gap between a unit and the next figure, in sizes of figures."""
LINE_SPACING = 1.5
"""Distance between two lines, in sizes of lines."""
WHITE = (255, 255, 255)
PALE = (200, 228, 230)
RIM = (4, 30, 40)
"""Color of the outline."""


class Figure(NamedTuple):
    """A number with its unit, as text."""

    number: str
    unit: str


@dataclass(frozen=True, kw_only=True)
class Style:
    """How text is written."""

    font: str
    """File name of a font, without its ending."""
    size: int
    """[pixels]."""
    color: Color


class Label(NamedTuple):
    """Text as a picture, with a margin as wide as the text is high."""

    image: Any
    """Picture with transparency."""
    length: int
    """Length of the text alone [pixels]."""


def write_captions(picture: Picture, figures: Sequence[Figure], lines: Sequence[str]) -> Picture:
    """Return the picture with text on it.

    Args:
        picture: The picture to write on.
        figures: Figures, from left to right at the top.
        lines: Lines at the bottom left.
    """
    image = Image.fromarray(picture)
    height = picture.shape[0]
    _write_figures(image, height, figures)
    _write_lines(image, height, lines)
    return np.asarray(image)


def _write_figures(image: Any, height: int, figures: Sequence[Figure]) -> None:
    """Write figures at the top of an image of some height [pixels]."""
    margin = round(MARGIN * height)
    size = round(LARGE * height)
    number_style = Style(font="DejaVuSans-Bold", size=size, color=WHITE)
    unit_style = Style(font="DejaVuSans", size=round(UNIT_SIZE * size), color=PALE)
    x = margin
    y = margin + size
    for figure in figures:
        x += _write(image, x, y, figure.number, number_style) + round(FIGURE_GAP * size)
        x += _write(image, x, y, figure.unit, unit_style) + round(UNIT_GAP * size)


def _write_lines(image: Any, height: int, lines: Sequence[str]) -> None:
    """Write lines at the bottom of an image of some height [pixels], from the last one upward.

    The first line is brighter than the others.
    """
    margin = round(MARGIN * height)
    size = round(SMALL * height)
    top = len(lines) - 1
    for above, text in enumerate(reversed(lines)):
        color = WHITE if above == top else PALE
        y = height - margin - round(LINE_SPACING * size * above)
        _write(image, margin, y, text, Style(font="DejaVuSans", size=size, color=color))


def _write(image: Any, x: int, y: int, text: str, style: Style) -> int:
    """Write text with the start of its baseline at a point; return its length [pixels]."""
    label = _draw_label(text, style)
    image.paste(label.image, (x - style.size, y - 2 * style.size), label.image)
    return label.length


@lru_cache(maxsize=256)
def _draw_label(text: str, style: Style) -> Label:
    """Return text with a margin and a dark outline.

    The font comes with matplotlib and is therefore always available.
    """
    size = style.size
    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{style.font}.ttf"
    font = ImageFont.truetype(str(file), size)
    length = round(font.getlength(text))
    image = Image.new("RGBA", (length + 2 * size, 3 * size), (*RIM, 0))
    ImageDraw.Draw(image).text(
        (size, 2 * size),
        text,
        font=font,
        fill=style.color,
        anchor="ls",
        stroke_width=max(1, size // 16),
        stroke_fill=RIM,
    )
    return Label(image, length)
