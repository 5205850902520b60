"""Does torque ever return to a robot that went limp, whatever happens to the program and its cable?

Question: the operator's program is stopped for 0.3 to 15 s, or the bus is cut and plugged in again,
or a module restarts, or the twin takes seconds for one step: at a random moment of a run, from the
first moment at which motors are on. Is a motor ever switched on that has been limp since? Is the
recording complete, is there a verdict, and does `replay` show it?

    python campaigns/torque_returns.py            # 20 freezes, 10 cables; writes torque_returns.csv
    python campaigns/torque_returns.py --stepped 200   # in the stepped tank, without wires; nothing is written

The first runs are of real processes on a real bus (UDP multicast): `laticauda lab`, `laticauda
operate`, and a monitor on the bus that counts orders to switch on and follows the heartbeats of all
modules. A freeze is a SIGSTOP of the program; the bus is cut at the modules. Half of the runs have
limits that notice nothing (`PATIENT`), so that only the supervisor's own rule is left. In the
stepped tank the states of the modules are known, and the same seed gives the same run. The tests
run a slice of it.

Found and mended: after a freeze of 15 s the verdict was missing. What had come in that time did not
fit into the pipe to the process that writes the recording, and its end waited for a next tick.

And a run whose cable was out from its first second on was accepted (seed 29): its verdict looks at
whole cycles up to the last answer, and there were none. Now a silence of half a second rejects it;
seeds 24 to 30 were tried anew with that.

Last answer (2 shared cores, busy with other work, 2026-11-29): 20 freezes and 10 cables, torque
returned 0 times, 0 orders to switch on after a motor had gone off, every recording complete, a
verdict on each of the 27 runs that began. `replay` ended each time with the sentence of a run that
failed, which has no figures any more; this campaign had still asked for them. Seeds 29 and 30 were
tried again after that was mended, and are right in every column.
"""

import argparse
import csv
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import laticauda as lc
from laticauda.control import Following
from laticauda.tank.lab import Fault, LabSettings, NodeSettings, Tank, VirtualRobot
from laticauda.tank.operate import Event, read_operation
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import Inputs, OperatorState, Outputs
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
)
from laticauda.tank.operate.tank_devices import TankBus, TankDevices, TankTime
from laticauda.tank.protocol import (
    Heartbeat,
    NodeCommand,
    Order,
    bus_address,
    from_frame,
    open_bus,
)

STORED = Path(__file__).with_suffix(".csv")
PATIENT = {
    "max_lateness": 60.0,
    "joint_timeout": 60.0,
    "heartbeat_timeout": 60.0,
    "mocap_timeout": 60.0,
}
"""Limits that notice neither a freeze nor a cable."""
DURATION = 6.0
"""Duration of a run [s]."""
LAST_MOMENT = 8.0
"""Latest moment of a mishap, since motors were first on [s]: the robot is stopping by then."""
KINDS = ("freeze", "cable", "restart", "late twin")


@dataclass(frozen=True, kw_only=True)
class Mishap:
    """What happens in one run."""

    kind: str
    """One of `KINDS`."""
    moment: float
    """When it happens, since motors were first on, or the run began [s]."""
    duration: float
    """How long it lasts [s]."""
    is_patient: bool
    """Whether the limits notice nothing."""
    node: int = 0
    """Module that restarts; 0: none."""
    is_whole: bool = False
    """Whether its whole process group is stopped; the process that writes the recording never is."""
    is_of_run: bool = False
    """Whether the moment counts from the beginning of the run; real processes only."""


def drawn(seed: int, kinds: tuple[str, ...] = KINDS) -> Mishap:
    """The mishap of a seed."""
    chance = random.Random(seed)
    kind = chance.choice(kinds)
    return Mishap(
        kind=kind,
        moment=round(
            chance.choice([chance.uniform(0.0, LAST_MOMENT), chance.uniform(0.0, 1.0)]), 2
        ),
        duration=round(chance.choice([chance.uniform(0.3, 3.0), chance.uniform(0.3, 15.0)]), 2),
        is_patient=chance.random() < 0.5,
        node=chance.randint(1, 8) if kind == "restart" else 0,
        is_whole=chance.random() < 0.5,
        is_of_run=chance.random() < 0.75,
    )


