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
from typing import Any

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
MEASURED = np.array([row.forward_velocity for row in ROWS])
GROUP_NAMES = tuple(dict.fromkeys(group_name(row.gait.kind, row.has_fin) for row in ROWS))
GROUP = np.array([GROUP_NAMES.index(group_name(row.gait.kind, row.has_fin)) for row in ROWS])
FOLLOWED = read_path_following_trials()
FOLLOWED_SPEED = np.array([row.forward_velocity for row in FOLLOWED])
FOLLOWED_GROUP = np.array(
    [GROUP_NAMES.index(group_name(row.gait.kind, row.has_fin)) for row in FOLLOWED]
)
LOOP_DELAY = 0.12  # committed beforehand: cameras, computer, bus, servo [s]
KICK = 2.0  # joints that torque does not limit start with a kick, which says nothing of power [s]
LAGS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8)  # from heading to joint, shown beside it [s]
FIN = {"tangential_friction": 0.005, "normal_drag": 2.0, "added_mass": 1.0}
FIN_AS_PLATE = {**FIN, "normal_drag": 1.2}
"""In textbook water: drag of a plate of .09 x .38 m; its law of the edge takes the span off the added mass."""
SERVO_POWER = (
    2.9 * 7.5
)  # stall torque x no-load speed of the published servo, which a gear keeps [W]
PRESETS = ("mamba-identified", "mamba-textbook")
BAND = math.radians(10.0)  # error at which a position loop asks for the whole speed
SPEEDS = (0.2, 7.5)  # rad/s
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
        actuator, joints = _drive(self.drive, speed)
        robots: dict[bool, Robot] = {}
        for has_fin in (False, True):
            robot = lc.load_robot("mamba-fin" if has_fin else "mamba")
            changes: dict[str, Any] = {"actuator": actuator}
            if has_fin:
                changes["caudal_fin"] = FIN_AS_PLATE if self.mass == "kirchhoff" else FIN
            robot = adjust(robot, changes)
            if self.place == "tail":
                robot = replace(robot, tether=Tether(drag=drag))
            elif self.place == "head":
                plate = {"lift_slope": 0.0, "stall_angle": math.pi / 2.0, "parasitic_drag": 1.0}
                own = PectoralFin(link=robot.n_links - 1, area=drag / 500.0, **plate)
                robot = replace(robot, pectoral_fins=(own,))
            robots[has_fin] = robot
        water = self.water(lc.load_robot("mamba"))
        water = replace(water, tangential_friction=drag) if self.place == "body" else water
        return Model(robots=robots, water=water, joints=joints)


def _drive(name: str, speed: float) -> tuple[dict[str, float], Any]:
    """The actuator and the joint law."""
    if name == "servo":
        return {"no_load_speed": speed, "stall_torque": SERVO_POWER / speed}, "servo"
    ratio = 200.0 / 2.9 if name == "speed-servo" else 7.5 / (1.5 * speed)
    of_motor = {"stall_torque": 2.9 * ratio}
    of_motor |= (
        {"stall_current": 4.6 * ratio} if name == "speed-servo" else {"no_load_speed": 1.5 * speed}
    )
    gain = 200.0 / speed if name == "speed-servo" else 2.9 * ratio / (0.1 * speed)
    return of_motor, lc.SpeedServo(speed_limit=speed, position_gain=speed / BAND, speed_gain=gain)


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
    laws = [model.joints for model in models]
    found: list[np.ndarray] = []
    for model, law in zip(models, laws, strict=True):  # a joint law's numbers are one set per batch
        robots = [model.robots[row.has_fin] for row in rows]
        batch = lc.swim_many(
            robots,
            [row.gait for row in rows],
            30.0,
            environments=model.water,
            joints=law,
            dt=0.004,
            threads=1,
        )
        found.append(np.maximum(np.where(batch.succeeded, batch.forward_velocity, 0.001), 0.001))
    return np.stack(found)


def fitted(
    candidate: Candidate, keep: np.ndarray, start: Numbers | None = None
) -> tuple[Numbers, bool]:
    """Least squares of log(simulated / measured) over the rows to keep; and whether a number is at an end."""
    rows, goal = [row for row, kept in zip(ROWS, keep, strict=True) if kept], np.log(MEASURED[keep])
    usual, *ends = PLACES[candidate.place]
    low, high = np.log(np.array([ends, SPEEDS])).T

    def logs(*points: np.ndarray) -> np.ndarray:
        return (
            np.log(forward_velocities([candidate.model(tuple(np.exp(x))) for x in points], rows))
            - goal
        )

    def slopes(x: np.ndarray) -> np.ndarray:
        here, *there = logs(x, *(x - 1e-3 * np.eye(2)))
        return (here - np.array(there)).T / 1e-3

    first = np.clip(np.log(start or (usual, 0.8)), low + 2e-3, high - 2e-3)
    found = least_squares(
        lambda x: logs(x)[0], first, slopes, bounds=(low, high), max_nfev=20, xtol=1e-4, ftol=1e-5
    )
    near = np.minimum(found.x - low, high - found.x) < 0.01 * (high - low)
    return (float(np.exp(found.x[0])), float(np.exp(found.x[1]))), bool(np.any(near))


