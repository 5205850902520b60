"""Do the stated 95 % intervals hold the truth 95 times of 100?

Question: 120 random robots (4 to 11 links, with and without a fin) in waters of random coefficients
and a random current swim three random gaits each; a tracker with noise and a twisted mount sees
their center of mass and heading; where they begin is unknown.
Which share of the intervals holds the true value, of all and by parameter, and is what cannot be
identified (the added inertia of thin links, and the joints' skin, which prescribed joints hold
against) reported as such?

    python campaigns/identify_coverage.py
    python campaigns/identify_coverage.py --lag 0.95

Last answer (2 shared cores, one thread, 2026-11-22; about 1.2 s of processor time per robot):
                                white noise            correlation of 0.95 per 50 ms
                              hold the truth    unidentified  hold the truth   unidentified
water.tangential_friction      105 of  117   89.7 %     3      110 of  114   96.5 %     6
water.normal_drag              108 of  117   92.3 %     3      107 of  114   93.9 %     6
water.added_mass               110 of  115   95.7 %     5      103 of  110   93.6 %    10
water.current_x                110 of  120   91.7 %     0      114 of  120   95.0 %     0
water.current_y                117 of  120   97.5 %     0      116 of  120   96.7 %     0
measured.heading_offset        117 of  119   98.3 %     1      109 of  113   96.5 %     7
water.added_inertia              0 of    0        -   120        0 of    0        -   120
robot.joint.stiffness            0 of    0        -   120        0 of    0        -   120
all                            667 of  708   94.2 %            659 of  691   95.4 %

One parameter's share of 120 scatters by 2 points. 120 other robots (`--seed 7`), white noise: 669
of 713, 93.8 %, by parameter 92.4 to 95.7 %. With starts that are known exactly, and not fitted, 675
of 713 did, 94.7 %, and 693 of 718 of 120 other robots (`--seed 7`).
"""

import argparse
from collections import defaultdict
from dataclasses import dataclass, replace

import numpy as np

import laticauda as lc
from laticauda.identify import Fit, Measurement, Unknown, fit, from_trial
from laticauda.robot import CaudalFin, Joint, Module, Robot, Section
from laticauda.trials import Trial

ROBOTS = 120
SEED = 6
DURATION = 12.0  # of a trial [s]
EVERY = 5  # samples: four a second
POSITION, HEADING = 0.003, 0.01  # standard deviations of the tracker's noise [m], [rad]
HIDDEN = ("water.added_inertia", "robot.joint.stiffness")
SEEN = (
    "water.tangential_friction",
    "water.normal_drag",
    "water.added_mass",
    "water.current_x",
    "water.current_y",
    "measured.heading_offset",
)


@dataclass(frozen=True, kw_only=True)
class Case:
    """One robot in its water, and what a fit found."""

    truth: dict[str, float]
    found: Fit


def random_robot(rng: np.random.Generator) -> Robot:
    """A chain of equal modules that about floats, every second one with a fin."""
    n = int(rng.integers(4, 12))
    section = Section(half_height=rng.uniform(0.03, 0.07), half_width=rng.uniform(0.03, 0.07))
    length = rng.uniform(0.1, 0.2)
    module = Module(
        length=length, mass=1000.0 * section.area * length * rng.uniform(0.7, 1.0), section=section
    )
    fin = (
        CaudalFin(length=rng.uniform(0.2, 0.4), height=rng.uniform(0.06, 0.14))
        if rng.random() < 0.5
        else None
    )
    return Robot(name="random", modules=(module,) * n, joints=(Joint(),) * (n - 1), caudal_fin=fin)


def random_gait(rng: np.random.Generator) -> lc.Gait:
    """A gait of either kind, slightly turning."""
    make = (lc.lateral_undulation, lc.eel_like)[int(rng.integers(2))]
    return make(
        amplitude=rng.uniform(0.3, 0.7),
        frequency=rng.uniform(1.2, 2.6),
        phase_shift=rng.uniform(0.4, 1.0),
        offset=rng.uniform(-0.05, 0.05),
    )


