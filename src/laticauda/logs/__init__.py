"""Files of trials and of other programs: formats, recordings of messages, measured tables with column maps."""

from laticauda.logs.bags import write_bag as write_bag
from laticauda.logs.column_maps import ColumnMap as ColumnMap, load_column_map as load_column_map
from laticauda.logs.loading import load_trial as load_trial
from laticauda.logs.recorder import Frame as Frame, Recorder as Recorder
from laticauda.logs.recording import (
    Logged as Logged,
    Recording as Recording,
    open_recording as open_recording,
)
from laticauda.packaging import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports()
