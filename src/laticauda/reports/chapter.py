"""A chapter of a report: the tables, figures and trials that go into a folder, and the template that tells of them.

Sentences stand in a Jinja2 template, the values that they speak of come with the chapter. A page extends "page.html"
and sets `title`, the block `introduction`, and `chapters` (names, titles, texts); tables and pictures are macros of
"parts.html". `templates/identify.html` uses all of it. A package with templates of its own hands them on:

    mine = partial(templates, "my.package")
    chapter = Chapter(name="speeds", values={"n": 3}, tables={"speeds": rows}, templates=mine)
    files, html = write_chapter(chapter, writable_folder("out"))
"""

import base64
import io
import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from laticauda.errors import BadArgument
from laticauda.extras import optional_import
from laticauda.files import local, write
from laticauda.reports.texts import Row, as_csv, form_of, in_digits, is_numeric, share, shown, span

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.trial import Trial

Pictures = Mapping[str, tuple[str, bytes]]
"""By name of the figure: its caption and the content of its PNG file."""


@cache
def templates(package: str = "laticauda.reports") -> Any:
    """What renders a package's templates (Jinja2's): texts are escaped, and a value that is missing is an error.

    Args:
        package: Whose folder `templates` has them; "page.html" and "parts.html" are there for all.

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    jinja2 = optional_import("The report", "Jinja2", "paper", "jinja2")
    folders = dict.fromkeys((package, "laticauda.reports"))
    made = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(folder) for folder in folders]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "base64": _base64,
        "cell": shown,
        "degrees": math.degrees,
        "digits": in_digits,
        "form_of": form_of,
        "span": span,
        "upper_first": _upper_first,
    }
    made.globals |= {"is_numeric": is_numeric, "share": share}
    return made


@dataclass(frozen=True, kw_only=True, eq=False)
class Chapter:
    """What a study has to say, before anything is written."""

    name: str
    """Of its template, and of its part of the page."""
    values: Mapping[str, Any]
    """What the template speaks of, beside its `tables` and `pictures`."""
    tables: Mapping[str, Sequence[Row]] = field(default_factory=dict[str, Sequence[Row]])
    """Written as CSV files under their names; None and nan are missing."""
    n_figures: int = 0
    """How many figures there are [-]."""
    figures: "Callable[[], Iterator[tuple[str, str, Figure]]]" = lambda: iter(())
    """One figure after the other: the name of its files, its caption, and the figure."""
    trials: "Mapping[str, Trial]" = field(default_factory=dict[str, "Trial"])
    """Stored as netCDF files under their names."""
    templates: Callable[[], Any] = templates
    """What renders its template."""

    def html(self, pictures: Pictures) -> str:
        """Its part of the page.

        Args:
            pictures: Its figures, drawn.
        """
        template = self.templates().get_template(f"{self.name}.html")
        return template.render(self.values, tables=self.tables, pictures=pictures)


def writable_folder(folder: str | Path) -> Path:
    """The folder, made if it does not exist.

    Args:
        folder: Where a report is to be written.

    Raises:
        ValueError: If it cannot be made, or no file can be written there.
    """
    path = local(folder)
    if path.exists() and not path.is_dir():
        raise BadArgument("folder", f"must be a folder, got the file {folder}")
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):  # rights alone do not tell
            pass
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise BadArgument("folder", f"must be a folder that can be written, got {folder}: {why}") from error
    return path


def write_chapter(
    chapter: Chapter, folder: Path, drawn: Callable[[int], None] = lambda n: None
) -> tuple[list[str], str]:
    """Write a chapter's trials, tables and figures.

    Args:
        chapter: What to write.
        folder: Where; it exists.
        drawn: Called after every figure with how many there are so far.

    Returns:
        The names of the files, and the chapter's part of the page.
    """
    from laticauda.figures import save_figure

    for name, trial in chapter.trials.items():
        trial.save(folder / f"{name}.nc")
    for name, rows in chapter.tables.items():
        write(folder / f"{name}.csv", as_csv(rows))
    files = [*(f"{name}.nc" for name in chapter.trials), *(f"{name}.csv" for name in chapter.tables)]
    pictures: dict[str, tuple[str, bytes]] = {}
    for name, caption, figure in chapter.figures():
        paths = [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")]
        save_figure(figure, *paths)
        files += [path.name for path in paths]
        pictures[name] = (caption, _for_the_page(paths[0]))
        drawn(len(pictures))
    return files, chapter.html(pictures)


def _for_the_page(path: Path) -> bytes:
    """A picture in 256 colors, which take a third of the room; its file keeps all."""
    from PIL import Image

    content = io.BytesIO()
    with Image.open(path) as picture:
        picture.convert("RGB").quantize().save(content, "PNG")
    return content.getvalue()


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _upper_first(text: str) -> str:
    return text[:1].upper() + text[1:]
