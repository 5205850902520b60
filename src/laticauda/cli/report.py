"""A trial as readable text and as JSON: robot, environment, gait and run, with figures and measured values."""

import dataclasses
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from laticauda import scenarios
from laticauda.cli.tables import aligned, format_number, percent, read_in
from laticauda.motion import gaits
from laticauda.robot import SEEN, TEXTBOOK, Ground, describe_coefficients, in_a_line
from laticauda.trials import FIGURES, MeasuredTrial, Trial, following, measured_counterpart
from laticauda.values.quantities import describe_fields

WIDTH = 110
LEFT_OUT = ("duration",)  # stated once, at the top


def facts_of(trial: Trial) -> dict[str, Any]:
    """Return the trial's summary, the measured values and the settings of the run for JSON, in SI units."""
    measured, environment = measured_counterpart(trial), dataclasses.asdict(trial.environment)
    found: dict[str, Any] = {
        **trial.summary(),
        "not_measured": list(trial.not_measured),
        "infeasible": list(trial.feasibility.problems),
        "measured": measured
        and {
            "forward_velocity": measured.forward_velocity,
            "electrical_power": measured.mean_power,
        },
        "gait_parameters": None if trial.gait is None else dataclasses.asdict(trial.gait),
        "certainty": SEEN if _is_of_textbook(trial) else None,
        "coefficients": {name: value for name, value in environment.items() if name != "name"},
        "settings": trial.settings,
        "version": trial.version,
    }
    if "cross_track_error" in trial.signals:
        found["path_following"] = following.summarize_following(trial)
    return found


def as_text(trial: Trial, origin: str = "") -> str:
    """Return a trial as a readable table, with angles in degrees.

    Args:
        trial: Any trial, including a failed one.
        origin: Source of the coefficients of water or ground, in words.
    """
    head = [("robot", trial.robot.words), ("gait", _gait(trial.gait))]
    head.append(
        (
            "ground" if isinstance(trial.environment, Ground) else "water",
            _environment(trial, origin),
        )
    )
    head.append(("run", _run(trial)))
    if "joint_angle" not in trial.not_measured:
        head.append(("joints", trial.feasibility.words))
    if trial.feasibility.problems:
        head.append(("WARNING", "; ".join(trial.feasibility.problems)))
    if not trial.succeeded:
        head.append(("FAILED", trial.status))
    parts = [_wrapped(head), figure_table(trial), _notes(trial)]
    return "\n\n".join(part for part in parts if part)


def following_table(trial: Trial) -> str:
    """Return a table of how soon and how well a run converged to its path, one figure per line."""
    found = following.summarize_following(trial)
    named = {
        name: one
        for name, one in following.FIGURES.items()
        if "height" not in name or found[name] is not None
    }
    rows = [(title, *read_in(found[name], unit)) for name, (unit, title) in named.items()]
    return aligned([("path following", "", ""), *rows], right=(1,))


def figure_table(trial: Trial) -> str:
    """Return a table of the figures that apply to this run, with measured values and differences where available."""
    summary, measured = trial.summary(), _measured(trial)
    names = ("measured", "the paper's") if _is_measured(trial) else ("simulated", "measured")
    rows: list[tuple[str, ...]] = [("", names[0], "", names[1], "difference")]
    for figure in FIGURES:
        value: Any = summary[figure.name]
        beside = measured.get(figure.name)
        # The power that `mean_power` stands for need not be listed twice.
        if figure.name in LEFT_OUT or figure.name == f"{trial.mean_power_kind}_power":
            continue
        if value is None and beside is None:
            continue
        title = (
            f"mean power ({trial.mean_power_kind})" if figure.name == "mean_power" else figure.title
        )
        shown, unit = read_in(value, figure.unit)
        difference = None if value is None or beside is None else 100.0 * (value - beside) / beside
        rows.append(
            (
                title,
                shown,
                unit,
                *(("", "") if beside is None else (format_number(beside), percent(difference))),
            )
        )
    if not measured:
        rows = [row[:3] for row in rows]
    return aligned(rows, right=(1, 3, 4)) if len(rows) > 1 else ""


def _measured(trial: Trial) -> dict[str, float]:
    """Return the paper's measured values by the names of the figures; its power is electrical."""
    measured = measured_counterpart(trial)
    power = "mean_power" if trial.mean_power_kind == "electrical" else "electrical_power"
    found = (
        {}
        if measured is None
        else {"forward_velocity": measured.forward_velocity, power: measured.mean_power}
    )
    return {name: value for name, value in found.items() if value is not None}


