"""Can one parameter set explain the paper's tank trials, both gaits, with and without the fin?

Question: many models, at most four fitted numbers each, are fitted to the speeds of Table 1. Which holds when a group
is left out, and what does it say of Table 2, which nothing was fitted to or chosen by? What was decided beforehand,
and the last answer, are in `identify_paper.md`.

    python campaigns/identify_paper.py                  # all candidates, some ten minutes of one core
    python campaigns/identify_paper.py --only geared    # those whose name holds a word; none is chosen
    python campaigns/identify_paper.py --table-1        # without Table 2
    python campaigns/identify_paper.py --output FILE    # keep what came out as JSON, for --fitted FILE next time
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

import laticauda as lc
from laticauda.control import StraightLine
from laticauda.fluid.laws import PolynomialDrag
from laticauda.gaits import Gait
from laticauda.interfaces import Start
from laticauda.paper.measured import efficiency_trials, path_following_trials
from laticauda.paper.path_following import figures_of
from laticauda.paper.settings import path_following_settings
from laticauda.robot import Robot, Water
from laticauda.simulate import plant, run
from laticauda.simulate.numbers import changed
from laticauda.trial import Trial
from laticauda.trial.null_models import NULL_MODELS, Row, fit, group_name, left_out, mape, predict

Values = Mapping[str, float]

ROWS = tuple(row for row in efficiency_trials() if row.forward_velocity is not None)
MEASURED = np.array([row.forward_velocity for row in ROWS])
GROUP_NAMES = tuple(dict.fromkeys(group_name(row.gait.kind, row.has_fin) for row in ROWS))
GROUP = np.array([GROUP_NAMES.index(group_name(row.gait.kind, row.has_fin)) for row in ROWS])
FOLLOWED = path_following_trials()
FOLLOWED_SPEED = np.array([row.forward_velocity for row in FOLLOWED])
FOLLOWED_GROUP = np.array([GROUP_NAMES.index(group_name(row.gait.kind, row.has_fin)) for row in FOLLOWED])
BANDWIDTHS = (10.0, 4.0)  # of the steering filter; the first is the one that counts [rad/s]

WATER = Water(name="identified", tangential_friction=0.15, normal_drag=1.75, added_mass=1.5)
FIN = {"tangential_friction": 0.005, "normal_drag": 2.0, "added_mass": 1.0}
SERVO_POWER = 2.9 * 7.5  # stall torque x no-load speed of the published servo; a gear keeps it [W]

RANGES: dict[str, tuple[float, float]] = {
    "water.tangential_friction": (0.03, 0.5),
    "water.drag.reference_speed": (0.05, 1.0),
    "water.added_mass": (0.8, 2.0),
    "water.drag.sway_friction": (0.02, 5.0),
    "water.friction_taper": (-0.9, 0.9),
    "robot.joint.actuator.tracking": (0.3, 1.2),
    "speed_limit": (0.2, 7.5),
    "geared.no_load_speed": (0.2, 7.5),
    "robot.joint.actuator.no_load_speed": (0.2, 7.5),
    "robot.joint.actuator.servo_gain": (1.0, 30.0),
    "pd.proportional_gain": (2.0, 300.0),
    "robot.joint.damping": (0.05, 30.0),
    "robot.joint.stiffness": (0.05, 30.0),
    "robot.caudal_fin.flexural_rigidity": (0.01, 30.0),
}
SIGNED = ("water.friction_taper",)  # not fitted as a logarithm
SHORT = {
    "water.tangential_friction": "C_f",
    "water.drag.reference_speed": "U_ref",
    "water.added_mass": "C_A",
    "water.drag.sway_friction": "sway",
    "water.friction_taper": "taper",
    "robot.joint.actuator.tracking": "tracking",
    "speed_limit": "limit",
    "geared.no_load_speed": "no-load",
    "robot.joint.actuator.no_load_speed": "no-load",
    "robot.joint.actuator.servo_gain": "gain",
    "pd.proportional_gain": "k_p",
    "robot.joint.damping": "d_skin",
    "robot.joint.stiffness": "k_skin",
    "robot.caudal_fin.flexural_rigidity": "EI",
}
C_F, U_REF, LIMIT, GEARED = (
    "water.tangential_friction",
    "water.drag.reference_speed",
    "speed_limit",
    "geared.no_load_speed",
)
GAIN, EI, SWAY = "robot.joint.actuator.servo_gain", "robot.caudal_fin.flexural_rigidity", "water.drag.sway_friction"
DAMPING, STIFFNESS = "robot.joint.damping", "robot.joint.stiffness"


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A model with some numbers left open."""

    name: str
    joints: str
    start: Values
    """The fitted numbers, and where their search begins."""
    water: Mapping[str, Any] = field(default_factory=dict)
    """What differs from `WATER`."""
    fin: Mapping[str, Any] = field(default_factory=dict)
    """What differs from `FIN`."""
    actuator: Values = field(default_factory=dict)
    n_links: int = 9
    is_motor: bool = False
    """Whether the drive has a motor in it."""
    is_limit: bool = False
    """Whether no motor can be like that."""

    def model(self, values: Values) -> "Model":
        """The model with these numbers."""
        plain = {name: value for name, value in values.items() if name.split(".")[0] in ("water", "robot")}
        actuator = dict(self.actuator)
        if GEARED in values:
            actuator |= {"no_load_speed": values[GEARED], "stall_torque": SERVO_POWER / values[GEARED]}
        if "pd.proportional_gain" in values:
            gain = values["pd.proportional_gain"]
            actuator |= {"proportional_gain": gain, "derivative_gain": gain / 4.0}
        plain |= {f"robot.joint.actuator.{name}": value for name, value in actuator.items()}
        bendable = {"n_hinges": 2, "flexural_rigidity": 1.0} if EI in values else {}
        robots: dict[bool, Robot] = {}
        water = replace(WATER, **self.water)
        for has_fin in (False, True):
            robot = lc.load_robot("mamba-fin" if has_fin else "mamba").with_links(self.n_links)
            if robot.caudal_fin is not None:
                robot = replace(robot, caudal_fin=replace(robot.caudal_fin, **{**FIN, **self.fin, **bendable}))
            own = plain if has_fin else {name: value for name, value in plain.items() if "caudal_fin" not in name}
            other = changed(lc.Scenario(robot=robot, motion=ROWS[0].gait, environment=water), own)
            robots[has_fin], changed_water = other.robot, other.environment
        return Model(robots=robots, water=changed_water, joints=self.joints, limit=values.get(LIMIT))


