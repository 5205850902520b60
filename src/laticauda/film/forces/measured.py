"""Films as measurements, from which `laticauda.identify` finds coefficients of the water.

A fitted path is smooth: neighboring moments share their error. `identify` takes the noise of every number
as independent, so each moment gets the sum of the sizes of its covariances with all others as its variance.
This never says more than the film does, because that diagonal matrix minus the covariance is positive.
"""

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.film.chain import ChainFit, ChainMotion
from laticauda.film.forces.arguments import check_span
from laticauda.identify import Measurement
from laticauda.robot import Water
from laticauda.values import BadArgument, check_instance, check_whole_number

N_MOMENTS = 15
"""Moments of a glide that are measured."""
N_DRAWS = 400
"""Draws that stand for a covariance."""
LARGEST_BEND = 0.12
"""Root mean square of the joint angles of a straight glide, at most [rad]."""


def measure_glide(
    fit: ChainFit,
    water: Water,
    *,
    name: str = "glide",
    span: tuple[float, float] | None = None,
    n_moments: int = N_MOMENTS,
    seed: int = 0,
) -> Measurement:
    """Return a glide of the straight body as a measurement: its path, whose slowing tells the friction.

    Where it begins, how fast and in which direction is found by `identify` as well.

    Args:
        fit: The fitted film.
        water: Water whose coefficients begin the search; those that are not identified stay.
        name: Name of the measurement.
        span: Begin and end of the glide in the film; None: all of it [s].
        n_moments: Number of moments.
        seed: Seed of the draws.

    Raises:
        ValueError: If the body bends, or the span is not in the film.
    """
    check_instance("fit", fit, ChainFit)
    check_instance("water", water, Water)
    check_whole_number("n_moments", n_moments, 3, 200)
    check_whole_number("seed", seed, 0)
    begin = float(fit.model.time[0])
    end = float(fit.model.time[-1])
    if span is not None:
        check_span(span, fit.model.time)
        begin, end = span
    time = np.linspace(begin, end, n_moments)
    motion = fit.motion(time)
    bend = float(np.sqrt(np.mean(motion.joint_angle**2)))
    if bend > LARGEST_BEND:
        rule = f"must be of a straight body, its joints within {np.degrees(LARGEST_BEND):.0f} deg (rms)"
        raise BadArgument("fit", f"{rule}, got {np.degrees(bend):.0f} deg")
    draws = fit.draw(N_DRAWS, time, seed=seed)
    deviations = [_independent_deviation(draws.center_of_mass[..., axis]) for axis in (0, 1)]
    path_deviation = np.stack(deviations, axis=1)
    start = _start_of(motion)
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.0)
    scenario = lc.build_scenario(
        fit.robot, still, end - begin, environment=water, start=start, sample_interval=0.02
    )
    return Measurement(
        name=name,
        scenario=scenario,
        time=time - begin,
        series={
            "center_of_mass": (motion.center_of_mass, path_deviation),
            "heading": (motion.heading, _independent_deviation(draws.heading)),
        },
        assumed="The noise is that of the fit of a chain to a film, with its covariance in time.",
    )


def _start_of(motion: ChainMotion) -> lc.Start:
    """Return place, heading and speed at the first moment."""
    x, y = motion.center_of_mass[0]
    heading = float(motion.heading[0])
    ahead = np.array([np.cos(heading), np.sin(heading)])
    speed = float(motion.rates[0, :2] @ ahead)
    return lc.Start(center_of_mass=(float(x), float(y)), heading=heading, velocity=speed)


def _independent_deviation(
    draws: Float[np.ndarray, "n_draws n_moments"],
) -> Float[np.ndarray, " n_moments"]:
    """Return deviations of independent noise that says no more than correlated draws do."""
    covariance = np.cov(draws, rowvar=False)
    return np.sqrt(np.sum(np.abs(covariance), axis=1))
