"""Which water, which drive and which place of the drag explain the tank trials of two robots?

Question: 72 models of two fitted numbers each are fitted to the speeds of the paper's Table 1.
Which holds when a group of gait and fin is left out, which says most of another robot, and what do
the chosen ones say of Table 2, which nothing was fitted to or chosen by? What was decided
beforehand, and the answer, are in `identify_paper.md`.

    python campaigns/identify_paper.py --interval             # Table 1 from textbook water, nothing compared
    python campaigns/identify_paper.py --output FILE          # all candidates; Table 2 and power by the chosen
    python campaigns/identify_paper.py --presets              # Table 2 and power by the numbers that ship
    python campaigns/identify_paper.py --only "beta 1"        # those whose name holds a word; none is chosen
"""

import argparse
import csv
import itertools
import json
import math
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import amphibot
import numpy as np
from scipy.optimize import least_squares, nnls

import laticauda as lc
from laticauda.models.simulate import build_plant, figure_intervals, intervals_of, run
from laticauda.paper.measured import read_efficiency_trials, read_path_following_trials
from laticauda.paper.path_following import figures_of
from laticauda.paper.settings import load_path_following_settings
from laticauda.robot import PectoralFin, Robot, Tether, Water, textbook_of
from laticauda.robot.parameters import adjust
from laticauda.trials import Trial
from laticauda.trials.null_models import group_name, mape
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

Numbers = tuple[float, float]
"""What is fitted: a drag, and the joints' speed [rad/s]."""

ROWS = tuple(row for row in read_efficiency_trials() if row.forward_velocity is not None)
"""Rows of Table 1 whose speed was measured."""
MEASURED = np.array([row.forward_velocity for row in ROWS])
"""Their speeds [m/s]."""
GROUP_NAMES = tuple(dict.fromkeys(group_name(row.gait.kind, row.has_fin) for row in ROWS))
FOLLOWED = read_path_following_trials()
"""Rows of Table 2."""
FOLLOWED_SPEED = np.array([row.forward_velocity for row in FOLLOWED])
"""Their speeds [m/s]."""


def _groups_of(rows: Sequence[Any]) -> np.ndarray:
    """Number of every row's group of gait and fin."""
    names = [group_name(row.gait.kind, row.has_fin) for row in rows]
    return np.array([GROUP_NAMES.index(name) for name in names])


GROUP = _groups_of(ROWS)
FOLLOWED_GROUP = _groups_of(FOLLOWED)
LOOP_DELAY = 0.12
"""Committed beforehand: cameras, computer, bus, servo [s]."""
KICK = 2.0
"""Joints that torque does not limit start with a kick, which says nothing of power [s]."""
LAGS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
"""Lags from heading to joint, shown beside it [s]."""
LEAST_SPEED = 0.001
"""Speed of a run that blows up or goes backward, as its logarithm is taken [m/s]."""
IDLE_POWER = 41.3
"""What the robot takes at rest [W]."""
FIN = {"tangential_friction": 0.005, "normal_drag": 2.0, "added_mass": 1.0}
FIN_AS_PLATE = {**FIN, "normal_drag": 1.2}
"""In textbook water: drag of a plate of .09 x .38 m; its law of the edge takes the span off the added mass."""
STALL_TORQUE, NO_LOAD_SPEED = 2.9, 7.5
"""Those of the published servo [N m], [rad/s]."""
SERVO_POWER = STALL_TORQUE * NO_LOAD_SPEED
"""Product of both, which a gear keeps [W]."""
PRESETS = ("mamba-identified", "mamba-textbook")
BAND = math.radians(10.0)
"""Error at which a position loop asks for the whole speed [rad]."""
SPEEDS = (0.2, 7.5)
"""Range of the joints' speed [rad/s]."""
HERE = Path(__file__).parent