def correlated(shape: tuple[int, ...], lag: float, rng: np.random.Generator) -> np.ndarray:
    """Normal noise, time first, whose correlation falls by a factor from sample to sample."""
    noise = rng.standard_normal(shape)
    for k in range(1, len(noise)):
        noise[k] = lag * noise[k - 1] + np.sqrt(1.0 - lag**2) * noise[k]
    return noise


def tracked(
    trial: Trial, name: str, twist: float, lag: float, rng: np.random.Generator
) -> Measurement:
    """What the tracker makes of a trial: noise on everything, and a mount that is twisted."""
    log = replace(
        trial,
        center_of_mass=trial.center_of_mass
        + POSITION * correlated(trial.center_of_mass.shape, lag, rng),
        heading=trial.heading + twist + HEADING * correlated(trial.heading.shape, lag, rng),
    )
    seen = from_trial(
        log, name=name, series={"center_of_mass": POSITION, "heading": HEADING}, every=EVERY
    )
    return replace(
        seen, scenario=replace(seen.scenario, environment=lc.load_water("paper-lateral"))
    )


def case(number: int, seed: int = SEED, lag: float = 0.0, threads: int | None = 1) -> Case:
    """One random robot, identified; the same for the same number."""
    rng = np.random.default_rng([seed, number])
    robot = random_robot(rng)
    water = lc.load_water("paper-lateral")
    truth = {
        "water.tangential_friction": water.tangential_friction
        * float(np.exp(rng.uniform(-0.7, 0.7))),
        "water.normal_drag": water.normal_drag * float(np.exp(rng.uniform(-0.7, 0.7))),
        "water.added_mass": water.added_mass * float(np.exp(rng.uniform(-0.7, 0.7))),
        "water.current_x": rng.uniform(-0.03, 0.03),
        "water.current_y": rng.uniform(-0.03, 0.03),
        "measured.heading_offset": rng.uniform(-0.1, 0.1),
    }
    true_water = replace(
        water,
        **{name.removeprefix("water."): truth[name] for name in SEEN[:3]},
        current=(truth["water.current_x"], truth["water.current_y"]),
    )
    measurements = [
        tracked(
            lc.swim(robot, random_gait(rng), DURATION, environment=true_water),
            f"{k}",
            truth[SEEN[5]],
            lag,
            rng,
        )
        for k in range(3)
    ]
    wanted = [*SEEN, HIDDEN[0], Unknown(name=HIDDEN[1], start=0.1, upper=10.0)]
    # The law is right: what other laws would leave changes no interval.
    found = fit(measurements, parameters=wanted, n_starts=1, rivals=False, threads=threads)
    return Case(truth=truth, found=found)


def counts(cases: list[Case]) -> dict[str, tuple[int, int, int]]:
    """By parameter: intervals that hold the truth, intervals stated, parameters reported as not identified."""
    found: dict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
    for one in cases:
        for name in (*SEEN, *HIDDEN):
            interval = one.found[name].interval
            if interval is None:
                found[name][2] += 1
            elif name in one.truth:
                found[name][0] += interval[0] <= one.truth[name] <= interval[1]
                found[name][1] += 1
            else:
                found[name][1] += 1
    return {name: (hit, stated, hidden) for name, (hit, stated, hidden) in found.items()}


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--robots", type=int, default=ROBOTS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument(
        "--lag",
        type=float,
        default=0.0,
        help="correlation of the noise from sample to sample, 50 ms",
    )
    options = parser.parse_args()
    cases: list[Case] = []
    for number in range(options.robots):
        cases.append(case(number, options.seed, options.lag))
        if (number + 1) % 20 == 0:
            print(f"{number + 1} robots", flush=True)
    table = counts(cases)
    print(f"{'':28}  hold the truth        not identified")
    for name, (hit, stated, hidden) in table.items():
        share = f"{100 * hit / stated:5.1f} %" if stated and name in SEEN else "      -"
        print(f"{name:28}  {hit:4d} of {stated:4d}  {share}  {hidden:4d}")
    hit, stated = (sum(table[name][i] for name in SEEN) for i in (0, 1))
    print(f"{'all':28}  {hit:4d} of {stated:4d}  {100 * hit / stated:5.1f} %")


if __name__ == "__main__":
    main()
