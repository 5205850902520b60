"""Trials that could be done next, and what each would say about the unknowns.

Besides swimming, with what sensors there are, a straight tow (the force that pulls the straight robot at a constant
speed) and a coast-down (the path of the straight robot that is let go with a speed).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, positive
from laticauda.gaits import Gait
from laticauda.identify.identifiability import marginal
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict, scaled_jacobian
from laticauda.identify.problem import Problem, other_measurements
from laticauda.identify.resolution import with_tied
from laticauda.identify.tables import setting_of
from laticauda.identify.unknowns import NUISANCE, ResolvedUnknown
from laticauda.interfaces import Start
from laticauda.quantities import quantity, value
from laticauda.robot import Environment, Robot, Water
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import changed
from laticauda.simulate.runner import Progress
from laticauda.trial.metrics import towing_drag

SENSORS: Mapping[str, tuple[str, str, float]] = {
    "speed": ("figure", "forward_velocity", 0.005),
    "power": ("figure", "mean_power", 2.0),
    "path": ("series", "center_of_mass", 0.005),
    "heading": ("series", "heading", 0.01),
    "joint-angle": ("series", "joint_angle", 0.01),
    "joint-torque": ("series", "joint_torque", 0.05),
}
"""By word: whether it gives a figure or a series, which one, and the standard deviation of its noise."""
FORCE_SIGMA = 0.05
"""Of a force that is measured in a tow [N]."""
FORCE_SHARE = 0.02
"""The same as a share of the force [-]."""
INTERVAL = 0.5
"""Between samples of a series that count [s]."""
_DIFFERENCE = 2.0**-12


@value
class Tow:
    """The force that pulls the straight robot along itself at a constant speed."""

    speed: float = quantity("m/s", "Through the water", gt=0.0)
    sigma: float = quantity("N", "Standard deviation of the noise of the force", default=FORCE_SIGMA, gt=0.0)
    share: float = quantity(
        "", "The same as a share of the force: speed, alignment and calibration", default=FORCE_SHARE, ge=0.0
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidate:
    """A trial that could be done."""

    name: str
    """What tables call it."""
    kind: str
    """swim, tow or coast-down."""
    measurement: Measurement
    """Robot, water and gait, and what would be measured; the numbers in it do not count."""
    tow: Tow | None = None
    """How it is towed; None: it is not."""


def swims(
    robot: Robot,
    gaits: Sequence[Gait],
    environment: Environment,
    sensors: Mapping[str, float],
    *,
    duration: float = 30.0,
    interval: float = INTERVAL,
) -> list[Candidate]:
    """A candidate per gait.

    Args:
        robot: What would swim.
        gaits: What it would be asked for.
        environment: Where.
        sensors: By name, of `SENSORS`: the standard deviation of the noise.
        duration: Of a trial [s].
        interval: Between the samples of series that count [s].
    """
    found: list[Candidate] = []
    for gait in gaits:
        scenario = Scenario(robot=robot, motion=gait, environment=environment, duration=duration)
        found.append(_candidate("swim", f"swim, {_words(robot, gait)}", scenario, sensors, interval))
    return found


def coast_down(
    robot: Robot, environment: Environment, speed: float, *, sigma: float = 0.005, duration: float = 5.0
) -> Candidate:
    """The straight robot let go with a speed, its center of mass tracked ten times a second.

    Args:
        robot: What coasts.
        environment: Where.
        speed: At the begin [m/s].
        sigma: Standard deviation of the noise of the path [m].
        duration: [s].
    """
    start = Start(velocity=positive("speed", speed, "m/s"))
    scenario = Scenario(robot=robot, motion=_STRAIGHT, environment=environment, start=start, duration=duration)
    return _candidate("coast-down", f"coast-down from {speed:g} m/s{_fin(robot)}", scenario, {"path": sigma}, 0.1)


def straight_tow(robot: Robot, environment: Environment, tow: Tow) -> Candidate:
    """The straight robot pulled at a constant speed, the force measured.

    Args:
        robot: What is pulled.
        environment: Where.
        tow: How.
    """
    name = f"straight tow at {tow.speed:g} m/s{_fin(robot)}"
    still = Scenario(robot=robot, motion=_STRAIGHT, environment=environment, duration=1.0)
    at_rest = Measurement(name=name, scenario=still, figures={"x": (0.0, 1.0)})
    return Candidate(name=name, kind="tow", measurement=at_rest, tow=tow)


def information_of(
    problem: Problem,
    candidates: Sequence[Candidate],
    values: Float[np.ndarray, " n_unknowns"],
    progress: Progress | None,
) -> Float[np.ndarray, "n_candidates n_unknowns n_unknowns"]:
    """What each candidate would say, as information to the coordinates of the unknowns.

    Args:
        problem: The unknowns.
        candidates: The trials.
        values: Of the unknowns.
        progress: Called with the share that is finished.

    Raises:
        ValueError: If a candidate cannot be simulated.
    """
    slope = problem.slopes(values)
    found = np.zeros((len(candidates), values.size, values.size))
    swimming = [i for i, one in enumerate(candidates) if one.kind == "swim"]
    for begin in range(0, len(swimming), _AT_ONCE):
        members = swimming[begin : begin + _AT_ONCE]
        part = other_measurements(problem, [candidates[i].measurement for i in members])
        predicted = predict(part, values, jacobian=True)
        assert predicted.jacobian is not None
        for name, status in predicted.failures.items():
            raise ValueError(f"`candidates` must be trials that can be simulated, got `{name}`: {status}")
        rows = predicted.jacobian / part.sigma[:, np.newaxis] * slope
        rows = np.where(np.isfinite(rows), rows, 0.0)
        for place, i in enumerate(members):
            mine = rows[part.owner == place]
            found[i] = mine.T @ mine
        if progress is not None:
            progress((begin + len(members)) / len(candidates))
    for i, one in enumerate(candidates):
        if one.kind == "coast-down":
            found[i] = _coasted(problem, one, values)
        elif one.tow is not None:
            force, slopes = _towed(problem, one, values)
            row = slopes / np.hypot(one.tow.sigma, one.tow.share * force) * slope
            found[i] = np.outer(row, row)
    if progress is not None:
        progress(1.0)
    return found


_AT_ONCE = 64
_STRAIGHT = Gait(amplitude=0.0, frequency=1.0, phase_shift=0.5)


def _coasted(problem: Problem, one: Candidate, values: np.ndarray) -> np.ndarray:
    """What a coast-down says where nobody knows exactly where and how fast it began: its path has to say that too."""
    part = other_measurements(problem, [one.measurement])
    unknown = [
        ResolvedUnknown(name=name, parameter=NUISANCE[name], start=0.0, is_log=False, size=0.1)
        for name in ("start.x", "start.velocity")
    ]
    moves = np.concatenate([part.moves, np.ones((1, len(unknown)), dtype=bool)], axis=1)
    part = replace(part, unknowns=(*part.unknowns, *unknown), moves=moves)
    every = np.concatenate([values, np.zeros(len(unknown))])
    rows = scaled_jacobian(part, every)
    return marginal(rows.T @ rows, range(values.size))


def _towed(problem: Problem, one: Candidate, values: np.ndarray) -> tuple[float, np.ndarray]:
    """The force, and its derivative to every unknown; of order two, of a smooth function in closed form."""
    part = other_measurements(problem, [one.measurement])
    assert one.tow is not None
    (scenario,) = part.scenarios_at(values)
    found = np.zeros(values.size)
    for k, unknown in enumerate(part.unknowns):
        name = unknown.parameter.name
        if not part.moves[0, k] or name in NUISANCE:
            continue
        step = _DIFFERENCE * (abs(float(values[k])) or unknown.size)
        ends = np.clip(values[k] + np.array([-step, step]), unknown.lower, unknown.upper)
        low, high = (
            _force(scenario, one.tow.speed, with_tied(scenario, name, float(end), unknown.tied)) for end in ends
        )
        found[k] = (high - low) / (ends[1] - ends[0])
    return _force(scenario, one.tow.speed, {}), found


def _force(scenario: Scenario, speed: float, values: Mapping[str, float]) -> float:
    swims = changed(scenario, values)
    if not isinstance(swims.environment, Water):
        raise BadArgument("candidates", "must be in water for a tow, got ground")
    tether = getattr(swims.robot.tether, "drag", 0.0) * speed**2
    return towing_drag(swims.robot, swims.environment, speed) + tether


def _candidate(kind: str, name: str, scenario: Scenario, sensors: Mapping[str, float], interval: float) -> Candidate:
    """A trial with figures and series whose numbers do not count."""
    robot, duration = scenario.robot, scenario.duration
    time = np.arange(1, round(duration / positive("interval", interval, "s")) + 1) * interval
    time = time[time <= duration * (1.0 + 1e-9)]
    figures: dict[str, tuple[float, float]] = {}
    series: dict[str, tuple[np.ndarray, float]] = {}
    shapes = {"center_of_mass": (time.size, 2), "heading": (time.size,)}
    for word, sigma in sensors.items():
        form, what, _ = SENSORS[word]
        if form == "figure":
            figures[what] = (0.0, sigma)
        else:
            series[what] = (np.zeros(shapes.get(what, (time.size, robot.n_links - 1))), sigma)
    measured: Any = {"figures": figures, "series": series, "time": time if series else None}
    return Candidate(name=name, kind=kind, measurement=Measurement(name=name, scenario=scenario, **measured))


def _words(robot: Robot, gait: Gait) -> str:
    return f"{gait.kind.replace('_', '-')} {setting_of(gait)} deg{_fin(robot)}"


def _fin(robot: Robot) -> str:
    return ", with fin" if robot.caudal_fin is not None else ""
