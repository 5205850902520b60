"""Export of a web page without a server: a folder of files with which robots swim in any browser.

The kernels that `laticauda.swim` runs are compiled to WebAssembly; everything that differs between
robots, and the descriptions of the sliders, is data.
"""

import base64
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, get_args

import laticauda as lc
from laticauda.connect.native.linking import link_library
from laticauda.connect.native.machine_code import compile_kernels_of, compile_to_object
from laticauda.connect.native.platforms import find_platform
from laticauda.connect.web import steering
from laticauda.connect.web.robot_data import (
    RobotChoice,
    build_choice,
    describe_choice,
    name_of_kernels,
)
from laticauda.connect.web.sliders import list_sliders
from laticauda.control import ROUNDING
from laticauda.models.planar import PlanarPlant
from laticauda.sensing import Place
from laticauda.values import files, hints_of

ROBOTS = ("mamba-fin", "mamba", "mamba-modules-fin", "amphibot", "tendon-fish")
"""Presets that a page contains by default."""
PAGE_FOLDER = Path(__file__).with_name("page")
"""Files of a page that are the same for all robots."""
MILLIMETERS = 3
"""Decimals of outlines in m."""
FOLLOWING_CHOICES = ("guidance", "heading_estimate")
"""Fields of path following whose values are chosen from a list."""


def export_web(
    folder: str | os.PathLike[str],
    robots: Sequence[str | lc.Robot] = (),
    *,
    places: Sequence[Place] = (),
) -> tuple[Path, ...]:
    """Write a web page on which robots swim without a server; its `index.html` can also be opened from disk.

    Args:
        folder: Output folder; the files of an older page in it are replaced.
        robots: Robots to choose from, the first one initially selected: presets, files or robots.
            None: `ROBOTS`.
        places: Nets, pipes, walls, docks and buoys that are drawn in the water. Robots swim through
            them, as in the planar model.

    Returns:
        Paths of the files.

    Raises:
        RobotFileError: If there is no robot with a given name.
        MissingExtra: If the package `ziglang`, which links WebAssembly, is not installed.
    """
    output_folder = files.local(folder)
    choices = [build_choice(robot) for robot in robots or ROBOTS]
    kernels = json.dumps(_compile_modules(choices))
    data = json.dumps(_describe_page(choices, places), separators=(",", ":"), ensure_ascii=False)
    content: dict[str, str] = {}
    for path in PAGE_FOLDER.iterdir():
        content[path.name] = path.read_text("utf-8")
    content["kernels.js"] = f"const KERNELS = {kernels};\n"
    content["robots.js"] = f"const PAGE = {data};\n"
    output_folder.mkdir(parents=True, exist_ok=True)
    for name, text in content.items():
        files.write(output_folder / name, text)
    return tuple(output_folder / name for name in sorted(content))


def _compile_modules(choices: Sequence[RobotChoice]) -> dict[str, str]:
    """Return WebAssembly modules in base64: the kernels by their names, and the steering."""
    plants: dict[str, PlanarPlant] = {}
    for choice in choices:
        for plant in choice.plants.values():
            plants[name_of_kernels(plant)] = plant
    browser = find_platform("wasm32")
    modules: dict[str, bytes] = {}
    for name, plant in plants.items():
        codes = compile_kernels_of(plant, [browser])
        modules[name] = link_library(codes[0], browser)
    steering_code = compile_to_object(steering.compile_bitcode(), browser)
    modules["steering"] = link_library(steering_code, browser, name=steering.ENTRY_FUNCTION)
    return {name: base64.b64encode(module).decode() for name, module in modules.items()}


def _describe_page(choices: Sequence[RobotChoice], places: Sequence[Place]) -> dict[str, Any]:
    """Return all data of a page."""
    hints = hints_of(lc.Following)
    return {
        "version": lc.__version__,
        "interval": lc.Following().interval,  # also the sample interval
        "choices": {name: get_args(hints[name]) for name in FOLLOWING_CHOICES},
        "steering": {
            "numbers": steering.NUMBERS,
            "results": steering.RESULTS,
            "rounding": ROUNDING,
        },
        "sliders": list_sliders(),
        "robots": [describe_choice(choice) for choice in choices],
        "places": [_describe_place(place) for place in places if place.outlines()],
    }


def _describe_place(place: Place) -> dict[str, Any]:
    """Return the name of a place and its outlines in plan [m]."""
    outlines = [outline.round(MILLIMETERS).tolist() for outline in place.outlines()]
    return {"name": place.name, "outlines": outlines}
