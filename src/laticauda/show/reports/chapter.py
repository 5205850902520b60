"""A chapter of a report: the tables, figures and trials that go into a folder, and the template that presents them.

Sentences are in a Jinja2 template, the values that they contain come with the chapter. A page
extends "page.html" and sets `title`, the block `introduction`, and `chapters` (names, titles,
texts); tables and pictures are macros of "parts.html". `templates/identify.html` uses all of these.
A package with its own templates passes them on:

    mine = partial(load_templates, "my.package")
    chapter = Chapter(name="speeds", values={"n": 3}, tables={"speeds": rows}, templates=mine)
    files, html = write_chapter(chapter, make_writable_folder("out"))

Numbers and tables are rounded on a page, but have all digits in a CSV file.
"""

import base64
import io
import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from laticauda.show.reports.cells import (
    Row,
    find_form,
    format_cell,
    format_number,
    format_share,
    format_span,
    is_numeric,
    write_csv,
)
from laticauda.values import BadArgument, local, optional_import, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.trials import Trial

FIGURE_SUFFIXES = (".png", ".pdf")
"""Endings of the files of a figure, that of the page first."""


class ReportFigure(NamedTuple):
    """A figure of a report."""

    name: str
    """Name of its files, without their endings [-]."""
    caption: str
    """Caption on the page [-]."""
    figure: "Figure"
    """The figure."""


class Picture(NamedTuple):
    """A figure as it stands on a page."""

    caption: str
    """Caption [-]."""
    png: bytes
    """Content of its PNG file."""


Pictures = Mapping[str, Picture]
"""Pictures by the names of their figures."""


@cache
def load_templates(package: str = "laticauda.show.reports") -> Any:
    """Return the Jinja2 environment for a package's templates: texts are escaped, and a missing value is an error.

    Args:
        package: Package whose folder `templates` holds them; "page.html" and "parts.html" are
            available to all.

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    jinja2 = optional_import("The report", "Jinja2", "paper", "jinja2")
    packages = dict.fromkeys((package, "laticauda.show.reports"))
    loaders = [jinja2.PackageLoader(name) for name in packages]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "base64": base64.b64encode,
        "cell": format_cell,
        "degrees": math.degrees,
        "digits": format_number,
        "form_of": find_form,
        "span": format_span,
    }
    environment.globals |= {"is_numeric": is_numeric, "share": format_share}
    return environment


def draw_no_figures() -> "Iterator[ReportFigure]":
    """Return the figures of a chapter that has none."""
    return iter(())


def ignore_progress(n_figures: int) -> None:
    """Do nothing after a figure.

    Args:
        n_figures: Number of figures so far.
    """


@dataclass(frozen=True, kw_only=True, eq=False)
class Chapter:
    """Content of a chapter, before anything is written."""

    name: str
    """Name of its template, and of its part of the page."""
    values: Mapping[str, Any]
    """Values in the template, in addition to its `tables` and `pictures`."""
    tables: Mapping[str, Sequence[Row]] = field(default_factory=dict[str, Sequence[Row]])
    """Tables, written as CSV files under their names; None and values that are not finite are missing."""
    n_figures: int = 0
    """Number of figures [-]."""
    figures: Callable[[], Iterator[ReportFigure]] = draw_no_figures
    """Function that yields the figures one by one."""
    trials: "Mapping[str, Trial]" = field(default_factory=dict[str, "Trial"])
    """Trials, stored as netCDF files under their names."""
    templates: Callable[[], Any] = load_templates
    """Function that returns the Jinja2 environment for its template."""

    def html(self, pictures: Pictures) -> str:
        """Return the chapter's part of the page.

        Args:
            pictures: Drawn figures of the chapter.
        """
        template = self.templates().get_template(f"{self.name}.html")
        return template.render(self.values, tables=self.tables, pictures=pictures)


def make_writable_folder(folder: str | Path) -> Path:
    """Return a writable folder, creating it if it does not exist.

    Args:
        folder: Folder in which a report is to be written.

    Raises:
        ValueError: If it cannot be created, or no file can be written there.
    """
    path = local(folder)
    if path.exists() and not path.is_dir():
        raise BadArgument("folder", f"must be a folder, got the file {folder}")
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):  # permissions alone do not suffice
            pass
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise BadArgument(
            "folder", f"must be a folder that can be written, got {folder}: {reason}"
        ) from error
    return path


def write_chapter(
    chapter: Chapter, folder: Path, after_figure: Callable[[int], None] = ignore_progress
) -> tuple[list[str], str]:
    """Write a chapter's trials, tables and figures.

    Args:
        chapter: Chapter to write.
        folder: Existing folder in which to write it.
        after_figure: Called after every figure with the number of figures so far.

    Returns:
        Names of the files, and the chapter's part of the page.
    """
    from laticauda.show.figures import save_figure

    file_names: list[str] = []
    for name, trial in chapter.trials.items():
        file_name = f"{name}.nc"
        trial.save(folder / file_name)
        file_names.append(file_name)
    for name, rows in chapter.tables.items():
        file_name = f"{name}.csv"
        write(folder / file_name, write_csv(rows))
        file_names.append(file_name)
    pictures: dict[str, Picture] = {}
    for drawn in chapter.figures():
        paths = [folder / f"{drawn.name}{suffix}" for suffix in FIGURE_SUFFIXES]
        save_figure(drawn.figure, *paths)
        file_names.extend(path.name for path in paths)
        png = _reduce_colors(paths[0])
        pictures[drawn.name] = Picture(caption=drawn.caption, png=png)
        after_figure(len(pictures))
    return file_names, chapter.html(pictures)


def _reduce_colors(path: Path) -> bytes:
    """Return a picture in 256 colors, which takes a third of the space; its file keeps all colors."""
    from PIL import Image

    buffer = io.BytesIO()
    with Image.open(path) as picture:
        picture.convert("RGB").quantize().save(buffer, "PNG")
    return buffer.getvalue()
