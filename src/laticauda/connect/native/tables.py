"""A robot in water as two arrays of numbers for the compiled function, and the list of its variables."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float, Int

import laticauda as lc
from laticauda.connect.native import entry, link_formulas, sensor_formulas
from laticauda.connect.native.body_parameters import build_link_table
from laticauda.connect.native.sensors import warn_of_missing_sensors
from laticauda.connect.native.variable import Causality, Variable
from laticauda.connect.native.variables import list_variables
from laticauda.connect.native.water_slopes import find_water_slopes
from laticauda.models.planar import model, rows
from laticauda.values import BadArgument, check_choice, check_instance

INPUTS = ("gait", "references")
"""Inputs that may drive the robot: a gait, or an angle for every joint."""
REQUIRED_CLASSES = {
    "environment": lc.Water,
    "model": lc.Planar,
    "motion": lc.Gait,
    "start": lc.Start,
}
"""Classes that the fields of an exported scenario must be of."""


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
    def n_numbers(self) -> int:
        """Number of numbers that a run needs, in addition to the variables [-]."""
        return self.n_rows + entry.SCRATCH

    @property
    def description(self) -> str:
        """Description of the robot in one sentence."""
        robot = self.plant.robot
        fin = ""
        if robot.caudal_fin is not None:
            fin = " with a caudal fin"
        return (
            f"The swimming snake robot {robot.name}{fin}: {robot.n_links} links, "
            f"{robot.length:.3g} m, {robot.mass:.3g} kg, {self.plant.joints.words}, "
            f"in water ({self.plant.environment.name}); planar model."
        )


def build_tables_of_scenario(
    robot: lc.Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    inputs: str = "gait",
    **changes: Any,
) -> Tables:
    """Return the arrays of a planar scenario in water; arguments and errors as for `export_fmu`."""
    check_choice("inputs", inputs, INPUTS)
    if isinstance(robot, lc.Scenario):
        scenario = robot
    else:
        scenario = lc.build_scenario(robot, cast(lc.Gait, gait), **changes)
    for name, required_class in REQUIRED_CLASSES.items():
        check_instance(name, getattr(scenario, name), required_class)
    plant = cast(model.PlanarPlant, lc.build_plant(scenario))
    plant.flow.refuse_tables("an FMU or a library in C")
    warn_of_missing_sensors(plant)
    scenario_gait = scenario.gait
    if inputs == "references":
        if plant.joints.prescribed:
            raise BadArgument(
                "inputs",
                "must be 'gait' for prescribed joints, which cannot jump; take others "
                '(joints="servo" in Python, --joints servo of `laticauda export`), '
                "got 'references'",
            )
        # The wave does not move, so its parameters have no meaning.
        scenario_gait = replace(
            scenario_gait, amplitude=0.0, frequency=0.0, phase_shift=0.0, offset=0.0
        )
    scenario_robot = scenario.robot
    return build_tables(
        plant,
        scenario_gait,
        cast(lc.Start, scenario.start),
        inputs=inputs,
        # Names count modules and joints of the robot, not the links and joints of its planar model.
        has_body_parameters=scenario_robot.planar() is scenario_robot,
    )


def build_tables(
    plant: model.PlanarPlant,
    gait: lc.Gait,
    start: lc.Start,
    *,
    inputs: str,
    has_body_parameters: bool = False,
) -> Tables:
    """Return the arrays of a robot in water.

    Args:
        plant: Plant in water.
        gait: Gait that the joints follow unless the inputs say otherwise.
        start: Initial state.
        inputs: Inputs that drive the robot: gait or references.
        has_body_parameters: Whether numbers of modules and joints are parameters; only if all modules are links.

    Raises:
        ValueError: If the plant rejects the gait, or external references.
    """
    references: tuple[float, ...] | None = None
    if inputs == "references":
        references = (0.0,) * len(plant.robot.driven_joints)
    command = lc.Command(gait=gait, references=references)
    template = plant.rows(plant.init(start, command), command)
    variables = list_variables(
        plant, gait, start, inputs=inputs, has_body_parameters=has_body_parameters
    )
    builder = _TablesBuilder(template)
    _add_chain(builder, plant)
    _add_variable_numbers(builder, variables)
    _add_water(builder, plant, variables)
    _add_variable_rows(builder, variables)
    _add_links(builder, plant, variables)
    _add_sensors(builder, plant, variables)
    return Tables(
        variables=variables,
        whole=builder.integers(),
        real=builder.reals(),
        n_rows=template.size,
        plant=plant,
        inputs=inputs,
    )


class PieceItem(NamedTuple):
    """A pair of numbers and its factor; what they mean depends on the piece (`entry`)."""

    first: int
    """Number of a variable or of a term [-]."""
    second: int
    """Number of another variable, or of a row [-]."""
    factor: float
    """Factor, or value of a term in the template."""


class _TablesBuilder:
    """The two arrays while they are being built."""

    def __init__(self, template: np.ndarray) -> None:
        self.header = [0] * entry.HEADER
        self.header[entry.N_ROWS] = template.size
        self._integers: list[int] = []
        self._reals: list[float] = template.tolist()

    def append(self, numbers: Iterable[Any]) -> int:
        """Append integers, and return where they begin."""
        begin = entry.HEADER + len(self._integers)
        self._integers.extend(int(number) for number in numbers)
        return begin

    def append_piece(self, position: int, items: Sequence[PieceItem]) -> None:
        """Append pairs and factors to the arrays, and store in the header where they begin."""
        pairs: list[int] = []
        for item in items:
            pairs.append(item.first)
            pairs.append(item.second)
        begin_of_pairs = self.append(pairs)
        begin_of_factors = len(self._reals)
        piece = [begin_of_pairs, begin_of_factors, len(items)]
        self.header[position : position + entry.PIECE_SIZE] = piece
        self._reals.extend(item.factor for item in items)

    def append_reals(self, numbers: Iterable[float]) -> int:
        """Append reals, and return where they begin."""
        begin = len(self._reals)
        self._reals.extend(numbers)
        return begin

    def integers(self) -> np.ndarray:
        """Return the array of integers, the header first."""
        return np.array([*self.header, *self._integers], dtype=np.int64)

    def reals(self) -> np.ndarray:
        """Return the array of reals, the template first."""
        return np.array(self._reals)


def _add_chain(builder: _TablesBuilder, plant: model.PlanarPlant) -> None:
    """Add the shape of the chain, and where strips, plates and joint laws stand."""
    layout = plant.layout
    builder.header[entry.N_BODIES] = layout.n_bodies
    builder.header[entry.TAIL_LINK] = layout.tail_link
    builder.header[entry.HAS_EXTRAS] = int(layout.has_extras)
    builder.header[entry.IS_IMPLICIT] = int(plant.is_implicit)
    builder.header[entry.FIRST_STRIP] = builder.append(layout.first_strip)
    builder.header[entry.FIRST_PLATE] = builder.append(layout.first_plate)
    # The joint laws are preceded by their number and followed by flags of the free joints.
    is_free = (layout.law >= rows.FIRST_FREE).astype(int)
    laws = [layout.n_bodies, *layout.law, *is_free]
    builder.header[entry.LAW] = builder.append(laws) + 1


def _add_variable_numbers(builder: _TablesBuilder, variables: Sequence[Variable]) -> None:
    """Add the numbers of the variables that the function needs by themselves."""
    numbers = {variable.name: number for number, variable in enumerate(variables)}
    builder.header[entry.DT] = numbers["dt"]
    builder.header[entry.HEADING] = numbers["start.heading"]
    builder.header[entry.VELOCITY] = numbers["start.velocity"]


def _add_water(
    builder: _TablesBuilder, plant: model.PlanarPlant, variables: Sequence[Variable]
) -> None:
    """Add how rows depend on the water's density and coefficients."""
    water = find_water_slopes(plant, variables)
    terms: list[PieceItem] = []
    for term in water.terms:
        item = PieceItem(first=term.coefficient, second=term.density, factor=term.value)
        terms.append(item)
    builder.append_piece(entry.TERMS, terms)
    slopes: list[PieceItem] = []
    for slope in water.slopes:
        item = PieceItem(first=slope.term, second=slope.row, factor=slope.slope)
        slopes.append(item)
    builder.append_piece(entry.SLOPES, slopes)


