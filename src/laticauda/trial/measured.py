"""What the paper measured on the physical robot, to put beside a simulation of the same setting."""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

from laticauda.gaits import Gait
from laticauda.robot import Actuator, Ground, Robot, Water, load_robot
from laticauda.trial.trial import Trial

GAIT_WORDS = {"lateral_undulation": "lateral undulation", "eel_like": "eel-like motion"}
_KINDS = {"LU": "lateral_undulation", "EEL": "eel_like"}
_TOLERANCE = 1e-6  # of amplitude [rad], frequency [rad/s] and phase shift [rad]: the paper's are whole degrees
_MAMBA = ("mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin")
_FOLLOWING_AMPLITUDE_DEG = {"LU": 30.0, "EEL": 40.0}


@dataclass(frozen=True, kw_only=True)
class MeasuredTrial:
    """One setting of Table 1: 30 s from standstill, without steering.

    The table lists the best of each sweep, so its speeds are biased upward by selection.
    """

    gait: Gait
    """What the joints were asked for."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""
    forward_velocity: float | None
    """Equation (5); None where it was not available [m/s]."""
    mean_power: float | None
    """Electrical power above idle (4), not comparable with a mechanical power; None if not available [W]."""
    is_maximum: bool = False
    """Whether the table has a star here: the fastest of a sweep over amplitude, frequency or phase shift."""


@dataclass(frozen=True, kw_only=True)
class MeasuredPathFollowing:
    """One case of Table 2: line-of-sight path following along the x axis."""

    gait: Gait
    """What the joints were asked for, apart from the steering."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""
    case: int
    """Number of the case in the table, 1 to 3 [-]."""
    initial_cross_track_error: float
    """Initial distance of the center of mass from the path, as printed [m]."""
    initial_heading: float
    """Initial heading [rad]."""
    forward_velocity: float
    """Equation (5) [m/s]."""
    mean_power: float
    """Electrical power above idle (4) [W]."""


@cache
def efficiency_trials() -> tuple[MeasuredTrial, ...]:
    """Table 1 of the paper, in its order; settings that were not measured are left out."""
    return tuple(
        MeasuredTrial(
            gait=_gait(row["gait"], row["alpha_deg"], row["omega_deg_s"], row["delta_deg"]),
            has_fin=row["config"] == "fin",
            forward_velocity=_number(row["v_m_s"]),
            mean_power=_number(row["P_avg_W"]),
            is_maximum=row["maximum"] == "yes",
        )
        for row in _rows("table1.csv")
        if row["v_m_s"] or row["P_avg_W"]
    )


@cache
def path_following_trials() -> tuple[MeasuredPathFollowing, ...]:
    """Table 2 of the paper, in its order."""
    return tuple(
        MeasuredPathFollowing(
            gait=_gait(row["gait"], _FOLLOWING_AMPLITUDE_DEG[row["gait"]], 90.0, 40.0),
            has_fin=row["config"] == "fin",
            case=int(row["case"]),
            initial_cross_track_error=float(row["py0_m"]),
            initial_heading=math.radians(float(row["theta0_deg"])),
            forward_velocity=float(row["v_m_s"]),
            mean_power=float(row["P_avg_W"]),
        )
        for row in _rows("table2.csv")
    )


def group_name(gait: str, has_fin: bool) -> str:
    """What tables and files call one gait with one configuration of the robot.

    Args:
        gait: The gait's kind.
        has_fin: Whether the robot wears the caudal fin.
    """
    return f"{GAIT_WORDS[gait]}, {'with' if has_fin else 'without'} fin"


def measured_trial(gait: Gait, has_fin: bool) -> MeasuredTrial | None:
    """The paper's trial of Mamba with this gait, or None if it has none.

    Args:
        gait: Its kind, amplitude, frequency and phase shift must be the table's, to 1e-6; it must not steer.
        has_fin: Whether the robot wears the caudal fin.
    """
    same = (trial for trial in efficiency_trials() if trial.has_fin == has_fin and _alike(trial.gait, gait))
    return next(same, None)


def measured_setting(robot: Robot, gait: Gait | None, environment: Water | Ground) -> MeasuredTrial | None:
    """The paper's trial of a setting, or None: only Mamba in still water was measured, bare or with its fin.

    Args:
        robot: What swims: Mamba, whatever its name, if its body and fin are those of one of Mamba's presets. Numbers
            that models and fits give to the same machine are not compared: actuators, power, the fin's coefficients.
        gait: How, without steering; None has no counterpart.
        environment: In what.
    """
    if gait is None or isinstance(environment, Ground) or environment.current != (0.0, 0.0):
        return None
    machine = _machine(robot)
    is_mamba = any(machine == _machine(load_robot(name)) for name in _MAMBA)
    return measured_trial(gait, robot.caudal_fin is not None) if is_mamba else None


def measured_counterpart(trial: Trial) -> MeasuredTrial | None:
    """The paper's trial of the same setting, or None, as `measured_setting` says.

    Args:
        trial: A run.
    """
    return measured_setting(trial.robot, trial.gait, trial.environment)


def _machine(robot: Robot) -> Robot:
    """What a workshop would build: without name, words, and the numbers that models give to it."""
    fin = robot.caudal_fin
    if fin is not None:
        fin = replace(fin, tangential_friction=None, normal_drag=None, added_mass=None, n_strips=1)
    joints = tuple(replace(joint, actuator=Actuator()) for joint in robot.joints)
    named = replace(robot, name="machine", description="", joints=joints, caudal_fin=fin)
    return replace(named, electronics_power=0.0, active_power=None)


def _rows(table: str) -> Iterator[dict[str, str]]:
    text = files("laticauda.trial").joinpath("data", table).read_text(encoding="utf-8")
    return csv.DictReader(text.splitlines())


def _number(text: str) -> float | None:
    return float(text) if text else None


def _gait(kind: str, amplitude: str | float, frequency: str | float, phase_shift: str | float) -> Gait:
    """The gait of a row: degrees and degrees per second."""
    alpha, omega, delta = (math.radians(float(value)) for value in (amplitude, frequency, phase_shift))
    return Gait(kind=_KINDS[kind], amplitude=alpha, frequency=omega, phase_shift=delta)


def _alike(one: Gait, other: Gait) -> bool:
    names = ("amplitude", "frequency", "phase_shift", "offset")
    close = all(abs(getattr(one, name) - getattr(other, name)) <= _TOLERANCE for name in names)
    return one.kind == other.kind and one.pitch == other.pitch and one.fin == other.fin and close
