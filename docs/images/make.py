"""Draw the pictures of the docs that are not there yet; `make docs` does so.

    python docs/images/make.py                 # those that are missing
    python docs/images/make.py cockpit film    # these, by name

Pictures are not in the repository, but for those of the front pages (`KEPT_FILES`) and one that
shows a measurement of one computer on one day. The same code always gives the same files, apart
from the live page's: what a browser draws differs by some pixels. Where a program is missing that a
picture needs, a gray one that says so takes its place.
"""

import runpy
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians
from pathlib import Path
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch
from PIL import Image, ImageDraw

import laticauda as lc
from laticauda.cli import main as command
from laticauda.missions import (
    Conditions,
    Mission,
    change_scenario,
    draw_conditions,
    draw_map,
    draw_phases,
    film_mission,
    load_mission,
    run_mission,
)
from laticauda.models.spatial.scene import Shore
from laticauda.motion.gaits import envelope_of
from laticauda.paper.measured import (
    MeasuredPathFollowing,
    MeasuredTrial,
    read_efficiency_trials,
    read_path_following_trials,
)
from laticauda.paper.settings import load_path_following_settings
from laticauda.show.figures import save_figure, style, swim_sheet
from laticauda.show.pictures.camera import Film
from laticauda.show.pictures.render import write_still
from laticauda.show.reports.front import draw_front_sheet
from laticauda.studies import Optimization, optimize
from laticauda.trials.null_models import mape
from laticauda.values.errors import LaticaudaError
from laticauda.water.fluid.uniform import Uniform
from laticauda.water.fluid.waves import Waves

FOLDER = Path(__file__).parent
CAMPAIGNS = FOLDER.parent.parent / "campaigns"

# The blocks of path following: center, what it says, its equation or class; sizes in inches.
BLOCKS = {
    "path": (0.55, 1.55, "path", "nearest point"),
    "guidance": (1.95, 1.55, "guidance", "LOS (7), ILOS"),
    "heading": (3.35, 1.55, "heading law", "(8), clipped"),
    "generator": (4.75, 1.55, "reference generator", "gait (3), filter"),
    "robot": (6.45, 1.55, "robot in the water", "joints, body"),
    "estimate": (4.75, 0.55, "heading estimate", "(6) or its cycle mean"),
}
HALF_WIDTH = {"generator": 0.62, "robot": 0.6, "estimate": 0.68}
STILL_TIME = 15.4  # [s]
# Also in docs/how-to/spatial.md.
FILM = (
    "follow --robot mamba-modules-fin --gait eel-like --amplitude-deg 40 --frequency-deg-s 110 --phase-shift-deg 40 "
    "--position 0 0.6 --duration 9"
)
STREET = (
    "swim --robot mamba-fin --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40 "
    "--current street --duration 20"
)
HALF_HEIGHT, LEAST_HALF_WIDTH = 0.26, 0.45
# Measured against predicted speeds: gait and fin by color and shape.
GROUPS = {
    ("lateral_undulation", False): (style.BLUE, "o", "lateral undulation"),
    ("lateral_undulation", True): (style.BLUE, "^", "lateral undulation, fin"),
    ("eel_like", False): (style.ORANGE, "o", "eel-like"),
    ("eel_like", True): (style.ORANGE, "^", "eel-like, fin"),
}
PAPER = ("path", "guidance", "heading", "generator", "robot")


def half_width(name: str) -> float:
    """Of a block [in]."""
    return HALF_WIDTH.get(name, LEAST_HALF_WIDTH)


def arrow(
    ax: Axes, points: list[tuple[float, float]], label: str, at: tuple[float, float], **place: str
) -> None:
    """A line along the points with a head at its end, and a label."""
    ax.plot(*zip(*points, strict=True), color=style.INK, linewidth=0.8, solid_joinstyle="miter")
    ax.annotate(
        "",
        points[-1],
        points[-2],
        arrowprops={"arrowstyle": "-|>", "color": style.INK, "lw": 0.8, "shrinkB": 0},
    )
    ax.text(
        *at,
        label,
        fontsize=style.TICK,
        color=style.BLUE,
        **{"ha": "center", "va": "bottom", **place},
    )


