"""How right is the twin that learns while the robot swims, and how soon does it name what has happened?

Question: an operation of a minute in the virtual tank, in water whose drag and friction nobody
fitted (off by 20 %, one standard deviation) and that moves (4 mm/s), with a marker body that sits
elsewhere than is said (0.3 deg). How often does the truth lie within the 95 % intervals of what is
learnt, after 20, 40 and 60 s? How far off is the speed that it foresees for the next minute? And
with a fin that is lost, a joint that jams or is weak, water that begins to move: what is named, and
how long after? The tank is stepped, so a seed always gives the same run.

    python campaigns/learning_twin.py --runs 54         # good ones
    python campaigns/learning_twin.py --faults 10       # of each; goes on where learning_twin.csv ends
    python campaigns/learning_twin.py                   # the table of what is in learning_twin.csv

The tests run a slice of it.
"""

import argparse
import math
import random
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import NamedTuple

from _rows import go_on

import laticauda as lc
from laticauda.control.estimation import Learned, Learner, Learning, Sample
from laticauda.control.estimation.learning import CRAB
from laticauda.tank.lab import Fault, LabSettings, Tank, VirtualRobot
from laticauda.tank.lab.faults import ON_NODES
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.settings import Calibration, CaptureVolume, Connection, Operation
from laticauda.tank.operate.tank_devices import TankDevices

FAULTS = {
    "lost fin": "lost_fin",
    "jammed joint": "stuck_servo",
    "weak joint, half": "weak_servo",
    "moving water, 3 cm/s": "moving_water",
}
"""Kinds of the tank's faults, by their titles."""
SIZES = {"weak_servo": {"share": 0.5}, "moving_water": {"speed": 0.03}}
"""Arguments of faults."""
NAMES = {"lost_fin": "fin", "stuck_servo": "stuck", "weak_servo": "weak", "moving_water": "water"}
"""A word that names each fault rightly."""
DURATION = 61.0
"""Duration of a run [s]."""
TIMES = (20.0, 40.0, 60.0)
"""Times at which it is asked what is known [s]."""
LEARNT = ("normal_drag", "tangential_friction", "current_x", "current_y")
"""Numbers that are learnt."""
FILE = Path(__file__).with_suffix(".csv")


@dataclass
class Row:
    """One run."""

    fault: str
    """Its title; "" for a good run."""
    seed: int
    what: str
    """Robot and gait."""
    off: str
    """Of good runs: what is learnt less the truth, by its standard deviation, at each time."""
    speed: float
    """Relative error of the speed that is foreseen for the next minute."""
    named: str
    """The first thing that was named."""
    after: float
    """When, after the fault; of good runs: after the beginning; nan: nothing was named [s]."""


class Follower:
    """A sink of entries of a recording, which hands them to a learner."""

    trouble = ""

    def __init__(self, learner: Learner) -> None:
        self.learner = learner
        self.state = learner.init()
        self.learned: list[Learned] = []

    def keep(self, now: float, entries) -> None:
        for entry in entries:
            if isinstance(entry, Sample):
                self.state = self.learner.step(self.state, entry)
                if self.state.learned is not None:
                    self.learned.append(self.state.learned)

    def known_at(self, time: float) -> Learned:
        """What was known at a time [s]."""
        return [learned for learned in self.learned if learned.time <= time][-1]


def operation(chance: random.Random, fault: str) -> Operation:
    """A straight run by a gait that nobody fitted."""
    gait = lc.lateral_undulation(
        amplitude=math.radians(chance.choice([25, 30])),
        frequency=math.radians(chance.choice([90, 110, 120])),
        phase_shift=math.radians(40),
    )
    return Operation(
        name="campaign",
        robot="mamba-fin" if fault == "lost fin" else chance.choice(["mamba", "mamba-fin"]),
        gait=gait,
        duration=DURATION,
        rate=50.0,
        countdown=0.5,
        estimator="kinematics",
        tank=CaptureVolume(volume_x=(-9.0, 19.0), volume_y=(-9.0, 9.0)),
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(
            joint_zeros=True,
            idle_time=0.5,
            still_time=2.0,
            patience=10.0,
            marker_yaw=chance.gauss(0.0, CRAB),
        ),
    )


class Injection:
    """Looks at every tick whether the run has begun, and then has the tank's fault come later."""

    def __init__(self, tank: Tank, kind: str, chance: random.Random) -> None:
        self.tank = tank
        self.kind = kind
        self.chance = chance
        self.delay = chance.uniform(25.0, 29.0)
        """Time from the beginning to the fault [s]."""
        self.node = chance.randint(2, 6)
        self.begun_at: float | None = None

    def __call__(self, state, outputs) -> None:
        if state.begun is None or self.begun_at is not None:
            return
        self.begun_at = state.begun
        if self.kind:
            self.tank.inject(self._fault(state.begun + self.delay))

    def _fault(self, time: float) -> Fault:
        towards = 0.0
        if self.kind != "stuck_servo":
            towards = self.chance.uniform(0.0, 2.0 * math.pi)
        arguments = dict(SIZES.get(self.kind, {}))
        if self.kind in ON_NODES:
            arguments["node"] = self.node
        return Fault(kind=self.kind, time=time, towards=towards, **arguments)


