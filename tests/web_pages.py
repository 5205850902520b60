"""The page without a server: exported, run by node, and held against Python."""

import json
import random
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import numpy as np

import laticauda as lc
from laticauda.cli.follow import Follow
from laticauda.cli.swim import Swim
from laticauda.trials.logs.tabular import flatten_columns

NODE = shutil.which("node")
SCRIPT = Path(__file__).parent / "connect" / "web" / "trials.js"


def data_of(folder: Path) -> dict[str, Any]:
    """What the page knows of its robots and sliders."""
    return json.loads(
        (folder / "robots.js").read_text("utf-8").removeprefix("const PAGE = ").removesuffix(";\n")
    )


def some_links(folder: Path, count: int, seed: int) -> list[str]:
    """Settings by chance, as links; every other one follows a path."""
    page, chance = data_of(folder), random.Random(seed)
    return [_some_link(page, chance, follows=k % 2 == 1) for k in range(count)]


def _some_link(page: dict[str, Any], chance: random.Random, *, follows: bool) -> str:
    robot = chance.choice(page["robots"])
    said: dict[str, Any] = {"robot": robot["name"], "fin": chance.choice(list(robot["fins"]))}
    said["gait"] = chance.choice(["lateral_undulation", "eel_like"])
    for slider in page["sliders"]:
        low, high, step = (slider[name] for name in ("low", "high", "step"))
        if slider["flag"] == "amplitude-deg":
            high = 40.0  # or steering takes the joints beyond their limit
        if chance.random() < 0.6:
            said[slider["flag"]] = round(
                low + step * chance.randint(1, round((high - low) / step)), 9
            )
    if follows:
        said["waypoints"] = " ".join(str(round(chance.uniform(-2.0, 2.0), 2)) for _ in range(6))
        for name, choices in (("guidance", "guidance"), ("heading-estimate", "heading_estimate")):
            said[name] = chance.choice(page["choices"][choices])
    return urlencode(said)


def trials(folder: Path, links: list[str]) -> list[dict[str, Any]]:
    """What the page makes of links: trial, figures, and what it says."""
    assert NODE is not None
    done = subprocess.run(
        [NODE, SCRIPT, folder], input="\n".join(links), text=True, capture_output=True, check=True
    )
    return [json.loads(line) for line in done.stdout.splitlines()]


def by_python(text: str) -> lc.Scenario:
    """The scenario of a script in Python that the page shows."""
    space: dict[str, Any] = {}
    exec(text.partition("trial = ")[0], space)
    return space["scenario"]


def by_shell(text: str, folder: Path) -> lc.Scenario:
    """The scenario of a command line that the page shows, read by the program."""
    file, _, line = text.rpartition("END\n")
    if file:
        (folder / "robot.toml").write_text(file.partition("\n")[2])
        line = line.replace("robot.toml", str(folder / "robot.toml"))
    program, name, *words = shlex.split(line.replace("\\\n", " "))
    assert program == "laticauda"
    return {"swim": Swim, "follow": Follow}[name].read(words, name).scenario_to_run


def nameless(scenario: lc.Scenario) -> lc.Scenario:
    """Without what it is called."""
    robot, water = scenario.robot, scenario.environment
    return replace(
        scenario, robot=replace(robot, description=""), environment=replace(water, name="water")
    )


def difference(csv: str, trial: lc.Trial) -> float:
    """The largest difference between a page's table and a trial, as a share of the largest number, or of 1."""
    head, *lines = csv.splitlines()
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    there = {
        f"{name} [{unit}]": values for name, unit, values in flatten_columns(trial.to_dataset())
    }
    names = [
        name for name in head.split(",") if not name.startswith("fin_")
    ]  # these the trial calls otherwise
    assert set(names) <= set(there) and len(names) > 25
    shared = {name: table[:, i] for i, name in enumerate(head.split(",")) if name in there}
    sizes = {name: max(1.0, float(np.abs(there[name]).max())) for name in shared}
    return max(
        float(np.abs(values - there[name]).max()) / sizes[name] for name, values in shared.items()
    )
