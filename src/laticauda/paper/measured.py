"""What the paper measured on the physical robot, as printed: Tables 1 and 2, row by row.

The tables are the CSV files in `data`. A printed change due to the fin stands in the row with the
fin; `PrintedChange` recomputes it from the two rows, which is how misprints are found.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from laticauda.motion import gaits
from laticauda.robot import Actuator, Environment, Ground, Robot, load_robot
from laticauda.trials import MeasuredTrial, MeasuredTrials, measured, null_models
from laticauda.values import read_rows
from laticauda.values.packaging import renamed_names

PRINTED_TO = 0.02
"""Tolerance of printed changes, as they come from unrounded speeds [%]."""
DURATION = 30.0
"""Duration of the trials of Table 1 [s]."""
_TOLERANCE = 1e-6
"""Tolerance of gait parameters, as the paper's are whole degrees [rad, rad/s]."""
_COMPARED_PARAMETERS = ("amplitude", "frequency", "phase_shift", "offset")
FRESH_WATER = 1000.0
"""Density of the tank's water [kg/m^3]."""
DENSITY_TOLERANCE = 10.0
"""Densities of fresh water at any temperature differ by less; sea water has 25 more [kg/m^3]."""
_MAMBA_PRESETS = ("mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin")


# ---- rows ----------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Row(null_models.Row):
    """Common fields of the rows of both tables; the gait is the commanded one, without steering."""

    case: int
    """Number among the cases of the same gait with the same robot, from 1 [-]."""
    printed_velocity: float | None
    """Printed change of forward velocity due to the fin; None if there is none [%]."""
    printed_power: float | None
    """Printed change of power due to the fin; None if there is none [%]."""


@dataclass(frozen=True, kw_only=True)
class MeasuredCase(_Row, MeasuredTrial):
    """One case of Table 1, straight and from rest; more fields in `MeasuredTrial`."""

    starred: str | None
    """Parameter of which this is said to be the best value; None for other cases."""


@dataclass(frozen=True, kw_only=True)
class MeasuredPathFollowing(_Row):
    """One case of Table 2: line-of-sight path following along the x axis."""

    initial_cross_track_error: float
    """Initial distance of the center of mass from the path, as printed [m]."""
    initial_heading: float
    """Initial heading [rad]."""
    forward_velocity: float
    """Forward velocity by equation (5) [m/s]."""
    mean_power: float
    """Electrical power above idle by equation (4) [W]."""


MeasuredRow = MeasuredCase | MeasuredPathFollowing


# ---- changes due to the fin ----------------------------------------------------------------------


class PrintedAndRecomputed(NamedTuple):
    """A change due to the fin as the paper prints it, and as it follows from the table."""

    printed: float
    """Change as printed [%]."""
    recomputed: float
    """Change from the two rows [%]."""


@dataclass(frozen=True, kw_only=True)
class PrintedChange:
    """Changes due to the fin between two rows: as printed, and from the table's own numbers."""

    without: MeasuredRow
    """The row without the fin."""
    with_fin: MeasuredRow
    """The row with the fin."""

    @property
    def velocity(self) -> float | None:
        """Change of velocity, recomputed from the speeds; None if one is missing [%]."""
        return _known_change(self.without.forward_velocity, self.with_fin.forward_velocity)

    @property
    def power(self) -> float | None:
        """Change of power, recomputed from the electrical powers; None if one is missing [%]."""
        return _known_change(self.without.mean_power, self.with_fin.mean_power)

    @property
    def misprints(self) -> Mapping[str, PrintedAndRecomputed]:
        """Printed changes of velocity or power that do not follow from the table [%]."""
        row = self.with_fin
        misprints: dict[str, PrintedAndRecomputed] = {}
        for quantity, printed, recomputed in (
            ("velocity", row.printed_velocity, self.velocity),
            ("power", row.printed_power, self.power),
        ):
            if printed is None or recomputed is None:
                continue
            if abs(printed - recomputed) > PRINTED_TO:
                misprints[quantity] = PrintedAndRecomputed(printed, recomputed)
        return misprints


def find_printed_changes(rows: Sequence[MeasuredRow]) -> tuple[PrintedChange, ...]:
    """Return the changes due to the fin, for every row that has a counterpart without it.

    Args:
        rows: Rows of one table.
    """
    rows_without_fin = {(row.gait.kind, row.case): row for row in rows if not row.has_fin}
    changes: list[PrintedChange] = []
    for row in rows:
        counterpart = rows_without_fin.get((row.gait.kind, row.case))
        if row.has_fin and counterpart is not None:
            changes.append(PrintedChange(without=counterpart, with_fin=row))
    return tuple(changes)


def percent_change(before: float, after: float) -> float:
    """Return the relative increase of a value [%].

    Args:
        before: Initial value, not zero.
        after: Final value, in the same unit.
    """
    return 100.0 * (after / before - 1.0)


def _known_change(before: float | None, after: float | None) -> float | None:
    if before is None or after is None:
        return None
    return percent_change(before, after)


# ---- reading the tables --------------------------------------------------------------------------


@cache
def read_table1() -> tuple[MeasuredCase, ...]:
    """Return Table 1 of the paper, in its order, including settings that were not measured."""
    return tuple(_read_efficiency_row(cells) for cells in _read_cells("table1.csv"))


