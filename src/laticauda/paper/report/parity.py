"""Whether the closed form and the 3D engine agree, for readers: a table and the convergence plot."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from laticauda.paper.parity import ORDERS, ParityStudy
from laticauda.paper.report.chapter import paper_chapter
from laticauda.reports.chapter import Chapter

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACCEPTED = 3e-3  # of the distance [-]


def parity_chapter(study: ParityStudy) -> Chapter:
    """What the comparison puts into the folder and the report.

    Args:
        study: What `run_parity` returned.
    """
    rows = [
        {
            "case": row.case,
            "step of the spatial model [ms]": 1000.0 * row.dt,
            "path / distance [-]": row.path,
            "after Richardson extrapolation [-]": row.richardson,
            "rotation [rad]": row.rotation,
            "heading [rad]": row.heading,
        }
        for row in study.rows
    ]
    dt, path = min(study.worst("path").items())
    return paper_chapter(
        "parity",
        values={"study": study, "dt": dt, "path": path},
        tables={"parity": rows},
        n_figures=1,
        figures=lambda: parity_figures(study),
    )


def parity_figures(study: ParityStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The convergence plot: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_parity` returned.
    """
    from laticauda.figures import new_figure, style
    from laticauda.paper.figures.convergence import ConvergenceCurve, convergence

    figure = new_figure(style.DOUBLE_COLUMN, 2.9)
    labels = {"path": "path: largest difference / distance [-]", "heading": "heading: largest difference [rad]"}
    joints = str(study.how["joints"])
    for ax, (name, label) in zip(figure.subplots(1, 2), labels.items(), strict=True):
        worst = study.worst(name)
        curve = ConvergenceCurve(
            label=f"{joints} joints",
            dt=np.array(list(worst)),
            difference=np.array(list(worst.values())),
            order=ORDERS[joints],
        )
        convergence([curve], ax, ylabel=label, bounds=[(ACCEPTED, "0.3 %")] if name == "path" else [])
    yield "parity", "Planar and spatial model over the step of the spatial one: the worst of all cases.", figure
