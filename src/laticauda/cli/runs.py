"""`laticauda swim | follow | replay`: one run of one robot, its figures, file and picture.

The robot swims its gait or follows a path; or its recorded operation becomes a trial, and passes
through the estimator and the controller again.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import laticauda as lc
from laticauda import control
from laticauda.cli import command, flags, progress, report, scene
from laticauda.cli.flags import BadFlag, File, Files, TomlOutput
from laticauda.cli.trial_output import Recording
from laticauda.control import estimation
from laticauda.models import simulate
from laticauda.show import figures
from laticauda.tank import operate
from laticauda.values import BadArgument, fields_of, option, quantity, value_class


@value_class
class ScenarioRun(scene.OfScenarioOrFile, Recording):
    """A command that runs one scenario."""

    link_forces: bool = option("Also log the force on every link", default=False)
    save_scenario: TomlOutput = option("Write the scenario to this file (.toml)", default=None)

    def run_scenario(self, scenario: lc.Scenario) -> lc.Trial:
        """Return the trial of a scenario, which is written to a file if requested.

        Args:
            scenario: Scenario to run.
        """
        if self.save_scenario is not None:
            lc.save_scenario(scenario, self.save_scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        return lc.swim(
            scenario, link_forces=self.link_forces, progress=progress.run_bar(scenario.duration)
        )


@value_class
class Swim(ScenarioRun):
    """Let a robot swim a gait, starting straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30
    --frequency-deg-s 130 --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png
    """

    resume: File = option(
        "Continue from the end of this stored trial, with its robot, gait and water", default=None
    )
    interval: bool = option(
        "Also print intervals from those of the textbook coefficients (8 more runs)", default=False
    )

    beside: Files = option(
        "Scenarios of more robots in the same scene, saved as run-1.nc, ... by --save", default=()
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed; see `OfScenario.read`."""
        if flags.was_typed(fields_of(cls)["resume"], arguments):
            return ResumeSwim.read(arguments, prog)
        return super().read(arguments, prog)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        if self.beside:
            return self._run_together()
        trial = self.run_scenario(self.scenario_to_run)
        if not self.interval:
            return self.write_and_report(trial, self.origin)
        varied = simulate.intervals_of(self.scenario_to_run)
        intervals = simulate.figure_intervals(trial, varied)
        table = report.interval_table(trial, intervals, varied)
        return self.write_and_report(
            trial,
            self.origin,
            further_text=f"\n\n{table}",
            further_facts={"interval": intervals},
        )

    def _run_together(self) -> command.Outcome:
        """Run the robot and those of further scenario files in one scene."""
        scenarios = [self.scenario_to_run, *map(lc.load_scenario, self.beside)]
        bar = progress.run_bar(self.scenario_to_run.duration)
        trial, *neighbors = lc.swim_together(scenarios, progress=bar)
        return self.write_and_report(
            trial,
            self.origin,
            further_text="".join(
                f"\n\n{report.describe_trial(neighbor)}" for neighbor in neighbors
            ),
            further_facts={"beside": [report.facts_of_trial(neighbor) for neighbor in neighbors]},
            neighbors=neighbors,
        )


