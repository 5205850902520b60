"""Common style of all figures: sizes, colors and labels, for print at journal width.

No global state is changed, neither pyplot's nor matplotlib's settings, so that figures can be
created in any thread and alongside those of the user.
"""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

import base64
import functools
import html
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.text import Text

from laticauda.values import write

DOUBLE_COLUMN = 7.16
"""Width of two columns of a journal [in]."""
LABEL = 9
"""Size of labels [pt]."""
TICK = 8
"""Size of tick labels and legends [pt]."""
THIN = 0.6
"""Width of thin lines [pt]."""
LINE = 1.2
"""Width of lines [pt]."""
DOTS_PER_INCH = 300
"""Resolution of pictures."""
SCREEN_DOTS_PER_INCH = 80
"""Resolution of small pictures beside a table."""

# Okabe and Ito's colors, distinguishable by the color-blind and, as their lightness differs, in
# gray print.
INK = "#222222"
BLUE = "#0072B2"
ORANGE = "#D55E00"
AMBER = "#E69F00"
GRAY = "#8A8A8A"
GRID = "#E4E4E4"
"""Color of lines behind the data."""

SOLID = "-"
DASHED = (0, (5, 2))
DOTTED = (0, (1, 1.5))
DASH_DOT = (0, (5, 1, 1, 1))
LINES: tuple[tuple[str, Any], ...] = (
    (BLUE, SOLID),
    (ORANGE, DASHED),
    (INK, DOTTED),
    (AMBER, DASH_DOT),
)
"""Colors and dashes of several lines."""
LEGEND: Any = {"fontsize": TICK, "labelcolor": INK, "frameon": False}
"""Look of legends."""
AIM: Any = {"color": ORANGE, "linewidth": LINE, "linestyle": (0, (4, 2))}
"""Look of targets and measured values."""
TITLE_MARGIN = 0.01
"""Space beside a title, as a fraction of the width of the figure [-]."""
PANEL_LETTERS = "abcdefgh"
"""Letters of panels."""

Outside = Literal["outside lower center", "outside lower left", "outside right upper"]


