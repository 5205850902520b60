"""Measured or computed joint angles over time: a motion not described by a wave."""

import itertools
import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits.angle_tables import read_angles
from laticauda.motion.gaits.reference import between_knots
from laticauda.values import BadArgument, Log, option, quantity, value_class

ZERO_PADDING = 32
"""Factor by which zeros lengthen the angles, for frequencies between those of whole cycles."""


@value_class
class JointAngles:
    """Angles of the yaw joints at given times, joined by a cubic spline with continuous second derivatives.

    Before the first and after the last time, the angles are held; the spline starts and ends at
    rest.

    Raises:
        ValueError: If the times do not increase, or the number of angles of a joint differs from
            the number of times.
    """

    time: tuple[float, ...] = quantity("s", "Times since the start of the run, increasing")
    angle: tuple[tuple[float, ...], ...] = quantity(
        "rad", "Angle of every yaw joint, tail first, at these times"
    )
    reading: str = option(
        "What was read of a file, in one line: rows, span, and what was not taken as it is written",
        default="",
        is_compared=False,
    )

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        increases = all(later > earlier for earlier, later in itertools.pairwise(self.time))
        if len(self.time) < 2 or not increases:
            raise BadArgument("time", "must be at least two increasing times")
        for i, angles in enumerate(self.angle):
            if len(angles) != len(self.time):
                rule = f"must have one angle per time, {len(self.time)}, got {len(angles)}"
                raise BadArgument(f"angle[{i}]", rule)

    @staticmethod
    def former(table: Mapping[str, Any]) -> dict[str, Any]:
        """Convert a `table` of a file whose angles may be in degrees, as `angle_deg`.

        Args:
            table: Table from the file.
        """
        new = dict(table)
        if "angle" not in new and isinstance(new.get("angle_deg"), list):
            new["angle"] = np.radians(np.array(new.pop("angle_deg"), dtype=float)).tolist()
        return new

    @classmethod
    def read(cls, path: str | Path, columns: Mapping[str, str] | None = None) -> "JointAngles":
        """Read the angles in a table, see `laticauda.motion.gaits.angle_tables`.

        The file has a column of times (`time_s`) and one per yaw joint, where `joint_1_deg` (or
        `joint_1_rad`) is the tail-most; other columns, and lines that begin with #, are ignored.
        Time counts from the first row.

        Args:
            path: Path of the file.
            columns: Names in the file by ours, for columns that it calls otherwise, such as
                ``{"time": "t [s]", "joint_{}_deg": "JointAngle{}"}``.

        Warns:
            TableWarning: If times or angles were not taken as they are written.

        Raises:
            TrialFileError: If the file cannot be read or is invalid.
        """
        recording = read_angles(path, columns)
        return cls(
            time=tuple(recording.time.tolist()),
            angle=_rows(recording.angle),
            reading=recording.reading,
        )

    @classmethod
    def of(cls, log: Log) -> "JointAngles":
        """Return the joint angles of a simulated or measured trial.

        Args:
            log: The trial.
        """
        time = log.time - log.time[0]
        return cls(time=tuple(time.tolist()), angle=_rows(log.joint_angle.T))

    @property
    def frequency(self) -> float:
        """Angular frequency of the strongest oscillation of all joints together; 0 if none moves [rad/s]."""
        start = self.time[0]
        stop = self.time[-1]
        n_samples = 2 * len(self.time)
        n_padded = ZERO_PADDING * n_samples
        even_time = np.linspace(start, stop, n_samples)
        swings = np.array(
            [np.interp(even_time, self.time, angles) - np.mean(angles) for angles in self.angle]
        )
        spectrum = np.fft.rfft(swings * np.hanning(n_samples), n_padded)
        power = np.sum(np.abs(spectrum) ** 2, axis=0)
        strongest = int(np.argmax(power))
        return 2.0 * math.pi * strongest * (n_samples - 1) / (stop - start) / n_padded

    @cached_property
    def knots(self) -> Float[np.ndarray, "n_knots n_numbers"]:
        """Input of the kernels: time [s], then angle [rad] and rate [rad/s] of every joint."""
        angle = np.array(self.angle).T
        rates = _clamped_rates(np.array(self.time), angle)
        angle_beside_rate = np.stack((angle, rates), axis=2).reshape(len(angle), -1)
        return np.column_stack((self.time, angle_beside_rate))

    def scaled(
        self, shares: Float[np.ndarray, " n_joints"]
    ) -> Float[np.ndarray, "n_knots n_numbers"]:
        """Return the knots with the angles of every joint scaled.

        Args:
            shares: Fraction of its angles that every yaw joint reaches, tail first [-].

        Raises:
            ValueError: If the number of joints differs.
        """
        if len(self.angle) != shares.size:
            rule = f"must have angles of all {shares.size} yaw joints, got {len(self.angle)}"
            raise BadArgument("recorded", rule)
        return self.knots * np.concatenate(([1.0], np.repeat(shares, 2)))

    def at(self, time: float) -> Float[np.ndarray, "3 n_joints"]:
        """Return angle [rad], rate [rad/s] and acceleration [rad/s^2] of every joint, tail first.

        Args:
            time: Time since the start of the run [s].
        """
        last_knot = int(np.searchsorted(self.time, time, side="right")) - 1
        knot = min(max(last_knot, 0), len(self.time) - 2)
        (begin, *numbers_at_begin), (end, *numbers_at_end) = self.knots[knot : knot + 2].tolist()
        joints = zip(
            numbers_at_begin[::2],
            numbers_at_begin[1::2],
            numbers_at_end[::2],
            numbers_at_end[1::2],
            strict=True,
        )
        return np.array([between_knots(time, begin, end, *numbers) for numbers in joints]).T


def _rows(table: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, table.tolist()))


def _clamped_rates(
    time: Float[np.ndarray, " n"], angle: Float[np.ndarray, "n n_joints"]
) -> Float[np.ndarray, "n n_joints"]:
    """Solve the tridiagonal system for the rates at the knots of the cubic spline that starts and ends at rest."""
    step = np.diff(time)[:, np.newaxis]
    pull = 3.0 * np.diff(angle, axis=0) / step**2
    rate = np.zeros_like(angle)
    passed = np.zeros_like(time)
    for i in range(1, time.size - 1):
        before = 1.0 / step[i - 1, 0]
        after = 1.0 / step[i, 0]
        pivot = 2.0 * (before + after) - before * passed[i - 1]
        passed[i] = after / pivot
        rate[i] = (pull[i - 1] + pull[i] - before * rate[i - 1]) / pivot
    for i in range(time.size - 2, 0, -1):
        rate[i] -= passed[i] * rate[i + 1]
    return rate
