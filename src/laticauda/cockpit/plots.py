"""The live plots."""

from typing import Any

import numpy as np

from laticauda.cockpit.door import time_scale
from laticauda.cockpit.live import Live

STEP = 4  # every how many-th sample is drawn
COLORS = ("#56B4E9", "#E69F00", "#8ADB9B")
# Title with its unit, and the lines: column of `Live.plots` and name.
PLOTS = (
    ("Speed [m/s]", (("speed", "speed"),)),
    ("Power [W]", (("power", "power"),)),
    ("Cross-track error [m]", (("cross_track_error", "error"),)),
    ("Heading [deg]", (("heading", "heading"),)),
    ("Joint angles [deg]", (("joint_tail", "tail"), ("joint_middle", "middle"), ("joint_head", "head"))),
)
HEIGHT = 165  # [px]


class Plots:
    """All plots, over the time of the world in seconds.

    Args:
        gui: Of the page's server.
    """

    def __init__(self, gui: Any) -> None:
        nothing = np.array([0.0])
        axis = {"stroke": "#c8d2d8", "grid": {"stroke": "#3a4750", "width": 1}}
        self._handles = [
            gui.add_uplot(
                (nothing, *(nothing for _ in lines)),
                (
                    {"label": "time [s]"},
                    *(
                        {"label": name, "stroke": color, "width": 1.5}
                        for (_, name), color in zip(lines, COLORS, strict=False)
                    ),
                ),
                title=title,
                scales=time_scale(),
                axes=(axis, axis),
                height=HEIGHT,
            )
            for title, lines in PLOTS
        ]

    def show(self, live: Live) -> None:
        """Draw what there is."""
        columns = live.plots(step=STEP)
        if not columns:
            return
        for handle, (_, lines) in zip(self._handles, PLOTS, strict=True):
            handle.data = (columns["time"], *(columns[name] for name, _ in lines))
