"""A trial from any file: one that laticauda wrote, or somebody's log with a map of its columns."""

from pathlib import Path

from laticauda.errors import TrialFileError
from laticauda.logs.column_maps import ColumnMap
from laticauda.logs.measuring import load_measured
from laticauda.trial import Format, Trial


def load_trial(path: str | Path, columns: str | Path | ColumnMap | None = None) -> Trial:
    """Read a trial from a file that `Trial.save` wrote, or make one of somebody's log.

    Args:
        path: The file.
        columns: What the columns of a log are: a column map or its TOML file, see `load_measured`; None for a file
            that laticauda wrote.

    Returns:
        A trial that `equals` the saved one, bit for bit.

    Raises:
        TrialFileError: If there is no such file, or it is no whole trial; the message has its name and the reason.
        MissingExtra: If the format needs a package that is not installed.
    """
    path = Path(path)
    if columns is not None:
        return load_measured(path, columns)
    form = Format.of(path)
    if not form.is_whole:
        raise TrialFileError(
            f"Cannot load {path}: a {path.suffix} file does not say what swam; give a column map "
            "(`columns`, on the command line --columns)."
        )
    try:
        return Trial.from_dataset(form.read(path))
    except TrialFileError:
        raise
    except OSError as error:
        raise TrialFileError(f"Cannot read {path}: {(error.strerror or str(error)).lower()}.") from error
    except KeyError as error:
        raise TrialFileError(f"Cannot load {path}: it has no `{error.args[0]}`.") from error
    except (ValueError, TypeError) as error:  # a text or an array that is not as it was written
        raise TrialFileError(f"Cannot load {path}: {error}") from error