@dataclass(frozen=True, kw_only=True)
class Model:
    """A candidate with numbers: what swims, where, and how it is driven."""

    robots: Mapping[bool, Robot]
    water: Water
    joints: str
    limit: float | None

    def gait(self, gait: Gait) -> Gait:
        """What the joints do of a gait if their speed is limited and they are prescribed."""
        if self.limit is None:
            return gait
        n = self.robots[False].n_links
        envelope = [
            g / math.sqrt(1.0 + (gait.amplitude * g * gait.frequency / self.limit) ** 2) for g in gait.joint_envelope(n)
        ]
        return replace(gait, kind="custom", envelope=tuple(envelope))


def forward_velocities(models: Sequence[Model], rows: Sequence[Any]) -> np.ndarray:
    """Speeds of the rows of Table 1, one line per model [m/s]; 1 mm/s where a run blows up."""
    found = lc.swim_many(
        [model.robots[row.has_fin] for model in models for row in rows],
        [model.gait(row.gait) for model in models for row in rows],
        30.0,
        environments=[model.water for model in models for row in rows],
        joints=models[0].joints,
        threads=1,
    )
    speeds = np.where(found.succeeded, found.forward_velocity, 0.001)
    return np.maximum(speeds.reshape(len(models), len(rows)), 0.001)


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """What a fit found."""

    values: dict[str, float]
    at_an_end: bool
    without: Callable[[int], dict[str, float]]
    """The numbers that one Gauss-Newton step without a row leads to."""


