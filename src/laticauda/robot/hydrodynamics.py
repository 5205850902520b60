"""Loads per link from a body's section and the water's dimensionless coefficients.

Those of a link follow from its section, length and coefficients by the formulas of
`laticauda.water.fluid.sections`. In a water with a `friction_taper`, C_f (1 + taper (1 - 2 s))
replaces C_f on the links, where s is the position of the link's middle, from 0 at the tail end of
the body to 1 at its head end; for links of equal length, the mean is C_f. The taper does not affect
the fin, nor modules with their own C_f.

The wake behind the tail end carries m' = rho pi C_A a^2 per length, from the section there
(`wake_mass`). With ``trailing_edge="finite-span"`` a fin is a plate of finite span: its strips have
the added mass k m' per length, together the moment of inertia k_r m' c^3 / 12 about the middle of
its chord c, and its edge has the numbers of `fin_edge` (`laticauda.water.fluid.edges`).

`bending_frequencies` computes the natural frequencies of a flexible fin in that water.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.robot import CaudalFin, Environment, Ground, Module, Robot, Water
from laticauda.robot.plates import PlateCoefficients, plate_of_fin, plates_of_modules
from laticauda.robot.silhouettes import FinPlate, fin_plate, strip_heights
from laticauda.values import BadArgument, explain
from laticauda.water.fluid.edges import NO_CAP, Plate
from laticauda.water.fluid.sections import Link, LinkLoads, link_loads, surface_factor

SMALLEST_OFFSET = 1e-9
"""Offset of two centers below which they are one, relative to a fin's length [-]."""
_LOADS = LinkLoads._fields


@dataclass(frozen=True, kw_only=True, eq=False)
class Coefficients:
    """Loads per element, tail first; every field but `fin` has shape (n,)."""

    half_length: Float[np.ndarray, " n"]
    """l [m]."""
    position: Float[np.ndarray, " n"]
    """Middle of the element from the tail end of its body, positive toward the head [m]."""
    mass: Float[np.ndarray, " n"]
    """m [kg]."""
    c_t: Float[np.ndarray, " n"]
    """Drag along the element [N s^2/m^2]; on viscous ground [N s/m], on dry ground mu_t m g [N]."""
    c_n: Float[np.ndarray, " n"]
    """Drag across the element [N s^2/m^2]; on viscous ground [N s/m], on dry ground mu_n m g [N]."""
    mu_t: Float[np.ndarray, " n"]
    """Added mass along the element [kg]."""
    mu_n: Float[np.ndarray, " n"]
    """Added mass across the element [kg]."""
    lambda_1: Float[np.ndarray, " n"]
    """Added inertia about the element's middle [kg m^2]."""
    lambda_2: Float[np.ndarray, " n"]
    """Linear rotational drag per U_ref [N s^2]."""
    lambda_3: Float[np.ndarray, " n"]
    """Quadratic rotational drag [N m s^2]."""
    displaced: Float[np.ndarray, " n"]
    """Mass of the water that would fill the element's volume; 0 on the ground [kg]."""
    fin: "Coefficients | None" = None
    """Strips of the caudal fin on body 0, from its root to the trailing edge; None without a fin [-]."""
    areas: "Coefficients | None" = None
    """Drag areas in the robot's order, each at its place from the tail end of its link; None without any [-]."""


def link_coefficients(robot: Robot, environment: Environment) -> Coefficients:
    """Compute drag and added mass of every link of a planar robot and of every strip of its fin.

    A fin strip of length d has, at its own middle,

        mu_n = rho pi C_A (h/2)^2 d,   c_n = 1/2 rho C_D h d,   c_t = 1/2 rho C_f 2 h d (two faces),   mu_t = 0

    and no torque of its own, unless ``rotational="strip"`` adds the contributions within a strip.
    An open opening has mass (see `CaudalFin`) but no area, and hence no strip. On the ground the
    strips carry the fin's whole mass: dry friction acts on their weight; viscous friction, which is
    given per link, does not act on them.

    Args:
        robot: Robot whose joints all rotate about the vertical axis (see `Robot.planar`).
        environment: The water in which it swims, or the ground on which it crawls.

    Returns:
        Arrays per link, tail first, together with the fin's strips and the drag areas. Coefficients of a module or of
        the fin replace the water's on that module or on the fin.

    Raises:
        ValueError: If the water's depth does not cover a link or the fin.
    """
    known = {
        id(one): (one.half_length, one.mass, one.volume)
        for one in {id(m): m for m in robot.modules}.values()
    }
    half_length, mass, volume = np.array([known[id(module)] for module in robot.modules]).T
    fin = robot.caudal_fin
    if isinstance(environment, Ground):
        loads, density = _ground_loads(mass, environment), 0.0
        strips = _fin_on_ground(fin, environment) if fin else None
        areas = None
    else:
        loads, density = _loads_in_water(robot, environment), environment.density
        strips = _fin_in_water(robot, fin, environment) if fin else None
        areas = _areas_in_water(robot, environment)
    links = _coefficients(half_length, half_length, mass, loads, density * volume, strips)
    return replace(links, areas=areas)


