"""Arguments of `find_forces` and `invert_points`: checked before any work, which takes seconds to minutes."""

import numpy as np
from jaxtyping import Float

from laticauda.film.forces.assumptions import Assumptions
from laticauda.robot import Water
from laticauda.values import (
    BadArgument,
    check_finite,
    check_instance,
    check_whole_number,
    check_within,
)

FEWEST_DRAWS = 40
"""Draws from which the ends of an interval can be told."""
MOST_DRAWS = 100_000
"""Draws that are certainly a mistake beyond."""


def check_force_arguments(
    *,
    time: Float[np.ndarray, " n_frames"],
    water: Water | Assumptions | None,
    span: tuple[float, float] | None,
    body_deviation: float,
    scale_deviation: float,
    n_draws: int,
    n_swims: int,
    seed: int,
    threads: int | None,
) -> None:
    """Reject what no film can be inverted with.

    Args:
        time: Times of the film's frames [s].
        water: The water, or what is assumed of it and of the body; None: from tables.
        span: Begin and end of the part of the film that is used; None: all of it [s].
        body_deviation: Relative standard deviation of the body's height and width [-].
        scale_deviation: The same of the film's scale [-].
        n_draws: Number of draws.
        n_swims: Number of draws that swim.
        seed: Seed of the draws.
        threads: Number of threads; None: all cores.

    Raises:
        ValueError: If an argument is of another type or out of its range.
    """
    if water is not None:
        check_instance("water", water, Water, Assumptions)
    if span is not None:
        check_span(span, time)
    check_within("body_deviation", body_deviation, 0.0, 1.0)
    check_within("scale_deviation", scale_deviation, 0.0, 1.0)
    check_whole_number("n_draws", n_draws, FEWEST_DRAWS, MOST_DRAWS)
    check_whole_number("n_swims", n_swims, 0, MOST_DRAWS)
    check_whole_number("seed", seed, 0)
    if threads is not None:
        check_whole_number("threads", threads, 1)


def check_span(span: tuple[float, float], time: Float[np.ndarray, " n_frames"]) -> None:
    """Reject a part that is not within its film.

    Args:
        span: Begin and end of the part [s].
        time: Times of the film's frames [s].

    Raises:
        ValueError: If it is not two times in turn within the film.
    """
    if len(span) != 2:
        raise BadArgument("span", f"must be a begin and an end in s, got {len(span)} numbers")
    begin = check_finite("span[0]", span[0], "s")
    end = check_finite("span[1]", span[1], "s")
    first = float(time[0])
    last = float(time[-1])
    if not first <= begin < end <= last:
        rule = f"must go from a begin to a later end within the film, {first:.4g} to {last:.4g} s"
        raise BadArgument("span", f"{rule}, got {begin:.4g} to {end:.4g}")
