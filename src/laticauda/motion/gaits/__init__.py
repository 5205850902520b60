"""Gaits: the motion requested of the joints, and the generator that turns it into references they can follow."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.motion.gaits.gait import (
        Anguilliform as Anguilliform,
        Custom as Custom,
        EelLike as EelLike,
        Envelope as Envelope,
        GAIT_WORDS as GAIT_WORDS,
        Gait as Gait,
        GaitFields as GaitFields,
        LateralUndulation as LateralUndulation,
        Wave as Wave,
        custom_gait as custom_gait,
        eel_like as eel_like,
        envelope_of as envelope_of,
        gait_by_name as gait_by_name,
        list_kinds as list_kinds,
        lateral_undulation as lateral_undulation,
        recorded_gait as recorded_gait,
        FASTEST as FASTEST,
        FIRST_GAIT as FIRST_GAIT,
        SMALLEST_AMPLITUDE as SMALLEST_AMPLITUDE,
        STRAIGHT as STRAIGHT,
        was_doubted as was_doubted,
    )
    from laticauda.motion.gaits.generator import (
        Generator as Generator,
        GeneratorState as GeneratorState,
    )
    from laticauda.motion.gaits.recorded import JointAngles as JointAngles
    from laticauda.motion.gaits.reference import (
        WaveState as WaveState,
        WaveTarget as WaveTarget,
        filter_step as filter_step,
        first_state as first_state,
        smooth_start as smooth_start,
    )

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
            "GaitFields",
            "LateralUndulation",
            "Wave",
            "custom_gait",
            "eel_like",
            "envelope_of",
            "gait_by_name",
            "list_kinds",
            "lateral_undulation",
            "recorded_gait",
        ],
        "laticauda.motion.gaits.generator": ["Generator", "GeneratorState"],
        "laticauda.motion.gaits.recorded": ["JointAngles"],
        "laticauda.motion.gaits.reference": ["WaveState"],
    },
    plain={
        "laticauda.motion.gaits.gait": [
            "FASTEST",
            "FIRST_GAIT",
            "SMALLEST_AMPLITUDE",
            "STRAIGHT",
            "was_doubted",
        ],
        "laticauda.motion.gaits.reference": [
            "WaveTarget",
            "filter_step",
            "first_state",
            "smooth_start",
        ],
    },
    renamed={"kinds": "list_kinds"},
)