def control_structure() -> Figure:
    """Path following as blocks, after the paper's Fig. 3."""
    figure = style.new_figure(7.16, 2.0)
    ax = figure.add_subplot()
    ax.set(xlim=(0.0, 7.16), ylim=(0.0, 2.0))
    ax.axis("off")
    for name, (x, y, words, below) in BLOCKS.items():
        half, color = half_width(name), style.ORANGE if name == "robot" else style.INK
        corner = (x - half, y - HALF_HEIGHT)
        ax.add_patch(
            FancyBboxPatch(
                corner,
                2.0 * half,
                2.0 * HALF_HEIGHT,
                boxstyle="round,pad=0,rounding_size=0.06",
                facecolor="white",
                edgecolor=color,
                linewidth=1.0,
            )
        )
        ax.text(x, y + 0.07, words, fontsize=style.TICK, color=style.INK, ha="center", va="center")
        ax.text(x, y - 0.11, below, fontsize=6.5, color=style.GRAY, ha="center", va="center")
    labels = ("$s, e, \\chi$", "$\\theta_{ref}$", "$\\phi_0$", "$\\phi_{ref}$")
    for (one, other), label in zip(pairwise(PAPER), labels, strict=True):
        begin, end = BLOCKS[one][0] + half_width(one), BLOCKS[other][0] - half_width(other)
        arrow(ax, [(begin, 1.55), (end, 1.55)], label, ((begin + end) / 2.0 - 0.03, 1.59))
    robot, estimate, heading, path = (
        BLOCKS[name][0] for name in ("robot", "estimate", "heading", "path")
    )
    low = 1.55 - HALF_HEIGHT
    arrow(
        ax,
        [(robot, low), (robot, 0.55), (estimate + half_width("estimate"), 0.55)],
        "$\\theta_i$",
        (5.93, 0.59),
    )
    arrow(
        ax,
        [(estimate - half_width("estimate"), 0.55), (heading, 0.55), (heading, low)],
        "$\\theta$",
        (3.7, 0.59),
    )
    arrow(
        ax, [(robot + 0.2, low), (robot + 0.2, 0.12), (path, 0.12), (path, low)], "$p$", (2.0, 0.16)
    )
    return figure


def swim_3d(path: Path) -> None:
    """Mamba with its fin in the water, of twice the size and then made smaller, which is smoother."""
    gait = lc.eel_like(amplitude=radians(48), frequency=radians(110), phase_shift=radians(40))
    trial = lc.swim(lc.load_robot("mamba-modules-fin"), gait, duration=18.0)
    write_still(trial, path, Film(size=(1920, 1080)), time=STILL_TIME)
    Image.open(path).resize((896, 504), Image.Resampling.LANCZOS).save(path, optimize=True)


def fronts() -> Figure:
    """Speed against power, for both of the paper's gaits."""
    bounds = {
        "gait.amplitude": (radians(10), radians(50)),
        "gait.frequency": (radians(50), radians(150)),
        "gait.phase_shift": (radians(10), radians(60)),
    }
    found = []
    for kind in ("lateral_undulation", "eel_like"):
        gait = lc.Gait(envelope=envelope_of(kind), amplitude=0.5, frequency=2.0, phase_shift=0.7)
        found.append(
            optimize(
                Optimization(
                    scenario=lc.build_scenario("mamba", gait), bounds=bounds, beyond_actuators=True
                ),
                seed=1,
            )
        )
    return draw_front_sheet(found)


