"""Gaits: what is asked of the joints, and the generator that turns it into a reference they can follow."""

from laticauda.gaits.gait import GAIT_KINDS, GAIT_WORDS, Gait, Wave, custom_gait, eel_like, lateral_undulation
from laticauda.gaits.generator import Generator, GeneratorState

__all__ = [
    "GAIT_KINDS",
    "GAIT_WORDS",
    "Gait",
    "Generator",
    "GeneratorState",
    "Wave",
    "custom_gait",
    "eel_like",
    "lateral_undulation",
]
