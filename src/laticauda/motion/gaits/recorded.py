"""Measured or computed joint angles over time: a motion not described by a wave."""

import math
import re
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits.reference import between_knots
from laticauda.values import BadArgument, Log, TrialFileError, quantity, read_columns, value_class

JOINT = re.compile(r"joint_(\d+)(_deg|_rad)?")
"""Pattern for the names of angle columns; 1 is the tail-most joint."""


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

    def __post_init__(self) -> None:
        """Check the consistency of the fields."""
        if len(self.time) < 2 or any(
            b <= a for a, b in zip(self.time, self.time[1:], strict=False)
        ):
            raise BadArgument("time", "must be at least two increasing times")
        for i, one in enumerate(self.angle):
            if len(one) != len(self.time):
                rule = f"must have one angle per time, {len(self.time)}, got {len(one)}"
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
    def read(cls, path: str | Path) -> "JointAngles":
        """Read the angles in a CSV file.

        The file has a column of times (`time_s`) and one per yaw joint, where `joint_1_deg` (or
        `joint_1_rad`) is the tail-most; other columns, and lines that begin with #, are ignored.

        Args:
            path: Path of the file.

        Raises:
            TrialFileError: If the file cannot be read or is invalid.
        """
        columns = read_columns(path, TrialFileError)
        joints = sorted(
            (int(found[1]), name) for name in columns if (found := JOINT.fullmatch(name))
        )
        if "time_s" not in columns or [k for k, _ in joints] != list(
            range(1, max(len(joints), 1) + 1)
        ):
            rule = "a column `time_s` and columns `joint_1_deg`, `joint_2_deg`, ... starting at the tail"
            raise TrialFileError(f"{path}: must have {rule}, got {', '.join(columns)}")
        units = np.array(
            [[math.radians(1.0) if name.endswith("_deg") else 1.0] for _, name in joints]
        )
        try:
            time, *angles = (
                [float(cell) for cell in columns[name]]
                for name in ("time_s", *(j for _, j in joints))
            )
            return cls(time=tuple(time), angle=_rows(np.array(angles) * units))
        except ValueError as error:
            raise TrialFileError(f"{path}: {error}") from None

    @classmethod
    def of(cls, log: Log) -> "JointAngles":
        """Return the joint angles of a simulated or measured trial.

        Args:
            log: The trial.
        """
        return cls(time=tuple((log.time - log.time[0]).tolist()), angle=_rows(log.joint_angle.T))

    @property
    def frequency(self) -> float:
        """Angular frequency of the strongest oscillation of all joints together; 0 if none moves [rad/s]."""
        n = 2 * len(self.time)
        even = np.linspace(self.time[0], self.time[-1], n)
        swings = np.array(
            [np.interp(even, self.time, one) - np.mean(one) for one in self.angle]
        ) * np.hanning(n)
        power = np.sum(np.abs(np.fft.rfft(swings, 32 * n)) ** 2, axis=0)
        return (
            2.0
            * math.pi
            * int(np.argmax(power))
            * (n - 1)
            / (self.time[-1] - self.time[0])
            / (32 * n)
        )

    @cached_property
    def knots(self) -> Float[np.ndarray, "n_knots n_numbers"]:
        """Input of the kernels: time [s], then angle [rad] and rate [rad/s] of every joint."""
        angle = np.array(self.angle).T
        rates = _clamped_rates(np.array(self.time), angle)
        return np.column_stack(
            (self.time, np.stack((angle, rates), axis=2).reshape(len(angle), -1))
        )

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
            raise BadArgument(
                "recorded",
                f"must have angles of all {shares.size} yaw joints, got {len(self.angle)}",
            )
        return self.knots * np.concatenate(([1.0], np.repeat(shares, 2)))

    def at(self, time: float) -> Float[np.ndarray, "3 n_joints"]:
        """Return angle [rad], rate [rad/s] and acceleration [rad/s^2] of every joint, tail first.

        Args:
            time: Time since the start of the run [s].
        """
        k = int(np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, len(self.time) - 2))
        (t, *a), (end, *b) = self.knots[k : k + 2].tolist()
        joints = zip(a[::2], a[1::2], b[::2], b[1::2], strict=True)
        return np.array([between_knots(time, t, end, *numbers) for numbers in joints]).T


def _rows(table: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, table.tolist()))


def _clamped_rates(
    time: Float[np.ndarray, " n"], angle: Float[np.ndarray, "n n_joints"]
) -> Float[np.ndarray, "n n_joints"]:
    """Solve the tridiagonal system for the rates at the knots of the cubic spline that starts and ends at rest."""
    step = np.diff(time)[:, np.newaxis]
    pull = 3.0 * np.diff(angle, axis=0) / step**2
    rate, passed = np.zeros_like(angle), np.zeros_like(time)
    for i in range(1, time.size - 1):
        before, after = 1.0 / step[i - 1, 0], 1.0 / step[i, 0]
        pivot = 2.0 * (before + after) - before * passed[i - 1]
        passed[i] = after / pivot
        rate[i] = (pull[i - 1] + pull[i] - before * rate[i - 1]) / pivot
    for i in range(time.size - 2, 0, -1):
        rate[i] -= passed[i] * rate[i + 1]
    return rate
