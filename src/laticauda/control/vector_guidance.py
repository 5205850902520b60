"""Guidance of many robots at once: each law of `laticauda.control.guidance`, written for arrays.

Every formula is that of the law for one robot, in the same order, and elementary functions are those
of `math`: the results are the same to the last bit.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda.control.frames import PathFrame, PathFrames
from laticauda.control.guidance import ROUNDING, Guidance, HeadingController
from laticauda.scenarios import vectorize_alike
from laticauda.values import wrap_to_pi

Numbers = Float[np.ndarray, " n"]
FIRST_CAPACITY = 64
"""Headings for which a window has room at first."""


def apply(function: Callable[..., float], *arrays: Numbers) -> Numbers:
    """Apply a function of numbers to arrays, element by element.

    Args:
        function: A function of `math`: those of NumPy may round differently.
        arrays: Arrays of equal length.
    """
    columns = [array.tolist() for array in arrays]
    return np.array(list(map(function, *columns)))


class VectorGuidance(ABC):
    """Guidance laws of many robots, with the state of each. It is made for one run."""

    @abstractmethod
    def step(
        self,
        frames: PathFrames,
        heading: Float[np.ndarray, " n"],
        dt: Float[np.ndarray, " n"],
        is_saturated: Bool[np.ndarray, " n"],
    ) -> Float[np.ndarray, " n"]:
        """Return theta_ref of every robot, in world axes, within half a turn of its heading [rad].

        Args:
            frames: Positions relative to the paths.
            heading: Theta of the robots [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """


class LinesOfSight(VectorGuidance):
    """Line-of-sight guidance of many robots, with integral action.

    Args:
        look_ahead_distance: Delta of each robot [m].
        integral_gain: sigma of each robot [m/s]; 0: no integral action.
    """

    def __init__(self, look_ahead_distance: Numbers, integral_gain: Numbers) -> None:
        self._look_ahead_distance = look_ahead_distance
        self._integral_gain = integral_gain
        self._has_integral = bool(np.any(integral_gain))
        self._integral = np.zeros(look_ahead_distance.size)

    def step(
        self,
        frames: PathFrames,
        heading: Numbers,
        dt: Numbers,
        is_saturated: Bool[np.ndarray, " n"],
    ) -> Numbers:
        """Return theta_ref of every robot [rad].

        Args:
            frames: Positions relative to the paths.
            heading: Theta of the robots [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
        delta = self._look_ahead_distance
        error = frames.cross_track_error
        if self._has_integral:
            aim = error + self._integral_gain * self._integral
            squared_distance = aim * aim + delta * delta
            growth = dt * delta * error / squared_distance
            grown = self._integral + growth
            self._integral = np.where(is_saturated, self._integral, grown)
            error = error + self._integral_gain * self._integral
        approach = apply(math.atan, error / delta)
        turn = frames.path_tangential_angle - approach - heading
        return heading + wrap_to_pi(turn)


class GuidanceOneByOne(VectorGuidance):
    """Guidance laws that are written for one robot, called one after the other.

    Args:
        laws: One for each robot.
    """

    def __init__(self, laws: Sequence[Guidance[Any]]) -> None:
        self._laws = laws
        self._states = [law.init() for law in laws]

    def step(
        self,
        frames: PathFrames,
        heading: Numbers,
        dt: Numbers,
        is_saturated: Bool[np.ndarray, " n"],
    ) -> Numbers:
        """Return theta_ref of every robot [rad].

        Args:
            frames: Positions relative to the paths.
            heading: Theta of the robots [rad].
            dt: Time since the last call, 0 at the first [s].
            is_saturated: Whether the offset was at its limit during that time.
        """
        heading_ref = np.empty(heading.size)
        columns = zip(*(column.tolist() for column in frames), strict=True)
        for i, (law, numbers) in enumerate(zip(self._laws, columns, strict=True)):
            self._states[i], heading_ref[i] = law.step(
                self._states[i],
                PathFrame(*numbers),
                float(heading[i]),
                float(dt[i]),
                bool(is_saturated[i]),
            )
        return heading_ref


def vectorize_guidance(laws: Sequence[Guidance[Any]]) -> VectorGuidance:
    """Return one object that computes many laws of one class.

    Args:
        laws: One for each robot.
    """
    guidance = vectorize_alike(laws, "init", "step")
    if guidance is None:
        return GuidanceOneByOne(laws)
    return guidance


class HeadingControllers:
    """Heading controllers of many robots.

    Args:
        controllers: One for each robot.
    """

    def __init__(self, controllers: Sequence[HeadingController]) -> None:
        gains = [controller.gain for controller in controllers]
        max_offsets = [controller.max_offset for controller in controllers]
        self._gain = np.array(gains)
        self._max_offset = np.array(max_offsets)

    def offset(
        self, *, heading_ref: Numbers, heading: Numbers
    ) -> tuple[Numbers, Bool[np.ndarray, " n"]]:
        """Return the offset to command to each robot [rad], and whether it is at its limit.

        Args:
            heading_ref: theta_ref [rad].
            heading: theta [rad].
        """
        error = wrap_to_pi(heading_ref - heading)
        offset = self._gain * error
        is_saturated = np.abs(offset) > self._max_offset
        limited = np.clip(offset, -self._max_offset, self._max_offset)
        return limited, is_saturated


class HeadingEstimates:
    """Headings of many robots as means over their most recent time windows.

    Args:
        window: Averaging time of each robot; 0: no mean [s].
    """

    def __init__(self, window: Numbers) -> None:
        self._averaging = np.flatnonzero(window)
        """The robots whose headings are averaged; everything else is about these."""
        self._window = window[self._averaging]
        n = self._averaging.size
        self._time = np.empty((FIRST_CAPACITY, n))
        self._heading = np.empty((FIRST_CAPACITY, n))
        self._integral = np.empty((FIRST_CAPACITY, n))
        """Integral of the heading from the very first one [rad s]."""
        self._n_kept = 0
        self._first = np.zeros(n, dtype=int)
        """Row of the last heading at or before the start of each window."""
        self._robots = np.arange(n)

    def step(self, time: Numbers, heading: Numbers) -> Numbers:
        """Add a heading of every robot, and return the means [rad].

        Args:
            time: Time of the headings, later than the last one [s].
            heading: Theta, unwrapped [rad].
        """
        if self._averaging.size == 0:
            return heading
        means = heading.copy()
        means[self._averaging] = self._average(time[self._averaging], heading[self._averaging])
        return means

    def _average(self, time: Numbers, heading: Numbers) -> Numbers:
        """Add a heading of every robot whose headings are averaged, and return the means [rad]."""
        latest = self._n_kept
        if latest == 0:
            self._keep(time, heading, np.zeros(heading.size))
            return heading
        last_time = self._time[latest - 1]
        last_heading = self._heading[latest - 1]
        half_time = 0.5 * (time - last_time)
        integral = self._integral[latest - 1] + half_time * (last_heading + heading)
        first_time = self._time[self._first, self._robots]
        begin = np.maximum(time - self._window, first_time)
        self._move_windows(begin)
        self._keep(time, heading, integral)
        return self._mean_since(begin, time, integral)

    def _move_windows(self, begin: Numbers) -> None:
        """Let each window begin with the last heading that is not later than its start."""
        while True:
            following = np.minimum(self._first + 1, self._n_kept - 1)
            is_before = self._time[following, self._robots] <= begin + ROUNDING
            moves = is_before & (following > self._first)
            if not moves.any():
                return
            self._first += moves

    def _keep(self, time: Numbers, heading: Numbers, integral: Numbers) -> None:
        """Append a heading; if there is no room, first drop what no window needs."""
        if self._n_kept == len(self._time):
            self._make_room()
        self._time[self._n_kept] = time
        self._heading[self._n_kept] = heading
        self._integral[self._n_kept] = integral
        self._n_kept += 1

    def _make_room(self) -> None:
        n_dropped = int(self._first.min())
        self._n_kept -= n_dropped
        self._first = self._first - n_dropped
        self._time = self._moved(self._time, n_dropped)
        self._heading = self._moved(self._heading, n_dropped)
        self._integral = self._moved(self._integral, n_dropped)

    def _moved(self, rows: np.ndarray, n_dropped: int) -> np.ndarray:
        """Return rows without the first ones, and with room for as many more."""
        capacity = max(FIRST_CAPACITY, 2 * self._n_kept)
        moved = np.empty((capacity, self._robots.size))
        moved[: self._n_kept] = rows[n_dropped : n_dropped + self._n_kept]
        return moved

    def _mean_since(self, begin: Numbers, time: Numbers, integral: Numbers) -> Numbers:
        """Return the mean heading of each robot from `begin` to now."""
        first = self._first, self._robots
        second = self._first + 1, self._robots
        first_time = self._time[first]
        first_heading = self._heading[first]
        interval = self._time[second] - first_time
        share = (begin - first_time) / interval
        change = self._heading[second] - first_heading
        heading_at_begin = first_heading + share * change
        half_time = 0.5 * (begin - first_time)
        integral_at_begin = self._integral[first] + half_time * (first_heading + heading_at_begin)
        return (integral - integral_at_begin) / (time - begin)