DRAGS: Mapping[str, Any] = {
    "linear + quadratic": PolynomialDrag(),
    "beta 0": TotalSpeedDrag(beta=0.0),
    "beta 0.5": TotalSpeedDrag(beta=0.5),
    "beta 1": TotalSpeedDrag(beta=1.0),
}
PLACES: Mapping[str, tuple[float, float, float]] = {
    "body": (0.2, 0.005, 1.0),
    "tail": (30.0, 0.5, 200.0),
    "head": (30.0, 0.5, 200.0),
}
"""Where the fitted drag is: start and range of C_f, or of half of rho times the drag area of a point [kg/m]."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A water, a drive, and where the drag is."""

    drag: str
    mass: str
    drive: str
    place: str

    @property
    def name(self) -> str:
        return f"{self.drag}, {self.mass}, {self.drive}, drag on the {self.place}"

    def water(self, robot: Robot) -> Water:
        """The water of a robot with nothing fitted."""
        book = replace(textbook_of(robot), drag=DRAGS[self.drag])
        if self.mass == "kirchhoff":
            return book
        form = {"added_mass_form": "relative", "trailing_edge": "none", "rotational": "paper"}
        return replace(book, **form, normal_drag=1.75, added_mass=1.5)

    def model(self, numbers: Numbers) -> "Model":
        """The model of Mamba with these numbers."""
        drag, speed = numbers
        drive = _drive(self.drive, speed)
        robots = {
            False: self._robot(lc.load_robot("mamba"), {"actuator": drive.actuator}, drag),
            True: self._robot(
                lc.load_robot("mamba-fin"),
                {
                    "actuator": drive.actuator,
                    "caudal_fin": FIN_AS_PLATE if self.mass == "kirchhoff" else FIN,
                },
                drag,
            ),
        }
        water = self.water(lc.load_robot("mamba"))
        if self.place == "body":
            water = replace(water, tangential_friction=drag)
        return Model(robots=robots, water=water, joints=drive.joints)

    def _robot(self, robot: Robot, changes: Mapping[str, Any], drag: float) -> Robot:
        """The robot with changes, and with the fitted drag if that is at its tail or head."""
        robot = adjust(robot, changes)
        if self.place == "tail":
            return replace(robot, tether=Tether(drag=drag))
        if self.place == "head":
            plate = PectoralFin(
                link=robot.n_links - 1,
                area=drag / 500.0,
                lift_slope=0.0,
                stall_angle=math.pi / 2.0,
                parasitic_drag=1.0,
            )
            return replace(robot, pectoral_fins=(plate,))
        return robot


class Drive(NamedTuple):
    """What moves the joints."""

    actuator: Mapping[str, float]
    """Numbers of the motor that differ."""
    joints: Any
    """Joint law."""


def _drive(name: str, speed: float) -> Drive:
    """The drive of a name, with joints of a speed [rad/s]."""
    if name == "servo":
        actuator = {"no_load_speed": speed, "stall_torque": SERVO_POWER / speed}
        return Drive(actuator, "servo")
    if name == "speed-servo":
        ratio = 200.0 / STALL_TORQUE
        actuator = {"stall_torque": STALL_TORQUE * ratio, "stall_current": 4.6 * ratio}
        speed_gain = 200.0 / speed
    else:
        ratio = NO_LOAD_SPEED / (1.5 * speed)
        actuator = {"stall_torque": STALL_TORQUE * ratio, "no_load_speed": 1.5 * speed}
        speed_gain = STALL_TORQUE * ratio / (0.1 * speed)
    joints = lc.SpeedServo(speed_limit=speed, position_gain=speed / BAND, speed_gain=speed_gain)
    return Drive(actuator, joints)


CANDIDATES = tuple(
    Candidate(drag=drag, mass=mass, drive=drive, place=place)
    for mass, drag, drive, place in itertools.product(
        ("relative", "kirchhoff"), DRAGS, ("servo", "speed-servo", "geared speed-servo"), PLACES
    )
)


@dataclass(frozen=True, kw_only=True)
class Model:
    """What swims, where, and how it is driven."""

    robots: Mapping[bool, Robot]
    water: Water
    joints: Any


def forward_velocities(models: Sequence[Model], rows: Sequence[Any] = ROWS) -> np.ndarray:
    """Speeds of rows of Table 1, one line per model [m/s]; 1 mm/s where a run blows up."""
    speeds_of_models: list[np.ndarray] = []
    for model in models:  # a joint law's numbers are one set per batch
        robots = [model.robots[row.has_fin] for row in rows]
        batch = lc.swim_many(
            robots,
            [row.gait for row in rows],
            30.0,
            environments=model.water,
            joints=model.joints,
            dt=0.004,
            threads=1,
        )
        speeds = np.where(batch.succeeded, batch.forward_velocity, LEAST_SPEED)
        speeds_of_models.append(np.maximum(speeds, LEAST_SPEED))
    return np.stack(speeds_of_models)


class Fit(NamedTuple):
    """A candidate's numbers."""

    numbers: Numbers
    is_at_an_end: bool
    """Whether one of them is at an end of its range."""