@dataclass(kw_only=True)
class Monitor:
    """Who watches the bus: orders to switch on, and the motors of all modules."""

    first_on: float | None = None
    """When the first motor was on [s]."""
    n_orders: int = 0
    """Orders to switch on [-]."""
    n_orders_after_limp: int = 0
    """Orders to switch on after a motor had gone off [-]."""
    on: set[int] = field(default_factory=set[int])
    """Modules whose motors are on."""
    limp: set[int] = field(default_factory=set[int])
    """Modules whose motors were on, and went off."""
    returned: list[tuple[float, int]] = field(default_factory=list[tuple[float, int]])
    """When motors came on that had gone off [s], and whose."""

    def order(self) -> None:
        """Note an order to switch on."""
        self.n_orders += 1
        self.n_orders_after_limp += bool(self.limp)

    def module(self, now: float, node: int, *, is_on: bool) -> None:
        """Note the state of a module."""
        if is_on and node not in self.on:
            if self.first_on is None:
                self.first_on = now
            if node in self.limp:
                self.returned.append((now, node))
            self.on.add(node)
        if not is_on and node in self.on:
            self.on.discard(node)
            self.limp.add(node)


# ---- in the stepped tank -------------------------------------------------------------------------


class MonitoredBus(TankBus):
    """The bus of a stepped tank, with a monitor on it."""

    monitor: Monitor

    def send(self, messages: Any) -> Any:
        for message in messages:
            if message == NodeCommand(order=Order.ENABLE):
                self.monitor.order()
        return super().send(messages)


class MonitoredTank(Tank):
    """A tank whose modules are watched at every moment."""

    monitor: Monitor

    def advance_to(self, time: float) -> None:
        while self.time < time - 1e-9:
            super().advance_to(min(time, self.time + 0.02))
            for node in self.nodes:
                has_power = self.faults.on("dead_module", node.number) is None
                self.monitor.module(self.time, node.number, is_on=node.is_on and has_power)


class Freezing(TankTime):
    """A clock that stands still for the program, once: the tank goes on without it."""

    at = float("inf")
    duration = 0.0

    def wait_until(self, moment: float) -> None:
        super().wait_until(moment)
        if moment >= self.at:
            self.at = float("inf")
            super().wait_until(moment + self.duration)


@dataclass(frozen=True, kw_only=True, eq=False)
class Slow(Operator):
    """An operator of which one tick takes long: what it decided is sent late."""

    clock: TankTime
    mishap: Mishap
    due: list[float] = field(default_factory=list[float])

    def tick(
        self, state: OperatorState, now: float, inputs: Inputs
    ) -> tuple[OperatorState, Outputs]:
        result = super().tick(state, now, inputs)
        if self.due and now >= self.due[0]:
            self.due.clear()
            self.clock.wait_until(now + self.mishap.duration)
        return result


def operation(mishap: Mishap) -> Operation:
    """The operation of a run in the stepped tank."""
    limits = Limits(straighten_time=1.0)
    gait = lc.lateral_undulation(amplitude=0.35, frequency=1.6, phase_shift=0.7)
    return Operation(
        name="torque",
        gait=gait,
        following=Following(),
        duration=DURATION,
        rate=25.0,
        estimator="kinematics",
        countdown=0.3,
        tank=CaptureVolume(volume_x=(-1.0, 11.0)),
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(joint_zeros=True, idle_time=0.3, still_time=0.3),
        limits=replace(limits, **PATIENT) if mishap.is_patient else limits,
    )


