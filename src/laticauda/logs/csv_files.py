"""The time series of a trial as a CSV file, for a spreadsheet: a row of names with units, then a row per sample."""

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from laticauda.logs import flat
from laticauda.trial import Format

if TYPE_CHECKING:
    import xarray


class CsvFile(Format):
    """Columns are called as `joint_angle_0 [rad]`; 0 is the tail."""

    called: ClassVar[str] = "csv"
    title: ClassVar[str] = "CSV, time series only"
    is_whole: ClassVar[bool] = False

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write the time series; see `Format.write`."""
        columns = list(flat.columns(dataset))
        text = io.StringIO(newline="")
        writer = csv.writer(text)
        writer.writerow([f"{name} [{unit}]" for name, unit, _ in columns])
        writer.writerows(np.stack([values for _, _, values in columns], axis=1).tolist())
        path.write_bytes(text.getvalue().encode())