class Picture(Figure):
    """A figure that notebooks show, with or without pyplot."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=DOTS_PER_INCH / 2)
        return content.getvalue()


def new_figure(width: float, height: float) -> Figure:
    """Create an empty figure that belongs to no window.

    Args:
        width: Width [in].
        height: Height [in].
    """
    figure = Picture(figsize=(width, height), layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def picture_in_html(ax: Axes, description: str) -> str:
    """Return the figure of axes as a small picture inside a page.

    Args:
        ax: Axes of the figure.
        description: What a reader hears who does not see it.
    """
    content = io.BytesIO()
    figure = ax.get_figure(root=True)
    assert figure is not None  # axes that were just drawn have one
    figure.savefig(content, format="png", dpi=SCREEN_DOTS_PER_INCH)
    data = base64.b64encode(content.getvalue()).decode()
    return f'<img alt="{html.escape(description)}" src="data:image/png;base64,{data}">'


def new_panels(
    n_panels: int = 1, *, width: float = DOUBLE_COLUMN, height: float = 3.0
) -> tuple[Figure, list[Axes]]:
    """Create a figure with panels side by side, whose lines take the colors and dashes of `LINES` in turn.

    Args:
        n_panels: Number of panels.
        width: Width of the figure [in].
        height: Height of the figure [in].

    Example:
        >>> figure, (ax,) = new_panels()
        >>> (line,) = ax.plot([0.0, 1.0], [0.0, 0.2])
        >>> ax = style_axes(ax, xlabel="time [s]", ylabel="distance [m]")
    """
    figure = new_figure(width, height)
    panels: list[Axes] = [*figure.subplots(1, n_panels, squeeze=False)[0]]
    colors, dashes = zip(*LINES, strict=True)
    for ax in panels:
        ax.set_prop_cycle(color=colors, linestyle=dashes)
    return figure, panels


def save_figure(figure: Figure, *paths: str | Path) -> None:
    """Write a figure to one file or several; the same figure always gives the same files.

    Args:
        figure: Any figure; its layout is fixed here.
        paths: The files; their endings .png, .pdf or .svg determine the formats.

    Raises:
        StorageFailed: If a file cannot be written.
    """
    # A date or a version in a file would make every file different.
    metadata_of_format: dict[str, Any] = {
        ".pdf": {"CreationDate": None, "Creator": None},
        ".svg": {"Date": None},
    }
    freeze_layout(figure)
    for path in paths:
        metadata = metadata_of_format.get(Path(path).suffix.lower(), {"Software": None})
        write(path, functools.partial(figure.savefig, dpi=DOTS_PER_INCH, metadata=metadata))


def freeze_layout(figure: Figure) -> None:
    """Fix the layout of a figure; otherwise matplotlib draws everything twice each time, to compute the layout."""
    layout = figure.get_layout_engine()
    if layout is None:
        return
    resolution = figure.get_dpi()
    figure.set_dpi(DOTS_PER_INCH)
    layout.execute(figure)
    figure.set_dpi(resolution)
    figure.set_layout_engine("none")


def style_axes(ax: Axes, *, xlabel: str, ylabel: str) -> Axes:
    """Give axes their labels and the common look."""
    ax.set_xlabel(xlabel, fontsize=LABEL, color=INK)
    ax.set_ylabel(ylabel, fontsize=LABEL, color=INK)
    ax.tick_params(labelsize=TICK, labelcolor=INK, color=GRAY, width=THIN, length=3)
    for axis in (ax.xaxis, ax.yaxis):
        axis.get_offset_text().set_fontsize(TICK)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(GRAY)
        spine.set_linewidth(THIN)
    return ax


def add_title(figure: Figure, title: str, note: str = "") -> Text:
    """Add a title above all panels, with a line below it; the layout reserves space for both.

    Lines that are longer than the figure is wide are broken.

    Args:
        figure: Any figure of `new_figure`.
        title: What the figure shows.
        note: The second line, or several; "" for none.
    """
    text = figure.suptitle(title, fontsize=LABEL, color=INK, x=TITLE_MARGIN, ha="left")
    text.set_linespacing(1.35)
    lines = _break_line(text, title)
    if note:
        for line in note.splitlines():
            lines += _break_line(text, line)
    text.set_text("\n".join(lines))
    return text


def _break_line(text: Text, line: str) -> list[str]:
    """Return a line as several that fit between the margins of the figure of a text."""
    figure: Any = text.get_figure(root=True)
    most = (1.0 - 2.0 * TITLE_MARGIN) * float(figure.bbox.width)
    first_part, *parts = line.split(" ")
    lines = [first_part]
    for part in parts:
        longer_line = f"{lines[-1]} {part}"
        text.set_text(longer_line)
        if text.get_window_extent().width <= most:
            lines[-1] = longer_line
        else:
            lines.append(part)
    return lines


def add_legend(ax: Axes, **settings: Any) -> None:
    """Add a legend without a frame."""
    ax.legend(handlelength=1.6, borderaxespad=0.2, **LEGEND, **settings)


def outside_legend(
    figure: Figure, handles: Sequence[Any], location: Outside, **settings: Any
) -> None:
    """Add a legend outside all panels.

    Args:
        figure: Any figure of `new_figure`.
        handles: Artists to show, each with its label.
        location: Location of the legend.
        settings: Further settings of matplotlib's legend.
    """
    figure.legend(handles=handles, loc=location, **LEGEND, **settings)


def add_letter(ax: Axes, panel: int, description: str = "", pad: float = 4.0) -> None:
    """Add the letter of a panel above its left corner, with a description.

    Args:
        ax: Axes of the panel.
        panel: Index of the panel, from 0.
        description: Description; "" for none.
        pad: Space between the text and the panel [pt].
    """
    text = f"({PANEL_LETTERS[panel]})"
    if description:
        text += f"  {description}"
    ax.set_title(text, fontsize=TICK, color=INK, loc="left", pad=pad)


def add_note(
    ax: Axes, text: str, point: tuple[float, float], shift: tuple[float, float], **look: Any
) -> Text:
    """Add a small text beside a point, gray unless specified otherwise.

    Args:
        ax: Axes to draw on.
        text: The text.
        point: The point, in data coordinates unless `look` specifies others (`xycoords`).
        shift: Offset from the point to the text [pt].
        look: Further arguments of matplotlib's `annotate`.
    """
    properties: dict[str, Any] = {"fontsize": TICK, "color": GRAY, **look}
    return ax.annotate(text, point, xytext=shift, textcoords="offset points", **properties)


def marker_style(marker: str, size: float, color: str = INK, **look: Any) -> dict[str, Any]:
    """Return the properties of markers without a line between them.

    Args:
        marker: Shape of the markers.
        size: Size [pt].
        color: Color of face and edge, unless `look` specifies others.
        look: Further properties of matplotlib's lines.
    """
    return {"linestyle": "none", "marker": marker, "markersize": size, "color": color, **look}


def light_grid(ax: Axes, axis: Literal["x", "y"]) -> None:
    """Draw lines behind the data, at the ticks of one axis.

    Args:
        ax: Axes to draw on.
        axis: Axis whose ticks are used.
    """
    ax.grid(axis=axis, color=GRID, linewidth=THIN)
    ax.set_axisbelow(True)


def joint_colors(n_joints: int) -> tuple[LinearSegmentedColormap, BoundaryNorm]:
    """Return the joints' colors, dark at the tail to light at the head: lightness varies evenly, also in gray print."""
    stops = ["#0B1E4B", "#2C4A8C", "#4C7F9E", "#79A97E", "#BDB95A"]
    colors = LinearSegmentedColormap.from_list("joints", stops, N=max(n_joints, 2))
    return colors, BoundaryNorm([i - 0.5 for i in range(n_joints + 1)], colors.N)
