"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import File, Number, Switch, changed, default
from laticauda.cli.groups import (
    Coefficients,
    EnvironmentFlags,
    GaitFlags,
    ModelFlags,
    RobotFlags,
    WaterChanges,
    radians,
)
from laticauda.cli.messages import given, in_flags
from laticauda.cli.outputs import check_output
from laticauda.cli.view import check_film, write_film
from laticauda.robot import Environment

if TYPE_CHECKING:
    from laticauda.scenarios import Model, Scenario
    from laticauda.trial import Trial

DURATION = 30.0  # [s]
PICTURES = (".png", ".pdf")
COMPILING = "compiling the kernels for this machine (once, about 10 s) ..."
CLOCK = ("duration", "sample_interval")
# All else is in the stored trial.
WITH_RESUME = ("resume", *CLOCK, "json", "save", "plot", "video")


@dataclass(frozen=True, kw_only=True)
class RunFlags:
    """From where, how long, and what is logged."""

    duration: Annotated[Number, default(f"{DURATION:g}")] = None
    """How long to swim [s]."""
    sample_interval: Annotated[Number, default("0.05")] = None
    """Between two samples of the log [s]."""
    heading_deg: Annotated[Number, default("0")] = None
    """Initial heading, counter-clockwise from the x axis [deg]."""
    link_forces: Switch = False
    """Log the force on every link too."""
    resume: File = None
    """Go on from the end of this stored trial, with its robot, gait and water; the result is the whole run."""


@dataclass(frozen=True, kw_only=True)
class OutputFlags:
    """What becomes of it."""

    json: Switch = False
    """Print one JSON object in SI units instead of the table."""
    save: File = None
    """Write the trial to this netCDF file (.nc)."""
    save_scenario: File = None
    """Write what was run, with all its numbers, to this TOML file, from which it can be run again."""
    plot: File = None
    """Draw path, speed, joint angles and torques into this picture (.png or .pdf)."""
    video: File = None
    """Show the run in 3D in this film (.mp4)."""


@dataclass(frozen=True, kw_only=True)
class Swim:
    """Let a robot swim a gait, from straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130
    --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png
    """

    scenario: Annotated[
        str | None, tyro.conf.Positional, tyro.conf.arg(metavar="SCENARIO", help_behavior_hint="(default: none)")
    ] = None
    """A TOML file that says all; other options change it."""
    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    environment: EnvironmentFlags = field(default_factory=EnvironmentFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = field(default_factory=ModelFlags)
    run: RunFlags = field(default_factory=RunFlags)
    output: OutputFlags = field(default_factory=OutputFlags)

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        check_output("save", self.output.save, (".nc",))
        check_output("save_scenario", self.output.save_scenario, (".toml",))
        check_output("plot", self.output.plot, PICTURES)
        check_film(self.output.video)
        trial, origin = self._swim() if self.run.resume is None else self._go_on(self.run.resume)
        if self.output.save is not None:
            trial.save(self.output.save)
        if self.output.plot is not None:
            from laticauda.figures import save_figure, swim_sheet

            save_figure(swim_sheet(trial), self.output.plot)
        if self.output.video is not None:
            write_film(trial, self.output.video)
        self._print(trial, origin)
        return 0 if trial.succeeded else 1

    def _swim(self) -> tuple["Trial", str]:
        """The run, and where its coefficients are from."""
        from laticauda.scenarios import save_scenario
        from laticauda.simulate import swim

        chosen, origin = self._chosen() if self.scenario is None else self._changed(self.scenario)
        if self.output.save_scenario is not None:
            save_scenario(chosen, self.output.save_scenario)
        trial = swim(
            chosen,
            link_forces=self.run.link_forces,
            progress=announced(chosen.environment, chosen.duration, model=chosen.model),
        )
        return trial, origin

    def _chosen(self) -> tuple["Scenario", str]:
        """The scenario that the options say."""
        from laticauda.interfaces import Start
        from laticauda.scenarios import scenario

        gait = self.gait.chosen()
        environment, origin = self.environment.chosen(gait, self.coefficients)
        chosen = scenario(
            self.environment.equipped(self.robot.chosen(), gait),
            gait,
            environment=environment,
            start=Start(heading=radians(self.run.heading_deg, 0.0)),
            **self.environment.model_settings(self.model),
            **self._clock(),
        )
        return chosen, origin

    def _changed(self, path: str) -> tuple["Scenario", str]:
        """The scenario of a file, with what other options say."""
        from laticauda.gaits import Gait
        from laticauda.interfaces import Start
        from laticauda.scenarios import load_scenario, model_of

        base, origin = load_scenario(path), f"as {path} says"
        parts: dict[str, Any] = {name: one for name, one in given(self.run).items() if name in CLOCK}
        if given(self.gait):
            if not isinstance(base.motion, Gait):
                raise ValueError(f"`{next(iter(given(self.gait)))}` must not be given: `scenario` has a controller.")
            parts["motion"] = self.gait.changed(base.motion)
        gait = parts.get("motion", base.gait)
        if given(self.environment):
            parts["environment"], origin = self.environment.chosen(gait, self.coefficients)
        elif given(self.coefficients):
            parts["environment"] = changed(base.environment, self.coefficients)
        if given(self.robot) or self.environment.parameters is not None:
            robot = self.robot.chosen() if given(self.robot) else base.robot
            parts["robot"] = self.environment.equipped(robot, gait)
        settings = self.environment.model_settings(self.model)
        if settings:
            parts["model"] = model_of(settings.pop("model", base.model), **settings)
        if self.run.heading_deg is not None:
            parts["start"] = Start(heading=radians(self.run.heading_deg, 0.0))
        return replace(base, **parts), origin

    def _go_on(self, path: str) -> tuple["Trial", str]:
        """The stored run and its continuation as one, and where its coefficients are from."""
        from laticauda.logs import load_trial
        from laticauda.simulate import plant, resume
        from laticauda.trial import joined

        for name in given(self):
            if name not in WITH_RESUME:
                raise ValueError(f"`{name}` must not be given with `resume`: the stored trial has its own.")
        first = load_trial(path)
        second = resume(
            plant(first.scenario),
            first,
            link_forces=first.link_force is not None,
            progress=announced(first.environment, model=first.scenario.model, **self._clock()),
            **self._clock(),
        )
        return joined(first, second), f"as stored in {path}"

    def _clock(self) -> dict[str, Any]:
        """How long, and how often to sample."""
        return {"duration": DURATION} | {name: value for name, value in given(self.run).items() if name in CLOCK}

    def _print(self, trial: "Trial", origin: str) -> None:
        from laticauda.cli.report import as_json, as_text

        print(as_json(trial) if self.output.json else as_text(trial, origin))
        if not trial.succeeded:
            print(in_flags(trial.status, self), file=sys.stderr)


def announced(
    environment: Environment, duration: float, *, model: "Model | str | None" = None, **_: object
) -> Callable[[float], None]:
    """Say that kernels will be compiled, if so, and return what shows the progress of the run.

    Args:
        environment: Where it will swim.
        duration: How long [s].
        model: By which model; None: planar.
    """
    from laticauda.cli.progress import progress
    from laticauda.simulate import needs_compiling

    if needs_compiling(environment, model=model):
        print(COMPILING, file=sys.stderr, flush=True)
    return progress(duration)
