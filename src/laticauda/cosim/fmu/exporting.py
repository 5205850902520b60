"""A robot in water as an FMU: a file that other simulation tools load and step.

Machine code and tables of numbers become a shared library by a C compiler.
"""

import hashlib
import io
import os
import time
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Unpack
from uuid import UUID

import laticauda as lc
from laticauda import files
from laticauda.cosim.fmu import description
from laticauda.cosim.native.platforms import linked, object_codes, platforms_of, universal
from laticauda.cosim.native.tables import identifier, tables_for, tables_in_c
from laticauda.cosim.native.variables import Variable
from laticauda.errors import BadArgument, one_of
from laticauda.packaging import __version__
from laticauda.scenarios import Changes, Scenario

HERE = Path(__file__).parent
FOLDER = HERE / "c"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of all files inside, so that the same robot makes the same FMU


def export_fmu(
    path: str | os.PathLike[str],
    robot: Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    fmi: str = "2.0",
    platform: Sequence[str] = (),
    author: str | None = None,
    model_version: str | None = None,
    license: str = "MIT",
    **changes: Unpack[Changes],
) -> tuple[Variable, ...]:
    """Write a planar robot in water to an FMU for co-simulation that needs no Python where it is used.

    Inside are the kernels that `laticauda.swim` runs, compiled for each platform. Inputs are held during a
    communication step of any length, which is cut into steps of the integration no longer than `dt`.

    Args:
        path: The file (.fmu); an older one is replaced.
        robot: The scenario, whose duration does not count; or what swims, with its gait.
        gait: With a robot: what the joints are asked for unless the FMU is told otherwise; of kind custom, its
            envelope too.
        inputs: What drives the robot: `gait` (amplitude, frequency, phase shift, offset) or, for joints driven by pd
            control or servos, `references` (an angle for every joint, and for a driven fin).
        fmi: Version of the standard: 2.0, which all tools read, or 3.0.
        platform: Where it is to run, one or several: linux64, aarch64 (Linux), win64, darwin; if left out, on machines
            like this one. For others than this machine, the package ziglang has to be there.
        author: Who made the model, as the FMU says it.
        model_version: Of the model; laticauda's own if left out.
        license: Of the model. The text of the kernels' own is in the FMU.
        changes: With a robot, what else differs from the defaults; see `laticauda.scenarios.Changes`.

    Returns:
        The FMU's variables, in the order of their value references.

    Raises:
        ValueError: If an argument is out of its range, or robot, gait and inputs do not fit together.
        MissingProgram, MissingExtra: If there is no C compiler, which puts the compiled kernels into a library.
        LinkingFailed: If it fails.
    """
    file = Path(path)
    if file.suffix.lower() != ".fmu":
        raise BadArgument("path", f"must be a file that ends in .fmu, got {path}")
    one_of("fmi", fmi, description.VERSIONS)
    wanted = platforms_of(platform)
    tables = tables_for(robot, gait, inputs, **changes)
    codes = object_codes(tables.plant, wanted)
    words = description.Description(
        identifier=identifier(file.stem),
        tables=tables,
        platforms=", ".join(one.pair for one in wanted),
        version=fmi,
        imprint={"author": author, "version": model_version or __version__, "license": license},
    )
    content = words.model_description() + tables_in_c(tables, "").encode() + b"".join(codes)
    content += b"".join(part.read_bytes() for part in sorted(FOLDER.iterdir()))
    guid = f"{{{UUID(hashlib.sha256(content).hexdigest()[:32])}}}"  # a digest of all that it is made of
    sources, headers = (FOLDER / f"fmi{fmi[0]}.c",), {"tables.h": tables_in_c(tables, guid)}
    libraries: dict[str, list[tuple[bytes, bytes]]] = {}
    for one, code in zip(wanted, codes, strict=True):
        folder = one.folder if fmi == "2.0" else one.pair
        name = f"binaries/{folder}/{words.identifier}{one.system.ending}"
        libraries.setdefault(name, []).append((code, linked(code, one, sources, headers)))
    parts = {
        "modelDescription.xml": words.model_description(guid, _now()),
        **{name: universal(some) for name, some in libraries.items()},
        "documentation/index.html": words.page().encode(),
        "documentation/licenses/license.txt": (HERE / "license.txt").read_bytes(),
        "model.png" if fmi == "2.0" else "terminalsAndIcons/icon.png": (HERE / "icon.png").read_bytes(),
    }
    files.write(file, _zipped(parts))
    return tables.variables


def _now() -> str:
    """This moment, or what reproducible builds take for it; to the second, as the standard has it."""
    seconds = float(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))


def _zipped(content: dict[str, bytes]) -> bytes:
    """The archive that an FMU is; the same content always gives the same bytes."""
    raw = io.BytesIO()
    with zipfile.ZipFile(raw, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, date_time=_EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, data)
    return raw.getvalue()
