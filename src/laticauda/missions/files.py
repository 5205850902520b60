"""Missions as files: scenarios whose controller is a mission; some come with the package."""

from pathlib import Path

from laticauda.missions.checking import check_mission
from laticauda.missions.running import mission_of
from laticauda.scenarios import Scenario, load_scenario
from laticauda.values import BadArgument, RobotFileError, codec, suggest_nearest

PRESETS = Path(__file__).parent / "presets"
"""Folder of the missions that come with the package."""


def list_missions() -> tuple[str, ...]:
    """Return the names of the missions that come with the package."""
    return tuple(sorted(path.stem for path in PRESETS.glob("*.toml")))


def load_mission(name: str | Path) -> Scenario:
    """Load a mission: a scenario whose controller is a mission.

    Args:
        name: Name of one that comes with the package, or path of a TOML file.

    Raises:
        RobotFileError: If the file cannot be read, or anything in it is wrong.
        ValueError: If there is no such mission, or something else steers.
    """
    path = Path(name)
    if path.suffix != ".toml":
        if str(name) not in list_missions():
            listed = ", ".join(f"`{known}`" for known in list_missions())
            hint = suggest_nearest(str(name), list_missions())
            raise BadArgument(
                "mission", f"must be {listed}, or a file *.toml, got {str(name)!r}{hint}"
            )
        path = PRESETS / f"{name}.toml"
    scenario = load_scenario(path)
    mission_of(scenario)
    with codec.keys_of(path, RobotFileError), codec.arguments_of(""):
        check_mission(scenario)
    return scenario
