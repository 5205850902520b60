"""A slice of campaigns/bad_input.py: bad input ends in one sentence, or in finite figures."""

import pytest
from campaign_scripts import campaign

bad_input = campaign("bad_input")


@pytest.mark.parametrize("kind", ["texts", "robots", "lists", "columns", "values"])
def test_bad_input_is_refused_by_name_or_comes_to_finite_figures(kind):
    assert list(bad_input.faults(11, 5, (kind,))) == []


def test_a_traceback_would_be_found():
    def crash(words):
        raise AttributeError("no such thing")

    case = bad_input.Case("calls", "", bad_input.call(crash, {"words": 1}, "words"))
    assert "AttributeError" in bad_input.tried(case)
    assert bad_input.shell(
        "swim", "--fin-amplitude-deg", "-1", names=("--no-such-name",)
    )().startswith("names nothing")
