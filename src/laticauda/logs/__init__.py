"""Files of trials and of other programs: formats, recordings of messages, measured tables with column maps."""

from laticauda.logs.column_maps import load_column_map
from laticauda.logs.column_maps import ColumnMap
from laticauda.logs.loading import load_trial
from laticauda.logs.recorder import Recorder
from laticauda.logs.recording import Logged, Recording, open_recording, read_messages

__all__ = [
    "ColumnMap",
    "Logged",
    "Recorder",
    "Recording",
    "load_column_map",
    "load_trial",
    "open_recording",
    "read_messages",
]
