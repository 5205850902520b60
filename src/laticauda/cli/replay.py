"""`laticauda replay`: a recorded operation as a trial, and once more through the estimator and the controller."""

from typing import Any

from laticauda import estimation, figures, operate, simulate
from laticauda.cli import command, flags, report, view
from laticauda.errors import BadArgument
from laticauda.operate.recording.entries import Timing
from laticauda.quantities import option, value


@value
class Replay(view.Filming):
    """Make a trial of a recorded operation, and print its figures.

    The speed is (5), the power (4) from the power meter. A recording that ends in the middle is replayed as far as it
    goes. --estimate and --control run the recorded estimator and controller again on what was recorded.

    For example: laticauda replay run.mcap --save run.nc --estimate --control
    """

    file: flags.Input = option("The recording, as `laticauda operate` wrote it (.mcap)")
    save: flags.NetCdf = option("Write the trial to this file (.nc)", default=None)
    estimate: bool = option("Estimate the motion again from the recorded samples, for the trial", default=False)
    kinematics: bool = option("Estimate it by kinematics alone, without the filter", default=False)
    control: bool = option("Controller decides again, and compare its commands with the recorded", default=False)
    plot_timing: flags.Picture = option("Draw how punctual the operator's loop was (.png or .pdf)", default=None)

    def run(self) -> command.Outcome:
        """Read, run again, and write."""
        log = operate.read_operation(self.file)
        estimates = self._estimates(log)
        trial = operate.trial_of(log, estimates)
        self._draw(log.timing)
        rerun = operate.rerun_controller(log, estimates=estimates) if self.control else None
        if self.save is not None:
            trial.save(self.save)
        self.write_film(trial)
        facts: dict[str, Any] = {**report.facts_of(trial), "lost": log.lost}
        text = [report.as_text(trial)]
        if log.timing is not None:
            facts["timing"] = log.timing.summary()
            text.append(_punctual(log.timing))
        if rerun is not None:
            facts["control"] = {
                "n_commands": len(rerun.recorded),
                "n_different": rerun.n_different,
                "largest_difference": rerun.largest_difference,
            }
            text.append(_sentence(rerun))
        lost = f"laticauda: {log.lost}" if log.lost else ""
        return command.Outcome(facts=facts, text="\n\n".join(text), problem=lost, succeeded=trial.succeeded)

    def _draw(self, timing: Timing | None) -> None:
        if self.plot_timing is None:
            return
        if timing is None:
            raise BadArgument("plot_timing", f"must go with a recording of a loop that had a clock, got {self.file}")
        figures.save_figure(figures.timing_sheet(timing.period, timing.latency, timing.interval), self.plot_timing)

    def _estimates(self, log: operate.OperationLog) -> list[estimation.Estimate] | None:
        if self.kinematics:
            known = {name: getattr(log.header.estimator, name, None) for name in ("mount", "in_space")}
            kwargs = {name: one for name, one in known.items() if one is not None}
            return operate.rerun_estimator(log, estimation.KinematicEstimator(robot=log.header.run.robot, **kwargs))
        return operate.rerun_estimator(log, plant=simulate.plant) if self.estimate else None


def _punctual(timing: Timing) -> str:
    found = timing.summary()
    ms = {name: f"{1e3 * found.get(name, 0.0):.1f}" for name in found}
    words = [f"The operator's loop: {found['ticks']} ticks of {ms['interval']} ms, {found['missed']} missed deadlines."]
    words += [
        f"{name} median {ms[f'{name}_median']}, 99 % {ms[f'{name}_p99']}, largest {ms[f'{name}_largest']} ms"
        for name in ("period", "latency")
        if f"{name}_median" in ms
    ]
    return "\n".join(words)


def _sentence(rerun: operate.Rerun) -> str:
    n = len(rerun.recorded)
    if rerun.n_different == 0:
        return f"The controller decided the same again, to the last bit, at all {n} control instants."
    return (
        f"The controller decided otherwise at {rerun.n_different} of {n} control instants, "
        f"by up to {rerun.largest_difference:.3g} rad of the joints' offset."
    )
