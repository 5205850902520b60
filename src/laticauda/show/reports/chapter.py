"""A chapter of a report: the tables, figures and trials that go into a folder, and the template that presents them.

Sentences are in a Jinja2 template, the values that they contain come with the chapter. A page
extends "page.html" and sets `title`, the block `introduction`, and `chapters` (names, titles,
texts); tables and pictures are macros of "parts.html". `templates/identify.html` uses all of these.
A package with its own templates passes them on:

    mine = partial(templates, "my.package")
    chapter = Chapter(name="speeds", values={"n": 3}, tables={"speeds": rows}, templates=mine)
    files, html = write_chapter(chapter, writable_folder("out"))

Numbers and tables are rounded on a page, but have all digits in a CSV file.
"""

import base64
import io
import math
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.values import BadArgument, csv_text, local, optional_import, write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.trials import Trial

Row = dict[str, Any]
"""Row of a table, by column; all rows have the columns of the first."""
Pictures = Mapping[str, tuple[str, bytes]]
"""By name of a figure: its caption and the content of its PNG file."""


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
    folders = dict.fromkeys((package, "laticauda.show.reports"))
    made = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(folder) for folder in folders]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "base64": base64.b64encode,
        "cell": format_cell,
        "degrees": math.degrees,
        "digits": in_digits,
        "form_of": form_of,
        "span": format_span,
    }
    made.globals |= {"is_numeric": is_numeric, "share": format_share}
    return made


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
    figures: "Callable[[], Iterator[tuple[str, str, Figure]]]" = lambda: iter(())
    """Function that yields the figures one by one: name of the files, caption and figure."""
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


def writable_folder(folder: str | Path) -> Path:
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
        why = (error.strerror or str(error)).lower()
        raise BadArgument(
            "folder", f"must be a folder that can be written, got {folder}: {why}"
        ) from error
    return path


def write_chapter(
    chapter: Chapter, folder: Path, drawn: Callable[[int], None] = lambda n: None
) -> tuple[list[str], str]:
    """Write a chapter's trials, tables and figures.

    Args:
        chapter: Chapter to write.
        folder: Existing folder in which to write it.
        drawn: Called after every figure with the number of figures so far.

    Returns:
        Names of the files, and the chapter's part of the page.
    """
    from laticauda.show.figures import save_figure

    for name, trial in chapter.trials.items():
        trial.save(folder / f"{name}.nc")
    for name, rows in chapter.tables.items():
        write(folder / f"{name}.csv", as_csv(rows))
    files = [
        *(f"{name}.nc" for name in chapter.trials),
        *(f"{name}.csv" for name in chapter.tables),
    ]
    pictures: dict[str, tuple[str, bytes]] = {}
    for name, caption, figure in chapter.figures():
        paths = [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")]
        save_figure(figure, *paths)
        files += [path.name for path in paths]
        pictures[name] = (caption, _for_the_page(paths[0]))
        drawn(len(pictures))
    return files, chapter.html(pictures)


def _for_the_page(path: Path) -> bytes:
    """Return a picture in 256 colors, which takes a third of the space; its file keeps all colors."""
    from PIL import Image

    content = io.BytesIO()
    with Image.open(path) as picture:
        picture.convert("RGB").quantize().save(content, "PNG")
    return content.getvalue()


# ---- numbers and tables --------------------------------------------------------------------------


def in_digits(value: float, form: str = "") -> str:
    """Format a number for a page: with a true minus sign, and without a sign if it is rounded to zero.

    Args:
        value: Any number.
        form: Format of the number, as Python's `format` takes it; "" shows six digits.
    """
    text = format(value, form or "g")
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("+-")
    return text.replace("-", "\N{MINUS SIGN}")


def format_cell(cell: Any, form: str = "") -> str:
    """Format a cell of a table for a page.

    Args:
        cell: Text, number, truth value or None; None and values that are not finite are shown as
            NA.
        form: Format of a number, as Python's `format` takes it.
    """
    if cell is None or (isinstance(cell, float) and not math.isfinite(cell)):
        return "NA"
    plain = _plain(cell)
    return plain if isinstance(cell, str) or plain in ("yes", "no") else in_digits(cell, form)


def is_numeric(rows: Iterable[Row], column: str) -> bool:
    """Return whether a column holds numbers, which are right-aligned.

    Args:
        rows: Rows of the table.
        column: Name of the column.
    """
    known = [row[column] for row in rows if format_cell(row[column]) != "NA"]
    return bool(known) and not any(isinstance(cell, str | bool | np.bool_) for cell in known)


def form_of(column: str, forms: Mapping[str, str]) -> str:
    """Return the format of a column's numbers: that of the longest key with which its name ends.

    Args:
        column: Name of the column.
        forms: Formats by the end of a column's name, as Python's `format` takes them.
    """
    return max(
        ((len(end), form) for end, form in forms.items() if column.endswith(end)), default=(0, "")
    )[1]


def format_span(values: Iterable[float], form: str = "") -> str:
    """Format the range from the smallest to the largest of several values.

    Args:
        values: At least one value.
        form: Format of the numbers, as Python's `format` takes it.
    """
    known = [*values]
    low, high = in_digits(min(known), form), in_digits(max(known), form)
    return low if low == high else f"{low} to {high}"


def format_share(part: int, whole: int) -> str:
    """Format a part of a total: "all 12", "none of the 12", "3 of the 12".

    Args:
        part: Number of items in the part.
        whole: Total number.
    """
    return (
        f"all {whole}"
        if part == whole
        else f"none of the {whole}"
        if part == 0
        else f"{part} of the {whole}"
    )


def as_csv(rows: Sequence[Row]) -> str:
    """Return the content of a table's CSV file; ten digits hide noise in the last bits, and missing cells are empty.

    Args:
        rows: Rows of the table.
    """
    heads = [*rows[0]] if rows else []
    return csv_text([heads, *([_plain(row[head]) for head in heads] for row in rows)], "\n")


def _plain(cell: Any) -> Any:
    """Return a cell as it appears in a CSV file."""
    if isinstance(cell, bool | np.bool_):
        return "yes" if cell else "no"
    if not isinstance(cell, float):
        return cell
    return f"{cell:.10g}" if math.isfinite(cell) else ""
