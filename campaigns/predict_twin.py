"""Do the intervals of `predict` hold what a robot does at a gait that nobody has measured?

Question: a robot of its own (4 to 11 links, half with a fin) swims 8 to 20 gaits, and each speed is
measured with noise of 3 %, which is stated. Its water is a random one: friction within a factor of
two of the textbook's; drag across the body, added mass and beta anywhere in their intervals. A fit
identifies friction and, with its prior from the textbook, drag; added mass and beta stay at the
textbook's values. Then one more gait is predicted. How often does the 95 % interval hold the speed
that the robot has there, without noise? There are three kinds of robots:

    right   the model is right
    error   it is off by another 2 to 6 %, one size for each robot, at every gait, independently;
            the true speed is the one with this error
    law     the robot sheds added mass, and drags, by laws that are not the model's

    python campaigns/predict_twin.py --robots 500       # of each kind; goes on where the table ends
    python campaigns/predict_twin.py                    # the answer from predict_twin.csv

The tests run a slice of it.

Last answer (2 shared cores, 2026-11-29; 0.6 s of processor time per robot):
                        hold          half width [%]      deviations [%]: coefficients,
kind   noise      of    the speed     median, 5 to 95 %   held fixed, left out
right  known      500    500  100.0 %   8.0, 4.9 to 14.4      1.23  2.19   2.83
right  estimated  100    100  100.0 %   8.0, 4.9 to 14.3      1.36  2.26   2.79
error  known      500    479   95.8 %   11.4, 6.5 to 19.7     1.73  2.23   4.67
error  estimated  100     97   97.0 %   11.1, 6.8 to 20.2     1.79  2.42   4.45
law    known       60     58   96.7 %   62.3, 26.5 to 105.3   9.07  2.91  30.13
law    estimated   12     11   91.7 %   58.0, 32.7 to 184.6   7.59  2.99  28.53
power, model right, noise known: 492 of 500, 98.4 %

The intervals of the third kind are wide, and hold the truth: a model that is wrong by a tenth or a
half says so. Where the model is right, they are wider than they need to be, for measurements with
noise do not prove it.
"""

import argparse
import math
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from _rows import go_on, stored

import laticauda as lc
from laticauda.identify import Measurement, Unknown, basis_of, fit, predict_scenario
from laticauda.robot import CaudalFin, Joint, Module, Robot, Section, Textbook, textbook_water

KINDS = ("right", "error", "law")
METHODS = ("known", "estimated")
EVERY = 5  # of so many robots, one is also fitted with its noise estimated
NOISE = 0.03  # of a measured speed [-]
ERRORS = (0.02, 0.06)  # least and greatest error of the model, of the robots of that kind [-]
DURATION = 10.0  # of a trial [s]
FILE = Path(__file__).with_suffix(".csv")


@dataclass
class Row:
    """One robot: the truth, and what was predicted with the noise known and with it estimated."""

    fault: str  # the kind of robot
    seed: int
    n_trials: int
    error: float  # standard deviation of the model's error [-]
    speed: float  # the true one [m/s]
    power: float  # the true one, of the model [W]
    known_low: float
    known_value: float
    known_high: float
    known_coefficients: float
    known_held: float
    known_left_out: float
    known_power_low: float
    known_power_high: float
    known_off: float
    known_explained: float
    known_degrees: float
    estimated_low: float
    estimated_value: float
    estimated_high: float
    estimated_coefficients: float
    estimated_held: float
    estimated_left_out: float
    estimated_power_low: float
    estimated_power_high: float
    estimated_off: float
    estimated_explained: float
    estimated_degrees: float

    def is_predicted(self, method: str) -> bool:
        """Whether this robot was fitted in this way."""
        return not math.isnan(getattr(self, f"{method}_value"))

    def holds(self, method: str) -> bool:
        """Whether the interval holds the true speed."""
        return getattr(self, f"{method}_low") <= self.speed <= getattr(self, f"{method}_high")

    def holds_power(self, method: str) -> bool:
        """Whether the interval holds the true power."""
        low, high = (getattr(self, f"{method}_power_{end}") for end in ("low", "high"))
        return low <= self.power <= high

    def half_width(self, method: str) -> float:
        """Half of the interval of the speed, relative."""
        low, high = (getattr(self, f"{method}_{end}") for end in ("low", "high"))
        return 0.5 * math.log(high / low)


def random_robot(rng: np.random.Generator) -> Robot:
    """A chain of equal modules that about floats, every second one with a fin."""
    n_links = int(rng.integers(4, 12))
    section = Section(half_height=rng.uniform(0.03, 0.07), half_width=rng.uniform(0.03, 0.07))
    length = rng.uniform(0.1, 0.2)
    mass = 1000.0 * section.area * length * rng.uniform(0.8, 1.0)
    module = Module(length=length, mass=mass, section=section)
    fin = None
    if rng.random() < 0.5:
        fin = CaudalFin(
            length=rng.uniform(0.1, 0.25), height=rng.uniform(0.06, 0.14), opening_length=0.0
        )
    joints = (Joint(),) * (n_links - 1)
    return Robot(name="random", modules=(module,) * n_links, joints=joints, caudal_fin=fin)


def random_gait(rng: np.random.Generator) -> lc.Gait:
    """A gait of either kind."""
    make = (lc.lateral_undulation, lc.eel_like)[int(rng.integers(2))]
    return make(
        amplitude=rng.uniform(0.3, 0.7),
        frequency=rng.uniform(1.2, 3.0),
        phase_shift=rng.uniform(0.5, 1.0),
    )


