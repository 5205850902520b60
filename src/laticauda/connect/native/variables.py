"""Variables of an FMU: what another tool may set and read, and the kernel rows to which each variable corresponds."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, cast

import laticauda as lc
from laticauda import robot
from laticauda.models.planar import rows
from laticauda.models.planar.model import LEAST_DT, PlanarPlant
from laticauda.values import formulas
from laticauda.values.files import read_toml
from laticauda.values.quantities import quantities_of

Shares = tuple[tuple[int, float], ...]
Ends = tuple[float, float]
FAR = 1e5  # m and rad, as for `Start`
TINY = 1e-9  # least value of what must be positive
LIKE: Mapping[str, Sequence[Sequence[Any]]] = read_toml(Path(__file__).with_suffix(".toml"))
"""Variables that are declared in the same way."""


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One number that is exchanged with another tool."""

    name: str
    """Name that other tools show; joints and links are numbered from 0 at the tail [-]."""
    causality: str
    """independent (time), parameter (set before the start), input (set at any time) or output [-]."""
    unit: str
    """Unit, as in `laticauda.connect.fmu.exporting.UNITS`; 1: dimensionless [-]."""
    description: str
    """Description [-]."""
    symbol: str = ""
    """Symbol in the formulas of the docs [-]."""
    start: float = 0.0
    """Value if it is not set [unit]."""
    least: float = -math.inf
    """Smallest accepted value [unit]."""
    most: float = math.inf
    """Largest accepted value [unit]."""
    rows: Shares = ()
    """Rows and factors: an output is their weighted sum; for others, each row is set to its factor times the value."""
    start_rows: Shares = ()
    """Rows and factors of an input that apply only at the start."""
    coefficient: str = ""
    """Name of the field of `Water` that a parameter represents, if no single row holds it [-]."""


def variables_of(
    plant: PlanarPlant, gait: lc.Gait, start: lc.Start, *, inputs: str
) -> tuple[Variable, ...]:
    """Return all variables, in the order of their value references.

    Args:
        plant: Plant in water.
        gait: Gait that the joints follow unless the inputs say otherwise.
        start: Initial state.
        inputs: Inputs that drive the robot: gait or references.
    """
    water = plant.environment
    assert isinstance(water, lc.Water)
    if inputs == "gait":
        fin = _wave("fin", gait.fin) if 0 in plant.robot.fin_joints else ()
        driven = (*_generator(plant, gait), *_wave("gait", gait), *fin)
    else:
        driven = _references(plant)
    clock = "Largest step of the integration; each communication step is divided into equal ones."
    return (
        Variable(name="time", causality="independent", unit="s", description="Time.", symbol="t"),
        _parameter("dt", "s", "", plant.dt, (LEAST_DT, 1e3), clock),
        *_start(plant, start),
        *_water(plant, water),
        *_plate(plant),
        *driven,
        *_current(plant, water),
        *_motion(),
        *_links(plant),
        *_joints(plant),
        *_fin_joints(plant),
        *_power(plant),
    )


def _set(
    causality: str,
    name: str,
    unit: str,
    symbol: str,
    start: float,
    ends: Ends,
    text: str,
    *row: int,
    **more: Any,
) -> Variable:
    """Create a variable that is set from outside, with the row, if any, that holds its value."""
    more = {"rows": tuple((one, 1.0) for one in row), "least": ends[0], "most": ends[1], **more}
    return Variable(
        name=name,
        causality=causality,
        unit=unit,
        symbol=symbol,
        start=start,
        description=text,
        **more,
    )


_parameter, _input = partial(_set, "parameter"), partial(_set, "input")


def _output(name: str, unit: str, symbol: str, text: str, *shares: tuple[int, float]) -> Variable:
    return Variable(
        name=name, causality="output", unit=unit, symbol=symbol, description=text, rows=shares
    )


def _outputs(
    name: str, unit: str, symbol: str, text: str, row: int, records: Sequence[tuple[int, int]]
) -> Iterator[Variable]:
    """Yield outputs for the same row of several records, each with its number."""
    for i, b in records:
        yield _output(f"{name}[{i}]", unit, symbol, text.format(i), (b + row, 1.0))


