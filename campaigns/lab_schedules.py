"""Is an operation ever unsafe, wrongly accepted, lost or stuck, whatever goes wrong, and however it coincides?

Tank, bus, cameras, meter, operator and disk run in one process on a virtual clock. A seed draws a
robot's operation and one to four mishaps of hardware, network, clocks, disk, computer and operator
at random moments; all that follows is the same, bit for bit, for the same seed and commit. Of every
schedule it is asked:

    unsafe      is every module limp in time after what stops the operation, and whenever the operation is idle?
    accepted    is a run accepted that was stopped, not recorded, long not seen, or whose way was another one?
    lost        is there an entry that was handed to the recorder, and is not in the file?
    hang        does it come to an end, and without an exception?

    python campaigns/lab_schedules.py                  # 2000 schedules, from where the last call ended
    python campaigns/lab_schedules.py --hours 1000     # until so much has been simulated in all
    python campaigns/lab_schedules.py --seed 17        # one, and what happened in it

A schedule at fault is cut down to the mishaps that it takes, and the line that repeats it is
printed. The tests run a slice. How far it went, and what it tried, is in lab_schedules.json.

Found and mended: when the cameras' clock steps back shortly before or in a run, or orders come
late, the way was off by up to 0.24 m (seeds 93, 96, 99, 100): such runs are rejected since there is
a verdict that asks how old poses are, too. In seeds 605 and 867 nothing went wrong, and the way was
off by 0.11 m: the filter took no angle of two joints whose servos had stalled and broke away, for
ten samples or 0.4 s; three are enough. In seed 895 corrupted answers of all modules put the robot
beyond the edge 0.28 s after the begin, and that run was accepted, as no cycle was whole to be
checked: jumps of angles count within a cycle too, and a run that comes to an edge needs a whole
cycle. In seed 2940 the cameras' clock stepped back by 0.3 s in the middle of a run of 3 s: the rest
of it was not seen, and the way was off by 0.14 m. A run whose end was not seen is rejected.

Not noticeable, and so not asked for: frames of the cameras that are all late by the same time, a
clock that drifts by less than 1 in 1000.
"""

import argparse
import hashlib
import json
import math
import multiprocessing
import random
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import laticauda as lc
from laticauda.control import Following
from laticauda.motion.gaits import envelope_of
from laticauda.tank import protocol
from laticauda.tank.lab import Fault, LabSettings, NodeSettings, Tank, VirtualRobot
from laticauda.tank.operate import Event
from laticauda.tank.operate.drivers import Frame
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import OperatorState, Outputs
from laticauda.tank.operate.recording.log import OperationLog, read_operation
from laticauda.tank.operate.recording.recorder import OperationRecorder, Sink
from laticauda.tank.operate.safety.supervisor import BY_EVENT
from laticauda.tank.operate.session import header_of, result_of
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
)
from laticauda.tank.operate.tank_devices import TankBus, TankCameras, TankDevices
from laticauda.tank.operate.verdict import verdict_of
from laticauda.values.errors import LaticaudaError

STORED = Path(__file__).with_suffix(".json")
AT_ONE = (
    "frame_loss",
    "frame_corruption",
    "bus_off",
    "dead_module",
    "stuck_servo",
    "leak",
    "over_temperature",
)
HARDWARE = (*AT_ONE, "body_lost", "mocap_silent", "meter_silent", "late_computer")
NETWORK = ("bus_late", "bus_doubled", "bus_lost", "bus_torn", "sent_doubled", "sent_lost")
CAMERAS = ("frames_late", "frames_doubled", "frames_lost", "meter_torn")
CLOCKS = ("clock_step", "clock_drift")
DISK = ("disk_full", "disk_slow", "disk_torn")
OURS = ("operator_key", "emergency_key", "sleeping_computer")
KINDS = (*HARDWARE, *NETWORK, *CAMERAS, *CLOCKS, *DISK, *OURS)
GAITS = {"lateral_undulation": 30.0, "eel_like": 40.0}
"""Kinds of gaits, and their amplitudes [deg]."""
RATE = 25.0
"""Rate of the loop [1/s]."""
STEP = 0.02
"""Step of the devices [s]."""
LONGEST = 150.0
"""Duration of an operation at most [s]."""
FRAMES = 5
"""Of so many recordings, one keeps the raw frames too, which are most of it."""
REACTION = 0.15
"""Modules hear of an event at the next tick, and their heartbeat comes ten times a second [s]."""
ASTRAY = 0.1
"""By how much the way of an accepted run may be off: noise, and frames late by up to 0.3 s [m]."""
SHORTEST = 0.05
"""Duration to which a mishap is cut down at least [s]."""


