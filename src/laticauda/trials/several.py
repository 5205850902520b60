"""Several trials: compared side by side with their differences from the first, or two in a row joined into one."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from laticauda.motion import gaits
from laticauda.scenarios import Experiment, Scenario
from laticauda.trials.trial import Figure, Trial, shown_figures
from laticauda.values import BadArgument, angles, check_instance, concatenated

_OF_MEAN_POWER = ("mean_power", "cost_of_transport", "joules_per_meter")

ROUNDING = 1e-6
"""A reference value below this, in its SI unit, is only rounding error: no difference is given in percent of it."""
LARGEST_PERCENT = 1000.0
"""Percentages larger than this are not reported: the first value is then negligible compared with the other."""


@dataclass(frozen=True, kw_only=True)
class ComparedFigure:
    """One figure of several trials, side by side."""

    figure: Any
    """The `Figure`; typed Any because a field of the type `Figure` would be read as a property."""
    values: tuple[float | None, ...]
    """One value per trial, in the figure's unit; None where the figure has no meaning."""
    differences: tuple[float | None, ...]
    """Each value minus the first trial's, in the figure's unit, angles in [-pi, pi); None where either is None."""
    differences_percent: tuple[float | None, ...]
    """The differences in percent of the first value; None where that is meaningless: either value is None, the first is
    negligible (`ROUNDING`, `LARGEST_PERCENT`), or the figure is an angle."""


class Comparison(list[ComparedFigure]):
    """The figures of several trials side by side, one `ComparedFigure` each, and what must be known of them.

    Args:
        rows: The figures.
        notes: What else differs between the trials, and which of them failed, in a sentence each.
    """

    def __init__(self, rows: Iterable[ComparedFigure], notes: Sequence[str] = ()) -> None:
        super().__init__(rows)
        self.notes = tuple(notes)

    def __repr__(self) -> str:
        """Return the notes, and then one line for each figure."""
        lines = [*self.notes]
        for row in self:
            values = ", ".join("-" if value is None else f"{value:.4g}" for value in row.values)
            lines.append(f"{row.figure.name}: {values} {row.figure.unit}".rstrip())
        return "\n".join(lines)


def compare(*trials: Trial | Sequence[Trial]) -> Comparison:
    """Compare the figures of several trials side by side, with their differences from the first.

    A trial that failed has no figures: its values are None. The `notes` of the result say so, and in
    what else the trials differ: robot, gait, water or ground, and duration.

    Args:
        trials: At least two trials, the reference first; or a list of them.

    Returns:
        One row per figure that has a meaning for any of the trials, in the order of `FIGURES`; those
        through the water only if it moves. If
        only some of the trials have a power model, the figures based on `mean_power` are left out.

    Raises:
        ValueError: If there are fewer than two trials.
    """
    compared_trials = _flat(trials)
    if len(compared_trials) < 2:
        rule = "must hold at least 2 trials to compare"
        raise BadArgument("trials", f"{rule}, got {len(compared_trials)}")
    columns: list[dict[str, float | None]] = []
    for i, trial in enumerate(compared_trials):
        check_instance(f"trials[{i}]", trial, Trial)
        values_by_name, _ = trial.figures()
        columns.append(values_by_name)
    # Mechanical and electrical power differ by a factor of ten: side by side they would be
    # misleading.
    has_both_powers = len({trial.mean_power_kind for trial in compared_trials}) > 1
    rows: list[ComparedFigure] = []
    for figure in shown_figures(*compared_trials):
        # Of some trials, no figure of loads is known.
        values = tuple(column.get(figure.name) for column in columns)
        is_misleading = has_both_powers and figure.name in _OF_MEAN_POWER
        if not is_misleading and any(value is not None for value in values):
            rows.append(_compare_values(figure, values))
    names = [f"trial {i}" for i in range(len(compared_trials))]
    return Comparison(rows, note_differences(compared_trials, names))


def note_differences(trials: Sequence[Trial], names: Sequence[str]) -> list[str]:
    """Return what must be known before figures of trials are compared, in a sentence each.

    Args:
        trials: The trials, the reference first.
        names: Name of each trial.
    """
    notes: list[str] = []
    for trial, name in zip(trials, names, strict=True):
        if not trial.succeeded:
            notes.append(f"FAILED: {name} has no figures. {trial.status}")
    robots = [trial.robot for trial in trials]
    notes += _note_difference("robots", robots, [robot.name for robot in robots], names)
    gaits_of_trials = [trial.gait for trial in trials]
    descriptions = [_describe_gait(gait) for gait in gaits_of_trials]
    notes += _note_difference("gaits", gaits_of_trials, descriptions, names)
    surroundings = [trial.environment for trial in trials]
    labels = [environment.name for environment in surroundings]
    notes += _note_difference("surroundings", surroundings, labels, names)
    durations = [f"{trial.time[-1] - trial.time[0]:.4g} s" for trial in trials]
    notes += _note_difference("durations", durations, durations, names)
    return notes


def _note_difference(
    subject: str, parts: Sequence[object], descriptions: Sequence[str], names: Sequence[str]
) -> list[str]:
    """Return a note if some parts of trials differ, each described in words; none if all are equal."""
    if all(part == parts[0] for part in parts):
        return []
    if len(set(descriptions)) == 1:
        return [f"Different {subject}: each is {descriptions[0]}, but with other numbers."]
    pairs = zip(names, descriptions, strict=True)
    listed = [f"{name} {description}" for name, description in pairs]
    return [f"Different {subject}: {'; '.join(listed)}."]


