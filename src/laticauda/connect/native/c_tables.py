"""The numbers of a robot as a C header, exact to the last bit."""

import hashlib
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from string import Template

from laticauda.connect.native import entry
from laticauda.connect.native.settable import REFERENCE_SYMBOL
from laticauda.connect.native.tables import Tables
from laticauda.connect.native.variable import Variable

TEMPLATE = Path(__file__).parent / "tables.h.in"
WORKS_HEADER = Path(__file__).parent / "c" / "works.h"
"""What the sources in C have in common."""
NO_PAIR = "{0, 0}"
"""Content of an empty list of pairs."""
CAUSALITY_LETTERS = {"independent": "t", "parameter": "p", "input": "i", "output": "o"}
"""Letters that stand for causalities in C."""
DIGEST_DIGITS = 16
"""Hexadecimal digits of the digest by which stored states are recognized."""


def make_c_identifier(stem: str) -> str:
    """Return a valid C name derived from that of a file.

    Args:
        stem: Name of the file, without its ending.
    """
    identifier = re.sub(r"\W", "_", stem, flags=re.ASCII)
    if identifier[:1].isalpha():
        return identifier
    return f"robot_{identifier}"


def write_headers(tables: Tables, guid: str) -> dict[str, str]:
    """Return the names and texts of the headers that sources in C include.

    Args:
        tables: Robot and variables.
        guid: Identifier that distinguishes this FMU from others.
    """
    return {
        "tables.h": write_c_tables(tables, guid),
        "works.h": WORKS_HEADER.read_text(encoding="utf-8"),
    }


def write_c_tables(tables: Tables, guid: str) -> str:
    """Return the header with a robot's numbers, exact to the last bit.

    Args:
        tables: Robot and variables.
        guid: Identifier that distinguishes this FMU from others.
    """
    variables = tables.variables
    integers = [str(number) for number in tables.whole.tolist()]
    causalities = [f"'{CAUSALITY_LETTERS[variable.causality]}'" for variable in variables]
    names = [f'"{variable.name}"' for variable in variables]
    reference_pairs = _list_pairs(variables, _is_reference)
    work_pairs = _list_pairs(variables, _is_work)
    digest = hashlib.sha256(guid.encode()).hexdigest()
    template = Template(TEMPLATE.read_text(encoding="utf-8"))
    return template.substitute(
        guid=guid,
        digest=digest[:DIGEST_DIGITS],
        n_variables=len(variables),
        n_numbers=tables.n_numbers,
        dt=tables.whole[entry.DT],
        n_references=len(reference_pairs),
        n_works=len(work_pairs),
        references=_write_pairs(reference_pairs),
        works=_write_pairs(work_pairs),
        whole=", ".join(integers),
        real=_write_reals(tables.real.tolist()),
        causality=", ".join(causalities),
        names=", ".join(names),
        start=_write_reals(variable.start for variable in variables),
        least=_write_reals(variable.least for variable in variables),
        most=_write_reals(variable.most for variable in variables),
    )


def _list_pairs(variables: Sequence[Variable], is_one: Callable[[Variable], bool]) -> list[str]:
    """Return the numbers of some variables, each with its only row, as pairs in C."""
    pairs: list[str] = []
    for number, variable in enumerate(variables):
        if not is_one(variable):
            continue
        row = variable.rows[0].row
        pairs.append(f"{{{number}, {row}}}")
    return pairs


def _write_pairs(pairs: list[str]) -> str:
    """Return the content of a list of pairs; C allows no empty one."""
    if not pairs:
        return NO_PAIR
    return ", ".join(pairs)


def _is_reference(variable: Variable) -> bool:
    return variable.causality == "input" and variable.symbol == REFERENCE_SYMBOL


def _is_work(variable: Variable) -> bool:
    return variable.causality == "output" and variable.unit == "J"


def _write_reals(numbers: Iterable[float]) -> str:
    return ", ".join(_write_real(float(number)) for number in numbers)


def _write_real(number: float) -> str:
    if number == float("inf"):
        return "INFINITY"
    if number == float("-inf"):
        return "-INFINITY"
    return number.hex()
