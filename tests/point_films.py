"""Synthetic films of points on swimming robots, for tests."""

from dataclasses import dataclass

import numpy as np

import laticauda as lc
from laticauda.film import TrackedPoints
from laticauda.trials.markers import marker_places

SETTLING = 4.0
"""Time before the film begins, in which the robot gets up to speed [s]."""


@dataclass(frozen=True, kw_only=True)
class Film:
    """A film of points with the truth behind it."""

    points: TrackedPoints
    along: np.ndarray
    trial: lc.Trial
    """The swim, from `SETTLING` before the film on."""

    def truth(self, name: str) -> np.ndarray:
        """Return a series of the swim at the frames of the film."""
        begin = np.searchsorted(self.trial.time, SETTLING - 1e-9)
        return getattr(self.trial, name)[begin:]


def film_of(
    robot: lc.Robot,
    gait: lc.Gait,
    *,
    duration: float = 4.0,
    frame_rate: float = 60.0,
    n_points: int = 9,
    noise: float = 0.0,
    outliers: float = 0.0,
    lost: float = 0.0,
    seed: int = 0,
    **changes,
) -> Film:
    """Let a robot swim, and return places of points on its body as a tracker sees them, in m."""
    chance = np.random.default_rng(seed)
    trial = lc.swim(
        robot, gait, SETTLING + duration, dt=0.005, sample_interval=1.0 / frame_rate, **changes
    )
    along = np.linspace(0.04, 0.96, n_points) * robot.length
    filmed = trial.time >= SETTLING - 1e-9
    places = marker_places(trial, along.tolist())[filmed]
    places = places + noise * chance.standard_normal(places.shape)
    jumps = chance.random(places.shape[:2]) < outliers
    places[jumps] += 0.2 * robot.length * chance.standard_normal((jumps.sum(), 2))
    places[chance.random(places.shape[:2]) < lost] = np.nan
    points = TrackedPoints(
        time=trial.time[filmed] - SETTLING,
        names=tuple(f"point_{i}" for i in range(n_points)),
        position=places,
        likelihood=np.full(places.shape[:2], np.nan),
        unit="m",
    )
    return Film(points=points, along=along, trial=trial)