def fitted(candidate: Candidate, keep: np.ndarray, start: Values | None = None, most: int = 25) -> Fitted:
    """Least squares of log(simulated / measured) over the rows to keep."""
    names = list(candidate.start)
    if not names:
        return Fitted(values={}, at_an_end=False, without=lambda row: {})
    rows = [row for row, kept in zip(ROWS, keep, strict=True) if kept]
    log_measured = np.log(MEASURED[keep])

    def into(name: str, value: float) -> float:
        return value if name in SIGNED else math.log(value)

    def out_of(x: np.ndarray) -> dict[str, float]:
        return {name: float(v) if name in SIGNED else math.exp(v) for name, v in zip(names, x, strict=True)}

    low, high = (np.array([into(name, RANGES[name][end]) for name in names]) for end in (0, 1))
    width = high - low
    x = np.clip([into(name, (start or candidate.start)[name]) for name in names], low + 1e-3, high - 1e-3)

    def residuals(x: np.ndarray) -> np.ndarray:
        return np.log(forward_velocities([candidate.model(out_of(x))], rows)[0]) - log_measured

    def slopes(x: np.ndarray) -> np.ndarray:
        step = np.where(x + 1e-3 <= high, 1e-3, -1e-3)
        points = [x, *(x + step[i] * np.eye(len(x))[i] for i in range(len(x)))]
        logs = np.log(forward_velocities([candidate.model(out_of(point)) for point in points], rows))
        return ((logs[1:] - logs[0]) / step[:, None]).T

    found = least_squares(residuals, x, slopes, bounds=(low, high), max_nfev=most, xtol=1e-5, ftol=1e-6)
    near = np.minimum(found.x - low, high - found.x) < 0.01 * width

    def without(row: int) -> dict[str, float]:
        others = np.arange(len(rows)) != row
        step = np.linalg.lstsq(found.jac[others], -found.fun[others])[0]
        return out_of(np.clip(found.x + step, low, high))

    return Fitted(values=out_of(found.x), at_an_end=bool(np.any(near)), without=without)


def leave_one_out_error(candidate: Candidate, found: Fitted) -> float:
    """Mean absolute percentage error of rows that the fit did not see: one Gauss-Newton step away from the fit [%]."""
    if not found.values:
        return mape(MEASURED, forward_velocities([candidate.model({})], ROWS)[0])
    speeds = [forward_velocities([candidate.model(found.without(i))], [row])[0, 0] for i, row in enumerate(ROWS)]
    return mape(MEASURED, np.array(speeds))


def leave_one_group_out_error(candidate: Candidate, values: Values) -> float:
    """The same with a whole group left out, fitted anew [%]."""
    speeds = np.empty_like(MEASURED)
    for number in range(4):
        out = GROUP == number
        refit = fitted(candidate, ~out, start=values or None, most=12)
        rows = [row for row, is_out in zip(ROWS, out, strict=True) if is_out]
        speeds[out] = forward_velocities([candidate.model(refit.values)], rows)[0]
    return mape(MEASURED, speeds)


def fin_gains(speeds: np.ndarray) -> list[float]:
    """v_fin / v_nofin - 1 of both gaits in Table 1, the mean over the settings that were measured both ways."""
    gains: list[float] = []
    for kind in ("lateral_undulation", "eel_like"):
        pairs = [
            speeds[j] / speeds[i] - 1.0
            for i, bare in enumerate(ROWS)
            for j, fin in enumerate(ROWS)
            if bare.gait == fin.gait and bare.gait.kind == kind and fin.has_fin and not bare.has_fin
        ]
        gains.append(float(np.mean(pairs)))
    return gains


def followed_gains(speeds: np.ndarray) -> list[float]:
    """The same in Table 2: of the mean speeds of the cases."""
    means = [float(np.mean(speeds[FOLLOWED_GROUP == group])) for group in range(4)]
    return [means[1] / means[0] - 1.0, means[3] / means[2] - 1.0]


def follow(model: Model, bandwidth: float) -> list[Trial]:
    """The cases of Table 2."""
    settings = path_following_settings()
    found: list[Trial] = []
    for row in FOLLOWED:
        body = plant(model.robots[row.has_fin], model.water, joints=model.joints, offset_bandwidth=bandwidth)
        controller = settings.steering().controller(model.gait(row.gait), StraightLine(), settings.control_interval)
        start = Start(center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading)
        found.append(run(body, controller, settings.duration, start=start, until=_is_there(settings.distance)))
    return found


def _is_there(distance: float) -> Callable[[Any], bool]:
    return lambda seen: bool(seen.center_of_mass[0] >= distance)