def identified() -> Figure:
    """Measured speeds of both tables against those of the preset `mamba-identified`."""
    parameters = lc.load_parameters("mamba-identified")
    settings = load_path_following_settings()

    def body(row: MeasuredTrial | MeasuredPathFollowing) -> lc.Plant[Any]:
        robot = parameters.robot(
            lc.load_robot("mamba-fin" if row.has_fin else "mamba"), row.gait.kind
        )
        loop = {
            "offset_bandwidth": 1e6,
            "loop_delay": 0.12,
        }  # as it was committed before Table 2 was run
        return lc.build_plant(
            robot, parameters.water(row.gait.kind), joints=parameters.joints, **loop
        )

    def followed(row: MeasuredPathFollowing) -> float:
        controller = settings.controller(row.gait)
        start = lc.Start(
            center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading
        )
        there = settings.distance
        trial = lc.run(
            body(row),
            controller,
            settings.duration,
            start=start,
            until=lambda seen: seen.center_of_mass[0] >= there,
        )
        return trial.forward_velocity

    first = [row for row in read_efficiency_trials() if row.forward_velocity is not None]
    second = read_path_following_trials()
    swum = [
        lc.run(body(row), lc.OpenLoop(command=lc.Command(gait=row.gait)), 30.0).forward_velocity
        for row in first
    ]
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.6)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, rows, says, title in (
        (panels[0], first, swum, "Table 1, fitted"),
        (panels[1], second, [followed(row) for row in second], "Table 2, not fitted"),
    ):
        ends = (0.06, 0.29)
        ax.fill_between(
            ends, [0.9 * v for v in ends], [1.1 * v for v in ends], color="#ECECEC", linewidth=0.0
        )
        ax.plot(ends, ends, color=style.GRAY, linewidth=style.THIN)
        for key, (color, marker, label) in GROUPS.items():
            points = [
                (row.forward_velocity, v)
                for row, v in zip(rows, says, strict=True)
                if (row.gait.kind, row.has_fin) == key
            ]
            face = color if key[1] else "white"
            ax.plot(
                *zip(*points, strict=True),
                marker,
                color=color,
                markerfacecolor=face,
                markersize=5.5,
                label=label,
            )
        style.style_axes(
            ax,
            xlabel="measured speed [m/s]",
            ylabel="predicted speed [m/s]" if ax is panels[0] else "",
        )
        ax.set(xlim=ends, ylim=ends, aspect="equal")
        error = mape(np.array([row.forward_velocity for row in rows]), np.array(says))
        ax.set_title(f"{title}: {error:.1f} %", fontsize=style.LABEL, color=style.INK)
    panels[0].legend(fontsize=style.TICK, frameon=False, loc="upper left")
    return figure


def smaller_still(trial: lc.Trial, path: Path, time: float) -> None:
    """A still of twice the size, made smaller, which is smoother."""
    write_still(trial, path, Film(size=(1680, 800)), time=time)
    Image.open(path).resize((840, 400), Image.Resampling.LANCZOS).save(path, optimize=True)


def three_dimensions(folder: Path) -> None:
    """A helix in the water, sidewinding on the ground, and from a shore into the water."""
    robot, water = lc.load_robot("mamba-modules"), lc.load_water("paper-lateral")
    yaw = lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(120), phase_shift=radians(40)
    )
    wave = lc.Wave(
        amplitude=radians(30), frequency=radians(120), phase_shift=radians(40), phase=radians(90)
    )
    helix = lc.swim(
        robot, replace(yaw, pitch=wave), 8.0, environment=water, model="spatial", gravity=False
    )
    smaller_still(helix, folder / "helix.png", 8.0)
    ground = lc.Ground(
        friction=lc.CoulombFriction(regularization_speed=1e-2), tangential=0.1, normal=0.5
    )
    sidewinding = replace(yaw, amplitude=radians(25), pitch=replace(wave, amplitude=radians(5)))
    bare = replace(ground, tangential=0.4, normal=0.4)
    smaller_still(
        lc.swim(robot, sidewinding, 6.0, environment=bare, model="spatial"),
        folder / "sidewinding.png",
        6.0,
    )
    plant = lc.build_plant(robot, water, model="spatial", scene=Shore(ground=ground))
    start = lc.Start(center_of_mass=(1.6, 0.0))
    smaller_still(
        lc.run(plant, lc.OpenLoop(command=lc.Command(gait=yaw)), 9.0, start=start),
        folder / "shore.png",
        7.0,
    )


def first_scenario() -> lc.Scenario:
    """What the cockpit starts with."""
    gait = lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
    )
    return lc.build_scenario("mamba-fin", gait, parameters="mamba-identified")


def cockpit_path(folder: Path) -> None:
    """The live page: following a path, with its plots."""
    from page import camera  # here alone: it needs a browser

    from laticauda.show.cockpit.changes import adapt_scenario

    plain = first_scenario()
    with camera(plain) as seen:
        seen.swim(adapt_scenario(plain, path=lc.StraightLine(point=(0.0, -0.6))), 40.0)
        seen.open("Plots")
        seen.look((-0.45, -2.1, 1.2), 0.3)
        seen.shoot(folder / "cockpit-path.png")