def immersion_factor(half_height: float, depth: float | None) -> float:
    """Return the factor 1 + a^2 / (2 h^2) of the surface on the normal added mass, from an image above the surface.

    Surface waves are neglected: at swimming frequencies, the surface acts as a lid.

    Args:
        half_height: a [m].
        depth: h, depth of the axis below the surface [m]; None for far below the surface.

    Returns:
        The factor [-], from 1 (deep) to 3/2 (just covered).

    Raises:
        ValueError: If the element is not covered by water, h <= a.
    """
    if depth is None:
        return 1.0
    if not depth > half_height:
        raise BadArgument(
            "depth", f"must be > {half_height:g} m, the element's half height, got {depth}"
        )
    return surface_factor(half_height, depth)


def mass_across(override: float | None, half_height: float, water: Water) -> float:
    """Compute the added mass per length across an element far below the surface, rho pi C_A a^2 [kg/m].

    Args:
        override: C_A of the part that the element belongs to; None for the water's.
        half_height: a, half the size of the section across the motion [m].
        water: Water that defines rho and C_A.
    """
    return water.density * np.pi * override_or_default(override, water.added_mass) * half_height**2


def wake_mass(robot: Robot, water: Water) -> float:
    """Compute m' of Lighthill's force at the trailing edge, from the section of the fin or of the tail link there.

    Args:
        robot: The robot that swims.
        water: Water that defines density, depth, and C_A unless the part has its own.

    Returns:
        rho pi C_A a^2, including the effect of the surface [kg/m].
    """
    fin, tail = robot.caudal_fin, robot.modules[0]
    if fin is not None:
        half_height = fin.height / 2.0
        coefficient = added_mass_of_fin(robot, water)
    else:
        half_height = tail.section.half_height
        coefficient = added_mass_of_module(tail, plates_of_modules(robot)[0], water)
    mass = mass_across(coefficient, half_height, water)
    return mass * immersion_factor(half_height, water.depth)


def added_mass_of_fin(robot: Robot, water: Water) -> float | None:
    """Return C_A of a robot's fin: its own, or that of a plate; None for the water's [-].

    Args:
        robot: The robot.
        water: Water that defines whether fins are plates.
    """
    fin = robot.caudal_fin
    own = None if fin is None else fin.added_mass
    if own is not None or water.plate_added_mass is None:
        return own
    if water.trailing_edge == "finite-span":
        return water.plate_added_mass  # of a slender plate: the law takes the span into account
    plate = plate_of_fin(robot)
    return None if plate is None else water.plate_added_mass * plate.added_mass


def drag_of_fin(robot: Robot, water: Water) -> float:
    """Return C_D of a robot's fin: its own, that of a plate, or the water's [-].

    Args:
        robot: The robot.
        water: Water that defines C_D and whether fins are plates.
    """
    fin = robot.caudal_fin
    own = None if fin is None else fin.normal_drag
    plate = plate_of_fin(robot)
    if own is not None or plate is None or water.plate_drag is None:
        return override_or_default(own, water.normal_drag)
    return water.plate_drag * plate.drag


def added_mass_of_module(
    module: Module, plate: PlateCoefficients | None, water: Water
) -> float | None:
    """Return C_A of a module: its own, or that of a plate; None for the water's [-].

    Args:
        module: The module.
        plate: Coefficients of the plate that it is; None if it is not flat.
        water: Water that defines whether flat modules are plates.
    """
    if module.added_mass is not None or plate is None or water.plate_added_mass is None:
        return module.added_mass
    return water.plate_added_mass * plate.added_mass