def of(name: str, joints: str, start: Values, **more: Any) -> Candidate:
    return Candidate(name=name, joints=joints, start=start, **more)


_FEW = {C_F: 0.15, LIMIT: 0.7}
_BASIC = {C_F: 0.13, LIMIT: 0.8, U_REF: 0.4}
_MOTOR = {C_F: 0.17, GEARED: 0.66, U_REF: 0.25}
_SKIN = {C_F: 0.12, U_REF: 0.4, DAMPING: 4.0}
_ELASTIC = {"n_hinges": 2, "flexural_rigidity": 1.0}
CANDIDATES: tuple[Candidate, ...] = (
    of("prescribed", "prescribed", {C_F: 0.2}),
    of("prescribed, a share", "prescribed", {C_F: 0.2, "robot.joint.actuator.tracking": 0.8}),
    of("prescribed, limited", "prescribed", _FEW),
    of("prescribed, limited, U", "prescribed", _BASIC),
    of("prescribed, limited, U, elastic", "prescribed", {**_BASIC, EI: 8.0}),
    of("prescribed, limited, U, sway", "prescribed", {**_BASIC, SWAY: 0.5}),
    of("prescribed, limited, U, taper", "prescribed", {**_BASIC, "water.friction_taper": 0.0}),
    of("prescribed, limited, sway", "prescribed", {**_FEW, SWAY: 1.0}),
    of("prescribed, limited, C_A", "prescribed", {**_FEW, "water.added_mass": 1.5}),
    of(
        "prescribed, limited, sway, quadratic",
        "prescribed",
        {**_FEW, SWAY: 1.0},
        water={"drag": PolynomialDrag(linear=False)},
    ),
    of("prescribed, limited, U, kirchhoff", "prescribed", _BASIC, water={"added_mass_form": "kirchhoff"}),
    of("prescribed, limited, U, 10 links", "prescribed", _BASIC, n_links=10),
    of("prescribed, limited, U, steady fin", "prescribed", _BASIC, fin={"normal_drag": 1.2}),
    of("pd, U", "pd", {C_F: 0.2, U_REF: 0.2, "pd.proportional_gain": 40.0}),
    of("pd, U, elastic", "pd", {C_F: 0.25, U_REF: 0.2, "pd.proportional_gain": 20.0, EI: 1.0}),
    of("servo with skin", "servo", _SKIN, is_motor=True),
    of("servo with skin, elastic", "servo", {**_SKIN, EI: 0.3}, is_motor=True),
    of("servo with stiff skin", "servo", {**_SKIN, STIFFNESS: 5.0}, is_motor=True),
    of("servo with stiff skin, elastic", "servo", {C_F: 0.1, DAMPING: 5.0, STIFFNESS: 5.0, EI: 0.3}, is_motor=True),
    of("geared", "servo", {C_F: 0.12, GEARED: 0.55}, is_motor=True),
    of("geared, gain", "servo", {C_F: 0.1, GEARED: 0.5, GAIN: 4.0}, is_motor=True),
    of("geared, U", "servo", _MOTOR, is_motor=True),
    of("geared, U, gain", "servo", {**_MOTOR, GAIN: 4.0}, is_motor=True),
    of("geared, U, elastic", "servo", {**_MOTOR, EI: 8.0}, is_motor=True),
    of("geared, U, sway", "servo", {**_MOTOR, SWAY: 0.5}, is_motor=True),
    of("geared, gain, elastic", "servo", {C_F: 0.1, GEARED: 0.5, GAIN: 4.0, EI: 8.0}, is_motor=True),
    of("geared, gain, C_A", "servo", {C_F: 0.1, GEARED: 0.5, GAIN: 4.0, "water.added_mass": 1.5}, is_motor=True),
    of("geared, gain, sway", "servo", {C_F: 0.1, GEARED: 0.5, GAIN: 4.0, SWAY: 0.5}, is_motor=True),
    of(
        "geared, U, gain, kirchhoff",
        "servo",
        {**_MOTOR, GAIN: 4.0},
        water={"added_mass_form": "kirchhoff"},
        is_motor=True,
    ),
    of("geared, U, gain, 10 links", "servo", {**_MOTOR, GAIN: 4.0}, n_links=10, is_motor=True),
    of("geared, U, gain, steady fin", "servo", {**_MOTOR, GAIN: 4.0}, fin={"normal_drag": 1.2}, is_motor=True),
    of(
        "unlimited torque, U",
        "servo",
        {C_F: 0.18, "robot.joint.actuator.no_load_speed": 0.67, U_REF: 0.25},
        actuator={"stall_torque": 200.0},
        is_motor=True,
        is_limit=True,
    ),
)


