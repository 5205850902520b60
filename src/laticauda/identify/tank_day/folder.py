"""The folder of a tank day: files to fill in, and what they hold once they are filled in."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import laticauda as lc
from laticauda.identify.conversion import from_tow
from laticauda.identify.measurements import Measurement
from laticauda.identify.towing import Tow
from laticauda.robot import Robot, load_robot, read_table, textbook_water, to_toml
from laticauda.values import (
    RobotFileError,
    TrialFileError,
    codec,
    files,
    quantity,
    read_rows,
    value_class,
)

FILES = Path(__file__).parent.parent / "tank_day_files"
"""Folder of the files that every tank day begins with."""
DAY = "tank-day.toml"
"""Name of the file with robot and noise."""
RUNS = ("swim", "glide", "turn")
"""Names of the runs that are logged."""
_COLUMN_OF_LOAD = {"drag": "drag_n", "side_force": "side_force_n", "yaw_moment": "yaw_moment_n_m"}
"""Columns of the table of tows, by name of the load."""


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
    tows: tuple[Measurement, ...]
    """Measured loads."""


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
    n_joints = robot.planar().n_joints
    joint_columns = [f"joint_{i}_deg" for i in range(1, n_joints + 1)]
    columns = ["time_s", "x_m", "y_m", "yaw_deg", *joint_columns]
    header = ",".join(columns)
    contents: dict[str, str] = {}
    for file in sorted(FILES.iterdir()):
        contents[file.name] = file.read_text(encoding="utf-8")
    contents["robot.toml"] = to_toml(robot)
    for run in RUNS:
        contents[f"{run}.csv"] = f"{header}\n"
    files.local(folder).mkdir(parents=True, exist_ok=True)
    new_files = [name for name in contents if not (folder / name).exists()]
    for name in new_files:
        files.write(folder / name, contents[name])
    return new_files


def load_day(folder: Path) -> Day:
    """Read a filled-in folder.

    Args:
        folder: Folder made by `prepare_folder`; files that were not filled in are skipped.

    Raises:
        RobotFileError: If tank-day.toml or the robot is invalid.
        TrialFileError: If a log is invalid.
    """
    table = read_table(folder / DAY)
    with codec.keys_of(folder / DAY, RobotFileError):
        codec.take_kind(table, "tank-day")
        robot = load_robot(folder / table.pop("robot", "robot.toml"))
        noise = codec.decode(Noise, table)
    trials: dict[str, lc.Trial] = {}
    for run in RUNS:
        log = folder / f"{run}.csv"
        if _is_filled_in(log):
            trials[run] = lc.load_trial(log, folder / f"{run}.toml")
    tows = _load_tows(folder / "tows.csv", robot, noise)
    return Day(robot=robot, noise=noise, trials=trials, tows=tows)


def _is_filled_in(log: Path) -> bool:
    """Return whether a log holds more than its header."""
    return len(log.read_text(encoding="utf-8").splitlines()) > 1


def _load_tows(path: Path, robot: Robot, noise: Noise) -> tuple[Measurement, ...]:
    """Return the measured loads, one measurement for each row that holds some."""
    water = textbook_water(robot).water
    tows: list[Measurement] = []
    _, rows = read_rows(path, TrialFileError)
    for number, row in rows:
        try:
            loads = _loads_of(row)
            if not loads:
                continue
            tow = Tow(speed=float(row["speed_m_s"]), angle=math.radians(float(row["angle_deg"])))
            measurement = from_tow(
                robot,
                water,
                tow,
                loads,
                name=f"tow, row {number}",
                sigma=noise.force_n,
                share=noise.force_share,
                misalignment=math.radians(noise.angle_deg),
            )
        except KeyError as missing:
            raise TrialFileError(f"{path}: row 1: column {missing} is missing") from None
        except ValueError as error:
            raise TrialFileError(f"{path}: row {number}: {error}") from None
        tows.append(measurement)
    return tuple(tows)


def _loads_of(row: Mapping[str, str]) -> dict[str, float]:
    """Return the loads that a row of the table states."""
    return {name: float(row[column]) for name, column in _COLUMN_OF_LOAD.items() if row[column]}
