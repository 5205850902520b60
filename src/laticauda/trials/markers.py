"""Markers on the body: their positions according to a trial, compared with those seen by cameras."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from laticauda.robot import kinematics
from laticauda.trials.trial import Trial
from laticauda.values import files
from laticauda.values.errors import BadArgument, TrialFileError

Places = Float[np.ndarray, "n_samples n_markers 2"]


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
        columns = files.read_columns(path, TrialFileError)
        names = [name.removesuffix("_x_m") for name in columns if name.endswith("_x_m")]
        wanted = ["time_s", *(f"{name}_{axis}_m" for name in names for axis in "xy")]
        try:
            table = np.array(
                [[float(cell or "nan") for cell in columns[name]] for name in wanted]
            ).T
            return cls(time=table[:, 0], place=table[:, 1:].reshape(len(table), -1, 2))
        except (KeyError, ValueError) as error:
            raise TrialFileError(
                f"{path}: must have columns `time_s`, `NAME_x_m`, `NAME_y_m`: {error}"
            ) from None


def marker_places(trial: Trial, along: Sequence[float]) -> Places:
    """Compute the positions of markers at the samples of a trial.

    Args:
        trial: Trial of a robot whose body lies in the plane.
        along: Distance of each marker from the tail end along the straight body [m].
    """
    robot = trial.chain
    ends = kinematics.Posture(
        robot, trial.center_of_mass[:, :2], trial.link_angle, fin_angle=trial.fin_angle
    ).link_ends
    begin = np.cumsum([0.0, *(module.length for module in robot.modules)])
    link = np.clip(np.searchsorted(begin, along, side="right") - 1, 0, robot.n_links - 1)
    angle = trial.link_angle[:, link]
    reach = np.asarray(along) - begin[link]
    return ends[:, link] + reach[:, np.newaxis] * np.stack((np.cos(angle), np.sin(angle)), axis=-1)


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
    if track.place.shape[1] != len(along):
        raise BadArgument(
            "along", f"must have one distance per marker, {track.place.shape[1]}, got {len(along)}"
        )
    within = (track.time >= trial.time[0]) & (track.time <= trial.time[-1])
    time, seen = track.time[within], track.place[within]
    flat = marker_places(trial, along).reshape(trial.time.size, -1)
    here = np.stack([np.interp(time, trial.time, column) for column in flat.T], axis=1).reshape(
        seen.shape
    )
    known = (time >= fitted[0]) & (time <= fitted[1])
    known = known[:, np.newaxis] & np.isfinite(seen).all(axis=-1)
    if not known.any():
        raise BadArgument("fitted", f"must be a span in which markers were seen, got {fitted}")
    a, b = here[known] @ (1.0, 1.0j), seen[known] @ (1.0, 1.0j)
    turn = np.exp(1j * np.angle(((b - b.mean()) * (a - a.mean()).conj()).sum()))
    gap = np.abs((here @ (1.0, 1.0j) - a.mean()) * turn + b.mean() - seen @ (1.0, 1.0j))
    return time, np.sqrt(np.nanmean(gap**2, axis=1))
