"""What `laticauda optimize` writes and says about a design: files, a drawing, and its limits."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from laticauda import robot
from laticauda.cli.tables import align_columns
from laticauda.scenarios import save_scenario
from laticauda.studies import Front, Judgment, Optimization, judge_design, judge_point
from laticauda.values import files

ENDING = "-design"
"""End of the name of a designed robot."""


@dataclass(frozen=True)
class Design:
    """The best robot of an optimization, beside the one with which it began."""

    before: Judgment
    after: Judgment

    @classmethod
    def of(cls, front: Front) -> "Design | None":
        """Return the design that was found; None if no single one was, or only the gait was sought.

        Args:
            front: Result of the optimization.
        """
        optimization = front.optimization
        is_of_robot = any(name.startswith("robot.") for name in optimization.names)
        if not is_of_robot or len(optimization.objectives) > 1 or len(front) == 0:
            return None
        after = judge_point(optimization, front.values[0])
        name = f"{after.scenario.robot.name}{ENDING}"
        designed = replace(after.scenario.robot, name=name)
        after = replace(after, scenario=replace(after.scenario, robot=designed))
        return cls(judge_design(optimization), after)

    def write(self, folder: Path) -> list[Path]:
        """Write robot, scenario and drawing; return their paths.

        Args:
            folder: Existing folder.
        """
        from laticauda.show.reports import write_design_sheet

        paths = [folder / name for name in ("robot.toml", "scenario.toml", "design.png")]
        robot_path, scenario_path, drawing_path = paths
        files.write(robot_path, robot.to_toml(self.after.scenario.robot))
        save_scenario(self.after.scenario, scenario_path)
        note = f"before: {describe_trial(self.before)}\nafter: {describe_trial(self.after)}"
        write_design_sheet(self.before.scenario, self.after.scenario, drawing_path, note)
        return paths

    @property
    def words(self) -> str:
        """Limits of the design, the largest share first, and what the robot took before."""
        rows = [("limit", "used", "before", "")]
        before = {use.limit: use.share for use in self.before.uses}
        for use in self.after.uses:
            share_before = ""
            if use.limit in before:
                share_before = f"{100.0 * before[use.limit]:.0f} %"
            rows.append((use.limit, f"{100.0 * use.share:.0f} %", share_before, use.description))
        active = ", ".join(self.after.active) or "none, so that the ranges limit it"
        lines = [align_columns(rows), f"Limits that are reached: {active}."]
        if not self.before.is_feasible:
            lines.append(f"Before, it was refused: {'; '.join(self.before.refusals)}.")
        lines.append("robot.toml and scenario.toml: the design; design.png: its drawing.")
        return "\n".join(lines)

    @property
    def facts(self) -> list[dict[str, Any]]:
        """The same for programs."""
        return [
            {
                "limit": use.limit,
                "share": use.share,
                "is_active": use.is_active,
                "words": use.description,
            }
            for use in self.after.uses
        ]


def describe_trial(judgment: Judgment) -> str:
    """Return speed, mass and power of a design.

    Args:
        judgment: The design.
    """
    trial = judgment.trial
    robot = judgment.scenario.robot
    return (
        f"{trial.forward_velocity:.3f} m/s, {robot.mass:.2f} kg, {robot.reach:.2f} m, "
        f"{trial.mean_power + robot.idle_power:.1f} W"
    )


def describe_refusals(front: Front) -> str:
    """Return which limits refused how many points.

    Args:
        front: Result of an optimization.
    """
    counts = sorted(front.refusals.items(), key=lambda item: -item[1])
    return ", ".join(f"{count} by {limit}" for limit, count in counts)


def describe_start(optimization: Optimization) -> str:
    """Return what refuses the robot with which a search began.

    Args:
        optimization: The optimization.
    """
    judgment = judge_design(optimization)
    if judgment.is_feasible:
        return "feasible, but outside the ranges."
    return f"{'; '.join(judgment.refusals)}."
