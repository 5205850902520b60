"""Verdict on a run that reached its end: the checks, how close each came to its limit, and since when it exceeded it.

The yardstick is a simulation of the same robot with servos in its joints, driven by the references
that were sent. A joint may therefore lie anywhere between its reference and the angle that its
servo reaches under the water's load. A speed that differs from the model's is only noted, because
the model may be wrong. A speed that *changes* while the model's does not shows that something
happened to robot, cameras or water, and rejects the run. For details, see docs/theory/verdict.md.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda import gaits
from laticauda.dynamics.plant import Plant
from laticauda.estimation import Estimate, JointSample, Mount, PoseSample, ReferenceSample
from laticauda.interfaces import Command, Start
from laticauda.logs.loading import interpolated
from laticauda.operate.recording.entries import Event
from laticauda.operate.recording.log import OperationLog
from laticauda.operate.settings import Acceptance
from laticauda.quantities import quantities_of, texts_of

STILL = gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0)
CYCLE, POINTS = (
    2.0,
    100,
)  # cycle of a gait without a frequency [s]; points at which a cycle is evaluated
FRAMES, GAP = (
    7,
    0.3,
)  # camera frames in a running median, as single ones may be wrong; longest gap between them [s]
LATE = 0.032  # typical time by which answers are late when a computer pauses [s]
TURNS, LEAST = (
    5,
    1e-3,
)  # cycles over which turning is averaged; least advance per cycle, if a gait hardly moves [m]
STEERS = (
    0.9,
    1.1,
)  # share of the model's turning by which a robot may turn when it bends, at least and at most [-]
BEFORE, LATENCY = (
    2.0,
    0.01,
)  # time before the run, robot straight; change allowed in the frames' smallest latency [s]
NOTED = ("model_speed", "without_zero")
"""Checks that never reject a run."""
Array: TypeAlias = NDArray[np.float64]
Found: TypeAlias = tuple[Any, Array, str]
"""Times at which a check's values were known [s], the values, and where the worst is."""
NOTHING: Found = (), np.empty(0), ""


class Check(NamedTuple):
    """Result of one check."""

    name: str
    """Name of the field of `Acceptance` that holds its limit."""
    value: float | None
    """Worst value; None: it could not be checked."""
    limit: float
    """Limit beyond which it is wrong."""
    share: float | None
    """Share of the limit that was used [-]."""
    since: float | None
    """Time at which it was first known to exceed its limit [s since the run began]; None: never."""
    word: str
    """Outcome: `ok`, `WRONG`, `noted` or `not checked`."""
    says: str
    """Description of the result."""


@dataclass(frozen=True)
class Verdict:
    """All checks of one run."""

    checks: tuple[Check, ...]
    """Checks, one for each limit."""
    is_cut: bool = False
    """Whether the run ended at an edge before one cycle was complete, so that nothing confirms the run or the edge."""

    @property
    def reason(self) -> str:
        """First fault found, as a sentence; "" if the run is accepted."""
        wrong = [check.says for check in self.checks if check.word == "WRONG"]
        wrong += (
            ["it reached an edge before a cycle was complete, so nothing confirms it"]
            if self.is_cut
            else []
        )
        return f"The run failed a check: {wrong[0]}." if wrong else ""

    def summary(self) -> dict[str, Any]:
        """Return the verdict in a form ready for JSON and for a recording."""
        lines = [f"{check.word:<11} {check.says}" for check in self.checks]
        return {
            "accepted": not self.reason,
            "checks": [check._asdict() for check in self.checks],
            "lines": lines,
        }


def verdict_of(log: OperationLog, limits: Acceptance, plant: Plant[Any] | None = None) -> Verdict:
    """Check a recorded run.

    Args:
        log: The recording.
        limits: Limits of what is accepted.
        plant: The same robot in its water with servos in its joints. If it is None, or for an
            operation in depth, what needs it is not checked, and of a joint only its mean and its
            swing, which may be off by half.
    """
    run = _Run(log, plant)
    found, events = dict(run.checked()), [one.data.get("event") for one in log.of(Event)]
    checks = (
        _check(limits, name, run.begin, *found.get(name, NOTHING))
        for name in quantities_of(Acceptance)
    )
    return Verdict(tuple(checks), is_cut="edge" in events and not run.ends.size)