def stepped(mishap: Mishap) -> tuple[Monitor, OperatorState, list[Event]]:
    """Run an operation with a mishap in the stepped tank, and return what the monitor saw."""
    how = operation(mishap)
    body = VirtualRobot(how.body(), lc.build_plant(how.body(), how.pool(), joints="servo"))
    settings = LabSettings(
        seed=1, step=0.02, nodes=NodeSettings(startup_time=0.2, calibration_time=0.2)
    )
    tank, monitor, events = MonitoredTank(body, settings), Monitor(), list[Event]()
    tank.monitor = monitor
    clock = Freezing(tank)
    devices = TankDevices(tank, clock=clock)
    bus = MonitoredBus(tank, clock)
    bus.monitor, devices.bus = monitor, bus
    operator = Slow(operation=how, clock=clock, mishap=mishap)

    def show(state: OperatorState, outputs: Outputs) -> None:
        events.extend(outputs.events)
        if any(event.message == "off -> enable" for event in outputs.events):
            _arrange(mishap, tank, clock, operator)

    state, _ = run_loop(operator, devices, show=show, longest=120.0)
    tank.advance_to(tank.time + 3.0)
    return monitor, state, events


def _arrange(mishap: Mishap, tank: Tank, clock: Freezing, operator: Slow) -> None:
    """Have the mishap happen."""
    at = tank.time + mishap.moment
    if mishap.kind == "freeze":
        clock.at, clock.duration = at, mishap.duration
    elif mishap.kind == "cable":
        tank.inject(Fault(kind="bus_off", time=at, duration=mishap.duration))
    elif mishap.kind == "restart":
        tank.inject(Fault(kind="dead_module", time=at, duration=mishap.duration, node=mishap.node))
    else:
        operator.due.append(at)


# ---- real processes ------------------------------------------------------------------------------

PROGRAM = (sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())")
TRIAL = """
kind = "trial"
name = "run"
robot = "mamba"
duration = {duration}
rate = 25
countdown = 0.2
supply_voltage = 35.0
estimator = "kinematics"
gait = {{amplitude_deg = 20, frequency_deg_s = 90, phase_shift_deg = 40}}
following = {{look_ahead_distance = 0.18}}
tank = {{volume_x = [-1, 11]}}
calibration = {{joint_zeros = true, idle_time = 1.0, still_time = 0.3}}
limits = {{straighten_time = 1.5, {limits}}}
"""
TRIES = 3
"""Times that a run is begun in which motors do not come on."""
STARTUP = 3.0
"""Time in which the modules start up [s]."""
USUAL = {"max_lateness": 0.5, "joint_timeout": 1.5, "heartbeat_timeout": 1.5, "mocap_timeout": 3.0}
"""Limits of the other runs; the computer is busy with other runs."""
COLUMNS = (
    "seed",
    "kind",
    "since",
    "moment",
    "duration",
    "limits",
    "orders",
    "went_limp",
    "orders_after_limp",
    "returned",
    "status",
    "recording",
    "verdict",
    "replay",
    "reason",
)


@dataclass(kw_only=True)
class Row:
    """What became of a run of real processes."""

    seed: int
    mishap: Mishap
    monitor: Monitor
    status: int
    """Exit status of `operate`."""
    recording: str
    """"complete", or what is wrong with it."""
    verdict: str
    """"there", "missing", or "no run": it was frozen before its run began."""
    replay: str
    """"shows it", or what it says."""
    reason: str
    """Reason that the run gives."""

    @property
    def is_right(self) -> bool:
        """Whether it is as it should be."""
        monitor = self.monitor
        is_safe = not monitor.returned and not monitor.n_orders_after_limp and not monitor.on
        is_told = self.recording == "complete" and self.replay == "shows it"
        return is_safe and is_told and self.verdict != "missing" and monitor.first_on is not None

    def columns(self) -> tuple[object, ...]:
        """The row of the table."""
        mishap, monitor = self.mishap, self.monitor
        return (
            self.seed,
            mishap.kind,
            "run" if mishap.is_of_run else "torque",
            mishap.moment,
            mishap.duration,
            "patient" if mishap.is_patient else "usual",
            monitor.n_orders,
            len(monitor.limp),
            monitor.n_orders_after_limp,
            len(monitor.returned),
            self.status,
            self.recording,
            self.verdict,
            self.replay,
            self.reason,
        )


