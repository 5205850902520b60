"""The presets that come with laticauda, and the loaders that take a preset's name or a path."""

from pathlib import Path
from typing import Any

from laticauda.errors import BadArgument
from laticauda.robot.environment import Ground, Water
from laticauda.robot.files import KINDS, find, from_toml, preset_names
from laticauda.robot.robot import Robot


def robot_names() -> tuple[str, ...]:
    """The names of the robot presets, sorted."""
    return preset_names("robot")


def water_names() -> tuple[str, ...]:
    """The names of the water presets, sorted."""
    return preset_names("water")


def ground_names() -> tuple[str, ...]:
    """The names of the ground presets, sorted."""
    return preset_names("ground")


def load_robot(name_or_path: str | Path, n_links: int | None = None) -> Robot:
    """Load a robot.

    Args:
        name_or_path: A preset's name (`robot_names` lists them), or the path of a TOML file.
        n_links: Number of links to have instead of the file's; only for robots whose modules and joints are all alike.

    Raises:
        RobotFileError: If there is no such robot (`RobotNotFound`), or its file is wrong.
        ValueError: If `n_links` cannot be had.

    Example:
        >>> load_robot("mamba").n_links
        9
        >>> load_robot("chain", n_links=12).n_joints
        11
    """
    robot: Robot = _load(name_or_path, "robot")
    return robot if n_links is None else robot.with_links(n_links)


def load_water(name_or_path: str | Path) -> Water:
    """Load water.

    Args:
        name_or_path: A preset's name (`water_names` lists them), or the path of a TOML file.

    Raises:
        RobotFileError: If there is no such water (`RobotNotFound`), or its file is wrong.

    Example:
        >>> load_water("paper-lateral").normal_drag
        1.75
    """
    return _load(name_or_path, "water")


def load_ground(name_or_path: str | Path) -> Ground:
    """Load ground.

    Args:
        name_or_path: A preset's name (`ground_names` lists them), or the path of a TOML file.

    Raises:
        RobotFileError: If there is no such ground (`RobotNotFound`), or its file is wrong.
    """
    return _load(name_or_path, "ground")


def _load(name_or_path: object, kind: str) -> Any:
    if not isinstance(name_or_path, str | Path):
        raise BadArgument("name_or_path", f"must be a preset's name or a path, got {name_or_path!r}")
    kind_of: type[Any] = KINDS[kind]
    return from_toml(find(name_or_path, kind), kind_of)
