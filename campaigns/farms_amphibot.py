"""The AmphiBot example of FARMS, read and swum here, beside FARMS's own equations and what its page says.

    python campaigns/farms_amphibot.py FOLDER           # run and print
    python campaigns/farms_amphibot.py FOLDER --write   # and store farms_amphibot.csv

FOLDER is examples/amphibot of github.com/podalanga/farmsim_docs, under the MIT license, commit
2c89a7b309b8 (2026); no file of it is in this repository. For the stored table,
models/amphibot.sdf and animat_config.yaml were retyped from their text, without what is only seen.
The tutorial "Swimming and buoyancy" says that the head moves about 0.56 m in the first 4 s, and
"Record, load and plot data" about 0.25 m/s in water, which the robot enters at about 0.3 m/s.

The second opinion uses no reader of laticauda: masses and joints are taken from the SDF file by
searching its text, and MuJoCo moves boxes of these masses by FARMS's oscillators, servos and drag.
"""

import argparse
import re
import warnings
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np
import yaml
from _rows import append_row, stored

import laticauda as lc
from laticauda.connect import FarmsAnimat, load_farms

TABLE = Path(__file__).with_suffix(".csv")
DURATION = 12.0
"""Of a run [s]."""
FIRST = 4.0
"""Time after which FARMS's page says how far the robot came [s]."""
DT = 1e-3
"""Time step of the second opinion [s]."""


@dataclass(frozen=True)
class Figure:
    """A figure by laticauda and by the second opinion."""

    name: str
    laticauda: float
    """Ours; nan if it is not computed."""
    second_opinion: float
    """That of the second opinion, likewise."""


def read_table() -> list[Figure]:
    """Return the stored figures."""
    return stored(TABLE, Figure)


# ---- second opinion ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Plain:
    """What is found in the text of the SDF file."""

    masses: list[float]
    """Of head and segments, head first [kg]."""
    places: list[float]
    """Along x, of their middles [m]."""
    anchor: float
    """Of every joint, in the frame of its rear link [m]."""
    half_size: list[float]
    """Of the box of every link [m]."""


def read_plain(text: str) -> Plain:
    """Return the masses and places of head and segments.

    Args:
        text: Text of the SDF file.
    """
    links = re.findall(r'<link name="(\w+)">(.*?)</link>', text, re.DOTALL)
    bodies = [content for name, content in links if not name.endswith("_wheel")]
    sizes = re.findall(r"<collision.*?<size>([^<]*)</size>", text, re.DOTALL)
    joint_pose = re.search(r"<joint name=\"joint1\".*?<pose>([^<]*)</pose>", text, re.DOTALL)
    assert joint_pose is not None
    return Plain(
        masses=[float(re.findall(r"<mass>([^<]*)<", content)[0]) for content in bodies],
        places=[float(re.findall(r"<pose>([^<]*)<", content)[0].split()[0]) for content in bodies],
        anchor=float(joint_pose[1].split()[0]),
        half_size=[0.5 * float(number) for number in sizes[0].split()],
    )


def build_model(plain: Plain) -> Any:
    """Return the links as boxes in MuJoCo, without gravity: buoyancy carries them.

    Args:
        plain: What is found in the file.
    """
    size = " ".join(str(half) for half in plain.half_size)
    text = ""
    for i in range(len(plain.masses) - 1, -1, -1):
        position = 0.0
        joint = "<freejoint/>"
        if i > 0:
            position = plain.places[i] - plain.places[i - 1]
            place = f'pos="{plain.anchor} 0 0" axis="0 0 1"'
            joint = f'<joint name="joint{i}" {place} range="-1 1" limited="true" damping="0.01"/>'
        geom = f'<geom type="box" size="{size}" mass="{plain.masses[i]}"/>'
        text = f'<body name="link{i}" pos="{position} 0 0">{joint}{geom}{text}</body>'
    options = f'<option timestep="{DT}" gravity="0 0 0"><flag contact="disable"/></option>'
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/>{options}<worldbody>{text}</worldbody></mujoco>'
    )