def _notes(trial: Trial) -> str:
    """Return notes on the figures: what was measured, and why figures are missing."""
    notes: list[str] = []
    if (measured := measured_counterpart(trial)) is not None:
        notes.append(_about(measured, trial))
    if not trial.succeeded:  # its status says more
        return _filled(notes)
    if _is_of_textbook(trial):
        seen = ", ".join(
            f"{kind} {100.0 * low:+.0f} to {100.0 * high:+.0f} %"
            for kind, (low, high) in SEEN.items()
        )
        notes.append(
            f"Textbook water, nothing fitted. AmphiBot's runs were off by: {seen}; a fish robot with a broad fin is 4 "
            "to 7 times too fast in it. How uncertain this robot's coefficients are: laticauda swim --interval."
        )
    by_reason: dict[str, list[str]] = {}
    for name, reason in trial.figures()[1].items():
        by_reason.setdefault(reason, []).append(name)
    for reason, names in by_reason.items():
        why = reason.replace(
            "`time` must", "The run must"
        )  # the reader of the text passes no such argument
        notes.append(f"Not available: {', '.join(names).replace('_', ' ')}. {why}")
    return _filled(notes)


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
    for figure in (one for one in FIGURES if one.name in intervals and one.name not in LEFT_OUT):
        (low, unit), (high, _) = (read_in(one, figure.unit) for one in intervals[figure.name])
        rows.append((figure.title, low, high, unit))
    names = ", ".join(name.removeprefix("water.") for name in varied)
    note = f"Varied within the textbook's intervals: {names}. All other coefficients are taken as known."
    return f"{aligned(rows, right=(1, 2))}\n\n{_filled([note])}"


def _filled(notes: Sequence[str]) -> str:
    return "\n".join(textwrap.fill(note, WIDTH, subsequent_indent="  ") for note in notes)


def _about(measured: MeasuredTrial, trial: Trial) -> str:
    text = f"Measured: {measured.about}."
    if abs(trial.duration - measured.duration) > 0.5:
        text += f" This run: {trial.duration:.4g} s."
    if trial.mean_power_kind == "mechanical" and "work" not in trial.not_measured:
        text += " Its power is electrical, most of it lost in servos: do not compare it with a mechanical one."
    return text


def _gait(gait: gaits.Gait | None) -> str:
    if gait is None:
        return "none"
    parts: list[str] = []
    if (seen := gait.recorded) is not None:
        parts.append(
            f"recorded motion: {len(seen.angle)} joints, {seen.time[0]:g} to {seen.time[-1]:.4g} s"
        )
    if seen is None or gait.amplitude or gait.offset:
        envelope = in_a_line(describe_fields(gait.envelope))
        wave = in_a_line(describe_fields(gait, "envelope", "recorded"))
        parts.append(f"{gait.kind.replace('_', '-')}: {', '.join(filter(None, (envelope, wave)))}")
    return ", ".join(parts)


def _environment(trial: Trial, origin: str) -> str:
    environment = trial.environment
    source = f" ({origin})" if origin else ""
    return f"{environment.name}{source}: {in_a_line(describe_coefficients(environment))}"


def _run(trial: Trial) -> str:
    settings = trial.settings
    duration = trial.time[-1] - trial.time[0]
    if settings.get("model") == "measured":
        return f"{duration:.4g} s from {settings['source']}, rates over {settings['smoothing']:g} s; {trial.status}"
    parts = [
        f"{duration:.4g} s, {settings.get('model', 'unknown')} model, {settings.get('joints', 'unknown')} joints"
    ]
    for name, words, unit in (("dt", "time step", "s"), ("ramp", "smooth start", "s")):
        if settings.get(name):
            parts.append(f"{words} {settings[name]:g} {unit}")
    if settings.get("scene"):
        force = (trial.link_force or {}).get("contact", np.zeros((1, 3)))
        strongest = np.linalg.norm(force, axis=-1).max()
        parts.append(
            f"scene {settings['scene']}: it pushes a link with at most {format_number(strongest)} N"
        )
    is_steered = "controller" in settings or (trial.gait is not None and trial.gait.offset)
    if is_steered and settings.get("offset_bandwidth"):
        parts.append(f"steering: {scenarios.loop_in_words(settings)}")
    return ", ".join(parts)


def _wrapped(rows: list[tuple[str, str]]) -> str:
    """Format rows of a name and a text, wrapping long texts."""
    width = max(len(name) for name, _ in rows) + 2
    lines = (
        textwrap.fill(text, WIDTH, initial_indent=name.ljust(width), subsequent_indent=" " * width)
        for name, text in rows
    )
    return "\n".join(lines)