def _describe_gait(gait: gaits.Gait | None) -> str:
    if gait is None:
        return "none"
    amplitude = math.degrees(gait.amplitude)
    frequency = math.degrees(gait.frequency)
    phase_shift = math.degrees(gait.phase_shift)
    return f"{gait.words} {amplitude:.4g} deg, {frequency:.4g} deg/s, {phase_shift:.4g} deg"


def _flat(trials: Sequence[Trial | Sequence[Trial]]) -> list[Trial]:
    """Return trials that may come alone or in lists, one after the other."""
    flat: list[Trial] = []
    for argument in trials:
        if isinstance(argument, Sequence):
            flat += argument
        else:
            flat.append(argument)
    return flat


def _compare_values(figure: Figure, values: tuple[float | None, ...]) -> ComparedFigure:
    """Compare the values of a figure with the first one."""
    first = values[0]
    if figure.unit == "rad":
        differences = tuple(_angle_between(first, value) for value in values)
        percentages: tuple[float | None, ...] = (None,) * len(values)
    else:
        differences = tuple(_difference(first, value) for value in values)
        percentages = tuple(_percent(difference, first) for difference in differences)
    return ComparedFigure(
        figure=figure,
        values=values,
        differences=differences,
        differences_percent=percentages,
    )


def _difference(first: float | None, value: float | None) -> float | None:
    if first is None or value is None:
        return None
    return value - first


def _angle_between(first: float | None, value: float | None) -> float | None:
    """Return the difference of two angles, in [-pi, pi) [rad]."""
    difference = _difference(first, value)
    if difference is None:
        return None
    return angles.wrap_to_pi(difference)


def _percent(difference: float | None, reference: float | None) -> float | None:
    if difference is None or reference is None or abs(reference) < ROUNDING:
        return None
    share = 100.0 * difference / abs(reference)
    if abs(share) > LARGEST_PERCENT:
        return None
    return share


# ---- joining -------------------------------------------------------------------------------------

_TOLERANCE = 1e-9
"""Of positions [m], angles [rad] and their rates where runs meet: a restart continues from the exact state."""
_CONTINUED = (
    "center_of_mass",
    "center_of_mass_velocity",
    "heading",
    "link_angle",
    "joint_angle",
    "joint_rate",
)


def joined(first: Trial, second: Trial) -> Trial:
    """Join two trials into one: `second` was restarted from the final state of `first`.

    The sample at which they meet is in both and is kept once. If the second run counted time or
    work from zero, they are shifted to continue the first. Settings and gait come from the first,
    status and final state from the second.

    Args:
        first: A run that reached its end.
        second: The run that continued from there.

    Raises:
        ValueError: If they differ in robot, gait, environment or what they log, or if the second
            does not begin where the first ends.
    """
    _check_belong(first, second)
    series = vars(concatenated((first, second.at(slice(1, None)))))
    # Where the runs meet, a signal has the value set by the second run, as at every other control
    # instant.
    signals = {
        name: np.concatenate((values[:-1], second.signals[name]))
        for name, values in first.signals.items()
    }
    counted = {
        "time": _counted_on(first.time, second.time),
        "work": _counted_on(first.work, second.work),
    }
    if first.electrical_work is not None and second.electrical_work is not None:
        counted["electrical_work"] = _counted_on(first.electrical_work, second.electrical_work)
    return replace(
        first,
        **{**series, **counted, "signals": signals},
        scenario=_scenario(first.scenario, second.scenario),
        status=second.status,
        succeeded=second.succeeded,
        state=second.state,
    )


def _scenario(first: Scenario | Experiment, second: Scenario | Experiment) -> Scenario | Experiment:
    """Return the scenario of one uncut run; a controller restarts at the cut, which no scenario can describe."""
    if isinstance(first, Scenario) and isinstance(second, Scenario):
        if isinstance(first.motion, gaits.Gait):
            return replace(first, duration=first.duration + second.duration)
    return Experiment(
        robot=first.robot, gait=first.gait, environment=first.environment, model=first.model
    )


def _check_belong(first: Trial, second: Trial) -> None:
    if not first.succeeded:
        raise ValueError(f"`first` must have reached its end, got a failed run: {first.status}")
    for name in ("robot", "gait", "environment"):
        if getattr(first, name) != getattr(second, name):
            raise BadArgument("second", f"must have the same `{name}` as `first`")
    # Files of older versions have forces on links without loads in joints; then the whole has none.
    lacks_loads = first.water_force is not None and second.water_force is None
    if lacks_loads or _Logged.of(first) != _Logged.of(second):
        raise BadArgument(
            "second",
            "must log the same as `first`, including electrical work, link forces and signals",
        )
    for name in _CONTINUED:
        gap = np.max(np.abs(getattr(second, name)[0] - getattr(first, name)[-1]), initial=0.0)
        if gap > _TOLERANCE:
            raise BadArgument(
                "second", f"must begin where `first` ends, but `{name}` jumps by {gap:.3g}"
            )


class _Logged(NamedTuple):
    """What a trial logs beside what every trial logs."""

    has_electrical_work: bool
    link_forces: set[str]
    signals: set[str]

    @classmethod
    def of(cls, trial: Trial) -> "_Logged":
        return cls(
            has_electrical_work=trial.electrical_work is not None,
            link_forces=set(trial.link_force or {}),
            signals=set(trial.signals),
        )


def _counted_on(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Append `second`, shifted only if it starts elsewhere: a shift by rounding error would change its last bits."""
    shift = first[-1] - second[0]
    continuation = second[1:]
    if np.any(shift):
        continuation = continuation + shift
    return np.concatenate((first, continuation))
