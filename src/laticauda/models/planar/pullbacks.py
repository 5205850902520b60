"""Pullbacks of the formulas of a run with prescribed joints, of which `adjoint` is made.

They are written by tracing the kernels' own functions, in plain Python: the templates are loaded once
more, for the target `TRACING`. A formula that changes has another pullback; nothing is to be changed
here. Only a formula that is called anew, or elsewhere, must be told to `adjoint`.
"""

# pyright: reportUnknownLambdaType=false, reportUnknownArgumentType=false

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from laticauda.compiling.formulas import digest_of
from laticauda.compiling.pullbacks import TRACING, Place, where, write_pullback
from laticauda.compiling.templates import specialized
from laticauda.models.planar import rows
from laticauda.models.planar.model import TEMPLATES
from laticauda.motion.gaits import reference
from laticauda.values import Formula

PACKAGE = "laticauda.models.planar"
"""Package of the templates."""
MOTION_OF_BODY = (rows.LINK_RATE, rows.V_T, rows.V_N)
"""Rows of a body's motion, by which it moves an element."""
EXTRA_LOADS = (rows.EXTRA_T, rows.EXTRA_N, rows.EXTRA_MOMENT)
"""Rows of a body's extra loads."""

Pullbacks = dict[str, str]
"""Source texts by name."""

_written: dict[str, tuple[tuple[str, str], ...]] = {}
"""Pullbacks by the digest of the drag law."""


def write_pullbacks(drag_law: Formula) -> tuple[tuple[str, str], ...]:
    """Return name and source text of every pullback.

    Args:
        drag_law: Formula of the drag law.

    Raises:
        NotTraceable: If the drag law does more than arithmetic with its numbers.
    """
    digest = digest_of(drag_law)
    if digest not in _written:
        formulas = _Formulas(drag_law)
        pullbacks = {
            **_write_of_body(formulas),
            **_write_of_extras(formulas),
            **_write_of_powers(formulas),
            **_write_of_references(formulas),
            **_write_of_waves(formulas),
        }
        _written[digest] = tuple(pullbacks.items())
    return _written[digest]


class _Formulas:
    """The templates as plain Python, for one drag law in water without a flow."""

    def __init__(self, drag_law: Formula) -> None:
        of_loads = {name: TEMPLATES[name] for name in ("loads", "recursion")}
        of_drives = {"drives": TEMPLATES["drives"]}
        names_of_loads = {"n_lanes": 1, "drag_law": drag_law, "flow_parts": ()}
        names_of_drives = {"n_lanes": 1, "joint_law": None}
        # Going backward gives the slopes by the current, too, so no term of it may be left out.
        replacements: dict[str, Any] = {**TRACING.replacements, "is_known_still": lambda S: False}
        of_any_current = replace(TRACING, replacements=replacements, functions={})
        self.recursion: Any = specialized(PACKAGE, of_loads, names_of_loads, of_any_current)
        self.loads: Any = self.recursion.loads
        self.drives: Any = specialized(PACKAGE, of_drives, names_of_drives, TRACING)
        self.shared: Any = self.drives.shared


def _write_of_body(formulas: _Formulas) -> Pullbacks:
    """Return the pullback of the wrench on a body alone, I a + p."""

    def wrench(S: Any, b: Any, spin: Any, qx: Any, qy: Any) -> Sequence[Any]:
        S[rows.IS_STILL] = 0.0  # in still water, too, loads depend on the current
        a00, a01, a02, a11, a12, a22, p0, p1, p2 = formulas.recursion.of_body(S, b)
        return (
            a00 * spin + a01 * qx + a02 * qy + p0,
            a01 * spin + a11 * qx + a12 * qy + p1,
            a02 * spin + a12 * qx + a22 * qy + p2,
        )

    returned = (rows.COS, rows.SIN, *MOTION_OF_BODY, *EXTRA_LOADS)
    text = write_pullback(
        "wrench",
        wrench,
        records=("b",),
        arguments=("spin", "qx", "qy"),
        returned=_rows_of_body(returned),
        constant=(rows.OWN_VELOCITY, rows.KIRCHHOFF),
        with_values=True,
    )
    return {"wrench": text}


def _rows_of_body(rows_of_record: Sequence[int]) -> list[Any]:
    return [Place("b") + row for row in rows_of_record]


def _write_of_extras(formulas: _Formulas) -> Pullbacks:
    """Return the pullbacks of the extra loads, from a body's motion to a force and a moment."""
    loads = formulas.loads

    def plate(S: Any, b: Any, e: Any) -> Sequence[Any]:
        return _extra_loads(S, b, loads.add_plate_load, b, e)

    def tether(S: Any, b: Any) -> Sequence[Any]:
        force_and_moment = _extra_loads(S, b, loads.add_tether_force, b)
        return force_and_moment[:2]

    def slender_edge(S: Any) -> Sequence[Any]:
        return _extra_loads(S, rows.HEADER_ROWS, loads.add_trailing_edge_load)

    def finite_span(S: Any) -> Sequence[Any]:
        load = _extra_loads(S, rows.HEADER_ROWS, loads.add_finite_span_load)
        return *load, S[rows.EDGE_MEMORY_RATE]

    motion = _rows_of_body(MOTION_OF_BODY)
    turned_motion = _rows_of_body((rows.COS, rows.SIN, rows.V_T, rows.V_N))
    motion_of_last = [rows.HEADER_ROWS + row for row in MOTION_OF_BODY]
    element = ("b", "e")
    return {
        "strip": write_pullback("strip", loads.element_drag, records=element, returned=motion),
        "plate": write_pullback("plate", plate, records=element, returned=motion),
        "tether": write_pullback("tether", tether, records=("b",), returned=turned_motion),
        "slender_edge": write_pullback("slender_edge", slender_edge, returned=motion_of_last),
        "finite_span": write_pullback("finite_span", finite_span, returned=motion_of_last),
    }