def run_one(fault: str, seed: int) -> Row:
    """One operation, with a fault or good."""
    chance = random.Random(f"{fault} {seed}")
    operated = operation(chance, fault)
    robot, guess = operated.body(), operated.pool()
    current = (chance.gauss(0.0, 0.004), chance.gauss(0.0, 0.004))
    coefficients = {
        name: getattr(guess, name) * math.exp(chance.gauss(0.0, 0.2)) for name in Learning().unknown
    }
    true_water = replace(guess, current=current, **coefficients)
    body = VirtualRobot(robot, lc.build_plant(robot, true_water, joints="servo"))
    tank = Tank(body, LabSettings(seed=seed, step=0.02))
    plant = lc.build_plant(robot, guess, joints="servo")
    learner = Learner(robot=robot, plant=plant, mount=operated.calibration.mount)
    follower = Follower(learner)
    injection = Injection(tank, FAULTS.get(fault, ""), chance)
    state, _ = run_loop(
        Operator(operation=operated, clears=False, check_only=False, twin=None),
        TankDevices(tank, has_meter=True),
        keys=lambda _: {},
        sink=follower,
        show=injection,
        longest=DURATION + 60.0,
    )
    gait = operated.gait
    what = f"{operated.robot} {gait.amplitude:.2f} {gait.frequency:.2f}"
    if injection.begun_at is None:
        return Row(fault, seed, what, "", math.nan, f"never began: {state.failure}", math.nan)
    errors = ""
    since = injection.begun_at + injection.delay
    if not fault:
        since = injection.begun_at
        truth = {**coefficients, "current_x": current[0], "current_y": current[1]}
        known = [follower.known_at(injection.begun_at + time) for time in TIMES]
        errors = "; ".join(describe_errors(learned, truth) for learned in known)
    change = first_change(follower.learned, since)
    return Row(
        fault=fault,
        seed=seed,
        what=what,
        off=errors,
        speed=error_of_speed(operated, follower.learned[-1], true_water),
        named=change.name,
        after=round(change.delay, 2),
    )


class Change(NamedTuple):
    """What a learner named first."""

    name: str
    """"" if nothing was."""
    delay: float
    """When [s]."""


def first_change(learned: list[Learned], since: float) -> Change:
    """The first change that was named since a time [s]."""
    for known in learned:
        if known.changes and known.time > since:
            return Change(known.changes[0], known.time - since)
    return Change("", math.nan)


def describe_errors(learned: Learned, truth: dict[str, float]) -> str:
    errors: list[str] = []
    for name in LEARNT:
        error = (learned.value[name] - truth[name]) / learned.deviation[name]
        errors.append(f"{name}={error:.2f}")
    return " ".join(errors)


def error_of_speed(operated: Operation, learned: Learned, true_water: lc.Water) -> float:
    """The relative error of the speed through the water in the next minute, if it swims as the twin has learnt."""
    robot = operated.body()
    still = true_water.still
    learnt_water = replace(still, **{name: learned.value[name] for name in Learning().unknown})

    def speed_in(water: lc.Water) -> float:
        trial = lc.swim(robot, operated.gait, environment=water, joints="servo", duration=60.0)
        return trial.forward_velocity

    return round(speed_in(learnt_water) / speed_in(still) - 1.0, 4)


def table(rows: list[Row]) -> str:
    """Coverage, foreseen speeds, false alarms; what was named, and when."""
    good = [row for row in rows if not row.fault and row.off]
    lines = [f"good runs: {len(good)}, {len(good) * DURATION / 3600.0:.2f} h"]
    lines += lines_of_coverage(good)
    errors = sorted(100.0 * abs(row.speed) for row in good)
    if errors:
        lines.append(
            f"    speed of the next minute: off by {median(errors):.1f} %, {errors[-1]:.1f} % at most"
        )
    alarms = [row for row in good if row.named]
    lines.append(f"    named although nothing happened: {len(alarms)}")
    for fault in FAULTS:
        rows_of_fault = [row for row in rows if row.fault == fault]
        if rows_of_fault:
            lines.append(line_of_fault(rows_of_fault))
    return "\n".join(lines)


def lines_of_coverage(good: list[Row]) -> list[str]:
    """How often intervals hold the truth, at each time and in all."""
    lines: list[str] = []
    all_held: list[bool] = []
    for i, time in enumerate(TIMES):
        errors_of_runs = [read_errors(row.off.split("; ")[i]) for row in good]
        for name in LEARNT:
            held = [abs(errors[name]) < 1.96 for errors in errors_of_runs]
            all_held += held
            share = 100 * sum(held) / max(len(held), 1)
            lines.append(f"    {name:<20} after {time:.0f} s: {share:>4.0f} % within 95 %")
    share = 100 * sum(all_held) / max(len(all_held), 1)
    lines.append(f"    all {len(all_held)} intervals: {share:.1f} % hold the truth")
    return lines


def read_errors(text: str) -> dict[str, float]:
    """Errors by name, as `describe_errors` writes them."""
    errors: dict[str, float] = {}
    for part in text.split():
        name, error = part.split("=")
        errors[name] = float(error)
    return errors


def line_of_fault(rows: list[Row]) -> str:
    """How often a fault was named, rightly or otherwise, and when."""
    fault = rows[0].fault
    name = NAMES[FAULTS[fault]]
    delays = sorted(row.after for row in rows if name in row.named.lower())
    n_other = sum(bool(row.named) and name not in row.named.lower() for row in rows)
    when = "-"
    if delays:
        when = f"{median(delays):.1f} s (median), {delays[-1]:.1f} s at most"
    return (
        f"{fault:<22}{len(rows):>4} runs, named right {len(delays):>3}, "
        f"otherwise {n_other:>3}; after {when}"
    )


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=0, help="good ones, from seed 1000 on")
    parser.add_argument("--faults", type=int, default=0, help="of each fault")
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = [("", 1000 + seed) for seed in range(options.runs)]
    jobs += [(fault, seed) for seed in range(options.faults) for fault in FAULTS]
    rows = go_on(options.file, Row, jobs, run_one, options.workers)
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
