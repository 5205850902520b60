"""Gaits: the motion requested of the joints, and the generator that turns it into references they can follow."""

from typing import TYPE_CHECKING

from laticauda.values.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.motion.gaits.gait import (
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
    from laticauda.motion.gaits.generator import (
        Generator as Generator,
        GeneratorState as GeneratorState,
    )
    from laticauda.motion.gaits.recorded import JointAngles as JointAngles
    from laticauda.motion.gaits.reference import WaveState as WaveState

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.motion.gaits.gait": [
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
        "laticauda.motion.gaits.generator": ["Generator", "GeneratorState"],
        "laticauda.motion.gaits.recorded": ["JointAngles"],
        "laticauda.motion.gaits.reference": ["WaveState"],
    },
    renamed={"kinds": "list_kinds"},
)
