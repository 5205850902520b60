"""Robot operation, from the trial file and the devices to the recording and the trial.

Names are imported on first use, because recordings load an additional library.
"""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.tank.operate.recording.entries import (
        Decision as Decision,
        Event as Event,
        Header as Header,
        PowerReading as PowerReading,
        punctuality as punctuality,
    )
    from laticauda.tank.operate.recording.log import (
        OperationLog as OperationLog,
        OperationRecorder as OperationRecorder,
        Rerun as Rerun,
        read_operation as read_operation,
        rerun_controller as rerun_controller,
        rerun_estimator as rerun_estimator,
        rerun_learner as rerun_learner,
    )
    from laticauda.tank.operate.recording.to_trial import trial_of as trial_of
    from laticauda.tank.operate.verdict import (
        Verdict as Verdict,
        recorded_verdict_summary as recorded_verdict_summary,
        verdict_of as verdict_of,
    )

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.tank.operate.recording.entries": [
            "Decision",
            "Event",
            "Header",
            "PowerReading",
            "punctuality",
        ],
        "laticauda.tank.operate.recording.log": [
            "OperationLog",
            "OperationRecorder",
            "Rerun",
            "read_operation",
            "rerun_controller",
            "rerun_estimator",
            "rerun_learner",
        ],
        "laticauda.tank.operate.recording.to_trial": ["trial_of"],
        "laticauda.tank.operate.verdict": ["Verdict", "recorded_verdict_summary", "verdict_of"],
    },
    renamed={"spoken": "recorded_verdict_summary"},
)