def fit(candidate: Candidate, is_used: np.ndarray, start: Numbers | None = None) -> Fit:
    """Least squares of log(simulated / measured) over the rows that are used."""
    rows = [ROWS[i] for i in np.flatnonzero(is_used)]
    log_measured = np.log(MEASURED[is_used])
    usual_drag, *ends = PLACES[candidate.place]
    low, high = np.log(np.array([ends, SPEEDS])).T
    step = 1e-3

    def residuals_at(*points: np.ndarray) -> np.ndarray:
        models = [candidate.model(tuple(np.exp(point))) for point in points]
        return np.log(forward_velocities(models, rows)) - log_measured

    def residuals(point: np.ndarray) -> np.ndarray:
        return residuals_at(point)[0]

    def slopes(point: np.ndarray) -> np.ndarray:
        at_point, *beside = residuals_at(point, *(point - step * np.eye(2)))
        return (at_point - np.array(beside)).T / step

    first = np.clip(np.log(start or (usual_drag, 0.8)), low + 2e-3, high - 2e-3)
    result = least_squares(
        residuals, first, slopes, bounds=(low, high), max_nfev=20, xtol=1e-4, ftol=1e-5
    )
    distance_from_ends = np.minimum(result.x - low, high - result.x)
    is_near_an_end = distance_from_ends < 0.01 * (high - low)
    drag, speed = np.exp(result.x).tolist()
    return Fit((drag, speed), bool(np.any(is_near_an_end)))


def on_table_1(candidate: Candidate) -> dict[str, Any]:
    """Fit, the errors on Table 1, and by groups."""
    numbers, is_at_an_end = fit(candidate, np.ones(len(ROWS), dtype=bool))
    speeds = forward_velocities([candidate.model(numbers)])[0]
    speeds_by_groups = np.empty_like(speeds)
    refits: list[Numbers] = []
    for group in range(len(GROUP_NAMES)):
        is_left_out = group == GROUP
        refit = fit(candidate, ~is_left_out, numbers).numbers
        refits.append(refit)
        rows = [ROWS[i] for i in np.flatnonzero(is_left_out)]
        speeds_by_groups[is_left_out] = forward_velocities([candidate.model(refit)], rows)[0]
    return {
        "name": candidate.name,
        "numbers": numbers,
        "at_an_end": is_at_an_end or bool(np.any(speeds <= LEAST_SPEED)),
        "speeds": speeds.tolist(),
        "error": mape(MEASURED, speeds),
        "by_groups": mape(MEASURED, speeds_by_groups),
        "refits": refits,
        "gains": gain_ratios(speeds),
    }


def on_amphibot(candidate: Candidate) -> dict[str, float]:
    """Simulated over measured - 1 of run 1: two swims, two glides, the start."""
    measured = amphibot.measured()
    water = candidate.water(lc.load_robot("amphibot"))
    simulated = amphibot.figures(amphibot.swum(water))
    return {name: simulated[name] / measured[name] - 1.0 for name in measured}


def error_of_swims(errors: Mapping[str, float]) -> float:
    """The score on AmphiBot: mean error of both swims [%]."""
    return 50.0 * (abs(errors["swim 1"]) + abs(errors["swim 2"]))


# ---- what the fin brings -------------------------------------------------------------------------


def gains(speeds: np.ndarray) -> list[list[float]]:
    """v_fin / v_nofin of both gaits in Table 1, of every setting that was measured both ways."""
    speed_with_fin = {
        row.gait: speed for row, speed in zip(ROWS, speeds, strict=True) if row.has_fin
    }
    gains_of_kind: dict[str, list[float]] = {"lateral_undulation": [], "eel_like": []}
    for row, speed in zip(ROWS, speeds, strict=True):
        if not row.has_fin and row.gait in speed_with_fin:
            gains_of_kind[row.gait.kind].append(speed_with_fin[row.gait] / speed)
    return list(gains_of_kind.values())


def followed_gains(speeds: np.ndarray) -> list[list[float]]:
    """The same in Table 2, case by case."""
    lateral, lateral_fin, eel_like, eel_like_fin = (
        speeds[group == FOLLOWED_GROUP] for group in range(4)
    )
    return [(lateral_fin / lateral).tolist(), (eel_like_fin / eel_like).tolist()]


