import csv
import io

import pytest

from laticauda.paper.report.efficiency_tables import efficiency_tables
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


def test_the_tables_of_the_study_have_all_their_rows(study):
    rows = {table.name: len(table.rows) for table in efficiency_tables(study)}
    points = sum(sweep.forward_velocity.size for sweep in study.sweeps)
    assert rows == {"table1": 22, "table1-maxima": 12, "fin-gain": 11, "errors": 6, "sweeps": points}


def test_table_1_as_a_file_is_table_1(study):
    table = efficiency_tables(study)[0]
    first, *_ = csv.DictReader(io.StringIO(table.csv))
    assert (first["amplitude [deg]"], first["frequency [deg/s]"], first["phase shift [deg]"]) == ("30", "130", "40")
    assert first["measured: v [m/s]"] == "0.1514"
    assert float(first["analytical-set: v [m/s]"]) == pytest.approx(study.cases[0].forward_velocity[0])
    assert float(first["analytical-set: error [%]"]) == pytest.approx(
        100 * (study.cases[0].forward_velocity[0] / 0.1514 - 1)
    )
