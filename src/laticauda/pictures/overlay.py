"""Words on a picture: a clock, the speed, and who swims."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from laticauda.pictures.offscreen import Picture

MARGIN, LARGE, SMALL = 0.045, 0.052, 0.029  # in heights of the picture
WHITE, PALE = (255, 255, 255), (200, 228, 230)
SHADE = 0.55  # what is left of the picture behind the words


def write_words(picture: Picture, large: Sequence[tuple[str, str]], small: Sequence[str]) -> Picture:
    """The picture with its words.

    Args:
        picture: What to write on.
        large: Figures with their units, from left to right at the top.
        small: Lines at the bottom left.
    """
    height = picture.shape[0]
    image = Image.fromarray(picture)
    draw: Any = ImageDraw.Draw(image)
    margin, figure, line = (round(share * height) for share in (MARGIN, LARGE, SMALL))
    x = margin
    for number, unit in large:
        bold, plain = _font(figure, "DejaVuSans-Bold"), _font(round(0.62 * figure), "DejaVuSans")
        _text(draw, (x, margin), number, bold, WHITE, figure)
        x += round(draw.textlength(number, font=bold)) + round(0.22 * figure)
        _text(draw, (x, margin), unit, plain, PALE, figure)
        x += round(draw.textlength(unit, font=plain)) + round(1.3 * figure)
    for k, words in enumerate(reversed(small)):
        at = (margin, height - margin - round(1.5 * line * k) - line)
        _text(draw, at, words, _font(line, "DejaVuSans"), WHITE if k == len(small) - 1 else PALE, line)
    return np.asarray(image)


def _text(draw: Any, at: tuple[int, int], words: str, font: Any, color: tuple[int, int, int], height: int) -> None:
    """Words that stand on the same line whatever their size, with a dark rim so that they can be read on anything."""
    place = (at[0], at[1] + height)
    draw.text(
        place, words, font=font, fill=color, anchor="ls", stroke_width=max(1, height // 16), stroke_fill=(4, 30, 40)
    )


@lru_cache(maxsize=16)
def _font(size: int, name: str) -> Any:
    """A font that comes with matplotlib, and so is everywhere."""
    file = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{name}.ttf"
    return ImageFont.truetype(str(file), size)
