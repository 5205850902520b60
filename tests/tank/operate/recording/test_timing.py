import numpy as np
import pytest

from laticauda.tank.operate.recording.timing import Timing, describe_punctuality
from laticauda.values import BadArgument


def test_missed_are_the_ticks_that_were_not_over_when_the_next_was_due():
    due = np.arange(5) * 0.01
    began = due + np.array([0.0, 0.001, 0.0, 0.004, 0.0])
    sent = due + np.array([0.001, 0.002, 0.012, 0.005, 0.001])
    timing = Timing(times=np.array([due, began, sent]).T, interval=0.01)
    summary = timing.summary()
    assert summary["missed"] == 1
    assert summary["ticks"] == 5
    assert summary["latency_largest"] == pytest.approx(0.012)
    assert summary["period_median"] == pytest.approx(0.01, abs=0.002)
    assert summary["lateness_largest"] == pytest.approx(0.004)
    said = describe_punctuality(summary)
    assert said.startswith(
        "5 ticks of 10.00 ms, 1 missed; late by 0.00 ms (median), 3.99 (99.9 %), 4.00 at most;"
    )
    assert said.endswith("all sent after 2.00 ms (median), 11.97 (99.9 %), 12.00 at most")


def test_a_loop_without_ticks_says_so_and_no_more():
    assert (
        describe_punctuality(Timing(times=np.empty((0, 3)), interval=0.01).summary())
        == "0 ticks of 10.00 ms, 0 missed"
    )


@pytest.mark.parametrize("missing", ["interval", "lateness_median", "latency_p99_9"])
def test_a_summary_that_lacks_a_figure_of_its_sentence_is_refused_by_that_figure(missing):
    summary = Timing(times=np.array([[0.0, 0.001, 0.002]]), interval=0.01).summary()
    del summary[missing]
    with pytest.raises(
        BadArgument, match=f"`timing` must hold {missing}, as `Timing.summary` does"
    ):
        describe_punctuality(summary)
