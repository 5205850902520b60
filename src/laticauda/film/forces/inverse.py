"""`find_forces`: from a fitted film to forces, power and efficiency, each with an interval.

Every draw is a whole motion, a body and a water. The state of the body at every moment is the film's, root
included; forces and torques are those of the model in that state. Two things test the water:

- the force left over, what the root really did less what the model says of it, times its inertia;
- the speed at which the model swims with the same joint angles when its root is free.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.film.chain import ChainFit, ChainMotion
from laticauda.film.forces.arguments import check_force_arguments
from laticauda.film.forces.assumptions import (
    AssumptionDraws,
    Assumptions,
    Draw,
    draw_assumptions,
)
from laticauda.film.forces.estimates import Estimate, estimate
from laticauda.film.forces.free_swim import FreeSwims, swim_draws
from laticauda.film.forces.loads import LoadDraws, evaluate_draws
from laticauda.film.forces.progress import ignore_progress, part_of_progress
from laticauda.film.forces.window import Window, choose_window
from laticauda.robot import Water
from laticauda.values import BadArgument, check_instance

USUAL_DRAWS = 200
"""Draws of motion, body and water."""
USUAL_SWIMS = 60
"""Draws that swim with a free root."""
FEWEST_FRAMES = 12
"""Frames of a film at least: forces are those of accelerations, which fewer do not show."""
STILL = 1e-3
"""Path by the length of the body, and joint angle in rad, up to which nothing moves."""
SHARE_OF_LOADS = 0.6
"""Share of the loads of all draws in the time after the fit."""
GRAVITY = 9.81
"""g, by which the cost of transport is defined [m/s^2]."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FilmForces:
    """Forces, power and efficiency of a filmed swim, with intervals."""

    fit: ChainFit
    """The fitted film."""
    assumptions: Assumptions
    """What is assumed of water and body."""
    window: Window
    """The span that the figures are of."""
    motions: ChainMotion
    """A motion of every draw."""
    assumed: AssumptionDraws
    """Body and water of every draw."""
    loads: LoadDraws
    """Loads of every draw."""
    swims: FreeSwims | None
    """Swims of every draw with a free root; None for a motion that does not repeat."""

    def __repr__(self) -> str:
        """Return one line: speed and power with their intervals."""
        speed, power = self.figures["speed"], self.figures["mechanical_power"]
        return (
            f"<FilmForces of {self.fit.robot.name}: {speed.median:.3g} m/s "
            f"({speed.low:.3g} to {speed.high:.3g}), {power.median:.3g} W "
            f"({power.low:.3g} to {power.high:.3g})>"
        )

    @cached_property
    def course(self) -> Float[np.ndarray, "n_draws 2"]:
        """Direction of travel over the span in every draw."""
        way = self._way
        return way / np.linalg.norm(way, axis=1, keepdims=True)

    @cached_property
    def speed(self) -> Float[np.ndarray, " n_draws"]:
        """Distance over time of the center of mass in every draw, as the film shows it [m/s]."""
        distance = self.assumed.scale * np.linalg.norm(self._way, axis=1)
        return distance / self.window.duration

    @property
    def _way(self) -> Float[np.ndarray, "n_draws 2"]:
        """From the first place of the center of mass to the last in every draw, in the film's scale [m]."""
        return _way_of(self.motions)

    @cached_property
    def force_along(self) -> Float[np.ndarray, "n_draws n_times n_links"]:
        """Force of the water on every link along the direction of travel; below 0 it brakes [N]."""
        return np.einsum("dtla,da->dtl", self.loads.link_force, self.course)

    @cached_property
    def mean_force_along(self) -> Float[np.ndarray, "n_draws n_links"]:
        """Mean of `force_along` over the span [N]."""
        return self._mean(self.force_along)

    @cached_property
    def thrust(self) -> Float[np.ndarray, " n_draws"]:
        """Sum of the mean forces of those links that push [N]."""
        return np.sum(np.maximum(self.mean_force_along, 0.0), axis=1)

    @cached_property
    def left_over_along(self) -> Float[np.ndarray, "n_draws n_times"]:
        """Force along the direction of travel that the water does not explain [N]."""
        return np.einsum("dta,da->dt", self.loads.left_over[..., 1:], self.course)

    @cached_property
    def figures(self) -> Mapping[str, Estimate]:
        """All figures by name."""
        speed = self.speed
        power = self._mean(self.loads.power)
        weight = np.array([_displaced_weight(draw) for draw in self.assumed.draws])
        left_over = self._mean(self.left_over_along)
        left_over_squares = np.sum(self.loads.left_over[..., 1:] ** 2, axis=2)
        left_over_rms = np.sqrt(self._mean(left_over_squares))
        rows = {
            "speed": ("speed, from the film", "m/s", speed),
            "mechanical_power": ("mechanical power", "W", power),
            "net_power": ("net mechanical power", "W", self._mean(self.loads.net_power)),
            "thrust": ("thrust of the links that push", "N", self.thrust),
            "froude_efficiency": ("Froude efficiency", "", self.thrust * speed / power),
            "cost_of_transport": ("cost of transport", "", power / (weight * speed)),
            "left_over": ("mean force left over", "N", left_over),
            "left_over_share": ("mean force left over, by thrust", "", self._by_thrust(left_over)),
            "left_over_rms": ("force left over, rms", "N", left_over_rms),
        }
        if self.swims is not None:
            rows["model_speed"] = ("speed that the model swims", "m/s", self.swims.speed)
            rows["model_power"] = ("power at that speed", "W", self.swims.power)
        figures: dict[str, Estimate] = {}
        for name, (title, unit, values) in rows.items():
            figures[name] = estimate(title, unit, values, self.assumed)
        return figures

    @cached_property
    def link_figures(self) -> tuple[Estimate, ...]:
        """Mean force of the water on every link along the direction of travel, tail first."""
        figures: list[Estimate] = []
        for link in range(self.fit.robot.n_links):
            force = self.mean_force_along[:, link]
            figures.append(estimate(f"link {link + 1}", "N", force, self.assumed))
        return tuple(figures)

    @property
    def explains(self) -> bool:
        """Whether the water explains the mean motion: 0 lies in the interval of the mean force left over."""
        return self.figures["left_over"].holds(0.0)

    def _by_thrust(self, force: Float[np.ndarray, " n_draws"]) -> Float[np.ndarray, " n_draws"]:
        """Return a force by the thrust; nan in draws in which no link pushes [-]."""
        pushing = np.where(self.thrust > 0.0, self.thrust, np.nan)
        return force / pushing

    def _mean(self, series: Float[np.ndarray, "n_draws n_times ..."]) -> np.ndarray:
        """Return the mean over the span in every draw."""
        return self.window.mean(np.moveaxis(series, 1, 0))


