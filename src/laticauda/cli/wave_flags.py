"""Flags of the optional waves of a gait: those of its pitch joints and of its fin.

A gait has such a wave if one of its numbers is typed. Numbers that are left out are those of the
wave that the gait had; if it had none, frequency and phase shift are those of the gait, and all
others are zero.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from tyro.constructors import StructFieldSpec

from laticauda.cli.flag_names import FLAG_NAMES
from laticauda.cli.number_flags import numbers_flag
from laticauda.values import Annotation, Field, quantities_of

COMMON_NUMBERS = ("frequency", "phase_shift")
"""Numbers that a new wave has from its gait, as far as they have flags: a fin has no phase shift of its own."""
OPTIONAL_NUMBER = Annotation.of(float | None)


@dataclass(frozen=True)
class WaveFlag:
    """The flag of one number of a wave."""

    number: str
    """Name of the number in the wave."""
    spec: StructFieldSpec
    """The flag."""


def wave_flags(field: Field, gait: Any) -> Sequence[WaveFlag]:
    """Return the flags of a wave.

    Args:
        field: Field of the gait that holds the wave.
        gait: Gait whose numbers are the defaults.
    """
    wave = getattr(gait, field.name)
    title = field.text.partition(";")[0]
    flags: list[WaveFlag] = []
    for number, quantity in quantities_of(field.annotation.only_member).items():
        if FLAG_NAMES.is_hidden_number(field, number):
            continue
        flag_name = f"{field.name}_{number}{quantity.display.ending}"
        flag_type: Any = Annotated[Any, numbers_flag(flag_name, OPTIONAL_NUMBER, quantity)]
        spec = StructFieldSpec(
            name=flag_name,
            type=flag_type,
            default=getattr(wave, number, None),
            helptext=f"{title}: {quantity.text}.",
        )
        flags.append(WaveFlag(number=number, spec=spec))
    return flags


def with_typed_wave(gait: Any, field: Field, typed: Mapping[str, Any]) -> Any:
    """Return a gait with the wave of which a number was typed; otherwise the gait itself.

    Args:
        gait: The gait.
        field: Its field that holds the wave.
        typed: Values of all flags by name; None: not typed.
    """
    flags = wave_flags(field, gait)
    changes: dict[str, float] = {}
    for flag in flags:
        number = typed.get(flag.spec.name)
        if number is not None:
            changes[flag.number] = number
    if not changes:
        return gait
    wave = getattr(gait, field.name)
    if wave is None:
        numbers = [flag.number for flag in flags]
        wave = _resting_wave(gait, field.annotation.only_member, numbers)
    return replace(gait, **{field.name: replace(wave, **changes)})


def _resting_wave(gait: Any, wave_class: Any, numbers: Sequence[str]) -> Any:
    """Return a wave that does not move, with the numbers that it shares with its gait."""
    common = {number: getattr(gait, number) for number in COMMON_NUMBERS if number in numbers}
    return wave_class(amplitude=0.0, **common)
