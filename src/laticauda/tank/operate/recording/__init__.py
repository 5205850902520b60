"""Recording of an operation: one file for everything, read again, and converted to a trial.

entries.py    what is recorded, besides the raw frames of the bus
timing.py     ticks of the loop, and how punctual they were
header.py     what is known about the whole operation when it begins
messages.py   entries as messages of the file, bit for bit, and back
recorder.py   the file, while an operation runs
writer.py     the same in a separate program, so that the loop is not late
log.py        a recording, read again
rerun.py      estimator, learner or controller, run once more on what was recorded
to_trial.py   the run in a recording as a trial
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.tank.operate.recording.header import HEADER as HEADER

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {},
    plain={
        "laticauda.tank.operate.recording.header": ["HEADER"],
    },
)
