"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import File, Number, Numbers, Preset, Switch, Whole, changed, changes, choice, default
from laticauda.cli.messages import flag, options
from laticauda.cli.outputs import check_output
from laticauda.robot import Environment, Water

if TYPE_CHECKING:
    from laticauda.gaits import Gait
    from laticauda.interfaces import Plant
    from laticauda.trial import Trial

# What an option that is left out stands for: Mamba's trial of the paper.
AMPLITUDE_DEG, FREQUENCY_DEG_S, PHASE_SHIFT_DEG = 30.0, 130.0, 40.0
DURATION, SAMPLE_INTERVAL, OFFSET_BANDWIDTH = 30.0, 0.05, 10.0
PICTURES = (".png", ".pdf")
COMPILING = "compiling the kernels for this machine (once, about 10 s) ..."
WaterChanges = changes(Water, omit=("name",), otherwise="the water's")
# What may be said again when a stored run goes on; the rest is in its file.
WITH_RESUME = ("resume", "duration", "sample_interval", "json", "save", "plot")


@dataclass(frozen=True, kw_only=True)
class OutputFlags:
    """What becomes of it."""

    json: Switch = False
    """Print one JSON object in SI units instead of the table."""
    save: File = None
    """Write the trial to this netCDF file (.nc)."""
    plot: File = None
    """Draw path, speed, joint angles and torques into this picture (.png or .pdf)."""


@dataclass(frozen=True, kw_only=True)
class Swim:
    """Let a robot swim a gait, from straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130
    --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png
    """

    robot: RobotFlags = RobotFlags()
    gait: GaitFlags = GaitFlags()
    environment: EnvironmentFlags = EnvironmentFlags()
    coefficients: Annotated[Any, tyro.conf.arg(constructor=WaterChanges)] = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = ModelFlags()
    run: RunFlags = RunFlags()
    output: OutputFlags = OutputFlags()

    def __call__(self) -> int:
        """Run, and return the exit status."""
        check_output("save", self.output.save, (".nc",))
        check_output("plot", self.output.plot, PICTURES)
        trial, origin = self._swim() if self.run.resume is None else self._go_on(self.run.resume)
        if self.output.save is not None:
            trial.save(self.output.save)
        if self.output.plot is not None:
            from laticauda.figures import save_figure, swim_sheet

            save_figure(swim_sheet(trial), self.output.plot)
        self._print(trial, origin)
        return 0 if trial.succeeded else 1

    def _swim(self) -> tuple["Trial", str]:
        """The run, and where its coefficients are from."""
        from laticauda.interfaces import Start
        from laticauda.robot import load_robot
        from laticauda.simulate import swim

        gait = self.gait.chosen()
        robot = load_robot(self.robot.robot or "mamba", self.robot.n_links)
        environment, origin = self._environment(gait)
        duration, settings = self._clock()
        trial = swim(
            robot,
            gait,
            duration,
            environment=environment,
            model=self.model.model or "planar",
            joints=self.model.joints or "prescribed",
            dt=self.model.dt,
            ramp=self.model.ramp,
            offset_bandwidth=_or(self.model.offset_bandwidth, OFFSET_BANDWIDTH),
            start=Start(heading=_radians(self.run.heading_deg, 0.0)),
            link_forces=self.run.link_forces,
            progress=_progress(environment, duration),
            **settings,
        )
        return trial, origin

    def _go_on(self, path: str) -> tuple["Trial", str]:
        """The stored run and its continuation as one, and where its coefficients are from."""
        from laticauda.simulate import resume
        from laticauda.trial import joined, load_trial

        given = [name for name, value in options(self).items() if value not in (None, False)]
        for name in given:
            if name not in WITH_RESUME:
                raise ValueError(f"`{name}` must not be given with --resume: the stored trial has its own.")
        first = load_trial(path)
        duration, settings = self._clock()
        progress = _progress(first.environment, duration)
        forces = first.link_force is not None
        second = resume(_plant_of(first), first, duration, link_forces=forces, progress=progress, **settings)
        return joined(first, second), f"as stored in {path}"

    def _environment(self, gait: "Gait") -> tuple[Environment, str]:
        """Where the robot moves, and where its coefficients are from."""
        from laticauda.robot import load_ground, load_water
        from laticauda.simulate import default_water

        wanted = self.environment
        if wanted.ground is not None:
            for name, value in {"water": wanted.water, **options(self.coefficients)}.items():
                if value not in (None, False):
                    raise ValueError(f"`{name}` must not be given with --ground: it belongs to water.")
            return load_ground(wanted.ground), "as asked for"
        preset = wanted.water or default_water(gait)
        origin = "as asked for" if wanted.water else f"the paper's for {gait.kind.replace('_', ' ')}"
        if gait.kind == "custom" and not wanted.water:
            origin = "the paper's for lateral undulation, in want of its own"
        return changed(load_water(preset), self.coefficients), origin

    def _clock(self) -> tuple[float, dict[str, float]]:
        """The duration, and how often to sample."""
        return _or(self.run.duration, DURATION), {"sample_interval": _or(self.run.sample_interval, SAMPLE_INTERVAL)}

    def _print(self, trial: "Trial", origin: str) -> None:
        if self.output.json:
            from laticauda.cli.report import as_json

            print(as_json(trial))
        else:
            from laticauda.cli.report import as_text

            print(as_text(trial, origin))
        if not trial.succeeded:
            print(trial.status, file=sys.stderr)


def _plant_of(trial: "Trial") -> "Plant[Any]":
    """The plant that a stored trial was made with."""
    from laticauda.simulate import plant

    settings: Any = trial.settings
    if settings.get("fluid_law", "built-in") != "built-in":
        raise ValueError(f"`resume` must be a trial with a built-in fluid law, got one with `{settings['fluid_law']}`.")
    names = ("model", "joints", "dt", "offset_bandwidth", "ramp")
    return plant(trial.robot, trial.environment, **{name: settings[name] for name in names if name in settings})


def _progress(environment: Environment, duration: float) -> Callable[[float], None]:
    """Say that kernels will be compiled, if so, and return what shows the progress of the run."""
    from laticauda.cli.progress import progress
    from laticauda.simulate import needs_compiling

    if needs_compiling(environment):
        print(COMPILING, file=sys.stderr, flush=True)
    return progress(duration)


def _or(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value


def _radians(degrees: float | None, otherwise: float) -> float:
    return math.radians(_or(degrees, otherwise))
