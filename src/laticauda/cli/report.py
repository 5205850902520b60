"""A trial as readable text and as JSON: robot, environment, gait and run, with figures and measured values."""

import dataclasses
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from laticauda import scenarios
from laticauda.cli.tables import (
    WIDTH,
    align_columns,
    format_figure,
    format_number,
    format_percent,
    wrap_rows,
)
from laticauda.motion import gaits
from laticauda.robot import SEEN, TEXTBOOK, Ground, describe_coefficients, in_a_line
from laticauda.trials import (
    MOVING_WATER_NOTE,
    MeasuredTrial,
    Trial,
    describe_edge,
    describe_sweeping,
    following,
    measured_counterpart,
    shown_figures,
    water_moves,
)
from laticauda.values import describe_fields

LEFT_OUT = ("duration",)  # stated once, at the top


def facts_of_trial(trial: Trial) -> dict[str, Any]:
    """Return the trial's summary, the measured values and the settings of the run for JSON, in SI units."""
    facts: dict[str, Any] = {
        **trial.summary(),
        "not_measured": list(trial.not_measured),
        "infeasible": list(trial.feasibility.problems),
        "swept": describe_sweeping(trial),
        "outside_law": describe_edge(trial),
        "measured": _measured_facts(trial),
        "gait_parameters": _gait_parameters(trial),
        "certainty": SEEN if _is_of_textbook(trial) else None,
        "coefficients": _coefficients(trial),
        "settings": trial.settings,
        "version": trial.version,
    }
    if "cross_track_error" in trial.signals:
        facts["path_following"] = following.summarize_following(trial)
    return facts


def _measured_facts(trial: Trial) -> dict[str, Any] | None:
    measured = measured_counterpart(trial)
    if measured is None:
        return None
    return {
        "forward_velocity": measured.forward_velocity,
        "electrical_power": measured.mean_power,
    }


def _gait_parameters(trial: Trial) -> dict[str, Any] | None:
    if trial.gait is None:
        return None
    return dataclasses.asdict(trial.gait)


def _coefficients(trial: Trial) -> dict[str, Any]:
    coefficients = dataclasses.asdict(trial.environment)
    del coefficients["name"]
    return coefficients


def describe_trial(trial: Trial, origin: str = "") -> str:
    """Return a trial as a readable table, with angles in degrees.

    Args:
        trial: Any trial, including a failed one.
        origin: Source of the coefficients of water or ground, in words.
    """
    place = "ground" if isinstance(trial.environment, Ground) else "water"
    head = [
        ("robot", trial.robot.words),
        ("gait", describe_gait(trial.gait)),
        (place, _describe_environment(trial, origin)),
        ("run", _describe_run(trial)),
    ]
    if trial.settings.get("reading"):
        head.append(("read", str(trial.settings["reading"])))
    if "joint_angle" not in trial.not_measured and trial.succeeded:
        head.append(("joints", trial.feasibility.words))
    if trial.feasibility.problems:
        head.append(("WARNING", "; ".join(trial.feasibility.problems)))
    if not trial.succeeded:
        head.append(("FAILED", trial.status))
    parts = [wrap_rows(head), figure_table(trial), _notes(trial)]
    return "\n\n".join(filter(None, parts))


def following_table(trial: Trial) -> str:
    """Return a table of how soon and how well a run converged to its path, one figure per line."""
    values = following.summarize_following(trial)
    rows = [("path following", "", "")]
    for name, (unit, title) in following.FIGURES.items():
        if "height" in name and values[name] is None:  # a path in the plane
            continue
        figure = format_figure(values[name], unit)
        rows.append((title, figure.number, figure.unit))
    return align_columns(rows, right=(1,))


