"""`laticauda follow`: one run along a path, its figures, its file and its picture."""

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

from laticauda.cli.flags import Number, Numbers, Switch, choice, default
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
from laticauda.cli.planned import PlanFlags
from laticauda.cli.swim import PICTURES, OutputFlags, announced
from laticauda.cli.view import check_film, write_film

if TYPE_CHECKING:
    from laticauda.control import Guidance, ModelPredictive, Path, PathFollowing
    from laticauda.gaits import Gait
    from laticauda.interfaces import Plant

DURATION = 90.0  # [s]
GUIDANCE = ("line-of-sight", "integral-line-of-sight", "model-predictive")
# The paper's settings for Mamba, and where published integral guidance starts from.
LOOK_AHEAD, GAIN, MAX_OFFSET_DEG, INTEGRAL_GAIN, INTERVAL = 0.18, 0.4, 20.0, 0.12, 0.05


@dataclass(frozen=True, kw_only=True)
class PathFlags:
    """Where to go; the x axis if nothing is said."""

    waypoints: Annotated[Numbers, default("the x axis")] = None
    """Corners of the path, x1 y1 x2 y2 ... [m]."""
    smooth: Switch = False
    """A smooth curve through the waypoints instead of straight legs."""
    acceptance_distance: Annotated[Number, default("0")] = None
    """Distance from a corner at which the next leg begins [m]."""

    def chosen(self) -> "Path[Any]":
        """The path that is asked for."""
        from laticauda.control import Polyline, Spline, StraightLine

        if self.waypoints is None:
            return StraightLine()
        if len(self.waypoints) % 2:
            raise ValueError(
                f"`waypoints` must be pairs of numbers, x1 y1 x2 y2 ..., got {len(self.waypoints)} numbers."
            )
        points = tuple(zip(self.waypoints[::2], self.waypoints[1::2], strict=True))
        if self.smooth:
            return Spline(waypoints=points)
        return Polyline(waypoints=points, acceptance_distance=self.acceptance_distance or 0.0)


@dataclass(frozen=True, kw_only=True)
class GuidanceFlags:
    """How it is led there."""

    guidance: Annotated[str | None, choice(*GUIDANCE), default(GUIDANCE[0])] = None
    """The guidance law; the last two learn a current, and model-predictive plans ahead."""
    look_ahead_distance: Annotated[Number, default(f"{LOOK_AHEAD:g}")] = None
    """Delta; model-predictive falls back on line of sight with 1.62 [m]."""
    integral_gain: Annotated[Number, default(f"{INTEGRAL_GAIN:g}")] = None
    """sigma of the integral law [m/s]."""
    gain: Annotated[Number, default(f"{GAIN:g}")] = None
    """k, offset per heading error; 0.25 where model-predictive falls back [-]."""
    max_offset_deg: Annotated[Number, default(f"{MAX_OFFSET_DEG:g}")] = None
    """Largest offset of the joints to either side [deg]."""
    heading_estimate: Annotated[str | None, choice("raw", "cycle-mean"), default("raw")] = None
    """The heading that is controlled: the mean link angle as it is, or its mean over the last gait cycle."""
    control_interval: Annotated[Number, default(f"{INTERVAL:g}, or 0.2 for model-predictive")] = None
    """Time between two control instants [s]."""
    plan: PlanFlags = field(default_factory=PlanFlags)

    def law(self) -> "Guidance[Any]":
        """The guidance law that is asked for."""
        from laticauda.control import IntegralLineOfSight, LineOfSight

        distance = LOOK_AHEAD if self.look_ahead_distance is None else self.look_ahead_distance
        if self.guidance == "integral-line-of-sight":
            gain = INTEGRAL_GAIN if self.integral_gain is None else self.integral_gain
            return IntegralLineOfSight(look_ahead_distance=distance, integral_gain=gain)
        return LineOfSight(look_ahead_distance=distance)

    def controller(self, gait: "Gait", path: "Path[Any]", body: "Plant[Any]") -> "PathFollowing | ModelPredictive":
        """Path following with all of it.

        Args:
            gait: What swims.
            path: Where to go.
            body: The robot in its water.
        """
        if self.guidance == GUIDANCE[-1]:
            return self._planned(gait, path, body)
        for name in given(self.plan):
            raise ValueError(f"`{name}` must not be given without `guidance` {GUIDANCE[-1]}.")
        from laticauda.control import HeadingController, PathFollowing

        return PathFollowing(
            gait=gait,
            path=path,
            guidance=self.law(),
            heading=HeadingController(
                gain=GAIN if self.gain is None else self.gain,
                max_offset=radians(self.max_offset_deg, MAX_OFFSET_DEG),
            ),
            heading_estimate=self.heading_estimate or "raw",
            interval=INTERVAL if self.control_interval is None else self.control_interval,
        )

    def _planned(self, gait: "Gait", path: "Path[Any]", body: "Plant[Any]") -> "ModelPredictive":
        for name in ("integral_gain", "heading_estimate"):
            if getattr(self, name) is not None:
                raise ValueError(f"`{name}` must not be given with `guidance` {GUIDANCE[-1]}.")
        fields = {"look_ahead_distance": "look_ahead_distance", "gain": "gain", "control_interval": "interval"}
        settings = {fields[name]: value for name, value in given(self).items() if name in fields}
        settings["max_offset"] = radians(self.max_offset_deg, MAX_OFFSET_DEG)
        return self.plan.controller(gait, path, body, settings)