def _extra_loads(S: Any, b: Any, add: Any, *arguments: Any) -> tuple[Any, ...]:
    """Return what a function adds to the extra loads of body b."""
    for row in EXTRA_LOADS:
        S[b + row] = 0.0
    add(S, *arguments)
    return tuple(S[b + row] for row in EXTRA_LOADS)


def _write_of_powers(formulas: _Formulas) -> Pullbacks:
    """Return the pullbacks of the powers of a joint, from its torque without that of its skin."""
    shared, drives = formulas.shared, formulas.drives

    def powers(S: Any, b: Any, total: Any) -> Sequence[Any]:
        return shared.joint_powers(total + drives.skin(S, b), S[b + rows.RATE])

    def electrical_power(S: Any, b: Any, total: Any) -> Sequence[Any]:
        stall_torque, no_load_speed, *further = drives.motor_of(S, b)
        # In lanes without a motor these are 0, and the power must be, too.
        has_motor = S[b + rows.STALL_POWER] > 0.0
        stall_torque = where(has_motor, stall_torque, 1.0)
        no_load_speed = where(has_motor, no_load_speed, 1.0)
        torque = total + drives.skin(S, b)
        power = shared.motor_power(torque, S[b + rows.RATE], stall_torque, no_load_speed, *further)
        return (power,)

    arguments = ("total",)
    return {
        "power": write_pullback("power", powers, records=("b",), arguments=arguments),
        "electrical_power": write_pullback(
            "electrical_power", electrical_power, records=("b",), arguments=arguments
        ),
    }


def _write_of_references(formulas: _Formulas) -> Pullbacks:
    """Return the pullbacks of a joint's reference, to the motion of its wave or to the knots of a recording."""
    shared = formulas.shared

    def of_wave(S: Any, sine: Any, cosine: Any, envelope: Any, *numbers: Any) -> Sequence[Any]:
        *motion, k = numbers
        return shared.wave_reference(sine, cosine, envelope, k, reference.WaveMotion(*motion))

    def of_knots(S: Any, *numbers: Any) -> Sequence[Any]:
        return shared.between_knots(*numbers)

    numbers_of_knots = ("start", "end", "angle", "rate", "next_angle", "next_rate")
    return {
        "reference": write_pullback(
            "reference",
            of_wave,
            arguments=("sine", "cosine", "envelope", *reference.WaveMotion._fields, "k"),
            constant=("k",),
        ),
        "knots": write_pullback(
            "knots", of_knots, arguments=("time", *numbers_of_knots), constant=("time",)
        ),
    }


def _write_of_waves(formulas: _Formulas) -> Pullbacks:
    """Return the pullbacks of the waves of body and fin: of their motion, and of a step of the generator."""
    shared, drives = formulas.shared, formulas.drives

    def motion(S: Any, wave: Any, target: Any) -> Sequence[Any]:
        ramp = shared.smooth_start(S[rows.TIME], S[rows.RAMP])
        return shared.wave_motion(wave, target, S[rows.BANDWIDTH], ramp)

    def wave_after(S: Any, wave: Any, target: Any, dt: Any) -> Any:
        return shared.advance_wave(wave, target, S[rows.BANDWIDTH], S[rows.DECAY], dt)

    def body_motion(S: Any) -> Sequence[Any]:
        return motion(S, drives.body_wave(S), drives.body_target(S))

    def fin_motion(S: Any) -> Sequence[Any]:
        return motion(S, drives.fin_wave(S), drives.fin_target(S))

    def body_wave(S: Any, dt: Any) -> Sequence[Any]:
        return wave_after(S, drives.body_wave(S), drives.body_target(S), dt)

    def fin_wave(S: Any, dt: Any) -> Sequence[Any]:
        wave = wave_after(S, drives.fin_wave(S), drives.fin_target(S), dt)
        return [getattr(wave, name) for name in rows.FIN_WAVE]

    rows_of_body_wave = range(rows.PHASE, rows.OFFSET_RATE + 1)
    rows_of_fin_wave = range(rows.FIN_PHASE, rows.FIN_OFFSET_RATE + 1)
    step: dict[str, Any] = {"arguments": ("dt",), "constant": ("dt",)}
    return {
        "body_motion": write_pullback("body_motion", body_motion, constant=(rows.TIME,)),
        "fin_motion": write_pullback("fin_motion", fin_motion, constant=(rows.TIME,)),
        "body_wave": write_pullback("body_wave", body_wave, returned=rows_of_body_wave, **step),
        "fin_wave": write_pullback("fin_wave", fin_wave, returned=rows_of_fin_wave, **step),
    }
