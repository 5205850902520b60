"""How much the sensors and the motion model are off: the settings by which the filter weighs what it is told."""

import math
from dataclasses import dataclass, replace

from laticauda.errors import not_negative, positive

GAINS = ("turn_gain", "slip_gain", "heading_gain", "across_gain", "heading_ripple", "position_ripple")


@dataclass(frozen=True, kw_only=True)
class Noise:
    """How much the sensors and the model are off: standard deviations, and how fast what is not known wanders.

    Raises:
        ValueError: If a field is out of its range.
    """

    position: float = 0.001
    """Of the marker body, per axis [m]."""
    yaw: float = math.radians(0.1)
    """Of the marker body [rad]."""
    joint: float = math.radians(0.3)
    """Of a joint's sensor, with what is left of its backlash [rad]."""
    joint_acceleration: float = 0.5
    """How fast a joint's rate strays from the reference's [rad/s^2/sqrt(Hz)]."""
    position_walk: float = 0.001
    """How fast the center of mass strays [m/sqrt(s)]."""
    surge: float = 0.0067
    """How fast the speed through the water changes [m/s/sqrt(s)]."""
    sway: float = 0.01
    """Of the sideways speed through the water, which fades within `sway_time` [m/s]."""
    sway_time: float = 6.0
    """[s]."""
    current: float = 0.1
    """Of the water's velocity, per axis, before anything was seen [m/s]."""
    current_walk: float = 0.001
    """How fast it changes [m/s/sqrt(s)]."""
    turning: float = 0.03
    """How fast the smooth heading's rate changes [rad/s/sqrt(s)]."""
    turn_gain: float = 0.06
    """How fast the rate of turning per mean joint angle changes [1/s/sqrt(s)]."""
    slip_gain: float = 0.015
    """How fast the sideways speed per mean joint angle changes [m/s/sqrt(s)]."""
    heading_gain: float = 0.15
    """How fast a bending mode's share in the heading changes [1/sqrt(s)]."""
    across_gain: float = 0.005
    """How fast a bending mode's share in the center of mass's place changes [m/sqrt(s)]."""
    heading_ripple: float = 0.0033
    """How fast the rest of the heading's ripple changes; harmonic k by 1/k of it [rad/sqrt(s)]."""
    position_ripple: float = 0.006
    """The same for the center of mass [m/sqrt(s)]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name in ("position", "yaw", "joint", "joint_acceleration", "sway_time", "current"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        for name in ("position_walk", "surge", "sway", "current_walk", "turning", *GAINS):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))


# How fast changes what a twin leaves to explain of the motion; chosen on runs of their own, with the right plant and
# with a wrong one. See docs/theory/estimation.md.
BESIDE_TWIN = {
    "turning": 0.012,
    "turn_gain": 0.03,
    "slip_gain": 0.01,
    "heading_gain": 0.05,
    "across_gain": 0.002,
    "heading_ripple": 0.003,
    "position_ripple": 0.0025,
}


def beside_twin(noise: Noise) -> Noise:
    """The same sensors, and of the motion what a twin does not foresee.

    Args:
        noise: Without a twin.
    """
    return replace(noise, **{name: min(getattr(noise, name), value) for name, value in BESIDE_TWIN.items()})
