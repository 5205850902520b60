"""`laticauda predict`: speed, power and path of a gait from an identification, with one interval."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import tyro

import laticauda as lc
from laticauda.cli import report
from laticauda.cli.command import Command, Outcome
from laticauda.cli.first_screen import describe_joints, describe_who
from laticauda.cli.flag_types import words_flag
from laticauda.cli.flags import BadFlag, Options, parse_command
from laticauda.cli.scene import Names, warn_of_compiling
from laticauda.cli.shared_options import threads_option
from laticauda.cli.short_forms import write_out_frequencies
from laticauda.cli.tables import format_digits, wrap_rows
from laticauda.identify import (
    SCENARIO_FILE,
    PredictedFigure,
    Prediction,
    PredictionBasis,
    load_basis,
    predict_scenario,
)
from laticauda.motion.gaits import FIRST_GAIT
from laticauda.scenarios import Scenario, load_scenario
from laticauda.trials import Trial
from laticauda.values import option, quantity, to_plain, value_class

DIGITS = 3
"""Significant digits of the figures."""
HELP = ("-h", "--help")
FOLDER_FIRST = "FOLDER must come first: the folder that `laticauda identify` wrote"

FolderArgument = Annotated[
    str,
    tyro.conf.Positional,
    words_flag(n_words=1, metavar="FOLDER", read=lambda words: words[0]),
]
"""The folder that the command is about."""


@value_class
class Swimmer(Options):
    """What swims, by name."""

    robot: str | None = option(
        "The same body with or without fin, a preset or a file; if omitted, the first trial's",
        default=None,
    )
    gait: str | None = option(
        "The kind of gait, as for `laticauda swim`; if omitted, the first trial's", default=None
    )
    envelope: tuple[float, ...] | None = quantity(
        "", "g of every joint for the gait custom, tail first", default=None
    )


@value_class
class Predict(Command):
    """Predict speed, power and path of a gait from an identification, with one interval.

    The interval holds what the coefficients leave open, what was held fixed although it is not
    known, and what the model was off in measurements that the fit did not see.

    For example: laticauda predict tank --amplitude-deg 35 --frequency-deg-s 210 --phase-shift-deg 45
    """

    folder: FolderArgument = option("Folder that `laticauda identify` wrote")
    swimmer: Swimmer = option("What swims, by name", default=Swimmer())
    motion: lc.Gait = option("The gait; every number can be changed", default=FIRST_GAIT)
    duration: float | None = quantity(
        "s", "Duration of the run; if omitted, that of the first trial", gt=0.0, default=None
    )
    threads: int | None = threads_option()

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed, reading its folder and its names first; see `Command.read`."""
        arguments = write_out_frequencies(arguments)
        if not arguments or arguments[0] in HELP:
            return parse_command(cls, arguments, prog)
        folder = arguments[0]
        if folder.startswith("-"):
            raise BadFlag(f"{FOLDER_FIRST}, got {folder!r}.")
        load_basis(folder)  # rejects other folders before anything else is read
        swimmer: Swimmer = parse_command(Swimmer, arguments[1:], prog, known_only=True)
        scenario = load_scenario(Path(folder) / SCENARIO_FILE)
        gait = scenario.gait
        if swimmer.gait is not None:
            names = Names(gait=swimmer.gait, envelope=swimmer.envelope)
            gait = replace(gait, envelope=names.choose_envelope())
        default = cls(folder=folder, swimmer=swimmer, motion=gait)
        return parse_command(cls, arguments, prog, default)

    def run(self) -> Outcome:
        """Predict, and report."""
        basis = load_basis(self.folder)
        scenario = self._scenario(basis)
        warn_of_compiling(scenario.environment, scenario.model, scenario.robot)
        prediction = predict_scenario(basis, scenario, threads=self.threads)
        trial = lc.swim(scenario)
        return Outcome(
            facts=self._describe_facts(prediction, trial),
            text=_describe(prediction, trial, basis, self.folder),
        )

    def _scenario(self, basis: PredictionBasis) -> Scenario:
        """Return the run, with the values that the folder has for its gait."""
        folder = Path(self.folder)
        scenario = load_scenario(folder / SCENARIO_FILE)
        parameters = lc.load_parameters(folder / "parameters.toml")
        robot = scenario.robot
        if self.swimmer.robot is not None:
            robot = _same_body(lc.load_robot(self.swimmer.robot), robot)
        kind = self.motion.kind
        return replace(
            scenario,
            robot=parameters.robot(robot, kind),
            motion=self.motion,
            environment=parameters.water(kind),
            duration=self.duration or basis.duration,
        )

    def _describe_facts(self, prediction: Prediction, trial: Trial) -> dict[str, Any]:
        figures = {name: dataclasses.asdict(figure) for name, figure in prediction.figures.items()}
        path = prediction.path
        return {
            "folder": self.folder,
            "robot": trial.robot.name,
            "gait_parameters": dataclasses.asdict(self.motion),
            "duration": prediction.scenario.duration,
            "confidence": prediction.confidence,
            "figures": to_plain(figures),
            "mean_power_kind": trial.mean_power_kind,
            "path": {
                "time": path.time.tolist(),
                "center_of_mass": path.center_of_mass.tolist(),
                "half_width": path.half_width.tolist(),
            },
            "infeasible": list(trial.feasibility.problems),
            "notes": list(prediction.notes),
        }