def _read_efficiency_row(cells: Mapping[str, str]) -> MeasuredCase:
    has_fin = cells["config"] != "nofin"
    robot = "mamba-fin" if has_fin else "mamba"
    configuration = "with" if has_fin else "without"
    return MeasuredCase(
        **_common_fields(cells),
        robot=robot,
        forward_velocity=_read_number(cells["v_m_s"]),
        mean_power=_read_number(cells["P_avg_W"]),
        starred=cells["fastest_over"] or None,
        is_maximum=bool(cells["fastest_over"]),
        duration=DURATION,
        source="the paper",
        about=f"Mamba {configuration} its fin in the tank, {DURATION:g} s "
        "from rest, the best of a sweep (Table 1 of the paper)",
    )


@cache
def read_efficiency_trials() -> tuple[MeasuredCase, ...]:
    """Return Table 1 of the paper, in its order, without settings that were not measured."""
    return tuple(
        row
        for row in read_table1()
        if row.forward_velocity is not None or row.mean_power is not None
    )


@cache
def read_path_following_trials() -> tuple[MeasuredPathFollowing, ...]:
    """Return Table 2 of the paper, in its order."""
    return tuple(_read_path_following_row(cells) for cells in _read_cells("table2.csv"))


def _read_path_following_row(cells: Mapping[str, str]) -> MeasuredPathFollowing:
    return MeasuredPathFollowing(
        **_common_fields(cells),
        initial_cross_track_error=float(cells["py0_m"]),
        initial_heading=math.radians(float(cells["theta0_deg"])),
        forward_velocity=float(cells["v_m_s"]),
        mean_power=float(cells["P_avg_W"]),
    )


def _read_cells(table: str) -> list[dict[str, str]]:
    """Return the cells of every row of a table, by column."""
    _, numbered_rows = read_rows(Path(__file__).parent / "data" / table)
    return [cells for _, cells in numbered_rows]


def _common_fields(cells: Mapping[str, str]) -> dict[str, Any]:
    """Return the fields of `_Row` from the cells of a row of either table."""
    gait = measured.gait_in_table(
        cells["gait"],
        float(cells["alpha_deg"]),
        float(cells["omega_deg_s"]),
        float(cells["delta_deg"]),
    )
    return {
        "gait": gait,
        "has_fin": cells["config"] == "fin",
        "case": int(cells["case"]),
        "printed_velocity": _read_number(cells["printed_v_percent"]),
        "printed_power": _read_number(cells["printed_P_percent"]),
    }


def _read_number(text: str) -> float | None:
    if not text:
        return None
    return float(text)


# ---- finding the row of a setting ----------------------------------------------------------------


class Table1(MeasuredTrials):
    """Table 1 of the paper: Mamba, bare or with its fin, from standstill in still water."""

    def trials(self) -> tuple[MeasuredTrial, ...]:
        """Return all rows of the table, in its order."""
        return read_table1()

    def counterpart(
        self, robot: Robot, gait: gaits.Gait, environment: Environment
    ) -> MeasuredTrial | None:
        """Return the row of a setting, or None if there is none.

        Args:
            robot: Robot that swims; it is Mamba, whatever its name, if its body and fin are those
                of one of Mamba's presets. Numbers that models and fits assign to the same machine
                are not compared: actuators, power, the fin's coefficients.
            gait: Gait without steering.
            environment: Environment of the trial: still water, as dense as the tank's. Its
                coefficients are a model's, and not compared.
        """
        if isinstance(environment, Ground) or environment.current != (0.0, 0.0):
            return None
        if abs(environment.density - FRESH_WATER) > DENSITY_TOLERANCE:
            return None
        if not _is_mamba(robot):
            return None
        return find_measured_trial(gait, robot.caudal_fin is not None)


def find_measured_trial(gait: gaits.Gait, has_fin: bool) -> MeasuredCase | None:
    """Return the paper's trial of Mamba with this gait, or None if there is none.

    Args:
        gait: Gait; its kind, amplitude, frequency and phase shift must be the table's, to 1e-6, and
            it must not steer.
        has_fin: Whether the robot has the caudal fin.
    """
    for trial in read_efficiency_trials():
        if trial.has_fin == has_fin and _is_same_gait(trial.gait, gait):
            return trial
    return None


def _is_same_gait(printed: gaits.Gait, gait: gaits.Gait) -> bool:
    for name in _COMPARED_PARAMETERS:
        if not abs(getattr(printed, name) - getattr(gait, name)) <= _TOLERANCE:
            return False
    if gait.recorded is not None:
        return False
    return printed.kind == gait.kind and printed.pitch == gait.pitch and printed.fin == gait.fin


def _is_mamba(robot: Robot) -> bool:
    machine = _as_built(robot)
    return any(machine == _as_built(load_robot(preset)) for preset in _MAMBA_PRESETS)


def _as_built(robot: Robot) -> Robot:
    """Return the robot as a workshop would build it, without what models assign to it."""
    fin = robot.caudal_fin
    if fin is not None:
        fin = replace(fin, tangential_friction=None, normal_drag=None, added_mass=None, n_strips=1)
    joints = tuple(replace(joint, actuator=Actuator()) for joint in robot.joints)
    return replace(
        robot,
        name="machine",
        description="",
        joints=joints,
        caudal_fin=fin,
        electronics_power=0.0,
        active_power=None,
    )


# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__,
    {
        "efficiency_trials": "read_efficiency_trials",
        "path_following_trials": "read_path_following_trials",
    },
)
