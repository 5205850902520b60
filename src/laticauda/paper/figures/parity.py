"""What was measured or published against what is simulated: points about the line of equality."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from laticauda.figures import style
from laticauda.figures.identification import parity
from laticauda.paper.optima import Optima

SCALES = {"forward velocity [m/s]": "linear", "net power [W]": "log"}
"""Of the axes, by what optima are compared in."""


def speeds_sheet(speeds: Mapping[str, Float[np.ndarray, "2 n"]]) -> Figure:
    """Simulated over measured forward velocities, in one square.

    Args:
        speeds: By what the legend says, the measured and the simulated ones [m/s].
    """
    figure = style.new_figure(0.55 * style.DOUBLE_COLUMN, 0.55 * style.DOUBLE_COLUMN)
    ax = parity(speeds, figure.subplots(), what="forward velocity [m/s]")
    ax.set_ylabel("simulated forward velocity [m/s]")
    style.legend(ax, loc="upper left")
    return figure


def optima_figure(found: Sequence[Optima]) -> Figure:
    """Simulated over published velocities and powers.

    Args:
        found: What `run_optima` returned.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.5 * style.DOUBLE_COLUMN)
    for i, (ax, (what, scale)) in enumerate(zip(figure.subplots(1, 2), SCALES.items(), strict=True)):
        points = {one.gait: np.stack((one.published[i], one.simulated[i])) for one in found}
        every = np.concatenate([*points.values()], axis=1)
        parity(points, ax, what=what).set(xlabel=f"published {what}", ylabel=f"simulated {what}")
        if scale == "log":
            ends = 0.8 * np.min(every), 1.25 * np.max(every)
            ax.set(xscale=scale, yscale=scale, xlim=ends, ylim=ends)
    style.legend(figure.axes[0], loc="upper left")
    return figure
