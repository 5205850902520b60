"""Plots of a run."""

# pyright: reportUnknownMemberType=false

from importlib import import_module
from typing import Any

import numpy as np

from laticauda.show.cockpit.live import Live

STEP = 4
"""Every `STEP`-th sample is drawn."""
COLORS = ("#56B4E9", "#E69F00", "#8ADB9B")
LINE_WIDTH = 1.5
"""[pixels]."""
HEIGHT = 165
"""Height of a plot [pixels]."""
PLOTS = {
    "Speed [m/s]": {
        "speed": "speed",
    },
    "Power [W]": {
        "power": "power",
    },
    "Cross-track error [m]": {
        "cross_track_error": "error",
    },
    "Heading [deg]": {
        "heading": "heading",
    },
    "Depth [m], in space": {
        "depth": "depth",
    },
    "Pitch and roll [deg], in space": {
        "pitch": "pitch",
        "roll": "roll",
    },
    "Joint angles [deg]": {
        "joint_tail": "tail",
        "joint_middle": "middle",
        "joint_head": "head",
    },
}
"""Lines of each plot, by its title with unit: column of `Live.plots` and name."""
AXIS = {"stroke": "#c8d2d8", "grid": {"stroke": "#3a4750", "width": 1}}
"""Arguments of viser for either axis."""


class Plots:
    """All plots, over the simulated time in seconds.

    Args:
        gui: GUI of the page's server.
    """

    def __init__(self, gui: Any) -> None:
        self._handles = [_add_plot(gui, title, lines) for title, lines in PLOTS.items()]

    def show(self, live: Live) -> None:
        """Draw the available data."""
        columns = live.plots(step=STEP)
        if not columns:
            return
        for handle, lines in zip(self._handles, PLOTS.values(), strict=True):
            handle.data = (columns["time"], *(columns[name] for name in lines))


def _add_plot(gui: Any, title: str, lines: dict[str, str]) -> Any:
    """Add an empty plot to the page; `lines` are the names of its lines, by their columns."""
    series: list[dict[str, Any]] = [{"label": "time [s]"}]
    for name, color in zip(lines.values(), COLORS, strict=False):
        series.append({"label": name, "stroke": color, "width": LINE_WIDTH})
    no_data = (np.zeros(1),) * (1 + len(lines))
    # uPlot would interpret seconds as dates.
    seconds = import_module("viser.uplot").Scale(time=False)
    return gui.add_uplot(
        no_data,
        tuple(series),
        title=title,
        scales={"x": seconds},
        axes=(AXIS, AXIS),
        height=HEIGHT,
    )