def on_table_1(candidate: Candidate) -> dict[str, Any]:
    """Fit, the errors on Table 1, and by groups."""
    every = np.ones(len(ROWS), dtype=bool)
    numbers, at_an_end = fitted(candidate, every)
    speeds = forward_velocities([candidate.model(numbers)])[0]
    without, refits = np.empty_like(speeds), []
    for number in range(4):
        out = number == GROUP
        refits.append(fitted(candidate, ~out, numbers)[0])
        rows = [row for row, is_out in zip(ROWS, out, strict=True) if is_out]
        without[out] = forward_velocities([candidate.model(refits[-1])], rows)[0]
    return {
        "name": candidate.name,
        "numbers": numbers,
        "at_an_end": at_an_end or bool(np.any(speeds <= 0.001)),
        "speeds": speeds.tolist(),
        "error": mape(MEASURED, speeds),
        "by_groups": mape(MEASURED, without),
        "refits": refits,
        "gains": gain_ratios(speeds),
    }


def on_amphibot(candidate: Candidate) -> dict[str, float]:
    """Simulated over measured - 1 of run 1: two swims, two glides, the start."""
    real, found = (
        amphibot.measured(),
        amphibot.figures(amphibot.swum(candidate.water(lc.load_robot("amphibot")))),
    )
    return {name: found[name] / real[name] - 1.0 for name in real}


def swims_of(found: Mapping[str, float]) -> float:
    """The score on AmphiBot [%]."""
    return 50.0 * sum(abs(found[name]) for name in ("swim 1", "swim 2"))


# ---- what the fin brings -------------------------------------------------------------------------


def gains(speeds: np.ndarray) -> list[list[float]]:
    """v_fin / v_nofin of both gaits in Table 1, of every setting that was measured both ways."""
    return [
        [
            speeds[j] / speeds[i]
            for (i, bare), (j, fin) in itertools.product(enumerate(ROWS), enumerate(ROWS))
            if bare.gait == fin.gait and bare.gait.kind == kind and fin.has_fin and not bare.has_fin
        ]
        for kind in ("lateral_undulation", "eel_like")
    ]


def followed_gains(speeds: np.ndarray) -> list[list[float]]:
    """The same in Table 2, case by case."""
    return [
        [speeds[FOLLOWED_GROUP == a + 1][k] / speeds[FOLLOWED_GROUP == a][k] for k in range(3)]
        for a in (0, 2)
    ]


def gain_ratios(speeds: np.ndarray) -> list[float]:
    """Simulated over measured gain v_fin / v_nofin - 1 of both gaits, means over the settings."""
    pairs = zip(
        *(map(np.mean, of(s)) for of, s in ((gains, speeds), (gains, MEASURED))), strict=True
    )
    return [float((ours - 1.0) / (theirs - 1.0)) for ours, theirs in pairs]


def gains_in_words(simulated: list[list[float]], measured: list[list[float]]) -> str:
    """Both gains with the standard error of the measured mean, and their ratio."""
    found: list[str] = []
    for gait, ours, theirs in zip(("lateral", "eel-like"), simulated, measured, strict=True):
        here, there = np.mean(ours) - 1.0, np.mean(theirs) - 1.0
        error = np.std(theirs, ddof=1) / math.sqrt(len(theirs))
        found.append(f"{gait} {here:.2f} against {there:.2f} +- {error:.2f} ({here / there:.2f})")
    return "; ".join(found)


# ---- Table 2 and power ---------------------------------------------------------------------------


def follow(model: Model, delay: float) -> list[Trial]:
    """The cases of Table 2, without a steering filter."""
    settings = load_path_following_settings()
    found: list[Trial] = []
    for row in FOLLOWED:
        how = {"joints": model.joints, "offset_bandwidth": 1e6, "loop_delay": delay}
        body = build_plant(model.robots[row.has_fin], model.water, **how)
        controller = settings.controller(row.gait)
        start = lc.Start(
            center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading
        )
        there = lambda seen: bool(seen.center_of_mass[0] >= settings.distance)  # noqa: E731
        found.append(run(body, controller, settings.duration, start=start, until=there))
    return found


