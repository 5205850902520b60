"""The paper by one call: run its studies, and write figures, tables, data and a report into one folder."""

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from laticauda import __version__
from laticauda.errors import one_of
from laticauda.reports.efficiency import efficiency_figures, efficiency_section
from laticauda.reports.efficiency_tables import efficiency_tables
from laticauda.reports.page import Paragraph, Section, page
from laticauda.studies import EfficiencyStudy, run_efficiency, write_netcdf

STUDIES = ("efficiency",)
TITLE = "Underwater snake robots with and without a caudal fin: the paper's experiments in simulation"
INTRODUCTION = (
    "The trials of “Experimental Investigation of Locomotion Efficiency and Path-Following for Underwater Snake Robots "
    "with and without a Caudal Fin”, repeated in simulation and put beside what was measured on the robot. Nothing was "
    "tuned here to make the two agree: the coefficients are the paper's. All numbers are also in CSV and netCDF files "
    "beside this page."
)

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Reproduction:
    """What was run and written."""

    folder: Path
    """Where everything is."""
    files: tuple[str, ...]
    """Names of the files in it."""
    efficiency: EfficiencyStudy
    """The efficiency study."""


def writable_folder(folder: str | Path) -> Path:
    """The folder, made if it does not exist.

    Args:
        folder: Where a report is to be written.

    Raises:
        ValueError: If it cannot be made, or no file can be written there.
    """
    path = Path(folder)
    if path.exists() and not path.is_dir():
        raise ValueError(f"`folder` must be a folder, got the file {folder}.")
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):  # rights alone do not tell
            pass
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise ValueError(f"`folder` must be a folder that can be written, got {folder}: {why}.") from error
    return path


def reproduce(
    folder: str | Path,
    *,
    only: str | None = None,
    joints: str = "prescribed",
    progress: Progress | None = None,
) -> Reproduction:
    """Run the paper's studies and write everything into a folder.

    Args:
        folder: Made if it does not exist; files of the same names are replaced, others are left alone.
        only: One of `STUDIES`; None runs all there are.
        joints: See `laticauda.simulate.plant`.
        progress: Called now and then with what is going on, how much of it is done, and how much there is.

    Returns:
        What was run and written.

    Raises:
        ValueError: If an argument is out of its range, or the folder cannot be written; nothing has been run then.
        SimulationFailed: If a trial blows up.
    """
    if only is not None:
        one_of("only", only, STUDIES)
    folder = writable_folder(folder)

    def tell(what: str, done: int, total: int) -> None:
        if progress is not None:
            progress(what, done, total)

    study = run_efficiency(joints=joints, progress=lambda done, total: tell("trials", done, total))
    files, section = _write_efficiency(study, folder, tell)
    introduction = [Paragraph(text=INTRODUCTION), Paragraph(text=f"Made with laticauda {__version__}.")]
    (folder / "report.html").write_text(page(TITLE, introduction, [section]), encoding="utf-8")
    return Reproduction(folder=folder, files=(*files, "report.html"), efficiency=study)


def _write_efficiency(study: EfficiencyStudy, folder: Path, tell: Progress) -> tuple[list[str], Section]:
    """Write the study's data, tables and figures; return the files' names, and its section of the report."""
    from laticauda.figures import save_figure

    write_netcdf(study, folder / "efficiency.nc")
    files = ["efficiency.nc"]
    for table in efficiency_tables(study):
        (folder / f"{table.name}.csv").write_text(table.csv, encoding="utf-8")
        files.append(f"{table.name}.csv")
    pictures: dict[str, tuple[str, bytes]] = {}
    n_figures = sum(len(group.figures) for group in study.settings.groups)
    for name, caption, figure in efficiency_figures(study):
        for suffix in (".png", ".pdf"):
            save_figure(figure, folder / f"{name}{suffix}")
            files.append(f"{name}{suffix}")
        pictures[name] = (caption, (folder / f"{name}.png").read_bytes())
        tell("figures", len(pictures), n_figures)
    return files, efficiency_section(study, pictures)
