"""A filmed swim in words: what was found, what it rests on, and what the film says against the water."""

import numpy as np

from laticauda.film.forces.doubts import share_of_misfit
from laticauda.film.forces.estimates import Estimate
from laticauda.film.forces.inverse import FilmForces

SMALL_SHARE = 0.1
"""Force left over, by thrust, that a right water leaves, too."""
WEAK_TEST = 1.0
"""Width of the interval of the force left over, by the thrust, above which it tests nothing."""
FEW_POINTS = 0.7
"""Points per link below which joint angles rest on the prior as well."""


def summarize(forces: FilmForces) -> str:
    """Return speed, power, and how well the chain holds.

    Args:
        forces: The figures.
    """
    speed = forces.figures["speed"]
    power = forces.figures["mechanical_power"]
    fit = forces.fit
    return (
        f"{fit.robot.name} swims at {write_interval(speed)}; its joints deliver "
        f"{write_interval(power)} (medians and 95 % intervals). The points are "
        f"{1e3 * float(np.median(fit.noise)):.2g} mm from the fitted chain (median of their noise), "
        f"{share_of_misfit(forces):.1%} of the body's length."
    )


def write_interval(figure: Estimate) -> str:
    """Return a figure with its interval.

    Args:
        figure: The figure.
    """
    median = f"{figure.median:.3g}"
    if figure.unit:
        median += f" {figure.unit}"
    return f"{median} ({figure.low:.3g} to {figure.high:.3g})"


def list_remarks(forces: FilmForces) -> list[str]:
    """Return what a reader of the figures should know, a sentence each.

    Args:
        forces: The figures.
    """
    fit = forces.fit
    n_frames, n_points = fit.membership.shape
    remarks = [_describe_window(forces)]
    least = 1e3 * min(fit.noise)
    greatest = 1e3 * max(fit.noise)
    remarks.append(
        f"{n_points} points in {n_frames} frames; noise of {least:.2g} to {greatest:.2g} mm; "
        f"{fit.n_outliers} places belong elsewhere and do not count."
    )
    if fit.noise_correlation > 0.0:
        remarks.append(
            f"Noise of consecutive frames is correlated ({fit.noise_correlation:.2f}): "
            f"the film's part of all intervals was widened {fit.widening:.2g} times."
        )
    if n_points < FEW_POINTS * fit.robot.n_links:
        remarks.append(
            f"{n_points} points for {fit.robot.n_links} links: joint angles between them rest on the prior."
        )
    if not fit.has_settled:
        remarks.append(
            "The search for the smoothness of the motion stopped before it had quite settled: intervals of power may "
            "be off by some per cent."
        )
    remarks.append(_describe_water(forces))
    remarks += _describe_exact(forces)
    remarks.append(_describe_left_over(forces))
    if forces.window.n_cycles and forces.swims is not None:
        remarks.append(_describe_free_swim(forces))
    return remarks


def _describe_window(forces: FilmForces) -> str:
    window = forces.window
    span = f"{window.begin:.3g} to {window.end:.3g} s"
    if window.n_cycles == 0:
        return f"The motion does not repeat: the figures are means over {span}."
    frequency = f"{forces.fit.frequency:.3g} Hz"
    return f"The figures are means over {window.n_cycles} whole cycles of {frequency}, {span}."


def _describe_water(forces: FilmForces) -> str:
    assumptions = forces.assumptions
    water = assumptions.water.name
    if not assumptions.intervals:
        return f"The water `{water}` was taken as known."
    numbers = ", ".join(
        f"{name.removeprefix('water.')} {low:.3g} to {high:.3g}"
        for name, (low, high) in assumptions.intervals.items()
    )
    return f"The water `{water}` is known to its intervals alone: {numbers}."


def _describe_exact(forces: FilmForces) -> list[str]:
    """Return a sentence on what the intervals take for exact."""
    exact: list[str] = []
    if forces.assumptions.scale_deviation == 0.0:
        exact.append("the scale of the film (--scale-deviation)")
    if forces.assumptions.body_deviation == 0.0:
        exact.append("height and width of the body (--body-deviation)")
    if not exact:
        return []
    return [f"The intervals take for exact: {' and '.join(exact)}."]


def _describe_left_over(forces: FilmForces) -> str:
    figure = forces.figures["left_over"]
    share = forces.figures["left_over_share"]
    value = f"{figure.median:.3g} N ({figure.low:.3g} to {figure.high:.3g}), {share.median:.0%} of the thrust"
    if forces.explains:
        if share.high - share.low > WEAK_TEST:
            return (
                f"The film hardly tests the water: {value} are left over, anything from {share.low:.0%} to "
                f"{share.high:.0%} of it. Water that is known (--water), or a longer film, would tell more."
            )
        return f"The water explains the mean motion: {value} are left over; 0 lies in the interval."
    if abs(share.median) < SMALL_SHARE:
        return f"The water nearly explains the mean motion: {value} are left over."
    way = "brakes too much or pushes too little"
    if figure.median < 0.0:
        way = "pushes too much or brakes too little"
    return f"The water does not explain the mean motion: {value} are left over; it {way}."


def _describe_free_swim(forces: FilmForces) -> str:
    measured = forces.figures["speed"]
    model = forces.figures["model_speed"]
    agreement = "which holds"
    if not model.holds(measured.median):
        agreement = "which does not hold"
    return (
        f"With these joint angles and a free root the model swims at {write_interval(model)}, "
        f"{agreement} the {measured.median:.3g} m/s of the film."
    )
