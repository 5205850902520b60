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

from _rows import gone_on

import laticauda as lc
from laticauda.control.estimation import Learned, Learner, Learning, Sample
from laticauda.control.estimation.learning import CRAB
from laticauda.tank.lab import Fault, LabSettings, Tank, VirtualRobot
from laticauda.tank.lab.faults import ON_NODES
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.settings import Calibration, CaptureVolume, Connection, Operation
from laticauda.tank.operate.tank_devices import TankDevices

FAULTS = {"lost fin": "lost_fin", "jammed joint": "stuck_servo", "weak joint, half": "weak_servo"}
FAULTS["moving water, 3 cm/s"] = "moving_water"
SIZES = {"weak_servo": {"share": 0.5}, "moving_water": {"speed": 0.03}}
NAMES = {"lost_fin": "fin", "stuck_servo": "stuck", "weak_servo": "weak", "moving_water": "water"}
DURATION, AT = 61.0, (20.0, 40.0, 60.0)  # of a run, and when it is asked what is known [s]
LEARNT = ("normal_drag", "tangential_friction", "current_x", "current_y")
FILE = Path(__file__).with_suffix(".csv")


@dataclass
class Row:
    """One run."""

    fault: str
    seed: int
    what: str
    off: str  # of good runs: what is learnt less the truth, by its standard deviation, at each time
    speed: float  # of the next minute, as it is foreseen: relative error
    named: str  # the first thing that was named
    after: float  # the fault [s]; of good runs: after the beginning; nan: nothing was


class Heard:
    """What a learner makes of the entries of a recording."""

    trouble = ""

    def __init__(self, learner: Learner) -> None:
        self.learner, self.state, self.learned = learner, learner.init(), list[Learned]()

    def keep(self, now: float, found) -> None:
        for entry in found:
            if isinstance(entry, Sample):
                self.state = self.learner.step(self.state, entry)
                self.learned += [] if self.state.learned is None else [self.state.learned]


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


def run_one(fault: str, seed: int) -> Row:
    """One operation, with a fault or good."""
    chance = random.Random(f"{fault} {seed}")
    what, unknown = operation(chance, fault), Learning().unknown
    robot, guess = what.body(), what.pool()
    current = (chance.gauss(0.0, 0.004), chance.gauss(0.0, 0.004))
    share = {name: math.exp(chance.gauss(0.0, 0.2)) for name in unknown}
    true = replace(
        guess, current=current, **{name: getattr(guess, name) * one for name, one in share.items()}
    )
    body = VirtualRobot(robot, lc.build_plant(robot, true, joints="servo"))
    tank = Tank(body, LabSettings(seed=seed, step=0.02))
    heard = Heard(
        Learner(
            robot=robot,
            plant=lc.build_plant(robot, guess, joints="servo"),
            mount=what.calibration.mount,
        )
    )
    begun, wait, node = list[float](), chance.uniform(25.0, 29.0), chance.randint(2, 6)

    def show(state, outputs) -> None:
        if state.begun is None or begun:
            return
        begun.append(state.begun)
        kind = FAULTS.get(fault, "")
        if kind:
            towards = 0.0 if kind == "stuck_servo" else chance.uniform(0.0, 2.0 * math.pi)
            where = {"node": node} if kind in ON_NODES else {}
            of = SIZES.get(kind, {})
            tank.inject(Fault(kind=kind, time=state.begun + wait, towards=towards, **where, **of))

    operator = Operator(operation=what, clears=False, check_only=False, twin=None)
    state, _ = run_loop(
        operator,
        TankDevices(tank, has_meter=True),
        keys=lambda _: {},
        sink=heard,
        show=show,
        longest=DURATION + 60.0,
    )
    words = f"{what.robot} {what.gait.amplitude:.2f} {what.gait.frequency:.2f}"
    if state.begun is None:
        return Row(fault, seed, words, "", math.nan, f"never began: {state.failure}", math.nan)
    since = begun[0] + (wait if fault else 0.0)
    named = [
        (one.time - since, one.changes[0])
        for one in heard.learned
        if one.changes and one.time > since
    ]
    truth = {name: getattr(true, name) for name in unknown}
    truth |= dict(zip(("current_x", "current_y"), current, strict=True))
    off = [_off(known_at(heard.learned, begun[0] + at), truth) for at in AT] if not fault else []
    after, name = named[0] if named else (math.nan, "")
    return Row(
        fault, seed, words, "; ".join(off), foreseen(what, heard, true), name, round(after, 2)
    )


def known_at(learned: list[Learned], time: float) -> Learned:
    """What was known at a moment [s]."""
    return [one for one in learned if one.time <= time][-1]


def _off(known: Learned, truth: dict[str, float]) -> str:
    return " ".join(
        f"{name}={(known.value[name] - truth[name]) / known.deviation[name]:.2f}" for name in LEARNT
    )


def foreseen(what: Operation, heard: Heard, true: lc.Water) -> float:
    """The relative error of the speed through the water in the next minute, if it swims as the twin has learnt."""
    robot, known = what.body(), heard.learned[-1].value
    water = replace(true.still, **{name: known[name] for name in Learning().unknown})
    speeds = [
        lc.swim(robot, what.gait, environment=one, joints="servo", duration=60.0).forward_velocity
        for one in (true.still, water)
    ]
    return round(speeds[1] / speeds[0] - 1.0, 4)


def table(rows: list[Row]) -> str:
    """Coverage, foreseen speeds, false alarms; what was named, and when."""
    good = [row for row in rows if not row.fault and row.off]
    lines = [f"good runs: {len(good)}, {len(good) * DURATION / 3600.0:.2f} h"]
    every: list[bool] = []
    for i, at in enumerate(AT):
        found = [dict(part.split("=") for part in row.off.split("; ")[i].split()) for row in good]
        for name in LEARNT:
            within = [abs(float(one[name])) < 1.96 for one in found]
            every += within
            lines.append(
                f"    {name:<20} after {at:.0f} s: {100 * sum(within) / max(len(within), 1):>4.0f} % within 95 %"
            )
    lines.append(
        f"    all {len(every)} intervals: {100 * sum(every) / max(len(every), 1):.1f} % hold the truth"
    )
    errors = sorted(100.0 * abs(row.speed) for row in good)
    if errors:
        lines.append(
            f"    speed of the next minute: off by {median(errors):.1f} %, {errors[-1]:.1f} % at most"
        )
    alarms = [row for row in good if row.named]
    lines.append(f"    named although nothing happened: {len(alarms)}")
    for fault, kind in FAULTS.items():
        found = [row for row in rows if row.fault == fault]
        right = sorted(row.after for row in found if NAMES[kind] in row.named.lower())
        other = [row for row in found if row.named and NAMES[kind] not in row.named.lower()]
        if found:
            when = f"{median(right):.1f} s (median), {right[-1]:.1f} s at most" if right else "-"
            lines.append(
                f"{fault:<22}{len(found):>4} runs, named right {len(right):>3}, otherwise {len(other):>3}; after {when}"
            )
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=0, help="good ones, from seed 1000 on")
    parser.add_argument("--faults", type=int, default=0, help="of each fault")
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = [("", 1000 + seed) for seed in range(options.runs)]
    jobs += [(fault, seed) for seed in range(options.faults) for fault in FAULTS]
    rows = gone_on(options.file, Row, jobs, run_one, options.workers)
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
