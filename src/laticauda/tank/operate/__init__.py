"""Robot operation, from the trial file and the devices to the recording and the trial.

Names are imported on first use, because recordings load an additional library.
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.tank.operate.recording.entries import (
        Decision as Decision,
        Event as Event,
        PowerReading as PowerReading,
    )
    from laticauda.tank.operate.recording.header import Header as Header
    from laticauda.tank.operate.recording.log import (
        OperationLog as OperationLog,
        read_operation as read_operation,
    )
    from laticauda.tank.operate.recording.recorder import OperationRecorder as OperationRecorder
    from laticauda.tank.operate.recording.rerun import (
        Rerun as Rerun,
        rerun_controller as rerun_controller,
        rerun_estimator as rerun_estimator,
        rerun_learner as rerun_learner,
    )
    from laticauda.tank.operate.recording.timing import describe_punctuality as describe_punctuality
    from laticauda.tank.operate.recording.to_trial import trial_of as trial_of
    from laticauda.tank.operate.verdict import (
        Verdict as Verdict,
        recorded_verdict_summary as recorded_verdict_summary,
        verdict_of as verdict_of,
    )
    from laticauda.tank.operate.series import (
        mean_and_deviation as mean_and_deviation,
        run_series as run_series,
    )
    from laticauda.tank.operate.settings import Connection as Connection

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.tank.operate.recording.entries": [
            "Decision",
            "Event",
            "PowerReading",
        ],
        "laticauda.tank.operate.recording.header": ["Header"],
        "laticauda.tank.operate.recording.log": ["OperationLog", "read_operation"],
        "laticauda.tank.operate.recording.recorder": ["OperationRecorder"],
        "laticauda.tank.operate.recording.rerun": [
            "Rerun",
            "rerun_controller",
            "rerun_estimator",
            "rerun_learner",
        ],
        "laticauda.tank.operate.recording.timing": ["describe_punctuality"],
        "laticauda.tank.operate.recording.to_trial": ["trial_of"],
        "laticauda.tank.operate.verdict": ["Verdict", "recorded_verdict_summary", "verdict_of"],
    },
    plain={
        "laticauda.tank.operate.series": ["mean_and_deviation", "run_series"],
        "laticauda.tank.operate.settings": ["Connection"],
    },
    renamed={
        "punctuality": "describe_punctuality",
        "spoken": "recorded_verdict_summary",
    },
)