@contextmanager
def watching(address: str, monitor: Monitor) -> Iterator[None]:
    """Watch a bus in a thread."""
    is_over = threading.Event()

    def watch() -> None:
        with open_bus(bus_address(address)) as bus:
            while not is_over.is_set():
                frame = bus.recv(0.1)
                message = None if frame is None else from_frame(frame)
                if isinstance(message, Heartbeat):
                    monitor.module(time.monotonic(), message.node, is_on=message.state.is_on)
                elif message == NodeCommand(order=Order.ENABLE):
                    monitor.order()

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def wired(seed: int, kind: str, *, tell: Callable[[str], None] = print) -> Row:
    """Run `operate` on a virtual tank over real wires, with the mishap of a seed."""
    mishap = drawn(seed, (kind,))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        limits = PATIENT if mishap.is_patient else USUAL
        text = ", ".join(f"{key} = {value}" for key, value in limits.items())
        (folder / "trial.toml").write_text(TRIAL.format(duration=DURATION, limits=text))
        address = f"udp_multicast:239.74.164.{1 + seed % 250}:{44100 + seed % 250}"
        monitor = Monitor()
        lab = subprocess.Popen(
            [*PROGRAM, "lab", "--json", "--robot", "mamba", "--bus", address, "--port", "0"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        operator = None
        try:
            assert lab.stdout is not None
            where = json.loads(lab.stdout.readline())
            time.sleep(STARTUP)
            with watching(address, monitor):
                words = ["operate", str(folder / "trial.toml"), "--json", "--output", str(folder)]
                words += ["--bus", address, "--mocap", where["qtm"], "--meter", where["meter"]]
                operator = subprocess.Popen(
                    [*PROGRAM, *words],
                    stdout=subprocess.PIPE,
                    stderr=(folder / "errors.txt").open("w"),
                    text=True,
                    start_new_session=True,
                )
                over = _happens(mishap, monitor, operator, lab, folder / "errors.txt")
                said = operator.communicate(timeout=120.0)[0]
                # Until modules are heard again, and are limp by themselves if they were not yet.
                time.sleep(max(0.0, over - time.monotonic()) + 2.0)
        finally:
            for process in (operator, lab):
                if process is not None:
                    process.kill()
                    process.wait(10)
        row = _judged(seed, mishap, monitor, operator.returncode, said, folder)
        tell(f"{'right' if row.is_right else 'WRONG'}: {row.columns()}")
        if not row.is_right:
            tell((folder / "errors.txt").read_text()[-2000:])
        return row


def tried(seed: int, kind: str) -> Row:
    """Run with the mishap of a seed; anew if a busy computer did not come as far as to switch motors on."""
    for _ in range(TRIES - 1):
        row = wired(seed, kind)
        if row.monitor.first_on is not None:
            return row
    return wired(seed, kind)


def _happens(
    mishap: Mishap,
    monitor: Monitor,
    operator: "subprocess.Popen[str]",
    lab: "subprocess.Popen[str]",
    told: Path,
) -> float:
    """Wait until the moment has come, have the mishap happen, and return when it is over [s]."""
    patience = time.monotonic() + 90.0

    def has_begun() -> bool:
        if mishap.is_of_run:
            return "the run begins" in told.read_text()
        return monitor.first_on is not None

    while not has_begun():
        if operator.poll() is not None or time.monotonic() > patience:
            return time.monotonic()
        time.sleep(0.01)
    time.sleep(mishap.moment)
    over = time.monotonic() + mishap.duration
    if operator.poll() is not None:
        return time.monotonic()
    if mishap.kind == "cable":
        assert lab.stdin is not None
        lab.stdin.write(f"bus_off duration={mishap.duration}\n")
        lab.stdin.flush()
        return over
    stop = partial(os.killpg if mishap.is_whole else os.kill, operator.pid)
    stop(signal.SIGSTOP)
    time.sleep(mishap.duration)
    stop(signal.SIGCONT)
    return over


def _judged(
    seed: int, mishap: Mishap, monitor: Monitor, status: int, said: str, folder: Path
) -> Row:
    """Look at what a run left."""
    facts: dict[str, Any] = json.loads(said) if said.strip() else {}
    return Row(
        seed=seed,
        mishap=mishap,
        monitor=monitor,
        status=status,
        recording=_recording(folder / "run.mcap"),
        verdict=_verdict(facts, folder / "run.mcap"),
        replay=_replay(folder / "run.mcap"),
        reason=str(facts.get("reason", "")),
    )


def _recording(path: Path) -> str:
    """What a recording is: "complete", or what is wrong with it."""
    try:
        log = read_operation(path)
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    events: list[Event] = log.of(Event)
    if log.lost:
        return log.lost
    if not any(event.message.endswith("-> done") for event in events):
        return "it has no end"
    if not any(event.kind == "torque" and "-> enable" in event.message for event in events):
        return "switching on is not in it"
    return "complete"


def _verdict(facts: dict[str, Any], path: Path) -> str:
    """Whether there is a verdict on the run: "there", "missing", or "no run"."""
    if facts.get("verdict"):
        return "there"
    events: list[Event] = read_operation(path).of(Event)
    return "missing" if any(event.kind == "start" for event in events) else "no run"


def _replay(path: Path) -> str:
    """What `replay` makes of a recording: "shows it", or its last words."""
    done = subprocess.run(
        [*PROGRAM, "replay", str(path)], capture_output=True, text=True, check=False
    )
    has_figures = done.returncode == 0 and "forward velocity" in done.stdout
    has_status = done.returncode == 1 and "FAILED" in done.stdout
    if has_figures or has_status:
        return "shows it"
    return f"{done.returncode}: {done.stderr.strip()[-200:]}"


def stored() -> list[dict[str, str]]:
    """The last answer."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--stepped", type=int, default=0, help="runs in the stepped tank instead")
    parser.add_argument("--freezes", type=int, default=20)
    parser.add_argument("--cables", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1, help="the first one")
    parser.add_argument("--workers", type=int, default=2, help="runs at a time")
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + options.stepped)
    if options.stepped:
        wrong = 0
        for seed in seeds:
            monitor, state, _ = stepped(drawn(seed))
            is_wrong = bool(monitor.returned or monitor.n_orders_after_limp or monitor.on)
            wrong += is_wrong
            cause = state.supervisor.cause
            print(
                f"{seed} {drawn(seed)} {'WRONG' if is_wrong else 'right'} {cause} {monitor.returned}"
            )
        print(f"{options.stepped} runs, {wrong} wrong")
        return int(wrong > 0)
    kinds = ["freeze"] * options.freezes + ["cable"] * options.cables
    with ThreadPoolExecutor(options.workers) as workers:
        numbers = range(options.seed, options.seed + len(kinds))
        rows = list(workers.map(tried, numbers, kinds))
    with STORED.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        table.writerows(row.columns() for row in rows)
    right = sum(row.is_right for row in rows)
    returned = sum(len(row.monitor.returned) for row in rows)
    orders = sum(row.monitor.n_orders_after_limp for row in rows)
    print(
        f"{right} of {len(rows)} right; torque returned {returned} times, {orders} orders after limp"
    )
    return int(right < len(rows))


if __name__ == "__main__":
    sys.exit(main())
