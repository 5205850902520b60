"""How much the sensors and the motion model are off: the settings by which the filter weighs what comes in."""

import math
from dataclasses import replace

from laticauda.quantities import quantity, value


@value
class Noise:
    """How much the sensors and the model are off: standard deviations, and how fast what is not known wanders."""

    position: float = quantity("m", "of the marker body, per axis", gt=0.0, default=0.001)
    yaw: float = quantity("rad", "of the marker body", gt=0.0, default=math.radians(0.1))
    joint: float = quantity("rad", "of a joint's sensor, with rests of its backlash", gt=0.0, default=math.radians(0.3))
    joint_acceleration: float = quantity(
        "rad/s^2/sqrt(Hz)", "how fast a joint's rate strays from the reference's", gt=0.0, default=0.5
    )
    position_walk: float = quantity("m/sqrt(s)", "how fast the center of mass strays", ge=0.0, default=0.001)
    surge: float = quantity("m/s/sqrt(s)", "how fast the speed through the water changes", ge=0.0, default=0.0067)
    sway: float = quantity("m/s", "of the sideways speed, which fades within `sway_time`", ge=0.0, default=0.01)
    sway_time: float = quantity("s", "in which the sideways speed fades", gt=0.0, default=6.0)
    current: float = quantity("m/s", "of the water's velocity, per axis, before any frame", gt=0.0, default=0.1)
    current_walk: float = quantity("m/s/sqrt(s)", "how fast the water's velocity changes", ge=0.0, default=0.001)
    turning: float = quantity("rad/s/sqrt(s)", "how fast the smooth heading's rate changes", ge=0.0, default=0.03)
    turn_gain: float = quantity("1/s/sqrt(s)", "how fast turning per mean joint angle changes", ge=0.0, default=0.06)
    slip_gain: float = quantity("m/s/sqrt(s)", "the same for the sideways speed", ge=0.0, default=0.015)
    heading_gain: float = quantity("1/sqrt(s)", "how fast a mode's share in the heading changes", ge=0.0, default=0.15)
    across_gain: float = quantity("m/sqrt(s)", "the same for its share in the place across", ge=0.0, default=0.005)
    heading_ripple: float = quantity(
        "rad/sqrt(s)", "how fast the heading's ripple changes; harmonic k by 1/k of it", ge=0.0, default=0.0033
    )
    position_ripple: float = quantity("m/sqrt(s)", "the same for the center of mass", ge=0.0, default=0.006)


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
    return replace(noise, **{name: min(getattr(noise, name), limit) for name, limit in BESIDE_TWIN.items()})