def _check(
    limits: Acceptance, name: str, begin: float, times: Any, values: Array, where: str
) -> Check:
    """Compare some values with their limit."""
    limit, says = float(getattr(limits, name)), texts_of(Acceptance)[name]
    if not np.isfinite(values).any():
        return Check(name, None, limit, None, None, "not checked", says)
    worst, beyond, unit = (
        float(np.nanmax(values)),
        np.flatnonzero(values > limit),
        quantities_of(Acceptance)[name].unit,
    )
    scale, unit = (math.degrees(1.0), "deg") if unit == "rad" else (1.0, unit)
    since = float(times[beyond[0]]) - begin if beyond.size else None
    says += (
        f": {scale * worst:.3g} of {scale * limit:.3g} {unit}".rstrip()
        + f" ({100.0 * worst / limit:.0f} %)"
    )
    says += ("" if since is None else f", since {since:.1f} s") + (f"; {where}" if where else "")
    word = "ok" if since is None else "noted" if name in NOTED else "WRONG"
    return Check(name, worst, limit, worst / limit, since, word, says)


def spoken(log: OperationLog, plant: Callable[..., Plant[Any]]) -> Mapping[str, Any]:
    """Return the summary of the verdict that a recording holds; if it holds none, judge it by the default limits.

    Args:
        log: The recording.
        plant: `laticauda.build_plant`, which builds the robot to compare with.
    """
    found, run = [one.data for one in log.of(Event) if one.kind == "verdict"], log.header.run
    if found:
        return found[0]
    return verdict_of(
        log, Acceptance(), plant(run.robot, run.environment, joints="servo")
    ).summary()


