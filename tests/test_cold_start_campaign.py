"""The stored answer of campaigns/cold_start.py."""

from campaign_scripts import campaign

cold_start = campaign("cold_start")


def test_the_first_swim_costs_little_more_than_any_other_and_runs_where_little_can_be_written():
    answers = cold_start.stored()
    for case, limit in cold_start.LIMITS.items():
        assert float(answers[case]) <= limit
    assert answers["no home"] == answers["may write nowhere"] == cold_start.WORKS
    assert answers["from an archive"] == cold_start.REFUSED
    shares = [
        int(share.removesuffix(" %"))
        for case, share in answers.items()
        if case.startswith("share of it")
    ]
    if shares:  # they are not stored when the machine was too busy to tell parts of half a second
        assert abs(sum(shares) - 100) <= len(shares)  # rounding
