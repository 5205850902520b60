"""A trial from any file: one that laticauda wrote, or somebody's log with a map of its columns."""

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from laticauda import files, trial
from laticauda.errors import TrialFileError
from laticauda.logs import array_files, column_maps, measuring, tabular
from laticauda.logs.tables import Table, csv_table, qtm_table, read_c3d


def load_trial(path: str | Path, columns: str | Path | column_maps.ColumnMap | None = None) -> trial.Trial:
    """Read a trial from a file that `Trial.save` wrote, or make one of somebody's log.

    A log is CSV, TSV, Parquet, .mat, C3D, or what Qualisys Track Manager exports as TSV; what the trial has of it says
    the how-to "Bring your own measurements".

    Args:
        path: The file; its ending says what it is.
        columns: What the columns of a log are: a column map or its TOML file; None for a file that laticauda wrote.

    Returns:
        A trial that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is no whole trial; of a log, if a column is missing, time does
            not increase, values are missing over too long a time, or units cannot be what is said. The message has the
            file's name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = Path(path)
    if columns is not None:
        given = columns if isinstance(columns, column_maps.ColumnMap) else column_maps.load_column_map(columns)
        with _failures_of(path):
            return measuring.measured_trial(read_table(path, given.separator, given.decimal), given, path.name)
    form = trial.Format.of(path)
    if not form.is_whole:
        raise TrialFileError(
            f"Cannot load {path}: a {path.suffix} file does not say what swam; give a column map "
            "(`columns`, on the command line --columns)."
        )
    with _failures_of(path):
        return trial.Trial.from_dataset(form.read(path))


def read_table(path: Path, separator: str | None = None, decimal: str = ".") -> Table:
    """Read a file of columns: CSV, TSV, QTM's TSV, C3D, Parquet, .mat.

    Args:
        path: The file; its ending says what it is, and its first line whether a table is QTM's.
        separator: Between the cells of a text; found by itself if None.
        decimal: Point or comma, in a text.

    Raises:
        ValueError: If it makes no sense.
        OSError: If it cannot be read.
        MissingExtra: If it needs a package that is not installed.
    """
    ending = path.suffix.lower()
    if ending == ".c3d":
        return read_c3d(path)
    if ending in (".parquet", ".mat"):
        return Table(columns=tabular.parquet_columns(path) if ending == ".parquet" else array_files.mat_columns(path))
    content = files.read_bytes(path)
    try:
        lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        lines = content.decode("latin-1").splitlines() if b"\x00" not in content else []
    if not lines:
        raise ValueError("it is no text of columns, or it is empty.")
    return qtm_table(lines) if lines[0].startswith("NO_OF_FRAMES") else csv_table(lines, separator, decimal)


@contextmanager
def _failures_of(path: Path) -> Generator[None]:
    """Within it, what goes wrong is said of that file."""
    try:
        yield
    except TrialFileError:
        raise
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no `{error.args[0]}`.") from error
    except (ValueError, TypeError) as error:  # a text or an array that is not as it was written
        raise TrialFileError(f"Cannot load {path}: {error}") from error
