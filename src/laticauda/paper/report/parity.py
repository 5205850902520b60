"""Whether the closed form and the 3D engine agree, for readers: a table and the convergence plot."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from laticauda.paper.parity import ORDERS, ParityStudy
from laticauda.reports.chapter import Chapter, Pictures
from laticauda.reports.page import Paragraph, Picture, Section
from laticauda.reports.tables import Column, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACCEPTED = 3e-3  # of the distance [-]


def parity_chapter(study: ParityStudy) -> Chapter:
    """What the comparison puts into the folder and the report.

    Args:
        study: What `run_parity` returned.
    """
    table = parity_table(study)
    return Chapter(
        section=lambda pictures: parity_section(study, table, pictures),
        tables=(table,),
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
    for ax, (name, label) in zip(figure.subplots(1, 2), labels.items(), strict=True):
        worst = study.worst(name)
        curve = ConvergenceCurve(
            label=f"{study.joints} joints",
            dt=np.array(list(worst)),
            difference=np.array(list(worst.values())),
            order=ORDERS[study.joints],
        )
        convergence([curve], ax, ylabel=label, bounds=[(ACCEPTED, "0.3 %")] if name == "path" else [])
    yield "parity", "Planar and spatial model over the step of the spatial one: the worst of all cases.", figure


def parity_section(study: ParityStudy, table: Table, pictures: Pictures) -> Section:
    """The comparison's part of the report.

    Args:
        study: What was run.
        table: `parity_table` of it.
        pictures: By name of the figure, its caption and the content of its PNG file.
    """
    dt, path = min(study.worst("path").items())
    text = (
        "The same robots, gaits and coefficients in the closed form and in MuJoCo with added mass, root in the plane, "
        f"no gravity, {study.joints} joints, {study.settings.duration:g} s. At a step of {1000.0 * dt:g} ms the paths "
        f"differ by at most {100.0 * path:.1g} % of the distance that was swum, the best rotation about the start "
        "taken out."
    )
    return Section(
        name="parity",
        title="Planar against spatial model",
        parts=(
            Paragraph(text=text),
            table,
            *(Picture(png=png, caption=caption, description=caption) for caption, png in pictures.values()),
        ),
    )


def parity_table(study: ParityStudy) -> Table:
    """Every comparison.

    Args:
        study: What `run_parity` returned.
    """
    return Table(
        name="parity",
        grouped=True,
        caption="Differences between the models: path, as a share of the distance, with the best rotation taken out; "
        "after Richardson extrapolation from this step and the one before; that rotation; heading.",
        columns=(
            Column(name="case"),
            Column(name="step of the spatial model [ms]", form="g"),
            Column(name="path / distance [-]", form=".1e"),
            Column(name="after Richardson extrapolation [-]", form=".1e"),
            Column(name="rotation [rad]", form=".1e"),
            Column(name="heading [rad]", form=".1e"),
        ),
        rows=tuple(
            (row.case, 1000.0 * row.dt, row.path, row.richardson, row.rotation, row.heading) for row in study.rows
        ),
    )
