"""`laticauda swim | follow | replay`: one run of one robot, its figures, file and picture.

The robot swims its gait or follows a path; or its recorded operation becomes a trial, and passes
through the estimator and the controller again.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import laticauda as lc
from laticauda import control
from laticauda.cli import command, flags, report, scene, trial
from laticauda.cli.flags import BadFlag, File, Files, Picture, ScenarioFile, Stored, Toml
from laticauda.control import estimation
from laticauda.models import simulate
from laticauda.show import figures
from laticauda.tank import operate
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class


@value_class
class Recording(trial.Filming):
    """A command that makes a trial, with the options for its output."""

    save: Stored = option(
        "Write the trial: .nc, .mcap, .parquet or .mat (all of it) or .csv (a table)", default=None
    )
    plot: Picture = option(
        "Plot path, speed, joint angles and torques to this file (.png, .pdf or .svg)", default=None
    )

    def outcome(
        self,
        trial: lc.Trial,
        origin: str,
        more: str = "",
        facts: Mapping[str, Any] | None = None,
        beside: Sequence[lc.Trial] = (),
    ) -> command.Outcome:
        """Write the requested files, and report the results.

        Args:
            trial: Trial of the run.
            origin: Source of its coefficients, in words.
            more: Text printed below the table.
            facts: Additional facts, for JSON.
            beside: Trials of other robots in the same scene.
        """
        if self.save is not None:
            place = Path(self.save)
            for k, one in enumerate((trial, *beside)):
                one.save(place.with_stem(f"{place.stem}-{k}") if k else place)
        if self.plot is not None:
            figures.save_figure(trial.plot(), self.plot)
        self.write_film(trial, beside=beside)
        return command.Outcome(
            facts={**report.facts_of(trial), **(facts or {})},
            text=report.as_text(trial, origin) + more,
            problem="" if trial.succeeded else trial.status,
            succeeded=trial.succeeded,
        )


@value_class
class Run(scene.OfScenario, Recording):
    """A command that runs one scenario."""

    file: ScenarioFile = option(
        "Scenario file (.toml) that the options modify; must come first", default=None
    )
    link_forces: bool = option("Also log the force on every link", default=False)
    save_scenario: Toml = option("Write the scenario to this file (.toml)", default=None)

    def swum(self, scenario: lc.Scenario) -> lc.Trial:
        """Return the trial of a scenario, which is written to a file if requested.

        Args:
            scenario: Scenario to run.
        """
        if self.save_scenario is not None:
            lc.save_scenario(scenario, self.save_scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        return lc.swim(
            scenario, link_forces=self.link_forces, progress=command.run_bar(scenario.duration)
        )


@value_class
class Swim(Run):
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
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """Return the command that was typed; see `OfScenario.read`."""
        return (
            SwimOn.read(words, prog)
            if flags.was_typed("resume", words)
            else super().read(words, prog)
        )

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        if self.beside:
            return self._together()
        trial = self.swum(self.chosen)
        if not self.interval:
            return self.outcome(trial, self.origin)
        varied = simulate.intervals_of(self.chosen)
        table = report.interval_table(
            trial, found := simulate.figure_intervals(trial, varied), varied
        )
        return self.outcome(trial, self.origin, f"\n\n{table}", {"interval": found})

    def _together(self) -> command.Outcome:
        """Run the robot and those of further scenario files in one scene."""
        scenarios = [self.chosen, *map(lc.load_scenario, self.beside)]
        trial, *others = lc.swim_together(scenarios, progress=command.run_bar(self.chosen.duration))
        facts = {"beside": [report.facts_of(one) for one in others]}
        return self.outcome(
            trial,
            self.origin,
            "".join(f"\n\n{report.as_text(one)}" for one in others),
            facts,
            others,
        )


@value_class
class SwimOn(Recording):
    """Continue from the end of a stored trial, with its robot, gait and water; the result is the whole run."""

    resume: File = option("The stored trial", default=None)
    duration: float = quantity("s", "Further duration", gt=0.0, default=30.0)
    sample_interval: float = quantity(
        "s", "Time between two samples of the log", gt=0.0, default=0.05
    )

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "SwimOn":
        """Return the command that was typed; arguments as for `Swim.read`.

        Raises:
            BadFlag: If an option sets what the stored trial already defines.
        """
        allowed = {flags.spell_flag(name) for name in flags.options_of(cls())} | {"--help", "-h"}
        for word in words:
            if word.startswith("--") and word.split("=")[0] not in allowed:
                raise BadFlag(
                    f"{word.split('=')[0]} must not be given with --resume: the stored trial has its own."
                )
        return flags.parse_command(cls, words, prog)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        assert self.resume is not None
        first = lc.load_trial(self.resume)
        if not isinstance(first.scenario, lc.Scenario):
            raise BadFlag(
                f"--resume must be a simulated trial, got {self.resume}, which lacks {first.scenario.lacks}"
            )
        scenario = replace(first.scenario, duration=self.duration)
        body = lc.build_plant(scenario)
        scene.warn_of_compiling(scenario.environment, scenario.model)
        second = lc.resume(
            body,
            first,
            self.duration,
            sample_interval=self.sample_interval,
            link_forces=first.link_force is not None,
            progress=command.run_bar(self.duration),
        )
        return self.outcome(lc.joined(first, second), f"as stored in {self.resume}")


# ---- along a path --------------------------------------------------------------------------------


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
        if len(self.waypoints) % 2:
            count = len(self.waypoints)
            raise BadArgument(
                "waypoints", f"must be pairs of numbers, x1 y1 x2 y2 ..., got {count} numbers"
            )
        if self.path_depth and self.guidance == "model-predictive":
            raise BadArgument(
                "path_depth",
                "must be left out with model-predictive guidance, which plans horizontally",
            )
        guidance: Any = (
            "line_of_sight"
            if self.guidance == "model-predictive"
            else self.guidance.replace("-", "_")
        )
        return control.Following(
            waypoints=tuple(zip(self.waypoints[::2], self.waypoints[1::2], strict=True)) or None,
            guidance=guidance,
            **{name: getattr(self, name) for name in control.Course.__dataclass_fields__},
        )


@value_class
class Follow(Run):
    """Let a robot follow a path with its gait, starting off the path, and print how soon and how well it converges.

    For example: laticauda follow --robot mamba-fin --waypoints 0 0 3 0 6 2 --smooth --duration 60
    --save run.nc --plot run.png
    """

    route: Route = option("Path to follow, and guidance law", default=Route())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """Return the command that was typed; see `OfScenario.read`."""
        names, route = (
            scene.Names.read(words, prog),
            flags.parse_command(Route, words, prog, known_only=True),
        )
        scenario, origin = names.scenario(words)
        kind = FollowPlanned if route.guidance == "model-predictive" else cls
        if scenario.motion == scenario.gait:  # a file may have a controller
            motion = (
                scenario.gait
                if kind is FollowPlanned
                else route.following.controller(scenario.gait)
            )
            scenario = replace(
                scenario, motion=motion, duration=90.0, start=lc.Start(center_of_mass=(0.0, 1.0))
            )
        return kind.about(scenario, words, prog, choice=names, origin=origin, route=route)

    def run(self) -> command.Outcome:
        """Run, and write the results."""
        trial = self.swum(self.steered(self.chosen))
        return self.outcome(trial, self.origin, f"\n\n{report.following_table(trial)}")

    def steered(self, scenario: lc.Scenario) -> lc.Scenario:
        """Return the scenario with the requested controller.

        Args:
            scenario: Scenario with the numbers that were typed.
        """
        motion = scenario.motion
        if not self.route.observe_current or not isinstance(motion, control.PathFollowing):
            return scenario
        return replace(
            scenario,
            motion=replace(motion, observer=control.CurrentObserver(model=learn_model(scenario))),
        )


@value_class
class FollowPlanned(Follow):
    """Let a robot follow a path by planning ahead, with a model that is first fitted to four trials of the robot.

    For example: laticauda follow --robot mamba-fin --guidance model-predictive --current 0 -0.03
    --duration 60
    """

    speed: float | None = quantity(
        "m/s", "Speed along the path; none: the gait's own", gt=0.0, default=None
    )
    plan: control.PlanLimits = option("Model-predictive guidance", default=control.PlanLimits())

    def steered(self, scenario: lc.Scenario) -> lc.Scenario:
        """Fit a model of the gait, and return the scenario with a controller that uses it; see `Follow.steered`."""
        gait, model = scenario.gait, learn_model(scenario, self.plan.frequency_limits)
        speed = model.speed(gait.frequency, 0.0) if self.speed is None else self.speed
        path, plan = self.route.following.path, vars(self.plan)
        motion = control.ModelPredictive(gait=gait, path=path, model=model, speed=speed, **plan)
        return replace(scenario, motion=motion)


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

    show = command.show_progress(
        command.SHARE, what="learned how the gait moves the robot", patience=command.PATIENCE
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

    file: flags.Input = option("The recording, as `laticauda operate` wrote it (.mcap)")
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
    plot_timing: flags.Picture = option(
        "Draw how punctual the operator's loop was (.png, .pdf or .svg)", default=None
    )

    def run(self) -> command.Outcome:
        """Read, run again and write."""
        log = operate.read_operation(self.file)
        estimates = self._estimates(log)
        trial, timing = operate.trial_of(log, estimates), log.timing
        if self.plot_timing is not None:
            if timing is None:
                raise BadArgument(
                    "plot_timing",
                    f"must go with a recording whose loop had a clock, got {self.file}",
                )
            sheet = figures.timing_sheet(timing.lateness, timing.latency, timing.interval)
            figures.save_figure(sheet, self.plot_timing)
        rerun = operate.rerun_controller(log, estimates=estimates) if self.control else None
        verdict = operate.recorded_verdict_summary(log, simulate.build_plant)
        facts: dict[str, Any] = {"lost": log.lost, "verdict": verdict}
        text = ["\n".join(verdict["lines"])]
        if timing is not None:
            facts["timing"] = timing.summary()
            text.append(f"The operator's loop: {operate.punctuality(facts['timing'])}.")
        if rerun is not None:
            facts["control"] = {
                "n_commands": len(rerun.recorded),
                "n_different": rerun.n_different,
                "largest_difference": rerun.largest_difference,
            }
            text.append(_sentence(rerun))
        learned = (
            operate.rerun_learner(log, simulate.build_plant)
            if self.learn
            else log.of(estimation.Learned)
        )
        if learned or self.learn:
            facts["learned"] = [vars(one) for one in learned]
            text.append(
                f"Learned: {learned[-1].line if learned else 'nothing, from so few cycles'}."
            )
            text += [f"{one.time:.2f} s: {change}" for one in learned for change in one.changes]
        lost = f"laticauda: {log.lost}" if log.lost else ""
        return replace(
            self.outcome(trial, "", "".join(f"\n\n{one}" for one in text), facts), problem=lost
        )

    def _estimates(self, log: "operate.OperationLog") -> "list[estimation.Estimate] | None":
        if self.kinematics:
            known = {
                name: getattr(log.header.estimator, name, None) for name in ("mount", "in_space")
            }
            kwargs = {name: one for name, one in known.items() if one is not None}
            return operate.rerun_estimator(
                log, estimation.KinematicEstimator(robot=log.header.run.robot, **kwargs)
            )
        return operate.rerun_estimator(log, plant=simulate.build_plant) if self.estimate else None


def _sentence(rerun: "operate.Rerun") -> str:
    n = len(rerun.recorded)
    if rerun.n_different == 0:
        return (
            f"The controller decided the same again, to the last bit, at all {n} control instants."
        )
    return (
        f"The controller decided otherwise at {rerun.n_different} of {n} control instants, "
        f"by up to {rerun.largest_difference:.3g} rad of the joints' offset."
    )