@dataclass(frozen=True, kw_only=True)
class Mishap:
    """One thing that goes wrong."""

    kind: str
    """One of `KINDS`."""
    time: float
    """When it begins [s]."""
    duration: float = math.inf
    """How long it lasts [s]."""
    node: int = 0
    """Where, if it is of a module; 0: at all."""
    share: float = 1.0
    """Of the frames; of the file that remains."""
    size: float = 0.1
    """By how much: lateness, step [s], drift [1]."""

    def is_on(self, now: float) -> bool:
        """Whether it is there."""
        return self.time <= now < self.time + self.duration


@dataclass(kw_only=True)
class Outcome:
    """What became of a schedule."""

    seed: int
    """Of everything random."""
    mishaps: tuple[Mishap, ...]
    """What went wrong."""
    wrong: list[str] = field(default_factory=list[str])
    """What must not have been: a class of faults, a colon, and what it was."""
    seen: tuple[str, ...] = ()
    """Events that the supervisor saw."""
    accepted: bool = False
    """Whether the run counts."""
    simulated: float = 0.0
    """[s]."""
    digest: str = ""
    """Of all that was sent, and of where the robot was."""

    @property
    def line(self) -> str:
        """The command that repeats it."""
        command = f"python campaigns/lab_schedules.py --seed {self.seed}"
        _, mishaps_of_seed = schedule(random.Random(self.seed))
        if self.mishaps == mishaps_of_seed:
            return command
        mishaps = json.dumps([asdict(mishap) for mishap in self.mishaps])
        return f"{command} --mishaps '{mishaps}'"

    @property
    def faults(self) -> set[str]:
        """Classes of what was wrong."""
        return {fault.split(":")[0] for fault in self.wrong}


def schedule(chance: random.Random) -> tuple[Operation, tuple[Mishap, ...]]:
    """An operation, and what goes wrong in it."""
    kind = chance.choice(list(GAITS))
    gait = lc.Gait(
        envelope=envelope_of(kind),
        amplitude=math.radians(GAITS[kind]),
        frequency=math.radians(chance.choice([90, 150])),
        phase_shift=math.radians(40),
    )
    operation = Operation(
        name="schedule",
        water="paper-eel" if kind == "eel_like" else "paper-lateral",
        gait=gait,
        following=chance.choice([None, Following()]),
        duration=chance.choice([3.0, 8.0]),
        rate=RATE,
        ramp=1.0,
        countdown=0.3,
        connection=Connection(meter_address="stepped"),
        supply_voltage=35.0,
        tank=CaptureVolume(volume_x=(-1.0, chance.choice([0.8, 11.0]))),
        calibration=Calibration(joint_zeros=True, idle_time=0.3, still_time=0.3, patience=8.0),
        limits=Limits(straighten_time=chance.choice([1.0, 2.0])),
    )
    end_of_run = 4.5 + operation.duration  # about then much happens at once
    n_mishaps = chance.randint(1, 4)
    mishaps = [_draw_mishap(chance, end_of_run) for _ in range(n_mishaps)]
    return operation, tuple(mishaps)


def _draw_mishap(chance: random.Random, end_of_run: float) -> Mishap:
    """A mishap at any time, before the run, or about its end."""
    time = chance.choice(
        [
            chance.uniform(0.0, end_of_run + 3.0),
            chance.uniform(2.5, 4.5),
            chance.gauss(end_of_run, 0.3),
        ]
    )
    return Mishap(
        kind=chance.choice(KINDS),
        time=round(max(time, 0.0), 3),
        duration=chance.choice([SHORTEST, 0.5, 3.0, 1e3]),
        node=chance.randint(1, 8) if chance.random() < 0.8 else 0,
        share=chance.choice([0.05, 0.5, 1.0]),
        size=chance.choice([0.02, 0.15, 0.3]),
    )


