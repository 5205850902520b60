"""Signs in a filmed swim that a figure may be wrong although its interval is narrow, a sentence each."""

import numpy as np

from laticauda.film.forces.inverse import FilmForces
from laticauda.film.forces.stretch import measure_stretch

NOTED_STRETCH = 0.03
"""Misfit of lengths in the film and on the body that is said."""
LOOSEST = 0.03
"""Noise of the points, by the length of the body, above which the chain does not hold."""
MOST_OUTLIERS = 0.1
"""Share of places that belong elsewhere, above which points or places are wrong."""
FAST = 5.0
"""Body lengths per second above which the frame rate may be wrong [1/s]."""


def list_doubts(forces: FilmForces) -> list[str]:
    """Return why the figures may be wrong, a sentence each; none if nothing speaks against them.

    Args:
        forces: The figures.
    """
    doubts = [
        _doubt_direction(forces),
        _doubt_length(forces),
        _doubt_chain(forces),
        _doubt_speed(forces),
        _doubt_free_swim(forces),
    ]
    return [doubt for doubt in doubts if doubt]


def share_of_misfit(forces: FilmForces) -> float:
    """Return how far the points are from the chain, the median of their noise by the length of the body [-].

    Args:
        forces: The figures.
    """
    return float(np.median(forces.fit.noise)) / forces.fit.robot.length


def _doubt_direction(forces: FilmForces) -> str:
    motion = forces.fit.motion(forces.window.time)
    ahead = np.stack((np.cos(motion.heading), np.sin(motion.heading)), axis=1)
    way = motion.center_of_mass[-1] - motion.center_of_mass[0]
    advance = float(way @ np.mean(ahead, axis=0))
    if advance > -0.5 * float(np.linalg.norm(way)):
        return ""
    return (
        "It swims tail first. Are the points in order from nose to tail tip, and is each where "
        "--along (`along`) says?"
    )


def _doubt_length(forces: FilmForces) -> str:
    stretch = measure_stretch(forces.fit)
    if abs(stretch - 1.0) < NOTED_STRETCH:
        return ""
    comparison = "closer together"
    if stretch > 1.0:
        comparison = "farther apart"
    return (
        f"The points are {abs(stretch - 1.0):.0%} {comparison} than on a body of {forces.fit.robot.length:.3g} m: its "
        "length, the scale of the film, or where the points sit is wrong. Speed has this error, and power, which "
        "goes with about the fifth power of length, five times as much. The intervals take scale, height and width as "
        f"known to {forces.assumptions.scale_deviation:.0%} (standard deviation), no more."
    )


def _doubt_chain(forces: FilmForces) -> str:
    fit = forces.fit
    n_seen = max(int(np.count_nonzero(fit.model.is_seen)), 1)
    outliers = fit.n_outliers / n_seen
    if share_of_misfit(forces) < LOOSEST and outliers < MOST_OUTLIERS:
        return ""
    return (
        f"The chain does not hold: the points are {1e3 * float(np.median(fit.noise)):.2g} mm from it, "
        f"{share_of_misfit(forces):.1%} of the body's length, and {outliers:.0%} of them belong elsewhere. Is each "
        "of them where --along (`along`) says, always of the same body?"
    )


def _doubt_speed(forces: FilmForces) -> str:
    lengths = forces.figures["speed"].median / forces.fit.robot.length
    if lengths < FAST:
        return ""
    return (
        f"It swims {lengths:.2g} body lengths per second, as only a burst of a fish does: is the film of "
        f"{forces.fit.points.frame_rate:.4g} frames per second?"
    )


def _doubt_free_swim(forces: FilmForces) -> str:
    model = forces.figures.get("model_speed")
    measured = forces.figures["speed"]
    if model is None or (model.low <= measured.high and measured.low <= model.high):
        return ""
    return (
        f"The model swims at {model.low:.3g} to {model.high:.3g} m/s with these joint angles, the film at "
        f"{measured.median:.3g} m/s: body, scale or water is another, and power may be as wrong."
    )
