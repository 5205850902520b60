"""Path following side by side, and robot by robot.

Question: 30 s of robots of ten links on a line, with line of sight every 0.05 s: how many times the
processor time of a trial without a controller, and what share of that of a single run?

Method: 512 robots from different starts in one call of `swim_many`, on one thread; the batch without a
controller has as many trials, with random gaits. Least processor time of a few rounds, in turns in one
process, so that only ratios matter.

    python benchmarks/closed_loops.py
"""

import time
import warnings
from dataclasses import replace
from functools import partial

import numpy as np
from _timing import fastest, of_links, random_gaits

import laticauda as lc
from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine

N_ROBOTS = 512
ROUNDS = 3


def main() -> None:
    """Print the ratios, one line per joint law."""
    warnings.simplefilter("ignore", lc.InfeasibleWarning)
    robot = of_links(10)
    gaits = random_gaits(N_ROBOTS)
    follower = PathFollowing(
        gait=gaits[0],
        path=StraightLine(),
        guidance=LineOfSight(look_ahead_distance=1.8),
        heading=HeadingController(gain=0.4, max_offset=0.35),
    )
    for joints in ("prescribed", "pd", "servo"):
        scenario = lc.build_scenario(robot, follower, 30.0, joints=joints)
        starts = [
            lc.Start(center_of_mass=(0.0, y)) for y in np.linspace(-2.0, 2.0, N_ROBOTS).tolist()
        ]
        scenarios = [replace(scenario, start=start) for start in starts]
        follow_in_lanes = partial(lc.swim_many, scenarios, threads=1)
        swim_in_lanes = partial(lc.swim_many, robot, gaits, threads=1, joints=joints)
        follow_alone = partial(lc.swim, scenarios[0])
        following = fastest(time.process_time, follow_in_lanes, ROUNDS) / N_ROBOTS
        swimming = fastest(time.process_time, swim_in_lanes, ROUNDS) / N_ROBOTS
        alone = fastest(time.process_time, follow_alone, ROUNDS)
        print(
            f"{joints}: {1e3 * following:.3f} ms a trial, {following / swimming:.2f} times one "
            f"without a controller, 1/{alone / following:.0f} of a single run"
        )


if __name__ == "__main__":
    main()
