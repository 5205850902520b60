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

from _rows import go_on

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
    "jammed joint": {"kind": "stuck_servo"},
    "weak joint, half": {"kind": "weak_servo", "share": 0.5},
    "weak joint, a quarter": {"kind": "weak_servo", "share": 0.25},
    "slipped zero, 5 deg": {"kind": "slipped_zero", "angle": math.radians(5.0)},
    "slipped zero, 10 deg": {"kind": "slipped_zero", "angle": math.radians(10.0)},
    "lost fin": {"kind": "lost_fin"},
    "wrong body": {"kind": "wrong_body"},
    "drifting clock, 0.1 %": {"kind": "clock_drift", "share": 1e-3},
    "marker body turned, 5 deg": {"kind": "marker_slip", "angle": math.radians(5.0)},
    "moving water, 3 cm/s": {"kind": "moving_water", "speed": 0.03},
}
"""Arguments of the tank's faults, by their titles."""
DURATION = 40.0
"""Duration of a run [s]."""
FILE = Path(__file__).with_suffix(".csv")


@dataclass
class Row:
    """One run."""

    fault: str
    """Its title; "" for a good run."""
    seed: int
    what: str
    """Robot, gait, path and rate."""
    outcome: str
    """accepted, rejected, stopped (by the supervisor, before the verdict)."""
    by: str
    """The check that saw it first, or the reason."""
    after: float
    """When, after the fault; nan: never [s]."""
    shares: str
    """Share of every check's limit."""


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


class Injection:
    """Looks at every tick whether the run has begun, and then has the tank's fault come later."""

    def __init__(self, tank: Tank, fault: str, cycle: float, chance: random.Random) -> None:
        self.tank = tank
        self.fault = fault
        self.delay = chance.uniform(1.5, 3.0) * cycle
        """Time from the beginning to the fault [s]."""
        self.node = chance.randint(2, 6)
        self.towards = chance.uniform(0.0, 2.0 * math.pi)
        self.is_injected = False

    def __call__(self, state, outputs) -> None:
        if state.begun is None or self.is_injected or not self.fault:
            return
        self.is_injected = True
        arguments = dict(FAULTS[self.fault])
        if arguments["kind"] in ON_NODES:
            arguments["node"] = self.node
        time = state.begun + self.delay
        self.tank.inject(Fault(time=time, towards=self.towards, **arguments))


def run_one(fault: str, seed: int) -> Row:
    """One operation, with a fault or good."""
    chance = random.Random(f"{fault} {seed}")
    operated = operation(chance, fault)
    gait = operated.gait
    robot = operated.body()
    plant = lc.build_plant(robot, operated.pool(), joints="servo")
    start = lc.Start(
        center_of_mass=(0.0, chance.uniform(-0.3, 0.3)), heading=chance.uniform(-0.2, 0.2)
    )
    step = 0.02 if fault else 0.01  # of the tank [s]
    tank = Tank(VirtualRobot(robot, plant, start), LabSettings(seed=seed, step=step))
    injection = Injection(tank, fault, 2.0 * math.pi / gait.frequency, chance)
    with tempfile.TemporaryDirectory() as folder:
        result = operate(
            operated, Path(folder), tank=tank, twin=plant, show=injection, frames=False
        )
    path = "path" if operated.following else "open"
    what = f"{operated.robot} {gait.kind} {path} {operated.rate:.0f} Hz"
    is_judged = result.accepted or result.reason.startswith("The run failed a check")
    if result.verdict is None or not is_judged:
        return Row(fault, seed, what, "stopped", result.reason, math.nan, "")
    checks = result.verdict.checks
    outcome = "noted" if result.accepted else "WRONG"
    complaints = [check for check in checks if check.outcome == outcome]
    first_name = ""
    delay = math.nan
    if complaints:
        first = min(complaints, key=lambda check: check.since)
        first_name = first.name
        delay = round(first.since - injection.delay, 2)
    shares = [f"{check.name}={check.share:.2f}" for check in checks if check.share is not None]
    return Row(
        fault=fault,
        seed=seed,
        what=what,
        outcome="accepted" if result.accepted else "rejected",
        by=first_name,
        after=delay,
        shares=" ".join(shares),
    )


def table(rows: list[Row]) -> str:
    """How many were noticed and when, how many good ones were not accepted, and the shares of limits they used."""
    lines = [
        f"{'fault':<28}{'runs':>6}{'rejected':>10}{'stopped':>9}{'noted':>7}{'after [s], median (most)':>27}  by"
    ]
    for fault in FAULTS:
        rows_of_fault = [row for row in rows if row.fault == fault]
        if rows_of_fault:
            lines.append(line_of_fault(rows_of_fault))
    good = [row for row in rows if not row.fault]
    hours = len(good) * DURATION / 3600.0
    bad = [row for row in good if row.outcome != "accepted"]
    lines.append(f"good runs: {len(good)}, {hours:.2f} h; not accepted: {len(bad)}")
    lines += [f"    {row.what}, seed {row.seed}: {row.outcome} by {row.by}" for row in bad]
    shares_of_runs = [read_shares(row.shares) for row in good]
    for name in Acceptance.__dataclass_fields__:
        shares = [shares_of_run[name] for shares_of_run in shares_of_runs if name in shares_of_run]
        if shares:
            most, middle = 100 * max(shares), 100 * median(shares)
            lines.append(
                f"    {name:<18} at most {most:>4.0f} % of its limit, median {middle:.0f} %"
            )
    return "\n".join(lines)


def line_of_fault(rows: list[Row]) -> str:
    rejected = [row for row in rows if row.outcome == "rejected"]
    n_stopped = sum(row.outcome == "stopped" for row in rows)
    n_noted = sum(row.outcome == "accepted" and bool(row.by) for row in rows)
    delays = sorted(row.after for row in rejected)
    times = "-"
    if delays:
        times = f"{median(delays):.0f} ({delays[-1]:.0f})"
    names = ", ".join(sorted({row.by for row in rejected}))
    return (
        f"{rows[0].fault:<28}{len(rows):>6}{len(rejected):>10}{n_stopped:>9}{n_noted:>7}"
        f"{times:>27}  {names}"
    )


def read_shares(text: str) -> dict[str, float]:
    """Shares of the checks' limits by name, as in a row."""
    shares: dict[str, float] = {}
    for part in text.split():
        name, share = part.split("=")
        shares[name] = float(share)
    return shares


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=0, help="of each fault")
    parser.add_argument("--hours", type=float, default=0.0, help="of good runs")
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    jobs = [(fault, seed) for seed in range(options.runs) for fault in FAULTS]
    jobs += [("", seed) for seed in range(math.ceil(options.hours * 3600.0 / DURATION))]
    rows = go_on(options.file, Row, jobs, run_one, options.workers)
    print(table(rows))
    return int(sum(not row.fault and row.outcome != "accepted" for row in rows) > 1)


if __name__ == "__main__":
    sys.exit(main())