def _add_variable_rows(builder: _TablesBuilder, variables: Sequence[Variable]) -> None:
    """Add which rows the variables set, and of which rows they are sums."""
    set_at_start = _list_row_shares(variables, "parameter")
    for number, variable in enumerate(variables):
        for share in variable.start_rows:
            item = PieceItem(first=number, second=share.row, factor=share.factor)
            set_at_start.append(item)
    builder.append_piece(entry.START_ROWS, set_at_start)
    builder.append_piece(entry.INPUT_ROWS, _list_row_shares(variables, "input"))
    time = PieceItem(first=0, second=rows.TIME, factor=1.0)
    builder.append_piece(entry.OUTPUT_ROWS, [time, *_list_row_shares(variables, "output")])


def _add_links(
    builder: _TablesBuilder, plant: model.PlanarPlant, variables: Sequence[Variable]
) -> None:
    """Add how rows of links follow from parameters of their modules."""
    table = build_link_table(plant, variables)
    places = table.places.copy()
    first_real = builder.append_reals(table.numbers)
    places[link_formulas.NUMBERS] += first_real
    for record in range(places[link_formulas.N_LINKS]):
        position = link_formulas.RECORDS + record * link_formulas.RECORD_SIZE
        places[position + link_formulas.REALS] += first_real
    builder.header[entry.LINKS] = builder.append(places)


def _add_sensors(
    builder: _TablesBuilder, plant: model.PlanarPlant, variables: Sequence[Variable]
) -> None:
    """Add where the formulas of sensors find what they need."""
    numbers = {variable.name: number for number, variable in enumerate(variables)}
    formulas: list[int] = []
    n_formulas = 0
    for number, variable in enumerate(variables):
        if variable.formula is not None:
            n_formulas += 1
            formulas += [
                number,
                variable.formula.kind,
                builder.append_reals(variable.formula.numbers),
            ]
    layout = [0] * sensor_formulas.FORMULAS
    layout[sensor_formulas.N_FORMULAS] = n_formulas
    if n_formulas:
        layout[sensor_formulas.N_LINKS] = plant.robot.n_links
        layout[sensor_formulas.CENTER_OF_MASS] = numbers["center_of_mass.x"]
        layout[sensor_formulas.HEADING_RATE] = numbers["heading_rate"]
        layout[sensor_formulas.LINK_ANGLE] = numbers["link_angle[0]"]
        layout[sensor_formulas.JOINT_RATE] = numbers["joint_rate[0]"]
    builder.header[entry.SENSORS] = builder.append([*layout, *formulas])


def _list_row_shares(variables: Sequence[Variable], causality: Causality) -> list[PieceItem]:
    """Return variable, row and factor for all variables of a causality."""
    items: list[PieceItem] = []
    for number, variable in enumerate(variables):
        if variable.causality != causality:
            continue
        for share in variable.rows:
            item = PieceItem(first=number, second=share.row, factor=share.factor)
            items.append(item)
    return items
