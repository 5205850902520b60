"""A film as a measurement for an identification: a path that is as certain as the film shows it."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from laticauda.film.tracking.body import BodyTrack
from laticauda.identify import Measurement, from_trial
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_positive

PATH = "center_of_mass"
"""Series that is measured."""


def measure_path(
    track: BodyTrack, trial: Trial, *, name: str = "film", interval: float = 0.25
) -> Measurement:
    """Return the path of a filmed trial as a measurement, with the deviation of every place.

    That is the noise from frame to frame, and the scale of the film times the distance from the
    middle of the path. What the scale does to all places together is thus part of the intervals.

    Args:
        track: The body in every frame.
        trial: The trial that `build_trial` made of it.
        name: Name in tables and messages.
        interval: Time between the places that are used [s].

    Raises:
        ValueError: If one tag alone was seen, which does not show its own noise.
    """
    check_positive("interval", interval, "s")
    if not np.isfinite(track.center_deviation):
        rule = "must be of two tags at least: one does not show its own noise"
        raise BadArgument("track", rule)
    step = float(np.median(np.diff(trial.time)))
    stride = max(round(interval / step), 1)
    measurement = from_trial(trial, name=name, series={PATH: track.center_deviation}, every=stride)
    places, _ = measurement.series[PATH]
    sigma = deviations_of_places(places, track)
    return replace(measurement, series={PATH: (places, sigma)})


def deviations_of_places(
    places: Float[np.ndarray, "n_samples 2"], track: BodyTrack
) -> Float[np.ndarray, "n_samples 2"]:
    """Return the standard deviation of every coordinate of a path [m].

    Args:
        places: The path [m].
        track: The body, with what is known of its noise and of the camera.
    """
    by_scale = np.zeros_like(places)
    if track.calibration is not None:
        by_scale = track.calibration.scale_deviation * (places - places.mean(axis=0))
    return np.hypot(track.center_deviation, by_scale)