def find_forces(
    fit: ChainFit,
    water: Water | Assumptions | None = None,
    *,
    span: tuple[float, float] | None = None,
    body_deviation: float = 0.0,
    scale_deviation: float = 0.0,
    n_draws: int = USUAL_DRAWS,
    n_swims: int = USUAL_SWIMS,
    seed: int = 0,
    threads: int | None = None,
    on_progress: Callable[[float], object] | None = None,
) -> FilmForces:
    """Find forces, power and efficiency of a filmed swim, each with an interval.

    Args:
        fit: The fitted film.
        water: The water, taken as known; or what is assumed of water and body; None: the water from tables
            for this body at this speed, with its intervals.
        span: Begin and end of the part of the film that is used; None: all whole cycles [s].
        body_deviation: Relative standard deviation of the body's height and width, unless `water`
            has it [-].
        scale_deviation: The same of the film's scale [-].
        n_draws: Number of draws.
        n_swims: Number of draws that swim with a free root as well; 0: none does.
        seed: Seed of the draws.
        threads: Number of threads of the free swims; None uses all cores.
        on_progress: Called with the share of the work that is done.

    Returns:
        The figures, and everything that they were computed from.

    Raises:
        ValueError: If the film holds no whole cycle, or an argument is out of its range.
    """
    check_instance("fit", fit, ChainFit)
    check_force_arguments(
        time=fit.model.time,
        water=water,
        span=span,
        body_deviation=body_deviation,
        scale_deviation=scale_deviation,
        n_draws=n_draws,
        n_swims=n_swims,
        seed=seed,
        threads=threads,
    )
    if fit.points.n_frames < FEWEST_FRAMES:
        rule = f"must hold at least {FEWEST_FRAMES} frames, for fewer do not show accelerations"
        raise BadArgument("points", f"{rule}, got {fit.points.n_frames}")
    _check_motion(fit)
    window = choose_window(fit, span)
    motions = fit.draw(n_draws, window.time, seed=seed)
    distance = np.linalg.norm(_way_of(motions), axis=1)
    speed = float(np.median(distance)) / window.duration
    assumptions = _assumptions_of(fit, water, speed, body_deviation, scale_deviation)
    assumed = draw_assumptions(fit.robot, assumptions, n_draws, seed + 1)
    report = on_progress or ignore_progress
    loads = evaluate_draws(
        motions,
        assumed.draws,
        assumed.scale,
        on_progress=part_of_progress(report, 0.0, SHARE_OF_LOADS),
    )
    swims = None
    if window.n_cycles and n_swims:
        swims = swim_draws(motions, assumed.draws, window, speed, n_swims=n_swims, threads=threads)
    return FilmForces(
        fit=fit,
        assumptions=assumptions,
        window=window,
        motions=motions,
        assumed=assumed,
        loads=loads,
        swims=swims,
    )


def _way_of(motions: ChainMotion) -> Float[np.ndarray, "n_draws 2"]:
    """Return the way from the first place of the center of mass to the last in every draw [m]."""
    return motions.center_of_mass[:, -1] - motions.center_of_mass[:, 0]


def _check_motion(fit: ChainFit) -> None:
    """Refuse a film in which nothing moves, whose figures would be quotients of nothing."""
    motion = fit.motion(fit.model.time)
    moved = float(np.max(np.ptp(motion.center_of_mass, axis=0)))
    bent = float(np.max(np.ptp(motion.joint_angle, axis=0)))
    if moved < STILL * fit.robot.length and bent < STILL:
        rule = "must show a body that moves"
        raise BadArgument(
            "points",
            f"{rule}: it stays within {1e3 * moved:.2g} mm, and its joints within {bent:.2g} rad",
        )


def _assumptions_of(
    fit: ChainFit,
    water: Water | Assumptions | None,
    speed: float,
    body_deviation: float,
    scale_deviation: float,
) -> Assumptions:
    if isinstance(water, Assumptions):
        return water
    if water is None:
        return Assumptions.of_textbook(
            fit.robot, speed, body_deviation=body_deviation, scale_deviation=scale_deviation
        )
    return Assumptions(water=water, body_deviation=body_deviation, scale_deviation=scale_deviation)


def _displaced_weight(draw: Draw) -> float:
    """Return the weight of the displaced water [N]."""
    return draw.water.density * draw.robot.volume * GRAVITY