@value_class
class ResumeSwim(Recording):
    """Continue from the end of a stored trial, with its robot, gait and water; the result is the whole run."""

    resume: File = option("The stored trial", default=None)
    duration: float = quantity("s", "Further duration", gt=0.0, default=30.0)
    sample_interval: float = quantity(
        "s", "Time between two samples of the log", gt=0.0, default=0.05
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> "ResumeSwim":
        """Return the command that was typed; arguments as for `Swim.read`.

        Raises:
            BadFlag: If an option sets what the stored trial already defines.
        """
        allowed = {flags.spell_option(field) for field in flags.options_of(cls())} | {"--help"}
        for argument in arguments:
            flag = flags.spell_typed_flag(argument)
            if flag.startswith("--") and flag not in allowed:
                rule = "must not be given with --resume: the stored trial has its own"
                raise BadFlag(f"{flag} {rule}.")
        return flags.parse_command(cls, arguments, prog)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        assert self.resume is not None
        first = lc.load_trial(self.resume)
        if not isinstance(first.scenario, lc.Scenario):
            lacking = f"{self.resume}, which lacks {first.scenario.lacks}"
            raise BadFlag(f"--resume must be a simulated trial, got {lacking}")
        scenario = replace(first.scenario, duration=self.duration)
        plant = lc.build_plant(scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        second = lc.resume(
            plant,
            first,
            self.duration,
            sample_interval=self.sample_interval,
            link_forces=first.link_force is not None,
            progress=progress.run_bar(self.duration),
        )
        whole_run = lc.joined(first, second)
        return self.write_and_report(whole_run, f"as stored in {self.resume}")


# ---- along a path --------------------------------------------------------------------------------


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
        n_numbers = len(self.waypoints)
        if n_numbers % 2:
            rule = "must be pairs of numbers, x1 y1 x2 y2 ..."
            raise BadArgument("waypoints", f"{rule}, got {n_numbers} numbers")
        guidance: Any = self.guidance.replace("-", "_")
        if self.plans_ahead:
            guidance = "line_of_sight"
            if self.path_depth:
                rule = "must be left out with model-predictive guidance, which plans horizontally"
                raise BadArgument("path_depth", rule)
        course = {name: getattr(self, name) for name in fields_of(control.Course)}
        corners = tuple(zip(self.waypoints[::2], self.waypoints[1::2], strict=True))
        return control.Following(waypoints=corners or None, guidance=guidance, **course)

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
        """Return the command that was typed; see `OfScenario.read`."""
        names = scene.Names.read(arguments, prog)
        route: Route = flags.parse_command(Route, arguments, prog, known_only=True)
        scenario, origin = names.resolve_scenario(arguments)
        command_class = cls
        if route.plans_ahead:
            from laticauda.cli.follow_planned import FollowPlanned  # a guest's command

            command_class = FollowPlanned
        if scenario.motion == scenario.gait:  # a file may have a controller
            scenario = _start_beside_path(scenario, route)
        return command_class.read_numbers(
            scenario, arguments, prog, choice=names, origin=origin, route=route
        )

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        trial = self.run_scenario(self.with_controller(self.scenario_to_run))
        table = report.following_table(trial)
        return self.write_and_report(trial, self.origin, further_text=f"\n\n{table}")

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


# ---- recorded operations -------------------------------------------------------------------------


@value_class
class Replay(Recording):
    """Make a trial from a recorded operation, and print its figures.

    The speed is by equation (5), the power by (4) from the power meter. A truncated recording is
    replayed as far as it goes. --estimate and --control run the recorded estimator and controller
    again on the recorded data, --learn the learning twin.

    For example: laticauda replay run.mcap --save run.nc --estimate --control
    """

    file: flags.FileArgument = option("The recording, as `laticauda operate` wrote it (.mcap)")
    estimate: bool = option(
        "Estimate the motion again from the recorded samples, for the trial", default=False
    )
    kinematics: bool = option(
        "Estimate the motion by kinematics alone, without the filter", default=False
    )
    control: bool = option(
        "Run the controller again, and compare its commands with the recorded ones", default=False
    )
    learn: bool = option(
        "Learn water, current and changes of the robot from the recorded samples", default=False
    )
    plot_timing: flags.PictureOutput = option(
        "Draw how punctual the operator's loop was (.png, .pdf or .svg)", default=None
    )

    def run(self) -> command.Outcome:
        """Read, run again and write."""
        log = operate.read_operation(self.file)
        estimates = self._estimates(log)
        trial = operate.trial_of(log, estimates)
        if self.plot_timing is not None:
            self._plot_timing(log, self.plot_timing)
        rerun = None
        if self.control:
            rerun = operate.rerun_controller(log, estimates=estimates)
        verdict = operate.recorded_verdict_summary(log, simulate.build_plant)
        facts: dict[str, Any] = {"lost": log.lost, "verdict": verdict}
        paragraphs = ["\n".join(verdict["lines"])]
        if log.timing is not None:
            facts["timing"] = log.timing.summary()
            paragraphs.append(
                f"The operator's loop: {operate.describe_punctuality(facts['timing'])}."
            )
        if rerun is not None:
            facts["control"] = _facts_of_rerun(rerun)
            paragraphs.append(_describe_rerun(rerun))
        learned = self._learned(log)
        if learned or self.learn:
            facts["learned"] = [vars(entry) for entry in learned]
            paragraphs += _describe_learned(learned)
        outcome = self.write_and_report(
            trial,
            further_text="".join(f"\n\n{paragraph}" for paragraph in paragraphs),
            further_facts=facts,
        )
        lost = f"laticauda: {log.lost}" if log.lost else ""
        return replace(outcome, problem=lost)

    def _plot_timing(self, log: "operate.OperationLog", path: str) -> None:
        timing = log.timing
        if timing is None:
            rule = "must go with a recording whose loop had a clock"
            raise BadArgument("plot_timing", f"{rule}, got {self.file}")
        sheet = figures.timing_sheet(timing.lateness, timing.latency, timing.interval)
        figures.save_figure(sheet, path)

    def _learned(self, log: "operate.OperationLog") -> "Sequence[estimation.Learned]":
        """Return what the learning twin learned: again, or as recorded."""
        if self.learn:
            return operate.rerun_learner(log, simulate.build_plant)
        return log.of(estimation.Learned)

    def _estimates(self, log: "operate.OperationLog") -> "list[estimation.Estimate] | None":
        """Return the motion as estimated again; None: as recorded."""
        if self.kinematics:
            estimator = _kinematic_estimator(log)
            return operate.rerun_estimator(log, estimator)
        if self.estimate:
            return operate.rerun_estimator(log, plant=simulate.build_plant)
        return None


def _kinematic_estimator(log: "operate.OperationLog") -> "estimation.KinematicEstimator":
    """Return an estimator by kinematics alone, with the settings of the recorded one."""
    settings: dict[str, Any] = {}
    for name in ("mount", "in_space"):
        setting = getattr(log.header.estimator, name, None)
        if setting is not None:
            settings[name] = setting
    return estimation.KinematicEstimator(robot=log.header.run.robot, **settings)


def _describe_learned(learned: "Sequence[estimation.Learned]") -> list[str]:
    """Return the last line of what was learned, and all changes of the robot."""
    if not learned:
        return ["Learned: nothing, from so few cycles."]
    lines = [f"Learned: {learned[-1].line}."]
    for entry in learned:
        lines += [f"{entry.time:.2f} s: {change}" for change in entry.changes]
    return lines


def _facts_of_rerun(rerun: "operate.Rerun") -> dict[str, Any]:
    return {
        "n_commands": len(rerun.recorded),
        "n_different": rerun.n_different,
        "largest_difference": rerun.largest_difference,
    }


def _describe_rerun(rerun: "operate.Rerun") -> str:
    n_instants = len(rerun.recorded)
    if rerun.n_different == 0:
        same = "The controller decided the same again, to the last bit"
        return f"{same}, at all {n_instants} control instants."
    return (
        f"The controller decided otherwise at {rerun.n_different} of {n_instants} control instants, "
        f"by up to {rerun.largest_difference:.3g} rad of the joints' offset."
    )
