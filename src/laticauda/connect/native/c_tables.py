"""The numbers of a robot as a C header, exact to the last bit."""

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path
from string import Template

from laticauda.connect.native import entry
from laticauda.connect.native.tables import Tables

TEMPLATE = Path(__file__).parent / "tables.h.in"
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
    digest = hashlib.sha256(guid.encode()).hexdigest()
    template = Template(TEMPLATE.read_text(encoding="utf-8"))
    return template.substitute(
        guid=guid,
        digest=digest[:DIGEST_DIGITS],
        n_variables=len(variables),
        n_numbers=tables.n_numbers,
        dt=tables.whole[entry.DT],
        whole=", ".join(integers),
        real=_write_reals(tables.real.tolist()),
        causality=", ".join(causalities),
        names=", ".join(names),
        start=_write_reals(variable.start for variable in variables),
        least=_write_reals(variable.least for variable in variables),
        most=_write_reals(variable.most for variable in variables),
    )


def _write_reals(numbers: Iterable[float]) -> str:
    return ", ".join(_write_real(float(number)) for number in numbers)


def _write_real(number: float) -> str:
    if number == float("inf"):
        return "INFINITY"
    if number == float("-inf"):
        return "-INFINITY"
    return number.hex()
