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


def simulated(rows: Sequence, joints: str) -> np.ndarray:
    """Power of all motors at a stall current of 1 A [W]."""
    water = load_paper_coefficients().water
    found = []
    for row in rows:
        robot = lc.load_robot("mamba-fin" if row.has_fin else "mamba")
        joint = robot.joints[0]
        joint = replace(joint, actuator=replace(joint.actuator, stall_current=1.0))
        robot = replace(robot, joints=(joint,) * robot.n_joints, active_power=0.0)
        with limit_case():  # the current is a unit, not that of a motor
            trial = lc.swim(robot, row.gait, environment=water(row.gait.kind), joints=joints)
        found.append(trial.electrical_power)
    return np.array(found)


def fitted(columns: np.ndarray, power: np.ndarray) -> np.ndarray:
    return np.linalg.lstsq(columns / power[:, np.newaxis], np.ones(power.size), rcond=None)[0]


def mape(predicted: np.ndarray, measured: np.ndarray) -> float:
    return 100.0 * float(np.mean(np.abs(predicted / measured - 1.0)))


def left_out(columns: np.ndarray, power: np.ndarray) -> float:
    """Error of rows that were not fitted, one at a time."""
    others = [np.arange(power.size) != k for k in range(power.size)]
    return mape(
        np.array([columns[k] @ fitted(columns[m], power[m]) for k, m in enumerate(others)]), power
    )


def main() -> None:
    first = [row for row in read_efficiency_trials() if row.mean_power is not None]
    second = read_path_following_trials()
    of_first, of_second = (np.array([row.mean_power for row in rows]) for rows in (first, second))
    idle = np.array([0.0 if row.has_fin else lc.load_robot("mamba").idle_power for row in second])
    print(
        "joints, [W], [A]; error of Table 1, of rows left out, of Table 2, of Table 2 with the idle hypothesis [%]"
    )
    for joints in ("constant", "prescribed", "servo"):
        columns = [np.ones((len(rows), 1)) for rows in (first, second)]
        if joints != "constant":
            motors = [simulated(rows, joints) for rows in (first, second)]
            columns = [np.column_stack(pair) for pair in zip(columns, motors, strict=True)]
        best = fitted(columns[0], of_first)
        after = columns[1] @ best
        errors = (
            mape(columns[0] @ best, of_first),
            left_out(columns[0], of_first),
            mape(after, of_second),
            mape(after - idle, of_second),
        )
        print(f"{joints:10}", np.round(best, 3), *(f"{error:.1f}" for error in errors))


if __name__ == "__main__":
    main()
