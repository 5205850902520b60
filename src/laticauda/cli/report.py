"""A trial as text to read, and as JSON: what moved, in what, how, and the figures beside what was measured."""

import dataclasses
import json
import math
import textwrap
from collections.abc import Sequence
from typing import Any

from laticauda.cli.tables import aligned, number, percent, read_in
from laticauda.gaits import Custom, Gait
from laticauda.robot import Ground, Robot, Water
from laticauda.trial import FIGURES, ComparedFigure, MeasuredTrial, Trial, following, measured_counterpart

WIDTH = 110
# Said once at the top, or by `mean_power`.
LEFT_OUT = ("duration",)


def as_json(trial: Trial) -> str:
    """One JSON object in SI units: the trial's summary, what was measured, and how the run was made."""
    measured = measured_counterpart(trial)
    environment = dataclasses.asdict(trial.environment)
    found: dict[str, Any] = {
        **trial.summary(),
        "not_measured": list(trial.not_measured),
        "measured": None
        if measured is None
        else {"forward_velocity": measured.forward_velocity, "electrical_power": measured.mean_power},
        "gait_parameters": None if trial.gait is None else dataclasses.asdict(trial.gait),
        "coefficients": {name: value for name, value in environment.items() if name != "name"},
        "settings": dict(trial.settings),
        "version": trial.version,
    }
    if "cross_track_error" in trial.signals:
        found["path_following"] = following.summary(trial)
    return json.dumps(found, indent=2, allow_nan=False)


def as_text(trial: Trial, origin: str = "") -> str:
    """The same as a table to read, angles in degrees.

    Args:
        trial: Any trial, a failed one too.
        origin: Where the coefficients of water or ground are from, in words.
    """
    head = [("robot", _robot(trial.robot)), ("gait", _gait(trial.gait))]
    head.append(("ground" if isinstance(trial.environment, Ground) else "water", _environment(trial, origin)))
    head.append(("run", _run(trial)))
    if not trial.succeeded:
        head.append(("FAILED", trial.status))
    parts = [_wrapped(head), figure_table(trial), _notes(trial)]
    return "\n\n".join(part for part in parts if part)


def comparison_as_json(names: Sequence[str], rows: Sequence[ComparedFigure]) -> str:
    """One JSON object: the trials' names, and per figure its unit, values and differences, also in percent."""
    found = {
        row.figure.name: {
            "unit": row.figure.unit,
            "values": row.values,
            "differences": row.differences,
            "differences_percent": row.differences_percent,
        }
        for row in rows
    }
    return json.dumps({"trials": list(names), "figures": found}, indent=2, allow_nan=False)


def comparison_as_text(names: Sequence[str], rows: Sequence[ComparedFigure]) -> str:
    """A table with a figure a line and, per trial, its value and its difference to the first."""
    first, *others = names
    lines: list[list[str]] = [["", first, "", *(cell for name in others for cell in (name, "difference"))]]
    for row in rows:
        cells = [read_in(value, row.figure.unit) for value in row.values]
        line = [row.figure.title, cells[0][0], cells[0][1]]
        for i, (shown, _) in enumerate(cells[1:], start=1):
            line += [shown, _difference(row, i)]
        lines.append(line)
    return aligned(lines, right=(1, *range(3, len(lines[0]))))


def _difference(row: ComparedFigure, i: int) -> str:
    """The difference of trial `i` in percent, or in the figure's unit where percent would say nothing."""
    share, difference = row.differences_percent[i], row.differences[i]
    if share is not None or difference is None:
        return percent(share)
    shown, unit = read_in(difference, row.figure.unit)
    return f"{'' if shown.startswith('-') or shown == '0' else '+'}{shown} {unit}".rstrip()


def following_table(trial: Trial) -> str:
    """How soon and how well a run came to its path, a figure a line."""
    found = following.summary(trial)
    rows = [(title, *read_in(found[name], unit)) for name, (unit, title) in following.FIGURES.items()]
    return aligned([("path following", "", ""), *rows], right=(1,))


def figure_table(trial: Trial) -> str:
    """Every figure that has a meaning for this run, with the measured value and the difference where there is one."""
    summary = trial.summary()
    measured = _measured(trial)
    is_measured = trial.settings.get("model") == "measured"
    names = ("measured", "the paper's") if is_measured else ("simulated", "measured")
    rows: list[tuple[str, ...]] = [("", names[0], "", names[1], "difference")]
    for figure in FIGURES:
        value: Any = summary[figure.name]
        beside = measured.get(figure.name)
        # The power that `mean_power` is need not come twice.
        if figure.name in LEFT_OUT or figure.name == f"{trial.mean_power_kind}_power":
            continue
        if value is None and beside is None:
            continue
        title = f"mean power ({trial.mean_power_kind})" if figure.name == "mean_power" else figure.title
        shown, unit = read_in(value, figure.unit)
        difference = None if value is None or beside is None else 100.0 * (value - beside) / beside
        rows.append((title, shown, unit, *(("", "") if beside is None else (number(beside), percent(difference)))))
    if not measured:
        rows = [row[:3] for row in rows]
    return aligned(rows, right=(1, 3, 4)) if len(rows) > 1 else ""


def _measured(trial: Trial) -> dict[str, float]:
    """What the paper measured, by the names of the figures; its power is electrical."""
    measured = measured_counterpart(trial)
    if measured is None:
        return {}
    power = "mean_power" if trial.mean_power_kind == "electrical" else "electrical_power"
    found = {"forward_velocity": measured.forward_velocity, power: measured.mean_power}
    return {name: value for name, value in found.items() if value is not None}