def drag_of_module(module: Module, plate: PlateCoefficients | None, water: Water) -> float:
    """Return C_D of a module: its own, that of a plate, or the water's [-].

    Args:
        module: The module.
        plate: Coefficients of the plate that it is; None if it is not flat.
        water: Water that defines C_D and whether flat modules are plates.
    """
    if module.normal_drag is not None or plate is None or water.plate_drag is None:
        return override_or_default(module.normal_drag, water.normal_drag)
    return water.plate_drag * plate.drag


@dataclass(frozen=True, kw_only=True)
class FinEdge:
    """Trailing edge of a fin of finite span."""

    plate: Plate
    """Numbers of the fin as a plate."""
    distance: float
    """Distance of x_w, where the speed across the fin decides on its lift, behind its root [m]."""


def fin_edge(robot: Robot, water: Water) -> FinEdge | None:
    """Return the trailing edge of a fin of finite span; None for other laws, and for a robot without a fin.

    Args:
        robot: The robot that swims.
        water: Water that defines the law, density, depth, and C_A unless the fin has its own.
    """
    plate = fin_plate(robot)
    if plate is None or water.trailing_edge != "finite-span":
        return None
    mass_per_length = wake_mass(robot, water)
    numbers = Plate(
        lift_mass=plate.lift * mass_per_length,
        added_mass=plate.mass * mass_per_length,
        lever=plate.control - plate.lift_center,
        suction=1.0 - 0.5 * plate.lift,
        instant=1.0 / (2.0 - plate.lift),
        cap=override_or_default(water.edge_clip, NO_CAP),
        lag=plate.lag,
    )
    return FinEdge(plate=numbers, distance=plate.control)


def override_or_default(override: float | None, water: float) -> float:
    """Return a part's own coefficient, or the water's if the part has none.

    Args:
        override: Coefficient of the part.
        water: Coefficient of the water.
    """
    return water if override is None else override


def _coefficients(
    half_length: np.ndarray,
    position: np.ndarray,
    mass: np.ndarray,
    loads: Iterable[np.ndarray],
    displaced: np.ndarray,
    fin: Coefficients | None = None,
) -> Coefficients:
    named: dict[str, Any] = dict(zip(_LOADS, loads, strict=True))
    shape = {"half_length": half_length, "position": position, "mass": mass, "displaced": displaced}
    return Coefficients(**shape, **named, fin=fin)


def links_in_water(robot: Robot, water: Water) -> list[Link]:
    """Return every link's size and the coefficients of the water on it, tail first; identical links are one object.

    Args:
        robot: Robot whose joints all rotate about the vertical axis (see `Robot.planar`).
        water: The water in which it swims.
    """
    modules = robot.modules
    known: dict[tuple[int, float, PlateCoefficients | None], Link] = {}
    links: list[Link] = []
    frictions = _friction_along_body(modules, water)
    for module, plate, friction in zip(modules, plates_of_modules(robot), frictions, strict=True):
        key = id(module), friction, plate
        if key not in known:
            known[key] = _link_of(module, plate, water, friction)
        links.append(known[key])
    return links


def _friction_along_body(modules: Sequence[Module], water: Water) -> list[float]:
    """Return the water's C_f at every link [-]."""
    if water.friction_taper == 0.0:
        return [water.tangential_friction] * len(modules)
    half_length = np.array([module.half_length for module in modules])
    middle = np.cumsum(2.0 * half_length) - half_length
    ahead_of_tail = middle / np.sum(half_length)  # 2 s
    share = 1.0 + water.friction_taper * (1.0 - ahead_of_tail)
    return (water.tangential_friction * share).tolist()


def _link_of(
    module: Module, plate: PlateCoefficients | None, water: Water, friction: float
) -> Link:
    added_mass = added_mass_of_module(module, plate, water)
    return Link(
        half_length=module.half_length,
        half_height=module.section.half_height,
        half_width=module.section.half_width,
        friction=override_or_default(module.tangential_friction, friction),
        drag=drag_of_module(module, plate, water),
        added_mass=override_or_default(added_mass, water.added_mass),
        added_inertia=override_or_default(module.added_inertia, water.added_inertia),
    )


def _loads_in_water(robot: Robot, water: Water) -> np.ndarray:
    """Compute the loads of all links, one column per link; identical links are computed once."""
    known: dict[int, LinkLoads] = {}
    columns: list[LinkLoads] = []
    links = links_in_water(robot, water)
    for link in links:
        if id(link) not in known:
            known[id(link)] = link_loads(
                link,
                water.density,
                water.tangential_added_mass,
                immersion_factor(link.half_height, water.depth),
                water.rotational == "strip",
            )
        columns.append(known[id(link)])
    return np.array(columns).T


