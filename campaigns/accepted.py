"""Is an accepted run right? What is noticed of it when something is wrong with robot, cameras or water, and how often
is something seen that is not there?

Question: an operation of 40 s in the virtual tank, in which one thing goes wrong at a random moment
after the first cycle: a jammed joint, a weak one, a zero that slips by 5 deg, a lost fin, cameras
that take another body for the robot's or whose clock drifts, a marker body that turns by 5 deg,
water that begins to move. Which check of the verdict says so, and how long after? And of good runs,
of three gaits and robots, open loop and along a path, at 20, 50 and 100 Hz: how many are rejected,
and how near does each check come to its limit? The tank of good runs takes steps of 10 ms, so that
a joint may have ended its own before it is asked. It is stepped, so a seed always gives the same
run.

    python campaigns/accepted.py --runs 20           # of each fault
    python campaigns/accepted.py --hours 10          # of good runs; goes on where accepted.csv ends
    python campaigns/accepted.py                     # the table of what is in accepted.csv

The tests run a slice of it.
"""

import argparse
import math
import random
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from _rows import gone_on

import laticauda as lc
from laticauda.control import Following
from laticauda.motion.gaits import envelope_of
from laticauda.tank.lab import Fault, LabSettings, Tank, VirtualRobot
from laticauda.tank.lab.faults import ON_NODES
from laticauda.tank.operate.session import operate
from laticauda.tank.operate.settings import (
    Acceptance,
    Calibration,
    CaptureVolume,
    Connection,
    Operation,
)

FAULTS = {
    "jammed joint": ("stuck_servo", {}),
    "weak joint, half": ("weak_servo", {"share": 0.5}),
    "weak joint, a quarter": ("weak_servo", {"share": 0.25}),
    "slipped zero, 5 deg": ("slipped_zero", {"angle": math.radians(5.0)}),
    "slipped zero, 10 deg": ("slipped_zero", {"angle": math.radians(10.0)}),
    "lost fin": ("lost_fin", {}),
    "wrong body": ("wrong_body", {}),
    "drifting clock, 0.1 %": ("clock_drift", {"share": 1e-3}),
    "marker body turned, 5 deg": ("marker_slip", {"angle": math.radians(5.0)}),
    "moving water, 3 cm/s": ("moving_water", {"speed": 0.03}),
}
DURATION = 40.0  # of a run [s]
FILE = Path(__file__).with_suffix(".csv")


@dataclass
class Row:
    """One run."""

    fault: str
    seed: int
    what: str
    outcome: str  # accepted, rejected, stopped (by the supervisor, before the verdict)
    by: str  # the check that saw it first, or the reason
    after: float  # the fault [s]; nan: never
    shares: str  # of every check's limit


def operation(chance: random.Random, fault: str) -> Operation:
    """A good run: a gait, a robot, open loop or along a path."""
    kind = chance.choice(["lateral_undulation", "eel_like"])
    robot = "mamba-fin" if fault == "lost fin" else chance.choice(["mamba", "mamba", "mamba-fin"])
    gait = lc.Gait(
        envelope=envelope_of(kind),
        amplitude=math.radians(chance.choice([25, 30])),
        frequency=math.radians(chance.choice([70, 90, 110])),
        phase_shift=math.radians(40),
    )
    return Operation(
        name="campaign",
        robot=robot,
        water="paper-eel" if kind == "eel_like" else "paper-lateral",
        gait=gait,
        following=Following() if chance.random() < 0.5 else None,
        duration=DURATION,
        rate=50.0 if fault else chance.choice([20.0, 50.0, 100.0]),
        countdown=0.5,
        estimator="kinematics",
        tank=CaptureVolume(volume_x=(-3.0, 11.0)),
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=2.0, patience=10.0),
    )


