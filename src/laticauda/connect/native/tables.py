"""A robot in water as two arrays of numbers for the compiled function, and the table of its variables.

Both are also written in C: as numbers for an FMU, or as a plain library for onboard computers and
programs that call C.
"""

import hashlib
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from string import Template
from typing import Any, Unpack, cast

import numpy as np
from jaxtyping import Float, Int

import laticauda as lc
from laticauda import scenarios
from laticauda.connect.native import entry
from laticauda.connect.native.platforms import FOLDER, linked, object_codes, platforms_of, universal
from laticauda.connect.native.variables import Variable, variables_of
from laticauda.models.planar import model, rows
from laticauda.models.planar.layout import build_layout
from laticauda.values import files
from laticauda.values.checks import check_choice, check_instance
from laticauda.values.errors import BadArgument

Triples = Sequence[tuple[int, int, float]]
INPUTS = ("gait", "references")
STATUS = ("DIVERGED", "WRONG_INTERVAL")
LETTERS = {"independent": "t", "parameter": "p", "input": "i", "output": "o"}


@dataclass(frozen=True, kw_only=True, eq=False)
class Tables:
    """Everything that distinguishes one FMU from another."""

    variables: tuple[Variable, ...]
    """Variables, in the order of their value references."""
    whole: Int[np.ndarray, " n_whole"]
    """Shape of the chain, and the mapping from variables to rows; see `entry`."""
    real: Float[np.ndarray, " n_real"]
    """All rows at the start, and the factors that belong to `whole`."""
    n_rows: int
    """Number of rows in the kernels' array [-]."""
    plant: model.PlanarPlant
    """Robot, environment and laws."""
    inputs: str
    """Inputs that drive the robot: gait or references [-]."""

    @property
    def words(self) -> str:
        """Description of the robot in one sentence."""
        body, robot = self.plant, self.plant.robot
        fin = "" if robot.caudal_fin is None else " with a caudal fin"
        return (
            f"The swimming snake robot {robot.name}{fin}: {robot.n_links} links, {robot.length:.3g} m, "
            f"{robot.mass:.3g} kg, {body.joints.words}, in water ({body.environment.name}); planar model."
        )


def tables_for(
    robot: lc.Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    inputs: str = "gait",
    **changes: Any,
) -> Tables:
    """Return the arrays of a planar scenario in water; arguments and errors as for `export_fmu`."""
    check_choice("inputs", inputs, INPUTS)
    chosen = (
        robot
        if isinstance(robot, lc.Scenario)
        else lc.build_scenario(robot, cast(lc.Gait, gait), **changes)
    )
    for name, kind in {
        "environment": lc.Water,
        "model": lc.Planar,
        "motion": lc.Gait,
        "start": lc.Start,
    }.items():
        check_instance(name, getattr(chosen, name), kind)
    plant, gait = cast(model.PlanarPlant, lc.build_plant(chosen)), chosen.gait
    plant.flow.refuse_tables("an FMU or a library in C")
    if inputs == "references" and plant.joints.prescribed:
        raise BadArgument(
            "inputs",
            "must be 'gait' for prescribed joints, which cannot jump; take others (joints=\"servo\" in Python, "
            "--joints servo of `laticauda export`), got 'references'",
        )
    if inputs == "references":  # the wave does not move, so its parameters have no meaning
        gait = replace(gait, amplitude=0.0, frequency=0.0, phase_shift=0.0, offset=0.0)
    return tables_of(plant, gait, cast(lc.Start, chosen.start), inputs=inputs)


