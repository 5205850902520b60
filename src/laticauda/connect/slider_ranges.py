"""Ranges of the sliders of pages: those of the page without a server, and those of the cockpit."""

from collections.abc import Mapping
from typing import NamedTuple


class SliderRange(NamedTuple):
    """Range of a slider, in degrees for angles."""

    low: float
    """Smallest value."""
    high: float
    """Largest value."""
    step: float
    """Distance of two values."""


LIMITS: Mapping[str, Mapping[str, SliderRange]] = {
    "gait": {  # the paper's sweeps and some more
        "amplitude": SliderRange(low=0.0, high=60.0, step=1.0),
        "frequency": SliderRange(low=0.0, high=220.0, step=5.0),
        "phase_shift": SliderRange(low=-90.0, high=90.0, step=1.0),
        "offset": SliderRange(low=-20.0, high=20.0, step=0.5),
    },
    "fin": {
        "flexural_rigidity": SliderRange(low=0.02, high=1.0, step=0.01),
    },
    "water": {
        "tangential_friction": SliderRange(low=0.0, high=1.0, step=0.005),
        "normal_drag": SliderRange(low=0.0, high=4.0, step=0.05),
        "added_mass": SliderRange(low=0.0, high=3.0, step=0.05),
    },
    "current": {
        "x": SliderRange(low=-0.3, high=0.3, step=0.005),
        "y": SliderRange(low=-0.3, high=0.3, step=0.005),
    },
    "path": {
        "look_ahead_distance": SliderRange(low=0.05, high=3.0, step=0.01),
        "integral_gain": SliderRange(low=0.0, high=0.5, step=0.01),
        "gain": SliderRange(low=0.05, high=1.5, step=0.05),
        "max_offset": SliderRange(low=1.0, high=30.0, step=1.0),
    },
}
"""Ranges of the sliders of a page, by group and name."""