def run_one(fault: str, seed: int) -> Row:
    """One operation, with a fault or good."""
    chance = random.Random(f"{fault} {seed}")
    what = operation(chance, fault)
    robot = what.body()
    plant = lc.build_plant(robot, what.pool(), joints="servo")
    start = lc.Start(
        center_of_mass=(0.0, chance.uniform(-0.3, 0.3)), heading=chance.uniform(-0.2, 0.2)
    )
    step = 0.02 if fault else 0.01  # of the tank [s]
    tank = Tank(VirtualRobot(robot, plant, start), LabSettings(seed=seed, step=step))
    begun: list[float] = []
    wait = chance.uniform(1.5, 3.0) * 2.0 * math.pi / what.gait.frequency
    node, towards = chance.randint(2, 6), chance.uniform(0.0, 2.0 * math.pi)

    def show(state, outputs) -> None:
        if state.begun is None or begun or not fault:
            return
        begun.append(state.begun)
        kind, of = FAULTS[fault]
        where = {"node": node} if kind in ON_NODES else {}
        tank.inject(Fault(kind=kind, time=state.begun + wait, towards=towards, **where, **of))

    with tempfile.TemporaryDirectory() as folder:
        done = operate(what, Path(folder), tank=tank, twin=plant, show=show, frames=False)
    words = (
        f"{what.robot} {what.gait.kind} {'path' if what.following else 'open'} {what.rate:.0f} Hz"
    )
    if done.verdict is None or (
        not done.accepted and not done.reason.startswith("The run failed a check")
    ):
        return Row(fault, seed, words, "stopped", done.reason, math.nan, "")
    word = "noted" if done.accepted else "WRONG"
    first = min(
        (one for one in done.verdict.checks if one.outcome == word),
        key=lambda one: one.since,
        default=None,
    )
    return Row(
        fault,
        seed,
        words,
        "accepted" if done.accepted else "rejected",
        first.name if first else "",
        round(first.since - wait, 2) if first else math.nan,
        " ".join(
            f"{one.name}={one.share:.2f}" for one in done.verdict.checks if one.share is not None
        ),
    )


def table(rows: list[Row]) -> str:
    """How many were noticed and when, how many good ones were not accepted, and the shares of limits they used."""
    lines = [
        f"{'fault':<28}{'runs':>6}{'rejected':>10}{'stopped':>9}{'noted':>7}{'after [s], median (most)':>27}  by"
    ]
    for fault in FAULTS:
        found = [row for row in rows if row.fault == fault]
        if not found:
            continue
        rejected, stopped = (
            [row for row in found if row.outcome == word] for word in ("rejected", "stopped")
        )
        noted = sum(row.outcome == "accepted" and bool(row.by) for row in found)
        after = sorted(row.after for row in rejected)
        times = f"{median(after):.0f} ({after[-1]:.0f})" if after else "-"
        names = sorted({row.by for row in rejected})
        lines.append(
            f"{fault:<28}{len(found):>6}{len(rejected):>10}{len(stopped):>9}{noted:>7}{times:>27}  {', '.join(names)}"
        )
    good = [row for row in rows if not row.fault]
    hours = len(good) * DURATION / 3600.0
    bad = [row for row in good if row.outcome != "accepted"]
    lines.append(f"good runs: {len(good)}, {hours:.2f} h; not accepted: {len(bad)}")
    lines += [f"    {row.what}, seed {row.seed}: {row.outcome} by {row.by}" for row in bad]
    for name in Acceptance.__dataclass_fields__:
        shares = [
            float(part.split("=")[1])
            for row in good
            for part in row.shares.split()
            if part.startswith(f"{name}=")
        ]
        if shares:
            lines.append(
                f"    {name:<18} at most {100 * max(shares):>4.0f} % of its limit, median {100 * median(shares):.0f} %"
            )
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=0, help="of each fault")
    parser.add_argument("--hours", type=float, default=0.0, help="of good runs")
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = [(fault, seed) for seed in range(options.runs) for fault in FAULTS]
    jobs += [("", seed) for seed in range(math.ceil(options.hours * 3600.0 / DURATION))]
    rows = gone_on(options.file, Row, jobs, run_one, options.workers)
    print(table(rows))
    return int(sum(not row.fault and row.outcome != "accepted" for row in rows) > 1)


if __name__ == "__main__":
    sys.exit(main())
