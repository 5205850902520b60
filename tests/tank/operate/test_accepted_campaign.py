"""A slice of campaigns/accepted.py: what goes wrong without a word of any device is seen, and good runs count."""

from dataclasses import fields

import campaign_scripts
import pytest

from laticauda.tank.operate.settings import Acceptance


@pytest.fixture
def accepted(monkeypatch: pytest.MonkeyPatch):
    campaign = campaign_scripts.campaign("accepted")
    monkeypatch.setattr(campaign, "DURATION", 25.0)  # the campaign's own runs are longer
    return campaign


@pytest.mark.parametrize(
    ("fault", "by"), [("jammed joint", "joint_error"), ("wrong body", "marker_jump")]
)
def test_a_run_with_something_wrong_is_rejected_and_its_verdict_says_by_what(
    accepted, fault: str, by: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(accepted, "DURATION", 17.0)  # both faults begin within 11 s
    row = accepted.run_one(fault, 0)
    assert (row.outcome, row.by) == ("rejected", by)
    assert 0.0 <= row.after <= 15.0


def test_a_good_run_is_accepted_and_uses_two_thirds_of_no_limit(accepted):
    row = accepted.run_one("", 1)
    assert row.outcome == "accepted"
    shares = dict(part.split("=") for part in row.shares.split())
    limits = {limit.name for limit in fields(Acceptance)}
    assert set(shares) == limits - {"time_late"}  # a stepped tank is never late: it has no clock
    assert all(float(share) < 0.67 for share in shares.values())
