"""Variables that another tool may set: parameters before the start, inputs at any time."""

import math
from collections.abc import Iterator
from typing import NamedTuple, cast

import laticauda as lc
from laticauda.connect.native.joint_rows import (
    first_row_of_body,
    list_body_joints,
    list_fin_joints,
)
from laticauda.connect.native.variable import (
    LARGEST_POSITION,
    SMALLEST_POSITIVE,
    RowShare,
    Variable,
    one_row,
    unit_of,
)
from laticauda.models.planar import LEAST_DT, PlanarPlant, rows
from laticauda.values import formulas, quantities_of
from laticauda.water.fluid import Flow

LARGEST_STEP = 1e3
"""Largest step of the integration that may be set [s]."""
LARGEST_SPEED = 100.0
"""Largest speed of the robot at the start, and of the water, that may be set [m/s]."""
LARGEST_BANDWIDTH = 1e6
"""Largest bandwidth of the filters that may be set [rad/s]."""
LONGEST_RAMP = 1e6
"""Longest smooth start that may be set [s]."""
REFERENCE_SYMBOL = "phi_ref"
"""Symbol of reference angles."""


class WaterNumber(NamedTuple):
    """A field of `Water` that may be set."""

    field: str
    """Name of the field [-]."""
    unit: str
    """Unit [-]."""
    symbol: str
    """Symbol in the formulas of the docs [-]."""
    least: float
    """Smallest accepted value [unit]."""
    description: str
    """Description [-]."""


WATER_NUMBERS = (
    WaterNumber(
        field="density",
        unit="kg/m3",
        symbol="rho",
        least=SMALLEST_POSITIVE,
        description="Density of the water.",
    ),
    WaterNumber(
        field="tangential_friction",
        unit="1",
        symbol="C_f",
        least=0.0,
        description="Drag along the body.",
    ),
    WaterNumber(
        field="normal_drag",
        unit="1",
        symbol="C_D",
        least=0.0,
        description="Drag across the body.",
    ),
    WaterNumber(
        field="added_mass",
        unit="1",
        symbol="C_A",
        least=0.0,
        description="Added mass across the body.",
    ),
    WaterNumber(
        field="added_inertia",
        unit="1",
        symbol="C_M",
        least=0.0,
        description="Added moment of inertia.",
    ),
    WaterNumber(
        field="tangential_added_mass",
        unit="1",
        symbol="C_T",
        least=0.0,
        description="Added mass along the body.",
    ),
)


class WaveNumber(NamedTuple):
    """A field of a gait, or of the wave of its fin, that may be set."""

    field: str
    """Name of the field [-]."""
    unit: str
    """Unit [-]."""
    symbol: str
    """Symbol in the formulas of the docs [-]."""
    least: float
    """Smallest accepted value [unit]."""
    row: int
    """Row of the kernels that holds the value [-]."""
    filtered_row: int | None
    """Row of the filter that follows the value, and starts from it; None: no filter [-]."""
    description: str
    """Description [-]."""


GAIT_NUMBERS = (
    WaveNumber(
        field="amplitude",
        unit="rad",
        symbol="alpha",
        least=0.0,
        row=rows.AMPLITUDE,
        filtered_row=rows.AMPLITUDE_NOW,
        description="Amplitude of the joints.",
    ),
    WaveNumber(
        field="frequency",
        unit="rad/s",
        symbol="omega",
        least=0.0,
        row=rows.FREQUENCY,
        filtered_row=rows.FREQUENCY_NOW,
        description="Angular frequency.",
    ),
    WaveNumber(
        field="phase_shift",
        unit="rad",
        symbol="delta",
        least=-LARGEST_POSITION,
        row=rows.PHASE_SHIFT,
        filtered_row=rows.PHASE_SHIFT_NOW,
        description="Between neighboring joints.",
    ),
    WaveNumber(
        field="offset",
        unit="rad",
        symbol="phi_0",
        least=-LARGEST_POSITION,
        row=rows.OFFSET,
        filtered_row=None,
        description="Of every joint; positive turns left.",
    ),
)

FIN_WAVE_NUMBERS = (
    WaveNumber(
        field="amplitude",
        unit="rad",
        symbol="",
        least=0.0,
        row=rows.FIN_AMPLITUDE,
        filtered_row=rows.FIN_AMPLITUDE_NOW,
        description="Amplitude of the driven fin.",
    ),
    WaveNumber(
        field="frequency",
        unit="rad/s",
        symbol="",
        least=0.0,
        row=rows.FIN_FREQUENCY,
        filtered_row=rows.FIN_FREQUENCY_NOW,
        description="Angular frequency of the fin.",
    ),
    WaveNumber(
        field="offset",
        unit="rad",
        symbol="",
        least=-LARGEST_POSITION,
        row=rows.FIN_OFFSET,
        filtered_row=None,
        description="Offset of the fin.",
    ),
    WaveNumber(
        field="phase",
        unit="rad",
        symbol="",
        least=-LARGEST_POSITION,
        row=rows.FIN_LEAD,
        filtered_row=None,
        description="Lead of the fin over the tail-most joint.",
    ),
)


