"""Gaits: the motion requested of the joints, and the generator that turns it into references they can follow."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.gaits.gait import (
        GAIT_WORDS as GAIT_WORDS,
        Anguilliform as Anguilliform,
        Custom as Custom,
    )
    from laticauda.gaits.gait import EelLike as EelLike, Envelope as Envelope, Gait as Gait
    from laticauda.gaits.gait import (
        LateralUndulation as LateralUndulation,
        Wave as Wave,
        custom_gait as custom_gait,
    )
    from laticauda.gaits.gait import (
        eel_like as eel_like,
        envelope_of as envelope_of,
        kinds as kinds,
    )
    from laticauda.gaits.gait import (
        lateral_undulation as lateral_undulation,
        recorded_gait as recorded_gait,
    )
    from laticauda.gaits.generator import Generator as Generator, GeneratorState as GeneratorState
    from laticauda.gaits.recorded import JointAngles as JointAngles
    from laticauda.gaits.reference import WaveState as WaveState

__getattr__, __dir__, __all__ = lazy_exports()
