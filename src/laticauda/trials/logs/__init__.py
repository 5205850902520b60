"""Files of trials and of other programs: formats, recordings of messages, measured tables with column maps.

Formats of trials: `tabular` (CSV, Parquet), `netcdf`, `mat` (MATLAB, GNU Octave), `mcap_trials`
(messages of ROS 2). Messages: `recorder` writes them to an MCAP file, `recording` reads any, even a
truncated one, from its `mcap_records`; `ros2` encodes and decodes them; `bags` makes a folder for
rosbag2.

Logs of other programs: `tables` holds columns by name and reads delimited text, `qtm` and `c3d` read
files of motion capture, `c3d_frames` those with many frames. `column_maps` says what columns mean,
in its `map_sections`. `loading` reads any file, `measuring` builds a trial from a table: `row_times`
gives its samples, `measured_log` its columns without gaps, `placing` the position and shape of the
robot, `rates` slopes.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.trials.logs.bags import write_bag as write_bag
    from laticauda.trials.logs.column_maps import (
        ColumnMap as ColumnMap,
        load_column_map as load_column_map,
    )
    from laticauda.trials.logs.loading import load_trial as load_trial
    from laticauda.trials.logs.recorder import Frame as Frame, Recorder as Recorder, CLOCK as CLOCK
    from laticauda.trials.logs.recording import (
        Logged as Logged,
        Recording as Recording,
        open_recording as open_recording,
        failures_of as failures_of,
    )
    from laticauda.trials.logs.map_sections import (
        Heading as Heading,
        JointColumns as JointColumns,
        Position as Position,
        TimeColumn as TimeColumn,
    )
    from laticauda.trials.logs.measuring import build_measured_trial as build_measured_trial
    from laticauda.trials.logs.netcdf import write_dataset as write_dataset
    from laticauda.trials.logs.rates import interpolate_columns as interpolate_columns
    from laticauda.trials.logs.tabular import TableColumn as TableColumn, format_csv as format_csv

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.trials.logs.bags": ["write_bag"],
        "laticauda.trials.logs.column_maps": ["ColumnMap", "load_column_map"],
        "laticauda.trials.logs.loading": ["load_trial"],
        "laticauda.trials.logs.recorder": ["Frame", "Recorder"],
        "laticauda.trials.logs.recording": ["Logged", "Recording", "open_recording"],
    },
    plain={
        "laticauda.trials.logs.map_sections": [
            "Heading",
            "JointColumns",
            "Position",
            "TimeColumn",
        ],
        "laticauda.trials.logs.measuring": ["build_measured_trial"],
        "laticauda.trials.logs.netcdf": ["write_dataset"],
        "laticauda.trials.logs.rates": ["interpolate_columns"],
        "laticauda.trials.logs.recorder": ["CLOCK"],
        "laticauda.trials.logs.recording": ["failures_of"],
        "laticauda.trials.logs.tabular": ["TableColumn", "format_csv"],
    },
)
