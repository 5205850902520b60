"""The stored answer of campaigns/cold_start.py."""

from campaign_scripts import campaign

cold_start = campaign("cold_start")


def test_the_first_swim_costs_little_more_than_any_other_and_runs_where_little_can_be_written():
    kept = cold_start.stored()
    assert all(float(kept[case]) <= limit for case, limit in cold_start.LIMITS.items())
    assert kept["no home"] == kept["may write nowhere"] == cold_start.WORKS
    assert kept["from an archive"] == cold_start.REFUSED
    shares = [
        int(share.removesuffix(" %"))
        for case, share in kept.items()
        if case.startswith("share of it")
    ]
    if shares:  # they are not stored when the machine was too busy to tell parts of half a second
        assert abs(sum(shares) - 100) <= len(shares)  # rounding