def figure_table(trial: Trial) -> str:
    """Return a table of the figures that apply to this run, with measured values and differences where available."""
    summary, measured = trial.summary(), _measured_figures(trial)
    heads = ("", "simulated", "", "measured", "difference")
    if _is_measured(trial):
        heads = ("", "measured", "", "the paper's", "difference")
    # The power that `mean_power` stands for need not be listed twice.
    left_out = (*LEFT_OUT, f"{trial.mean_power_kind}_power")
    rows: list[tuple[str, ...]] = [heads]
    for figure in shown_figures(trial):
        value: Any = summary[figure.name]
        reference = measured.get(figure.name)
        if figure.name in left_out or (value is None and reference is None):
            continue
        title = figure.title
        if figure.name == "mean_power":
            title = f"mean power ({trial.mean_power_kind})"
        number, unit = format_figure(value, figure.unit)
        rows.append((title, number, unit, *_compare(value, reference)))
    if len(rows) == 1:
        return ""
    if not measured:
        return align_columns([row[:3] for row in rows], right=(1,))
    return align_columns(rows, right=(1, 3, 4))


def _compare(value: float | None, reference: float | None) -> tuple[str, str]:
    """Return a reference and the difference from it, as a table shows them."""
    if reference is None:
        return "", ""
    if value is None:
        return format_number(reference), format_percent(None)
    difference = 100.0 * (value - reference) / reference
    return format_number(reference), format_percent(difference)


def _measured_figures(trial: Trial) -> dict[str, float]:
    """Return the paper's measured values by the names of the figures; its power is electrical."""
    measured = measured_counterpart(trial)
    if measured is None:
        return {}
    power = "electrical_power"
    if trial.mean_power_kind == "electrical":
        power = "mean_power"
    figures: dict[str, float] = {}
    if measured.forward_velocity is not None:
        figures["forward_velocity"] = measured.forward_velocity
    if measured.mean_power is not None:
        figures[power] = measured.mean_power
    return figures


def _notes(trial: Trial) -> str:
    """Return notes on the figures: what was measured, and why figures are missing."""
    notes: list[str] = []
    measured = measured_counterpart(trial)
    if measured is not None:
        notes.append(_note_on_measurement(measured, trial))
    if trial.succeeded:  # otherwise its status says more
        if water_moves(trial.environment):
            notes += filter(None, [MOVING_WATER_NOTE, describe_sweeping(trial)])
        if _is_of_textbook(trial):
            notes.append(_note_on_textbook())
        notes += filter(None, [describe_edge(trial)])
        notes += _notes_on_missing_figures(trial)
    return wrap_notes(notes)


def _note_on_textbook() -> str:
    errors = ", ".join(
        f"{kind} {100.0 * low:+.0f} to {100.0 * high:+.0f} %" for kind, (low, high) in SEEN.items()
    )
    return (
        f"Textbook water, nothing fitted. AmphiBot's runs were off by: {errors}; a fish robot with a broad fin is up "
        "to 5 times too fast in it. How uncertain this robot's coefficients are: laticauda swim --interval."
    )


def _notes_on_missing_figures(trial: Trial) -> list[str]:
    """Return a note for each reason why figures are missing."""
    _, reasons = trial.figures()
    names_by_reason: dict[str, list[str]] = {}
    for figure in shown_figures(trial):
        if figure.name in reasons:
            names_by_reason.setdefault(reasons[figure.name], []).append(figure.name)
    notes: list[str] = []
    for reason, names in names_by_reason.items():
        # Whoever reads the text passes no argument `time`.
        sentence = reason.replace("`time` must", "The run must")
        notes.append(f"Not available: {', '.join(names).replace('_', ' ')}. {sentence}")
    return notes


def _is_measured(trial: Trial) -> bool:
    """Return whether the trial comes from data or an operated robot rather than from a model."""
    return trial.settings.get("model") in ("measured", "robot")


def _is_of_textbook(trial: Trial) -> bool:
    return not _is_measured(trial) and trial.environment.name.startswith(TEXTBOOK)


