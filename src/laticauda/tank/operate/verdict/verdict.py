"""The verdict on a run: all checks, in the order in which they are listed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from laticauda.models.dynamics import Plant
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.recording.log import OperationLog
from laticauda.tank.operate.settings import Acceptance
from laticauda.tank.operate.verdict import cameras, completeness, joints, motion, preparation
from laticauda.tank.operate.verdict.check import Check, CheckResult, compare_with_limit
from laticauda.tank.operate.verdict.recorded_run import RecordedRun

CHECKS = (
    Check(
        name="missing_answers",
        measure=completeness.measure_missing_answers,
        rejects=False,
        explains_others=True,
    ),
    Check(
        name="time_late",
        measure=completeness.measure_time_late,
        rejects=False,
        explains_others=True,
    ),
    Check(name="missing_in_run", measure=completeness.measure_missing_in_run, explains_others=True),
    Check(
        name="longest_silence", measure=completeness.measure_longest_silence, explains_others=True
    ),
    Check(name="joint_error", measure=joints.measure_joint_error),
    Check(name="angle_jump", measure=joints.measure_angle_jump),
    Check(name="marker_jump", measure=cameras.measure_marker_jump),
    Check(name="swing_error", measure=cameras.measure_swing_error),
    Check(name="speed_change", measure=motion.measure_speed_change),
    Check(name="sideslip_change", measure=motion.measure_sideslip_change),
    Check(name="turn_change", measure=motion.measure_turn_change),
    Check(name="model_speed", measure=motion.measure_model_speed, rejects=False),
    Check(name="pose_age", measure=cameras.measure_pose_age),
    Check(name="clock_drift", measure=cameras.measure_clock_drift),
    Check(name="water_speed", measure=preparation.measure_water_speed),
    Check(name="without_zero", measure=preparation.measure_modules_without_zero, rejects=False),
)
"""All checks, one for every field of `Acceptance`, in the same order."""
EXPLAINING = frozenset(check.name for check in CHECKS if check.explains_others)
"""Checks of what may make a good run look wrong."""

CUT_SHORT = "it reached an edge before a cycle was complete, so nothing confirms it"
"""Why a run is rejected that ended at an edge within its first cycle."""


@dataclass(frozen=True)
class Verdict:
    """All checks of one run."""

    checks: tuple[CheckResult, ...]
    """Checks, one for each limit."""
    is_cut: bool = False
    """Whether the run ended at an edge before one cycle was complete, so that nothing confirms the
    run or the edge."""

    @property
    def reason(self) -> str:
        """What failed, by the largest share of its limit; "" if the run is accepted.

        A recording with holes may make anything look wrong, and is therefore named first.
        """
        failed = self._ranked_by_share("WRONG")
        if not failed and self.is_cut:
            return f"The run failed a check: {CUT_SHORT}."
        if not failed:
            return ""
        # Holes that reject the run are named before those that are only noted.
        holes = [
            check
            for check in (*failed, *self._ranked_by_share("noted"))
            if check.name in EXPLAINING
        ]
        failed_besides = [check for check in failed if check.name not in EXPLAINING]
        worst = [*holes, *failed_besides][0]
        if not (holes and failed_besides):
            return f"The run failed a check: {worst.description}."
        return (
            f"The run failed a check: {worst.description}. "
            f"This may be why another one failed: {failed_besides[0].description}."
        )

    def summary(self) -> dict[str, Any]:
        """Return the verdict in a form ready for JSON and for a recording.

        Its lines begin with what exceeds its limit, the largest share first.
        """
        exceeded = [*self._ranked_by_share("WRONG"), *self._ranked_by_share("noted")]
        within_limits = [check for check in self.checks if check not in exceeded]
        return {
            "accepted": not self.reason,
            "checks": [check.summary() for check in self.checks],
            "lines": [
                f"{check.outcome:<11} {check.description}" for check in (*exceeded, *within_limits)
            ],
        }

    def _ranked_by_share(self, outcome: str) -> list[CheckResult]:
        """Return the checks with this outcome, those that used most of their limit first."""
        checks = [check for check in self.checks if check.outcome == outcome]
        return sorted(checks, key=lambda check: check.share or 0.0, reverse=True)


def verdict_of(log: OperationLog, limits: Acceptance, plant: Plant[Any] | None = None) -> Verdict:
    """Check a recorded run.

    Args:
        log: The recording.
        limits: Limits of what is accepted.
        plant: The same robot in its water, with the joint law of its modules. If it is None, or for an
            operation in depth, what needs it is not checked, and of a joint only its mean and its
            swing, which may be off by half.
    """
    run = RecordedRun.of(log, plant)
    results = [compare_with_limit(check, check.measure(run), limits, run.begin) for check in CHECKS]
    reached_edge = any(event.data.get("event") == "edge" for event in run.events)
    return Verdict(tuple(results), is_cut=reached_edge and not len(run.cycles))


def recorded_verdict_summary(
    log: OperationLog, build_plant: Callable[..., Plant[Any]]
) -> Mapping[str, Any]:
    """Return the summary of the verdict in a recording; without one, judge by the default limits.

    Args:
        log: The recording.
        build_plant: `laticauda.build_plant`, which builds the robot to compare with.
    """
    for event in log.of(Event):
        if event.kind == "verdict":
            return event.data
    run = log.header.run
    plant = build_plant(run.robot, run.environment, joints=log.header.joint_law)
    return verdict_of(log, Acceptance(), plant).summary()
