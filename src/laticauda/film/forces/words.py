"""A filmed swim in words: what was found, what it rests on, and what the film says against the water."""

from laticauda.film.forces.estimates import Estimate
from laticauda.film.forces.inverse import FilmForces

SMALL_SHARE = 0.1
"""Force left over, by thrust, that a right water leaves, too."""
FEW_POINTS = 0.7
"""Points per link below which joint angles rest on the prior as well."""


def summarize(forces: FilmForces) -> str:
    """Return speed and power in a sentence.

    Args:
        forces: The figures.
    """
    speed, power = forces.figures["speed"], forces.figures["mechanical_power"]
    return (
        f"{forces.fit.robot.name} swims at {write_interval(speed)}; its joints deliver "
        f"{write_interval(power)} (medians and 95 % intervals)."
    )


def write_interval(figure: Estimate) -> str:
    """Return a figure with its interval.

    Args:
        figure: The figure.
    """
    unit = f" {figure.unit}" if figure.unit else ""
    return f"{figure.median:.3g}{unit} ({figure.low:.3g} to {figure.high:.3g})"


def list_remarks(forces: FilmForces) -> list[str]:
    """Return what a reader of the figures should know, a sentence each.

    Args:
        forces: The figures.
    """
    fit, window = forces.fit, forces.window
    n_frames, n_points = fit.membership.shape
    remarks = [_describe_window(forces)]
    least, greatest = 1e3 * min(fit.noise), 1e3 * max(fit.noise)
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
        remarks.append("The weights of the fit had not quite settled after its last step.")
    remarks.append(_describe_water(forces))
    remarks.append(_describe_left_over(forces))
    if window.n_cycles and forces.swims is not None:
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


def _describe_left_over(forces: FilmForces) -> str:
    figure, share = forces.figures["left_over"], forces.figures["left_over_share"]
    value = f"{figure.median:.3g} N ({figure.low:.3g} to {figure.high:.3g}), {share.median:.0%} of the thrust"
    if forces.explains:
        return (
            f"The water explains the mean motion: {value} are left over, none within the interval."
        )
    if abs(share.median) < SMALL_SHARE:
        return f"The water nearly explains the mean motion: {value} are left over."
    way = "brakes too much or pushes too little"
    if figure.median < 0.0:
        way = "pushes too much or brakes too little"
    return f"The water does not explain the mean motion: {value} are left over; it {way}."


def _describe_free_swim(forces: FilmForces) -> str:
    measured, model = forces.figures["speed"], forces.figures["model_speed"]
    agreement = "which holds"
    if not model.holds(measured.median):
        agreement = "which does not hold"
    return (
        f"With these joint angles and a free root the model swims at {write_interval(model)}, "
        f"{agreement} the {measured.median:.3g} m/s of the film."
    )
