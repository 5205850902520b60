"""Excel workbooks by the real openpyxl: what people have in them is read, or refused with its place."""

import datetime
import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laticauda as lc
from laticauda.trials.measured import load_speeds
from laticauda.values import TableWarning, TrialFileError
from laticauda.values.tables import open_sheet
from laticauda.values.tables.workbooks import read_workbook

openpyxl = pytest.importorskip("openpyxl", reason="workbooks are read by openpyxl")
NAMES = ["time_s", "joint_1_deg", "joint_2_deg"]
ROWS = [[round(0.05 * i, 10), 0.5 * i, -0.4 * i] for i in range(40)]
SPEEDS = [
    ["gait", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "P_avg_W"],
    ["LU", 30, 130, 40, 0.1514, 106.63],
    ["LU", 25, 130, 40, 0.13, 90],
]


def workbook(path: Path, rows: list[list[Any]], **others: list[list[Any]]) -> Path:
    """A sheet `Data` with these rows, and others by name."""
    book = openpyxl.Workbook()
    book.active.title = "Data"
    sheets = {"Data": rows, **others}
    for name, cells in sheets.items():
        sheet = book[name] if name in book.sheetnames else book.create_sheet(name)
        for row in cells:
            sheet.append(row)
    book.save(path)
    return path


def assert_read(path: Path) -> lc.JointAngles:
    found = lc.load_joint_angles(path)
    assert found.time == pytest.approx([row[0] for row in ROWS], abs=1e-6)
    np.testing.assert_allclose(np.degrees(found.angle).T, [row[1:] for row in ROWS], atol=1e-9)
    return found


def test_a_plain_workbook_is_read_and_said(tmp_path):
    found = assert_read(workbook(tmp_path / "a.xlsx", [NAMES, *ROWS]))
    assert "an Excel workbook" in found.reading
    assert load_speeds(workbook(tmp_path / "s.xlsx", SPEEDS))[1].P_avg_W == 90.0


def test_rows_have_their_numbers_in_the_file(tmp_path):
    cells = [["# by hand"], [None, None], ["t", "x"], [0.1, None], [2, 3.5]]
    rows = read_workbook(workbook(tmp_path / "a.xlsx", cells).read_bytes())
    assert [(row.number, list(row.cells)) for row in rows] == [
        (3, ["t", "x"]),
        (4, ["0.1", ""]),
        (5, ["2", "3.5"]),
    ]


START = datetime.datetime(2026, 11, 29, 17, 30)


@pytest.mark.parametrize(
    ("times", "remark"),
    [
        ([START + datetime.timedelta(seconds=row[0]) for row in ROWS], "since 1970; time 0 is its"),
        ([(START + datetime.timedelta(seconds=row[0])).time() for row in ROWS], "begin at 63000 s"),
        ([datetime.timedelta(seconds=5.0 + row[0]) for row in ROWS], "begin at 5 s; time 0 is its"),
        ([(START + datetime.timedelta(seconds=row[0])).isoformat() for row in ROWS], "since 1970"),
    ],
)
def test_dates_and_clocks_are_times(tmp_path, times, remark):
    rows = [[time, *row[1:]] for time, row in zip(times, ROWS, strict=True)]
    with pytest.warns(TableWarning, match=remark):
        assert_read(workbook(tmp_path / "a.xlsx", [NAMES, *rows]))


def test_numbers_as_texts_with_decimal_commas_are_numbers(tmp_path):
    rows = [[f"{number:.10g}".replace(".", ",") for number in row] for row in ROWS]
    assert_read(workbook(tmp_path / "a.xlsx", [NAMES, *rows]))


@pytest.mark.parametrize("n_empty", [1, 50])
def test_empty_rows_and_columns_around_a_table_are_nothing(tmp_path, n_empty):
    rows = [[], NAMES, *ROWS[:10], [], *ROWS[10:], *[[None, "", " "]] * n_empty]
    assert_read(workbook(tmp_path / "a.xlsx", [["# by hand"], *rows]))
    assert_read(
        workbook(tmp_path / "b.xlsx", [[*NAMES, None, None], *[[*row, None] for row in ROWS]])
    )