def gain_ratios(speeds: np.ndarray) -> list[float]:
    """Simulated over measured gain v_fin / v_nofin - 1 of both gaits, means over the settings."""
    ratios: list[float] = []
    for simulated, measured in zip(gains(speeds), gains(MEASURED), strict=True):
        ratio = (np.mean(simulated) - 1.0) / (np.mean(measured) - 1.0)
        ratios.append(float(ratio))
    return ratios


def describe_gains(simulated: list[list[float]], measured: list[list[float]]) -> str:
    """Both gains with the standard error of the measured mean, and their ratio."""
    descriptions: list[str] = []
    gaits = ("lateral", "eel-like")
    for gait, simulated_ratios, measured_ratios in zip(gaits, simulated, measured, strict=True):
        gain = np.mean(simulated_ratios) - 1.0
        measured_gain = np.mean(measured_ratios) - 1.0
        error = np.std(measured_ratios, ddof=1) / math.sqrt(len(measured_ratios))
        descriptions.append(
            f"{gait} {gain:.2f} against {measured_gain:.2f} +- {error:.2f} "
            f"({gain / measured_gain:.2f})"
        )
    return "; ".join(descriptions)


# ---- Table 2 and power ---------------------------------------------------------------------------


def follow(model: Model, delay: float) -> list[Trial]:
    """The cases of Table 2, without a steering filter."""
    settings = load_path_following_settings()

    def has_arrived(observation: lc.Observation) -> bool:
        return bool(observation.center_of_mass[0] >= settings.distance)

    trials: list[Trial] = []
    for row in FOLLOWED:
        plant = build_plant(
            model.robots[row.has_fin],
            model.water,
            joints=model.joints,
            offset_bandwidth=1e6,
            loop_delay=delay,
        )
        controller = settings.controller(row.gait)
        start = lc.Start(
            center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading
        )
        trials.append(run(plant, controller, settings.duration, start=start, until=has_arrived))
    return trials


def table_2(trials: Sequence[Trial]) -> dict[str, Any]:
    """How far they are from what was measured, and how many converge."""
    distance = load_path_following_settings().distance
    figures = [figures_of(trial, distance) for trial in trials]
    speeds = np.array([figures_of_trial.forward_velocity for figures_of_trial in figures])
    error = speeds / FOLLOWED_SPEED - 1.0
    return {
        "error": mape(FOLLOWED_SPEED, speeds),
        "bias": [100.0 * float(np.mean(error[group == FOLLOWED_GROUP])) for group in range(4)],
        "converging": sum(figures_of_trial.converged for figures_of_trial in figures),
        "gains": describe_gains(followed_gains(speeds), followed_gains(FOLLOWED_SPEED)),
        "speeds": speeds.tolist(),
    }


def powers(model: Model, followed: Sequence[Trial]) -> list[dict[str, Any]]:
    """Electrical power of all 30 measured rows by one model each, no coefficient negative.

    The hypothesis: only the rows of Table 2 without the fin had the idle 41.3 W taken off, or had
    it twice.
    """
    rows = [row for row in read_efficiency_trials() if row.mean_power is not None]
    trials: list[Trial] = []
    for row in rows:
        robot = model.robots[row.has_fin]
        trials.append(lc.swim(robot, row.gait, environment=model.water, joints=model.joints))
    trials += followed
    measured = np.array([row.mean_power for row in (*rows, *FOLLOWED)], dtype=float)
    is_without_fin = np.array([False] * len(rows) + [not row.has_fin for row in FOLLOWED])
    columns = columns_of_power(trials)
    results: list[dict[str, Any]] = []
    for is_idle in (False, True):
        target = measured
        if is_idle:
            target = measured + IDLE_POWER * is_without_fin
        for name, columns_of_model in columns.items():
            results.append({"name": name, "idle": is_idle, **fit_power(columns_of_model, target)})
    return results


def columns_of_power(trials: Sequence[Trial]) -> dict[str, list[np.ndarray]]:
    """What the coefficients of every model are multiplied with, by trial: sums over the joints of means over time."""

    def total(of: Callable[[Trial], np.ndarray]) -> np.ndarray:
        totals = [np.sum(np.mean(of(trial)[trial.time > KICK], axis=0)) for trial in trials]
        return np.array(totals)

    constant = np.ones(len(trials))
    torque = total(lambda trial: trial.joint_torque**2)
    rate = total(lambda trial: np.abs(trial.joint_rate))
    mechanical = total(lambda trial: np.abs(trial.joint_torque * trial.joint_rate))
    return {
        "constant": [constant],
        "constant + torque^2": [constant, torque],
        "constant + mechanical": [constant, mechanical],
        "constant + torque^2 + |rate|": [constant, torque, rate],
    }


