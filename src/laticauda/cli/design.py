"""`laticauda design-experiment`: the most informative next trials."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from laticauda import scenarios
from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import File, OptionalFolder, Options, PictureOutput, Words
from laticauda.cli.progress import PATIENCE, SHARE, show_progress
from laticauda.cli.shared_options import base_option, joint_law_option, threads_option
from laticauda.cli.tables import align_columns, parse_numbers, spell_with_underscores
from laticauda.identify import (
    LIMIT,
    SENSORS,
    Design,
    Discrimination,
    Judged,
    Measurement,
    Problem,
    Rival,
    Tow,
    Unknown,
    coast_down,
    design_experiment,
    discriminate,
    format_share,
    from_tow,
    known_from,
    make_problem,
    marginal,
    misidentification_probability,
    swim_candidates,
    tasks,
)
from laticauda.motion import gaits
from laticauda.robot import TEXTBOOK, Environment, Robot, load_robot, water_names
from laticauda.show import figures
from laticauda.values import BadArgument, check_not_empty, option, packaging, quantity, value_class

FORM = "NAME, NAME=VALUE or NAME=MEAN+-SD, such as water.normal_drag=1.75+-0.5"
SENSOR_FORM = "one of speed, power, path, heading, joint-angle, joint-torque, alone or with =SIGMA, such as path=0.003"


def _deg(*angles: float) -> tuple[float, ...]:
    return tuple(map(math.radians, angles))


@value_class
class Unknowns(Options):
    """What is to be identified, and what is already known about it."""

    after: File = option(
        "TOML file of an identification, which is repeated to find the next trials", default=None
    )
    parameters: Words = option(
        "NAME, NAME=VALUE or NAME=MEAN+-SD: parameters as in sweeps, and priors", default=()
    )
    criterion: str = option(
        "Minimized: D, volume of uncertainty; A, mean variance; NAME, its standard deviation",
        default="D",
    )
    rivals: Words = option(
        "Waters or parameter files: choose trials that show which of them is right", default=()
    )
    trials: int = quantity("", "Number of trials to choose", ge=1, default=4)


@value_class
class Candidates(Options):
    """Candidate trials: every combination of gait parameters, and trials with the straight robot."""

    gait: Literal["lateral-undulation", "eel-like", "both"] = option(
        "Kinds of gait", default="lateral-undulation"
    )
    amplitudes: tuple[float, ...] = quantity(
        "rad", "Amplitudes alpha", ge=0.0, le=math.pi, default=_deg(20, 30, 40)
    )
    frequencies: tuple[float, ...] = quantity(
        "rad/s", "Frequencies omega", ge=0.0, le=1e3, default=_deg(70, 110, 150)
    )
    phase_shifts: tuple[float, ...] = quantity(
        "rad", "Phase shifts delta", ge=-math.pi, le=math.pi, default=_deg(30, 50)
    )
    sensors: Words = option(f"Measured in a swim, each {SENSOR_FORM} (SI)", default=("speed",))
    tow: tuple[float, ...] = quantity(
        "m/s", "Speeds of towing the straight robot", gt=0.0, default=(0.1, 0.4)
    )
    tow_angles: tuple[float, ...] = quantity(
        "rad", "Angles between robot and tow; 0: along", default=_deg(0, 15)
    )
    coast_down: tuple[float, ...] = quantity(
        "m/s", "Speeds at which it is released", gt=0.0, le=100.0, default=(0.4,)
    )
    no_tow: bool = option("Neither tows nor coast-downs", default=False)
    no_swims: bool = option("No swimming trials", default=False)
    duration: float = quantity("s", "Duration of a swim", gt=0.0, le=1e5, default=30.0)
    threads: int | None = threads_option()

    def __post_init__(self) -> None:
        """Reject empty lists."""
        for name in (
            "amplitudes",
            "frequencies",
            "phase_shifts",
            "tow",
            "tow_angles",
            "coast_down",
            "sensors",
        ):
            check_not_empty(name, getattr(self, name), "value")

    def combine_gaits(self) -> Iterator[gaits.Gait]:
        """Yield the gait of every combination of parameters."""
        kinds = (self.gait,)
        if self.gait == "both":
            kinds = ("lateral-undulation", "eel-like")
        combinations = product(self.amplitudes, self.frequencies, self.phase_shifts, kinds)
        for amplitude, frequency, phase_shift, kind in combinations:
            yield gaits.Gait(
                envelope=gaits.Envelope.named(kind)(),
                amplitude=amplitude,
                frequency=frequency,
                phase_shift=phase_shift,
            )


@value_class
class DesignExperiment(Command):
    """Find the next trials that would reduce the uncertainty of parameters most.

    For example: laticauda design-experiment --parameters water.tangential_friction
    water.normal_drag water.added_mass --sensors speed --trials 4

    After a first identification: laticauda design-experiment --after tank.toml --trials 3
    """

    unknowns: Unknowns = option(
        "What is to be identified, and what is known about it", default=Unknowns()
    )
    robot: str | None = option(
        "A preset or a TOML file; if omitted, --after's or mamba", default=None
    )
    base: str | None = base_option("the paper's")
    water: str | None = option(
        "A preset, a TOML file or textbook, instead of the base's", default=None
    )
    joints: str | None = joint_law_option()
    candidates: Candidates = option("Trials to choose from", default=Candidates())
    output: PictureOutput = option(
        "Plot the uncertainty over the number of trials (.png, .pdf or .svg)", default=None
    )

    tank_day: OptionalFolder = option(
        "New folder for runs to do and files to fill in, or a filled one to judge", default=None
    )

    def run(self) -> Outcome:
        """Evaluate the candidates, choose trials and draw."""
        if self.tank_day:
            return self._tank_day(Path(self.tank_day))
        show = show_progress(SHARE, what="judged", patience=PATIENCE)
        n_trials = self.unknowns.trials
        if self.unknowns.rivals:
            return _report_rivals(discriminate(self._rivals(), n_trials, progress=show))
        task = self._task()
        design = design_experiment(
            task.problem,
            self._candidates(task.problem),
            n_trials,
            **task.known,
            criterion=self.unknowns.criterion,
            progress=show,
        )
        if self.output is not None:
            _draw(design, self.output)
        return _report_design(design)

    def _tank_day(self, folder: Path) -> Outcome:
        """Begin a tank day, or evaluate its measurements."""
        from laticauda.identify import tank_day

        if not (folder / tank_day.DAY).exists():
            new = tank_day.prepare_folder(folder, load_robot(self._names.robot))
            text = f"{folder / 'RUNS.md'}: what to do. Fill in the tables, then run the same command again."
            return Outcome(facts={"output": str(folder), "files": new}, text=text)
        day = tank_day.load_day(folder)
        show = show_progress(SHARE, what="fitted", patience=PATIENCE)
        evaluation = tank_day.evaluate(day, threads=self.candidates.threads, progress=show)
        files = tank_day.write_result(folder, day, evaluation)
        facts = tank_day.tabulate_evaluation(evaluation)
        facts |= {"output": str(folder / "result"), "files": files}
        listed = f"{folder / 'result'}: {', '.join(files)}"
        text = f"{tank_day.format_evaluation(evaluation)}\n\n{listed}"
        return Outcome(facts=facts, text=text)

    def _rivals(self) -> dict[str, Rival]:
        """Return problem and candidates of every rival, by the name of its water or parameter file."""
        waters = (*water_names(), TEXTBOOK)
        rivals: dict[str, Rival] = {}
        for name in self.unknowns.rivals:
            if name in waters:
                rival = replace(self, water=name)
            else:
                rival = replace(self, base=name)
            problem = rival._task().problem
            rivals[name] = Rival(problem=problem, candidates=rival._candidates(problem))
        return rivals

    def _task(self) -> "_Task":
        """Return the unknowns, and what is known about them."""
        if self.unknowns.after is not None:
            return self._task_after(self.unknowns.after)
        swims = self._swims()
        problem = make_problem(
            swims,
            [_parse_unknown(text) for text in self.unknowns.parameters],
            joints=self._names.resolved(swims[0].scenario.gait).model.joints,
            threads=self.candidates.threads,
        )
        return _Task(problem.without_starts, known={})

    def _task_after(self, file: str) -> "_Task":
        """Repeat an identification, and return what it left to be known."""
        if self.unknowns.parameters:
            rule = "must not be given with --after, whose file defines them"
            raise BadArgument("parameters", rule)
        if self.joints is not None:
            raise BadArgument("joints", "must not be given with --after, whose file defines them")
        task = tasks.load_task(file).without_rivals()  # no doubt of the fit is reported here
        fit = task.run(threads=self.candidates.threads)
        of_interest = fit.problem.of_interest
        information = marginal(known_from(fit), of_interest)
        known = {"values": fit.best[of_interest], "information": information}
        return _Task(fit.problem.without_starts, known)

    @property
    def _names(self) -> scenarios.Choice:
        return scenarios.Choice(
            robot=self.robot or "mamba", water=self.water, parameters=self.base, joints=self.joints
        )

    def _swims(self, fitted: Sequence[scenarios.Scenario] = ()) -> list[Measurement]:
        """Return a candidate per gait and robot.

        Args:
            fitted: Scenarios of an identification, whose robots and waters are used; if there are
                none, those that the names stand for.
        """
        robots = self._robots(fitted)
        swims: list[Measurement] = []
        for gait, robot in product(self.candidates.combine_gaits(), robots):
            choice = self._names.resolved(gait, _always(robot))
            swims += swim_candidates(
                choice.robot,
                [gait],
                self._fitted_water(gait, fitted) or choice.environment,
                _parse_sensors(self.candidates.sensors),
                duration=self.candidates.duration,
            )
        return swims

    def _robots(self, fitted: Sequence[scenarios.Scenario]) -> list[Robot]:
        """Return the robots of a fit, each once, unless another one was typed."""
        if self.robot is None and fitted:
            by_name = {scenario.robot.name: scenario.robot for scenario in fitted}
            return list(by_name.values())
        return [load_robot(self._names.robot)]

    def _fitted_water(
        self, gait: gaits.Gait, fitted: Sequence[scenarios.Scenario]
    ) -> Environment | None:
        """Return the water of the first fitted trial with this kind of gait."""
        if self.base is not None or self.water is not None:
            return None
        for scenario in fitted:
            if scenario.gait.kind == gait.kind:
                return scenario.environment
        return None

    def _candidates(self, problem: Problem) -> list[Measurement]:
        swims = self._swims(problem.scenarios)
        candidates: list[Measurement] = []
        if not self.candidates.no_swims:
            candidates += swims
        if self.candidates.no_tow:
            return candidates
        by_robot = {swim.scenario.robot.name: swim.scenario for swim in reversed(swims)}
        for scenario in by_robot.values():
            candidates += self._straight_trials(scenario)
        return candidates

    def _straight_trials(self, scenario: scenarios.Scenario) -> list[Measurement]:
        """Return the tows and coast-downs of the robot of a scenario."""
        robot = scenario.robot
        water = scenario.environment
        trials: list[Measurement] = []
        for speed, angle in product(self.candidates.tow, self.candidates.tow_angles):
            tow = Tow(speed=speed, angle=angle)
            trials.append(from_tow(robot, water, tow))
        for speed in self.candidates.coast_down:
            trials.append(coast_down(robot, water, speed))
        return trials


def _always(robot: Robot) -> Callable[[str, int | None], Robot]:
    """Return a function that finds this robot, whatever its name: for `Choice.resolved`, which else loads one."""

    def find_robot(name: str, n_links: int | None) -> Robot:
        return robot

    return find_robot


class _Task(NamedTuple):
    """What is to be identified."""

    problem: Problem
    known: dict[str, Any]
    """What is known about the unknowns, as arguments of `design_experiment`."""


def _parse_unknown(text: str) -> Unknown:
    if "=" not in text:
        return Unknown(name=spell_with_underscores(text))
    typed_name, sign, (mean, *deviations) = parse_numbers("parameters", text, FORM, "+-")
    prior = None
    if sign:
        prior = (mean, deviations[0])
    return Unknown(name=spell_with_underscores(typed_name), start=mean, prior=prior)


def _parse_sensors(typed: tuple[str, ...]) -> dict[str, float]:
    """Return the standard deviations of the noise, by sensor."""
    sigmas: dict[str, float] = {}
    for text in typed:
        name = text
        typed_sigma: float | None = None
        if "=" in text:
            name, _, (typed_sigma,) = parse_numbers("sensors", text, SENSOR_FORM)
        if name not in SENSORS or (typed_sigma is not None and typed_sigma <= 0.0):
            raise BadArgument("sensors", f"must be {SENSOR_FORM}, got {text!r}")
        sigmas[name] = SENSORS[name].sigma
        if typed_sigma is not None:
            sigmas[name] = typed_sigma
    return sigmas


def _by_name(names: Sequence[str], numbers: np.ndarray) -> dict[str, float]:
    return dict(zip(names, numbers.tolist(), strict=True))


def _facts_of_trials(
    key: str, names: Sequence[str], judged: Iterable[Judged]
) -> list[dict[str, Any]]:
    """Return name, kind and numbers of every trial; the numbers stand under `key`, by their names."""
    facts: list[dict[str, Any]] = []
    for trial, numbers in judged:
        facts.append({"trial": trial.name, "kind": trial.group, key: _by_name(names, numbers)})
    return facts


class _Row(NamedTuple):
    """Numbers after some trials."""

    title: str
    numbers: Any


def _table_of(
    head: str, labels: Sequence[str], rows: Iterable[_Row], show: Callable[[float], str]
) -> str:
    """Return a table of some numbers after trials."""
    lines = [[head, *labels]]
    for row in rows:
        lines.append([row.title, *map(show, row.numbers)])
    return align_columns(lines, right=range(1, len(labels) + 1))


def _best_of_each_kind(alone: Iterable[Judged]) -> list[_Row]:
    """Return a row for the best trial of each kind; `alone` begins with the best."""
    rows: dict[str, _Row] = {}
    for trial, numbers in alone:
        rows.setdefault(trial.group, _Row(f"best {trial.group}: {trial.name}", numbers))
    return list(rows.values())


def _report_design(design: Design) -> Outcome:
    """Report the trials in order, the expected standard deviations after each, and what each contributes."""
    facts = {
        "criterion": design.criterion,
        "values": _by_name(design.names, design.values),
        "relative_sigma_before": _by_name(design.names, design.before),
        "trials": _facts_of_trials("relative_sigma", design.names, design.steps),
        "candidates": _facts_of_trials("relative_sigma", design.names, design.alone),
        "version": packaging.__version__,
    }
    labels = [
        name if unknown.is_log else f"{name} *"
        for name, unknown in zip(design.names, design.unknowns, strict=True)
    ]
    rows = [_Row("what is known now", design.before), *_numbered(design.steps)]
    title = (
        f"The best {len(design.steps)} of {len(design.alone)} candidates, criterion {design.criterion}. Expected "
        "standard deviations (relative to the value; *: in its unit)."
    )
    after = _table_of("after", labels, rows, format_share)
    by_itself = _table_of("by itself", labels, _best_of_each_kind(design.alone), format_share)
    reasons = "\n".join(design.reasons).replace("`", "")
    return Outcome(facts=facts, text="\n\n".join([title, after, reasons, by_itself]))


def _report_rivals(design: Discrimination) -> Outcome:
    """Report the trials in order and, after each, the probability of a wrong verdict for every pair of models."""
    names = [" / ".join(pair) for pair in design.pairs]
    facts = {
        "trials": _facts_of_trials("distance", names, design.steps),
        "candidates": _facts_of_trials("distance", names, design.alone),
        "version": packaging.__version__,
    }
    title = (
        f"The best {len(design.steps)} of {len(design.alone)} candidates. "
        "Chance that the wrong one of two fits better:"
    )
    after = _table_of("after", names, _numbered(design.steps), _format_chance)
    by_itself = _table_of("by itself", names, _best_of_each_kind(design.alone), _format_chance)
    return Outcome(facts=facts, text="\n\n".join([title, after, by_itself]))


def _format_chance(distance: float) -> str:
    """Return the chance that the wrong model fits better, from the distance of the two."""
    return f"{100.0 * misidentification_probability(distance):.2g} %"


def _numbered(steps: Iterable[Judged]) -> list[_Row]:
    rows: list[_Row] = []
    for number, (trial, numbers) in enumerate(steps, start=1):
        rows.append(_Row(f"{number}. {trial.name}", numbers))
    return rows


def _draw(design: Design, path: str) -> None:
    from laticauda.show.figures import style
    from laticauda.show.reports import draw_expected_deviations, shorten_names

    figure = figures.new_figure(style.DOUBLE_COLUMN, 3.0)
    ax = figure.subplots()
    draw_expected_deviations(
        shorten_names(design.names),
        design.sigma,
        ax,
        ylabel="expected standard deviation / value [-]",
        limit=LIMIT,
    )
    figures.save_figure(figure, path)
