"""Trials from any file: one that laticauda wrote, or an external log with a column map."""

from pathlib import Path

from laticauda.trials import Format, Trial
from laticauda.trials.logs import bags, c3d, column_maps, mat, qtm, tabular
from laticauda.trials.logs.measuring import build_measured_trial
from laticauda.trials.logs.recording import failures_of
from laticauda.values import TrialFileError, files
from laticauda.values.tables import Table, build_table, decode_text, is_workbook, parse_sheet

FOREIGN_BAGS = {
    ".db3": "it is a bag of rosbag2 in SQLite; run `ros2 bag convert` with `storage_id: mcap`.",
    ".bag": "it is a bag of ROS 1; `rosbags-convert` of the package `rosbags` makes one of ROS 2.",
}
"""What to do with files of ROS that are not read, by their extension."""


def load_trial(
    path: str | Path, columns: str | Path | column_maps.ColumnMap | None = None
) -> Trial:
    """Read a trial from a file that `Trial.save` wrote, or build one from an external log.

    A log is CSV, TSV, Excel, Parquet, .mat, C3D, or a TSV export of Qualisys Track Manager; the how-to
    "Bring your own measurements" explains what the trial takes from it.

    Args:
        path: The file; its extension sets the format.
        columns: Meaning of the columns of a log: a column map or its TOML file; None for a file
            that laticauda wrote.

    Returns:
        A trial; from a file that laticauda wrote, one that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is not a complete trial; for a log, if a
            column is missing, time does not increase, values are missing over too long a time, or
            the stated units cannot be right. The message gives the file's name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = files.local(path)
    if columns is None:
        return _load_own_file(path)
    if isinstance(columns, column_maps.ColumnMap):
        column_map = columns
        source = str(path)
    else:
        column_map = column_maps.load_column_map(columns)
        source = f"{path} by {columns}"
    with failures_of(source):
        table = read_table(path, column_map.separator, column_map.decimal)
        return build_measured_trial(table, column_map, source=path.name)


def _load_own_file(path: Path) -> Trial:
    """Read a trial from a file that laticauda wrote, or from the only file in a folder for rosbag2."""
    if path.is_dir():
        with failures_of(path):
            path = bags.find_file_in_bag(path)
    if path.suffix.lower() in FOREIGN_BAGS:
        raise TrialFileError(f"Cannot load {path}: {FOREIGN_BAGS[path.suffix.lower()]}")
    file_format = Format.of(path)
    if not file_format.is_whole:
        raise TrialFileError(
            f"Cannot load {path}: a {path.suffix} file does not state the robot; give a column map "
            "(`columns`, on the command line --columns). Measured speeds are for `laticauda identify --table`."
        )
    with failures_of(path):
        return Trial.from_dataset(file_format.read(path))


def read_table(path: Path, separator: str | None = None, decimal: str | None = None) -> Table:
    """Read a file of columns: CSV, TSV, Excel, QTM's TSV, C3D, Parquet, .mat.

    Args:
        path: The file; its extension sets the format, and its first line shows whether a table is
            QTM's.
        separator: Separator between the cells of a text file; detected if None.
        decimal: Decimal separator of a text file, point or comma; detected if None.

    Raises:
        ValueError: If the content is invalid.
        OSError: If the file cannot be read.
        MissingExtra: If the format needs a package that is not installed.
    """
    ending = path.suffix.lower()
    if ending == ".c3d":
        return c3d.read_c3d(path)
    if ending == ".parquet":
        return Table(columns=tabular.read_parquet_columns(path))
    if ending == ".mat":
        return Table(columns=mat.read_mat_columns(path))
    content = files.read_bytes(path)
    if not is_workbook(content):
        text = decode_text(content)
        if text.startswith("NO_OF_FRAMES"):
            return qtm.parse_qtm(text.splitlines())
    return build_table(parse_sheet(content, separator, decimal))
