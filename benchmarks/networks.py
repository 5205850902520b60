"""Neural gaits with feedback: how many seconds of swimming a second of one core buys.

Question: robots of 31 links, each with 30 oscillators that feel their joint's angle and the pressure of
the water, at a control instant every 0.02 s: swimmer-seconds per second of processor time, side by side in
lanes (`swim_many`) and one by one (`swim`)? How large is the difference of their paths?

Method: networks with random phases, natural frequencies and cuts, in one call of `swim_many` on one thread.
Least processor time of a few rounds.

    python benchmarks/networks.py
"""

import time
import warnings
from dataclasses import replace
from functools import partial

import numpy as np
from _timing import fastest, of_links, print_load

import laticauda as lc
from laticauda.control import Feedback, PhaseOscillators

N_ROBOTS = 256
"""Robots in a call."""
N_LINKS = 31
"""Links of each robot."""
DURATION = 4.0
"""Duration of every trial [s]."""
ROUNDS = 5
"""Rounds, of which the fastest counts: others may run on the same machine."""
FEEDBACK = Feedback(pressure=0.08, stretch=-3.0)
GAIT = lc.lateral_undulation(amplitude_deg=10, frequency_deg_s=130, phase_shift_deg=11)


def network_of(seed: int) -> PhaseOscillators:
    """Return a network that is cut in one place.

    Args:
        seed: Its seed, which also says where it is cut.
    """
    return PhaseOscillators(
        gait=GAIT, feedback=FEEDBACK, cuts=(seed % (N_LINKS - 2),), seed=seed, spread=0.05
    )


def main() -> None:
    """Print swimmer-seconds per second, one line per joint law."""
    warnings.simplefilter("ignore")
    robot = of_links(N_LINKS)
    for joints in ("ekeberg", "pd", "servo"):
        first = lc.build_scenario(robot, network_of(0), DURATION, joints=joints)
        scenarios = [replace(first, motion=network_of(seed)) for seed in range(N_ROBOTS)]
        swims = lc.swim_many(scenarios, threads=1)
        trial = lc.swim(scenarios[5])
        difference = np.abs(swims.center_of_mass[5] - trial.center_of_mass[-1]).max()
        in_lanes = fastest(time.process_time, partial(lc.swim_many, scenarios, threads=1), ROUNDS)
        alone = fastest(time.process_time, partial(lc.swim, first), ROUNDS)
        print(
            f"{joints}: {N_ROBOTS * DURATION / in_lanes:.0f} swimmer-seconds a second in lanes, "
            f"{DURATION / alone:.0f} one by one; ends differ by {difference:.1e} m"
        )
    print_load()


if __name__ == "__main__":
    main()
