"""A chapter of the report: what a study writes into the folder of a reproduction, and the template that tells of it.

The sentences stand in `templates`, one file per chapter; a chapter brings the values that they speak of.
"""

# pandas' own annotations are partial: this module hands on typed texts.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import base64
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from laticauda.extras import optional_import
from laticauda.files import write
from laticauda.gaits import GAIT_WORDS

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from xarray import Dataset

Pictures = Mapping[str, tuple[str, bytes]]
"""By name of the figure: its caption and the content of its PNG file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Chapter:
    """What a study has to say, before anything is written."""

    name: str
    """Of its template, and of its part of the page."""
    values: Mapping[str, Any]
    """What the template speaks of."""
    tables: "Mapping[str, DataFrame]"
    """Written as CSV files under their names; None and nan are missing."""
    n_figures: int = 0
    """How many figures there are [-]."""
    figures: "Callable[[], Iterator[tuple[str, str, Figure]]]" = lambda: iter(())
    """One figure after the other: the name of its files, its caption, and the figure."""
    data: "Mapping[str, Callable[[], Dataset]]" = field(default_factory=dict)
    """By name of the netCDF file: what makes its content."""

    def html(self, pictures: Pictures) -> str:
        """Its part of the page.

        Args:
            pictures: Its figures, drawn.
        """
        template = environment().get_template(f"{self.name}.html")
        return template.render(self.values, tables=self.tables, pictures=pictures)


def write_chapter(chapter: Chapter, folder: Path, drawn: Callable[[int], None]) -> tuple[list[str], str]:
    """Write a chapter's data, tables and figures.

    Args:
        chapter: What to write.
        folder: Where; it exists.
        drawn: Called after every figure with how many there are so far.

    Returns:
        The names of the files, and the chapter's part of the page.
    """
    from laticauda.figures import save_figure

    for name, dataset in chapter.data.items():
        write(folder / name, partial(dataset().to_netcdf, engine="netcdf4"))
    for name, frame in chapter.tables.items():
        write(folder / f"{name}.csv", as_csv(frame))
    files = [*chapter.data, *(f"{name}.csv" for name in chapter.tables)]
    pictures: dict[str, tuple[str, bytes]] = {}
    for name, caption, figure in chapter.figures():
        paths = [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")]
        save_figure(figure, *paths)
        files += [path.name for path in paths]
        pictures[name] = (caption, paths[0].read_bytes())
        drawn(len(pictures))
    return files, chapter.html(pictures)


def as_csv(frame: "DataFrame") -> str:
    """The content of a table's CSV file; ten digits hide the noise of the last bits.

    Args:
        frame: The table.
    """
    return frame.map(_plain).to_csv(index=False, lineterminator="\n")


@cache
def environment() -> Any:
    """What renders the templates (Jinja2's): all texts are escaped, and a value that is missing is an error.

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    jinja2 = optional_import("The report", "Jinja2", "paper", "jinja2")
    made = jinja2.Environment(
        loader=jinja2.PackageLoader("laticauda.paper.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {
        "base64": _base64,
        "cell": shown,
        "cm": _centimeters,
        "degrees": math.degrees,
        "digits": in_digits,
        "figs": figure_numbers,
        "form_of": form_of,
        "span": span,
        "upper_first": _upper_first,
    }
    made.globals |= {"by_gait": _by_gait, "is_numeric": is_numeric, "share": share, "words": GAIT_WORDS}
    return made


# ---- numbers as texts ----------------------------------------------------------------------------------------------


def in_digits(value: float, form: str = "") -> str:
    """A number as a page shows it: with a real minus, and what is rounded to zero without a sign.

    Args:
        value: Any number.
        form: As in `format`; "" shows six digits.
    """
    text = format(value, form or "g")
    if not any(digit in text for digit in "123456789"):
        text = text.lstrip("+-")
    return text.replace("-", "\N{MINUS SIGN}")


def shown(cell: Any, form: str = "") -> str:
    """A cell of a table as a page shows it.

    Args:
        cell: A text, a number, a truth, or None or nan.
        form: Of a number, as in `format`.
    """
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return "NA"
    plain = _plain(cell)
    return plain if isinstance(cell, str) or plain in ("yes", "no") else in_digits(cell, form)


def span(values: Iterable[float], form: str = "") -> str:
    """From the smallest to the largest of several values.

    Args:
        values: At least one.
        form: As in `format`.
    """
    known = [*values]
    low, high = in_digits(min(known), form), in_digits(max(known), form)
    return low if low == high else f"{low} to {high}"


def share(part: int, whole: int) -> str:
    """How many of them: "all 12", "none of the 12", "3 of the 12".

    Args:
        part: How many.
        whole: Of how many.
    """
    return f"all {whole}" if part == whole else f"none of the {whole}" if part == 0 else f"{part} of the {whole}"


def figure_numbers(numbers: Sequence[int]) -> str:
    """Numbers of figures, those in a row as from-to: "Figs. 12, 14 to 16 and 18".

    Args:
        numbers: At least one, rising.
    """
    rows: list[list[int]] = []
    for number in numbers:
        if rows and rows[-1][-1] == number - 1:
            rows[-1].append(number)
        else:
            rows.append([number])
    parts = [f"{row[0]}" if len(row) == 1 else f"{row[0]} to {row[-1]}" for row in rows]
    listed = " and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else parts[0]
    return f"{'Fig.' if len(numbers) == 1 else 'Figs.'} {listed}"


def form_of(column: str, forms: Mapping[str, str]) -> str:
    """How a column's numbers are shown: the form of the longest key that its name ends with.

    Args:
        column: Its name.
        forms: By the end of a column's name, as in `format`.
    """
    return max(((len(end), form) for end, form in forms.items() if column.endswith(end)), default=(0, ""))[1]


def is_numeric(cells: Iterable[Any]) -> bool:
    """Whether a column holds numbers: they end one below the other.

    Args:
        cells: Of the column.
    """
    texts = [shown(cell) for cell in cells]
    known = [(cell, text) for cell, text in zip(cells, texts, strict=True) if text != "NA"]
    return bool(known) and not any(isinstance(cell, str) or text in ("yes", "no") for cell, text in known)


def _plain(cell: Any) -> Any:
    """A cell as a CSV file has it."""
    import numpy as np

    if isinstance(cell, bool | np.bool_):
        return "yes" if cell else "no"
    return f"{cell:.10g}" if isinstance(cell, float) and not math.isnan(cell) else cell


def _by_gait(swimmers: Iterable[Any]) -> list[list[Any]]:
    """Swimmers with the same gait together."""
    groups: dict[Any, list[Any]] = {}
    for swimmer in swimmers:
        groups.setdefault(swimmer.gait, []).append(swimmer)
    return [*groups.values()]


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")


def _centimeters(length: float | None) -> str:
    return "unknown" if length is None else f"{100.0 * length:.2g} cm"


def _upper_first(text: str) -> str:
    return text[:1].upper() + text[1:]
