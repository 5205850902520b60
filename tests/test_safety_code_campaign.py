"""The stored answer of campaigns/safety_code.py, and one file of it anew."""

import pytest
from campaign_scripts import campaign

safety_code = campaign("safety_code")


def test_every_statement_and_branch_of_the_safety_code_is_run_by_its_own_tests():
    rows = safety_code.stored()
    files = [
        str(file.relative_to(safety_code.ROOT))
        for part in safety_code.TESTS
        for file in safety_code.files_of(part)
    ]
    assert [row["file"] for row in rows] == files  # a new file has to be measured
    assert not [row for row in rows if row["not_run"] or row["branches_not_taken"]]
    assert (
        sum(int(row["statements"]) for row in rows) > 1500
        and sum(int(row["branches"]) for row in rows) > 300
    )


@pytest.mark.slow
def test_what_no_test_runs_is_listed_by_line_and_branch():
    (file,) = (one for one in safety_code.files_of("tank/protocol") if one.name == "meter.py")
    lines = ["", *file.read_text(encoding="utf-8").splitlines()]
    rows = safety_code.measure(
        ["tank/protocol"], tests=["tests/tank/protocol/test_meter.py::test_the_current_comes_back"]
    )
    _, statements, branches, missing, ways = next(
        row for row in rows if row[0].endswith("meter.py")
    )
    not_run = [lines[int(line)].strip() for line in missing.split()]
    assert 'return question.encode("ascii") + END' in not_run
    assert 'return f"{current:.6E},ADC,NORMAL,NONE"' not in not_run
    assert 80 < statements and branches == 24 and "->" in ways
