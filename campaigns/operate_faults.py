"""Does a robot always come to a safe stop, whatever goes wrong?

Question: an operation of 30 s in the virtual tank, with one to three random faults at random moments, of random length;
now and then also the operator's key, an emergency stop, a computer that sleeps, or a disk that is full. After each:
every module is limp within the stated time of the event, no exception came out of the operator, and the recording is
complete up to the end. The tank is stepped, so a seed always gives the same run.

    python campaigns/operate_faults.py              # 200 schedules
    python campaigns/operate_faults.py --runs 20 --seed 1000

The tests run a slice of it.

Last answer (2 shared cores, 2026-11-21; 812 s of CPU): 200 operations, 200 without complaint.
    fault               tried  survived  slowest stop [s]
    body_lost              29        29              2.04
    bus_off                23        23              2.00
    dead_module            22        22              2.08
    emergency_key          27        27              2.04
    frame_corruption       29        29              2.50
    frame_loss             26        26              2.00
    full_disk              25        25              2.04
    late_computer          24        24              2.50
    leak                   19        19              1.42
    meter_silent           28        28              2.00
    mocap_silent           29        29              2.08
    operator_key           28        28              2.02
    over_temperature       22        22              2.00
    sleeping_computer      20        20              1.50
    stuck_servo            27        27              2.50
"""

import argparse
import math
import random
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import laticauda as lc
from laticauda.control import Following
from laticauda.gaits import envelope_of
from laticauda.lab import Fault, LabSettings, Tank, VirtualRobot
from laticauda.operate import Event
from laticauda.operate.course.operator import Operator
from laticauda.operate.loop import TankDevices, run_loop
from laticauda.operate.recording.log import OperationRecorder, Sink, read_operation
from laticauda.operate.safety.transitions import BY_EVENT
from laticauda.operate.session import header_of
from laticauda.operate.settings import Calibration, CaptureVolume, Connection, Operation
from laticauda.protocol import NodeState

KINDS = (
    "frame_loss",
    "frame_corruption",
    "bus_off",
    "dead_module",
    "stuck_servo",
    "leak",
    "over_temperature",
    "body_lost",
    "mocap_silent",
    "meter_silent",
    "late_computer",
)
OURS = ("operator_key", "emergency_key", "sleeping_computer", "full_disk")
ON_ONE = KINDS[:7]
GAITS = {"lateral_undulation": 30.0, "eel_like": 40.0}
REACTION = 0.1  # modules hear of an event at the next tick, and their heartbeat comes ten times a second [s]


@dataclass
class Outcome:
    """What became of one schedule."""

    seed: int
    tried: list[str] = field(default_factory=list)
    seen: list[str] = field(default_factory=list)
    state: str = ""
    slowest: float = 0.0
    wrong: list[str] = field(default_factory=list)


class Computer(Tank):
    """The tank, and a computer that may sleep: then time goes on without it."""

    sleeps: tuple[float, float] | None = None
    limp_at: float | None = None

    def advance_to(self, when: float) -> None:
        super().advance_to(when)
        # A module without power is limp, whatever its memory held.
        moving = any(
            node.state in (NodeState.ACTIVE, NodeState.HOLD) and self.faults.on("dead_module", node.number) is None
            for node in self.nodes
        )
        self.limp_at = None if moving else self.limp_at if self.limp_at is not None else self.time


class FullDisk(Sink):
    """A recorder that cannot write from some time on."""

    def __init__(self, recorder: OperationRecorder, at: float) -> None:
        super().__init__(recorder)
        self._at = at

    def keep(self, now, found) -> None:
        if now >= self._at:
            self.trouble = "no space left on device"
        super().keep(now, found)


def operation(chance: random.Random, rate: float, duration: float) -> Operation:
    kind = chance.choice(list(GAITS))
    gait = lc.Gait(
        envelope=envelope_of(kind),
        amplitude=math.radians(GAITS[kind]),
        frequency=math.radians(90),
        phase_shift=math.radians(40),
    )
    return Operation(
        name="campaign",
        water="paper-eel" if kind == "eel_like" else "paper-lateral",
        gait=gait,
        following=Following(),
        duration=duration,
        rate=rate,
        countdown=0.5,
        connection=Connection(meter_port="stepped"),
        supply_voltage=35.0,
        tank=CaptureVolume(volume_x=(-1.0, 11.0)),
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5, patience=10.0),
    )


def schedule(chance: random.Random, duration: float) -> tuple[list[Fault], dict[str, float]]:
    """Faults of the tank, and what happens on our side, by time."""
    faults: list[Fault] = []
    ours: dict[str, float] = {}
    for _ in range(chance.randint(1, 3)):
        kind = chance.choice([*KINDS, *OURS])
        at = chance.uniform(0.0, 8.0 + duration)
        if kind in OURS:
            ours[kind] = at
            continue
        faults.append(
            Fault(
                kind=kind,
                time=at,
                duration=chance.choice([0.05, 0.5, 3.0, math.inf]),
                node=chance.randint(1, 8) if kind in ON_ONE and chance.random() < 0.8 else 0,
                share=chance.choice([0.05, 0.5, 1.0]),
                delay=chance.choice([0.02, 0.15, 0.6]),
            )
        )
    return faults, ours