def cockpit(folder: Path) -> None:
    """The live page: the controls, and the map of the gaits."""
    from page import camera  # here alone: it needs a browser

    plain = first_scenario()
    with camera(plain) as seen:
        seen.cockpit.live.link_forces = True
        seen.swim(plain, 30.0)
        seen.open("Swim")
        seen.look((-0.45, -1.9, 1.1), 0.5)
        seen.shoot(folder / "cockpit.png")
        seen.cockpit.live.link_forces = False
        seen.open("Map")
        gaits = seen.cockpit._map
        gaits._on.value = True
        gaits.show()
        gaits._worker.join()
        gaits.show()
        seen.look((-0.45, -1.9, 1.1), 0.5)
        seen.shoot(folder / "cockpit-map.png")


def film(folder: Path, name: str = "follow", run: str = FILM) -> None:
    """The film of a run, as a picture that moves."""
    with tempfile.TemporaryDirectory() as scratch:
        whole = Path(scratch) / "film.mp4"
        if command([*run.split(), "--video", str(whole)]) != 0:
            raise SystemExit("the run of the film failed")
        shrink_film(whole, folder / f"{name}.webp")


def shrink_film(whole: Path, small: Path, width: int = 640) -> None:
    """Write a film as a picture that moves, with fewer pictures of fewer pixels."""
    words = ["ffmpeg", "-y", "-loglevel", "error", "-i", str(whole)]
    words += ["-vf", f"fps=12,scale={width}:-2:flags=lanczos"]
    words += ["-c:v", "libwebp_anim", "-quality", "65", "-compression_level", "4", "-loop", "0"]
    subprocess.run([*words, str(small)], check=True)


def swim(folder: Path) -> None:
    """A swim on one sheet."""
    gait = lc.lateral_undulation(
        amplitude=radians(30), frequency=radians(130), phase_shift=radians(40)
    )
    save_figure(swim_sheet(lc.swim(lc.load_robot("mamba"), gait)), folder / "swim.png")


def street(folder: Path) -> None:
    """A swim in a Karman street: its path over the field, and its film from above."""
    if command([*STREET.split(), "--plot", str(folder / "street.png")]) != 0:
        raise SystemExit("the run in the street failed")
    film(folder, "street", f"{STREET} --camera top --from 10")


def currents(folder: Path) -> None:
    """The errors of all guidance laws in all waters, from the stored answer of the campaign."""
    campaign = runpy.run_path(str(CAMPAIGNS / "currents.py"))
    campaign["figure"](campaign["stored"](), str(folder / "currents.png"))


def wake(folder: Path) -> None:
    """Two fish in line, and what the follower gains or loses, from the stored answer of the campaign."""
    sys.path.append(str(CAMPAIGNS))  # what it shares with others
    campaign = runpy.run_path(str(CAMPAIGNS / "wake.py"))
    campaign["draw"](campaign["read_table"](), str(folder / "wake.png"))


def parity(folder: Path) -> None:
    """The difference between both models, from the stored answer of the campaign."""
    campaign = runpy.run_path(str(CAMPAIGNS / "parity.py"))
    campaign["draw"](campaign["stored"](), str(folder / "parity.png"))


def edge_map(folder: Path) -> None:
    """The errors of two laws of the trailing edge against a vortex lattice."""
    campaign = runpy.run_path(str(CAMPAIGNS / "edge_map.py"))
    campaign["figure"](str(folder / "edge-map.png"))


def severed_lamprey(folder: Path) -> None:
    """Run the example, which writes its picture to the folder that it runs in."""
    example = FOLDER.parent.parent / "examples/27_severed_lamprey.py"
    subprocess.run([sys.executable, example], cwd=folder, check=True)


def mission(folder: Path) -> None:
    """Draw the phases of a mission, and film a run of it in which the sonar fails."""
    scenario = load_mission("net-inspection")
    save_figure(draw_phases(cast(Mission, scenario.motion)), folder / "mission-phases.png")
    conditions = Conditions(failing=("sonar",))
    draw = draw_conditions(conditions, 14)
    result = run_mission(change_scenario(scenario, conditions, draw))
    save_figure(draw_map(result), folder / "mission-map.png")
    with tempfile.TemporaryDirectory() as scratch:
        whole = Path(scratch) / "film.mp4"
        film_mission(result).save(whole)
        shrink_film(whole, folder / "mission.webp", width=800)