def _notes(trial: Trial) -> str:
    """What the figures do not say: what was measured, and why figures are missing."""
    notes: list[str] = []
    measured = measured_counterpart(trial)
    if measured is not None:
        notes.append(_about(measured, trial))
    if not trial.succeeded:  # its status says more
        return _filled(notes)
    by_reason: dict[str, list[str]] = {}
    missing: Any = trial.summary()["not_available"]
    for name, reason in missing.items():
        by_reason.setdefault(reason, []).append(name)
    notes += [f"Not available: {', '.join(names)}. {reason}" for reason, names in by_reason.items()]
    return _filled(notes)


def _filled(notes: Sequence[str]) -> str:
    return "\n".join(textwrap.fill(note, WIDTH, subsequent_indent="  ") for note in notes)


def _about(measured: MeasuredTrial, trial: Trial) -> str:
    text = f"Measured: {measured.about}."
    duration = float(trial.time[-1] - trial.time[0])
    if abs(duration - measured.duration) > 0.5:
        text += f" This run: {duration:.4g} s."
    if trial.mean_power_kind == "mechanical" and "work" not in trial.not_measured:
        text += " Its power is electrical, most of it lost in servos: do not compare it with a mechanical one."
    return text


def _robot(robot: Robot) -> str:
    fin = ", with a caudal fin" if robot.caudal_fin else ""
    return f"{robot.name}: {robot.n_links} links, {robot.length:.4g} m, {robot.mass:.4g} kg{fin}"


def _gait(gait: Gait | None) -> str:
    if gait is None:
        return "none"
    amplitude, shift, offset = (math.degrees(angle) for angle in (gait.amplitude, gait.phase_shift, gait.offset))
    text = (
        f"{gait.kind.replace('_', '-')}: amplitude {amplitude:.4g} deg, "
        f"frequency {math.degrees(gait.frequency):.4g} deg/s, phase shift {shift:.4g} deg"
    )
    if gait.offset:
        text += f", offset {offset:.4g} deg"
    if isinstance(gait.envelope, Custom):
        text += f", envelope {' '.join(f'{g:g}' for g in gait.envelope.values)}"
    if gait.pitch is not None:
        pitch = gait.pitch
        amplitude, ahead = math.degrees(pitch.amplitude), math.degrees(pitch.phase)
        text += f", pitch wave: amplitude {amplitude:.4g} deg, {ahead:.4g} deg ahead"
        text += f", offset {math.degrees(pitch.offset):.4g} deg" if pitch.offset else ""
    if gait.fin is not None:
        fin = gait.fin
        amplitude, frequency, ahead = (math.degrees(x) for x in (fin.amplitude, fin.frequency, fin.phase))
        text += f", fin: amplitude {amplitude:.4g} deg, frequency {frequency:.4g} deg/s, {ahead:.4g} deg ahead"
        text += f", offset {math.degrees(fin.offset):.4g} deg" if fin.offset else ""
    return text


def _environment(trial: Trial, origin: str) -> str:
    environment = trial.environment
    source = f" ({origin})" if origin else ""
    text = _water(environment) if isinstance(environment, Water) else _ground(environment)
    return f"{environment.name}{source}: {text}"


def _water(water: Water) -> str:
    parts = [
        f"tangential_friction {water.tangential_friction:g}",
        f"normal_drag {water.normal_drag:g}",
        f"added_mass {water.added_mass:g} ({water.added_mass_form})",
        f"added_inertia {water.added_inertia:g} (rotation: {water.rotational})",
        f"drag {water.drag.words}",
    ]
    if water.tangential_added_mass:
        parts.append(f"tangential_added_mass {water.tangential_added_mass:g}")
    if water.friction_taper:
        parts.append(f"friction_taper {water.friction_taper:g}")
    if water.trailing_edge != "none":
        parts.append(f"trailing edge {water.trailing_edge}")
    if any(water.current):
        parts.append(f"current ({water.current[0]:g}, {water.current[1]:g}) m/s")
    if water.depth is not None:
        parts.append(f"depth {water.depth:g} m")
    if water.density != 1000.0:
        parts.append(f"density {water.density:g} kg/m^3")
    return ", ".join(parts)


def _ground(ground: Ground) -> str:
    unit = "" if ground.friction.of_weight else " N s/m"
    return f"{ground.friction.words} friction, tangential {ground.tangential:g}{unit}, normal {ground.normal:g}{unit}"


def _run(trial: Trial) -> str:
    settings = trial.settings
    duration = trial.time[-1] - trial.time[0]
    if settings.get("model") == "measured":
        return f"{duration:.4g} s from {settings['source']}, rates over {settings['smoothing']:g} s; {trial.status}"
    parts = [f"{duration:.4g} s, {settings.get('model', 'unknown')} model, {settings.get('joints', 'unknown')} joints"]
    for name, words, unit in (("dt", "time step", "s"), ("ramp", "smooth start", "s")):
        if settings.get(name):
            parts.append(f"{words} {settings[name]:g} {unit}")
    if trial.gait is not None and trial.gait.offset and settings.get("offset_bandwidth"):
        parts.append(f"offset bandwidth {settings['offset_bandwidth']:g} rad/s")
    return ", ".join(parts)


def _wrapped(rows: list[tuple[str, str]]) -> str:
    """Rows of a name and a text, the text over several lines where it is long."""
    width = max(len(name) for name, _ in rows) + 2
    lines = (
        textwrap.fill(text, WIDTH, initial_indent=name.ljust(width), subsequent_indent=" " * width)
        for name, text in rows
    )
    return "\n".join(lines)
