import csv
import io

import pytest

from laticauda.reports.tables import Column, Table, shown


def test_csv_files_have_all_digits_and_empty_cells_for_what_is_missing():
    columns = (Column(name="a, b"), Column(name="v [m/s]", form=".2f"), Column(name="end"))
    table = Table(name="t", caption="", columns=columns, rows=(("x", 0.123456, True), ('"', None, False)))
    assert list(csv.reader(io.StringIO(table.csv))) == [
        ["a, b", "v [m/s]", "end"],
        ["x", "0.123456", "yes"],
        ['"', "", "no"],
    ]
    assert table.shown == [["x", "0.12", "yes"], ['"', "NA", "no"]]


def test_negative_numbers_are_shown_with_a_minus_sign_and_not_a_hyphen():
    assert shown(-1.5, ".1f") == "\N{MINUS SIGN}1.5"


def test_what_is_rounded_to_zero_has_no_sign():
    assert [shown(-0.0004, ".2f"), shown(0.0, "+.1f"), shown(0.06, "+.1f")] == ["0.00", "0.0", "+0.1"]


def test_a_row_with_too_few_cells_is_refused():
    with pytest.raises(ValueError, match=r"`rows\[0\]` must have 1 cells, one per column, got 2"):
        Table(name="t", caption="", columns=(Column(name="a"),), rows=((1, 2),))
