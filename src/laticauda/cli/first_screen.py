"""The first screen of a run: who swam how, how fast, for what power, and whether the robot can do it.

A newcomer reads these lines first. The option --all prints the table of every figure instead (`report`).
"""

import textwrap

from laticauda.cli.report import describe_gait
from laticauda.cli.tables import WIDTH, format_digits, wrap_rows
from laticauda.robot import Ground
from laticauda.trials import (
    MeasuredTrial,
    Trial,
    describe_edge,
    describe_sweeping,
    following,
    measured_counterpart,
    water_moves,
)
from laticauda.trials.feasibility import describe_ability

DIGITS = 3
"""Significant digits of the figures: a measured speed has no more."""
MORE = "More: --all prints every figure, --plot run.png draws the run, --json is for programs."


def first_screen(trial: Trial, basis: str = "", more: str = MORE) -> str:
    """Return the lines about a run that a newcomer reads first.

    Args:
        trial: Any trial, including a failed one.
        basis: What its coefficients rest on, in sentences; "" if that is not known.
        more: What else can be asked for, in a sentence.
    """
    measured = measured_counterpart(trial)
    lines = [*describe_who(trial), ""]
    if not trial.succeeded:
        rows = [("FAILED", trial.status)]
        return "\n".join([*lines, wrap_rows(rows)])
    rows = [
        ("speed", _describe_speed(trial, measured)),
        ("", describe_sweeping(trial)),
        ("", describe_edge(trial)),
        ("power", _describe_power(trial, measured)),
    ]
    rows = [(name, text) for name, text in rows if text]
    rows += describe_joints(trial, measured)
    if trial.joint_force is not None:
        rows.append(("loads", _describe_loads(trial)))
    if "cross_track_error" in trial.signals:
        rows.append(("path", _describe_following(trial)))
    notes = [note for note in (basis, _note_on_measurement(trial, measured), more) if note]
    wrapped_notes = [textwrap.fill(note, WIDTH) for note in notes]
    return "\n".join([*lines, wrap_rows(rows), "", *wrapped_notes])


def describe_who(trial: Trial) -> list[str]:
    """Return who swam how long in what, and how, in a line each.

    Args:
        trial: Any trial.
    """
    duration = trial.time[-1] - trial.time[0]
    kind = "ground" if isinstance(trial.environment, Ground) else "water"
    who = f"{trial.robot.name}, {duration:.4g} s, {kind} {trial.environment.name}"
    how = f"gait {describe_gait(trial.gait)}".replace("_", " ")
    return [who, *textwrap.wrap(how, WIDTH)]


def _describe_speed(trial: Trial, measured: MeasuredTrial | None) -> str:
    speed = f"{format_digits(trial.forward_velocity, DIGITS)} m/s"
    if water_moves(trial.environment):
        through_water = format_digits(trial.speed_through_water, DIGITS)
        return f"{speed} over ground, {through_water} m/s through the water"
    if measured is None or measured.forward_velocity is None:
        return speed
    return f"{speed} (tank {format_digits(measured.forward_velocity, DIGITS)})"


def _describe_power(trial: Trial, measured: MeasuredTrial | None) -> str:
    figures, _ = trial.figures()
    mean_power = figures["mean_power"]
    if mean_power is None:
        return "not measured"
    kind = trial.mean_power_kind
    power = f"{format_digits(mean_power, DIGITS)} W {kind}"
    if measured is None or measured.mean_power is None:
        return power
    in_tank = format_digits(measured.mean_power, DIGITS)
    if kind == "electrical":
        return f"{power} (tank {in_tank})"
    return f"{power} (tank {in_tank} electrical, most of it lost in servos)"


def describe_joints(trial: Trial, measured: MeasuredTrial | None) -> list[tuple[str, str]]:
    """Return rows on whether the robot can do it, and what follows if it cannot.

    Args:
        trial: Any trial.
        measured: Measurement beside it; None: there is none.
    """
    if "joint_angle" in trial.not_measured:
        return []
    rows = [("joints", describe_ability(trial.chain, trial.feasibility))]
    if trial.feasibility.problems:
        rows.append(("", _consequence(trial, measured)))
    return rows


def _describe_loads(trial: Trial) -> str:
    """Return the largest loads that a joint carries, of a trial that has loads."""
    moment = format_digits(trial.peak_bending_moment, DIGITS)
    shear = format_digits(trial.peak_shear_force, DIGITS)
    axial = format_digits(trial.peak_axial_force, DIGITS)
    return f"a joint carries up to {moment} N m of bending, {shear} N of shear, {axial} N of axial force"


def _consequence(trial: Trial, measured: MeasuredTrial | None) -> str:
    if measured is not None and measured.forward_velocity is not None:
        return (
            "But the robot swam this gait in the tank. So these coefficients or the data of its servo ask too "
            "much; speed and power hold for joints that follow the gait exactly."
        )
    return (
        "So the robot would swim more slowly than this: speed and power hold for joints that follow the gait "
        "exactly. --joints servo lets them lag as its servo would."
    )


def _describe_following(trial: Trial) -> str:
    figures = following.summarize_following(trial)
    time, distance = figures["convergence_time"], figures["convergence_distance"]
    if time is None or distance is None:
        return f"not reached: the mean error did not stay within {following.TOLERANCE:g} m"
    reached_at = f"{format_digits(time, DIGITS)} s and {format_digits(distance, DIGITS)} m"
    return f"reached after {reached_at}, to within {following.TOLERANCE:g} m"


def _note_on_measurement(trial: Trial, measured: MeasuredTrial | None) -> str:
    if measured is None:
        return ""
    text = f"Tank: {measured.about}."
    if abs(trial.duration - measured.duration) > 0.5:
        text += f" This run: {trial.duration:.4g} s."
    return text
