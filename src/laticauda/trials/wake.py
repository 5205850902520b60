"""The wake of the robot of a trial, as water in which another robot can swim.

The street of vortices is that of `laticauda.water.fluid.wake`. Its numbers are the leader's own: speed,
period, the way of its trailing edge from side to side, and the thrust that drives the same robot
straight through the water at that speed, over the height of its tail. From this thrust follows the
circulation of the vortices.
"""

import functools
import hashlib
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from laticauda.robot import Posture, Robot, Water
from laticauda.trials import cycles, metrics
from laticauda.trials.contents import Contents
from laticauda.trials.logs import load_trial
from laticauda.values import (
    BadArgument,
    TrialFileError,
    check_positive,
    option,
    quantity,
    value_class,
)
from laticauda.water.fluid import Flow, Wake, find_circulation

CORE_SHARE = 0.25
"""Core of a new vortex by half its distance from the next one of its row, or by the distance of the rows [-]."""
SMALLEST_ADVANCE = 1e-3
"""Advance per cycle below which a leader leaves no street [m]."""
SMALLEST_ADVANCE_SHARE = 0.1
"""The same, as a share of the way of its tail from side to side [-]."""
LARGEST_TURN = math.radians(20.0)
"""Turn of the leader during the life of its vortices beyond which its wake is not straight [rad]."""


class TailBeat(NamedTuple):
    """Straight motion of a trailing edge over ground, and its beat across, at the end of a run."""

    position: np.ndarray
    """Middle of its way from side to side, at the end of the run [m]."""
    velocity: np.ndarray
    """Velocity of that middle over ground [m/s]."""
    harmonic: np.ndarray
    """Beat A cos + B sin of the phase since the end of the run: A and B, each x and y [m]."""


def measure_wake(
    trial: Contents,
    *,
    thrust: float | None = None,
    span: float | None = None,
    core: float | None = None,
    viscosity: float = 1e-6,
    pairs: int = 8,
) -> Wake:
    """Return the wake that the robot of a trial leaves in its steady part; time 0 of the wake is the trial's end.

    Args:
        trial: Trial of a robot that swam straight in the plane, in still or uniform water.
        thrust: Mean thrust that the wake carries [N]; None: the drag of the straight robot at its speed.
        span: Height over which the vortices carry it [m]; None: the height of the fin, or of the tail link.
        core: Radius of a new vortex's core [m]; None: a quarter of the distance of the rows, or of half the
            spacing in a row if that is less.
        viscosity: Viscosity that widens the cores [m^2/s].
        pairs: Length of the street in pairs of vortices.

    Raises:
        ValueError: If the robot did not swim straight for two cycles in still or uniform water, or if no
            street of its width carries that thrust.
    """
    leader = _Leader.of(trial, pairs)
    period = leader.period
    beat = measure_tail_beat(trial, period)
    current = np.array(leader.water.uniform)
    through_water = beat.velocity - current[:2]
    forward_x, forward_y = through_water.tolist()
    speed = math.hypot(forward_x, forward_y)
    direction = math.atan2(forward_y, forward_x)
    to_the_left = np.array([-math.sin(direction), math.cos(direction)])
    cosine_part, sine_part = (beat.harmonic @ to_the_left).tolist()
    width = 2.0 * math.hypot(cosine_part, sine_part)
    advance = speed * period
    least_advance = max(SMALLEST_ADVANCE, SMALLEST_ADVANCE_SHARE * width)
    if advance < least_advance:
        rule = f"must advance for a wake: by {least_advance:.2g} m in a cycle"
        raise BadArgument("trial", f"{rule}, got {advance:.2g} m")

    flux = leader.momentum_flux(speed, thrust, span)
    if core is None:
        core = CORE_SHARE * min(width, 0.5 * speed * period)
    x, y = beat.position.tolist()
    return Wake(
        speed=speed,
        period=period,
        width=width,
        circulation=find_circulation(flux, speed, period, width),
        core=core,
        viscosity=viscosity,
        direction=direction,
        x=x,
        y=y,
        phase=math.atan2(cosine_part, sine_part),
        pairs=pairs,
        mean=leader.water.uniform,
    )


