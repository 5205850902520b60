"""Animals as robots: a body of links from length, mass and profile, so that all that swims a robot swims it."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from laticauda.robot import Actuator, Joint, Module, Robot, Section
from laticauda.values import BadArgument, check_positive, check_whole_number

USUAL_LINKS = 10
"""Links of an animal's body."""
LEAST_SHARE = 0.02
"""Width or height of a link by the largest of the body, at least: a tail tip is thin but not nothing."""
WATER_DENSITY = 1000.0
"""Density of a body that neither sinks nor floats in fresh water [kg/m^3]."""
EEL_WIDTH = (0.01, 0.025, 0.035, 0.045, 0.05, 0.055, 0.055, 0.05, 0.02)
"""Width of an eel by its length, tail first."""
EEL_HEIGHT = (0.03, 0.06, 0.065, 0.065, 0.065, 0.065, 0.065, 0.06, 0.03)
"""Height of an eel by its length, fins included, tail first."""
FISH_WIDTH = (0.005, 0.02, 0.05, 0.09, 0.12, 0.13, 0.13, 0.12, 0.04)
"""Width of a fish such as a zebrafish or a carp by its length, tail first."""
FISH_HEIGHT = (0.2, 0.09, 0.08, 0.14, 0.19, 0.21, 0.21, 0.17, 0.05)
"""Its height, tail fin included."""


def build_body(
    name: str,
    length: float,
    width: Sequence[float],
    height: Sequence[float],
    *,
    mass: float | None = None,
    n_links: int = USUAL_LINKS,
) -> Robot:
    """Return the body of an animal as a robot of equally long links with elliptic sections.

    Args:
        name: What it is called.
        length: From tail tip to nose [m].
        width: Width at equal steps from the tail tip to the nose [m].
        height: Height at equal steps, fins included [m].
        mass: Mass [kg]; None: as heavy as the water that it displaces. It is spread like the volume.
        n_links: Number of links.

    Returns:
        The body. Its joints have no motor data of their own.

    Raises:
        ValueError: If a profile has no positive number, or the others are out of range.

    Example:
        >>> build_body("tadpole", 0.04, width=[0.001, 0.002, 0.008], height=[0.004, 0.006, 0.007])
        <Robot tadpole: 10 links, 0.04 m, 0.0006384 kg>
    """
    length = check_positive("length", length, "m")
    check_whole_number("n_links", n_links, 2, 100)
    half_widths = 0.5 * _sizes_of_links("width", width, n_links)
    half_heights = 0.5 * _sizes_of_links("height", height, n_links)
    volumes = np.pi * half_widths * half_heights * length / n_links
    total = WATER_DENSITY * float(np.sum(volumes))
    if mass is not None:
        total = check_positive("mass", mass, "kg")
    masses = total * volumes / np.sum(volumes)
    modules: list[Module] = []
    for i in range(n_links):
        section = Section(half_height=float(half_heights[i]), half_width=float(half_widths[i]))
        modules.append(Module(length=length / n_links, mass=float(masses[i]), section=section))
    joint = Joint(actuator=Actuator(stated=False))
    return Robot(
        name=name,
        description=f"Body of {n_links} links from its profile",
        modules=tuple(modules),
        joints=(joint,) * (n_links - 1),
        surface="smooth",
        nose="faired",
        tail="faired",
    )


def build_eel(length: float, *, mass: float | None = None, n_links: int = USUAL_LINKS) -> Robot:
    """Return an eel of usual proportions.

    Args:
        length: From tail tip to nose [m].
        mass: Mass [kg]; None: as heavy as the water that it displaces.
        n_links: Number of links.

    Example:
        >>> build_eel(0.4)
        <Robot eel: 10 links, 0.4 m, 0.1281 kg>
    """
    width = length * np.array(EEL_WIDTH)
    height = length * np.array(EEL_HEIGHT)
    return build_body("eel", length, width.tolist(), height.tolist(), mass=mass, n_links=n_links)


def build_fish(length: float, *, mass: float | None = None, n_links: int = USUAL_LINKS) -> Robot:
    """Return a fish of the proportions of a zebrafish or a carp, tail fin included.

    Args:
        length: From the end of the tail fin to the nose [m].
        mass: Mass [kg]; None: as heavy as the water that it displaces.
        n_links: Number of links.

    Example:
        >>> build_fish(0.03)
        <Robot fish: 10 links, 0.03 m, 0.000307 kg>
    """
    width = length * np.array(FISH_WIDTH)
    height = length * np.array(FISH_HEIGHT)
    return build_body("fish", length, width.tolist(), height.tolist(), mass=mass, n_links=n_links)


def _sizes_of_links(
    name: str, profile: Sequence[float], n_links: int
) -> Float[np.ndarray, " n_links"]:
    """Return a profile at the middles of all links, nowhere nothing [m]."""
    sizes = _check_profile(name, profile)
    middles = (np.arange(n_links) + 0.5) / n_links
    steps = np.linspace(0.0, 1.0, sizes.size)
    sizes_of_links = np.interp(middles, steps, sizes)
    return np.maximum(sizes_of_links, LEAST_SHARE * np.max(sizes))


def _check_profile(name: str, profile: Sequence[float]) -> Float[np.ndarray, " n_sizes"]:
    """Return a profile as an array, if it holds sizes."""
    sizes = np.asarray(profile, dtype=float)
    if sizes.ndim != 1 or sizes.size < 2:
        raise BadArgument(name, "must hold at least two numbers, from the tail tip to the nose")
    are_sizes = np.all(np.isfinite(sizes)) and np.all(sizes >= 0.0)
    if not are_sizes or not np.any(sizes > 0.0):
        raise BadArgument(name, f"must hold sizes >= 0 m, some of them > 0, got {list(profile)}")
    return sizes
