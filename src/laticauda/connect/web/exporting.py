"""Export of a web page without a server: a folder of files with which robots swim in any browser.

The kernels that `laticauda.swim` runs are compiled to WebAssembly; everything that differs between
robots, and the descriptions of the sliders, is data.
"""

import base64
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import cycle
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

import laticauda as lc
from laticauda import control, robot, scenarios
from laticauda.connect.native import entry, platforms
from laticauda.connect.native.tables import Variable, tables_of
from laticauda.connect.web import steering
from laticauda.control.guidance import ROUNDING
from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.motion import gaits
from laticauda.motion.gaits.gait import FIRST_GAIT
from laticauda.robot import kinematics
from laticauda.values import codec, extensions, files
from laticauda.values.quantities import fields_of, hints_of

ROBOTS = ("mamba", "mamba-fin", "mamba-modules-fin", "amphibot", "tendon-fish")
"""Presets that a page contains by default."""
MOTION = rows.ANGLE, rows.RATE

LIMITS: Mapping[str, Mapping[str, Any]] = {
    "gait": {  # the paper's sweeps and some more
        "amplitude": [0.0, 60.0, 1.0],
        "frequency": [0.0, 220.0, 5.0],
        "phase_shift": [-90.0, 90.0, 1.0],
        "offset": [-20.0, 20.0, 0.5],
    },
    "fin": {
        "flexural_rigidity": [0.02, 1.0, 0.01],
    },
    "water": {
        "tangential_friction": [0.0, 1.0, 0.005],
        "normal_drag": [0.0, 4.0, 0.05],
        "added_mass": [0.0, 3.0, 0.05],
    },
    "current": {
        "x": [-0.3, 0.3, 0.005],
        "y": [-0.3, 0.3, 0.005],
    },
    "path": {
        "look_ahead_distance": [0.05, 3.0, 0.01],
        "integral_gain": [0.0, 0.5, 0.01],
        "gain": [0.05, 1.5, 0.05],
        "max_offset": [1.0, 30.0, 1.0],
    },
}
"""Least and greatest value and step of the sliders of a page, by group; angles in degrees."""
WATER = LIMITS["water"]
WORKS = {
    "mechanical_work": "work_absolute",
    "net_work": "work_net",
    "positive_work": "work_positive",
}
LOGGED = ("time", "center", "heading", "link", "joint", "fin_", *WORKS, "electrical_work")
"""Prefixes of the names of variables that a trial also contains."""
ELASTIC: Any = {"n_hinges": 3, "flexural_rigidity": 0.2}
"""Number of hinges and flexural rigidity of an elastic fin [-], [N m^2]."""
SIZES = {"small": 0.8, "large": 1.25}
"""Factors by which the lengths of a rigid fin are multiplied; its thickness stays the same."""


def export_web(
    folder: str | os.PathLike[str], robots: Sequence[str | lc.Robot] = ()
) -> tuple[Path, ...]:
    """Write a web page on which robots swim without a server; its `index.html` can also be opened from disk.

    Args:
        folder: Output folder; the files of an older page in it are replaced.
        robots: Robots to choose from, the first one initially selected: presets, files or robots.
            None: `ROBOTS`.

    Returns:
        Paths of the files.

    Raises:
        RobotFileError: If there is no robot with a given name.
        MissingExtra: If the package `ziglang`, which links WebAssembly, is not installed.
    """
    place = files.local(folder)
    entries = [_entry(one) for one in robots or ROBOTS]
    plants = {fin["law"]: fin.pop("plant") for one in entries for fin in one["fins"].values()}
    browser = platforms.platform_of("wasm32")
    made = {
        law: platforms.linked(platforms.object_codes(one, [browser])[0], browser)
        for law, one in plants.items()
    }
    steer = platforms.emitted(steering.bitcode(), browser)
    made["steering"] = platforms.linked(steer, browser, name=steering.NAME)
    kernels = {name: base64.b64encode(one).decode() for name, one in made.items()}
    data = {
        "version": lc.__version__,
        "interval": lc.Following().interval,  # also the sample interval
        "choices": {
            name: get_args(hints_of(lc.Following)[name])
            for name in ("guidance", "heading_estimate")
        },
        "steering": {
            "numbers": steering.NUMBERS,
            "results": steering.RESULTS,
            "rounding": ROUNDING,
        },
        "sliders": _sliders(),
        "robots": entries,
    }
    content = {
        path.name: path.read_text("utf-8") for path in Path(__file__).with_name("page").iterdir()
    }
    content["kernels.js"] = f"const KERNELS = {json.dumps(kernels)};\n"
    content["robots.js"] = (
        f"const PAGE = {json.dumps(data, separators=(',', ':'), ensure_ascii=False)};\n"
    )
    place.mkdir(parents=True, exist_ok=True)
    for name, text in content.items():
        files.write(place / name, text)
    return tuple(place / name for name in sorted(content))


# ---- data of a page ------------------------------------------------------------------------------


def _sliders() -> list[dict[str, Any]]:
    """Return all sliders in page order: group, kernel variable ("" for path following), flag, texts, limits."""
    of_water = dict.fromkeys(("water", "current"), lc.load_water("paper-lateral"))
    owners = {
        "gait": FIRST_GAIT,
        "fin": robot.CaudalFin(**ELASTIC),
        **of_water,
        "path": control.Following(),
    }
    return [
        _slider(group, owners[group], *one)
        for group, limited in LIMITS.items()
        for one in limited.items()
    ]