class _Run:
    """The run of a recording, cycle by cycle, and the same run by the model."""

    def __init__(self, log: OperationLog, plant: Plant[Any] | None) -> None:
        self.log, self.begin = log, log.span[0]
        robot = log.header.run.robot
        self.mount: Mount = getattr(log.header.estimator, "mount", Mount())
        self.link = self.mount.on_link(robot)[0]
        self.estimates: list[Estimate] = log.of_run(Estimate)
        self.samples: list[JointSample] = log.of_run(JointSample)
        self.references: list[ReferenceSample] = log.of_run(ReferenceSample)
        self.seen = sorted(
            (one for one in log.of(PoseSample) if one.rotation is not None),
            key=lambda one: one.time,
        )
        frequency = max((one.frequency or 0.0 for one in self.references), default=0.0)
        cycle = 2.0 * math.pi / frequency if frequency else CYCLE
        last = (
            self.samples[-1].time
            if self.estimates and self.references and self.samples
            else self.begin
        )
        n = int((last - self.begin) / cycle + 1e-6) if math.isfinite(self.begin) else 0
        self.ends = (self.begin if n else 0.0) + cycle * np.arange(1, n + 1)
        self.grid = self.ends[:, np.newaxis] - cycle + cycle * np.linspace(0.0, 1.0, POINTS)
        yaw = [i for i, joint in enumerate(robot.joints) if joint.axis == "yaw"]
        self.driven = [*yaw, *range(robot.n_joints, len(robot.driven_joints))]
        in_plane = n > 0 and len(self.references) > 1 and self.estimates[0].center_of_mass.size == 2
        fits = plant is not None and len(plant.robot.driven_joints) == len(self.driven)
        self.model: tuple[Array, ...] = (
            self._modelled(plant) if plant is not None and fits and in_plane else ()
        )

    def checked(self) -> Iterator[tuple[str, Found]]:
        """Yield the values of all checks that can be made."""
        yield from self._before()
        if len(self.samples) > 1 and all(one.rate is not None for one in self.samples):
            yield from self._jumps()
        if self.ends.size:
            yield from self._joints()
        if self.model and self.ends.size > 1 and len(self.seen) > 2 * FRAMES:
            yield from self._motion()

    def _columns(self, name: str) -> Array:
        return np.array([getattr(one, name) for one in self.samples], dtype=float)

    def _at(self, when: Any, values: Any) -> Array:
        """Interpolate measured values linearly to the points of all cycles: by cycle, point and column."""
        return interpolated(
            self.grid, np.array(when), np.array(values, dtype=float).reshape(len(when), -1)
        )

    def _modelled(self, plant: Plant[Any]) -> tuple[Array, ...]:
        """Return the model's time, joint angles, place, heading, and angle of the markers' link; () if it fails."""
        first, ticks = self.estimates[0], [one.time for one in self.references]
        x, y = first.center_of_mass.tolist()
        state = plant.init(Start(center_of_mass=(x, y), heading=first.heading), Command(gait=STILL))
        rows: list[tuple[Any, ...]] = []
        for sent, then in zip(self.references[:-1], ticks[1:], strict=True):
            angle = sent.angle[self.driven].tolist()
            command = Command(gait=STILL, references=tuple(angle), enabled=(True,) * len(angle))
            state, found, failure = plant.march(state, command, then - sent.time, then - sent.time)
            if failure is not None:
                return ()
            joints = np.append(
                found.joint_angle[-1], found.signals.get("fin_angle_0", np.empty((1, 0)))[-1]
            )
            rows.append(
                (
                    joints,
                    found.center_of_mass[-1, :2],
                    found.heading[-1],
                    found.link_angle[-1, self.link],
                )
            )
        return np.array(ticks[1:]), *(np.array(one) for one in zip(*rows, strict=True))

    def _before(self) -> Iterator[tuple[str, Found]]:
        """Yield the age of poses, the modules' zeros, the straight robot's drift and that of the cameras' clock."""
        if self.estimates:
            # The end of a run counts by itself, because it decides its way.
            ages = [
                np.median([one.age for one in some])
                for some in (self.estimates, self.estimates[-FRAMES:])
            ]
            yield "pose_age", (2 * [self.estimates[-1].time], np.array(ages), "")
        events: list[Event] = self.log.of(Event)
        unset = [
            float(one.data.get("without_zero", 0)) for one in events if one.kind == "calibrating"
        ]
        yield "without_zero", ([self.begin], np.array(unset[-1:]), "")
        # Setting joint zeros moves the estimate.
        since = max(
            [self.begin - BEFORE, *(one.time + GAP for one in events if one.kind == "calibrating")]
        )
        still = [
            one
            for one in self.log.of(Estimate)
            if since <= one.time <= self.begin and one.age < GAP
        ]
        if len(still) > 1 and still[-1].time - still[0].time > 0.5 * BEFORE:
            place = _typical([one.center_of_mass[:2] for one in still])
            drift = np.polyfit([one.time - self.begin for one in still], place, 1)[0]
            yield "water_speed", ([self.begin], np.array([math.hypot(*drift)]), "")
        clocks = [
            (one.time, one.data["clock"]) for one in events if "clock" in one.data
        ]  # start and stop
        if len(clocks) == 2:
            (begin, before), (end, after) = clocks
            drift = max(abs(after - before) - LATENCY, 0.0) / max(end - begin, 1.0)
            yield "clock_drift", ([end], np.array([drift]), "")

    def _joints(self) -> Iterator[tuple[str, Found]]:
        """Yield how far every joint is, over every cycle, from the segment between reference and servo."""
        ticks = self._columns("time")
        measured = self._at(ticks, self._columns("angle"))[..., self.driven]
        held = np.searchsorted([one.time for one in self.references], self.grid, side="right") - 1
        asked = np.array([one.angle for one in self.references])[:, self.driven][
            np.maximum(held, 0)
        ]
        error, swing = measured - asked, asked.std(axis=1)
        if self.model:
            lag = self._at(self.model[0], self.model[1]) - asked
            share = np.sum(error * lag, axis=1) / np.maximum(np.sum(lag * lag, axis=1), 1e-12)
            off = np.sqrt(
                np.mean((error - np.clip(share, 0.0, 1.0)[:, np.newaxis] * lag) ** 2, axis=1)
            )
        else:  # the lag of the servo is unknown: check only how far and about what it swings
            off = np.maximum(
                np.abs(error.mean(axis=1)), np.abs(measured.std(axis=1) - swing) - 0.5 * swing
            )
            off[0] = 0.0  # the run began at rest
        yield (
            "joint_error",
            (
                self.ends,
                off.max(axis=1),
                f"module {self.driven[int(off.max(axis=0).argmax())] + 1}",
            ),
        )

    def _jumps(self) -> Iterator[tuple[str, Found]]:
        """Yield the jumps of every joint's angle that its rate does not explain; within a cycle, too."""
        ticks = self._columns("time")
        angle, rate = (
            np.nan_to_num(interpolated(ticks, ticks, self._columns(one)))
            for one in ("angle", "rate")
        )
        step = np.diff(ticks)[:, np.newaxis]
        around = 2 * round(LATE / max(float(np.median(step)), 1e-6)) + 1  # answers
        if not 1 < around < 0.5 * len(ticks):
            return
        moved = np.where(step < GAP, np.diff(angle, axis=0), 0.0).T
        # A rate is that of a moment. How much of a step it explains depends on the load and on how
        # often it is asked.
        told = np.where(step < GAP, step * np.stack((rate[1:], rate[:-1])), 0.0).T
        left = moved - (told @ (np.linalg.pinv(told) @ moved[..., np.newaxis]))[..., 0]
        times, jump = _jump(ticks[1:], np.cumsum(left, axis=1).T, math.inf, around)
        yield (
            "angle_jump",
            (times, jump.max(axis=1), f"module {int(jump.max(axis=0).argmax()) + 1}"),
        )

    def _motion(self) -> Iterator[tuple[str, Found]]:
        """Yield what the cameras see compared with the model: markers, and changes of speed, sideslip and turning."""
        ticks = [one.time for one in self.estimates]
        time = np.array([one.time for one in self.seen])
        yaw = np.unwrap([self.mount.link_yaw(one.rotation) for one in self.seen])
        bend = [one.heading - one.link_angle[self.link] for one in self.estimates]
        off = np.asarray(
            yaw + np.interp(time, ticks, bend) - np.interp(time, self.model[0], self.model[3]),
            float,
        )
        off[(time < self.begin) | (time > self.model[0][-1])] = np.nan
        yield "marker_jump", (*_jump(time, off, GAP), "")

        heading = self._at(ticks, _typical(np.unwrap([one.heading for one in self.estimates])))[
            ..., 0
        ]
        center = self._at(ticks, _typical([one.center_of_mass for one in self.estimates]))
        model_center, model_heading, swing = (
            self._at(self.model[0], one) for one in self.model[2:]
        )
        off, whole = (_size(one[..., 0]) for one in (self._at(time, _typical(yaw)) - swing, swing))
        yield "swing_error", (self.ends, off / np.maximum(whole, math.radians(1.0)), "")
        (ahead, aside), (usual_ahead, usual_aside) = (
            _step(center, heading),
            _step(model_center, model_heading[..., 0]),
        )
        usual = float(np.median(usual_ahead))
        usual = math.copysign(max(abs(usual), LEAST), usual)  # negative if it swims backward
        speed = ahead / usual / np.maximum(usual_ahead / usual, 0.2)
        yield "speed_change", (self.ends[1:], _spread(speed), "")
        yield (
            "sideslip_change",
            (self.ends[2:], _spread((aside - usual_aside)[1:] / usual), ""),
        )  # first: from rest
        yield (
            "model_speed",
            (self.ends[-1:], np.array([abs(math.log(max(float(np.median(speed)), 1e-3)))]), ""),
        )
        turned, usual_turn = (np.diff(one.mean(axis=1)) for one in (heading, model_heading[..., 0]))
        turned -= usual_turn * np.clip(
            turned @ usual_turn / max(usual_turn @ usual_turn, 1e-12), *STEERS
        )
        if turned.size >= TURNS:
            mean = np.lib.stride_tricks.sliding_window_view(turned, TURNS).mean(axis=1)
            yield "turn_change", (self.ends[TURNS:], _spread(mean), "")


