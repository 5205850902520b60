"""Verdict on a run that reached its end: how close it came to each limit, and since when.

The yardstick is a simulation of the same robot with servos in its joints, driven by the references
that were sent. A joint may therefore lie anywhere between its reference and the angle that its
servo reaches under the water's load. A speed that differs from the model's is only noted, because
the model may be wrong. A speed that *changes* while the model's does not shows that something
happened to robot, cameras or water, and rejects the run. For details, see docs/theory/verdict.md.

    verdict.py       the list of all checks, and the verdict on a run
    check.py         what a check is, and how its measurement is compared with its limit
    recorded_run.py  the recording, cut into cycles of the gait
    model_run.py     the same run, swum by the model
    completeness.py  joints.py  cameras.py  motion.py  preparation.py
                     the checks, by what they look at
    signals.py       running medians, jumps and ranges
"""

from laticauda.tank.operate.verdict.check import CheckResult as CheckResult
from laticauda.tank.operate.verdict.verdict import (
    Verdict as Verdict,
    recorded_verdict_summary as recorded_verdict_summary,
    verdict_of as verdict_of,
)
from laticauda.values import renamed_names

__getattr__ = renamed_names(
    __name__, {"Check": "CheckResult", "spoken": "recorded_verdict_summary"}
)
