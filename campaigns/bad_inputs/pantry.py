"""Good files: what commands read beside a bad input, and what is damaged. Made once, in a folder of its own."""

import contextlib
import io
import shutil
import warnings
from pathlib import Path

import numpy as np
from _jobs import OPERATION
from _program import recorded

import laticauda as lc
from laticauda.cli import main
from laticauda.film import write_example
from laticauda.robot.files import to_toml
from laticauda.trials import Trial

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
ROBOTS = ("mamba", "mamba-fin", "mamba-thruster")
LOG_NAMES = ["t", "x", "y", "yaw", *(f"phi {i}" for i in range(8)), "I"]
COLUMN_MAP = """
kind = "columns"
robot = "mamba"
longest_gap = 0.2
gait = {kind = "lateral-undulation", amplitude_deg = 30.0, frequency_deg_s = 130.0, phase_shift_deg = 40.0}
time = {column = "t", unit = "s"}
frame = {x = "x", y = "y", origin = [0.0, 0.0], rotation_deg = 0.0}
body = {link = 0, position = ["x", "y"], length_unit = "m", yaw = "yaw", angle_unit = "rad"}
joint_angle = {columns = "phi {}", unit = "rad"}
power = {current = "I", voltage = 35.0, idle = 41.3}
"""
TASK = """
kind = "identification"
name = "x"
title = "t"
joints = "prescribed"
noise = "estimated"
starts = 1
seed = 1
parameters = [{name = "water.tangential_friction", start = 0.15, lower = 0.03, upper = 0.5}]
table1 = {sigma = 0.05, selected_from = 1}
fixed = {water = {normal_drag = 1.75, added_mass = 1.5}, caudal_fin = {normal_drag = 2.0}}
"""
SPEEDS = """gait,alpha_deg,omega_deg_s,delta_deg,v_m_s,duration_s
LU,25,120,50,0.095,10
LU,30,120,50,0.105,10
LU,30,180,50,0.170,10
LU,35,180,50,0.185,10
LU,30,240,50,0.235,10
LU,30,180,40,0.200,10
"""
EEL = """
kind = "robot"
name = "eel"
description = "six modules"
modules = [{count = 6, length = 0.1, mass = 0.3, section = {half_height = 0.032, half_width = 0.03}}]
joints = [{count = 5, limit_deg = 70}]
caudal_fin = {length = 0.12, height = 0.08, thickness = 0.002, opening_length = 0.0}
"""
IDENTIFY = (
    "identify --table speeds.csv --robot eel.toml --starts 1 --threads 1 --quick --output fit "
    "--parameters water.tangential_friction"
)
FLOW = 'kind = "gridded"\nsource = "flow.nc"\n'
SWEEP = "sweep --duration 0.5 --vary amplitude-deg=10:60:50 --output swept"
SCENE = (
    '<mujoco><worldbody><geom name="b" type="box" size=".1 .1 .1" pos="3 0 0"/>'
    "</worldbody></mujoco>"
)
FORMATS = ("nc", "mcap", "parquet", "mat", "csv")
"""Endings of files of trials."""


ANIMAT = Path(__file__).parents[2] / "tests" / "data" / "farms" / "eel.sdf"
"""Bodies of an animat of FARMS."""


def fill_pantry(folder: Path) -> None:
    """Write the good files that take no time.

    Args:
        folder: Where.
    """
    trial = swim_trial(0.5)
    for ending in FORMATS:
        trial.save(folder / f"trial.{ending}")
    lc.save_scenario(trial.scenario, folder / "scenario.toml")
    for name in ROBOTS:
        (folder / f"{name}.toml").write_text(to_toml(lc.load_robot(name)))
    (folder / "water.toml").write_text(to_toml(lc.load_water("paper-lateral")))
    (folder / "points.csv").write_text("amplitude-deg\n10\n20\n")
    (folder / "good.csv").write_text("t,x\n0,1\n1,2\n")
    (folder / "log.csv").write_text(log_text(log_rows()))
    (folder / "map.toml").write_text(COLUMN_MAP)
    (folder / "task.toml").write_text(TASK)
    (folder / "speeds.csv").write_text(SPEEDS)
    (folder / "eel.toml").write_text(EEL)
    (folder / "operation.toml").write_text(OPERATION)
    (folder / "scene.xml").write_text(SCENE)
    _write_flow(folder / "flow.nc")
    (folder / "flow.toml").write_text(FLOW)
    source = Path(lc.__file__).parent / "robot" / "presets" / "parameters"
    shutil.copy(source / "mamba-identified.toml", folder / "parameters.toml")
    shutil.copy(ANIMAT, folder / "test_eel.sdf")
    (folder / "animat.yaml").write_text("sdf: test_eel.sdf\n")
    write_example(folder)


def fill_slow_pantry(folder: Path) -> None:
    """Write those that take seconds: a recording, and the folders of an identification and of a sweep.

    Args:
        folder: Where.
    """
    recorded(folder / "operated", 1.0)
    shutil.copy(folder / "operated" / "run.mcap", folder / "recording.mcap")
    with contextlib.chdir(folder), contextlib.redirect_stdout(io.StringIO()):
        with contextlib.redirect_stderr(io.StringIO()):
            assert main(SWEEP.split()) == 0
            assert main(IDENTIFY.split()) == 0


def swim_trial(duration: float) -> Trial:
    """Return a short trial of Mamba.

    Args:
        duration: Its duration [s].
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", lc.InfeasibleWarning)
        return lc.swim("mamba", GAIT, duration)


def log_rows() -> list[list[str]]:
    """Return the cells of a good log."""
    return [[f"{0.05 * k:.2f}", "0", "0", "0", *["0.1"] * 8, "1.5"] for k in range(40)]


def log_text(rows: list[list[str]]) -> str:
    """Return the text of a log.

    Args:
        rows: Its cells.
    """
    return "\n".join(map(",".join, [LOG_NAMES, *rows]))


def _write_flow(path: Path) -> None:
    """Write a current on a grid, which is still."""
    import xarray

    coordinates = {name: (name, np.linspace(-5.0, 5.0, 4)) for name in ("y", "x")}
    coordinates["time"] = ("time", np.array([0.0, 9.0]))
    axes = ("time", "y", "x")
    still = {name: (axes, np.zeros((2, 4, 4)), {"units": "m/s"}) for name in "uv"}
    xarray.Dataset(still, coords=coordinates).to_netcdf(str(path))


def lay_out(pantry: Path, words: tuple[str, ...]) -> None:
    """Copy the good files that are among these words into the working directory.

    Args:
        pantry: The folder of good files.
        words: What is typed.
    """
    for word in words:
        source = pantry / word
        if "/" in word or word in ("", ".", "..") or len(word) > 100:
            continue
        if source.is_dir():
            shutil.copytree(source, word)
        elif source.is_file():
            shutil.copy(source, word)