def table_2(trials: Sequence[Trial]) -> dict[str, Any]:
    """How far they are from what was measured, and how many converge."""
    runs = [figures_of(trial, load_path_following_settings().distance) for trial in trials]
    speeds = np.array([one.forward_velocity for one in runs])
    error = speeds / FOLLOWED_SPEED - 1.0
    return {
        "error": mape(FOLLOWED_SPEED, speeds),
        "bias": [100.0 * float(np.mean(error[g == FOLLOWED_GROUP])) for g in range(4)],
        "converging": sum(one.converged for one in runs),
        "gains": gains_in_words(followed_gains(speeds), followed_gains(FOLLOWED_SPEED)),
        "speeds": speeds.tolist(),
    }


def powers(model: Model, followed: Sequence[Trial]) -> list[dict[str, Any]]:
    """Electrical power of all 30 measured rows by one model each, no coefficient negative.

    The hypothesis: only the rows of Table 2 without the fin had the idle 41.3 W taken off, or had
    it twice.
    """
    first = [row for row in read_efficiency_trials() if row.mean_power is not None]
    trials = [
        lc.swim(model.robots[row.has_fin], row.gait, environment=model.water, joints=model.joints)
        for row in first
    ] + list(followed)
    measured = np.array([row.mean_power for row in (*first, *FOLLOWED)], dtype=float)
    bare = np.array([False] * len(first) + [not row.has_fin for row in FOLLOWED])

    def total(of: Callable[[Trial], np.ndarray]) -> np.ndarray:
        return np.array([np.sum(np.mean(of(t)[t.time > KICK], axis=0)) for t in trials])

    torque, rate = total(lambda t: t.joint_torque**2), total(lambda t: np.abs(t.joint_rate))
    one, work = np.ones_like(measured), total(lambda t: np.abs(t.joint_torque * t.joint_rate))
    columns = {
        "constant": [one],
        "constant + torque^2": [one, torque],
        "constant + mechanical": [one, work],
        "constant + torque^2 + |rate|": [one, torque, rate],
    }
    found: list[dict[str, Any]] = []
    for is_idle, (name, parts) in itertools.product((False, True), columns.items()):
        target = measured + (41.3 * bare if is_idle else 0.0)
        matrix = np.stack(parts, axis=1) / target[:, None]  # relative errors count
        numbers = nnls(matrix, one)[0]
        left = [
            float(matrix[i] @ nnls(np.delete(matrix, i, 0), one[1:])[0]) for i in range(len(target))
        ]
        error, out = (
            100.0 * float(np.mean(np.abs(says - 1.0)))
            for says in (matrix @ numbers, np.array(left))
        )
        found.append(
            {
                "name": name,
                "idle": is_idle,
                "numbers": numbers.tolist(),
                "error": error,
                "left_out": out,
            }
        )
    return found


# ---- the choice ----------------------------------------------------------------------------------


