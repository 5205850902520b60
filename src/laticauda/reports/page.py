"""A report as one HTML page that needs nothing else: styles and pictures are in it, and it runs no scripts."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from laticauda.reports.tables import Column, Table, numeric

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; color: #222; background: #fff;
  max-width: 76rem; margin: 0 auto; padding: 1.5rem 1.25rem 4rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: .5rem 0 1rem; }
h2 { font-size: 1.35rem; margin: 2.6rem 0 .6rem; padding-top: .6rem; border-top: 2px solid #222; }
h3 { font-size: 1.08rem; margin: 2rem 0 .4rem; }
p, li { max-width: 46rem; }
nav ol { padding-left: 1.2rem; margin: .3rem 0 1rem; }
a { color: #0059a0; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .875rem; line-height: 1.35; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #444; padding: .4rem 0 .6rem; max-width: 46rem; }
th, td { padding: .28rem .7rem .28rem 0; text-align: left; vertical-align: top; }
thead th { vertical-align: bottom; border-bottom: 1.5px solid #222; font-weight: 600; max-width: 9rem; }
tbody th { padding: .9rem 0 .3rem; font-weight: 600; }
tbody tr { border-bottom: 1px solid #e4e4e4; }
th.n, td.n { text-align: right; }
td { white-space: nowrap; }
td.w { white-space: normal; min-width: 11rem; }
figure { margin: 1.6rem 0; }
figure img { max-width: 100%; height: auto; }
figcaption { color: #444; font-size: .875rem; max-width: 46rem; }
@media print { body { max-width: none; padding: 0; font-size: 10pt; }
  h2 { break-before: page; } figure, tr { break-inside: avoid; } }
"""


@dataclass(frozen=True, kw_only=True)
class Heading:
    """A heading within a section."""

    text: str
    """What it says."""


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """Running text."""

    text: str
    """What it says."""


@dataclass(frozen=True, kw_only=True)
class Points:
    """A list of short statements."""

    texts: tuple[str, ...]
    """One per point."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A picture that is stored in the page."""

    png: bytes
    """Content of the PNG file."""
    caption: str
    """Below the picture."""
    description: str
    """For those who do not see it."""


Part = Heading | Paragraph | Points | Picture | Table


@dataclass(frozen=True, kw_only=True)
class Section:
    """What one study has to say."""

    name: str
    """Short, for links: letters and hyphens."""
    title: str
    """Its heading."""
    parts: tuple[Part, ...]
    """From top to bottom."""


def page(title: str, introduction: Sequence[Part], sections: Sequence[Section]) -> str:
    """A whole HTML page.

    Args:
        title: Of the page.
        introduction: What comes before the sections.
        sections: In their order; more than one get a list of contents.

    Returns:
        The text of the file; all texts are escaped.
    """
    contents = "".join(f'<li><a href="#{escape(part.name)}">{escape(part.title)}</a></li>' for part in sections)
    body = [
        f"<h1>{escape(title)}</h1>",
        *map(_html, introduction),
        f"<nav><ol>{contents}</ol></nav>" if len(sections) > 1 else "",
        *map(_section, sections),
    ]
    head = (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
    )
    return head + "\n".join(part for part in body if part) + "\n</body>\n</html>\n"


def _section(section: Section) -> str:
    parts = "\n".join(map(_html, section.parts))
    return f'<section id="{escape(section.name)}">\n<h2>{escape(section.title)}</h2>\n{parts}\n</section>'


def _html(part: Part) -> str:
    match part:
        case Heading():
            return f"<h3>{escape(part.text)}</h3>"
        case Paragraph():
            return f"<p>{escape(part.text)}</p>"
        case Points():
            return "<ul>{}</ul>".format("".join(f"<li>{escape(text)}</li>" for text in part.texts))
        case Picture():
            data = base64.b64encode(part.png).decode("ascii")
            image = f'<img src="data:image/png;base64,{data}" alt="{escape(part.description)}">'
            return f"<figure>{image}<figcaption>{escape(part.caption)}</figcaption></figure>"
        case Table():
            return _table(part)


def _mark(column: Column, is_numeric: bool) -> str:
    """What sets a column's cells apart."""
    return ' class="n"' if is_numeric else ' class="w"' if column.wraps else ""


def _table(table: Table) -> str:
    first = 1 if table.grouped else 0  # of the columns that are columns here
    marks = [_mark(column, right) for column, right in zip(table.columns, numeric(table), strict=True)][first:]
    heads = "".join(
        f'<th scope="col"{mark}>{escape(column.name)}</th>'
        for mark, column in zip(marks, table.columns[first:], strict=True)
    )
    rows = ""
    above = ""
    for row in table.shown:
        if table.grouped and row[0] != above:
            above = row[0]
            rows += f'<tr><th scope="rowgroup" colspan="{len(marks)}">{escape(above)}</th></tr>\n'
        cells = (f"<td{mark}>{escape(cell)}</td>" for mark, cell in zip(marks, row[first:], strict=True))
        rows += f"<tr>{''.join(cells)}</tr>\n"
    return (
        f'<div class="wide"><table><caption>{escape(table.caption)}</caption>\n'
        f"<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>"
    )
