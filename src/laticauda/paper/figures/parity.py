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

Points = Mapping[str, Float[np.ndarray, "2 n"]]
"""By what the legend says, what is known and what is simulated."""


def parity_sheet(panels: Mapping[str, Points], known: str) -> Figure:
    """Simulated over known numbers, a square per quantity; powers, which span decades, on logarithmic axes.

    Args:
        panels: By quantity with its unit.
        known: What the known numbers are: measured, published.
    """
    side = 0.55 * style.DOUBLE_COLUMN
    figure = style.new_figure(side * len(panels), side)
    for ax, (what, points) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels.items(), strict=True):
        parity(points, ax, what=what).set(xlabel=f"{known} {what}", ylabel=f"simulated {what}")
        if "power" in what:
            every = np.concatenate([*points.values()], axis=1)
            ends = 0.8 * np.min(every), 1.25 * np.max(every)
            ax.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    style.legend(figure.axes[0], loc="upper left")
    return figure


def optima_figure(found: Sequence[Optima]) -> Figure:
    """Simulated over published velocities and powers.

    Args:
        found: What `run_optima` returned.
    """
    quantities = ("forward velocity [m/s]", "net power [W]")
    by_quantity = [{one.gait: np.stack((one.published[i], one.simulated[i])) for one in found} for i in (0, 1)]
    return parity_sheet(dict(zip(quantities, by_quantity, strict=True)), "published")
