"""Export of a robot in water as an FMU: a file that other simulation tools load and step.

A C compiler links machine code and tables of numbers into a shared library. The FMU is described by
`modelDescription.xml` for programs, and by an HTML page for people.
"""

import hashlib
import io
import os
import time
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Unpack
from uuid import UUID

import laticauda as lc
from laticauda import scenarios
from laticauda.connect.fmu.documentation import write_documentation
from laticauda.connect.fmu.model_description import (
    FMI_VERSIONS,
    Description,
    write_model_description,
)
from laticauda.connect.native.c_tables import make_c_identifier, write_headers
from laticauda.connect.native.linking import LinkedLibrary, combine_libraries, link_library
from laticauda.connect.native.machine_code import compile_kernels_of
from laticauda.connect.native.platforms import Platform, find_library_platforms
from laticauda.connect.native.tables import build_tables_of_scenario
from laticauda.connect.native.variable import Variable
from laticauda.values import BadArgument, check_choice, files

FOLDER = Path(__file__).parent
C_FOLDER = FOLDER / "c"
"""C sources of the functions of FMI 2 and 3."""

MODIFICATION_DATE = (1980, 1, 1, 0, 0, 0)
"""Date and time of all files inside, so that the same robot gives the same FMU."""
EXECUTABLE_MODE = 0o755
"""Permissions of the libraries inside."""
PLAIN_MODE = 0o644
"""Permissions of the other files inside."""


def export_fmu(
    path: str | os.PathLike[str],
    robot: scenarios.Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    fmi: str = "2.0",
    platform: Sequence[str] = (),
    author: str | None = None,
    model_version: str | None = None,
    license: str = "MIT",
    **changes: Unpack[scenarios.Changes],
) -> tuple[Variable, ...]:
    """Export a planar robot in water as an FMU for co-simulation, which runs without Python.

    The FMU contains the kernels that `laticauda.swim` runs, compiled for each platform. Inputs are
    held constant during a communication step of any length, which is divided into integration steps
    no longer than `dt`.

    Args:
        path: The file (.fmu); an existing one is replaced.
        robot: The scenario, whose duration is ignored; or the robot, with its gait.
        gait: With a robot: the gait that the joints follow unless the FMU's inputs say otherwise;
            for the kind custom, including its envelope.
        inputs: What drives the robot: `gait` (amplitude, frequency, phase shift, offset) or, for
            joints driven by pd control or servos, `references` (an angle for every joint, and for a
            driven fin).
        fmi: Version of the standard: 2.0, which all tools support, or 3.0.
        platform: One or more target platforms: linux64, aarch64 (Linux), win64, darwin; if omitted,
            that of this machine. Platforms other than this machine's require the package ziglang.
        author: Author of the model, as stated in the FMU.
        model_version: Version of the model; laticauda's own if omitted.
        license: License of the model. The FMU also contains the text of the kernels' own license.
        changes: With a robot, further changes to the defaults: `environment`, `current`, `model`,
            `start`, `sample_interval` [s], or, for the model, `joints`, `dt` [s] and the other
            fields of `laticauda.scenarios.ModelChanges`.

    Returns:
        The FMU's variables, in the order of their value references.

    Raises:
        ValueError: If an argument is out of range, or robot, gait and inputs are incompatible.
        MissingProgram, MissingExtra: If there is no C compiler to link the compiled kernels into a
            library.
        LinkingFailed: If the C compiler fails.
    """
    file = Path(path)
    if file.suffix.lower() != ".fmu":
        raise BadArgument("path", f"must be a file that ends in .fmu, got {path}")
    check_choice("fmi", fmi, FMI_VERSIONS)
    platforms = find_library_platforms(platform)
    tables = build_tables_of_scenario(robot, gait, inputs, **changes)
    codes = compile_kernels_of(tables.plant, platforms)
    imprint = {"author": author, "version": model_version or lc.__version__, "license": license}
    description = Description(
        identifier=make_c_identifier(file.stem),
        tables=tables,
        imprint=imprint,
        fmi_version=fmi,
    )
    guid = _make_guid(description, codes)
    libraries = _link_libraries(description, guid, platforms, codes)
    icon = "model.png" if description.is_fmi2 else "terminalsAndIcons/icon.png"
    content = {
        "modelDescription.xml": write_model_description(description, guid, _date_of_creation()),
        **libraries,
        "documentation/index.html": write_documentation(description, platforms).encode(),
        "documentation/licenses/license.txt": (FOLDER / "license.txt").read_bytes(),
        icon: (FOLDER / "icon.png").read_bytes(),
    }
    files.write(file, _write_archive(content))
    return tables.variables


def _make_guid(description: Description, codes: Sequence[bytes]) -> str:
    """Return the identifier of an FMU: a digest of everything from which it is made."""
    content = write_model_description(description)
    for header in write_headers(description.tables, "").values():
        content += header.encode()
    content += b"".join(codes)
    for source in sorted(C_FOLDER.iterdir()):
        content += source.read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    return f"{{{UUID(digest[:32])}}}"


def _link_libraries(
    description: Description,
    guid: str,
    platforms: Sequence[Platform],
    codes: Sequence[bytes],
) -> dict[str, bytes]:
    """Return the libraries by their paths in the FMU; those of both kinds of Mac may share a path, and are one file."""
    source = C_FOLDER / f"fmi{description.fmi_version[0]}.c"
    headers = write_headers(description.tables, guid)
    libraries: dict[str, list[LinkedLibrary]] = {}
    for platform, machine_code in zip(platforms, codes, strict=True):
        folder = platform.fmi2_folder if description.is_fmi2 else platform.pair
        ending = platform.system.library_ending
        path = f"binaries/{folder}/{description.identifier}{ending}"
        library = link_library(machine_code, platform, sources=[source], headers=headers)
        linked = LinkedLibrary(machine_code=machine_code, library=library)
        libraries.setdefault(path, []).append(linked)
    return {path: combine_libraries(parts) for path, parts in libraries.items()}


def _date_of_creation() -> str:
    """Return the current time, or the one set for reproducible builds, to the second, as the standard requires."""
    seconds = float(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))


def _write_archive(content: Mapping[str, bytes]) -> bytes:
    """Return the archive that makes up an FMU; the same content always gives the same bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            mode = EXECUTABLE_MODE if name.startswith("binaries/") else PLAIN_MODE
            entry = zipfile.ZipInfo(name, date_time=MODIFICATION_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = mode << 16  # the upper half holds Unix permissions
            archive.writestr(entry, data)
    return buffer.getvalue()
