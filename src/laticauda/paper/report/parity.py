"""Whether the closed form and the 3D engine agree, for readers: a table and the convergence plot."""

# matplotlib's own annotations are partial; this package hands on typed figures and axes.
# pyright: reportUnknownMemberType=false

from collections.abc import Iterator

from matplotlib.figure import Figure

from laticauda.figures import style
from laticauda.paper.parity import ParityStudy
from laticauda.paper.report.chapter import paper_chapter
from laticauda.reports.chapter import Chapter


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


def parity_figures(study: ParityStudy) -> Iterator[tuple[str, str, Figure]]:
    """The convergence plot: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_parity` returned.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.9)
    labels = {"path": "path: largest difference / distance [-]", "heading": "heading: largest difference [rad]"}
    for ax, (name, label) in zip(figure.subplots(1, 2), labels.items(), strict=True):
        steps, worst = zip(*((1000.0 * dt, found) for dt, found in study.worst(name).items()), strict=True)
        ax.loglog(steps, worst, color=style.BLUE, linewidth=style.LINE, marker="o", markersize=3.5)
        style.dress(ax, xlabel="time step of the spatial model [ms]", ylabel=label)
        ax.set_xticks(steps, [f"{step:g}" for step in steps])
        ax.minorticks_off()
    words = f"{study.how['joints']} joints, the worst of all cases"
    yield "parity", f"Planar and spatial model over the step of the spatial one: {words}.", figure