def run_one(seed: int, folder: Path, *, rate: float = 50.0, duration: float = 30.0) -> Outcome:
    """One operation with the faults of a seed, and what is wrong with how it ended."""
    chance = random.Random(seed)
    what = operation(chance, rate, duration)
    faults, ours = schedule(chance, duration)
    outcome = Outcome(seed=seed, tried=sorted({*(fault.kind for fault in faults), *ours}))
    robot = what.body()
    start = lc.Start(center_of_mass=(0.0, chance.uniform(-1.5, 1.5)), heading=chance.uniform(-0.5, 0.5))
    world = VirtualRobot(robot, lc.plant(robot, what.pool(), joints="servo"), start)
    tank = Computer(world, LabSettings(seed=seed), faults)
    operator = Operator(operation=what)
    path = folder / f"{seed}.mcap"
    slept: list[bool] = []

    def keys(now: float) -> dict[str, str]:
        if "sleeping_computer" in ours and now >= ours["sleeping_computer"] and not slept:
            slept.append(True)
            tank.advance_to(now + 0.4)
        return {key: "campaign" for key in ("operator_key", "emergency_key") if now >= ours.get(key, math.inf)}

    try:
        with OperationRecorder(path, header_of(operator)) as recorder:
            sink = FullDisk(recorder, ours.get("full_disk", math.inf))
            last, _ = run_loop(operator, TankDevices(tank), keys=keys, sink=sink, longest=120.0)
    except Exception as error:
        outcome.wrong.append(f"an exception came out: {type(error).__name__}: {error}")
        return outcome
    outcome.state = last.supervisor.state
    _judge(outcome, operator, tank, path, ended=tank.time, full="full_disk" in ours)
    return outcome


def _judge(outcome: Outcome, operator: Operator, tank: Computer, path: Path, *, ended: float, full: bool) -> None:
    """Limp in time, and a log up to the end."""
    log = read_operation(path)
    events = [event for event in log.of(Event) if event.data.get("event") in BY_EVENT]
    outcome.seen = sorted({str(event.data["event"]) for event in events})
    for _ in range(100):
        tank.advance_to(tank.time + 0.02)
    if "program_error" in outcome.seen:
        outcome.wrong.append("the operator's program has an error")
    limp = tank.limp_at
    if limp is None:
        outcome.wrong.append("a module is not limp at the end")
        return
    stopping = [event for event in events if event.data["action"] != "finish" and event.data["before"] != "idle"]
    if stopping:
        action = str(stopping[0].data["action"])
        outcome.slowest = max(0.0, limp - stopping[0].time)
        if outcome.slowest > operator.supervisor.within(action) + REACTION:
            outcome.wrong.append(f"limp {outcome.slowest:.2f} s after {stopping[0].data['event']}")
    if outcome.state not in ("idle", "fault"):
        outcome.wrong.append(f"the supervisor is {outcome.state}")
    if log.lost:
        outcome.wrong.append(f"the log lost something: {log.lost}")
    last = log.entries[-1].time if log.entries else 0.0
    if not full and last < ended - 0.1:
        outcome.wrong.append(f"the log ends {ended - last:.2f} s before the end")


def table(outcomes: list[Outcome]) -> str:
    """How often each was tried and survived, and the slowest stop."""
    tried, survived, slowest = Counter[str](), Counter[str](), dict[str, float]()
    seen = Counter(event for outcome in outcomes for event in outcome.seen)
    for outcome in outcomes:
        for kind in outcome.tried:
            tried[kind] += 1
            survived[kind] += not outcome.wrong
            slowest[kind] = max(slowest.get(kind, 0.0), outcome.slowest)
    lines = [f"{'fault':<18}{'tried':>7}{'survived':>10}{'slowest stop [s]':>18}"]
    lines += [f"{kind:<18}{n:>7}{survived[kind]:>10}{slowest[kind]:>18.2f}" for kind, n in sorted(tried.items())]
    lines.append(f"events seen: {', '.join(f'{event} {n}' for event, n in sorted(seen.items()))}")
    states = Counter(outcome.state for outcome in outcomes)
    lines.append(f"{len(outcomes)} operations, {sum(not o.wrong for o in outcomes)} without complaint; {dict(states)}")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--rate", type=float, default=50.0)
    parser.add_argument("--duration", type=float, default=30.0)
    options = parser.parse_args()
    outcomes: list[Outcome] = []
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.seed, options.seed + options.runs):
            outcome = run_one(seed, Path(folder), rate=options.rate, duration=options.duration)
            outcomes.append(outcome)
            Path(folder, f"{seed}.mcap").unlink(missing_ok=True)
            for complaint in outcome.wrong:
                print(f"seed {seed} ({', '.join(outcome.tried)}): {complaint}", flush=True)
            if sys.stderr.isatty():
                print(f"\r{len(outcomes)} of {options.runs}", end="", file=sys.stderr)
    print(table(outcomes))
    print(f"{time.process_time() - began:.0f} s of CPU")
    return int(any(outcome.wrong for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
