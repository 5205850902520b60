"""Cases from the field about models, waves and other programs, each with its source in tests/cases/*/case.md.

Cases about tables and recordings are in test_table_cases.py. Where a case has no file, its function
builds what the text says. The values that are asserted are those that the text calls right.
"""

import inspect
from pathlib import Path

import pytest
from cases_of_bodies import BODIES
from cases_of_programs import PROGRAMS
from cases_of_waves import WAVES

CASES = Path(__file__).parent / "cases"
KNOWN = BODIES | WAVES | PROGRAMS


@pytest.mark.parametrize("name", KNOWN)
def test_a_case_from_the_field_has_its_right_value(name, tmp_path, monkeypatch):
    case = KNOWN[name]
    if "monkeypatch" in inspect.signature(case).parameters:
        case(tmp_path, monkeypatch)
    else:
        case(tmp_path)


def test_every_case_from_the_field_is_a_test():
    of_tables = (Path(__file__).parent / "test_table_cases.py").read_text()
    for folder in sorted(CASES.iterdir()):
        assert (folder / "case.md").is_file()
        name = f"case_{folder.name}"
        assert name in KNOWN or f"def {name}(" in of_tables, name