def _start(plant: PlanarPlant, start: lc.Start) -> Iterator[Variable]:
    text, (x, y), anywhere = (
        "Position of the center of mass at the start.",
        start.center_of_mass,
        (-FAR, FAR),
    )
    yield _parameter("start.x", "m", "p_x", x, anywhere, text, rows.X)
    yield _parameter("start.y", "m", "p_y", y, anywhere, text, rows.Y)
    text = "Mean angle of the links at the start, counter-clockwise from the x axis."
    yield _parameter("start.heading", "rad", "theta", start.heading, anywhere, text, rows.HEADING)
    text = "Speed at the start, along the heading."
    yield _parameter("start.velocity", "m/s", "", start.velocity, (-100.0, 100.0), text)
    for i, b in enumerate(() if plant.joints.prescribed else _records(plant)):
        name, text = f"start.joint_angle[{i}]", f"Angle of joint {i} at the start."
        yield _parameter(name, "rad", "phi", 0.0, (-math.pi, math.pi), text, b + rows.ANGLE)


def _water(plant: PlanarPlant, water: lc.Water) -> Iterator[Variable]:
    for name, unit, symbol, least, text in LIKE["water"]:
        value: float = getattr(water, name)
        yield _parameter(
            f"water.{name}", unit, symbol, value, (least, math.inf), text, coefficient=name
        )
    yield from _law("water.drag", water.drag, rows.LAW)
    if plant.joints.own is not None:
        yield from _law("joints", plant.joints, rows.JOINT_LAW)