@dataclass(frozen=True, kw_only=True)
class StartFlags:
    """From where, and how long."""

    position: Annotated[Numbers, default("0 1")] = None
    """Where the center of mass starts, x y [m]."""
    heading_deg: Annotated[Number, default("0")] = None
    """Initial heading, counter-clockwise from the x axis [deg]."""
    duration: Annotated[Number, default(f"{DURATION:g}")] = None
    """How long to swim [s]."""


@dataclass(frozen=True, kw_only=True)
class Follow:
    """Let a robot follow a path, and print how soon and how well it came to it.

    For example: laticauda follow --robot mamba-fin --frequency-deg-s 90 --position 0 1.848 --heading-deg 7.7
    --plot follow.png
    """

    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    path: PathFlags = field(default_factory=PathFlags)
    guidance: GuidanceFlags = field(default_factory=GuidanceFlags)
    start: StartFlags = field(default_factory=StartFlags)
    environment: EnvironmentFlags = field(default_factory=EnvironmentFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = field(default_factory=ModelFlags)
    output: OutputFlags = field(default_factory=OutputFlags)

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        check_output("save", self.output.save, (".nc",))
        check_output("plot", self.output.plot, PICTURES)
        check_film(self.output.video)
        from laticauda.cli.report import as_json, as_text, following_table
        from laticauda.interfaces import Start
        from laticauda.simulate import plant, run

        gait = self.gait.chosen()
        environment, origin = self.environment.chosen(gait, self.coefficients)
        position = (0.0, 1.0) if self.start.position is None else self.start.position
        if len(position) != 2:
            raise ValueError(f"`position` must be two numbers, x y [m], got {len(position)}.")
        duration = DURATION if self.start.duration is None else self.start.duration
        robot = self.environment.equipped(self.robot.chosen(), gait)
        body = plant(robot, environment, **self.environment.model_settings(self.model))
        progress = announced(environment, duration, model=self.model.model)
        controller = self.guidance.controller(gait, self.path.chosen(), body)
        start = Start(center_of_mass=(position[0], position[1]), heading=radians(self.start.heading_deg, 0.0))
        trial = run(body, controller, duration, start=start, progress=progress)
        if self.output.save is not None:
            trial.save(self.output.save)
        if self.output.plot is not None:
            from laticauda.figures import follow_sheet, save_figure

            save_figure(follow_sheet(trial), self.output.plot)
        if self.output.video is not None:
            write_film(trial, self.output.video)
        print(as_json(trial) if self.output.json else f"{as_text(trial, origin)}\n\n{following_table(trial)}")
        if not trial.succeeded:
            print(in_flags(trial.status, self), file=sys.stderr)
        return 0 if trial.succeeded else 1
