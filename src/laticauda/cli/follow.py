"""`laticauda follow`: one run along a path, its figures, its file and its picture."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal

from laticauda import control, simulate
from laticauda.cli.command import Outcome
from laticauda.cli.flags import read
from laticauda.cli.progress import PATIENCE, SHARE, progress
from laticauda.cli.report import following_table
from laticauda.cli.scene import Names
from laticauda.cli.swim import Run
from laticauda.errors import BadArgument
from laticauda.interfaces import Start
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario


@value
class Route(control.Course):
    """Where to go, and by which law."""

    waypoints: tuple[float, ...] = quantity("m", "Corners of the path, x1 y1 x2 y2 ...; none: the x axis", default=())
    guidance: Literal["line-of-sight", "integral-line-of-sight", "model-predictive"] = option(
        "The last two learn a current; model-predictive plans ahead, by a model fitted first", default="line-of-sight"
    )
    observe_current: bool = option(
        "Observe the current and point upstream, with a model of the gait fitted to four trials in still water first",
        default=False,
    )

    @property
    def following(self) -> control.Following:
        """In numbers, with the paper's settings for Mamba, and where published integral guidance starts from."""
        if len(self.waypoints) % 2:
            count = len(self.waypoints)
            raise BadArgument("waypoints", f"must be pairs of numbers, x1 y1 x2 y2 ..., got {count} numbers")
        if self.path_depth and self.guidance == "model-predictive":
            raise BadArgument("path_depth", "must be left out with the guidance model-predictive, which plans in plan")
        guidance: Any = "line_of_sight" if self.guidance == "model-predictive" else self.guidance.replace("-", "_")
        return control.Following(
            waypoints=tuple(zip(self.waypoints[::2], self.waypoints[1::2], strict=True)) or None,
            guidance=guidance,
            **{name: getattr(self, name) for name in control.Course.__dataclass_fields__},
        )


@value
class Follow(Run):
    """Let a robot follow a path with its gait, from beside it, and print how soon and how well it came there.

    For example: laticauda follow --robot mamba-fin --waypoints 0 0 3 0 6 2 --smooth --duration 60 --save run.nc --plot
    run.png
    """

    route: Route = option("Where to go, and by which law", default=Route())
    sheet: ClassVar[str] = "follow_sheet"

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """The command that was typed; see `OfScenario.read`."""
        names, route = Names.read(words, prog), read(Route, words, prog, first=True)
        scenario, origin = names.scenario(words)
        kind = FollowPlanned if route.guidance == "model-predictive" else cls
        if scenario.motion == scenario.gait:  # a file may have a controller
            motion = scenario.gait if kind is FollowPlanned else route.following.controller(scenario.gait)
            scenario = replace(scenario, motion=motion, duration=90.0, start=Start(center_of_mass=(0.0, 1.0)))
        return kind.about(scenario, words, prog, choice=names, origin=origin, route=route)

    def run(self) -> Outcome:
        """Run and write."""
        trial = self.swum(self.steered(self.chosen))
        return self.outcome(trial, self.origin, f"\n\n{following_table(trial)}")

    def steered(self, scenario: Scenario) -> Scenario:
        """The scenario with the controller that is asked for.

        Args:
            scenario: With the numbers that were typed.
        """
        motion = scenario.motion
        if not self.route.observe_current or not isinstance(motion, control.PathFollowing):
            return scenario
        return replace(scenario, motion=replace(motion, observer=control.CurrentObserver(model=learned(scenario))))


@value
class FollowPlanned(Follow):
    """Let a robot follow a path by planning ahead, with a model that it fits to four trials of its own first.

    For example: laticauda follow --robot mamba-fin --guidance model-predictive --current 0 -0.03 --duration 60
    """

    speed: float | None = quantity("m/s", "Speed along the path; none: what the gait swims", gt=0.0, default=None)
    plan: control.PlanLimits = option("Model-predictive guidance", default=control.PlanLimits())

    def steered(self, scenario: Scenario) -> Scenario:
        """The scenario with a controller whose model is fitted now; see `Follow.steered`."""
        gait, model = scenario.gait, learned(scenario, self.plan.frequency_limits)
        speed = model.speed(gait.frequency, 0.0) if self.speed is None else self.speed
        path, plan = self.route.following.path, vars(self.plan)
        motion = control.ModelPredictive(gait=gait, path=path, model=model, speed=speed, **plan)
        return replace(scenario, motion=motion)


def learned(scenario: Scenario, frequency_limits: tuple[float, float] | None = None) -> control.AveragedModel:
    """How its gait moves its robot, from trials that are run now.

    Args:
        scenario: Of the robot.
        frequency_limits: See `studies.averaged_model` [rad/s].
    """
    from laticauda.studies import averaged_model

    show = progress(SHARE, what="learned how the gait moves the robot", patience=PATIENCE)
    return averaged_model(simulate.plant(scenario), scenario.gait, frequency_limits, progress=show)
