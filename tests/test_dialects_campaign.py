"""The campaign dialects.py: no dialect of a table gives other numbers silently; what it stores is what it finds."""

import pytest
from campaign_scripts import campaign

dialects = campaign("dialects")
PLAIN = {
    "separator": "comma",
    "decimal": ".",
    "encoding": "utf-8",
    "header": "ours",
    "time": "s",
    "unit": "deg",
    "ends": "unix",
}


def test_the_stored_answer_has_nothing_silent_and_nothing_without_a_sentence():
    answers = dialects.stored()
    assert len(answers) == 3 * dialects.NUMBER
    assert {answer.verdict for answer in answers} == {"right", "said", "cured", "refused"}
    assert all(answer.sentence for answer in answers if answer.verdict == "refused")


@pytest.mark.parametrize("seed", [11, 12])
def test_other_dialects_are_not_silent_either(seed):
    answers = dialects.judge_dialects(12, seed)
    bad = [answer for answer in answers if answer.verdict in ("SILENT", "crashed")]
    assert bad == []


@pytest.mark.parametrize(
    ("door", "change", "verdict"),
    [
        ("--joint-angles", {}, "right"),
        ("column map", {"separator": "semicolon", "decimal": ","}, "right"),
        ("--table", {"header": "own names"}, "cured"),
        ("--joint-angles", {"header": "own names", "separator": "blank"}, "cured"),
        ("--joint-angles", {"time": "ms unsaid"}, "refused"),
        ("--joint-angles", {"unit": "rad called deg"}, "refused"),
        ("--table", {"unit": "rad"}, "refused"),
        ("column map", {"unit": "rad called deg"}, "said"),
    ],
)
def test_a_dialect_gets_the_verdict_that_it_deserves(tmp_path, door, change, verdict):
    assert dialects.judge(door, {**PLAIN, **change}, tmp_path)[0] == verdict


def test_other_numbers_are_found_to_be_silent(tmp_path, monkeypatch):
    read = dialects.read_numbers
    reading = dialects.Reading
    monkeypatch.setattr(
        dialects, "read_numbers", lambda *given: reading(read(*given).numbers * 1.01)
    )
    assert dialects.judge("--joint-angles", PLAIN, tmp_path)[0] == "SILENT"
