"""A slice of campaigns/strangers_net.py, and what its stored answer says."""

import re

import pytest
from campaign_scripts import campaign

from laticauda.connect import Server

strangers_net = campaign("strangers_net")


def test_no_stranger_got_or_broke_anything():
    rows = {question: [] for question in strangers_net.QUESTIONS}
    for row in strangers_net.stored():
        rows[row.question].append(row)
    assert all(rows.values())
    for row in rows["listeners"]:
        assert row.answer.startswith("loopback: ")
    for row in rows["tokens"]:
        expected = "no token: refused; a wrong one: refused; the token: answered"
        if "127.0.0.1" in row.asked:
            expected = "no token: not reached"
        assert row.answer == expected
    for row in rows["origins"]:
        is_ours = "its own" in row.asked or "of this computer" in row.asked
        assert row.answer.startswith("gets nothing") is not is_ours
        assert "done" not in row.answer or row.answer.endswith("done: 0")
    for row in rows["greedy"]:
        assert float(re.match(r"most (\d+) MB", row.answer)[1]) < 1000.0
    for row in rows["talks"]:
        assert row.answer.startswith("0 faults, 0 tracebacks, alive")
    for row in rows["code"]:
        assert row.answer == "none imported, compiled, run or unpickled"


def test_hostile_conversations_end_in_no_fault(capfd):
    with Server(port=0) as server:
        assert strangers_net.converse_often(server.port, 40, 7) == []
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.parametrize("address", ["tcp 127.0.0.1:80", "udp 239.74.163.2:1", "tcp ::1:80"])
def test_the_campaign_knows_what_only_this_computer_reaches(address):
    assert strangers_net.is_here(address)


@pytest.mark.parametrize("address", ["tcp 0.0.0.0:80", "udp 10.0.0.1:1", "tcp :::80"])
def test_the_campaign_knows_what_others_reach(address):
    assert not strangers_net.is_here(address)
