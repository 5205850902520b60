import csv
import io

import pytest

from laticauda.paper.report.efficiency_tables import efficiency_tables


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
