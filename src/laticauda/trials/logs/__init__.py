"""Files of trials and of other programs: formats, recordings of messages, measured tables with column maps."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.trials.logs.bags import write_bag as write_bag
    from laticauda.trials.logs.column_maps import (
        ColumnMap as ColumnMap,
        load_column_map as load_column_map,
    )
    from laticauda.trials.logs.loading import load_trial as load_trial, interpolated as interpolated
    from laticauda.trials.logs.recorder import Frame as Frame, Recorder as Recorder, CLOCK as CLOCK
    from laticauda.trials.logs.recording import (
        Logged as Logged,
        Recording as Recording,
        open_recording as open_recording,
        failures_of as failures_of,
    )
    from laticauda.trials.logs.tabular import csv_text as csv_text

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
        "laticauda.trials.logs.loading": ["interpolated"],
        "laticauda.trials.logs.recorder": ["CLOCK"],
        "laticauda.trials.logs.recording": ["failures_of"],
        "laticauda.trials.logs.tabular": ["csv_text"],
    },
)