def fit_power(columns: Sequence[np.ndarray], power: np.ndarray) -> dict[str, Any]:
    """Fit coefficients; the errors, also of each row without which they are fitted [%]."""
    matrix = np.stack(columns, axis=1) / power[:, None]  # relative errors count
    ones = np.ones(len(power))
    numbers, _ = nnls(matrix, ones)
    left_out = np.zeros(len(power))
    for i in range(len(power)):
        numbers_without, _ = nnls(np.delete(matrix, i, 0), ones[1:])
        left_out[i] = matrix[i] @ numbers_without
    return {
        "numbers": numbers.tolist(),
        "error": 100.0 * float(np.mean(np.abs(matrix @ numbers - 1.0))),
        "left_out": 100.0 * float(np.mean(np.abs(left_out - 1.0))),
    }


# ---- the choice ----------------------------------------------------------------------------------


def choose(results: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """By the rule of `identify_paper.md`, which knows nothing of Table 2."""

    def error_on_mamba(result: Mapping[str, Any]) -> float:
        return result["by_groups"]

    def error_on_amphibot(result: Mapping[str, Any]) -> float:
        return error_of_swims(result["amphibot"])

    def error_on_both(result: Mapping[str, Any]) -> float:
        return max(error_on_mamba(result), error_on_amphibot(result))

    def error_on_amphibot_then_mamba(result: Mapping[str, Any]) -> tuple[float, float]:
        return round(error_on_amphibot(result), 6), error_on_mamba(result)

    allowed = [result for result in results if not result["at_an_end"]]
    least = min(map(error_on_mamba, allowed))
    equal = [result for result in allowed if error_on_mamba(result) <= least + 0.5]
    return {
        "Mamba's": min(equal, key=error_on_amphibot),
        "shared": min(allowed, key=error_on_both),
        "by Mamba alone": min(allowed, key=error_on_mamba),
        "by AmphiBot alone": min(allowed, key=error_on_amphibot_then_mamba),
    }


def interval() -> None:
    """Every row of Table 1 in the textbook's water, into a file, beside nothing."""
    with (HERE / "identify_paper_interval.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(
            ("gait", "fin", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "low_m_s", "high_m_s")
        )
        for row in ROWS:
            gait = row.gait
            robot = lc.load_robot("mamba-fin" if row.has_fin else "mamba")
            robot = replace(robot, surface="skinned")
            trial = lc.swim(robot, gait, environment=textbook_of(robot))
            low, high = figure_intervals(trial, intervals_of(trial.scenario))["forward_velocity"]
            angles = (gait.amplitude, gait.frequency, gait.phase_shift)
            speeds = (trial.forward_velocity, low, high)
            cells = [gait.kind, int(row.has_fin)]
            cells += [f"{math.degrees(angle):.0f}" for angle in angles]
            cells += [f"{speed:.4f}" for speed in speeds]
            writer.writerow(cells)


def line(result: Mapping[str, Any]) -> str:
    """A candidate's figures."""
    on_amphibot = result["amphibot"]
    drag, speed = result["numbers"]
    errors_on_amphibot = " ".join(f"{100 * error:+4.0f}" for error in on_amphibot.values())
    gain = " ".join(f"{ratio:.2f}" for ratio in result["gains"])
    errors = f"{result['error']:5.1f} {result['by_groups']:5.1f}  {gain}"
    errors += f"  {error_of_swims(on_amphibot):5.1f} ({errors_on_amphibot})"
    text = f"{result['name']:66s} {errors}  {drag:.3g}, {speed:.3g} rad/s"
    if result["at_an_end"]:
        text += " (at an end of its range)"
    return text


HEAD = f"{'':66s} Table 1, by groups, fin gain LU EEL, AmphiBot (swims, glides, start); drag, joint speed"


def report_candidate(choice: str, result: Mapping[str, Any]) -> None:
    """What a chosen candidate says of Table 2 and of power."""
    (candidate,) = [candidate for candidate in CANDIDATES if candidate.name == result["name"]]
    drag, speed = result["numbers"]
    title = f"{choice}: {candidate.name}, {drag:.4g}, {speed:.4g} rad/s"
    report(title, candidate.model((drag, speed)), np.array(result["speeds"]), BAND / speed)


def report_preset(name: str) -> None:
    """What a preset says of Table 1, of Table 2 and of power, with the numbers that ship."""
    parameters = lc.load_parameters(name)
    robots = {
        False: parameters.robot(lc.load_robot("mamba"), "lateral_undulation"),
        True: parameters.robot(lc.load_robot("mamba-fin"), "lateral_undulation"),
    }
    water = parameters.water("lateral_undulation")
    joints = parameters.joints
    model = Model(robots=robots, water=water, joints=joints)
    trials = [
        lc.swim(robots[row.has_fin], row.gait, environment=water, joints=joints) for row in ROWS
    ]
    speeds = np.array([trial.forward_velocity for trial in trials])
    torque = max(np.abs(trial.joint_torque[trial.time > KICK]).max() for trial in trials)
    share = max(trial.utilization for trial in trials)
    error = f"Table 1 {mape(MEASURED, speeds):.1f} %"
    motor = f"{torque:.1f} N m, {share:.0%} of the servo"
    report(f"{name}: {error}, {motor}", model, speeds, 1.0 / joints.position_gain)


def report(title: str, model: Model, speeds: np.ndarray, lag: float) -> None:
    """Print what the fin brings, Table 2 by lag, and the powers."""
    print(f"\n{title}")
    print("  fin gain, Table 1:", describe_gains(gains(speeds), gains(MEASURED)))
    trials = follow(model, LOOP_DELAY)
    report_table_2(trials, f"{LOOP_DELAY:.3f} s, committed", LOOP_DELAY + lag)
    for power in powers(model, trials):
        numbers = ", ".join(f"{number:.3g}" for number in power["numbers"])
        idle = "with idle" if power["idle"] else "as printed"
        errors = f"{power['error']:.1f} %, a row left out {power['left_out']:.1f} %"
        print(f"  power {idle}, {power['name']}: {errors}; {numbers}")
    for whole_lag in LAGS:
        delay = whole_lag - lag
        if delay >= 0.0:
            report_table_2(follow(model, delay), f"{delay:.3f} s", whole_lag)


def report_table_2(trials: Sequence[Trial], delay: str, lag: float) -> None:
    result = table_2(trials)
    bias = " ".join(f"{bias_of_group:+.0f}" for bias_of_group in result["bias"])
    print(
        f"  Table 2, delay {delay}, lag {lag:.2f} s: {result['error']:.1f} % ({bias}), "
        f"{result['converging']}/12 converge, fin gain {result['gains']}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--interval", action="store_true", help="write the interval of Table 1 and end"
    )
    parser.add_argument("--presets", action="store_true", help="judge the two presets and end")
    parser.add_argument("--only", default="", help="part of the names of the candidates")
    parser.add_argument(
        "--output", type=Path, help="JSON file of what came out, which the next run goes on with"
    )
    arguments = parser.parse_args()
    if arguments.interval:
        return interval()
    if arguments.presets:
        for name in PRESETS:
            report_preset(name)
        return None
    candidates = [candidate for candidate in CANDIDATES if arguments.only in candidate.name]
    results = judge_candidates(candidates, arguments.output)
    print(HEAD)
    for result in results:
        print(line(result))
    if len(candidates) < len(CANDIDATES):
        return None
    choices = choose(results)
    print()
    for choice, result in choices.items():
        print(f"{choice}: {line(result)}")
    drag_on_the_body = [result for result in results if result["name"].endswith("body")]
    report_candidate("Mamba's", choices["Mamba's"])
    report_candidate("shared", choices["shared"])
    report_candidate("drag on the body", choose(drag_on_the_body)["shared"])
    return None


def judge_candidates(candidates: Sequence[Candidate], output: Path | None) -> list[dict[str, Any]]:
    """Results of candidates; those that the file of output has are read from there, others are added to it."""
    known: dict[str, Any] = {}
    if output and output.exists():
        known = json.loads(output.read_text())
    errors_of_water: dict[tuple[str, str], dict[str, float]] = {}
    for candidate in candidates:
        if candidate.name in known:
            continue
        begin = time.process_time()
        water = (candidate.drag, candidate.mass)
        if water not in errors_of_water:
            errors_of_water[water] = on_amphibot(candidate)
        result = {**on_table_1(candidate), "amphibot": errors_of_water[water]}
        known[candidate.name] = result
        seconds = time.process_time() - begin
        print(f"{line(result)} [{seconds:.0f} s]", file=sys.stderr, flush=True)
        if output:
            output.write_text(json.dumps(known))
    return [known[candidate.name] for candidate in candidates]


if __name__ == "__main__":
    main()