class _Leader(NamedTuple):
    """A robot that leaves a straight street of vortices."""

    robot: Robot
    """The robot, as it lies in the plane."""
    water: Water
    """Its water, still or uniform."""
    period: float
    """Period of its tail beat [s]."""

    @classmethod
    def of(cls, trial: Contents, pairs: int) -> "_Leader":
        """Return the robot of a trial; refuse one that turns while a street of so many pairs lives."""
        water = trial.environment
        if not isinstance(water, Water) or water.flow is not None:
            raise BadArgument(
                "environment", "must be still or uniform water for a wake, got another one"
            )
        trial.need("a wake", "link_angle")
        period = trial.period
        turning_rate = metrics.turning_rate(trial)
        assert period is not None  # it has a turning rate
        turn = abs(turning_rate) * pairs * period
        if turn > LARGEST_TURN:
            raise BadArgument(
                "trial",
                f"must be straight for a wake: within {math.degrees(LARGEST_TURN):.0f} deg "
                f"in {pairs} cycles, got {math.degrees(turn):.0f} deg",
            )
        return cls(robot=trial.chain, water=water, period=period)

    def momentum_flux(self, speed: float, thrust: float | None, span: float | None) -> float:
        """Return the flux of momentum that carries a thrust, per density and per span [m^3/s^2].

        Without a thrust, it is the straight robot's drag; without a span, the height of its tail.
        """
        if thrust is None:
            thrust = metrics.towing_drag(self.robot, self.water, speed)
        if span is None:
            span = tail_height(self.robot)
        check_positive("thrust", thrust, "N")
        check_positive("span", span, "m")
        return thrust / (self.water.density * span)


def measure_tail_beat(trial: Contents, period: float) -> TailBeat:
    """Return the motion of the trailing edge over the steady part, with its first harmonic.

    Args:
        trial: Trial whose body lies in the plane.
        period: Period of its gait [s].

    Raises:
        ValueError: If the run is too short for one cycle.
    """
    steady_part = cycles.steady_part(trial.time, period)
    is_steady = trial.time >= steady_part.start
    time = trial.time[is_steady] - trial.time[-1]
    posture = Posture(
        trial.chain,
        trial.center_of_mass[is_steady, :2],
        trial.link_angle[is_steady],
        fin_angle=trial.fin_angle[is_steady],
    )
    phase = 2.0 * math.pi * time / period
    constant = np.ones_like(time)
    first_wave = [np.cos(phase), np.sin(phase)]
    second_wave = [np.cos(2.0 * phase), np.sin(2.0 * phase)]
    terms = np.stack([constant, time, *first_wave, *second_wave], axis=1)
    coefficients, *_ = np.linalg.lstsq(terms, posture.trailing_edge, rcond=None)
    return TailBeat(position=coefficients[0], velocity=coefficients[1], harmonic=coefficients[2:4])


def tail_height(robot: Robot) -> float:
    """Return the height of a robot's fin, or without one that of its tail link [m].

    Args:
        robot: The robot.
    """
    if robot.caudal_fin is not None:
        return robot.caudal_fin.height
    return 2.0 * robot.modules[0].section.half_height


@value_class
class WakeOfTrial(Flow):
    """The wake of the robot of a trial that was saved to a file, and the uniform water in which it swam.

    Place and phase of its tail at the start are those at the end of the trial, unless stated.
    """

    source: str = option("A file of the trial (in a file, relative to its folder)")
    x: float | None = quantity(
        "m", "x of the tail's middle at the start; None: as in the trial", default=None
    )
    y: float | None = quantity("m", "y of the same", default=None)
    phase: float | None = quantity(
        "rad", "Phase of the tail at the start, as of `wake`; None: as in the trial", default=None
    )
    core: float | None = quantity(
        "m", "r_c of a new vortex; None: from the distances of the vortices", gt=0.0, default=None
    )
    viscosity: float = quantity("m^2/s", "nu that widens the cores", ge=0.0, default=1e-6)
    pairs: int = quantity("", "Length of the street in pairs of vortices", ge=2, le=200, default=8)
    digest: str = option("Digest of the file; filled in, and checked if given", default="")

    def __post_init__(self) -> None:
        """Make the path absolute, and compute the digest."""
        path = Path(self.source).resolve()
        object.__setattr__(self, "source", str(path))
        try:
            digest = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise TrialFileError(f"{path}: cannot be read: {reason}") from error
        if self.digest not in ("", digest):
            raise BadArgument(
                "digest", f"must match `{path}`, which has changed since, got {self.digest}"
            )
        object.__setattr__(self, "digest", digest)

    @functools.cached_property
    def wake(self) -> Wake:
        """The wake with all its numbers."""
        measured = _measure_file(
            self.source, self.digest, core=self.core, viscosity=self.viscosity, pairs=self.pairs
        )
        changes: dict[str, Any] = {}
        for name in ("x", "y", "phase"):
            value = getattr(self, name)
            if value is not None:
                changes[name] = value
        return replace(measured, **changes)

    @property
    def parts(self) -> tuple[Flow, ...]:
        """Parts of the wake."""
        return self.wake.parts

    @property
    def words(self) -> str:
        """Description of the flow."""
        return f"the wake of `{self.source}`"


@functools.lru_cache(maxsize=16)
def _measure_file(
    source: str, digest: str, *, core: float | None, viscosity: float, pairs: int
) -> Wake:
    """Return the wake of a trial in a file; `digest` tells one content of the file from another."""
    trial = load_trial(source)
    try:
        return measure_wake(trial, core=core, viscosity=viscosity, pairs=pairs)
    except ValueError as reason:
        raise TrialFileError(f"{source}: its robot left no wake: {reason}") from reason
