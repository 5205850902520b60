"""`laticauda follow`: a run along a path, and how soon and how well it converges.

The guidance law decides which options there are: one that plans ahead has limits of its plan, and
learns a model of the gait first (`laticauda.cli.follow_planned`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import laticauda as lc
from laticauda import control
from laticauda.cli import command, flags, progress, report, scene
from laticauda.cli.short_forms import write_out
from laticauda.cli.swim import ScenarioRun
from laticauda.models import simulate
from laticauda.values import BadArgument, fields_of, option, quantity, value_class

FOLLOWING_DURATION = 90.0
"""Duration of a run along a path, unless it is typed [s]."""
START_BESIDE_PATH = (0.0, 1.0)
"""Where the robot starts, unless it is typed [m]."""


@value_class
class Route(control.Course, flags.Options):
    """Where to go, and by which guidance law."""

    waypoints: tuple[float, ...] = quantity(
        "m", "Corners of the path, x1 y1 x2 y2 ...; none: the x axis", default=()
    )
    guidance: Literal["line-of-sight", "integral-line-of-sight", "model-predictive"] = option(
        "The last two learn a current; model-predictive plans ahead, with a model fitted first",
        default="line-of-sight",
    )
    observe_current: bool = option(
        "Observe the current and point upstream, with a model of the gait fitted to four trials in still water first",
        default=False,
    )

    @property
    def following(self) -> control.Following:
        """Path-following parameters: the paper's for Mamba, with the integral gain where published guidance starts."""
        return self._following_by(self.guidance.replace("-", "_"))

    @property
    def planned_path(self) -> control.Path[Any]:
        """The path alone, for guidance that plans ahead, which `control.Following` does not have.

        The path is the same under every law of guidance.
        """
        if self.path_depth:
            rule = "must be left out with model-predictive guidance, which plans horizontally"
            raise BadArgument("path_depth", rule)
        return self._following_by("line_of_sight").path

    def _following_by(self, guidance: Any) -> control.Following:
        corners = self._corners()
        course = {name: getattr(self, name) for name in fields_of(control.Course)}
        return control.Following(waypoints=corners or None, guidance=guidance, **course)

    def _corners(self) -> tuple[tuple[float, float], ...]:
        n_numbers = len(self.waypoints)
        if n_numbers % 2:
            rule = "must be pairs of numbers, x1 y1 x2 y2 ..."
            raise BadArgument("waypoints", f"{rule}, got {n_numbers} numbers")
        x = self.waypoints[::2]
        y = self.waypoints[1::2]
        return tuple(zip(x, y, strict=True))

    @property
    def plans_ahead(self) -> bool:
        """Whether the guidance is model-predictive."""
        return self.guidance == "model-predictive"


@value_class
class Follow(ScenarioRun):
    """Let a robot follow a path with its gait, starting off the path, and print how soon and how well it converges.

    For example: laticauda follow --robot mamba-fin --waypoints 0 0 3 0 6 2 --smooth --duration 60
    --save run.nc --plot run.png
    """

    route: Route = option("Path to follow, and guidance law", default=Route())

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed; see `OfScenario.read`.

        The route is read first, too: on its guidance law depend the class of the command, and the
        controller whose numbers are flags.
        """
        arguments = write_out(arguments, accepts_file=True)
        names = scene.Names.read(arguments, prog)
        route: Route = flags.parse_command(Route, arguments, prog, known_only=True)
        named = names.resolve_scenario(arguments)
        scenario = named.scenario
        if scenario.motion == scenario.gait:
            scenario = _start_beside_path(scenario, route)
        else:
            _refuse_another_route(scenario, arguments)
        command_class = cls
        if route.plans_ahead:
            # It imports this module, and is left out where planning is (see `tests/test_guests.py`).
            from laticauda.cli.follow_planned import FollowPlanned

            command_class = FollowPlanned
        return command_class.read_numbers(
            scenario,
            arguments,
            prog,
            choice=names,
            origin=named.origin,
            basis=named.basis,
            route=route,
        )

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        trial = self.run_scenario(self.with_controller(self.scenario_to_run))
        table = ""
        if self.all:
            table = f"\n\n{report.following_table(trial)}"
        return self.write_and_report(trial, self.origin, further_text=table, basis=self.basis)

    def with_controller(self, scenario: lc.Scenario) -> lc.Scenario:
        """Return the scenario with the requested controller.

        Args:
            scenario: Scenario with the numbers that were typed.
        """
        motion = scenario.motion
        if not self.route.observe_current or not isinstance(motion, control.PathFollowing):
            return scenario
        observer = control.CurrentObserver(model=learn_model(scenario))
        return replace(scenario, motion=replace(motion, observer=observer))


def _start_beside_path(scenario: lc.Scenario, route: Route) -> lc.Scenario:
    """Return a run that starts beside the path, with the controller of the route."""
    motion: Any = scenario.gait  # one that plans ahead learns a model first, see `FollowPlanned`
    if not route.plans_ahead:
        motion = route.following.controller(scenario.gait)
    return replace(
        scenario,
        motion=motion,
        duration=FOLLOWING_DURATION,
        start=lc.Start(center_of_mass=START_BESIDE_PATH),
    )


def _refuse_another_route(scenario: lc.Scenario, arguments: Sequence[str]) -> None:
    """Refuse the options of `Route` that a scenario file with a controller leaves without effect.

    Args:
        scenario: Scenario of the file, which has a path and a guidance law of its own.
        arguments: What was typed, the file first.
    """
    for field in fields_of(Route).values():
        if not flags.was_typed(field, arguments):
            continue
        if field.name == "observe_current" and isinstance(scenario.motion, control.PathFollowing):
            continue
        controller = f"{arguments[0]}, whose controller has its own path and guidance"
        raise flags.BadFlag(f"{flags.spell_option(field)} must not be given with {controller}.")


def learn_model(
    scenario: lc.Scenario, frequency_limits: tuple[float, float] | None = None
) -> control.AveragedModel:
    """Learn how the gait of a scenario moves its robot, by running trials.

    Args:
        scenario: Scenario of the robot.
        frequency_limits: Lowest and highest frequency of the trials; None: a third below and above
            the gait's [rad/s].
    """
    from laticauda.studies import averaged_model

    show = progress.show_progress(
        progress.SHARE,
        what="learned how the gait moves the robot",
        patience=progress.PATIENCE,
    )
    return averaged_model(
        simulate.build_plant(scenario), scenario.gait, frequency_limits, progress=show
    )
