"""`laticauda replay`: a recorded operation becomes a trial, and passes through estimator and controller again."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from laticauda.cli import command, flags
from laticauda.cli.trial_output import Recording
from laticauda.control import estimation
from laticauda.models import simulate
from laticauda.show import figures
from laticauda.tank import operate
from laticauda.values import BadArgument, option, value_class


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
        if not log.lost:
            return outcome
        problems = [f"laticauda: {log.lost}", outcome.problem]
        return replace(outcome, problem="\n".join(filter(None, problems)))

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
