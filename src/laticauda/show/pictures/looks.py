"""Colors and light of the surroundings of a robot: under water, near the surface, and on land."""

from dataclasses import dataclass

Color = tuple[float, float, float]
"""Red, green and blue, each from 0 to 1."""


@dataclass(frozen=True, kw_only=True)
class Look:
    """Colors and light of the surroundings; the defaults are those under water."""

    floor: Color = (0.36, 0.55, 0.56)
    """Color of the floor."""
    line: float = 0.76
    """Brightness of the grid lines relative to the floor [-]."""
    far: Color = (0.032, 0.235, 0.310)
    """Color to which distant objects fade."""
    above: Color = (0.30, 0.66, 0.70)
    """Color overhead."""
    fog_begin: float = 1.2
    """Distance at which fading begins, for a robot of 2 m or less [m]."""
    fog_end: float = 8.0
    """Distance at which fading ends, for a robot of 2 m or less [m]."""
    ambient: Color = (0.34, 0.40, 0.42)
    """Ambient light."""


WATER = Look()
AIR = Look(
    far=(0.64, 0.79, 0.84),
    above=(0.46, 0.70, 0.86),
    fog_begin=3.0,
    fog_end=14.0,
    ambient=(0.42, 0.40, 0.38),
)
"""Above the surface of the water, which is visible."""
LAND = Look(
    floor=(0.50, 0.47, 0.42),
    line=0.90,
    far=(0.80, 0.84, 0.87),
    above=(0.55, 0.70, 0.84),
    fog_begin=3.0,
    fog_end=14.0,
    ambient=(0.42, 0.42, 0.42),
)

FOG_PER_LENGTH = 0.5
"""The distances of the fog increase by this factor with the length of a robot of more than 2 m [1/m]."""


def scale_fog(length: float) -> float:
    """Return the factor on the distances of the fog for a robot of some length [m]."""
    return max(1.0, FOG_PER_LENGTH * length)