def on_table_1(candidate: Candidate) -> dict[str, Any]:
    """Fit, and the errors on Table 1."""
    every = np.ones(len(ROWS), dtype=bool)
    best = fitted(candidate, every)
    speeds = forward_velocities([candidate.model(best.values)], ROWS)[0]
    gains, measured_gains = fin_gains(speeds), fin_gains(MEASURED)
    return {
        "name": candidate.name,
        "n": len(candidate.start),
        "values": best.values,
        "at_an_end": best.at_an_end,
        "is_motor": candidate.is_motor,
        "is_limit": candidate.is_limit,
        "speeds": speeds.tolist(),
        "error": mape(MEASURED, speeds),
        "groups": [mape(MEASURED[GROUP == g], speeds[GROUP == g]) for g in range(4)],
        "largest": 100.0 * float(np.max(np.abs(speeds / MEASURED - 1.0))),
        "leave_one_out": leave_one_out_error(candidate, best),
        "leave_one_group_out": leave_one_group_out_error(candidate, best.values),
        "gain_ratios": [g / m for g, m in zip(gains, measured_gains, strict=True)],
    }


def on_table_2(candidate: Candidate, result: Mapping[str, Any], bandwidths: Sequence[float]) -> dict[str, Any]:
    """What it says of Table 2."""
    model = candidate.model(result["values"])
    found: dict[str, Any] = {}
    for bandwidth in bandwidths:
        trials = follow(model, bandwidth)
        runs = [figures_of(trial, path_following_settings().distance) if trial.succeeded else None for trial in trials]
        speeds = np.array([0.0 if one is None else one.forward_velocity for one in runs])
        gains, measured = followed_gains(speeds), followed_gains(FOLLOWED_SPEED)
        by_group = [(FOLLOWED_SPEED[FOLLOWED_GROUP == g], speeds[FOLLOWED_GROUP == g]) for g in range(4)]
        found[f"{bandwidth:g}"] = {
            "speeds": speeds.tolist(),
            "error": mape(FOLLOWED_SPEED, speeds),
            "groups": [mape(was, says) for was, says in by_group],
            "bias": [100.0 * float(np.mean(says / was - 1.0)) for was, says in by_group],
            "converging": sum(one is not None and one.converged for one in runs),
            "gain_ratios": [g / m for g, m in zip(gains, measured, strict=True)],
        }
    return found


def chosen(results: Sequence[Mapping[str, Any]]) -> Mapping[str, Any] | None:
    """By the rule of `identify_paper.md`, which knows nothing of Table 2."""
    allowed = [r for r in results if r["n"] <= 4 and not r["at_an_end"] and not r["is_limit"]]
    if not allowed:
        return None
    best = min(r["leave_one_group_out"] for r in allowed)
    equal = [r for r in allowed if r["leave_one_group_out"] <= best + 1.0]
    equal = [r for r in equal if r["is_motor"]] or equal
    least = min(r["leave_one_out"] for r in equal)
    return min((r for r in equal if r["leave_one_out"] <= least + 0.2), key=lambda r: (r["n"], r["leave_one_out"]))