# ---- what can go wrong ---------------------------------------------------------------------------


class World:
    """The mishaps, and the chance that decides about single frames."""

    def __init__(self, mishaps: Sequence[Mishap], seed: int) -> None:
        self.mishaps = mishaps
        self.chance = random.Random(seed + 1)

    def mishap_on(self, kind: str, now: float) -> Mishap | None:
        """The first mishap of a kind that is there."""
        for mishap in self.mishaps:
            if mishap.kind == kind and mishap.is_on(now):
                return mishap
        return None

    def hits(self, kind: str, now: float) -> bool:
        """Whether a mishap hits a single frame."""
        mishap = self.mishap_on(kind, now)
        return mishap is not None and self.chance.random() < mishap.share

    def delay_of_frame(self, kind: str, now: float) -> float:
        """By how much a frame is late [s]."""
        mishap = self.mishap_on(kind, now)
        if mishap is None or self.chance.random() >= mishap.share:
            return 0.0
        return mishap.size * self.chance.random()


class Delivery(NamedTuple):
    """A frame on its way; those that are due first arrive first, then those that were sent first."""

    due: float
    """When it arrives [s]."""
    number: int
    """Of all that were sent."""
    frame: Any


class Queue:
    """Frames on their way, which arrive late, twice or never; late ones are overtaken."""

    def __init__(self, world: World, prefix: str) -> None:
        self.world = world
        self.prefix = prefix
        self.deliveries: list[Delivery] = []
        self.n_sent = 0

    def deliver(self, now: float, frames: Sequence[Any]) -> list[Any]:
        """Send frames, and return what arrives by now."""
        for frame in frames:
            n_copies = 2 if self.world.hits(f"{self.prefix}_doubled", now) else 1
            for _ in range(n_copies):
                self._send(now, frame)
        self.deliveries.sort(key=lambda delivery: (delivery.due, delivery.number))
        arrived = [delivery.frame for delivery in self.deliveries if delivery.due <= now]
        self.deliveries = [delivery for delivery in self.deliveries if delivery.due > now]
        return arrived

    def _send(self, now: float, frame: Any) -> None:
        if self.world.hits(f"{self.prefix}_lost", now):
            return
        self.n_sent += 1
        due = now + self.world.delay_of_frame(f"{self.prefix}_late", now)
        self.deliveries.append(Delivery(due, self.n_sent, frame))


class Bus(TankBus):
    """A bus that is late, doubles, loses and tears frames."""

    def __init__(self, tank: Tank, clock: Any, world: World) -> None:
        super().__init__(tank, clock)
        self.world = world
        self.queue = Queue(world, "bus")
        self.digest = hashlib.sha256()

    def receive(self) -> tuple[Frame, ...]:
        now = self._clock.now()
        arrived = self.queue.deliver(now, super().receive())
        return tuple(self._torn(frame._replace(time=now), now) for frame in arrived)

    def _torn(self, frame: Frame, now: float) -> Frame:
        if not self.world.hits("bus_torn", now):
            return frame
        data = frame.data[: self.world.chance.randrange(len(frame.data) + 1)]
        return frame._replace(data=data, message=protocol.decode(frame.identifier, data))

    def send(self, messages: tuple[protocol.CanMessage, ...]) -> tuple[Frame, ...]:
        now = self._clock.now()
        heard = [message for message in messages if not self.world.hits("sent_lost", now)]
        n_copies = 2 if self.world.hits("sent_doubled", now) else 1
        for _ in range(n_copies):
            super().send(tuple(heard))
        frames = tuple(
            Frame(now, *protocol.encode(message), is_ours=True, message=message)
            for message in messages
        )
        for frame in frames:
            self.digest.update(repr((frame.time, frame.identifier, frame.data)).encode())
        return frames


