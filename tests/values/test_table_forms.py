"""Forms of one table x three doors: read right, or refused with the cause; nothing is silent."""

import re

import numpy as np
import pytest
from table_forms import DOORS, FORMS, bring, numbers_of


@pytest.mark.parametrize("name", FORMS)
def test_a_form_of_a_table_is_read_right_or_refused_with_the_cause(name, tmp_path):
    form = FORMS[name]
    for door in form.doors:
        result = bring(form, door, tmp_path)
        if door in form.refused:
            assert result.numbers is None, (door, result)
            assert re.search(form.refused[door], result.sentence), (door, result)
            continue
        assert result.numbers is not None, (door, result)
        expected = numbers_of(DOORS[door][0]())
        np.testing.assert_allclose(result.numbers, expected, rtol=1e-9, atol=1e-6, err_msg=door)
        assert bool(result.sentence) == (door in form.warned), (door, result)
        assert re.search(form.warned.get(door, ""), result.sentence), (door, result)


def test_there_are_enough_forms():
    assert len(FORMS) >= 34


def test_excel_itself(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    for door, (make, read) in DOORS.items():
        cells = make()
        workbook = openpyxl.Workbook()
        workbook.active.append(cells.names)
        for row in cells.rows:
            workbook.active.append([cell if cell == "LU" else float(cell) for cell in row])
        path = tmp_path / "table.xlsx"
        workbook.save(path)
        np.testing.assert_allclose(read(path, cells), numbers_of(cells), err_msg=door)
