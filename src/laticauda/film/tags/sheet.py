"""The sheet of tags to print, at true scale, as a PDF."""

# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from laticauda.film.tags.layout import CELLS, DICTIONARIES, TagLayout, describe_placing
from laticauda.film.vision import load_opencv
from laticauda.values import BadArgument, check_choice, files

PAPERS = {"a4": (210.0, 297.0), "a3": (297.0, 420.0), "letter": (215.9, 279.4)}
"""Width and height of papers [mm]."""
EDGE = 12.0
"""What a printer cannot reach, on every side [mm]."""
CAPTION = 9.0
"""Height of the text below a tag [mm]."""
HEAD = 22.0
"""Height of the line that shows the scale [mm]."""
INCH = 25.4
POINTS_PER_MM = 72.0 / INCH
RULER = 100.0
"""Length of the line that shows the scale [mm]."""


class _Printed(NamedTuple):
    """A tag to be printed."""

    number: int
    size: float
    """Side of the black square [mm]."""
    caption: str


class _Page(NamedTuple):
    tags: list[tuple[_Printed, float, float]]
    """Tags with the left and lower edges of their white margins [mm]."""


def write_sheet(layout: TagLayout, path: str | Path, paper: str = "a4") -> int:
    """Write the sheet of tags as a PDF.

    Args:
        layout: The tags.
        path: Path of the PDF.
        paper: `a4`, `a3` or `letter`.

    Returns:
        The number of pages, the instructions too.

    Raises:
        ValueError: If a tag is larger than the paper.
        MissingExtra: If OpenCV is not installed.
        StorageFailed: If it cannot be written.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    figures = draw_sheet(layout, paper)

    def write_pages(target: Path) -> None:
        with PdfPages(target) as pages:
            for figure in figures:
                pages.savefig(figure)

    files.write(path, write_pages)
    return len(figures)


def draw_sheet(layout: TagLayout, paper: str = "a4") -> list[Figure]:
    """Draw the pages of the sheet: instructions first, then the tags.

    Args:
        layout: The tags.
        paper: `a4`, `a3` or `letter`.

    Raises:
        ValueError: If a tag is larger than the paper.
        MissingExtra: If OpenCV is not installed.
    """
    size = PAPERS[check_choice("paper", paper, tuple(PAPERS))]
    figures = [_draw_instructions(layout, size)]
    printed = _list_tags(layout)
    n_cells = CELLS[layout.dictionary]
    for name, tags in printed.items():
        for page in _lay_out(tags, size, n_cells, name):
            figures.append(_draw_page(page, size, layout))
    return figures


def _list_tags(layout: TagLayout) -> dict[str, list[_Printed]]:
    """Return what is printed, by the name of its size."""
    floor: list[_Printed] = []
    for tag in layout.floor:
        caption = f"tag {tag.number}: floor or rim, at x = {tag.x:g} m, y = {tag.y:g} m"
        floor.append(_Printed(tag.number, 1e3 * layout.floor_size, caption))
    links: list[_Printed] = []
    for tag in layout.links:
        caption = f"tag {tag.number}: link {tag.link}"
        if tag.link == 0:
            caption += " (tail)"
        links.append(_Printed(tag.number, 1e3 * layout.link_size, caption))
    return {"floor_size": floor, "link_size": links}


def _lay_out(
    tags: Sequence[_Printed], size: tuple[float, float], n_cells: int, name: str
) -> list[_Page]:
    """Return the tags on pages, row by row."""
    pages: list[_Page] = []
    if not tags:
        return pages
    whole = tags[0].size * (1.0 + 2.0 / n_cells)
    usable_width = size[0] - 2.0 * EDGE
    usable_height = size[1] - 2.0 * EDGE - HEAD
    n_columns = int(usable_width // whole)
    n_rows = int(usable_height // (whole + CAPTION))
    if n_columns < 1 or n_rows < 1:
        largest = min(usable_width, usable_height - CAPTION) / (1.0 + 2.0 / n_cells)
        rule = f"must be at most {math.floor(largest) / 1e3:.3f} m on this paper"
        raise BadArgument(name, f"{rule}, got {1e-3 * tags[0].size:g} m")
    for i, tag in enumerate(tags):
        row, column = divmod(i % (n_columns * n_rows), n_columns)
        if row == 0 and column == 0:
            pages.append(_Page([]))
        left = EDGE + column * whole
        lower = size[1] - EDGE - HEAD - (row + 1) * (whole + CAPTION) + CAPTION
        pages[-1].tags.append((tag, left, lower))
    return pages


def pattern_of(number: int, dictionary: str) -> np.ndarray:
    """Return the cells of a tag, its black border too: true where it is white, first row on top.

    Args:
        number: Number of the tag.
        dictionary: Set of tags, one of `DICTIONARIES`.
    """
    opencv = load_opencv("Drawing tags")
    tags_of_set = opencv.aruco.getPredefinedDictionary(
        getattr(opencv.aruco, DICTIONARIES[dictionary])
    )
    cells = opencv.aruco.generateImageMarker(tags_of_set, number, CELLS[dictionary])
    return np.asarray(cells) > 127


# ---- drawing -------------------------------------------------------------------------------------


def _new_page(size: tuple[float, float]) -> tuple[Figure, Any]:
    """Return a page whose axes count mm from its lower left corner."""
    figure = Figure(figsize=(size[0] / INCH, size[1] / INCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0.0, size[0])
    axes.set_ylim(0.0, size[1])
    axes.axis("off")
    return figure, axes


def _draw_ruler(axes: Any, size: tuple[float, float]) -> None:
    y = size[1] - EDGE - 5.0
    axes.plot([EDGE, EDGE + RULER], [y, y], color="black", linewidth=0.8)
    for x in np.arange(0.0, RULER + 1.0, 10.0):
        axes.plot([EDGE + x, EDGE + x], [y - 1.5, y + 1.5], color="black", linewidth=0.8)
    text = f"This line is {RULER:g} mm long. If not, the printer scaled the page: print at 100 %."
    axes.text(EDGE, y - 5.0, text, fontsize=8.0, va="top")


def _draw_page(page: _Page, size: tuple[float, float], layout: TagLayout) -> Figure:
    figure, axes = _new_page(size)
    _draw_ruler(axes, size)
    n_cells = CELLS[layout.dictionary]
    for tag, left, lower in page.tags:
        _draw_tag(axes, tag, left, lower, n_cells, layout.dictionary)
    return figure


def _draw_tag(
    axes: Any, tag: _Printed, left: float, lower: float, n_cells: int, dictionary: str
) -> None:
    """Draw a tag with its white margin, which is a cell wide and ends at a line to cut along."""
    from matplotlib.patches import Rectangle

    cell = tag.size / n_cells
    whole = tag.size + 2.0 * cell
    cut: dict[str, Any] = {"edgecolor": "0.6", "linewidth": 0.4, "linestyle": (0, (4, 4))}
    axes.add_patch(Rectangle((left, lower), whole, whole, facecolor="white", **cut))
    square: dict[str, Any] = {"facecolor": "black", "edgecolor": "none", "antialiased": False}
    axes.add_patch(Rectangle((left + cell, lower + cell), tag.size, tag.size, **square))
    square["facecolor"] = "white"
    for row, column in np.argwhere(pattern_of(tag.number, dictionary)):
        corner = (left + (column + 1) * cell, lower + (n_cells - row) * cell)
        axes.add_patch(Rectangle(corner, cell, cell, **square))
    middle = lower + 0.5 * whole
    axes.annotate(
        "",
        xy=(left + whole - 0.15 * cell, middle),
        xytext=(left + whole - 0.85 * cell, middle),
        arrowprops={"arrowstyle": "->", "linewidth": 0.8},
    )
    fontsize = min(8.0, 1.6 * POINTS_PER_MM * whole / len(tag.caption))
    axes.text(left, lower - 1.0, tag.caption, fontsize=fontsize, va="top")


def _draw_instructions(layout: TagLayout, size: tuple[float, float]) -> Figure:
    """Draw the first page: what to do, and a map of the tags on the floor."""
    import textwrap

    figure, axes = _new_page(size)
    _draw_ruler(axes, size)
    y = size[1] - EDGE - HEAD - 6.0
    axes.text(EDGE, y, "Tags for films of a robot", fontsize=15.0, va="top")
    y -= 13.0
    for i, sentence in enumerate(describe_placing(layout), start=1):
        lines = textwrap.wrap(f"{i}. {sentence}", width=int(size[0] / 2.1))
        axes.text(EDGE, y, "\n".join(lines), fontsize=10.0, va="top", linespacing=1.35)
        y -= 5.0 * len(lines) + 3.0
    x_of = np.array([tag.x for tag in layout.floor])
    y_of = np.array([tag.y for tag in layout.floor])
    if layout.floor:
        width = (size[0] - 2.0 * EDGE) / size[0]
        height = (y - 2.0 * EDGE) / size[1]
        small = figure.add_axes(
            (EDGE / size[0] + 0.06, EDGE / size[1] + 0.05, width - 0.1, height - 0.05)
        )
        small.set_aspect("equal", adjustable="datalim")
        small.plot(x_of, y_of, "s", color="black", markersize=9.0)
        for tag in layout.floor:
            small.annotate(
                str(tag.number), (tag.x, tag.y), xytext=(8, 6), textcoords="offset points"
            )
        small.margins(0.15)
        small.set_xlabel("x [m]")
        small.set_ylabel("y [m]")
        small.set_title("Tags on the floor, seen from above", fontsize=10.0)
    return figure