class Oscillators:
    """FARMS's oscillators, from its YAML file.

    Args:
        network: Table `control.network`.
    """

    def __init__(self, network: dict[str, Any]) -> None:
        entries = network["oscillators"]
        names = [entry["name"] for entry in entries]
        couplings = network["osc2osc"]
        drive = network["drives"][0]["initial_value"]
        self.phase = np.array([entry["initial_phase"] for entry in entries])
        self.amplitude = np.array([entry["initial_amplitude"] for entry in entries])
        self.frequency = np.array([entry["frequency_gain"] * drive for entry in entries])
        self.nominal = np.array([entry["amplitude_gain"] * drive for entry in entries])
        self.rate = np.array([entry["rate"] for entry in entries])
        self.pulled = [names.index(coupling["in"]) for coupling in couplings]
        self.pulling = [names.index(coupling["out"]) for coupling in couplings]
        self.weight = np.array([coupling["weight"] for coupling in couplings])
        self.bias = np.array([coupling["phase_bias"] for coupling in couplings])

    def begin_as_wave(self, lag: float) -> None:
        """Begin with the wave, instead of the random phases of the file.

        Args:
            lag: Lead of every joint over the next one toward the tail [rad].
        """
        joints, sides = np.divmod(np.arange(self.phase.size), 2)
        self.phase = np.pi * sides - 0.5 * np.pi - lag * joints

    def step(self) -> np.ndarray:
        """Advance by a time step, and return the angles that are commanded, head first [rad]."""
        lead = self.phase[self.pulling] - self.phase[self.pulled] - self.bias
        pull = self.amplitude[self.pulling] * self.weight * np.sin(lead)
        rate = self.frequency.copy()
        np.add.at(rate, self.pulled, pull)
        self.phase = self.phase + DT * rate
        self.amplitude = self.amplitude + DT * self.rate * (self.nominal - self.amplitude)
        output = self.amplitude * (1.0 + np.cos(self.phase))
        return 0.5 * (output[1::2] - output[0::2])


@dataclass(frozen=True)
class Run:
    """Run of the second opinion."""

    head: np.ndarray
    """Places of the head's middle [m]."""
    center: np.ndarray
    """Places of the center of mass [m]."""
    lags: np.ndarray
    """Lags of the commanded angles from joint to joint, over the last second [deg]."""


def run_second_opinion(plain: Plain, table: dict[str, Any], lag: float | None = None) -> Run:
    """Swim by FARMS's equations.

    Args:
        plain: What is found in the SDF file.
        table: All of the YAML file.
        lag: Begin with the wave of this lag [rad]; None: with the phases of the file.
    """
    model = build_model(plain)
    data: Any = mujoco.MjData(model)
    oscillators = Oscillators(table["control"]["network"])
    if lag is not None:
        oscillators.begin_as_wave(lag)
    motor = table["control"]["motors"][0]
    stiffness, damping = motor["gains"][:2]
    limit = motor["limits_torque"][1]
    n_links = len(plain.masses)
    drag = [
        np.array(link["drag_coefficients"][0]) for link in table["morphology"]["links"][:n_links]
    ]
    n_steps = round(DURATION / DT)
    head = np.empty((n_steps, 2))
    center = np.empty((n_steps, 2))
    commands: list[np.ndarray] = []
    velocity = np.empty(6)
    for step in range(n_steps):
        command = oscillators.step()
        commands.append(command)
        torque = stiffness * (command - data.qpos[7:]) - damping * data.qvel[6:]
        data.qfrc_applied[6:] = np.clip(torque, -limit, limit)
        for i in range(n_links):
            body_frame = mujoco.mjtObj.mjOBJ_XBODY
            mujoco.mj_objectVelocity(model, data, body_frame, i + 1, velocity, 1)
            force = drag[i] * velocity[3:] * np.abs(velocity[3:])
            data.xfrc_applied[i + 1, :3] = data.xmat[i + 1].reshape(3, 3) @ force
        mujoco.mj_step(model, data)
        head[step] = data.xpos[1, :2]
        center[step] = data.subtree_com[1, :2]
    last = np.array(commands[-round(1.0 / DT) :])
    wave = np.exp(-2j * np.pi * DT * np.arange(len(last)))
    phases = np.angle(wave @ last)
    lags = [np.degrees(a - b) % 360.0 for a, b in pairwise(phases)]
    return Run(head=head, center=center, lags=np.array(lags))


