"""Outcome of an operation: whether the run counts and why, and its figures."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import OperatorState
from laticauda.tank.operate.recording.log import OperationLog, read_operation
from laticauda.tank.operate.recording.timing import Timing, describe_punctuality
from laticauda.tank.operate.recording.to_trial import trial_of
from laticauda.tank.operate.safety.supervisor import BY_EVENT, cause_of
from laticauda.tank.operate.verdict import Verdict
from laticauda.trials import Trial, following, metrics
from laticauda.values import TrialFileError

FIGURE_TEXTS: dict[str, Any] = tomllib.loads(
    Path(__file__).with_name("figures.toml").read_text(encoding="utf-8")
)
"""How the figures of a `run` and of a `series` are shown."""
FOLLOWING_FIGURES = ("convergence_time", "steady_error", "ripple", "last_cycles_error")
"""Figures of a run along a path."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Result:
    """Outcome of an operation."""

    name: str
    """Name of the operation."""
    accepted: bool
    """Whether the run counts: neither a fault nor the operator ended it, and its verdict found
    nothing wrong."""
    reason: str
    """How the run ended, or why it does not count."""
    trial: Trial | None
    """The run; None if there was none."""
    start: tuple[float, float, float] | None = None
    """Center of mass [m, m] and heading [rad] before the run."""
    idle_current: float | None = None
    """I_0 [A]; None: not measured."""
    supply_voltage: float | None = None
    """V of (4) [V]; None without a power meter."""
    lost_meter: bool = False
    """Whether the power meter was silent during the run, so that its power is not known."""
    notes: tuple[str, ...] = ()
    """Problems that did not stop the run."""
    recording: Path | None = None
    """File of the recording."""
    timing: Timing | None = None
    """Punctuality of the loop; None if it had no real clock."""
    aftermath: str = ""
    """What went wrong while the robot stopped after a run that counts, to be inspected before the
    next; "" if nothing did."""
    verdict: Verdict | None = None
    """Verdict on the run; None if there was no run, or it was not recorded."""
    stopped: bool = False
    """Whether the operator has asked to stop, during the run or after it."""
    needs_acknowledgment: bool = False
    """Whether a fault has stopped the robot: somebody has to look at it before it gets torque
    again."""

    def summary(self) -> dict[str, Any]:
        """Return the figures of the run by name, ready for JSON; a run that failed has only its duration."""
        figures: dict[str, Any] = {
            "name": self.name,
            "accepted": self.accepted,
            "reason": self.reason,
        }
        if self.start is not None:
            _, cross_track_error, heading = self.start
            figures["initial_cross_track_error"] = cross_track_error
            figures["initial_heading"] = heading
        figures["idle_current"] = self.idle_current
        learned = None
        if self.trial is not None:
            figures |= self._figures_of_trial(self.trial)
            learned = self.trial.settings.get("learned")
        return figures | {
            "notes": list(self.notes),
            "aftermath": self.aftermath,
            "learned": learned,
            "recording": None if self.recording is None else str(self.recording),
            "timing": None if self.timing is None else self.timing.summary(),
            "verdict": None if self.verdict is None else self.verdict.summary(),
        }

    def _figures_of_trial(self, trial: Trial) -> dict[str, Any]:
        figures: dict[str, Any] = {
            "duration": metrics.log_duration(trial.time),
            "forward_velocity": None,
            "electrical_power": None,
            "total_power": None,
        }
        if not trial.succeeded:  # its reason is above
            return figures
        figures["forward_velocity"] = trial.forward_velocity
        if trial.electrical_work is not None and not self.lost_meter:
            figures["electrical_power"] = trial.electrical_power
            figures["total_power"] = trial.electrical_power + self._idle_power
        cross_track_error = trial.signals.get("cross_track_error")
        if cross_track_error is not None:
            figures["final_cross_track_error"] = float(cross_track_error[-1])
            reached = following.summarize_following(trial)
            for name in FOLLOWING_FIGURES:
                figures[name] = reached[name]
        return figures

    @property
    def _idle_power(self) -> float:
        """Power at rest [W]; 0 if it is not known."""
        if self.idle_current is None or self.supply_voltage is None:
            return 0.0
        return self.supply_voltage * self.idle_current


