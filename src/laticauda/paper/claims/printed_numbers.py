"""Numbers of claims that need no study: from Table 2, from the robots, and from a campaign."""

from typing import Any

from laticauda.paper.measured import find_printed_changes, read_path_following_trials
from laticauda.robot import load_robot, load_water

Numbers = dict[str, Any]
"""Numbers by the names that `claims.toml` uses."""

MODELS: Numbers = {"dt": 0.0005, "path": 1.1e-8}
"""Difference between the paths of planar and spatial model over the distance [-], at a step [s].

It is a result of campaigns/parity.py.
"""

N_PRINTED_LINKS = 20
"""Number of links of the robot, as section 2 of the paper prints it."""


def collect_table_numbers() -> Numbers:
    """Return the changes due to the fin, recomputed from Table 2 [%]."""
    velocity_changes: list[float] = []
    power_changes: list[float] = []
    energy_changes: list[float] = []
    for change in find_printed_changes(read_path_following_trials()):
        assert change.velocity is not None and change.power is not None  # Table 2 lacks none
        velocity_changes.append(change.velocity)
        power_changes.append(change.power)
        energy_changes.append(energy_change(change.power, change.velocity))
    return {"gain": velocity_changes, "power": power_changes, "energy": energy_changes}


def energy_change(power_change: float, velocity_change: float) -> float:
    """Return the change of energy per meter from the changes of power and velocity [%].

    Args:
        power_change: Change of the power [%].
        velocity_change: Change of the velocity [%].
    """
    return 100.0 * ((100.0 + power_change) / (100.0 + velocity_change) - 1.0)


def collect_robot_numbers() -> Numbers:
    """Return how much longer the fin makes the robot [%], and coefficients that the paper found."""
    robot = load_robot("mamba-fin")
    modular_robot = load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    fin_length = robot.caudal_fin.length
    link_length = robot.modules[0].length
    return {
        "fin": fin_length,
        "link": link_length,
        "robot": robot,
        "modules": modular_robot,
        "longer": 100.0 * fin_length / robot.length,
        "modules_longer": 100.0 * fin_length / modular_robot.length,
        "printed_longer": 100.0 * fin_length / (N_PRINTED_LINKS * link_length),
        "lateral_friction": load_water("paper-lateral").tangential_friction,
        "eel_friction": load_water("paper-eel").tangential_friction,
    }