# ---- laticauda -----------------------------------------------------------------------------------


def swim(animat: FarmsAnimat, *, by_textbook: bool) -> lc.Trial:
    """Return a trial of the animat.

    Args:
        animat: The animat.
        by_textbook: Whether in water by the textbook, instead of that with the drag of FARMS.
    """
    assert animat.network is not None
    assert animat.robot_with_drag is not None
    assert animat.water is not None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if by_textbook:
            return lc.swim(animat.robot, animat.network, DURATION, joints=animat.joints)
        return lc.swim(
            animat.robot_with_drag,
            animat.network,
            DURATION,
            joints=animat.joints,
            environment=animat.water,
        )


class Progress(NamedTuple):
    """How a run gets on."""

    way: float
    """How far the center of mass comes in the first seconds, see `FIRST` [m]."""
    speed: float
    """Its mean speed after these [m/s]."""


def measure_progress(time: np.ndarray, center: np.ndarray) -> Progress:
    """Return how a run gets on.

    Args:
        time: Times [s].
        center: Its places [m].
    """
    first = int(np.searchsorted(time, FIRST))
    way = float(np.linalg.norm(center[first] - center[0]))
    speed = np.linalg.norm(center[-1] - center[first]) / (time[-1] - time[first])
    return Progress(way=way, speed=float(speed))


def compare(folder: Path) -> list[Figure]:
    """Return all figures.

    Args:
        folder: Folder of the example.
    """
    animat = load_farms(folder / "animat_config.yaml")
    print(animat.words)
    plain = read_plain((folder / "models" / "amphibot.sdf").read_text())
    table = yaml.load((folder / "animat_config.yaml").read_text(), Loader=_Loader)
    assert animat.network is not None
    second = run_second_opinion(plain, table)
    as_wave = run_second_opinion(plain, table, animat.network.gait.phase_shift)
    trial = swim(animat, by_textbook=False)
    textbook = swim(animat, by_textbook=True)
    times = DT * np.arange(1, len(second.center) + 1)
    progress = measure_progress(trial.time, trial.center_of_mass)
    progress_second = measure_progress(times, second.center)
    progress_as_wave = measure_progress(times, as_wave.center)
    progress_textbook = measure_progress(textbook.time, textbook.center_of_mass)
    phases = [trial.signals[f"phase_{i}"][-1] for i in range(animat.robot.n_joints)]
    lags = np.degrees(np.diff(phases)) % 360.0
    length = plain.places[0] - plain.places[-1] + 2.0 * plain.half_size[0]
    head_way = float(np.linalg.norm(second.head[round(FIRST / DT)] - second.head[0]))
    return [
        Figure("mass [kg]", animat.robot.mass, sum(plain.masses)),
        Figure("length [m]", animat.robot.length, length),
        Figure("lag, least [deg]", float(lags.min()), float(second.lags.min())),
        Figure("lag, largest [deg]", float(lags.max()), float(second.lags.max())),
        Figure("way in 4 s, begun as a wave [m]", progress.way, progress_as_wave.way),
        Figure("way in 4 s, begun by the file [m]", float("nan"), progress_second.way),
        Figure("way of the head in 4 s, begun by the file [m]", float("nan"), head_way),
        Figure("speed after 4 s [m/s]", progress.speed, progress_second.speed),
        Figure("textbook water: way in 4 s [m]", progress_textbook.way, float("nan")),
        Figure("textbook water: speed after 4 s [m/s]", progress_textbook.speed, float("nan")),
    ]


class _Loader(yaml.SafeLoader):
    """Loader that drops the tags of Python."""


_Loader.add_multi_constructor("tag:yaml.org,2002:python/", lambda *_: None)


def main() -> None:
    """Run the comparison."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    figures = compare(arguments.folder)
    for figure in figures:
        print(f"{figure.name:40} {figure.laticauda:8.4f} {figure.second_opinion:8.4f}")
    if arguments.write:
        TABLE.unlink(missing_ok=True)
        for figure in figures:
            ours, theirs = round(figure.laticauda, 4), round(figure.second_opinion, 4)
            append_row(TABLE, Figure(figure.name, ours, theirs))


if __name__ == "__main__":
    main()