def _same_body(robot: lc.Robot, measured: lc.Robot) -> lc.Robot:
    """Return a robot whose modules and joints are those that were measured."""
    if robot.modules != measured.modules or len(robot.joints) != len(measured.joints):
        rule = f"must have the modules and joints of `{measured.name}`, which was measured"
        raise BadFlag(f"--robot {rule}, got `{robot.name}`.")
    return robot


# ---- text ----------------------------------------------------------------------------------------


def _describe(prediction: Prediction, trial: Trial, basis: PredictionBasis, folder: str) -> str:
    """Return what is printed: who and how, the figures with their intervals, and notes."""
    percent = f"{100.0 * prediction.confidence:g} %"
    figures = prediction.figures
    rows: list[tuple[str, str]] = []
    for title, name, kind in (
        ("speed", "forward_velocity", ""),
        ("power", "mean_power", f" {trial.mean_power_kind}"),
    ):
        if name in figures:
            rows.append((title, _describe_figure(figures[name], kind, percent, prediction)))
    rows.append(("path", _describe_end(prediction)))
    rows += describe_joints(trial, None)
    notes = [_name_what_is_in_it(prediction, basis, percent), *prediction.notes]
    parts = ["\n".join(describe_who(trial)), wrap_rows(rows)]
    parts.append(report.wrap_notes(notes))
    return "\n\n".join(parts)


def _describe_figure(
    figure: PredictedFigure, kind: str, percent: str, prediction: Prediction
) -> str:
    """Return a speed or a power, its interval, and what this is made of."""
    value, low, high = (
        format_digits(number, DIGITS) for number in (figure.value, figure.low, figure.high)
    )
    shares = figure.shares
    text = (
        f"{value} {figure.unit}{kind}, {percent} {low} to {high}: "
        f"coefficients {_half_width(shares.coefficients, prediction)}, "
        f"what was held fixed {_half_width(shares.held_fixed, prediction)}, "
    )
    if shares.left_out is None:
        return f"{text}what the model leaves out is not known"
    return f"{text}model left out {_half_width(shares.left_out, prediction)}"


def _half_width(sigma: float, prediction: Prediction) -> str:
    """Return half of the interval that one share alone would have."""
    return f"+-{100.0 * prediction.quantile * sigma:.1f} %"


def _describe_end(prediction: Prediction) -> str:
    """Return where the robot ends."""
    parts: list[str] = []
    for name in ("x", "y"):
        figure = prediction.figures[name]
        parts.append(f"{name} {figure.value:.2f} m ({figure.low:.2f} to {figure.high:.2f})")
    heading = prediction.figures["heading"]
    angles = [math.degrees(angle) for angle in (heading.value, heading.low, heading.high)]
    parts.append("heading {:.1f} deg ({:.1f} to {:.1f})".format(*angles))
    return f"ends at {', '.join(parts)}"


def _name_what_is_in_it(prediction: Prediction, basis: PredictionBasis, percent: str) -> str:
    """Return which numbers the interval is about."""
    fitted = ", ".join(number.name for number in basis.fitted)
    text = f"{percent} intervals of what the robot does, without the noise of a measurement. Fitted: {fitted}."
    if basis.held_numbers:
        held_numbers = ", ".join(
            f"{number.name} {number.value:.3g} ({number.low:.3g} to {number.high:.3g})"
            for number in basis.held_numbers
        )
        return f"{text} Held fixed, though not known: {held_numbers}; the fit follows them."
    return f"{text} All other coefficients were stated, and are taken as known."