def _fin_in_water(robot: Robot, fin: CaudalFin, water: Water) -> Coefficients:
    edges = _strip_edges(fin, closed=fin.opening == "closed")
    d, h, rho = np.diff(edges), fin.height, water.density
    heights = strip_heights(fin, edges)
    zero = np.zeros_like(d)
    mu_n = mass_across(added_mass_of_fin(robot, water), h / 2.0, water) * d
    mu_n *= immersion_factor(h / 2.0, water.depth)
    mass_per_length = float(mu_n.sum() / d.sum())
    mu_n *= (heights / h) ** 2
    c_n = 0.5 * rho * drag_of_fin(robot, water) * heights * d
    c_t = (
        0.5
        * rho
        * override_or_default(fin.tangential_friction, water.tangential_friction)
        * 2.0
        * heights
        * d
    )
    lambdas = (
        _strip_lambdas(mu_n, c_n, d / 2.0) if water.rotational == "strip" else (zero, zero, zero)
    )
    plate = fin_plate(robot)
    if plate is not None and water.trailing_edge == "finite-span":
        mu_n, lambda_1 = _spread_added_mass(plate, edges, heights, mass_per_length)
        lambdas = (lambda_1, *lambdas[1:])
    return _strips(fin, edges, (c_t, c_n, zero, mu_n, *lambdas), rho)


def _areas_in_water(robot: Robot, water: Water) -> Coefficients | None:
    """Return the loads of the drag areas: drag only."""
    if not robot.drag_areas:
        return None
    zero = np.zeros(len(robot.drag_areas))
    position = [area.x + robot.modules[area.link].half_length for area in robot.drag_areas]
    c_t = 0.5 * water.density * np.array([area.along for area in robot.drag_areas])
    c_n = 0.5 * water.density * np.array([area.across for area in robot.drag_areas])
    loads = (c_t, c_n, zero, zero, zero, zero, zero)
    return _coefficients(zero, np.array(position), zero, loads, zero)