def test_the_only_sheet_with_cells_is_read_wherever_it_is(tmp_path):
    assert_read(workbook(tmp_path / "a.xlsx", [], Log=[NAMES, *ROWS], More=[]))
    path = workbook(tmp_path / "b.xlsx", [NAMES, *ROWS], Notes=[["fin off"]])
    message = "b.xlsx: it has several sheets, `Data`, `Notes`: save the one with the table alone"
    with pytest.raises(TrialFileError, match=message):
        lc.load_joint_angles(path)
    with pytest.raises(TrialFileError, match="it is not a text file of columns, or it is empty"):
        lc.load_joint_angles(workbook(tmp_path / "c.xlsx", []))


@pytest.mark.parametrize(("row", "column"), [(2, 1), (7, 2), (40, 3)])
def test_a_formula_without_its_result_is_refused_with_its_place(tmp_path, row, column):
    rows = [list(cells) for cells in ROWS]
    rows[row - 2][column - 1] = "=1+1"
    message = f"row {row} of sheet `Data` has a formula without its result in column {column}: open"
    with pytest.raises(TrialFileError, match=message):
        lc.load_joint_angles(workbook(tmp_path / "a.xlsx", [NAMES, *rows]))


def test_a_power_by_a_formula_is_not_silently_missing(tmp_path):
    rows = [*SPEEDS[:2], [*SPEEDS[2][:5], "=F2*2"]]
    with pytest.raises(TrialFileError, match="row 3 of sheet `Data` has a formula without its"):
        load_speeds(workbook(tmp_path / "s.xlsx", rows))


@pytest.mark.parametrize("error", ["#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NAME?", "#NUM!"])
def test_a_row_that_begins_with_an_error_is_no_comment(tmp_path, error):
    rows = [list(cells) for cells in ROWS]
    rows[5][0] = error
    with pytest.raises(TrialFileError, match=f"must hold numbers, got '{error[:4]}.* in row 7"):
        lc.load_joint_angles(workbook(tmp_path / "a.xlsx", [NAMES, *rows]))
    lines = [",".join(map(str, row)) for row in [NAMES, *rows]]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    with pytest.raises(TrialFileError, match=f"must hold numbers, got '{error[:4]}.* in row 7"):
        lc.load_joint_angles(tmp_path / "a.csv")


def test_merged_cells_above_a_table_are_refused_with_their_row(tmp_path):
    path = workbook(tmp_path / "a.xlsx", [["Trial 3, fin off"], NAMES, *ROWS])
    book = openpyxl.load_workbook(path)
    book.active.merge_cells("A1:C1")
    book.save(path)
    with pytest.raises(TrialFileError, match=r"row 2 must have 1 cells, .*; is row 1 a title\?"):
        lc.load_joint_angles(path)
    path = workbook(tmp_path / "b.xlsx", [["time_s", "angles", None], *ROWS])
    book = openpyxl.load_workbook(path)
    book.active.merge_cells("B1:C1")
    book.save(path)
    with pytest.raises(TrialFileError, match="row 2 must have 2 cells, as row 1 has, got 3"):
        lc.load_joint_angles(path)


def test_a_wrong_size_in_the_file_costs_no_row(tmp_path):
    path = workbook(tmp_path / "a.xlsx", [NAMES, *ROWS])
    content = io.BytesIO()
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(content, "w") as new:
        for name in old.namelist():
            text = old.read(name)
            if name.endswith("sheet1.xml"):
                text = text.replace(b'<dimension ref="A1:C41"', b'<dimension ref="A1:C5"')
                assert b"A1:C5" in text
            new.writestr(name, text)
    path.write_bytes(content.getvalue())
    assert_read(path)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_a_cut_workbook_is_refused(tmp_path, share):
    path = workbook(tmp_path / "a.xlsx", [NAMES, *ROWS])
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(TrialFileError, match="it is not an intact Excel file"):
        open_sheet(path, TrialFileError)


def test_another_zip_file_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.xlsx", "w") as file:
        file.writestr("notes.txt", "1,2")
    with pytest.raises(TrialFileError, match="it is not an intact Excel file"):
        open_sheet(tmp_path / "a.xlsx", TrialFileError)
