"""The one figure that shows most of a run."""

from matplotlib.figure import Figure

from laticauda.show.figures.follow import follow_sheet
from laticauda.show.figures.swim import swim_sheet
from laticauda.trials import Trial


def sheet(trial: Trial) -> Figure:
    """Create the figure that shows most of a run: `follow_sheet` if it followed a path, otherwise `swim_sheet`.

    Args:
        trial: Any trial, including a failed one.
    """
    if "cross_track_error" in trial.signals:
        return follow_sheet(trial)
    return swim_sheet(trial)
