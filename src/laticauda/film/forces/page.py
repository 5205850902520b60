"""A page with the results of a filmed swim, its tables and its figure, in one folder."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from laticauda.film.chain.result import SURE
from laticauda.film.forces.chain_picture import draw_chain
from laticauda.film.forces.doubts import list_doubts
from laticauda.film.forces.estimates import SOURCES, Estimate
from laticauda.film.forces.inverse import FilmForces
from laticauda.film.forces.picture import draw_forces
from laticauda.film.forces.words import list_remarks, summarize
from laticauda.show.reports import (
    Chapter,
    ReportFigure,
    Row,
    load_templates,
    make_writable_folder,
    write_chapter,
)
from laticauda.values import __version__, write

PAGE = "inverse.html"
"""Name of the page in its folder."""
CAPTION = (
    "Forces of the water along the way on every link over a cycle, and their means; power of the joints; "
    "and the force left over, what the film's motion asks for beyond what the water does."
)

CHAIN_CAPTION = (
    "The fitted chain over the tracked points in six frames: it must lie on the points in every one, "
    "with its large end at the head."
)


def write_page(forces: FilmForces, folder: str | Path, command: str = "") -> list[str]:
    """Write the page inverse.html, its tables as CSV files and its figure.

    Args:
        forces: The figures.
        folder: Folder; it is made if it does not exist.
        command: Command that made it, for the page.

    Returns:
        Names of the files.
    """
    chapter = Chapter(
        name="inverse",
        values={
            "forces": forces,
            "summary": summarize(forces),
            "doubts": list_doubts(forces),
            "remarks": [*forces.fit.points.notes, *list_remarks(forces)],
            "command": command,
            "version": __version__,
        },
        tables={
            "figures": [_row_of(figure) for figure in forces.figures.values()],
            "links": [_link_row(i, figure) for i, figure in enumerate(forces.link_figures)],
            "points": _point_rows(forces),
        },
        n_figures=2,
        figures=partial(_figures_of, forces),
        templates=partial(load_templates, "laticauda.film.forces"),
    )
    path = make_writable_folder(folder)
    names, html = write_chapter(chapter, path)
    write(path / PAGE, html.encode())
    return [PAGE, *names]


def _figures_of(forces: FilmForces) -> Iterator[ReportFigure]:
    yield ReportFigure(name="chain", caption=CHAIN_CAPTION, figure=draw_chain(forces))
    yield ReportFigure(name="forces", caption=CAPTION, figure=draw_forces(forces))


def _row_of(figure: Estimate) -> Row:
    row: Row = {
        "figure": figure.title,
        "unit": figure.unit,
        "median": figure.median,
        "low": figure.low,
        "high": figure.high,
    }
    for source in SOURCES:
        row[f"{source} [%]"] = 100.0 * figure.shares[source]
    return row


def _link_row(link: int, figure: Estimate) -> Row:
    return {"link": link + 1, "median": figure.median, "low": figure.low, "high": figure.high}


def _point_rows(forces: FilmForces) -> list[Row]:
    fit = forces.fit
    elsewhere = (fit.model.is_seen & (fit.membership < SURE)).sum(axis=0)
    lost = (~fit.model.is_seen).sum(axis=0)
    return [
        {
            "point": name,
            "given [m]": float(fit.model.places.along[i]),
            "found [m]": float(fit.places.along[i]),
            "noise [mm]": 1e3 * float(fit.noise[i]),
            "elsewhere": int(elsewhere[i]),
            "lost": int(lost[i]),
        }
        for i, name in enumerate(fit.points.names)
    ]