def interval_table(
    trial: Trial, intervals: Mapping[str, tuple[float, float]], varied: Iterable[str]
) -> str:
    """Return a table of the intervals in which the figures lie, given those of the coefficients, one figure per line.

    Args:
        trial: Trial of the run.
        intervals: Intervals from `laticauda.models.simulate.figure_intervals`.
        varied: Names of the coefficients that were varied.
    """
    rows = [("if the coefficients lie in their intervals", "from", "to", "")]
    for figure in shown_figures(trial):
        if figure.name not in intervals or figure.name in LEFT_OUT:
            continue
        low, high = intervals[figure.name]
        lowest, unit = format_figure(low, figure.unit)
        highest = format_figure(high, figure.unit).number
        rows.append((figure.title, lowest, highest, unit))
    names = ", ".join(name.removeprefix("water.") for name in varied)
    note = f"Varied within the textbook's intervals: {names}. All other coefficients are taken as known."
    return f"{align_columns(rows, right=(1, 2))}\n\n{wrap_notes([note])}"


def wrap_notes(notes: Sequence[str]) -> str:
    """Return notes, one below the other, wrapped.

    Args:
        notes: The notes.
    """
    return "\n".join(textwrap.fill(note, WIDTH, subsequent_indent="  ") for note in notes)


def _note_on_measurement(measured: MeasuredTrial, trial: Trial) -> str:
    text = f"Measured: {measured.about}."
    if abs(trial.duration - measured.duration) > 0.5:
        text += f" This run: {trial.duration:.4g} s."
    if trial.mean_power_kind == "mechanical" and "work" not in trial.not_measured:
        text += " Its power is electrical, most of it lost in servos: do not compare it with a mechanical one."
    return text


def describe_gait(gait: gaits.Gait | None) -> str:
    """Return the kind of a gait, with the numbers of all its waves."""
    if gait is None:
        return "none"
    parts: list[str] = []
    recorded = gait.recorded
    if recorded is not None:
        span = f"{recorded.time[0]:g} to {recorded.time[-1]:.4g} s"
        parts.append(f"recorded motion: {len(recorded.angle)} joints, {span}")
    if recorded is None or gait.amplitude or gait.offset:
        envelope = in_a_line(describe_fields(gait.envelope))
        wave = in_a_line(describe_fields(gait, "envelope", "recorded"))
        numbers = ", ".join(filter(None, (envelope, wave)))
        if not numbers:
            return "straight, with all joints at rest"
        parts.append(f"{gait.kind.replace('_', '-')}: {numbers}")
    return ", ".join(parts)


def _describe_environment(trial: Trial, origin: str) -> str:
    environment = trial.environment
    source = f" ({origin})" if origin else ""
    return f"{environment.name}{source}: {in_a_line(describe_coefficients(environment))}"


def _describe_run(trial: Trial) -> str:
    settings = trial.settings
    duration = trial.time[-1] - trial.time[0]
    if settings.get("model") == "measured":
        return f"{duration:.4g} s from {settings['source']}, rates over {settings['smoothing']:g} s; {trial.status}"
    model = settings.get("model", "unknown")
    joints = settings.get("joints", "unknown")
    parts = [f"{duration:.4g} s, {model} model, {joints} joints"]
    if settings.get("dt"):
        parts.append(f"time step {settings['dt']:g} s")
    if settings.get("ramp"):
        parts.append(f"smooth start {settings['ramp']:g} s")
    if settings.get("scene"):
        forces = (trial.link_force or {}).get("contact", np.zeros((1, 3)))
        strongest = format_number(np.linalg.norm(forces, axis=-1).max())
        parts.append(f"scene {settings['scene']}: it pushes a link with at most {strongest} N")
    is_steered = "controller" in settings or (trial.gait is not None and trial.gait.offset)
    if is_steered and settings.get("offset_bandwidth"):
        parts.append(f"steering: {scenarios.loop_in_words(settings)}")
    return ", ".join(parts)
