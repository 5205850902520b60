"""What a reader finds in a chapter of the report."""

import csv
import html
import io
import re

from laticauda.show.reports.cells import write_csv
from laticauda.show.reports.chapter import Chapter, Pictures


def said(chapter: Chapter, pictures: Pictures | None = None) -> str:
    """Its words without the marks of the page, and with single spaces."""
    text = re.sub(r"<table>.*?</table>", " ", chapter.html(pictures or {}), flags=re.DOTALL)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", text)).split())


def cells(chapter: Chapter, table: str) -> list[dict[str, str]]:
    """A table as its CSV file has it."""
    return list(csv.DictReader(io.StringIO(write_csv(chapter.tables[table]))))