class Judgment(NamedTuple):
    """Whether a run counts, and why."""

    accepted: bool
    """Whether it counts."""
    reason: str
    """How it ended, or why it does not count, in one sentence."""


def result_of(
    operator: Operator,
    state: OperatorState,
    recording: Path | None,
    timing: Timing | None,
    verdict: Verdict | None = None,
    read: OperationLog | None = None,
) -> Result:
    """Return the outcome of an operation, from its last state and its recording.

    Args:
        operator: Operator of the operation.
        state: Last state.
        recording: Closed file of the recording; None if nothing was recorded.
        timing: Punctuality of the loop; None: not known.
        verdict: Verdict on the run; None: there is none.
        read: What is in the recording; None: it is still to be read.
    """
    trial: Trial | None = None
    if recording is not None and state.begun is not None:
        try:
            trial = trial_of(read or read_operation(recording))
            trial.save(recording.with_suffix(".nc"))
        except TrialFileError as error:
            state = replace(state, notes=(*state.notes, str(error)))
    judgment = _judge(operator, state, verdict)
    is_kept = trial is not None or recording is None
    return Result(
        name=operator.operation.name,
        accepted=judgment.accepted and is_kept,
        reason=judgment.reason,
        trial=trial,
        start=state.prepared.start,
        idle_current=state.idle.mean,
        supply_voltage=operator.operation.supply_voltage,
        lost_meter=state.lost_meter,
        notes=state.notes,
        recording=recording,
        timing=timing,
        aftermath=_describe_aftermath(state) if judgment.accepted else "",
        verdict=verdict,
        needs_acknowledgment=state.supervisor.is_fault,
    )


def _judge(operator: Operator, state: OperatorState, verdict: Verdict | None) -> Judgment:
    """Return whether the run counts, and how it ended."""
    judgment = _judge_by_end(operator, state)
    if judgment.accepted and verdict is not None and verdict.reason:
        return Judgment(accepted=False, reason=verdict.reason)
    return judgment


def _judge_by_end(operator: Operator, state: OperatorState) -> Judgment:
    """Return whether the run counts by the way in which it ended."""
    if operator.check_only and not state.failure:
        return Judgment(accepted=True, reason="All devices are OK.")
    if state.begun is None:
        cause = cause_of(state.supervisor.cause) or "the run did not start"
        reason = state.failure or f"{cause[:1].upper()}{cause[1:]}."
        return Judgment(accepted=False, reason=reason)
    if not state.stopped_by:
        return Judgment(accepted=True, reason="The run reached its end.")
    cause = cause_of(state.stopped_by)
    if state.stopped_by == "edge":
        return Judgment(accepted=True, reason=f"The run ended: {cause}.")
    return Judgment(accepted=False, reason=f"The run was ended: {cause}.")


def _describe_aftermath(state: OperatorState) -> str:
    """Return what happened to the robot after the run.

    It does not affect the run, but prevents the next.
    """
    cause = state.supervisor.cause
    if cause not in BY_EVENT or not state.supervisor.is_fault:
        return ""
    return f"After the run, {cause_of(cause)}. Check the robot, then start with `--clear`."


def format_summary(summary: Mapping[str, Any]) -> str:
    """Return a summary as text, one figure per line.

    Args:
        summary: Summary of a `Result`.
    """
    outcome = "accepted" if summary["accepted"] else "rejected"
    lines = [f"{summary['name']}: {outcome}. {summary['reason']}"]
    for name, (title, unit, digits) in FIGURE_TEXTS["run"].items():
        if summary.get(name) is not None:
            lines.append(f"  {title:<24}{summary[name]:>12.{digits}f} {unit}")
    if summary.get("timing"):
        lines.append(f"  loop: {describe_punctuality(summary['timing'])}")
    if summary.get("verdict"):
        lines += [f"  {line}" for line in summary["verdict"]["lines"]]
    if summary.get("learned"):
        lines.append(f"  learned: {summary['learned']}")
    for note in (*summary.get("notes", ()), summary.get("aftermath")):
        if note:
            lines.append(f"  note: {note}")
    if summary.get("recording"):
        lines.append(f"  recording: {summary['recording']}")
    return "\n".join(lines)