def tables_of(plant: model.PlanarPlant, gait: lc.Gait, start: lc.Start, *, inputs: str) -> Tables:
    """Return the arrays of a robot in water.

    Args:
        plant: Plant in water.
        gait: Gait that the joints follow unless the inputs say otherwise.
        start: Initial state.
        inputs: Inputs that drive the robot: gait or references.

    Raises:
        ValueError: If the plant rejects the gait, or external references.
    """
    held = (0.0,) * len(plant.robot.driven_joints) if inputs == "references" else None
    command = lc.Command(gait=gait, references=held)
    template = plant.rows(plant.init(start, command), command)
    variables = variables_of(plant, gait, start, inputs=inputs)
    number = {variable.name: i for i, variable in enumerate(variables)}
    terms, slopes = _water_slopes(plant, variables)
    a = plant.layout
    n = a.n_bodies
    freedom = (a.law >= rows.FIRST_FREE).astype(int)
    packed = _Packed(template)
    shape = n, a.tail_link, int(a.has_extras), int(plant.is_implicit), template.size
    told = (number[name] for name in ("dt", "start.heading", "start.velocity"))
    # The joint laws are preceded by their number and followed by flags of the free joints.
    chains = (
        packed.add(a.first_strip),
        packed.add(a.first_plate),
        packed.add([n, *a.law, *freedom]) + 1,
    )
    packed.header[: entry.TERMS] = *shape, *told, *chains  # in the order of `entry`
    packed.piece(entry.TERMS, terms)
    packed.piece(entry.SLOPES, slopes)
    first = [(i, *share) for i, variable in enumerate(variables) for share in variable.start_rows]
    packed.piece(entry.STARTED, [*_shares(variables, "parameter"), *first])
    packed.piece(entry.HELD, _shares(variables, "input"))
    packed.piece(entry.SEEN, [(0, rows.TIME, 1.0), *_shares(variables, "output")])
    whole, real = packed.arrays
    return Tables(
        variables=variables,
        whole=whole,
        real=real,
        n_rows=template.size,
        plant=plant,
        inputs=inputs,
    )


