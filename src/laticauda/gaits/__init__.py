"""Gaits: the motion requested of the joints, and the generator that turns it into references they can follow."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.gaits.gait import (
        Anguilliform as Anguilliform,
        Custom as Custom,
        EelLike as EelLike,
        Envelope as Envelope,
        GAIT_WORDS as GAIT_WORDS,
        Gait as Gait,
        LateralUndulation as LateralUndulation,
        Wave as Wave,
        custom_gait as custom_gait,
        eel_like as eel_like,
        envelope_of as envelope_of,
        list_kinds as list_kinds,
        lateral_undulation as lateral_undulation,
        recorded_gait as recorded_gait,
    )
    from laticauda.gaits.generator import Generator as Generator, GeneratorState as GeneratorState
    from laticauda.gaits.recorded import JointAngles as JointAngles
    from laticauda.gaits.reference import WaveState as WaveState

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.gaits.gait": [
            "Anguilliform",
            "Custom",
            "EelLike",
            "Envelope",
            "GAIT_WORDS",
            "Gait",
            "LateralUndulation",
            "Wave",
            "custom_gait",
            "eel_like",
            "envelope_of",
            "list_kinds",
            "lateral_undulation",
            "recorded_gait",
        ],
        "laticauda.gaits.generator": ["Generator", "GeneratorState"],
        "laticauda.gaits.recorded": ["JointAngles"],
        "laticauda.gaits.reference": ["WaveState"],
    },
    renamed={"kinds": "list_kinds"},
)
