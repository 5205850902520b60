import numpy as np
import pytest

from laticauda.operate.recording.entries import Tick, Timing


def test_missed_are_the_ticks_that_were_not_over_when_the_next_was_due():
    due = np.arange(5) * 0.01
    began = due + np.array([0.0, 0.001, 0.0, 0.004, 0.0])
    sent = due + np.array([0.001, 0.002, 0.012, 0.005, 0.001])
    timing = Timing(ticks=[Tick(*row) for row in np.array([due, began, sent]).T.tolist()], interval=0.01)
    summary = timing.summary()
    assert summary["missed"] == 1
    assert summary["ticks"] == 5
    assert summary["latency_largest"] == pytest.approx(0.012)
    assert summary["period_median"] == pytest.approx(0.01, abs=0.002)