def null_results() -> list[dict[str, Any]]:
    """The same figures of the models without physics."""
    rows = [Row(gait=row.gait, has_fin=row.has_fin) for row in ROWS]
    others = [Row(gait=row.gait, has_fin=row.has_fin) for row in FOLLOWED]
    groups = sorted({row.group for row in rows})
    found: list[dict[str, Any]] = []
    for name in NULL_MODELS:
        columns, known = NULL_MODELS[name](rows, groups)
        target = np.log(MEASURED) - known
        speeds = np.exp(columns @ fit(columns, target) + known)
        one, group = (np.exp(left_out(columns, target, by) + known) for by in (np.arange(len(ROWS)), GROUP))
        followed = predict(name, rows, MEASURED, others)[0]
        found.append(
            {
                "name": f"null: {name}",
                "n": columns.shape[1],
                "error": mape(MEASURED, speeds),
                "groups": [mape(MEASURED[GROUP == g], speeds[GROUP == g]) for g in range(4)],
                "leave_one_out": mape(MEASURED, one),
                "leave_one_group_out": mape(MEASURED, group) if np.all(np.isfinite(group)) else None,
                "table_2": mape(FOLLOWED_SPEED, followed),
                "table_2_groups": [
                    mape(FOLLOWED_SPEED[FOLLOWED_GROUP == g], followed[FOLLOWED_GROUP == g]) for g in range(4)
                ],
            }
        )
    return found


def power_answers(model: Model, followed: Sequence[Trial]) -> list[dict[str, Any]]:
    """Electrical power of all 30 measured rows, with one model each, with and without an idle offset in Table 2.

    The hypothesis: of all rows only those of Table 2 without the fin had the idle 41.3 W taken off, or had it twice.
    """
    first = [row for row in efficiency_trials() if row.mean_power is not None]
    trials = [
        lc.swim(model.robots[r.has_fin], model.gait(r.gait), environment=model.water, joints=model.joints)
        for r in first
    ]
    trials += list(followed)
    measured = np.array([row.mean_power for row in (*first, *FOLLOWED)], dtype=float)
    bare = np.array([False] * len(first) + [not row.has_fin for row in FOLLOWED])
    torque = np.array([np.sum(np.mean(t.joint_torque**2, axis=0)) for t in trials])
    rate = np.array([np.sum(np.mean(np.abs(t.joint_rate), axis=0)) for t in trials])
    one = np.ones_like(measured)
    columns = {
        "constant": [one],
        "constant + torque^2": [one, torque],
        "constant + torque^2 + |rate|": [one, torque, rate],
        "constant + mechanical": [one, np.array([t.mechanical_power for t in trials])],
    }
    known = {}
    if model.joints == "servo":
        motor = np.array([t.electrical_power for t in trials])
        columns["constant + motor x factor"] = [one, motor]
        known["constant + motor as published"] = motor
    found: list[dict[str, Any]] = []
    for offset in (False, True):
        target = measured + (41.3 * bare if offset else 0.0)
        for name in (*columns, *known):
            given = known.get(name, np.zeros_like(measured))
            table = np.stack(columns.get(name, [one]), axis=1)
            # Relative errors count: every line divided by what was measured.
            matrix, wanted = table / target[:, None], (target - given) / target
            numbers = np.linalg.lstsq(matrix, wanted)[0]
            out = [np.linalg.lstsq(np.delete(matrix, i, 0), np.delete(wanted, i))[0] for i in range(len(target))]
            says = table @ numbers + given
            held = np.array([table[i] @ out[i] + given[i] for i in range(len(target))])
            found.append(
                {
                    "name": name,
                    "offset": offset,
                    "numbers": numbers.tolist(),
                    "error": mape(target, says),
                    "leave_one_out": mape(target, held),
                    "table_1": mape(target[: len(first)], says[: len(first)]),
                    "table_2": mape(target[len(first) :], says[len(first) :]),
                    "says": says.tolist(),
                    "target": target.tolist(),
                }
            )
    return found


def line_1(r: Mapping[str, Any], mark: str = " ") -> str:
    """A candidate's figures on Table 1."""
    numbers = ", ".join(f"{SHORT[name]} {value:.3g}" for name, value in r["values"].items())
    groups = " ".join(f"{g:5.1f}" for g in r["groups"])
    gains = " ".join(f"{g:.2f}" for g in r["gain_ratios"])
    note = " (at an end of its range)" if r["at_an_end"] else " (no motor is like that)" if r["is_limit"] else ""
    return (
        f"{mark}{r['name']:38s} {r['n']} {r['error']:6.1f} {groups} {r['leave_one_out']:6.1f} "
        f"{r['leave_one_group_out']:6.1f}   {gains}   {numbers}{note}"
    )