def textbook_then(robot: Robot) -> Textbook:
    """The textbook as it was for the stored answer: fins like bodies, with the edge of slender ones."""
    textbook = textbook_water(robot)
    water = replace(
        textbook.water, plate_drag=None, plate_added_mass=None, trailing_edge="elongated"
    )
    intervals = {
        name: ends
        for name, ends in textbook.intervals.items()
        if not name.startswith("water.plate")
    }
    return replace(textbook, water=water, intervals=intervals)


def true_water(textbook: Textbook, kind: str, rng: np.random.Generator) -> lc.Water:
    """Water that nobody knows."""
    water = textbook.water
    drawn = {name: rng.uniform(*ends) for name, ends in textbook.intervals.items()}
    drag = replace(water.drag, beta=drawn["water.drag.beta"])
    changes = {}
    if kind == "law":
        changes = {"rotational": "paper", "trailing_edge": "none"}
    return replace(
        water,
        tangential_friction=water.tangential_friction * math.exp(rng.uniform(-0.7, 0.7)),
        normal_drag=drawn["water.normal_drag"],
        added_mass=drawn["water.added_mass"],
        drag=drag,
        **changes,
    )


def run(kind: str, seed: int) -> Row:
    """One robot; the same for the same kind and seed."""
    rng = np.random.default_rng([KINDS.index(kind), seed])
    while True:
        robot = random_robot(rng)
        textbook = textbook_then(robot)
        water = true_water(textbook, kind, rng)
        gaits = [random_gait(rng) for _ in range(int(rng.integers(8, 21)) + 1)]
        swims = lc.swim_many(robot, gaits, DURATION, environments=water, threads=1)
        speeds = np.asarray(swims.forward_velocity)
        if np.all(speeds > 0.01):  # a robot that does not swim is no case
            break
    error = 0.0
    if kind == "error":
        error = rng.uniform(*ERRORS)
    truths = speeds * np.exp(error * rng.standard_normal(speeds.size))
    measured = truths * (1.0 + NOISE * rng.standard_normal(speeds.size))
    measurements = [
        Measurement(
            name=f"{number}",
            scenario=lc.build_scenario(robot, gait, DURATION, environment=textbook.water),
            figures={"forward_velocity": (float(speed), NOISE * float(speed))},
        )
        for number, (gait, speed) in enumerate(zip(gaits[1:], measured[1:], strict=True))
    ]
    low, high = textbook.intervals["water.normal_drag"]
    prior = (0.5 * (low + high), (high - low) / math.sqrt(12.0))
    unknowns = ["water.tangential_friction", Unknown(name="water.normal_drag", prior=prior)]
    numbers = {name: math.nan for name in Row.__annotations__ if name.startswith(METHODS)}
    for method in METHODS[: 1 + (seed % EVERY == 0)]:
        found = fit(measurements, parameters=unknowns, noise=method, n_starts=1, threads=1)
        start = found.problem.scenarios_at(found.best)[0]
        basis = basis_of(found)
        seen = basis.left_out["forward_velocity"].by_measurement
        wanted = predict_scenario(basis, replace(start, motion=gaits[0]), threads=1)
        speed, power = wanted.figures["forward_velocity"], wanted.figures["mean_power"]
        numbers |= {
            f"{method}_low": speed.low,
            f"{method}_value": speed.value,
            f"{method}_high": speed.high,
            f"{method}_coefficients": speed.shares.coefficients,
            f"{method}_held": speed.shares.held_fixed,
            f"{method}_left_out": speed.shares.left_out or math.nan,
            f"{method}_power_low": power.low,
            f"{method}_power_high": power.high,
            f"{method}_off": seen.off,
            f"{method}_explained": seen.explained,
            f"{method}_degrees": seen.degrees,
        }
    return Row(
        fault=kind,
        seed=seed,
        n_trials=len(measurements),
        error=error,
        speed=float(truths[0]),
        power=float(swims.mean_power[0]),
        **{name: float(number) for name, number in numbers.items()},
    )


def describe(rows: list[Row]) -> str:
    """The answer: by kind of robot, how many intervals hold the truth, and how wide they are."""
    lines = [
        "                        hold          half width [%]      deviations [%]: coefficients,",
        "kind   noise      of    the speed     median, 5 to 95 %   held fixed, left out",
    ]
    for kind in KINDS:
        for method in METHODS:
            own = [row for row in rows if row.fault == kind and row.is_predicted(method)]
            if own:
                lines.append(_describe_kind(own, kind, method))
    right = [row for row in rows if row.fault == "right"]
    if right:
        n_held = sum(row.holds_power("known") for row in right)
        lines.append(
            f"power, model right, noise known: {n_held} of {len(right)}, {100 * n_held / len(right):.1f} %"
        )
    return "\n".join(lines)


def _describe_kind(own: list[Row], kind: str, method: str) -> str:
    n_held = sum(row.holds(method) for row in own)
    low, middle, high = np.percentile([100 * row.half_width(method) for row in own], [5, 50, 95])
    shares = [
        100 * float(np.median([getattr(row, f"{method}_{name}") for row in own]))
        for name in ("coefficients", "held", "left_out")
    ]
    widths = f"{middle:.1f}, {low:.1f} to {high:.1f}"
    return (
        f"{kind:6} {method:9} {len(own):4} {n_held:6} {100 * n_held / len(own):6.1f} %   "
        f"{widths:21}{shares[0]:5.2f} {shares[1]:5.2f} {shares[2]:6.2f}"
    )


def main() -> None:
    """Go on with the table, and print the answer."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--robots", type=int, default=0, help="of each kind")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--kinds", nargs="*", default=KINDS)
    options = parser.parse_args()
    jobs = [(kind, seed) for seed in range(options.robots) for kind in options.kinds]
    rows = go_on(FILE, Row, jobs, partial(run), options.workers) if jobs else stored(FILE, Row)
    print(describe(rows), file=sys.stdout)


if __name__ == "__main__":
    main()