class _Packed:
    """The two arrays while they are being built."""

    def __init__(self, template: np.ndarray) -> None:
        self.header = [0] * entry.HEADER
        self._whole: list[int] = []
        self._real: list[float] = template.tolist()

    def add(self, numbers: Iterable[Any]) -> int:
        """Append integers, and return where they begin."""
        begin = entry.HEADER + len(self._whole)
        self._whole += [int(number) for number in numbers]
        return begin

    def piece(self, place: int, triples: Triples) -> None:
        """Append pairs and factors to the arrays, and store in the header where they begin."""
        pairs = self.add(number for first, second, _ in triples for number in (first, second))
        self.header[place : place + 3] = [pairs, len(self._real), len(triples)]
        self._real += [factor for _, _, factor in triples]

    @property
    def arrays(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array([*self.header, *self._whole], dtype=np.int64), np.array(self._real)


def _shares(variables: Sequence[Variable], causality: str) -> Triples:
    """Return variable, row and factor for all variables of a causality."""
    mine = [
        (i, variable) for i, variable in enumerate(variables) if variable.causality == causality
    ]
    return [(i, *share) for i, variable in mine for share in variable.rows]


def _water_slopes(
    plant: model.PlanarPlant, variables: Sequence[Variable]
) -> tuple[Triples, Triples]:
    """Compute how the rows depend on density and coefficients, from layouts of the robot in other waters.

    Each row is the sum of a constant, a constant times the density, and, for each coefficient, a
    constant times the density times that coefficient (`laticauda.robot.hydrodynamics`); products of two
    coefficients do not occur. Differences between layouts are therefore exact slopes, up to
    rounding, and not a linearization.

    Returns:
        The terms, as coefficient (or `entry.NONE`), density, and their product in the template; and
        term, row and slope for each row that depends on a term.
    """
    water = plant.environment
    assert isinstance(water, lc.Water)
    fields = {
        variable.coefficient: i for i, variable in enumerate(variables) if variable.coefficient
    }
    density = fields.pop("density")
    here = plant.layout.template
    terms: list[tuple[int, int, float]] = []
    slopes: list[tuple[int, int, float]] = []
    left = _difference(
        plant, water, here, "density", water.density
    )  # per unit of density, at these coefficients
    for name, i in fields.items():
        value: float = getattr(water, name)
        slope = _difference(plant, water, here, name, max(1.0, value)) / water.density
        left -= value * slope
        slopes += [(len(terms), int(row), float(slope[row])) for row in np.flatnonzero(slope)]
        terms.append((i, density, value * water.density))
    left[np.abs(left) * water.density <= 1e-12 * np.abs(here)] = 0.0  # rounding
    slopes += [(len(terms), int(row), float(left[row])) for row in np.flatnonzero(left)]
    terms.append((entry.NONE, density, water.density))
    return terms, slopes


def _difference(
    plant: model.PlanarPlant, water: lc.Water, here: np.ndarray, field: str, step: float
) -> np.ndarray:
    """Return the change of the rows per unit of a field of the water."""
    there: Any = {field: getattr(water, field) + step}
    other = build_layout(plant.robot, replace(water, **there), joints=plant.joints).template
    change = (other - here) / step
    change[np.abs(other - here) <= 1e-13 * np.abs(here)] = 0.0
    return change


# ---- in C ----------------------------------------------------------------------------------------


def c_identifier(stem: str) -> str:
    """Return a valid C name derived from that of a file."""
    plain = re.sub(r"\W", "_", stem, flags=re.ASCII)
    return plain if plain[:1].isalpha() else f"robot_{plain}"


def tables_in_c(tables: Tables, guid: str) -> str:
    """Return the header with a robot's numbers, exact to the last bit.

    Args:
        tables: Robot and variables.
        guid: Identifier that distinguishes this FMU from others.
    """
    variables = tables.variables
    return Template((FOLDER.parent / "tables.h.in").read_text(encoding="utf-8")).substitute(
        guid=guid,
        digest=hashlib.sha256(guid.encode()).hexdigest()[:16],
        n_variables=len(variables),
        n_numbers=tables.n_rows + entry.SCRATCH,
        dt=tables.whole[entry.DT],
        whole=", ".join(map(str, tables.whole.tolist())),
        real=_reals(tables.real),
        causality=", ".join(f"'{LETTERS[variable.causality]}'" for variable in variables),
        names=", ".join(f'"{variable.name}"' for variable in variables),
        **{
            name: _reals(getattr(variable, name) for variable in variables)
            for name in ("start", "least", "most")
        },
    )


def _reals(numbers: Iterable[float] | Sequence[float] | np.ndarray) -> str:
    return ", ".join(_real(float(number)) for number in numbers)


def _real(number: float) -> str:
    if number in (float("inf"), float("-inf")):
        return "INFINITY" if number > 0.0 else "-INFINITY"
    return number.hex()


# ---- as a library in C ---------------------------------------------------------------------------


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
    file, wanted = Path(path), platforms_of([platform] if platform else [])
    if file.suffix.lower() != ".h":
        raise BadArgument("path", f"must be a file that ends in .h, got {path}")
    tables = tables_for(robot, gait, inputs, **changes)
    name, sources = c_identifier(file.stem), [FOLDER / "library.c"]
    header = header_of(tables, name)
    own = [f"#define {word} {name.upper()}_{word}" for word in STATUS]
    own += [f"#define ROBOT {name}", f"#define FUNCTION(what) {name}_##what"]
    headers = {"tables.h": tables_in_c(tables, name), "header.h": "\n".join((header, *own, ""))}
    codes = zip(object_codes(tables.plant, wanted), wanted, strict=True)
    made = universal(
        [(code, linked(code, one, sources, headers, static=static)) for code, one in codes]
    )
    files.write(
        file.with_name(f"lib{file.stem}{'.a' if static else wanted[0].system.ending}"), made
    )
    files.write(file, header.encode())
    return tables.variables


def header_of(tables: Tables, name: str) -> str:
    """Return the header of a robot's library.

    Args:
        tables: The robot and its variables.
        name: Name of the structure, and prefix of the function names.
    """
    return Template((FOLDER / "library.h").read_text(encoding="utf-8")).substitute(
        words=tables.words.replace("*/", "* /"),  # within a comment
        version=lc.__version__,
        name=name,
        guard=name.upper(),
        fields="\n".join(_fields(tables.variables)),
        rows=tables.n_rows + entry.SCRATCH,
    )


def _fields(variables: tuple[Variable, ...]) -> Iterator[str]:
    """Yield the members of the structure; variables numbered from 0 form one array."""
    for stem, group in groupby(variables, key=lambda one: one.name.partition("[")[0]):
        some, plain = list(group), stem.replace(".", "_")
        if some[0].name.endswith("[0]"):
            yield _field(
                f"{plain}[{len(some)}]", some[0], re.sub(r"\b0\b", "i", some[0].description)
            )
        else:
            yield from (
                _field(re.sub(r"\W+", "_", one.name).strip("_"), one, one.description)
                for one in some
            )


def _field(name: str, variable: Variable, text: str) -> str:
    facts = [variable.causality, "-" if variable.unit == "1" else variable.unit]
    if variable.causality in ("parameter", "input"):
        facts.append(f"{variable.least:g} to {variable.most:g}")
    return f"    double {name}; /* {', '.join(facts)}. {text} */"
