"""What is measured before a run: joint zeros, marker body on its module, clocks, current at rest, stillness.

Each is a small value with `init` and `step`, or a function of what was collected.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.angles import wrap_to_pi
from laticauda.errors import LaticaudaError
from laticauda.quantities import quantity, value

Places = tuple[tuple[float, float, float, float], ...]


class CalibrationFailed(LaticaudaError, RuntimeError):
    """The robot or its instruments are not as the calibration needs them: it says what to do."""


def joint_zeros(angle: Float[np.ndarray, "n_samples n_joints"], *, largest: float) -> Float[np.ndarray, " n_joints"]:
    """What every joint reports while the robot lies straight: the median of the samples.

    Args:
        angle: What the limp joints reported [rad]; nan where one did not.
        largest: Beyond this, the robot was not straight [rad].

    Returns:
        The zeros [rad].

    Raises:
        CalibrationFailed: If a joint was not heard, or is further from zero.
    """
    if not np.isfinite(angle).any(axis=0).all():
        node = int(np.argmin(np.isfinite(angle).any(axis=0))) + 1
        raise CalibrationFailed(f"The joint zeros cannot be measured: module {node} did not report its angle.")
    zero = np.nanmedian(angle, axis=0)
    worst = int(np.argmax(np.abs(zero)))
    if abs(zero[worst]) > largest:
        raise CalibrationFailed(
            f"The joint zeros cannot be measured: module {worst + 1} reports {math.degrees(zero[worst]):.1f} deg, more "
            f"than {math.degrees(largest):.1f}; lay the robot straight against a ruler."
        )
    return zero


def marker_yaw(rotation: Float[np.ndarray, "n_samples 3 3"], *, heading: float) -> float:
    """The direction of the marker body to its module, from the straight robot.

    All links of a straight robot point the same way, so the module's direction is the robot's, which somebody knows:
    it lies along a wall, or along a rope.

    Args:
        rotation: From the marker body to the tank frame [-].
        heading: Of the straight robot, tank frame [rad].

    Returns:
        [rad], in [-pi, pi).

    Raises:
        CalibrationFailed: If there is no sample.
    """
    if not len(rotation):
        raise CalibrationFailed("The marker body cannot be calibrated: the motion capture did not see it.")
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    mean = math.atan2(float(np.mean(np.sin(yaw))), float(np.mean(np.cos(yaw))))
    return wrap_to_pi(mean - heading)


class ClockState(NamedTuple):
    """What is known of another clock: the smallest differences of this window of time and of the one before."""

    smallest: float
    """Since the window began, own clock minus the other [s]."""
    before: float
    """In the window before [s]."""
    began: float
    """The window, own clock [s]."""

    @property
    def offset(self) -> float:
        """Own clock minus the other, with the smallest latency in it [s]."""
        return min(self.smallest, self.before)


@value
class ClockOffset:
    """The difference of two clocks from the frames with the smallest latency.

    A frame is never early: own time of arrival minus its stamp is the offset plus a latency >= 0. The smallest one of
    the last seconds is the best estimate, and the smallest latency itself stays in it. What is older is forgotten:
    clocks drift, and the cameras' clock may jump, when their computer stalls or the measurement is begun anew.
    """

    window: float = quantity(
        "s", "a smallest latency counts for this long at least, and for twice as long at most", gt=0.0, default=5.0
    )

    def init(self) -> ClockState | None:
        """Nothing known."""
        return None

    def step(self, state: ClockState | None, arrival: float, stamp: float) -> ClockState:
        """What is known after one more frame.

        Args:
            state: As the last call returned it, or `init`.
            arrival: Of the frame, own clock [s].
            stamp: Of the frame, the other clock [s].
        """
        difference = arrival - stamp
        if state is None or arrival - state.began >= 2.0 * self.window:
            return ClockState(smallest=difference, before=difference, began=arrival)
        if arrival - state.began >= self.window:
            return ClockState(smallest=difference, before=state.smallest, began=arrival)
        return state._replace(smallest=min(state.smallest, difference))


@dataclass(frozen=True, kw_only=True)
class MeanCurrent:
    """A mean over the readings of a time: I_0 at rest, I_avg of a run."""

    total: float = 0.0
    """Sum [A]."""
    count: int = 0
    """Number of readings [-]."""

    def step(self, current: float) -> "MeanCurrent":
        """With one more reading of a `current` [A]."""
        return MeanCurrent(total=self.total + current, count=self.count + 1)

    @property
    def mean(self) -> float | None:
        """[A]; None without a reading."""
        return self.total / self.count if self.count else None


@value
class Stillness:
    """Whether something has been still for long enough."""

    speed: float = quantity("m/s", "slower than this is still", gt=0.0)
    rate: float = quantity("rad/s", "turning slower than this is still", gt=0.0)
    duration: float = quantity("s", "for how long it has to be", gt=0.0)

    def step(self, places: Places, now: float, x: float, y: float, heading: float) -> tuple[Places, bool]:
        """One more look. Means over two halves of the time are compared, so noise does not count as motion.

        Args:
            places: As the last call returned it; () at the start.
            now: [s].
            x: Of the center of mass [m].
            y: Likewise [m].
            heading: [rad].

        Returns:
            The places within the time, and whether it was still for all of it.
        """
        begin = now - self.duration
        places = (*(place for place in places if place[0] > begin - 1e-9), (now, x, y, heading))
        middle = now - 0.5 * self.duration
        early = [place for place in places if place[0] <= middle]
        late = [place for place in places if place[0] > middle]
        if places[0][0] > begin + 0.1 * self.duration or not early or not late:
            return places, False
        gone, *way = (
            sum(place[i] for place in late) / len(late) - sum(place[i] for place in early) / len(early)
            for i in range(4)
        )
        speed, rate = math.hypot(way[0], way[1]) / gone, way[2] / gone
        return places, speed <= self.speed and abs(rate) <= self.rate
