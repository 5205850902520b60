"""Markers on the body: their positions according to a trial, compared with those seen by cameras."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Complex, Float

from laticauda.robot import kinematics
from laticauda.trials.trial import Trial
from laticauda.values import BadArgument, TrialFileError, read_columns

Places = Float[np.ndarray, "n_samples n_markers 2"]
ComplexPlaces = Complex[np.ndarray, "n_times n_markers"]
AS_COMPLEX = (1.0, 1.0j)
"""Turns x and y, the last axis of places, into x + i y."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Track:
    """Observed positions of markers."""

    time: Float[np.ndarray, " n_samples"]
    """Time since the start of the run [s]."""
    place: Places
    """Position of every marker, in the axes of the cameras; nan where one was not seen [m]."""

    @classmethod
    def read(cls, path: str | Path) -> "Track":
        """Read a track from a CSV file: `time_s`, and `NAME_x_m` and `NAME_y_m` of every marker, in column order.

        Args:
            path: Path of the file.

        Raises:
            TrialFileError: If the file cannot be read, or anything in it is wrong.
        """
        columns = read_columns(path, TrialFileError)
        names = [name.removesuffix("_x_m") for name in columns if name.endswith("_x_m")]
        try:
            series = [_numbers(columns["time_s"])]
            for name in names:
                series.append(_numbers(columns[f"{name}_x_m"]))
                series.append(_numbers(columns[f"{name}_y_m"]))
            table = np.array(series).T
            return cls(time=table[:, 0], place=table[:, 1:].reshape(len(table), -1, 2))
        except (KeyError, ValueError) as error:
            raise TrialFileError(
                f"{path}: must have columns `time_s`, `NAME_x_m`, `NAME_y_m`: {error}"
            ) from None


def _numbers(cells: Sequence[str]) -> list[float]:
    """Return the numbers in the cells of a column; nan where a cell is empty."""
    return [float(cell or "nan") for cell in cells]


def marker_places(trial: Trial, along: Sequence[float]) -> Places:
    """Compute the positions of markers at the samples of a trial.

    Args:
        trial: Trial of a robot whose body lies in the plane.
        along: Distance of each marker from the tail end along the straight body [m].
    """
    robot = trial.chain
    posture = kinematics.Posture(
        robot, trial.center_of_mass[:, :2], trial.link_angle, fin_angle=trial.fin_angle
    )
    begin = np.cumsum([0.0, *(module.length for module in robot.modules)])
    link = np.clip(np.searchsorted(begin, along, side="right") - 1, 0, robot.n_links - 1)
    angle = trial.link_angle[:, link]
    reach = np.asarray(along) - begin[link]
    direction = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    return posture.link_ends[:, link] + reach[:, np.newaxis] * direction


def marker_distance(
    trial: Trial, track: Track, along: Sequence[float], *, fitted: tuple[float, float]
) -> tuple[Float[np.ndarray, " n_times"], Float[np.ndarray, " n_times"]]:
    """Compute the distance between the markers of a trial and those of a track, after aligning the start of both.

    The trial is rotated and translated as a rigid body for the best fit (least squares) in a span
    of time. After that span, the remaining distances show where the trial swims elsewhere, turns
    differently, or bends into another shape.

    Args:
        trial: The trial, for instance a simulated one.
        track: The observed track.
        along: Distance of each marker from the tail end along the straight body [m].
        fitted: The span of time used for the fit [s].

    Returns:
        The times of the track within the trial [s], and the root mean square distance at these
        times [m].

    Raises:
        ValueError: If the track has a different number of markers, or none in the span.
    """
    n_markers = track.place.shape[1]
    if n_markers != len(along):
        rule = f"must have one distance per marker, {n_markers}"
        raise BadArgument("along", f"{rule}, got {len(along)}")
    is_in_trial = (track.time >= trial.time[0]) & (track.time <= trial.time[-1])
    time = track.time[is_in_trial]
    observed = track.place[is_in_trial]
    coordinates = marker_places(trial, along).reshape(trial.time.size, -1)
    resampled = [np.interp(time, trial.time, coordinate) for coordinate in coordinates.T]
    computed = np.stack(resampled, axis=1).reshape(observed.shape)
    begin, end = fitted
    is_in_span = (time >= begin) & (time <= end)
    counts = is_in_span[:, np.newaxis] & np.isfinite(observed).all(axis=-1)
    if not counts.any():
        raise BadArgument("fitted", f"must be a span in which markers were seen, got {fitted}")
    aligned = _aligned(computed @ AS_COMPLEX, observed @ AS_COMPLEX, counts)
    gap = np.abs(aligned - observed @ AS_COMPLEX)
    return time, np.sqrt(np.nanmean(gap**2, axis=1))


def _aligned(
    computed: ComplexPlaces, observed: ComplexPlaces, counts: Bool[np.ndarray, "n_times n_markers"]
) -> ComplexPlaces:
    """Return places rotated and translated for the best fit to the observed ones that count [m]."""
    computed_mean = computed[counts].mean()
    observed_mean = observed[counts].mean()
    covariance = (observed[counts] - observed_mean) * (computed[counts] - computed_mean).conj()
    turn = np.exp(1j * np.angle(covariance.sum()))
    return (computed - computed_mean) * turn + observed_mean
