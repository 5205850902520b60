"""What the paper measured on the physical robot, to put beside a simulation of the same setting."""

import csv
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

from laticauda.gaits import Gait, envelope_of
from laticauda.robot import Actuator, Environment, Ground, Robot, load_robot
from laticauda.trial import MeasuredTrial, MeasuredTrials

_KINDS = {"LU": "lateral_undulation", "EEL": "eel_like"}
_TOLERANCE = 1e-6  # of amplitude [rad], frequency [rad/s] and phase shift [rad]: the paper's are whole degrees
DURATION = 30.0  # of the trials of Table 1 [s]
_MAMBA = ("mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin")
_FOLLOWING_AMPLITUDE_DEG = {"LU": 30.0, "EEL": 40.0}


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


class Table1(MeasuredTrials):
    """Table 1 of the paper: Mamba, bare or with its fin, from standstill in still water."""

    def trials(self) -> tuple[MeasuredTrial, ...]:
        """All rows of the table, in its order."""
        return _table1()

    def counterpart(self, robot: Robot, gait: Gait, environment: Environment) -> MeasuredTrial | None:
        """The row of a setting, or None.

        Args:
            robot: What swims: Mamba, whatever its name, if its body and fin are those of one of Mamba's presets.
                Numbers that models and fits give to the same machine are not compared: actuators, power, the fin's
                coefficients.
            gait: How, without steering.
            environment: In what.
        """
        if isinstance(environment, Ground) or environment.current != (0.0, 0.0):
            return None
        machine = _machine(robot)
        is_mamba = any(machine == _machine(load_robot(name)) for name in _MAMBA)
        return measured_trial(gait, robot.caudal_fin is not None) if is_mamba else None


@cache
def _table1() -> tuple[MeasuredTrial, ...]:
    rows = [(row, row["config"] == "fin") for row in _rows("table1.csv")]
    return tuple(
        MeasuredTrial(
            gait=_gait(row["gait"], row["alpha_deg"], row["omega_deg_s"], row["delta_deg"]),
            robot="mamba-fin" if has_fin else "mamba",
            has_fin=has_fin,
            forward_velocity=_number(row["v_m_s"]),
            mean_power=_number(row["P_avg_W"]),
            is_maximum=row["maximum"] == "yes",
            duration=DURATION,
            source="the paper",
            about=f"Mamba {'with' if has_fin else 'without'} its fin in the tank, {DURATION:g} s from rest, the best "
            "of a sweep (Table 1 of the paper)",
        )
        for row, has_fin in rows
    )


@cache
def efficiency_trials() -> tuple[MeasuredTrial, ...]:
    """Table 1 of the paper, in its order; settings that were not measured are left out."""
    return tuple(row for row in _table1() if row.forward_velocity is not None or row.mean_power is not None)


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


def measured_trial(gait: Gait, has_fin: bool) -> MeasuredTrial | None:
    """The paper's trial of Mamba with this gait, or None if it has none.

    Args:
        gait: Its kind, amplitude, frequency and phase shift must be the table's, to 1e-6; it must not steer.
        has_fin: Whether the robot wears the caudal fin.
    """
    same = (trial for trial in efficiency_trials() if trial.has_fin == has_fin and _alike(trial.gait, gait))
    return next(same, None)


def _machine(robot: Robot) -> Robot:
    """What a workshop would build: without name, words, and the numbers that models give to it."""
    fin = robot.caudal_fin
    if fin is not None:
        fin = replace(fin, tangential_friction=None, normal_drag=None, added_mass=None, n_strips=1)
    joints = tuple(replace(joint, actuator=Actuator()) for joint in robot.joints)
    named = replace(robot, name="machine", description="", joints=joints, caudal_fin=fin)
    return replace(named, electronics_power=0.0, active_power=None)


def _rows(table: str) -> Iterator[dict[str, str]]:
    text = files("laticauda.paper").joinpath("data", table).read_text(encoding="utf-8")
    return csv.DictReader(text.splitlines())


def _number(text: str) -> float | None:
    return float(text) if text else None


def _gait(kind: str, amplitude: str | float, frequency: str | float, phase_shift: str | float) -> Gait:
    """The gait of a row: degrees and degrees per second."""
    alpha, omega, delta = (math.radians(float(value)) for value in (amplitude, frequency, phase_shift))
    return Gait(envelope=envelope_of(_KINDS[kind]), amplitude=alpha, frequency=omega, phase_shift=delta)


def _alike(one: Gait, other: Gait) -> bool:
    names = ("amplitude", "frequency", "phase_shift", "offset")
    close = all(abs(getattr(one, name) - getattr(other, name)) <= _TOLERANCE for name in names)
    return one.kind == other.kind and one.pitch == other.pitch and one.fin == other.fin and close