def _slider(group: str, owner: object, name: str, limits: Any) -> dict[str, Any]:
    """Return one slider, `name` in its group; the owner holds its initial value."""
    field_name, axis = name, ""
    if group == "current":
        field_name, axis = group, f" {name}"
    field = fields_of(type(owner))[field_name]
    current_value = getattr(owner, field_name)
    usual = 0.0
    if field.display.is_in_degrees:
        usual = round(field.display.from_si(current_value), 9)
    elif not axis:
        usual = current_value
    return {
        "group": group,
        "field": field_name,
        "variable": "" if group == "path" else f"{group}.{name}",
        "flag": (field_name + field.display.ending + axis).replace("_", "-").replace(" ", "-"),
        "label": field_name.replace("_", " ") + axis,
        "unit": field.unit.replace("rad", "°").replace("^2", "²"),
        "text": field.text,
        **dict(zip(("low", "high", "step"), limits, strict=True)),
        "factor": field.display.in_si_unit,
        "usual": usual,
    }


def _entry(given: str | lc.Robot) -> dict[str, Any]:
    """Return the data of a robot, or of what `load_robot` accepts, with each fin that it can have."""
    own = given if isinstance(given, lc.Robot) else lc.load_robot(given)
    fins, fin = {"rigid" if own.caudal_fin else "none": own}, own.caudal_fin
    if fin is not None and not fin.n_hinges and fin.joint is None:
        fins["elastic"] = replace(own, caudal_fin=replace(fin, **ELASTIC))
        for name, times in SIZES.items():
            sizes = {
                side: times * getattr(fin, side) for side in ("length", "height", "opening_length")
            }
            fins[name] = replace(own, caudal_fin=replace(fin, **sizes))
    return {
        "name": given if isinstance(given, str) else own.name,
        "title": own.description or own.name,
        "fins": {name: _body(one) for name, one in fins.items()},
    }


def _body(body: lc.Robot) -> dict[str, Any]:
    plant, none, one = (
        cast(PlanarPlant, lc.build_plant(one))
        for one in _in_waters(lc.build_scenario(body, FIRST_GAIT))
    )
    tables = tables_of(plant, FIRST_GAIT, lc.Start(), inputs="gait")
    number = {variable.name: i for i, variable in enumerate(tables.variables)}
    water = [number[f"water.{name}"] for name in WATER]
    ends, fin = kinematics.levers(plant.robot), plant.robot.caudal_fin
    bodies = [rows.HEADER_ROWS + i * rows.BODY_ROWS for i in range(1, plant.layout.n_bodies)]
    return {
        "plant": plant,
        "plate": {} if fin is None else codec.encode(fin),
        "law": extensions.name_of(type(plant.law)),
        "whole": tables.whole.tolist(),
        "real": tables.real.tolist(),
        "n_rows": tables.n_rows + entry.SCRATCH,
        "first": [variable.start for variable in tables.variables],
        "number": number,
        "columns": [
            [_column(one), i]
            for i, one in enumerate(tables.variables)
            if one.name.startswith(LOGGED)
        ],
        # The rows that are kept when the water's parameters change: all those that `Plant.pack`
        # keeps.
        "state": [
            *range(rows.TIME, rows.TIME + rows.LOG_STATE),
            *(b + row for b in bodies for row in MOTION),
        ],
        "angles": _angles(plant, number),
        "ends": ends.end.tolist(),
        "fin": ends.fin.tolist(),
        "width": [module.section.half_width for module in plant.robot.modules],
        "limits": [joint.limit for joint in plant.robot.joints],
        "dt": none.dt,
        # Rate at which the drag stops each element, which limits the step: (p + q C) / (m + k C'),
        # C and C' variables.
        "slopes": [
            row
            for (p, m), (c, mass), of in zip(none.stopping(), one.stopping(), cycle(water[1::-1]))
            for row in np.stack(
                np.broadcast_arrays(p, c - p, of, m, mass - m, water[2]), axis=1
            ).tolist()
        ],
        "kinds": {kind: _kind(plant, kind) for kind in ("lateral_undulation", "eel_like")},
    }


def _in_waters(given: lc.Scenario) -> Iterator[lc.Scenario]:
    """Yield the scenario in its own water, then with all coefficients 0 and 1; in between, all is linear."""
    yield given
    for value in (0.0, 1.0):
        yield replace(
            given, environment=replace(cast(Any, given.environment), **dict.fromkeys(WATER, value))
        )


def _kind(plant: PlanarPlant, kind: str) -> dict[str, Any]:
    """Return the data of a kind of gait: its envelope, and the coefficients of the default water."""
    gait = replace(FIRST_GAIT, envelope=gaits.envelope_of(kind))
    water = scenarios.default_water(plant.robot, gait)
    coefficients = {f"water.{name}": getattr(water, name) for name in WATER}
    return {"envelope": gait.joint_envelope(plant.robot.n_links), "water": coefficients}


def _column(one: Variable) -> str:
    """Return the name of a variable's column in a trial's CSV file (`laticauda trial convert`)."""
    name = WORKS.get(one.name, one.name).replace("[", "_").replace("]", "").replace(".", "_")
    return f"{name} [{one.unit.replace('/s', ' s-1').replace('.', ' ')}]"


def _angles(plant: PlanarPlant, number: dict[str, int]) -> list[list[tuple[int, float]]]:
    """Return the variables and factors that sum to the angle of each fin piece, last one first, and each link."""
    tail, joints = [(number["link_angle[0]"], 1.0)], plant.robot.fin_joints
    n_pieces = kinematics.levers(plant.robot).end.shape[1] - plant.robot.n_links
    bends = [
        [(number[f"fin_angle[{k}]"], -1.0) for k in joints if k <= piece]
        for piece in range(n_pieces)
    ]
    links = ([(number[f"link_angle[{i}]"], 1.0)] for i in range(plant.robot.n_links))
    return [*(tail + bent for bent in reversed(bends)), *links]