def net_pen(folder: Path) -> None:
    """Draw and film the mission of the tutorial on a net pen, in its tide and its waves."""
    page = (FOLDER.parent / "tutorials" / "net-pen.md").read_text(encoding="utf-8")
    _, _, after_title = page.partition('title="pen.toml"\n')
    content, _, _ = after_title.partition("```")
    with tempfile.TemporaryDirectory() as scratch:
        file = Path(scratch) / "pen.toml"
        file.write_text(content, encoding="utf-8")
        scenario = load_mission(file)
        sea = Uniform(v=0.11) + Waves(height=0.1, period=4.0, direction=2.0)
        water = replace(cast(lc.Water, scenario.environment), current=sea)
        result = run_mission(replace(scenario, environment=water))
        save_figure(draw_map(result), folder / "net-pen-map.png")
        whole = Path(scratch) / "film.mp4"
        film_mission(result).save(whole)
        shrink_film(whole, folder / "net-pen.webp", width=800)


@dataclass(frozen=True)
class Picture:
    """One or several files that are drawn together."""

    draw: Callable[[Path], object]
    """Draws them into a folder."""
    files: tuple[str, ...]
    """Their names."""


PICTURES = {
    "swim": Picture(swim, ("swim.png",)),
    "path-following": Picture(
        lambda folder: save_figure(control_structure(), folder / "path-following.png"),
        ("path-following.png",),
    ),
    "swim-3d": Picture(lambda folder: swim_3d(folder / "swim-3d.png"), ("swim-3d.png",)),
    "front": Picture(lambda folder: save_figure(fronts(), folder / "front.png"), ("front.png",)),
    "three-dimensions": Picture(three_dimensions, ("helix.png", "sidewinding.png", "shore.png")),
    "identified": Picture(
        lambda folder: save_figure(identified(), folder / "identified.png"), ("identified.png",)
    ),
    "cockpit-path": Picture(cockpit_path, ("cockpit-path.png",)),
    "cockpit": Picture(cockpit, ("cockpit.png", "cockpit-map.png")),
    "film": Picture(film, ("follow.webp",)),
    "street": Picture(street, ("street.png", "street.webp")),
    "currents": Picture(currents, ("currents.png",)),
    "wake": Picture(wake, ("wake.png",)),
    "edge-map": Picture(edge_map, ("edge-map.png",)),
    "parity": Picture(parity, ("parity.png",)),
    "severed-lamprey": Picture(severed_lamprey, ("severed-lamprey.png",)),
    "net-pen": Picture(net_pen, ("net-pen-map.png", "net-pen.webp")),
    "mission": Picture(mission, ("mission-phases.png", "mission-map.png", "mission.webp")),
}
KEPT_FILES = ("cockpit-path.png", "follow.webp")
"""Files of the front pages, which are in the repository."""
MADE_FILES = tuple(
    file for picture in PICTURES.values() for file in picture.files if file not in KEPT_FILES
)
"""Files that are made when the documentation is built."""


def draw_missing() -> None:
    """Draw the pictures of which a file is missing."""
    for name, picture in PICTURES.items():
        if all((FOLDER / file).exists() for file in picture.files):
            continue
        sys.stderr.write(f"{name} ...\n")
        with tempfile.TemporaryDirectory() as scratch:
            try:
                picture.draw(Path(scratch))
            except (LaticaudaError, OSError, ImportError, SystemExit) as error:
                sys.stderr.write(f"{name} cannot be drawn here: {error}\n")
            for file in picture.files:
                place_file(Path(scratch) / file)


def place_file(drawn: Path) -> None:
    """Put a drawn file into the folder unless it is there; a gray one if it could not be drawn."""
    target = FOLDER / drawn.name
    if target.exists():
        return
    if drawn.exists():
        shutil.copyfile(drawn, target)
        return
    gray = Image.new("RGB", (640, 120), "#D8D8D8")
    ImageDraw.Draw(gray).text((20, 50), f"{drawn.name}: not drawn on this computer", fill="black")
    gray.save(target)


if __name__ == "__main__":
    if sys.argv[1:]:
        for name in sys.argv[1:]:
            PICTURES[name].draw(FOLDER)
    else:
        draw_missing()
