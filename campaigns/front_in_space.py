"""What does the twin in space, with the published servos, make of gaits that a search in the plane found best?

A front is searched for `mamba-fin` twice, with servo joints and with prescribed ones that keep
within what the servos have (`laticauda optimize`, 800 points of 20 s). Ten gaits of each then swim
in space with servos.

    python campaigns/front_in_space.py
"""

import argparse
import tempfile
from collections.abc import Sequence
from contextlib import redirect_stdout
from io import StringIO

import numpy as np

import laticauda as lc
from laticauda.cli.app import main as laticauda

SEARCH = "optimize --robot mamba-fin --gait lateral-undulation --budget 800 --population 40 --duration 20 --seed 1"
N_GAITS, DURATION = 10, 20.0  # [-], [s]


def errors(joints: str) -> np.ndarray:
    """Speed in space with servos over what the search had in the plane with `joints`, less 1, of each gait [%]."""
    robot = lc.load_robot("mamba-fin")
    with tempfile.TemporaryDirectory() as folder:
        with redirect_stdout(StringIO()):
            laticauda([*SEARCH.split(), "--joints", joints, "--output", folder])
        front = np.genfromtxt(f"{folder}/front.csv", delimiter=",", skip_header=1)[:, :4]
    found: list[float] = []
    for amplitude, frequency, shift, speed in front[
        np.linspace(0, len(front) - 1, N_GAITS).astype(int)
    ].tolist():
        gait = lc.lateral_undulation(amplitude=amplitude, frequency=frequency, phase_shift=shift)
        trial = lc.swim(robot, gait, DURATION, joints="servo", model="spatial")
        found.append(100.0 * (trial.forward_velocity / speed - 1.0))
    return np.array(found)


def main(words: Sequence[str] | None = None) -> None:
    """Print the errors of both fronts."""
    argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    ).parse_args(words)
    for joints in ("servo", "prescribed"):
        off = errors(joints)
        print(
            f"searched with {joints} joints: speed in space with servos off by {off.min():+.3f} to {off.max():+.3f} %"
        )


if __name__ == "__main__":
    main()
