"""A chapter: what one study puts into the folder of a reproduction, and into its report."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from laticauda.errors import BadArgument
from laticauda.files import write
from laticauda.reports.page import Section
from laticauda.reports.tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Mapping[str, tuple[str, bytes]]
"""By name of the figure: its caption and the content of its PNG file."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Chapter:
    """What a study has to say, before anything is written."""

    section: Callable[[Pictures], Section]
    """Its part of the report, once its figures are drawn."""
    tables: tuple[Table, ...] = ()
    """Written as CSV files under their names."""
    n_figures: int = 0
    """How many figures there are [-]."""
    figures: "Callable[[], Iterator[tuple[str, str, Figure]]]" = lambda: iter(())
    """One figure after the other: the name of its files, its caption, and the figure."""
    data: Mapping[str, Callable[[Path], None]] = field(default_factory=dict[str, Callable[[Path], None]])
    """By name of the file: what writes it."""


def writable_folder(folder: str | Path) -> Path:
    """The folder, made if it does not exist.

    Args:
        folder: Where a report is to be written.

    Raises:
        ValueError: If it cannot be made, or no file can be written there.
    """
    path = Path(folder)
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


def write_chapter(chapter: Chapter, folder: Path, drawn: Callable[[int], None]) -> tuple[list[str], Section]:
    """Write a chapter's data, tables and figures.

    Args:
        chapter: What to write.
        folder: Where; it exists.
        drawn: Called after every figure with how many there are so far.

    Returns:
        The names of the files, and the chapter's part of the report.
    """
    from laticauda.figures import save_figure

    files: list[str] = []
    for name, store in chapter.data.items():
        write(folder / name, store)
        files.append(name)
    for table in chapter.tables:
        write(folder / f"{table.name}.csv", table.csv)
        files.append(f"{table.name}.csv")
    pictures: dict[str, tuple[str, bytes]] = {}
    for name, caption, figure in chapter.figures():
        paths = [folder / f"{name}{suffix}" for suffix in (".png", ".pdf")]
        save_figure(figure, *paths)
        files += [path.name for path in paths]
        pictures[name] = (caption, (folder / f"{name}.png").read_bytes())
        drawn(len(pictures))
    return files, chapter.section(pictures)
