"""Places in the water, as seen from above: nets, walls, pipes, docks and buoys with their names."""

# matplotlib's own annotations are partial; this package passes on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patheffects import withStroke

from laticauda.scenarios import Scenario
from laticauda.sensing import Outline, Place
from laticauda.show.figures import style
from laticauda.trials import Trial

EDGE_WIDTH = 1.0
"""Width of an outline, by which thin nets are seen [pt]."""
NAME_SHIFT = (0.0, 3.0)
"""From the top of a place to its name [pt]."""


def places_of(trial: Trial) -> tuple[Place, ...]:
    """Return what was in the water of a run; nothing is known of a run in a tank.

    Args:
        trial: Any trial.
    """
    scenario = trial.scenario
    if not isinstance(scenario, Scenario):
        return ()
    return scenario.model.places


def outlines_of(places: Sequence[Place]) -> list[Outline]:
    """Return the outlines of all places [m].

    Args:
        places: The places.
    """
    outlines: list[Outline] = []
    for place in places:
        outlines += place.outlines()
    return outlines


def draw_places(ax: Axes, places: Sequence[Place]) -> None:
    """Draw places in plan, each with its name above it; the limits of the axes make room for them.

    Args:
        ax: Axes to draw on, in meters.
        places: The places.
    """
    for place in places:
        outlines = place.outlines()
        if not outlines:
            continue
        shapes = PolyCollection(
            outlines, facecolor=style.GRAY, edgecolor=style.INK, linewidth=EDGE_WIDTH, zorder=1.5
        )
        ax.add_collection(shapes)
        corners = np.concatenate(outlines)
        ax.update_datalim(corners)
        low = corners.min(axis=0)
        high = corners.max(axis=0)
        middle = 0.5 * (low[0] + high[0])
        style.add_note(
            ax,
            place.name,
            (float(middle), float(high[1])),
            NAME_SHIFT,
            ha="center",
            va="bottom",
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
            zorder=5,
        )
    ax.autoscale_view()
