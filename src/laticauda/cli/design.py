"""`laticauda design-experiment`: the most informative next trials."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any, Literal

import numpy as np

from laticauda import scenarios
from laticauda.cli.command import PATIENCE, SHARE, Command, Outcome, show_progress
from laticauda.cli.flags import File, Options, Picture, Place, Words
from laticauda.cli.tables import aligned, parse_numbers
from laticauda.identify import tasks
from laticauda.identify.candidates import SENSORS, coast_down, from_tow, swim_candidates
from laticauda.identify.design import (
    Design,
    Discrimination,
    Judged,
    design_experiment,
    discriminate,
    format_share,
    known_from,
    misidentification_probability,
)
from laticauda.identify.identifiability import LIMIT, marginal
from laticauda.identify.measurements import Measurement, Tow
from laticauda.identify.problem import Problem, make_problem
from laticauda.identify.unknowns import Unknown
from laticauda.motion import gaits
from laticauda.robot import TEXTBOOK, load_robot, water_names
from laticauda.show import figures
from laticauda.values import packaging
from laticauda.values.checks import check_not_empty
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

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
    threads: int | None = quantity(
        "", "Trials to run in parallel; one per core if omitted", ge=1, default=None
    )

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
    base: str | None = option(
        "Parameter file for all else, with a joint law; else the paper's", default=None
    )
    water: str | None = option(
        "A preset, a TOML file or textbook, instead of the base's", default=None
    )
    joints: str | None = option(
        "How joints follow the gait; if omitted, the base's law or prescribed", default=None
    )
    candidates: Candidates = option("Trials to choose from", default=Candidates())
    output: Picture = option(
        "Plot the uncertainty over the number of trials (.png, .pdf or .svg)", default=None
    )

    tank_day: Place = option(
        "New folder for runs to do and files to fill in, or a filled one to judge", default=None
    )

    def run(self) -> Outcome:
        """Evaluate the candidates, choose trials and draw."""
        if self.tank_day:
            return self._tank_day(Path(self.tank_day))
        show = show_progress(SHARE, what="judged", patience=PATIENCE)
        if self.unknowns.rivals:
            found = discriminate(self._rivals(), self.unknowns.trials, progress=show)
            return _rivals_said(found)
        problem, known = self._problem()
        candidates = self._candidates(problem)
        criterion = self.unknowns.criterion
        found = design_experiment(
            problem, candidates, self.unknowns.trials, **known, criterion=criterion, progress=show
        )
        if self.output is not None:
            _draw(found, self.output)
        return _design_said(found)

    def _tank_day(self, folder: Path) -> Outcome:
        """Begin a tank day, or evaluate its measurements."""
        from laticauda.identify import tank_day

        if not (folder / tank_day.DAY).exists():
            new = tank_day.prepare_folder(folder, load_robot(self._names.robot))
            text = f"{folder / 'RUNS.md'}: what to do. Fill in the tables, then run the same command again."
            return Outcome(facts={"output": str(folder), "files": new}, text=text)
        day = tank_day.load_day(folder)
        show = show_progress(SHARE, what="fitted", patience=PATIENCE)
        found = tank_day.evaluate(day, threads=self.candidates.threads, progress=show)
        files = tank_day.write_result(folder, day, found)
        said = tank_day.tabulate_evaluation(found) | {
            "output": str(folder / "result"),
            "files": files,
        }
        return Outcome(
            facts=said,
            text=f"{tank_day.format_evaluation(found)}\n\n{folder / 'result'}: {', '.join(files)}",
        )

    def _rivals(self) -> dict[str, tuple[Problem, list[Measurement]]]:
        """Return problem and candidates of every rival, by the name of its water or parameter file."""
        found: dict[str, tuple[Problem, list[Measurement]]] = {}
        for name in self.unknowns.rivals:
            of = "water" if name in (*water_names(), TEXTBOOK) else "base"
            one = replace(self, **{of: name})
            problem, _ = one._problem()
            found[name] = problem, one._candidates(problem)
        return found

    def _problem(self) -> tuple[Problem, dict[str, Any]]:
        """Return the unknowns, and what is known about them."""
        if self.unknowns.after is not None:
            if self.unknowns.parameters:
                raise BadArgument(
                    "parameters", "must not be given with --after, whose file defines them"
                )
            fit = tasks.load_task(self.unknowns.after).run(threads=self.candidates.threads)
            keep = fit.problem.of_interest
            known = {"values": fit.best[keep], "information": marginal(known_from(fit), keep)}
            return fit.problem.without_starts, known
        swims = self._swims()
        problem = make_problem(
            swims,
            [_unknown(word) for word in self.unknowns.parameters],
            joints=self._names.resolved(swims[0].scenario.gait).model.joints,
            threads=self.candidates.threads,
        )
        return problem.without_starts, {}

    @property
    def _names(self) -> scenarios.Choice:
        return scenarios.Choice(
            robot=self.robot or "mamba", water=self.water, parameters=self.base, joints=self.joints
        )

    def _swims(self, fitted: Sequence[scenarios.Scenario] = ()) -> list[Measurement]:
        """Return a candidate per gait and robot; robots and waters are those of a fit, or what the names stand for."""
        flags = self.candidates
        kinds = ("lateral-undulation", "eel-like") if flags.gait == "both" else (flags.gait,)
        robots = {one.robot.name: one.robot for one in fitted if self.robot is None}
        found: list[Measurement] = []
        for a, f, p, kind in product(
            flags.amplitudes, flags.frequencies, flags.phase_shifts, kinds
        ):
            gait = gaits.Gait(
                envelope=gaits.Envelope.named(kind)(), amplitude=a, frequency=f, phase_shift=p
            )
            waters = [
                one.environment
                for one in fitted
                if one.gait.kind == gait.kind and self.base is None
            ]
            for robot in robots.values() or (load_robot(self._names.robot),):
                chosen = self._names.resolved(gait, lambda name, n_links, robot=robot: robot)
                where = waters[0] if waters else chosen.environment
                found += swim_candidates(
                    chosen.robot, [gait], where, _sensors(flags.sensors), duration=flags.duration
                )
        return found

    def _candidates(self, put: Problem) -> list[Measurement]:
        flags, swum = self.candidates, self._swims(put.scenarios)
        found = [] if flags.no_swims else swum
        for one in {one.scenario.robot.name: one.scenario for one in reversed(swum)}.values():
            where = one.robot, one.environment
            if not flags.no_tow:
                tows = product(flags.tow, flags.tow_angles)
                found = [
                    *found,
                    *(from_tow(*where, Tow(speed=v, angle=angle)) for v, angle in tows),
                ]
                found += [coast_down(*where, v) for v in flags.coast_down]
        return found


def _unknown(word: str) -> Unknown:
    if "=" not in word:
        return Unknown(name=word)
    name, sign, (mean, *sd) = parse_numbers("parameters", word, FORM, "+-")
    return Unknown(name=name, start=mean, prior=(mean, sd[0]) if sign else None)


def _sensors(words: tuple[str, ...]) -> dict[str, float]:
    found: dict[str, float] = {}
    for word in words:
        usual = SENSORS.get(word, ("", 0.0))[1]
        name, _, (sigma,) = (
            parse_numbers("sensors", word, SENSOR_FORM) if "=" in word else (word, "", [usual])
        )
        if name not in SENSORS or not sigma > 0.0:
            raise BadArgument("sensors", f"must be {SENSOR_FORM}, got {word!r}")
        found[name] = sigma
    return found


def _by_name(names: Sequence[str], found: np.ndarray) -> dict[str, float]:
    return dict(zip(names, found.tolist(), strict=True))


def _listed(key: str, names: Sequence[str], judged: Iterable[Judged]) -> list[dict[str, Any]]:
    return [
        {"trial": one.name, "kind": one.group, key: _by_name(names, found)} for one, found in judged
    ]


def _tables(
    labels: Sequence[str],
    steps: Iterable[tuple[str, Any]],
    alone: Iterable[Judged],
    shown: Callable[[float], str],
) -> list[str]:
    """Return tables of some numbers after successive trials, and after the best trial of each kind alone."""
    kinds: dict[str, tuple[str, Any]] = {}
    for one, found in alone:
        kinds.setdefault(one.group, (f"best {one.group}: {one.name}", found))
    right = range(1, len(labels) + 1)
    return [
        aligned(
            [[head, *labels], *([name, *map(shown, found)] for name, found in rows)], right=right
        )
        for head, rows in (("after", steps), ("by itself", kinds.values()))
    ]


def _design_said(found: Design) -> Outcome:
    """Report the trials in order, the expected standard deviations after each, and what each contributes."""
    facts = {
        "criterion": found.criterion,
        "values": _by_name(found.names, found.values),
        "relative_sigma_before": _by_name(found.names, found.before),
        "trials": _listed("relative_sigma", found.names, found.steps),
        "candidates": _listed("relative_sigma", found.names, found.alone),
        "version": packaging.__version__,
    }
    labels = [
        name if one.is_log else f"{name} *"
        for name, one in zip(found.names, found.unknowns, strict=True)
    ]
    rows = [("what is known now", found.before), *_numbered(found.steps)]
    title = (
        f"The best {len(found.steps)} of {len(found.alone)} candidates, criterion {found.criterion}. Expected "
        "standard deviations (relative to the value; *: in its unit)."
    )
    after, by_itself = _tables(labels, rows, found.alone, format_share)
    reasons = "\n".join(found.reasons).replace("`", "")
    return Outcome(facts=facts, text="\n\n".join([title, after, reasons, by_itself]))


def _rivals_said(found: Discrimination) -> Outcome:
    """Report the trials in order and, after each, the probability of a wrong verdict for every pair of models."""
    names = [" / ".join(pair) for pair in found.pairs]
    listed = {
        key: _listed("distance", names, of)
        for key, of in (("trials", found.steps), ("candidates", found.alone))
    }
    title = (
        f"The best {len(found.steps)} of {len(found.alone)} candidates. "
        "Chance that the wrong one of two fits better:"
    )
    tables = _tables(
        names,
        _numbered(found.steps),
        found.alone,
        lambda apart: f"{100.0 * misidentification_probability(apart):.2g} %",
    )
    return Outcome(
        facts={**listed, "version": packaging.__version__}, text="\n\n".join([title, *tables])
    )


def _numbered(steps: Iterable[Judged]) -> list[tuple[str, Any]]:
    return [(f"{i + 1}. {one.name}", found) for i, (one, found) in enumerate(steps)]


def _draw(found: Design, path: str) -> None:
    from laticauda.show.figures import style
    from laticauda.show.reports.identify_figures import short_names, shrinking

    figure = figures.new_figure(style.DOUBLE_COLUMN, 3.0)
    ax = figure.subplots()
    shrinking(
        short_names(found.names),
        found.sigma,
        ax,
        ylabel="expected standard deviation / value [-]",
        limit=LIMIT,
    )
    figures.save_figure(figure, path)