def list_step_parameters(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the step of the integration.

    Args:
        plant: Plant in water.
    """
    yield Variable(
        name="dt",
        causality="parameter",
        unit="s",
        description="Largest step of the integration; each communication step is divided into equal ones.",
        start=plant.dt,
        least=LEAST_DT,
        most=LARGEST_STEP,
    )


def list_start_parameters(plant: PlanarPlant, start: lc.Start) -> Iterator[Variable]:
    """Yield position, heading, speed and joint angles at the start; prescribed joints follow the gait from the start.

    Args:
        plant: Plant in water.
        start: Initial state.
    """
    x, y = start.center_of_mass
    yield _start_position(name="start.x", symbol="p_x", value=x, row=rows.X)
    yield _start_position(name="start.y", symbol="p_y", value=y, row=rows.Y)
    yield Variable(
        name="start.heading",
        causality="parameter",
        unit="rad",
        symbol="theta",
        description="Mean angle of the links at the start, counter-clockwise from the x axis.",
        start=start.heading,
        least=-LARGEST_POSITION,
        most=LARGEST_POSITION,
        rows=one_row(rows.HEADING),
    )
    yield Variable(
        name="start.velocity",
        causality="parameter",
        unit="m/s",
        description="Speed at the start, along the heading.",
        start=start.velocity,
        least=-LARGEST_SPEED,
        most=LARGEST_SPEED,
    )
    if plant.joints.prescribed:
        return
    for joint in list_body_joints(plant):
        yield Variable(
            name=f"start.joint_angle[{joint.number}]",
            causality="parameter",
            unit="rad",
            symbol="phi",
            description=f"Angle of joint {joint.number} at the start.",
            least=-math.pi,
            most=math.pi,
            rows=one_row(joint.first_row + rows.ANGLE),
        )


def _start_position(*, name: str, symbol: str, value: float, row: int) -> Variable:
    return Variable(
        name=name,
        causality="parameter",
        unit="m",
        symbol=symbol,
        description="Position of the center of mass at the start.",
        start=value,
        least=-LARGEST_POSITION,
        most=LARGEST_POSITION,
        rows=one_row(row),
    )


def list_water_parameters(plant: PlanarPlant, water: lc.Water) -> Iterator[Variable]:
    """Yield the water's density and coefficients, and the numbers of the laws of drag and joints.

    Args:
        plant: Plant in water.
        water: The water.
    """
    for number in WATER_NUMBERS:
        yield Variable(
            name=f"water.{number.field}",
            causality="parameter",
            unit=number.unit,
            symbol=number.symbol,
            description=number.description,
            start=getattr(water, number.field),
            least=number.least,
            coefficient=number.field,
        )
    yield from _list_law_parameters("water.drag", water.drag, first_row=rows.LAW)
    if plant.joints.own is not None:
        yield from _list_law_parameters("joints", plant.joints, first_row=rows.JOINT_LAW)


def _list_law_parameters(prefix: str, law: formulas.Law, *, first_row: int) -> Iterator[Variable]:
    """Yield the numbers of a law, which stand in consecutive rows in the order of its formula."""
    fields = law.formula.fields
    for name, quantity in quantities_of(cast(type, type(law))).items():
        yield Variable(
            name=f"{prefix}.{name}",
            causality="parameter",
            unit=unit_of(quantity),
            description=quantity.text[0].upper() + quantity.text[1:] + ".",
            start=getattr(law, name),
            least=max(quantity.least, -LARGEST_POSITION),
            most=min(quantity.le, LARGEST_POSITION),
            rows=one_row(first_row + fields.index(name)),
        )


def list_fin_parameters(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the flexural rigidity of an elastic fin, to which the stiffness of each of its hinges is proportional.

    Args:
        plant: Plant in water.
    """
    fin = plant.robot.caudal_fin
    if fin is None or fin.flexural_rigidity is None or not fin.hinges:
        return
    hinge_joints = [joint for joint in list_fin_joints(plant) if joint.number > 0]
    shares: list[RowShare] = []
    for joint, hinge in zip(hinge_joints, fin.hinges, strict=True):
        share = RowShare(
            row=joint.first_row + rows.STIFFNESS, factor=hinge.stiffness / fin.flexural_rigidity
        )
        shares.append(share)
    yield Variable(
        name="fin.flexural_rigidity",
        causality="parameter",
        unit="N.m2",
        symbol="E I",
        description="Flexural rigidity of the fin that bends.",
        start=fin.flexural_rigidity,
        least=SMALLEST_POSITIVE,
        rows=tuple(shares),
    )


def list_gait_variables(plant: PlanarPlant, gait: lc.Gait) -> Iterator[Variable]:
    """Yield the parameters of the gait generator, and the numbers of the gait and of a driven fin's wave.

    Args:
        plant: Plant in water.
        gait: Gait that the joints follow unless the inputs say otherwise.
    """
    yield Variable(
        name="offset_bandwidth",
        causality="parameter",
        unit="rad/s",
        description="Bandwidth of the filters behind the gait's parameters.",
        start=plant.settings.offset_bandwidth,
        least=SMALLEST_POSITIVE,
        most=LARGEST_BANDWIDTH,
        rows=one_row(rows.BANDWIDTH),
    )
    yield Variable(
        name="ramp",
        causality="parameter",
        unit="s",
        symbol="T",
        description="Duration of the smooth start.",
        start=plant.ramp,
        least=0.0,
        most=LONGEST_RAMP,
        rows=one_row(rows.RAMP),
    )
    yield from _list_envelope(plant, gait)
    yield from _list_phases(plant, gait)
    yield from _list_wave_inputs("gait", gait, GAIT_NUMBERS)
    if 0 in plant.robot.fin_joints:
        yield from _list_wave_inputs("fin", gait.fin, FIN_WAVE_NUMBERS)


def _list_envelope(plant: PlanarPlant, gait: lc.Gait) -> Iterator[Variable]:
    template = plant.layout.template
    envelope = gait.joint_envelope(plant.robot.n_links)
    for joint, value in zip(list_body_joints(plant), envelope, strict=True):
        row = joint.first_row + rows.ENVELOPE
        yield Variable(
            name=f"gait.envelope[{joint.number}]",
            causality="parameter",
            unit="1",
            symbol="g",
            description=f"Share of the amplitude that joint {joint.number} has.",
            start=value,
            rows=(RowShare(row=row, factor=float(template[row])),),
        )


def _list_phases(plant: PlanarPlant, gait: lc.Gait) -> Iterator[Variable]:
    """Yield the lead of every joint over the wave, if the gait has any."""
    if gait.phases is None:
        return
    leads = gait.joint_phases(plant.robot.n_links)
    for joint, lead in zip(list_body_joints(plant), leads, strict=True):
        yield Variable(
            name=f"gait.phase[{joint.number}]",
            causality="parameter",
            unit="rad",
            description=f"Lead of joint {joint.number} over the wave.",
            start=lead,
            rows=one_row(joint.first_row + rows.LEAD),
        )


def _list_wave_inputs(
    prefix: str, wave: lc.Gait | lc.Wave | None, numbers: tuple[WaveNumber, ...]
) -> Iterator[Variable]:
    """Yield the numbers of a wave; those that are filtered take effect at once at the start."""
    for number in numbers:
        start_rows: tuple[RowShare, ...] = ()
        if number.filtered_row is not None:
            start_rows = one_row(number.filtered_row)
        value = 0.0
        if wave is not None:
            value = getattr(wave, number.field)
        yield Variable(
            name=f"{prefix}.{number.field}",
            causality="input",
            unit=number.unit,
            symbol=number.symbol,
            description=number.description,
            start=value,
            least=number.least,
            most=LARGEST_POSITION,
            rows=one_row(number.row),
            start_rows=start_rows,
        )


def list_reference_inputs(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield a reference angle for every joint, and for a driven fin.

    Args:
        plant: Plant in water.
    """
    for joint in list_body_joints(plant):
        yield _reference_input(
            name=f"references[{joint.number}]",
            driven=f"joint {joint.number}",
            first_row=joint.first_row,
        )
    if 0 in plant.robot.fin_joints:
        yield _reference_input(
            name="fin.reference",
            driven="the fin",
            first_row=first_row_of_body(plant.layout.tail_link),
        )


def _reference_input(*, name: str, driven: str, first_row: int) -> Variable:
    return Variable(
        name=name,
        causality="input",
        unit="rad",
        symbol=REFERENCE_SYMBOL,
        description=f"Reference angle of {driven}, held during a communication step.",
        least=-LARGEST_POSITION,
        most=LARGEST_POSITION,
        # The generator stands still at the crest of a wave of amplitude 1 (`PlanarPlant.rows`).
        rows=one_row(first_row + rows.ENVELOPE),
    )


def list_current_variables(plant: PlanarPlant, water: lc.Water) -> Iterator[Variable]:
    """Yield the velocity of a uniform current, or the parameters of a single-part flow; other flows are built in.

    Args:
        plant: Plant in water.
        water: The water.
    """
    if water.flow is None:
        velocity_x, velocity_y, *_ = water.uniform
        yield _current_input("x", velocity=velocity_x, row=rows.CURRENT_X)
        yield _current_input("y", velocity=velocity_y, row=rows.CURRENT_Y)
        return
    if _is_single_part(plant, water.flow):
        first_row = plant.layout.template.size - len(water.flow.numbers)
        yield from _list_law_parameters("current", water.flow, first_row=first_row)


def _is_single_part(plant: PlanarPlant, flow: Flow) -> bool:
    """Return whether the kernels know the flow as one part of one kind, without tables."""
    single_kind = (type(flow), None, None)
    return plant.flow.parts == (single_kind,) and plant.flow.counts == (1,)


def _current_input(axis: str, *, velocity: float, row: int) -> Variable:
    return Variable(
        name=f"current.{axis}",
        causality="input",
        unit="m/s",
        symbol=f"V_{axis}",
        description="Velocity of the water, world axes.",
        start=velocity,
        least=-LARGEST_SPEED,
        most=LARGEST_SPEED,
        rows=one_row(row),
    )
