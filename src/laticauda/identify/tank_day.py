"""Tank day: files for about two hours of trials, and the robot's own water identified from them, with a verdict.

`begin` creates a folder with a list of runs, the robot, and files to fill in; `evaluate` fits its
contents. The joints follow their logged angles, so that only the water is fitted. Three laws of the
water are fitted to the same trials, each with free friction and with the other numbers near
tabulated ones for the robot's cross sections:

    kirchhoff   added mass of potential flow, shed at the tail end; quadratic drag, beta free
    relative    added mass without Munk moment and wake; quadratic drag, beta free
    linear      the same with linear and quadratic drag, U_ref free

They are compared by their probabilities given the data, in Laplace's approximation,

    ln p = -Q/2 + ln det(C)/2 - sum ln s + const.

with the sum of squares Q of data and priors, the covariance C of the unknowns and the standard
deviations s of their priors. If the best law leaves residuals of k > 1 times the stated noise, Q
and C are computed with k times that noise.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.identify import candidates, fitting, measurements, result
from laticauda.identify.unknowns import Unknown
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate.runner import Progress, silent
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.robot import Environment, Robot, Water, load_robot, textbook_water, to_toml
from laticauda.robot.files import read_table
from laticauda.values import codec, files, packaging
from laticauda.values.errors import RobotFileError, TrialFileError
from laticauda.values.optional import optional_import
from laticauda.values.quantities import quantity, value_class

FILES = Path(__file__).parent / "tank_day_files"
DAY = "tank-day.toml"
DECISIVE = 100.0
"""Odds above which a law counts as decided."""
HARDLY = 0.7
"""Fraction of the prior standard deviation above which the data count as uninformative."""
IDENTIFIED = "{value:.4g} ({low:.4g} to {high:.4g}) {unit}"
JOINTS = ("joints.speed_limit", "joints.position_gain")
_LOADS = {"drag": "drag_n", "side_force": "side_force_n", "yaw_moment": "yaw_moment_n_m"}
_RUNS = ("swim", "glide", "turn")
_INTERVAL = 0.25  # between samples that are used [s]
_SMOOTHED = 0.2  # window of a cubic smoothing of joint angles, in cycles: keeps their noise out of the forces [-]


@value_class
class Noise:
    """Standard deviations of the noise on the tank day."""

    path_m: float = quantity(
        "m", "Noise of the center of mass, as measured by the cameras", gt=0.0, default=0.005
    )
    heading_rad: float = quantity("rad", "Noise of the heading", gt=0.0, default=0.01)
    joint_angle_rad: float = quantity("rad", "Noise of joint angles", gt=0.0, default=0.01)
    force_n: float = quantity("N", "Noise of a force in a tow", gt=0.0, default=0.05)
    force_share: float = quantity("", "Noise of a force as a fraction of it", ge=0.0, default=0.02)
    angle_deg: float = quantity("deg", "Noise of the angle of a tow", ge=0.0, default=0.5)


@dataclass(frozen=True, kw_only=True, eq=False)
class Day:
    """Contents of a filled-in folder."""

    robot: Robot
    """The robot that swam."""
    noise: Noise
    """Noise of the measurements."""
    trials: Mapping[str, lc.Trial]
    """Logged trials, by name of the run."""
    tows: tuple[measurements.Measurement, ...]
    """Measured loads."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """Results of a tank day."""

    fits: Mapping[str, result.Fit]
    """Fits by law, most probable first."""
    odds: Mapping[str, float]
    """Odds of the most probable law against each law, at most 1e304 [-]."""
    numbers: tuple[Mapping[str, Any], ...]
    """Rows of name, value, ends of the interval (low, high) and unit, by the best law: numbers of the water, drag area
    2 F / (rho v^2) of the straight robot at the speed of the day, and joints; None for values not
    identified."""
    joints: result.Fit | None
    """Fit of the speed and stiffness of the joints (`JOINTS`); None if no gait was commanded."""
    verdict: tuple[str, ...]
    """Sentences on which law is the most probable, and on what the data do not determine."""


def prepare_folder(folder: Path, robot: Robot) -> list[str]:
    """Write the list of runs, the robot, and files to fill in; existing files are kept.

    Args:
        folder: Folder for the files; created if needed.
        robot: Robot that is going to swim.

    Returns:
        Names of the files that were written.

    Raises:
        StorageFailed: If a file cannot be written.
    """
    head = [
        "time_s",
        "x_m",
        "y_m",
        "yaw_deg",
        *(f"joint_{i}_deg" for i in range(1, robot.planar().n_joints + 1)),
    ]
    contents = {one.name: one.read_text(encoding="utf-8") for one in sorted(FILES.iterdir())}
    contents |= {"robot.toml": to_toml(robot)} | {
        f"{run}.csv": ",".join(head) + "\n" for run in _RUNS
    }
    files.local(folder).mkdir(parents=True, exist_ok=True)
    new = [name for name in contents if not (folder / name).exists()]
    for name in new:
        files.write(folder / name, contents[name])
    return new


def load_day(folder: Path) -> Day:
    """Read a filled-in folder.

    Args:
        folder: Folder made by `begin`; files that were not filled in are skipped.

    Raises:
        RobotFileError: If tank-day.toml or the robot is invalid.
        TrialFileError: If a log is invalid.
    """
    table = read_table(folder / DAY)
    with codec.keys_of(folder / DAY, RobotFileError):
        codec.take_kind(table, "tank-day")
        robot, noise = (
            load_robot(folder / table.pop("robot", "robot.toml")),
            codec.decode(Noise, table),
        )
    names = [
        name
        for name in _RUNS
        if len((folder / f"{name}.csv").read_text(encoding="utf-8").splitlines()) > 1
    ]
    trials = {
        name: lc.load_trial(folder / f"{name}.csv", folder / f"{name}.toml") for name in names
    }
    return Day(
        robot=robot, noise=noise, trials=trials, tows=_tows(folder / "tows.csv", robot, noise)
    )


def _tows(path: Path, robot: Robot, noise: Noise) -> tuple[measurements.Measurement, ...]:
    water, found = textbook_water(robot).water, list[measurements.Measurement]()
    said: Any = {
        "sigma": noise.force_n,
        "share": noise.force_share,
        "misalignment": math.radians(noise.angle_deg),
    }
    for number, row in files.read_rows(path, TrialFileError)[1]:
        try:
            loads = {name: float(row[column]) for name, column in _LOADS.items() if row[column]}
            if loads:
                tow = measurements.Tow(
                    speed=float(row["speed_m_s"]), angle=math.radians(float(row["angle_deg"]))
                )
                found.append(
                    candidates.from_tow(robot, water, tow, loads, name=f"tow, row {number}", **said)
                )
        except KeyError as missing:
            raise TrialFileError(f"{path}: row 1: column {missing} is missing") from None
        except ValueError as error:
            raise TrialFileError(f"{path}: row {number}: {error}") from None
    return tuple(found)


def evaluate(day: Day, *, threads: int | None = None, progress: Progress = silent) -> Evaluation:
    """Fit the three laws to a tank day, and judge them.

    Args:
        day: Contents of the folder, from `load_day`.
        threads: Number of threads; None uses all cores available to this process.
        progress: Called with the finished fraction.

    Raises:
        TrialFileError: If nothing was measured.
        SimulationFailed: If a trial cannot be simulated.
    """
    measured = [_of_water(name, trial, day.noise) for name, trial in day.trials.items()] + [
        *day.tows
    ]
    if not measured:
        raise TrialFileError(
            "No file was filled in: the tank day needs swim.csv, glide.csv, turn.csv or tows.csv."
        )
    fits: dict[str, result.Fit] = {}
    for name, (water, unknowns) in _laws(day.robot).items():
        inside = [
            replace(one, scenario=replace(one.scenario, environment=water)) for one in measured
        ]
        fits[name] = fitting.fit(inside, parameters=unknowns, n_starts=1, threads=threads)
        progress(len(fits) / 4.0)
    scale = max(1.0, min(found.noise_factor for found in fits.values()))
    evidence = {name: _log_evidence(found, scale) for name, found in fits.items()}
    order = sorted(fits, key=lambda name: -evidence[name])
    best = fits[order[0]]
    odds = {name: math.exp(min(evidence[order[0]] - evidence[name], 700.0)) for name in order}
    speed = max([0.05, *(trial.forward_velocity for trial in day.trials.values())])
    joints = _joint_speed(day, best.problem.scenarios_at(best.best)[0].environment, threads)
    numbers = [row for k, row in enumerate(best.table()) if k in best.problem.of_interest]
    numbers += [_drag_area(best, speed), *(joints.table() if joints else [])]
    verdict = _verdict(day, best, odds, joints)
    fits = {name: fits[name] for name in order}
    return Evaluation(
        fits=fits, odds=odds, numbers=tuple(numbers), joints=joints, verdict=tuple(verdict)
    )


def _measured(name: str, trial: lc.Trial, series: Mapping[str, float]) -> measurements.Measurement:
    every = max(1, round(_INTERVAL / float(np.median(np.diff(trial.time)))))
    return measurements.from_trial(trial, name=name, series=series, every=every)


def _of_water(name: str, trial: lc.Trial, noise: Noise) -> measurements.Measurement:
    """Return path and heading of a trial as a measurement whose joints follow their logged angles."""
    seen = _measured(name, trial, {"center_of_mass": noise.path_m, "heading": noise.heading_rad})
    signal = optional_import("The tank day", "scipy", "identify", "scipy.signal")
    step = float(np.median(np.diff(trial.time)))
    width = 2 * max(2, round(_SMOOTHED * (trial.period or 0.0) / step / 2.0)) + 1
    smooth = signal.savgol_filter(
        trial.joint_angle, min(width, (trial.time.size - 1) // 2 * 2 - 1), 3, axis=0
    )
    angles = JointAngles(
        time=tuple((trial.time - trial.time[0]).tolist()),
        angle=tuple(map(tuple, smooth.T.tolist())),
    )
    return replace(seen, scenario=replace(seen.scenario, motion=recorded_gait(angles)))


def _laws(robot: Robot) -> dict[str, tuple[Water, list[Unknown]]]:
    """Return a water and its unknowns by name of the law."""
    book = textbook_water(robot)
    shared = [Unknown(name="water.tangential_friction")]
    for name in ("water.normal_drag", "water.added_mass"):
        low, high = book.intervals[name]
        shared.append(Unknown(name=name, prior=(0.5 * (low + high), 0.5 * (high - low))))
    beta = Unknown(
        name="water.drag.beta", start=0.5, prior=(0.5, 0.5), lower=0.0, upper=1.0, scale="linear"
    )
    slow = Unknown(
        name="water.drag.reference_speed", start=0.5, prior=(0.5, 0.5), lower=0.0, scale="linear"
    )
    still = replace(
        book.water, added_mass_form="relative", trailing_edge="none", rotational="paper"
    )
    return {
        "kirchhoff": (book.water, [*shared, beta]),
        "relative": (still, [*shared, beta]),
        "linear": (replace(still, drag=lc.PolynomialDrag()), [*shared, slow]),
    }


def _log_evidence(found: result.Fit, scale: float) -> float:
    """Return the log probability of the data, up to a constant that is the same for all laws."""
    problem = found.problem
    squares = found.chi2 + float(np.sum(problem.prior_residuals(found.best) ** 2))
    priors = [
        one.prior[1] / one.slope(v)
        for one, v in zip(problem.unknowns, found.best, strict=True)
        if one.prior
    ]
    volume = np.linalg.slogdet(
        np.where(np.isfinite(found.covariance), found.covariance, 0.0) * scale**2
    )[1]
    return -0.5 * squares / scale**2 + 0.5 * float(volume) - float(np.sum(np.log(priors)))


def _drag_area(found: result.Fit, speed: float) -> dict[str, Any]:
    """Return the drag area of the straight robot, with an interval derived from that of its friction."""
    scenario, friction = found.problem.scenarios_at(found.best)[0], found.table()[0]
    water: Any = scenario.environment

    def area(value: float | None) -> float | None:
        if value is None:
            return None
        plant = PlanarPlant(
            robot=scenario.robot, environment=replace(water, tangential_friction=value)
        )
        return -2.0 * plant.towing_load(speed)[0] / (water.density * speed**2)

    ends = {key: area(friction[key]) for key in ("value", "low", "high")}
    return {"name": f"drag area at {speed:.2g} m/s", **ends, "unit": "m^2"}


def _joint_speed(day: Day, water: Environment, threads: int | None) -> result.Fit | None:
    """Fit the speed limit of the joints to how they followed the commanded gaits in the identified water."""
    series = {"joint_angle": day.noise.joint_angle_rad}
    asked = {
        name: trial
        for name, trial in day.trials.items()
        if trial.gait is not None and trial.gait.amplitude
    }
    measured = [_measured(name, trial, series) for name, trial in asked.items()]
    measured = [replace(one, scenario=replace(one.scenario, environment=water)) for one in measured]
    if not measured:
        return None
    return fitting.fit(
        measured, parameters=JOINTS, joints=lc.SpeedServo(), n_starts=1, threads=threads
    )


def _verdict(
    day: Day, best: result.Fit, odds: Mapping[str, float], joints: result.Fit | None
) -> list[str]:
    """Return sentences on which law is the most probable, and on what the data do not determine."""
    name, *others = odds
    found = [f"The law is `{name}`, the most probable of {len(odds)}."]
    for other in others:
        how = "decided" if odds[other] > DECISIVE else "the data do not distinguish them"
        found.append(f"Against `{other}`: odds of {odds[other]:.3g} to 1, {how}.")
    found += [warning for warning in best.warnings if warning.startswith("chi^2")]
    for k in best.problem.of_interest:
        one, prior = best.estimates[k], best.problem.unknowns[k].prior
        if one.sigma is None or (prior and one.sigma > HARDLY * prior[1]):
            found.append(
                f"The data hardly determine `{one.name}`: it is essentially its prior, from tables."
            )
    if joints is None or joints[JOINTS[0]].interval is None:
        found.append(
            "The data do not determine the speed of the joints: no commanded gait was too fast for them."
        )
    missing = [run for run in _RUNS if run not in day.trials] + ([] if day.tows else ["tows"])
    return [
        *found,
        *(
            f"Without {run}.csv the data tell less: RUNS.md explains what it is for."
            for run in missing
        ),
    ]


def format_evaluation(found: Evaluation) -> str:
    """Format an evaluation as readable text.

    Args:
        found: Evaluation from `evaluate`.
    """
    lines = [*found.verdict, "", f"With `{next(iter(found.fits))}`, and 95 % intervals:"]
    for row in found.numbers:
        said = "not identified" if row["value"] is None else IDENTIFIED.format(**row)
        lines.append(f"{row['name']:<30} {said}")
    return "\n".join(lines)


def write_result(folder: Path, day: Day, found: Evaluation) -> list[str]:
    """Write files that another lab can read: trials, robot, loads, parameter file and summary.

    Args:
        folder: Folder of the tank day; the files go to its subfolder `result`.
        day: Contents of the folder, from `load_day`.
        found: Evaluation from `evaluate`.

    Returns:
        Names of the files.

    Raises:
        StorageFailed: If they cannot be written.
    """
    place, best = folder / "result", next(iter(found.fits.values()))
    place.mkdir(exist_ok=True)
    for name, trial in day.trials.items():
        trial.save(place / f"{name}.nc")
    for name in (DAY, "robot.toml", "tows.csv"):
        files.write(place / name, (folder / name).read_bytes())
    kept = best.parameters("tank-day", f"{day.robot.name}, tank day")
    law = (
        None
        if found.joints is None
        else found.joints.problem.scenarios_at(found.joints.best)[0].model.joints
    )
    (kept if law is None else replace(kept, joints=law)).save(place / "parameters.toml")
    files.write(place / "summary.md", format_evaluation(found) + "\n")
    files.write(place / "summary.json", files.to_json(tabulate_evaluation(found)) + "\n")
    return sorted(one.name for one in place.iterdir())


def tabulate_evaluation(found: Evaluation) -> dict[str, Any]:
    """Return an evaluation as plain values.

    Args:
        found: Evaluation from `evaluate`.
    """
    laws = {
        name: {
            "odds_against": found.odds[name],
            "chi2": one.chi2,
            "numbers": one.problem.observed.size,
        }
        | {"parameters": [row for k, row in enumerate(one.table()) if k in one.problem.of_interest]}
        for name, one in found.fits.items()
    }
    return {
        "laws": laws,
        "numbers": [*found.numbers],
        "verdict": [*found.verdict],
        "version": packaging.__version__,
    }
