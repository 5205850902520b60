"""Export of a robot in water as a plain library in C, for onboard computers and programs that call C."""

import os
import re
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from string import Template
from typing import Unpack

import laticauda as lc
from laticauda import scenarios
from laticauda.connect.native.c_tables import make_c_identifier, write_headers
from laticauda.connect.native.linking import LinkedLibrary, combine_libraries, link_library
from laticauda.connect.native.machine_code import compile_kernels_of
from laticauda.connect.native.platforms import C_FOLDER, find_library_platforms
from laticauda.connect.native.tables import Tables, build_tables_of_scenario
from laticauda.connect.native.variable import Variable
from laticauda.values import BadArgument, files

STATUS_NAMES = ("DIVERGED", "WRONG_INTERVAL")
"""What the library's functions return on an error, without the prefix that each library has."""


def export_c(
    path: str | os.PathLike[str],
    robot: scenarios.Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    platform: str | None = None,
    static: bool = False,
    **changes: Unpack[scenarios.Changes],
) -> tuple[Variable, ...]:
    """Export a planar robot in water as a C library, which runs without Python, and a header that describes it.

    Args:
        path: The header (.h), after which the structure and the functions are named; the library is
            written next to it. Existing files are replaced.
        robot: The scenario, whose duration is ignored; or the robot, with its gait.
        gait: With a robot: the gait that the joints follow unless the inputs say otherwise; for the
            kind custom, including its envelope.
        inputs: What drives the robot: `gait` (amplitude, frequency, phase shift, offset) or, for
            joints driven by pd control or servos, `references` (an angle for every joint, and for a
            driven fin).
        platform: Target platform: linux64, aarch64 (Linux), win64, darwin; that of this machine if
            omitted.
        static: Whether to write a static library instead of a shared one.
        changes: With a robot, further changes to the defaults: `environment`, `current`, `model`,
            `start`, `sample_interval` [s], or, for the model, `joints`, `dt` [s] and the other
            fields of `laticauda.scenarios.ModelChanges`.

    Returns:
        The variables, in the order of the structure.

    Raises:
        ValueError: If an argument is out of range, or robot, gait and inputs are incompatible.
        MissingProgram, MissingExtra: If there is no C compiler for that platform.
        LinkingFailed: If the C compiler fails.
    """
    header_path = Path(path)
    platforms = find_library_platforms([platform] if platform else [])
    if header_path.suffix.lower() != ".h":
        raise BadArgument("path", f"must be a file that ends in .h, got {path}")
    tables = build_tables_of_scenario(robot, gait, inputs, **changes)
    name = make_c_identifier(header_path.stem)
    header = write_header(tables, name)
    included_headers = {
        **write_headers(tables, name),
        "header.h": header + "\n" + _write_definitions(name),
    }
    libraries: list[LinkedLibrary] = []
    codes = compile_kernels_of(tables.plant, platforms)
    for target, machine_code in zip(platforms, codes, strict=True):
        library = link_library(
            machine_code,
            target,
            sources=[C_FOLDER / "library.c"],
            headers=included_headers,
            static=static,
        )
        libraries.append(LinkedLibrary(machine_code=machine_code, library=library))
    ending = ".a" if static else platforms[0].system.library_ending
    library_path = header_path.with_name(f"lib{header_path.stem}{ending}")
    files.write(library_path, combine_libraries(libraries))
    files.write(header_path, header.encode())
    return tables.variables


def _write_definitions(name: str) -> str:
    """Return the macros by which library.c names a robot's structure, functions and errors."""
    lines = [f"#define {status} {name.upper()}_{status}" for status in STATUS_NAMES]
    lines.append(f"#define ROBOT {name}")
    lines.append(f"#define FUNCTION(what) {name}_##what")
    return "\n".join(lines) + "\n"


def write_header(tables: Tables, name: str) -> str:
    """Return the header of a robot's library.

    Args:
        tables: The robot and its variables.
        name: Name of the structure, and prefix of the function names.
    """
    template = Template((C_FOLDER / "library.h").read_text(encoding="utf-8"))
    return template.substitute(
        words=tables.description.replace("*/", "* /"),  # within a comment
        version=lc.__version__,
        name=name,
        guard=name.upper(),
        fields="\n".join(_list_members(tables.variables)),
        rows=tables.n_numbers,
    )


def _list_members(variables: Sequence[Variable]) -> list[str]:
    """Return the members of the structure; variables numbered from 0 form one array."""
    members: list[str] = []
    for stem, group in groupby(variables, key=_stem_of):
        neighbors = list(group)
        if neighbors[0].name.endswith("[0]"):
            members.append(_write_array(stem, neighbors))
            continue
        for variable in neighbors:
            name = re.sub(r"\W+", "_", variable.name).strip("_")
            members.append(_write_member(name, variable, variable.description))
    return members


def _stem_of(variable: Variable) -> str:
    """Return the name of a variable without its number."""
    stem, _, _ = variable.name.partition("[")
    return stem


def _write_array(stem: str, elements: Sequence[Variable]) -> str:
    """Return the member that is an array of variables, described as the first one with i as its number."""
    name = stem.replace(".", "_")
    first = elements[0]
    description = re.sub(r"\b0\b", "i", first.description)
    return _write_member(f"{name}[{len(elements)}]", first, description)


def _write_member(name: str, variable: Variable, description: str) -> str:
    properties = [variable.causality, variable.shown_unit]
    if variable.is_settable:
        properties.append(f"{variable.least:g} to {variable.most:g}")
    return f"    double {name}; /* {', '.join(properties)}. {description} */"
