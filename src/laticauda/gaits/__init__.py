"""Gaits: what is asked of the joints, and the generator that turns it into a reference they can follow."""

from laticauda.gaits.envelopes import GAIT_WORDS, Custom, EelLike, Envelope, LateralUndulation, envelope_of, kinds
from laticauda.gaits.gait import Gait, Wave, custom_gait, eel_like, lateral_undulation
from laticauda.gaits.generator import Generator, GeneratorState

__all__ = [
    "GAIT_WORDS",
    "Custom",
    "EelLike",
    "Envelope",
    "Gait",
    "Generator",
    "GeneratorState",
    "LateralUndulation",
    "Wave",
    "custom_gait",
    "eel_like",
    "envelope_of",
    "kinds",
    "lateral_undulation",
]