def _typical(values: Any, n: int = FRAMES) -> Array:
    """Return running medians of n rows, so that single wrong frames do not count."""
    rows = np.asarray(values, float)
    around = np.concatenate((rows[: n // 2], rows, rows[-(n // 2) :]))
    return np.median(np.lib.stride_tricks.sliding_window_view(around, n, axis=0), axis=-1)


def _jump(time: Array, values: Array, longest: float, n: int = FRAMES) -> tuple[Array, Array]:
    """Return when running medians of n rows jump, and by how much, if what is compared spans less than `longest`."""
    middle = _typical(values, n)[n // 2 : -(n // 2)]
    last, lasts = time[2 * n - 1 :], time[2 * n - 1 :] - time[: 1 - 2 * n]
    return last, np.where(lasts < longest, np.abs(middle[n:] - middle[:-n]).T, np.nan).T


def _size(values: Array) -> Array:
    """Return the root mean square of every cycle, after removing its mean and slope."""
    place = np.linspace(-1.0, 1.0, values.shape[1])
    line = np.polynomial.polynomial.polyval(
        place, np.polynomial.polynomial.polyfit(place, values.T, 1)
    )
    return np.sqrt(np.mean((values - line) ** 2, axis=1))


def _step(center: Array, heading: Array) -> tuple[Array, Array]:
    """Return the way from each cycle's mean place to the next's, along their mean heading and to the left of it [m]."""
    place, toward = center.mean(axis=1) @ np.array([1.0, 1.0j]), heading.mean(axis=1)
    gone = np.diff(place) * np.exp(-0.5j * (toward[1:] + toward[:-1]))
    return gone.real, gone.imag


def _spread(values: Array) -> Array:
    """Return the range of a series up to each moment."""
    return np.maximum.accumulate(values) - np.minimum.accumulate(values)
