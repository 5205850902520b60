"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

from laticauda.cli.flags import File, Number, Switch, default
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
        from laticauda.interfaces import Start
        from laticauda.simulate import swim

        gait = self.gait.chosen()
        environment, origin = self.environment.chosen(gait, self.coefficients)
        robot = self.environment.equipped(self.robot.chosen(), gait)
        trial = swim(
            robot,
            gait,
            environment=environment,
            start=Start(heading=radians(self.run.heading_deg, 0.0)),
            link_forces=self.run.link_forces,
            progress=announced(environment, model=self.model.model, **self._clock()),
            **self.environment.model_settings(self.model),
            **self._clock(),
        )
        return trial, origin

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
            progress=announced(first.environment, model=str(first.settings.get("model")), **self._clock()),
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
    environment: Environment, duration: float, *, model: str | None = None, **_: object
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
