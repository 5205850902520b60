"""A stored trial that is played back on the page."""

from dataclasses import replace

import numpy as np

from laticauda.robot import Robot
from laticauda.trials import Trial
from laticauda.values import series


class Ghost:
    """A stored trial that is played back in a loop.

    Args:
        trial: The trial.

    Raises:
        ValueError: If the trial does not contain the robot's posture.
    """

    def __init__(self, trial: Trial) -> None:
        trial.need("a picture of the robot", "joint_angle", "heading", "link_angle")
        n_axes = trial.center_of_mass.shape[1]
        self.shift = np.zeros(n_axes)
        """Offset of the ghost from its recorded position [m]."""
        self.robot: Robot = trial.chain
        self._trial = trial
        if n_axes == 3 and "orientation_w" not in trial.signals:
            raise ValueError("The trial must hold the robot's orientation in space to be shown.")

    def move(self, position: np.ndarray) -> None:
        """Shift the ghost so that it begins at a given position [m]."""
        self.shift[:2] = position[:2] - self._trial.center_of_mass[0, :2]

    def sample(self, time: float) -> series.Log:
        """Return the sample at a time since the beginning [s]; after its end, the trial repeats."""
        trial = self._trial
        time_in_trial = 0.0
        begin = float(trial.time[0])
        duration = float(trial.time[-1]) - begin  # a run that failed has one, too
        if duration > 0.0:
            time_in_trial = time % duration
        next_sample: int = np.searchsorted(trial.time, begin + time_in_trial).item()
        last_sample = trial.time.size - 1
        sample = trial.at(min(next_sample, last_sample))
        return replace(sample, center_of_mass=sample.center_of_mass + self.shift)
