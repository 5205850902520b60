"""A slice of campaigns/identify_coverage.py: intervals that hold the truth as often as they say."""

from studies.sweeps import campaign

coverage = campaign("identify_coverage")
ROBOTS = 3


def test_stated_intervals_hold_the_truth_and_what_is_unseen_is_not_stated():
    table = coverage.counts([coverage.case(number) for number in range(ROBOTS)])
    hit, stated = (sum(table[name][i] for name in coverage.SEEN) for i in (0, 1))
    assert stated >= 5 * ROBOTS
    # Of 18 intervals, fewer than 15 hold the truth once in 90 times if each does in 95 % of all cases.
    assert hit >= stated - 3
    for name in coverage.HIDDEN:
        assert table[name] == (0, 0, ROBOTS), name
