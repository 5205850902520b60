"""A robot in water as a plain library in C: for robots' own computers, and for whatever can call C."""

import os
import re
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from string import Template
from typing import Unpack

import laticauda as lc
from laticauda import files
from laticauda.cosim.native import entry
from laticauda.cosim.native.platforms import FOLDER, linked, object_codes, platforms_of, universal
from laticauda.cosim.native.tables import Tables, identifier, tables_for, tables_in_c
from laticauda.cosim.native.variables import Variable
from laticauda.errors import BadArgument
from laticauda.packaging import __version__
from laticauda.scenarios import Changes, Scenario

STATUS = ("DIVERGED", "WRONG_INTERVAL")


def export_c(
    path: str | os.PathLike[str],
    robot: Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    platform: str | None = None,
    static: bool = False,
    **changes: Unpack[Changes],
) -> tuple[Variable, ...]:
    """Write a planar robot in water to a library in C, which needs no Python, and a header that says what is in it.

    Args:
        path: The header (.h), whose name becomes that of the structure and of the functions; the library is written
            beside it. Older ones are replaced.
        robot: As for `export_fmu`.
        gait: As for `export_fmu`.
        inputs: As for `export_fmu`.
        platform: Where it is to run: linux64, aarch64 (Linux), win64, darwin; on machines like this one if left out.
        static: Whether to write a static library instead of a shared one.
        changes: As for `export_fmu`.

    Returns:
        The variables, in the order of the structure.

    Raises:
        ValueError: If an argument is out of its range, or robot, gait and inputs do not fit together.
        MissingProgram, MissingExtra: If there is no C compiler for that platform.
        LinkingFailed: If it fails.
    """
    file, wanted = Path(path), platforms_of([platform] if platform else [])
    if file.suffix.lower() != ".h":
        raise BadArgument("path", f"must be a file that ends in .h, got {path}")
    tables = tables_for(robot, gait, inputs, **changes)
    name, sources = identifier(file.stem), [FOLDER / "library.c"]
    header = header_of(tables, name)
    own = [f"#define {word} {name.upper()}_{word}" for word in STATUS]
    own += [f"#define ROBOT {name}", f"#define FUNCTION(what) {name}_##what"]
    headers = {"tables.h": tables_in_c(tables, name), "header.h": "\n".join((header, *own, ""))}
    codes = zip(object_codes(tables.plant, wanted), wanted, strict=True)
    made = universal([(code, linked(code, one, sources, headers, static=static)) for code, one in codes])
    files.write(file.with_name(f"lib{file.stem}{'.a' if static else wanted[0].system.ending}"), made)
    files.write(file, header.encode())
    return tables.variables


def header_of(tables: Tables, name: str) -> str:
    """The header of a robot's library.

    Args:
        tables: The robot, and its variables.
        name: Of the structure, and what its functions' names begin with.
    """
    return Template((FOLDER / "library.h").read_text(encoding="utf-8")).substitute(
        words=tables.words,
        version=__version__,
        name=name,
        guard=name.upper(),
        fields="\n".join(_fields(tables.variables)),
        rows=tables.n_rows + entry.SCRATCH,
    )


def _fields(variables: tuple[Variable, ...]) -> Iterator[str]:
    """Members of the structure; variables that are counted from 0 are one array."""
    for stem, group in groupby(variables, key=lambda one: one.name.partition("[")[0]):
        some, plain = list(group), stem.replace(".", "_")
        if some[0].name.endswith("[0]"):
            yield _field(f"{plain}[{len(some)}]", some[0], re.sub(r"\b0\b", "i", some[0].description))
        else:
            yield from (_field(re.sub(r"\W+", "_", one.name).strip("_"), one, one.description) for one in some)


def _field(name: str, variable: Variable, text: str) -> str:
    facts = [variable.causality, "-" if variable.unit == "1" else variable.unit]
    if variable.causality in ("parameter", "input"):
        facts.append(f"{variable.least:g} to {variable.most:g}")
    return f"    double {name}; /* {', '.join(facts)}. {text} */"
