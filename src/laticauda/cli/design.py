"""`laticauda design-experiment`: the next trials that would tell the most."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from typing import Any, Literal

from laticauda import figures
from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import File, Picture, Words
from laticauda.cli.progress import PATIENCE, SHARE, progress
from laticauda.cli.tables import aligned, number, numbers
from laticauda.errors import BadArgument
from laticauda.gaits import Envelope, Gait
from laticauda.identify.candidates import SENSORS, Candidate, Tow, coast_down, straight_tow, swims
from laticauda.identify.design import Design, Step, design, known_from
from laticauda.identify.identifiability import LIMIT, marginal
from laticauda.identify.problem import Problem, make_problem
from laticauda.identify.tasks import load_task
from laticauda.identify.unknowns import Unknown
from laticauda.packaging import __version__
from laticauda.quantities import option, quantity, value
from laticauda.robot import load_robot
from laticauda.scenarios import Choice, Scenario

FORM = "NAME, NAME=VALUE or NAME=MEAN+-SD, as water.normal_drag=1.75+-0.5"
SENSOR_FORM = "of speed, power, path, heading, joint-angle, joint-torque, each alone or with =SIGMA, as path=0.003"


def _degrees(*angles: float) -> tuple[float, ...]:
    return tuple(map(math.radians, angles))


@value
class Unknowns:
    """What is to be identified, and what is known of it."""

    after: File = option(
        "The TOML file of an identification: its fit is repeated, and the trials are those to do next", default=None
    )
    parameters: Words = option(
        "NAME, NAME=VALUE or NAME=MEAN+-SD: numbers of robot and water, with dots as in a sweep, each with its value "
        "or with what is known of it before",
        default=(),
    )
    criterion: str = option(
        "What is to be small: D, the volume of what is possible; A, the mean variance; or the name of one parameter, "
        "its deviation",
        default="D",
    )
    trials: int = quantity("", "How many trials to choose", ge=1, default=4)


@value
class Candidates:
    """Trials that could be done: every combination, and straight ones."""

    gait: Literal["lateral-undulation", "eel-like", "both"] = option("Which gaits", default="lateral-undulation")
    amplitudes: tuple[float, ...] = quantity("rad", "alpha of the candidates", ge=0.0, default=_degrees(20, 30, 40))
    frequencies: tuple[float, ...] = quantity(
        "rad/s", "omega of the candidates", ge=0.0, default=_degrees(70, 110, 150)
    )
    phase_shifts: tuple[float, ...] = quantity("rad", "delta of the candidates", default=_degrees(30, 50))
    sensors: Words = option(
        "NAME or NAME=SIGMA, what would be measured of a swim: speed, power, path, heading, joint-angle, joint-torque, "
        "with the standard deviation of the noise in SI units",
        default=("speed",),
    )
    tow: tuple[float, ...] = quantity(
        "m/s", "Speeds of straight tows whose force would be measured", default=(0.1, 0.4)
    )
    coast_down: tuple[float, ...] = quantity(
        "m/s", "Speeds from which the straight robot would be let go", default=(0.4,)
    )
    no_tow: bool = option("Neither tow nor coast-down", default=False)
    duration: float = quantity("s", "Of a swim", gt=0.0, default=30.0)
    threads: int | None = quantity("", "How many trials run at once; one per core if left out", ge=1, default=None)


@value
class DesignExperiment(Command):
    """Find the next trials that would shrink the uncertainty of parameters most.

    For example: laticauda design-experiment --parameters water.tangential_friction water.normal_drag water.added_mass
    --sensors speed --trials 4

    After a first identification: laticauda design-experiment --after tank.toml --trials 3
    """

    unknowns: Unknowns = option("What is to be identified, and what is known of it", default=Unknowns())
    robot: str | None = option("A preset or a TOML file; the file's, or mamba, if left out", default=None)
    base: str | None = option(
        "A parameter file with the numbers that are not identified, and a joint law; the paper's if left out",
        default=None,
    )
    joints: str | None = option(
        "How the joints follow the gait; the base's law, or prescribed, if left out", default=None
    )
    candidates: Candidates = option("Trials that could be done", default=Candidates())
    output: Picture = option("A figure, .png or .pdf: uncertainty over the number of trials", default=None)

    def run(self) -> Outcome:
        """Judge, choose and draw."""
        show = progress(SHARE, what="judged", patience=PATIENCE)
        problem, known = self._problem()
        candidates = self._candidates(problem)
        criterion = self.unknowns.criterion
        found = design(problem, candidates, self.unknowns.trials, **known, criterion=criterion, progress=show)
        if self.output is not None:
            _draw(found, self.output)
        return Outcome(facts=_facts(found), text=_text(found))

    def _problem(self) -> tuple[Problem, dict[str, Any]]:
        """The unknowns, and what is known of them."""
        if self.unknowns.after is not None:
            if self.unknowns.parameters:
                raise BadArgument("parameters", "must not be given with --after, whose file says them")
            fit = load_task(self.unknowns.after).run(threads=self.candidates.threads)
            keep = fit.problem.of_interest
            put = replace(
                fit.problem, unknowns=tuple(fit.problem.unknowns[k] for k in keep), moves=fit.problem.moves[:, keep]
            )
            values = fit.best[keep]
            return put, {"values": values, "information": marginal(known_from(fit), keep)}
        if not self.unknowns.parameters:
            raise BadArgument("parameters", "must name at least one number to identify, as water.normal_drag, got none")
        swims = self._swims()
        problem = make_problem(
            [one.measurement for one in swims],
            [_unknown(word) for word in self.unknowns.parameters],
            joints=self._names.resolved(swims[0].measurement.scenario.gait).model.joints,
            threads=self.candidates.threads,
        )
        return problem, {}

    @property
    def _names(self) -> Choice:
        return Choice(robot=self.robot or "mamba", parameters=self.base, joints=self.joints)

    def _swims(self, fitted: Sequence[Scenario] = ()) -> list[Candidate]:
        """A candidate per gait and robot: those of a fit, or what the names stand for."""
        flags = self.candidates
        kinds = ("lateral-undulation", "eel-like") if flags.gait == "both" else (flags.gait,)
        robots = {one.robot.name: one.robot for one in fitted if self.robot is None}
        found: list[Candidate] = []
        for a, f, p, kind in product(flags.amplitudes, flags.frequencies, flags.phase_shifts, kinds):
            gait = Gait(envelope=Envelope.named(kind)(), amplitude=a, frequency=f, phase_shift=p)
            waters = [one.environment for one in fitted if one.gait.kind == gait.kind and self.base is None]
            for robot in robots.values() or (load_robot(self._names.robot),):
                chosen = self._names.resolved(gait, lambda name, n_links, robot=robot: robot)
                where = waters[0] if waters else chosen.environment
                found += swims(chosen.robot, [gait], where, _sensors(flags.sensors), duration=flags.duration)
        return found

    def _candidates(self, put: Problem) -> list[Candidate]:
        found = self._swims(put.scenarios)
        if self.candidates.no_tow:
            return found
        first: dict[str, Candidate] = {}
        for one in found:
            first.setdefault(one.measurement.scenario.robot.name, one)
        for one in first.values():
            robot, water = one.measurement.scenario.robot, one.measurement.scenario.environment
            found += [straight_tow(robot, water, Tow(speed=v)) for v in self.candidates.tow]
            found += [coast_down(robot, water, v) for v in self.candidates.coast_down]
        return found


def _unknown(word: str) -> Unknown:
    if "=" not in word:
        return Unknown(name=word)
    name, sign, (mean, *sd) = numbers("parameters", word, FORM, "+-")
    return Unknown(name=name, start=mean, prior=(mean, sd[0]) if sign else None)


def _sensors(words: tuple[str, ...]) -> dict[str, float]:
    found: dict[str, float] = {}
    for word in words:
        usual = SENSORS.get(word, ("", "", 0.0))[2]
        name, _, (sigma,) = numbers("sensors", word, SENSOR_FORM) if "=" in word else (word, "", [usual])
        if name not in SENSORS or not sigma > 0.0:
            raise BadArgument("sensors", f"must be {SENSOR_FORM}, got {word!r}")
        found[name] = sigma
    return found


def _facts(found: Design) -> dict[str, Any]:
    """The trials in their order, and the expected standard deviations after each."""

    def shares(sigma: Iterable[float]) -> dict[str, float | None]:
        values = [float(value) if math.isfinite(value) else None for value in sigma]
        return dict(zip(found.names, values, strict=True))

    def listed(steps: Iterable[Step]) -> list[dict[str, Any]]:
        named = [(step.candidate, shares(step.sigma)) for step in steps]
        return [{"trial": one.name, "kind": one.kind, "relative_sigma": sigma} for one, sigma in named]

    return {
        "criterion": found.criterion,
        "values": dict(zip(found.names, map(float, found.values), strict=True)),
        "relative_sigma_before": shares(found.before),
        "trials": listed(found.steps),
        "candidates": listed(found.alone),
        "version": __version__,
    }


def _text(found: Design) -> str:
    """The same for people, with what each trial is good for."""
    labels = [name if one.is_log else f"{name} *" for name, one in zip(found.names, found.unknowns, strict=True)]
    rows = [["after", *labels], ["what is known now", *map(_shown, found.before)]]
    rows += [[f"{i + 1}. {step.candidate.name}", *map(_shown, step.sigma)] for i, step in enumerate(found.steps)]
    kinds = {step.candidate.kind: step for step in reversed(found.alone)}
    best = sorted(kinds.values(), key=found.alone.index)
    alone = [["by itself", *labels]]
    alone += [[f"best {s.candidate.kind}: {s.candidate.name}", *map(_shown, s.sigma)] for s in best]
    right = range(1, len(labels) + 1)
    title = (
        f"The best {len(found.steps)} of {found.n_candidates} candidates, criterion {found.criterion}. Expected "
        "standard deviations (shares of the value; *: in the unit); -: not known."
    )
    reasons = "\n".join(found.reasons).replace("`", "")
    return "\n\n".join([title, aligned(rows, right=right), reasons, aligned(alone, right=right)])


def _shown(sigma: float) -> str:
    if not math.isfinite(sigma) or sigma > 100.0:
        return "-"
    return f"{number(100.0 * sigma)} %" if sigma < 10.0 else "> 1000 %"


def _draw(found: Design, path: str) -> None:
    from laticauda.figures import style
    from laticauda.figures.identification import shrinking
    from laticauda.reports.identify_figures import short_names

    figure = figures.new_figure(style.DOUBLE_COLUMN, 3.0)
    ax = figure.subplots()
    shrinking(short_names(found.names), found.sigma, ax, ylabel="expected standard deviation / value [-]", limit=LIMIT)
    figures.save_figure(figure, path)