def _plate(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the flexural rigidity of an elastic fin, to which the stiffness of each of its hinges is proportional."""
    fin = plant.robot.caudal_fin
    if fin is None or fin.flexural_rigidity is None or not fin.hinges:
        return
    now, text = fin.flexural_rigidity, "Flexural rigidity of the fin that bends."
    first = [
        _record(plant.layout.tail_link - k) + rows.STIFFNESS
        for k in plant.robot.fin_joints
        if k > 0
    ]
    shares = tuple(
        (row, hinge.stiffness / now) for row, hinge in zip(first, fin.hinges, strict=True)
    )
    yield _parameter(
        "fin.flexural_rigidity", "N.m2", "E I", now, (TINY, math.inf), text, rows=shares
    )


def _law(prefix: str, law: formulas.Law, first: int) -> Iterator[Variable]:
    """Yield the parameters of a law."""
    for name, one in quantities_of(cast(type, type(law))).items():
        text, unit = (
            one.text[0].upper() + one.text[1:] + ".",
            one.unit.replace(" ", ".").replace("^", "") or "1",
        )
        ends, row = (max(one.least, -FAR), min(one.le, FAR)), first + law.formula.fields.index(name)
        yield _parameter(f"{prefix}.{name}", unit, "", getattr(law, name), ends, text, row)


def _generator(plant: PlanarPlant, gait: lc.Gait) -> Iterator[Variable]:
    text, now = (
        "Bandwidth of the filters behind the gait's parameters.",
        plant.settings.offset_bandwidth,
    )
    yield _parameter("offset_bandwidth", "rad/s", "", now, (TINY, 1e6), text, rows.BANDWIDTH)
    yield _parameter(
        "ramp", "s", "T", plant.ramp, (0.0, 1e6), "Duration of the smooth start.", rows.RAMP
    )
    template = plant.layout.template
    for i, (b, g) in enumerate(
        zip(_records(plant), gait.joint_envelope(plant.robot.n_links), strict=True)
    ):
        name, text = f"gait.envelope[{i}]", f"Share of the amplitude that joint {i} has."
        share = ((b + rows.ENVELOPE, float(template[b + rows.ENVELOPE])),)
        yield _parameter(name, "1", "g", g, (-math.inf, math.inf), text, rows=share)


def _wave(prefix: str, wave: lc.Gait | lc.Wave | None) -> Iterator[Variable]:
    """Yield the parameters of a wave; those that are filtered take effect at once at the start."""
    for name, unit, symbol, least, row, now, text in LIKE[prefix]:
        first = ((getattr(rows, now), 1.0),) if now else ()
        value = 0.0 if wave is None else getattr(wave, name)
        yield _input(
            f"{prefix}.{name}",
            unit,
            symbol,
            value,
            (least, FAR),
            text,
            getattr(rows, row),
            start_rows=first,
        )


def _references(plant: PlanarPlant) -> Iterator[Variable]:
    driven = [(f"references[{i}]", f"joint {i}", b) for i, b in enumerate(_records(plant))]
    if 0 in plant.robot.fin_joints:
        driven.append(("fin.reference", "the fin", _record(plant.layout.tail_link)))
    for name, of, b in driven:
        # The generator stands still at the crest of a wave of amplitude 1 (`PlanarPlant.rows`).
        text = f"Reference angle of {of}, held during a communication step."
        yield _input(name, "rad", "phi_ref", 0.0, (-FAR, FAR), text, b + rows.ENVELOPE)


def _current(plant: PlanarPlant, water: lc.Water) -> Iterator[Variable]:
    """Yield the velocity of a uniform current, or the parameters of a single-part flow; other flows are built in."""
    flow, kinds = water.flow, plant.flow
    if flow is not None:
        if (kinds.parts, kinds.counts) == (((type(flow), None, None),), (1,)):
            yield from _law("current", flow, plant.layout.template.size - len(flow.numbers))
        return
    for name, row, value in zip(
        "xy", (rows.CURRENT_X, rows.CURRENT_Y), water.uniform[:2], strict=True
    ):
        text = "Velocity of the water, world axes."
        yield _input(f"current.{name}", "m/s", f"V_{name}", value, (-100.0, 100.0), text, row)


def _motion() -> Iterator[Variable]:
    for *shown, row in LIKE["motion"]:
        yield _output(*shown, (getattr(rows, row), 1.0))


def _links(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield theta_i: the heading, minus the joints' mean rotation, plus that of the joints between tail and link i."""
    records, n = _records(plant), plant.robot.n_links
    for i in range(n):
        shares = ((b + rows.ANGLE, float(j < i) - (n - 1 - j) / n) for j, b in enumerate(records))
        yield _output(
            f"link_angle[{i}]",
            "rad",
            "theta_i",
            f"Angle of link {i}.",
            (rows.HEADING, 1.0),
            *shares,
        )


def _joints(plant: PlanarPlant) -> Iterator[Variable]:
    records = [*enumerate(_records(plant))]
    yield from _outputs("joint_angle", "rad", "phi_i", "Angle of joint {}.", rows.ANGLE, records)
    yield from _outputs("joint_rate", "rad/s", "phi'_i", "Rate of joint {}.", rows.RATE, records)
    for i, b in records:
        # Reference of the gait; the kernel's own reference is the share of it that prescribed
        # joints follow.
        share = plant.robot.joints[i].actuator.tracking if plant.joints.prescribed else 1.0
        rest = () if share == 1.0 else ((rows.OFFSET_NOW, 1.0 - 1.0 / share),)
        text = f"Reference angle of joint {i}."
        yield _output(
            f"joint_angle_ref[{i}]",
            "rad",
            "phi_i,ref",
            text,
            (b + rows.REFERENCE, 1.0 / share),
            *rest,
        )
    yield from _outputs(
        "joint_torque", "N.m", "u_i", "Torque of the drive of joint {}.", rows.TORQUE, records
    )


def _fin_joints(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the variables of the fin's joints, numbered as in `Robot.fin_joints`."""
    records = [(k, _record(plant.layout.tail_link - k)) for k in plant.robot.fin_joints]
    yield from _outputs(
        "fin_angle", "rad", "phi_j", "Angle of a joint of the fin.", rows.ANGLE, records
    )
    yield from _outputs("fin_rate", "rad/s", "phi'_j", "Its rate.", rows.RATE, records)
    for _, b in records[:1] if 0 in plant.robot.fin_joints else ():
        yield _output("fin_torque", "N.m", "", "Torque of the fin's drive.", (b + rows.TORQUE, 1.0))


def _power(plant: PlanarPlant) -> Iterator[Variable]:
    kinds = LIKE["power"][: 3 + robot.has_power_model(plant.robot, plant.joints)]
    for name, text, power, _ in kinds:
        yield _output(
            f"{name}_power", "W", "P", f"{text}, at this moment.", (getattr(rows, power), 1.0)
        )
    for name, text, _, work in kinds:
        yield _output(
            f"{name}_work", "J", "", f"{text}, since the start.", (getattr(rows, work), 1.0)
        )


def _records(plant: PlanarPlant) -> Sequence[int]:
    """Return the first rows of the records of the body's joints, tail first."""
    return [_record(i) for i in range(plant.layout.tail_link + 1, plant.layout.n_bodies)]


def _record(i: int) -> int:
    """Return the first row of the record of a body, whose joint is the one at its tail end."""
    return rows.HEADER_ROWS + i * rows.BODY_ROWS