def _spread_added_mass(
    plate: FinPlate, edges: np.ndarray, heights: np.ndarray, mass_per_length: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return added mass and inertia of the strips of a fin of finite span, from m' of a slender plate of its height.

    The masses go with the squares of the strips' heights, more toward one end so that their center is the plate's.

    The inertia of a strip is what the plate's moment of inertia lacks beyond that of the strips' masses;
    it is negative where the water near the ends of the plate moves less than that in its middle.
    """
    shares = heights**2 * np.diff(edges)
    arm = 0.5 * (edges[:-1] + edges[1:]) - plate.center
    shares = _center(shares / shares.sum(), arm, negligible=SMALLEST_OFFSET * float(edges[-1]))
    mu_n = plate.mass * mass_per_length * shares
    whole = plate.inertia * mass_per_length
    lacking = whole - mu_n @ (arm * arm)
    return mu_n, np.full_like(mu_n, lacking / mu_n.size)


def _center(shares: np.ndarray, arm: np.ndarray, *, negligible: float) -> np.ndarray:
    """Return shares whose mean arm is 0: tilted, as far as none becomes negative, and then moved to the nearer end.

    Args:
        shares: Shares of the whole, in the order of the arms.
        arm: Increasing distances from the center that is wanted.
        negligible: Offset of the center that may stay.
    """
    offset = float(shares @ arm)
    if abs(offset) <= negligible:
        return shares
    lever = arm - offset
    tilt = offset / float(shares @ (lever * lever))
    steepest = 1.0 / float(np.max(lever * np.sign(offset)))
    shares = shares * (1.0 - np.clip(tilt, -steepest, steepest) * lever)
    offset = float(shares @ arm)
    if abs(offset) <= negligible:
        return shares
    end = 0 if offset > 0.0 else -1
    moved = min(offset / (offset - float(arm[end])), 1.0)
    shares = (1.0 - moved) * shares
    shares[end] += moved
    return shares


def _fin_on_ground(fin: CaudalFin, ground: Ground) -> Coefficients:
    edges = _strip_edges(fin, closed=True)
    mass = fin.mass * np.diff(edges) / fin.length
    loads = (
        _ground_loads(mass, ground)
        if ground.friction.of_weight
        else [np.zeros_like(mass)] * len(_LOADS)
    )
    return _strips(fin, edges, loads, 0.0)


def _ground_loads(mass: np.ndarray, ground: Ground) -> list[np.ndarray]:
    weight = mass * ground.gravity if ground.friction.of_weight else np.ones_like(mass)
    return [ground.tangential * weight, ground.normal * weight] + [np.zeros_like(mass)] * 5


def _strip_edges(fin: CaudalFin, *, closed: bool) -> np.ndarray:
    """Return the strip edges behind the root [m]; strips of a closed opening are about as long as the others.

    A hinge of the fin splits the strip in which it lies.
    """
    cuts = tuple(hinge.position for hinge in fin.hinges)
    return _cut_strips(fin.length, fin.opening_length, fin.n_strips, closed, cuts)


@lru_cache(maxsize=64)  # most robots of a batch have the same fin; the array is never modified
def _cut_strips(
    length: float, opening: float, n_strips: int, closed: bool, cuts: tuple[float, ...]
) -> np.ndarray:
    edges = np.linspace(opening, length, n_strips + 1)
    if closed and opening > 0.0:
        pieces = int(np.ceil(opening / (edges[1] - edges[0])))
        edges = np.concatenate((np.linspace(0.0, opening, pieces + 1)[:-1], edges))
    inside = [x for x in cuts if x > edges[0] and np.min(np.abs(edges - x)) > 1e-9]
    return np.sort(np.concatenate((edges, inside)))


def _strips(
    fin: CaudalFin, edges: np.ndarray, loads: Iterable[np.ndarray], density: float
) -> Coefficients:
    d = np.diff(edges)
    displaced = density * fin.volume * d / np.sum(d)  # the whole volume, including an opening's
    return _coefficients(
        d / 2.0, -(edges[:-1] + edges[1:]) / 2.0, fin.mass * d / fin.length, loads, displaced
    )


def _strip_lambdas(
    mu_n: np.ndarray, c_n: np.ndarray, half_length: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return normal added mass and drag (linear, quadratic) spread along an element that rotates about its middle."""
    return mu_n * half_length**2 / 3.0, c_n * half_length**2 / 3.0, c_n * half_length**3 / 4.0


def bending_frequencies(robot: Robot, environment: Environment) -> Float[np.ndarray, " n_hinges"]:
    """Compute the natural frequencies of a robot's fin with its root fixed, without drag and damping.

    For small deflections, (K - (2 pi f)^2 M) phi = 0 for the hinge angles phi, with K the hinges'
    stiffness and M the inertia of plate and added mass behind them, m (x - s_i)(x - s_j) for a mass
    m at x behind the hinges i and j.

    Args:
        robot: Robot whose fin has hinges.
        environment: The environment around the fin; on the ground there is no added mass.

    Returns:
        f of every mode, lowest first [Hz].

    Raises:
        ValueError: If there is no flexible fin.

    Example:
        >>> from dataclasses import replace
        >>> from laticauda.robot import load_robot, load_water
        >>> robot = load_robot("mamba-fin")
        >>> fin = replace(robot.caudal_fin, n_hinges=2, flexural_rigidity=2.0)
        >>> bending_frequencies(replace(robot, caudal_fin=fin), load_water("paper-lateral")).round(2).tolist()
        [1.22, 7.85]
    """
    fin, strips = robot.caudal_fin, link_coefficients(robot, environment).fin
    if fin is None or strips is None or not fin.hinges:
        raise BadArgument(
            "robot", "must have a fin that bends (`caudal_fin.n_hinges` > 0), got one that does not"
        )
    hinge = np.array([one.position for one in fin.hinges])
    pieces = [(0.5 * (p.begin + p.end), p.mass, p.mass * p.length**2 / 12.0) for p in fin.pieces]
    water = zip(-strips.position, strips.mu_n, strips.lambda_1, strict=True)
    mass_matrix = np.zeros((hinge.size, hinge.size))
    for place, mass, inertia in [*pieces, *water]:
        behind = hinge < place
        arm = np.where(behind, place - hinge, 0.0)
        mass_matrix += mass * np.outer(arm, arm) + inertia * np.outer(behind, behind)
    root = np.diag([math.sqrt(one.stiffness) for one in fin.hinges])
    flexibility = np.linalg.eigvalsh(np.linalg.inv(root) @ mass_matrix @ np.linalg.inv(root))
    return np.asarray(1.0 / (2.0 * math.pi * np.sqrt(flexibility[::-1])))


explain(globals())