def line_2(r: Mapping[str, Any], mark: str = " ") -> str:
    """A candidate's figures on Table 2."""
    parts: list[str] = []
    for found in r["table_2"].values():
        groups = " ".join(f"{b:+6.1f}" for b in found["bias"])
        gains = " ".join(f"{g:.2f}" for g in found["gain_ratios"])
        parts.append(f"{found['error']:6.1f} {groups} {found['converging']:3d}/12  {gains}")
    return f"{mark}{r['name']:38s} {r['n']} " + "  |  ".join(parts)


HEAD_1 = (
    f" {'Table 1, mean error [%]':38s} n    all    LU  LUfin   EEL EELfin   LOO   LOGO   fin gain LU EEL, simulated / "
    "measured; numbers"
)
HEAD_2 = (
    f" {'Table 2, not fitted [%]':38s} n  per bandwidth: all, signed mean LU LUfin EEL EELfin, converging, "
    "fin gain LU EEL, simulated / measured"
)


HEAD_3 = f" {'Power of 30 rows, mean error [%]':38s} with 41.3 W; n, all, LOO, Table 1, Table 2; numbers"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="part of the names of the candidates")
    parser.add_argument("--table-1", action="store_true", help="do not run Table 2")
    parser.add_argument("--bandwidth", type=float, nargs="+", default=BANDWIDTHS, help="of the steering filter, rad/s")
    parser.add_argument("--fitted", type=Path, help="take the fits from the --output of an earlier run")
    parser.add_argument("--output", type=Path, help="JSON file for what came out")
    arguments = parser.parse_args()
    candidates = [candidate for candidate in CANDIDATES if arguments.only in candidate.name]
    tell: Callable[[str], None] = lambda text: print(text, file=sys.stderr, flush=True)  # noqa: E731
    results: list[dict[str, Any]] = []
    known = {r["name"]: r for r in json.loads(arguments.fitted.read_text())["results"]} if arguments.fitted else {}
    for i, candidate in enumerate(candidates):
        begin = time.perf_counter()
        results.append(known.get(candidate.name) or on_table_1(candidate))
        tell(f"{i + 1}/{len(candidates)} {line_1(results[-1]).strip()} [{time.perf_counter() - begin:.0f} s]")
    best = chosen(results) if len(candidates) == len(CANDIDATES) else None  # the rule is for all of them
    if not arguments.table_1:
        for i, (candidate, result) in enumerate(zip(candidates, results, strict=True)):
            result["table_2"] = on_table_2(candidate, result, arguments.bandwidth)
            tell(f"{i + 1}/{len(candidates)} {line_2(result).strip()}")
    nulls = null_results()
    print(HEAD_1)
    for null in nulls:
        group = null["leave_one_group_out"]
        print(
            f" {null['name']:38s} {null['n']} {null['error']:6.1f} {' '.join(f'{g:5.1f}' for g in null['groups'])} "
            f"{null['leave_one_out']:6.1f} {'     -' if group is None else f'{group:6.1f}'}"
        )
    for result in results:
        print(line_1(result, "*" if result is best else " "))
    if not arguments.table_1:
        print(HEAD_2)
        for null in nulls:
            groups = " ".join(f"{g:6.1f}" for g in null["table_2_groups"])
            print(f" {null['name']:38s} {null['n']} {null['table_2']:6.1f} {groups} (without sign)")
        for result in results:
            print(line_2(result, "*" if result is best else " "))
    powers: list[dict[str, Any]] = []
    if best is not None and not arguments.table_1:
        candidate = next(one for one in candidates if one.name == best["name"])
        model = candidate.model(best["values"])
        powers = power_answers(model, follow(model, BANDWIDTHS[0]))
        print(HEAD_3)
        for found in powers:
            numbers = ", ".join(f"{number:.3g}" for number in found["numbers"])
            with_offset = "yes" if found["offset"] else "no "
            print(
                f" {found['name']:38s} {with_offset} {len(found['numbers'])} {found['error']:6.1f} "
                f"{found['leave_one_out']:6.1f} {found['table_1']:6.1f} {found['table_2']:6.1f}   {numbers}"
            )
    if arguments.output:
        arguments.output.write_text(
            json.dumps({"chosen": best and best["name"], "results": results, "null": nulls, "power": powers})
        )


if __name__ == "__main__":
    main()
