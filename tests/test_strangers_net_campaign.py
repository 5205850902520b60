"""A slice of campaigns/strangers_net.py, and what its stored answer says."""

import re

import pytest
from campaign_scripts import campaign

from laticauda.connect import Server

strangers_net = campaign("strangers_net")


def test_no_stranger_got_or_broke_anything():
    kept = {question: [] for question in strangers_net.QUESTIONS}
    for question, asked, answer in strangers_net.stored():
        kept[question].append((asked, answer))
    assert all(kept.values())
    assert all(answer.startswith("loopback: ") for _, answer in kept["listeners"])
    for asked, answer in kept["tokens"]:
        assert answer == (
            "no token: not reached"
            if "127.0.0.1" in asked
            else "no token: refused; a wrong one: refused; the token: answered"
        )
    for asked, answer in kept["origins"]:
        assert answer.startswith("gets nothing") is (
            "its own" not in asked and "of this computer" not in asked
        )
        assert "done" not in answer or answer.endswith("done: 0")
    assert all(
        float(re.match(r"most (\d+) MB", answer)[1]) < 1000.0 for _, answer in kept["greedy"]
    )
    assert all(answer.startswith("0 faults, 0 tracebacks, alive") for _, answer in kept["talks"])
    assert all(answer == "none imported, compiled, run or unpickled" for _, answer in kept["code"])


def test_hostile_conversations_end_in_no_fault(capfd):
    with Server(port=0) as server:
        assert strangers_net.talked(server.port, 40, 7) == []
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.parametrize("address", ["tcp 127.0.0.1:80", "udp 239.74.163.2:1", "tcp ::1:80"])
def test_the_campaign_knows_what_only_this_computer_reaches(address):
    assert strangers_net.is_here(address)


@pytest.mark.parametrize("address", ["tcp 0.0.0.0:80", "udp 10.0.0.1:1", "tcp :::80"])
def test_the_campaign_knows_what_others_reach(address):
    assert not strangers_net.is_here(address)
