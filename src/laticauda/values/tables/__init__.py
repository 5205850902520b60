"""Tables that people bring: one reader for all of them, and one set of checks.

Numbers come from delimited text of any form, from Excel, or from a format with a reader of its
own (`trials.logs`). All of them become a `Table`, and pass the same checks.

decoding.py   bytes to text: encodings
splitting.py  text to cells: separators, comments
workbooks.py  Excel workbooks to cells
sheets.py     names, units and decimal signs of the cells
opening.py    files by name
renaming.py   columns that the file calls otherwise
columns.py    columns of numbers
units.py      units, and how people write them
times.py      times: units, clocks, order
angles.py     joint angles: units, whole turns, jumps
headings.py   angles of a body: where they were lost, whole turns, jumps
positions.py  positions: where a marker was lost, jumps
"""

from laticauda.values.tables.angles import (
    LARGEST_BEND as LARGEST_BEND,
    SMALLEST_SWING as SMALLEST_SWING,
    check_jumps as check_jumps,
    check_unit as check_unit,
    mend_turns as mend_turns,
)
from laticauda.values.tables.columns import (
    Table as Table,
    add_column as add_column,
    build_table as build_table,
    convert_numbers as convert_numbers,
    parse_float as parse_float,
)
from laticauda.values.tables.decoding import decode_text as decode_text
from laticauda.values.tables.headings import (
    count_turns as count_turns,
    find_lost_angles as find_lost_angles,
)
from laticauda.values.tables.opening import (
    failures_of_table as failures_of_table,
    open_sheet as open_sheet,
)
from laticauda.values.tables.positions import find_lost_samples as find_lost_samples
from laticauda.values.tables.renaming import (
    check_columns as check_columns,
    list_names as list_names,
    parse_columns as parse_columns,
    rename_columns as rename_columns,
    spell_columns as spell_columns,
)
from laticauda.values.tables.sheets import (
    NAME_JOINT as NAME_JOINT,
    Sheet as Sheet,
    parse_sheet as parse_sheet,
)
from laticauda.values.tables.times import (
    check_increasing as check_increasing,
    check_sampling as check_sampling,
    read_times as read_times,
)
from laticauda.values.tables.workbooks import is_workbook as is_workbook
from laticauda.values.tables.units import (
    ANGLES as ANGLES,
    LENGTHS as LENGTHS,
    RATES as RATES,
    TIMES as TIMES,
    TORQUES as TORQUES,
    read_unit as read_unit,
    split_unit as split_unit,
    unit_in_name as unit_in_name,
    unknown_unit as unknown_unit,
)