def chosen(results: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """By the rule of `identify_paper.md`, which knows nothing of Table 2."""
    allowed = [one for one in results if not one["at_an_end"]]
    least = min(one["by_groups"] for one in allowed)
    equal = [one for one in allowed if one["by_groups"] <= least + 0.5]
    return {
        "Mamba's": min(equal, key=lambda one: swims_of(one["amphibot"])),
        "shared": min(allowed, key=lambda one: max(one["by_groups"], swims_of(one["amphibot"]))),
        "by Mamba alone": min(allowed, key=lambda one: one["by_groups"]),
        "by AmphiBot alone": min(
            allowed, key=lambda one: (round(swims_of(one["amphibot"]), 6), one["by_groups"])
        ),
    }


def interval() -> None:
    """Every row of Table 1 in the textbook's water, into a file, beside nothing."""
    with (HERE / "identify_paper_interval.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(
            ("gait", "fin", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s", "low_m_s", "high_m_s")
        )
        for row in ROWS:
            robot = replace(
                lc.load_robot("mamba-fin" if row.has_fin else "mamba"), surface="skinned"
            )
            trial = lc.swim(robot, row.gait, environment=textbook_of(robot))
            low, high = figure_intervals(trial, intervals_of(trial.scenario))["forward_velocity"]
            angles = (
                math.degrees(getattr(row.gait, one))
                for one in ("amplitude", "frequency", "phase_shift")
            )
            speeds = (f"{v:.4f}" for v in (trial.forward_velocity, low, high))
            writer.writerow(
                (row.gait.kind, int(row.has_fin), *(f"{a:.0f}" for a in angles), *speeds)
            )


def line(one: Mapping[str, Any]) -> str:
    """A candidate's figures."""
    a, (drag, speed) = one["amphibot"], one["numbers"]
    amphi = " ".join(f"{100 * a[name]:+4.0f}" for name in a)
    gain = " ".join(f"{g:.2f}" for g in one["gains"])
    end = " (at an end of its range)" if one["at_an_end"] else ""
    errors = f"{one['error']:5.1f} {one['by_groups']:5.1f}  {gain}  {swims_of(a):5.1f} ({amphi})"
    return f"{one['name']:66s} {errors}  {drag:.3g}, {speed:.3g} rad/s{end}"


HEAD = f"{'':66s} Table 1, by groups, fin gain LU EEL, AmphiBot (swims, glides, start); drag, joint speed"


def report_candidate(candidate: Candidate, one: Mapping[str, Any], what: str) -> None:
    """What a chosen candidate says of Table 2 and of power."""
    drag, speed = one["numbers"]
    title = f"{what}: {candidate.name}, {drag:.4g}, {speed:.4g} rad/s"
    report(title, candidate.model((drag, speed)), np.array(one["speeds"]), BAND / speed)


def report_preset(name: str) -> None:
    """What a preset says of Table 1, of Table 2 and of power, with the numbers that ship."""
    known = lc.load_parameters(name)
    robots = {
        has_fin: known.robot(lc.load_robot(robot), "lateral_undulation")
        for has_fin, robot in ((False, "mamba"), (True, "mamba-fin"))
    }
    water = known.water("lateral_undulation")
    model = Model(robots=robots, water=water, joints=known.joints)
    trials = [
        lc.swim(robots[row.has_fin], row.gait, environment=water, joints=known.joints)
        for row in ROWS
    ]
    speeds = np.array([trial.forward_velocity for trial in trials])
    torque = max(np.abs(trial.joint_torque[trial.time > KICK]).max() for trial in trials)
    share = max(trial.utilization for trial in trials)
    error = f"Table 1 {mape(MEASURED, speeds):.1f} %"
    motor = f"{torque:.1f} N m, {share:.0%} of the servo"
    report(f"{name}: {error}, {motor}", model, speeds, 1.0 / known.joints.position_gain)


def report(title: str, model: Model, speeds: np.ndarray, lag: float) -> None:
    """Print what the fin brings, Table 2 by lag, and the powers."""
    print(f"\n{title}")
    print("  fin gain, Table 1:", gains_in_words(gains(speeds), gains(MEASURED)))
    for delay in (LOOP_DELAY, *(whole - lag for whole in LAGS if whole >= lag)):
        trials = follow(model, delay)
        found = table_2(trials)
        bias = " ".join(f"{b:+.0f}" for b in found["bias"])
        mark = ", committed" if delay == LOOP_DELAY else ""
        print(
            f"  Table 2, delay {delay:.3f} s{mark}, lag {delay + lag:.2f} s: {found['error']:.1f} % ({bias}), ",
            end="",
        )
        print(f"{found['converging']}/12 converge, fin gain {found['gains']}", flush=True)
        if delay == LOOP_DELAY:
            for power in powers(model, trials):
                numbers = ", ".join(f"{number:.3g}" for number in power["numbers"])
                idle = "with idle" if power["idle"] else "as printed"
                errors = f"{power['error']:.1f} %, a row left out {power['left_out']:.1f} %"
                print(f"  power {idle}, {power['name']}: {errors}; {numbers}")


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
    known: dict[str, Any] = {}
    if arguments.output and arguments.output.exists():
        known = json.loads(arguments.output.read_text())
    wanted = [candidate for candidate in CANDIDATES if arguments.only in candidate.name]
    abroad: dict[tuple[str, str], dict[str, float]] = {}
    for candidate in wanted:
        if candidate.name not in known:
            begin, water = time.process_time(), (candidate.drag, candidate.mass)
            abroad[water] = abroad.get(water) or on_amphibot(candidate)
            known[candidate.name] = {**on_table_1(candidate), "amphibot": abroad[water]}
            spent = time.process_time() - begin
            print(f"{line(known[candidate.name])} [{spent:.0f} s]", file=sys.stderr, flush=True)
            if arguments.output:
                arguments.output.write_text(json.dumps(known))
    results = [known[candidate.name] for candidate in wanted]
    print(HEAD)
    for one in results:
        print(line(one))
    if len(wanted) < len(CANDIDATES):
        return None
    found = chosen(results)
    print()
    for what, one in found.items():
        print(f"{what}: {line(one)}")
    found["drag on the body"] = chosen([one for one in results if one["name"].endswith("body")])[
        "shared"
    ]
    for what in ("Mamba's", "shared", "drag on the body"):
        report_candidate(
            next(one for one in CANDIDATES if one.name == found[what]["name"]), found[what], what
        )


if __name__ == "__main__":
    main()
