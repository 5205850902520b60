"""The same run elsewhere: a command line and Python that repeat what swims here, and buttons that copy them."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass, replace
from html import escape
from typing import Any

from laticauda.cockpit.changes import STILL, path_of
from laticauda.cockpit.controls import joints_name, model_name
from laticauda.gaits import Custom
from laticauda.robot import Robot, Water, load_robot, load_water, robot_names, water_names
from laticauda.scenarios import Scenario

DURATION = 30.0  # [s]
FILE, WATER_FILE = "robot.toml", "water.toml"  # of what is no preset
STYLE = (
    "font:inherit;font-size:0.875em;padding:0.3em 0.8em;margin:0 0.5em 0.3em 0;border:0;border-radius:2px;"
    "background:#1971c2;color:white;cursor:pointer"
)
# Browsers let a page write to the clipboard only if it comes from this computer, or by https; else by the old way.
SCRIPT = (
    "const t={text},b=this,s=b.textContent,done=()=>{{b.textContent='copied';setTimeout(()=>b.textContent=s,1200)}};"
    "if(navigator.clipboard)navigator.clipboard.writeText(t).then(done);"
    "else{{const a=document.createElement('textarea');a.value=t;document.body.append(a);a.select();"
    "document.execCommand('copy');a.remove();done()}}"
)


def robot_source(robot: Robot) -> str:
    """The preset that a robot is, or the name of a file that it has to be saved to first.

    Args:
        robot: What swims.
    """
    return next((name for name in robot_names() if load_robot(name) == robot), FILE)


def water_source(scenario: Scenario) -> str:
    """The preset that the water is but for its current, or the name of a file that it has to be saved to first.

    Args:
        scenario: What swims where.
    """
    water = scenario.environment
    assert isinstance(water, Water)
    still = replace(water, current=STILL)
    return next((name for name in water_names() if load_water(name) in (water, still)), WATER_FILE)


def command_line(scenario: Scenario) -> str:
    """The command that runs a scenario.

    Args:
        scenario: What swims how.
    """
    gait, path, water = scenario.gait, path_of(scenario), scenario.environment
    assert isinstance(water, Water)
    words = [f"laticauda {'swim' if path is None else 'follow'} --robot {robot_source(scenario.robot)}"]
    words.append(f"--gait {gait.kind.replace('_', '-')}")
    words += _angles("", gait, "amplitude", "frequency", "phase_shift", "offset")
    if isinstance(gait.envelope, Custom):
        words.append("--envelope " + " ".join(f"{value:g}" for value in gait.envelope.values))
    if gait.pitch is not None:
        words += _angles("pitch-", gait.pitch, "amplitude", "phase", "offset")
    if gait.fin is not None:
        words += _angles("fin-", gait.fin, "amplitude", "phase", "offset", "frequency")
    words.append(f"--water {water_source(scenario)} --current {water.current[0]:g} {water.current[1]:g}")
    words.append(f"--model {model_name(scenario)} --joints {joints_name(scenario)}")
    if path is not None:
        (x, y), (c, s) = path.point, (math.cos(path.angle), math.sin(path.angle))
        words.append(f"--waypoints {x:.6g} {y:.6g} {x + 10.0 * c:.6g} {y + 10.0 * s:.6g} --position 0 0")
    return " ".join([*words, f"--duration {DURATION:g}"])


def python_code(scenario: Scenario) -> str:
    """The script that runs a scenario; its `trial` is the run.

    Args:
        scenario: What swims how.
    """
    water = scenario.environment
    assert isinstance(water, Water)
    kinds = sorted({(type(one).__module__.split(".")[1], type(one).__name__) for one in _parts(scenario.motion)})
    return "\n".join(
        [
            "from dataclasses import replace",
            "import laticauda as lc",
            *(f"from laticauda.{package} import {name}" for package, name in kinds),
            "",
            f'robot = lc.load_robot("{robot_source(scenario.robot)}")',
            f'water = replace(lc.load_water("{water_source(scenario)}"), current={water.current!r})',
            f"motion = {_code(scenario.motion)}",
            "trial = lc.swim(",
            f"    robot, motion, {DURATION}, environment=water,",
            f'    model="{model_name(scenario)}", joints="{joints_name(scenario)}",',
            ")",
            "print(trial.forward_velocity, trial.mean_power)",
        ]
    )


def commands_text(scenario: Scenario) -> str:
    """Both as Markdown.

    Args:
        scenario: What swims how.
    """
    sources = {"robot": (robot_source(scenario.robot), FILE), "water": (water_source(scenario), WATER_FILE)}
    note = "".join(
        f"This {what} is no preset: download it as `{file}` first.\n\n"
        for what, (source, file) in sources.items()
        if source == file
    )
    return f"{note}```bash\n{folded(command_line(scenario))}\n```\n```python\n{python_code(scenario)}\n```"


def folded(command: str) -> str:
    """A command with a line per flag: the page's column is narrow."""
    return " \\\n  ".join(re.split(r" (?=--)", command))


def copy_buttons(texts: dict[str, str]) -> str:
    """Buttons, as HTML, that put a text on the clipboard of whoever looks at the page: the server cannot.

    Args:
        texts: What is copied, by what stands on its button.
    """
    return "<div style='padding:0.3em 0.8em'>" + "".join(map(_button, texts, texts.values())) + "</div>"


def _button(label: str, text: str) -> str:
    script = escape(SCRIPT.format(text=json.dumps(text)), quote=True)
    return f'<button type="button" style="{STYLE}" onclick="{script}">{escape(label)}</button>'


def _angles(prefix: str, wave: Any, *names: str) -> list[str]:
    """Flags of a wave, in degrees and degrees per second."""
    return [
        f"--{prefix}{name.replace('_', '-')}-{'deg-s' if name == 'frequency' else 'deg'} "
        f"{math.degrees(getattr(wave, name)):.10g}"
        for name in names
    ]


def _given(value: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not as usual."""
    return {
        field.name: getattr(value, field.name)
        for field in fields(value)
        if field.init and (field.default is MISSING or getattr(value, field.name) != field.default)
    }


def _parts(value: Any) -> Iterator[Any]:
    """A dataclass and those within it."""
    if is_dataclass(value):
        yield value
        for part in _given(value).values():
            yield from _parts(part)


def _code(value: Any, indent: str = "") -> str:
    """An expression that makes a value: a line per field."""
    if not is_dataclass(value):
        return repr(value)
    inner = indent + "    "
    lines = [f"{inner}{name}={_code(part, inner)},\n" for name, part in _given(value).items()]
    return f"{type(value).__name__}(\n{''.join(lines)}{indent})"
