"""How much of the measured electrical power the gear-motor's formula explains, with two numbers fitted.

    P = active_power + stall_current x (what the motors draw per ampere of stall current)

The two are fitted to the rows of Table 1 (least squares of relative errors), Table 2 is predicted.
Its rows without fin look as if the power at rest had been taken off once more; errors are printed
with and without that hypothesis.

    python benchmarks/power.py

Last answer (2026-11-21), errors of Table 1, of rows left out, of Table 2, and of it with the
hypothesis:
    constant      98.7 W            10.8  11.4  47.8   7.0 %
    prescribed    91.1 W, 0.05 A     9.2  11.3  41.9   2.1 %
    servo         56.9 W, 2.72 A     8.2   9.5  28.4  15.0 %
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import laticauda as lc
from laticauda.paper.measured import read_efficiency_trials, read_path_following_trials
from laticauda.paper.settings import load_paper_coefficients
from laticauda.scenarios import limit_case


def simulate_power(rows: Sequence, joints: str) -> np.ndarray:
    """Power of all motors at a stall current of 1 A [W]."""
    water = load_paper_coefficients().water
    power = []
    for row in rows:
        robot = lc.load_robot("mamba-fin" if row.has_fin else "mamba")
        joint = robot.joints[0]
        joint = replace(joint, actuator=replace(joint.actuator, stall_current=1.0))
        robot = replace(robot, joints=(joint,) * robot.n_joints, active_power=0.0)
        with limit_case():  # the current is a unit, not that of a motor
            trial = lc.swim(robot, row.gait, environment=water(row.gait.kind), joints=joints)
        power.append(trial.electrical_power)
    return np.array(power)


def fit_numbers(columns: np.ndarray, power: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(columns / power[:, np.newaxis], np.ones(power.size), rcond=None)[0]


def mape(predicted: np.ndarray, measured: np.ndarray) -> float:
    return 100.0 * float(np.mean(np.abs(predicted / measured - 1.0)))


def error_of_rows_left_out(columns: np.ndarray, power: np.ndarray) -> float:
    """Error of rows that were not fitted, one at a time [%]."""
    predicted = np.zeros(power.size)
    for k in range(power.size):
        is_fitted = np.arange(power.size) != k
        predicted[k] = columns[k] @ fit_numbers(columns[is_fitted], power[is_fitted])
    return mape(predicted, power)


def columns_of(rows: Sequence, joints: str) -> np.ndarray:
    """What each of the numbers that are fitted is multiplied with, by row."""
    constant = np.ones((len(rows), 1))
    if joints == "constant":
        return constant
    return np.column_stack((constant, simulate_power(rows, joints)))


def main() -> None:
    table1 = [row for row in read_efficiency_trials() if row.mean_power is not None]
    table2 = read_path_following_trials()
    power1 = np.array([row.mean_power for row in table1])
    power2 = np.array([row.mean_power for row in table2])
    idle_power = lc.load_robot("mamba").idle_power
    taken_off = np.array([0.0 if row.has_fin else idle_power for row in table2])
    print(
        "joints, [W], [A]; error of Table 1, of rows left out, of Table 2, of Table 2 with the idle hypothesis [%]"
    )
    for joints in ("constant", "prescribed", "servo"):
        columns1 = columns_of(table1, joints)
        best = fit_numbers(columns1, power1)
        predicted2 = columns_of(table2, joints) @ best
        errors = (
            mape(columns1 @ best, power1),
            error_of_rows_left_out(columns1, power1),
            mape(predicted2, power2),
            mape(predicted2 - taken_off, power2),
        )
        print(f"{joints:10}", np.round(best, 3), *(f"{error:.1f}" for error in errors))


if __name__ == "__main__":
    main()
