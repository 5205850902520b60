"""What keeps a robot from swimming faster: the limits that a trial comes up against, in words."""

from laticauda.models.simulate import build_plant, run_scenario
from laticauda.scenarios import Scenario
from laticauda.trials import Trial
from laticauda.trials.feasibility import SERVOS

NEAR = 0.97
"""Share of a limit from which on it counts as reached [-]."""
TOP_SPEED = "servos' top speed"


def name_limits(scenario: Scenario) -> list[str]:
    """Run a scenario and return which limits of the robot it comes up against.

    Args:
        scenario: Scenario of the planar model, feasible or not.

    Returns:
        The limits that are reached, such as "servos" or "joint angles"; empty if there is none.
    """
    trial = run_scenario(scenario, build_plant(scenario))
    if not trial.succeeded:
        return []
    limits: list[str] = []
    if trial.utilization >= NEAR:
        limits.append(trial.feasibility.limited_by)
    if _turns_at_top_speed(scenario, trial) and SERVOS not in limits:
        limits.insert(0, TOP_SPEED)
    return limits


def describe_limits(scenarios: list[Scenario]) -> str:
    """Return the limits of some scenarios in words, each once; "" if none is reached.

    Args:
        scenarios: Scenarios of the planar model, feasible or not.
    """
    limits: list[str] = []
    for scenario in scenarios:
        limits += name_limits(scenario)
    return ", ".join(dict.fromkeys(limits))


def _turns_at_top_speed(scenario: Scenario, trial: Trial) -> bool:
    """Return whether joints turn as fast as their law lets them; only some laws have a limit."""
    top_speed: float | None = getattr(scenario.model.joints, "speed_limit", None)
    return top_speed is not None and trial.peak_joint_rate >= NEAR * top_speed
