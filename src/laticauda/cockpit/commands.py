"""The same run elsewhere: a command line and Python that repeat what swims here, from straight and at rest."""

import math
import re
from dataclasses import MISSING, fields

from laticauda.cockpit.settings import GAIN, LOOK_AHEAD, MAX_OFFSET, Setting
from laticauda.control import StraightLine
from laticauda.gaits import Gait
from laticauda.robot import Robot, Water, load_robot, load_water, robot_names, water_names

DURATION = 30.0  # [s]
FILE, WATER_FILE = "robot.toml", "water.toml"  # of what is no preset


def robot_source(robot: Robot) -> str:
    """The preset that a robot is, or the name of a file that it has to be saved to first.

    Args:
        robot: What swims.
    """
    return next((name for name in robot_names() if load_robot(name) == robot), FILE)


def water_source(water: Water) -> str:
    """The preset that a water is, or the name of a file that it has to be saved to first.

    Args:
        water: Where it swims.
    """
    return next((name for name in water_names() if load_water(name) == water), WATER_FILE)


def command_line(setting: Setting) -> str:
    """The command that runs a setting.

    Args:
        setting: What swims how.
    """
    gait = setting.gait
    words = [f"laticauda {'swim' if setting.path is None else 'follow'} --robot {robot_source(setting.robot)}"]
    words.append(f"--gait {gait.kind.replace('_', '-')}")
    for flag, value in (
        ("amplitude-deg", gait.amplitude),
        ("frequency-deg-s", gait.frequency),
        ("phase-shift-deg", gait.phase_shift),
        ("offset-deg", gait.offset),
    ):
        words.append(f"--{flag} {_degrees(value)}")
    if gait.envelope is not None:
        words.append("--envelope " + " ".join(f"{value:g}" for value in gait.envelope))
    words += _waves(gait)
    if setting.water is not None:
        words.append(f"--water {water_source(setting.water)}")
    if any(setting.current):
        words.append("--current {:g} {:g}".format(*setting.current))
    words.append(f"--model {setting.model} --joints {setting.joints}")
    if setting.path is not None:
        words.append(
            "--waypoints " + " ".join(f"{value:.6g}" for point in _two_points(setting.path) for value in point)
        )
        words.append("--position 0 0")
    words.append(f"--duration {DURATION:g}")
    return " ".join(words)


def python_code(setting: Setting) -> str:
    """The script that runs a setting; its `trial` is the run.

    Args:
        setting: What swims how.
    """
    gait = setting.gait
    water = "default_water(gait)" if setting.water is None else repr(water_source(setting.water))
    lines = [
        "from dataclasses import replace",
        "import laticauda as lc",
        f"from laticauda.gaits import Gait{', Wave' if gait.pitch or gait.fin else ''}",
        "from laticauda.interfaces import Command, OpenLoop",
        "from laticauda.robot import load_water",
        "from laticauda.scenarios import default_water",
        "from laticauda.simulate import plant, run",
        "",
        f'robot = lc.load_robot("{robot_source(setting.robot)}")',
        *_gait_code(gait),
        f"water = replace(load_water({water}), current={setting.current!r})",
        f'body = plant(robot, water, model="{setting.model}", joints="{setting.joints}")',
    ]
    if setting.path is None:
        lines.append("controller = OpenLoop(command=Command(gait=gait))")
    else:
        lines.insert(2, "from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine")
        lines += [
            "controller = PathFollowing(",
            "    gait=gait,",
            f"    path={setting.path!r},",
            f"    guidance=LineOfSight(look_ahead_distance={LOOK_AHEAD}),",
            f"    heading=HeadingController(gain={GAIN}, max_offset={MAX_OFFSET!r}),",
            ")",
        ]
    lines += [f"trial = run(body, controller, {DURATION})", "print(trial.forward_velocity, trial.mean_power)"]
    return "\n".join(lines)


def commands_text(setting: Setting) -> str:
    """Both as Markdown.

    Args:
        setting: What swims how.
    """
    is_file = robot_source(setting.robot) == FILE
    note = f"This robot is no preset: download it as `{FILE}` first.\n\n" if is_file else ""
    is_file = setting.water is not None and water_source(setting.water) == WATER_FILE
    note += f"This water is no preset: download it as `{WATER_FILE}` first.\n\n" if is_file else ""
    return f"{note}```bash\n{folded(command_line(setting))}\n```\n```python\n{python_code(setting)}\n```"


def folded(command: str) -> str:
    """A command with a line per flag: the page's column is narrow."""
    return " \\\n  ".join(re.split(r" (?=--)", command))


def _waves(gait: Gait) -> list[str]:
    """The flags of a second wave and of a driven fin."""
    words: list[str] = []
    for name, wave in (("pitch", gait.pitch), ("fin", gait.fin)):
        if wave is not None:
            words += [
                f"--{name}-{flag} {_degrees(value)}"
                for flag, value in (
                    ("amplitude-deg", wave.amplitude),
                    ("phase-deg", wave.phase),
                    ("offset-deg", wave.offset),
                )
            ]
    if gait.fin is not None:
        words.append(f"--fin-frequency-deg-s {_degrees(gait.fin.frequency)}")
    return words


def _gait_code(gait: Gait) -> list[str]:
    """The lines that make it: a line per field that is not as usual."""
    usual = Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0, kind="lateral_undulation")
    lines = ["gait = Gait("]
    for field in fields(gait):
        value = getattr(gait, field.name)
        if field.init and (value != getattr(usual, field.name) or field.default is MISSING):
            lines.append(f"    {field.name}={value!r},")
    return [*lines, ")"]


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.10g}"


def _two_points(path: StraightLine) -> tuple[tuple[float, float], tuple[float, float]]:
    x, y = path.point
    return (x, y), (x + 10.0 * math.cos(path.angle), y + 10.0 * math.sin(path.angle))
