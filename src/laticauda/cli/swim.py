"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import File, Number, Numbers, Preset, Switch, Two, Whole, changed, changes, choice, default
from laticauda.cli.messages import flag, options
from laticauda.cli.outputs import check_output
from laticauda.robot import Environment, Water

if TYPE_CHECKING:
    from laticauda.gaits import Gait
    from laticauda.trial import Trial

PICTURES = (".png", ".pdf")
COMPILING = "compiling the kernels for this machine (once, about 10 s) ..."
WaterChanges = changes(Water, omit=("name",), otherwise="the water's")
# What may be said again when a stored run goes on; the rest is in its file.
WITH_RESUME = ("resume", "duration", "sample_interval", "json", "save", "plot")


@dataclass(frozen=True, kw_only=True)
class RobotFlags:
    """What swims."""

    robot: Annotated[Preset, default("mamba")] = None
    """A preset (`laticauda robots` lists them) or a TOML file."""
    n_links: Annotated[Whole, default("the robot's")] = None
    """Number of links to have instead, for robots whose links are all alike."""


@dataclass(frozen=True, kw_only=True)
class GaitFlags:
    """How it moves: phi_i = alpha g(i, n) sin(omega t + (i-1) delta) + phi_0, i = 1 at the tail."""

    gait: Annotated[choice("lateral-undulation", "eel-like", "custom"), default("lateral-undulation")] = None
    """The envelope g: 1, (n-i)/(n+1), or one's own."""
    envelope: Annotated[Numbers, tyro.conf.arg(help_behavior_hint="")] = None
    """g of every joint for the gait `custom`, tail first [-]."""
    amplitude_deg: Annotated[Number, default("30")] = None
    """alpha [deg]."""
    frequency_deg_s: Annotated[Number, default("130")] = None
    """omega, an angular frequency [deg/s]."""
    phase_shift_deg: Annotated[Number, default("40")] = None
    """delta between neighboring joints [deg]."""
    offset_deg: Annotated[Number, default("0")] = None
    """phi_0 of every joint; positive turns left [deg]."""

    def chosen(self) -> "Gait":
        """The gait that they describe."""
        from laticauda.gaits import Gait

        return Gait(
            kind=self.gait or "lateral-undulation",
            amplitude=_radians(self.amplitude_deg, 30.0),
            frequency=_radians(self.frequency_deg_s, 130.0),
            phase_shift=_radians(self.phase_shift_deg, 40.0),
            offset=_radians(self.offset_deg, 0.0),
            envelope=self.envelope,
        )


@dataclass(frozen=True, kw_only=True)
class EnvironmentFlags:
    """Where it moves."""

    water: Annotated[Preset, default("paper-eel for the gait eel-like, else paper-lateral")] = None
    """A preset or a TOML file."""
    ground: Annotated[Preset, tyro.conf.arg(help_behavior_hint="")] = None
    """A preset or a TOML file: crawl on land instead."""


@dataclass(frozen=True, kw_only=True)
class ModelFlags:
    """How it is computed."""

    model: Annotated[choice("planar"), default("planar")] = None
    """The model of the body."""
    joints: Annotated[choice("prescribed", "pd", "servo"), default("prescribed")] = None
    """How the joints follow the gait: exactly, by the published simulations' law, or as the real robot's servos do."""
    ramp: Annotated[Number, default("1 for prescribed joints, else 0")] = None
    """Duration of the smooth start [s]."""
    offset_bandwidth: Annotated[Number, default("10")] = None
    """Of the filters behind the gait's parameters [rad/s]."""
    dt: Annotated[Number, default("a converged one")] = None
    """Largest time step [s]."""


@dataclass(frozen=True, kw_only=True)
class RunFlags:
    """From where, how long, and what is logged."""

    duration: Annotated[Number, default("30")] = None
    """[s]."""
    sample_interval: Annotated[Number, default("0.05")] = None
    """Between two samples of the log [s]."""
    heading_deg: Annotated[Number, default("0")] = None
    """Initial heading, from the x axis [deg]."""
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
            offset_bandwidth=_or(self.model.offset_bandwidth, 10.0),
            start=Start(heading=_radians(self.run.heading_deg, 0.0)),
            link_forces=self.run.link_forces,
            progress=_progress(environment, duration),
            **settings,
        )
        return trial, origin

    def _go_on(self, path: str) -> tuple["Trial", str]:
        """The stored run and its continuation as one, and where its coefficients are from."""
        from laticauda.simulate import plant_of, resume
        from laticauda.trial import joined, load_trial

        given = [name for name, value in options(self).items() if value not in (None, False)]
        for name in given:
            if name not in WITH_RESUME:
                raise ValueError(f"`{name}` must not be given with --resume: the stored trial has its own.")
        first = load_trial(path)
        duration, settings = self._clock()
        progress = _progress(first.environment, duration)
        forces = first.link_force is not None
        second = resume(plant_of(first), first, duration, link_forces=forces, progress=progress, **settings)
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
        return _or(self.run.duration, 30.0), {"sample_interval": _or(self.run.sample_interval, 0.05)}

    def _print(self, trial: "Trial", origin: str) -> None:
        if self.output.json:
            from laticauda.cli.report import as_json

            print(as_json(trial))
        else:
            from laticauda.cli.report import as_text

            print(as_text(trial, origin))
        if not trial.succeeded:
            print(trial.status, file=sys.stderr)


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
