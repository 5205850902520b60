"""What was measured and published, to stand beside a run of the same setting; whoever has such numbers adds a class.

An installed package offers its trials as an entry point of the group ``laticauda.measured_trials``.
"""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from laticauda import extensions, gaits
from laticauda.robot import Environment, Robot
from laticauda.trial.trial import Trial


@dataclass(frozen=True, kw_only=True)
class MeasuredTrial:
    """One setting that was measured, without steering."""

    gait: gaits.Gait
    """What the joints were asked for."""
    robot: str
    """The robot's name (`laticauda.load_robot`)."""
    has_fin: bool
    """Whether it wore the caudal fin."""
    forward_velocity: float | None
    """Equation (5); None where it was not available [m/s]."""
    mean_power: float | None
    """Electrical power above idle (4), not comparable with a mechanical power; None if not available [W]."""
    is_maximum: bool = False
    """Whether it was published as the fastest of a sweep, so that its speed is biased upward by selection."""
    duration: float
    """Of the trial, from rest [s]."""
    source: str
    """Where it was published, in a word or two."""
    about: str
    """What swam where, and what one has to know of the numbers, in a sentence without its full stop."""


class MeasuredTrials(extensions.Extensible, group="measured_trials"):
    """Base of published measurements."""

    @abstractmethod
    def trials(self) -> Sequence[MeasuredTrial]:
        """All of them; settings that were published without a number too."""

    @abstractmethod
    def counterpart(self, robot: Robot, gait: gaits.Gait, environment: Environment) -> MeasuredTrial | None:
        """What was measured in this very setting, or None.

        Args:
            robot: What swims.
            gait: How, without steering.
            environment: In what.
        """


def all_measured() -> list[MeasuredTrials]:
    """All published measurements that are installed."""
    return [MeasuredTrials.named(name)() for name in MeasuredTrials.names()]


def measured_setting(robot: Robot, gait: gaits.Gait | None, environment: Environment) -> MeasuredTrial | None:
    """What was measured in a setting, or None.

    Args:
        robot: What swims.
        gait: How, without steering; None has no counterpart.
        environment: In what.
    """
    if gait is None:
        return None
    found = (one.counterpart(robot, gait, environment) for one in all_measured())
    return next((trial for trial in found if trial is not None), None)


def measured_counterpart(trial: Trial) -> MeasuredTrial | None:
    """What was measured in the setting of a run, or None.

    Args:
        trial: A run.
    """
    return measured_setting(trial.robot, trial.gait, trial.environment)