class Cameras(TankCameras):
    """Cameras whose frames are late, doubled and lost, by a clock that steps and drifts."""

    def __init__(self, tank: Tank, clock: Any, world: World) -> None:
        super().__init__(tank, clock)
        self.world = world
        self.queue = Queue(world, "frames")

    def receive(self) -> tuple[tuple[float, Any], ...]:
        now = self._clock.now()
        arrived = self.queue.deliver(now, super().receive())
        return tuple((now, replace(pose, time=self._time_shown(pose.time))) for _, pose in arrived)

    def _time_shown(self, time: float) -> float:
        """What the cameras' clock shows at a time [s]."""
        shown = time
        for mishap in self.world.mishaps:
            if shown < mishap.time:
                continue
            if mishap.kind == "clock_step":
                direction = 1.0 if mishap.node % 2 else -1.0
                shown += mishap.size * 10.0 * direction
            if mishap.kind == "clock_drift":
                shown += mishap.size * 1e-3 * (shown - mishap.time)
        return shown


class Water(Tank):
    """The tank, and since when all of its modules have been limp."""

    limp_at: float | None = 0.0
    world: World

    @property
    def moving(self) -> list[int]:
        """Modules that hold or move; one without power is limp, whatever its memory held."""
        moving: list[int] = []
        for node in self.nodes:
            is_dead = self.faults.on("dead_module", node.number) is not None
            if node.is_on and not is_dead:
                moving.append(node.number)
        return moving

    def advance_to(self, time: float) -> None:
        super().advance_to(time)
        if self.moving:
            self.limp_at = None
        elif self.limp_at is None:
            self.limp_at = self.time

    def answer(self, line: str) -> bytes:
        answer = super().answer(line)
        if self.world.hits("meter_torn", self.time):
            return answer[: len(answer) // 2]
        return answer


class Batch(NamedTuple):
    """Entries on their way to the disk."""

    due: float
    """When the disk takes them [s]."""
    time: float
    """When they were handed over [s]."""
    entries: Any


class Disk(Sink):
    """A disk that is full or slow; everything that was handed over is counted."""

    def __init__(self, recorder: OperationRecorder, world: World, *, frames: bool) -> None:
        super().__init__(recorder, frames=frames)
        self.world = world
        self.n_given = 0
        self.batches: list[Batch] = []

    def keep(self, now: float, entries: Any) -> None:
        if not self.trouble:
            self.n_given += sum(not isinstance(entry, Frame) for entry in entries)
        delay = 0.0
        slowness = self.world.mishap_on("disk_slow", now)
        if slowness is not None:
            delay = slowness.size * 10.0
        self.batches.append(Batch(now + delay, now, entries))
        while self.batches and self.batches[0].due <= now:
            self._store_batch()

    def _store_batch(self) -> None:
        batch = self.batches.pop(0)
        is_full = self.world.mishap_on("disk_full", batch.time) is not None
        if is_full and not self.trouble:
            self.trouble = "no space left on device"
        super().keep(batch.time, batch.entries)

    def flush(self) -> None:
        """Store the rest."""
        while self.batches:
            self._store_batch()


# ---- one schedule --------------------------------------------------------------------------------


def run(seed: int, mishaps: Sequence[Mishap] | None = None, folder: Path | None = None) -> Outcome:
    """One schedule: that of a seed, or the seed's operation with other mishaps.

    Args:
        seed: Of everything random.
        mishaps: None: those of the seed.
        folder: Where the recording goes; None: a temporary one.
    """
    if folder is None:
        with tempfile.TemporaryDirectory() as name:
            return run(seed, mishaps, Path(name))
    chance = random.Random(seed)
    operation, mishaps_of_seed = schedule(chance)
    if mishaps is None:
        mishaps = mishaps_of_seed
    world = World(tuple(mishaps), seed)
    outcome = Outcome(seed=seed, mishaps=tuple(world.mishaps))
    start = lc.Start(
        center_of_mass=(0.0, chance.uniform(-1.5, 1.5)), heading=chance.uniform(-0.5, 0.5)
    )
    tank = _tank_of(operation, world, start, seed)
    operator = Operator(operation=operation)
    path = folder / f"{seed}.mcap"
    devices = TankDevices(tank)
    bus = devices.bus = Bus(tank, devices.clock, world)
    devices.mocap = Cameras(tank, devices.clock, world)
    watch = Watch(operator, tank, outcome)
    try:
        with OperationRecorder(path, header_of(operator)) as recorder:
            disk = Disk(recorder, world, frames=seed % FRAMES == 0)
            last, _ = run_loop(
                operator, devices, keys=_keys(world, tank), sink=disk, show=watch, longest=LONGEST
            )
            disk.flush()
    except Exception as error:
        outcome.wrong.append(f"hang: {type(error).__name__}: {error}")
        return outcome
    outcome.simulated = tank.time
    log = read_operation(path)
    _judge_safety(outcome, operator, tank, last, log)
    _judge_record(outcome, disk, log, world)
    _judge_acceptance(outcome, operator, tank, last, log, world)
    truth = tank.truth
    end = (tank.time, truth.center_of_mass.tolist(), truth.joint_angle.tolist())
    bus.digest.update(repr(end).encode())
    outcome.digest = bus.digest.hexdigest()
    return outcome


def _tank_of(operation: Operation, world: World, start: lc.Start, seed: int) -> Water:
    """The tank with the operation's robot, and the mishaps that are faults of its hardware."""
    robot = operation.body()
    plant = lc.build_plant(robot, operation.pool(), joints="servo")
    nodes = NodeSettings(startup_time=0.2, calibration_time=0.2)
    settings = LabSettings(seed=seed, step=STEP, nodes=nodes)
    faults = [_fault(mishap) for mishap in world.mishaps if mishap.kind in HARDWARE]
    tank = Water(VirtualRobot(robot, plant, start), settings, faults)
    tank.world = world
    return tank


def _fault(mishap: Mishap) -> Fault:
    return Fault(
        kind=mishap.kind,
        time=mishap.time,
        duration=mishap.duration,
        node=mishap.node if mishap.kind in AT_ONE else 0,
        share=mishap.share,
        delay=2.0 * mishap.size,
    )


def _keys(world: World, tank: Tank) -> Callable[[float], Mapping[str, str]]:
    """Keys that are pressed; a computer that is to sleep does so when it is asked for them."""
    has_slept = set[Mishap]()

    def keys(now: float) -> dict[str, str]:
        for mishap in world.mishaps:
            is_sleep = mishap.kind == "sleeping_computer" and mishap not in has_slept
            if is_sleep and now >= mishap.time:
                has_slept.add(mishap)
                tank.advance_to(now + 4.0 * mishap.size)
        pressed: dict[str, str] = {}
        for kind in ("operator_key", "emergency_key"):
            if world.mishap_on(kind, now):
                pressed[kind] = "schedule"
        return pressed

    return keys


class Watch:
    """Looks at every tick whether a module moves that may not: what the operation says, and what is so."""

    def __init__(self, operator: Operator, tank: Water, outcome: Outcome) -> None:
        self.operator = operator
        self.tank = tank
        self.outcome = outcome

    def __call__(self, state: OperatorState, outputs: Outputs) -> None:
        """One tick."""
        supervisor = state.supervisor
        if supervisor.state not in ("idle", "fault"):
            return
        now = self.tank.time
        time_to_be_limp = self.operator.supervisor.within("limp")
        if now - supervisor.since <= time_to_be_limp or "unsafe" in self.outcome.faults:
            return
        if self.tank.moving:
            self.outcome.wrong.append(
                f"unsafe: module {self.tank.moving} moves at {now:.2f} s in {supervisor.state}"
            )


def _judge_safety(
    outcome: Outcome, operator: Operator, tank: Water, last: OperatorState, log: OperationLog
) -> None:
    """Limp within the stated time of the first event that stops it, and for good."""
    for _ in range(100):
        tank.advance_to(tank.time + 0.02)
    events = [event for event in log.of(Event) if event.data.get("event") in BY_EVENT]
    outcome.seen = tuple(sorted({str(event.data["event"]) for event in events}))
    errors = [event.message for event in events if event.data["event"] == "program_error"]
    if errors:
        outcome.wrong.append(f"hang: the operator's program has an error: {errors[0]}")
    if tank.limp_at is None:
        outcome.wrong.append("unsafe: a module is not limp at the end")
        return
    stops = [
        event
        for event in events
        if event.data["action"] != "finish" and event.data["before"] != "idle"
    ]
    if stops:
        first = stops[0]
        time_taken = tank.limp_at - first.time
        if time_taken > operator.supervisor.within(str(first.data["action"])) + REACTION:
            outcome.wrong.append(f"unsafe: limp {time_taken:.2f} s after {first.data['event']}")
    if last.supervisor.state not in ("idle", "fault"):
        outcome.wrong.append(f"unsafe: the supervisor is {last.supervisor.state} at the end")


def _judge_record(outcome: Outcome, disk: Disk, log: OperationLog, world: World) -> None:
    """All that was handed over is in the file, as far as the disk had room; of a torn file, what is before its end."""
    if log.lost:
        outcome.wrong.append(f"lost: {log.lost}")
    if len(log.entries) != disk.n_given and not disk.trouble:
        outcome.wrong.append(f"lost: {len(log.entries)} entries of {disk.n_given}")
    tears = [mishap for mishap in world.mishaps if mishap.kind == "disk_torn"]
    if not tears or not log.entries:
        return
    whole = log.path.read_bytes()
    size = int(len(whole) * tears[0].share * world.chance.random())
    torn_path = log.path.with_suffix(".torn.mcap")
    torn_path.write_bytes(whole[:size])
    try:
        torn_log = read_operation(torn_path)
    except LaticaudaError:
        return  # not even its header is there; that is said
    beginning = log.entries[: len(torn_log.entries)]
    if list(map(repr, torn_log.entries)) != list(map(repr, beginning)):
        outcome.wrong.append("lost: a torn file is not the beginning of the whole one")


def _judge_acceptance(
    outcome: Outcome,
    operator: Operator,
    tank: Water,
    last: OperatorState,
    log: OperationLog,
    world: World,
) -> None:
    """What is accepted ended by itself, is on disk, was seen, and went where the file says."""
    operation = operator.operation
    plant = lc.build_plant(operation.body(), operation.pool(), joints="servo")
    verdict = verdict_of(log, operation.acceptance, plant)
    result = result_of(operator, last, log.path, None, verdict)
    outcome.accepted = result.accepted
    if not result.accepted or last.begun is None or last.ended is None:
        return
    patience = {
        "operator_key": 0.0,
        "emergency_key": 0.0,
        "disk_full": 0.0,
        "body_lost": operation.limits.mocap_timeout,
        "mocap_silent": operation.limits.mocap_timeout,
    }
    for mishap in world.mishaps:
        begin = max(mishap.time, last.begun)
        end = min(mishap.time + mishap.duration, last.ended)
        inside = end - begin
        if inside > patience.get(mishap.kind, math.inf) + 2.0 / RATE:
            outcome.wrong.append(
                f"accepted: in spite of {mishap.kind} for {inside:.2f} s of the run"
            )
    trial = result.trial
    if trial is None:
        outcome.wrong.append("accepted: without a trial")
        return
    way = trial.center_of_mass[-1] - trial.center_of_mass[0]
    truth = tank.body.trial("")
    true_end = _position_at(truth, last.begun + trial.duration)
    true_way = true_end - _position_at(truth, last.begun)
    error = math.dist(way, true_way)
    if error > ASTRAY:
        outcome.wrong.append(f"accepted: its way is off by {error:.3f} m")


def _position_at(truth: lc.Trial, time: float) -> Any:
    sample = int(truth.time.searchsorted(time))
    return truth.center_of_mass[min(sample, truth.time.size - 1)]


def shrink(outcome: Outcome) -> Outcome:
    """The same fault by as few mishaps as it takes, each as short as it may be."""
    smaller = _smaller_at_fault(outcome)
    while smaller is not None:
        outcome = smaller
        smaller = _smaller_at_fault(outcome)
    return outcome


def _smaller_at_fault(outcome: Outcome) -> Outcome | None:
    """The first outcome of smaller mishaps that has one of the same faults."""
    for mishaps in _smaller_mishaps(outcome.mishaps):
        smaller = run(outcome.seed, mishaps)
        if smaller.faults & outcome.faults:
            return smaller
    return None


def _smaller_mishaps(mishaps: tuple[Mishap, ...]) -> Iterator[tuple[Mishap, ...]]:
    """All but one of the mishaps, or one of them shorter."""
    for k, mishap in enumerate(mishaps):
        before, after = mishaps[:k], mishaps[k + 1 :]
        yield (*before, *after)
        if mishap.duration > SHORTEST:
            duration = max(SHORTEST, min(mishap.duration, 10.0) / 4.0)
            yield (*before, replace(mishap, duration=duration), *after)


# ---- many ----------------------------------------------------------------------------------------


def stored() -> dict[str, Any]:
    """How far the campaign went."""
    if STORED.exists():
        return json.loads(STORED.read_text())
    return {
        "next_seed": 0,
        "schedules": 0,
        "hours": 0.0,
        "accepted": 0,
        "violations": 0,
        "tried": {},
        "seen": {},
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--schedules", type=int, default=2000)
    parser.add_argument(
        "--hours", type=float, help="of simulated time in all, in place of --schedules"
    )
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which it pauses")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, help="only this one")
    parser.add_argument("--mishaps", help="with other mishaps, JSON")
    options = parser.parse_args()
    if options.seed is not None:
        return run_one(options.seed, options.mishaps)
    return run_many(options)


def run_one(seed: int, mishaps: str | None) -> int:
    """Print what happens in the schedule of a seed, with other mishaps if they are given [JSON]."""
    other_mishaps = None
    if mishaps is not None:
        other_mishaps = [Mishap(**fields) for fields in json.loads(mishaps)]
    outcome = run(seed, other_mishaps)
    print(
        *outcome.mishaps,
        f"events {outcome.seen}, accepted {outcome.accepted}, digest {outcome.digest[:16]}",
        *outcome.wrong,
        sep="\n",
    )
    return bool(outcome.wrong)


def run_many(options: argparse.Namespace) -> int:
    """Go on where the last call ended, and store how far it went after every schedule."""
    totals = stored()
    pause_at = time.monotonic() + 60.0 * options.minutes
    n_schedules = options.schedules
    hours = math.inf
    if options.hours is not None:
        n_schedules = 10**9
        hours = options.hours or math.inf
    first = totals["next_seed"]
    is_any_wrong = False
    with multiprocessing.Pool(options.workers) as pool:
        for outcome in pool.imap(run, range(first, first + n_schedules)):
            _add_to_totals(totals, outcome)
            if outcome.wrong:
                is_any_wrong = True
                _print_fault(outcome)
            STORED.write_text(json.dumps(totals, indent=1, sort_keys=True) + "\n")
            if time.monotonic() > pause_at or totals["hours"] >= hours:
                pool.terminate()
                break
    print({name: total for name, total in totals.items() if name not in ("tried", "seen")})
    return is_any_wrong


def _print_fault(outcome: Outcome) -> None:
    least = shrink(outcome)
    print(f"seed {outcome.seed}: {'; '.join(outcome.wrong)}")
    print(f"    {least.line}\n    {'; '.join(least.wrong)}", flush=True)


def _add_to_totals(totals: dict[str, Any], outcome: Outcome) -> None:
    totals["next_seed"] = outcome.seed + 1
    totals["schedules"] += 1
    totals["hours"] = round(totals["hours"] + outcome.simulated / 3600.0, 5)
    totals["accepted"] += outcome.accepted
    totals["violations"] += bool(outcome.wrong)
    for mishap_kind in {mishap.kind for mishap in outcome.mishaps}:
        totals["tried"][mishap_kind] = totals["tried"].get(mishap_kind, 0) + 1
    for event in set(outcome.seen):
        totals["seen"][event] = totals["seen"].get(event, 0) + 1


if __name__ == "__main__":
    sys.exit(main())
