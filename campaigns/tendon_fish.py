"""A fish robot that nobody fitted here: ETH Zurich's tendon-driven fish, simulated from its tracked tail.

The joints do what markers on the tail say (`tendon_fish.csv`: a harmonic of every joint, tail
first), prescribed; the water is the textbook's. What comes out stands beside the speed of the head
in the same videos, the incidence of the fin, and models without hydrodynamics. The first rows go, step by
step, from the water and the robot before fins were plates, the bars were there, and the fin had its silhouette
behind the plates of the tail.

    python campaigns/tendon_fish.py                     the table
    python campaigns/tendon_fish.py --markers FOLDER    make tendon_fish.csv anew from the source's Data/Markers

Source of the markers: github.com/srl-ethz/fishsim (MIT License, Copyright (c) 2026 Soft Robotics
Lab, ETH Zurich).
"""

import argparse
import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

import laticauda as lc
from laticauda.robot import CaudalFin, textbook_water

TABLE = Path(__file__).with_suffix(".csv")
VIDEOS = ("0_50", "0_75", "1_00", "1_25", "1_75")
"""By the frequency that the motor was asked for [Hz]. In those at 1.5, 2 and 2.25 Hz the tracker lost markers."""
RATE = 60.0  # frames per second, as the source's own script has it
HEAD = 0.142  # m, between the first two markers: the scale
NOSE = 0.077  # m, from the first marker to the origin of the source's lengths
JOINTS = np.array([0.285, 0.3145, 0.3455, 0.376, 0.401])  # m, from that origin
BEHIND = np.array(
    [0.0145, 0.015, 0.016, 0.0145, 0.0105, 0.073]
)  # m, of tail markers behind their joint
PLACE, TURN = 0.005, 0.12
"""How well markers are seen [m], and by how much neighboring joints differ [rad]: without, their angles alternate."""
N_CYCLES, N_SAMPLES = 12, 24


@dataclass(frozen=True, kw_only=True)
class Swim:
    """What one video says."""

    asked: float
    """Frequency of the motor [Hz]."""
    frequency: float
    """Of the tail in the video [Hz]."""
    speed: float
    """Of the head along its path [m/s]."""
    tip: float
    """Amplitude of the fin's tip beside the head's axis [m]."""
    joints: tuple[complex, ...]
    """Amplitude and phase of every joint, tail first [rad]."""


def swims() -> list[Swim]:
    """The table."""
    with TABLE.open(encoding="utf-8") as file:
        rows = [
            [float(cell) for cell in row]
            for row in csv.reader(line for line in file if line[0] in "0123456789")
        ]
    return [
        Swim(
            asked=a,
            frequency=f,
            speed=v,
            tip=tip,
            joints=tuple(np.radians(j[::2]) * np.exp(1j * np.radians(j[1::2]))),
        )
        for a, f, v, tip, *j in rows
    ]


def gait(swim: Swim) -> lc.Gait:
    """Its joints over some cycles, from straight."""
    time = np.arange(N_CYCLES * N_SAMPLES + 1) / N_SAMPLES / swim.frequency
    phase = 2.0 * np.pi * swim.frequency * time
    angle = np.real(np.outer(swim.joints, np.exp(1j * phase))) * -np.expm1(-phase / 2.0 / np.pi)
    return lc.recorded_gait(lc.JointAngles(time=tuple(time), angle=tuple(map(tuple, angle))))


def textbook(swim: Swim, robot: lc.Robot | str = "tendon-fish", **changes: Any) -> lc.Water:
    """Coefficients from tables for its shape at its speed; `changes` are fields of the water."""
    shape = lc.load_robot(robot) if isinstance(robot, str) else robot
    return replace(textbook_water(shape, speed=swim.speed).water, **changes)


AS_A_BODY = {"plate_drag": None, "plate_added_mass": None}
"""Changes of the water with which the fin and the flat tail have the coefficients of the box-shaped body."""


GAP = 1e-6
"""An opening ahead of a fin, so small that it only makes its leading edge free [m]."""


def with_rectangle() -> lc.Robot:
    """The robot with a free rectangular fin of the same area at a longer last link."""
    fish = lc.load_robot("tendon-fish")
    fin = CaudalFin(
        length=0.0365, height=0.203, thickness=0.002, density=1350.0, opening_length=GAP
    )
    tail = replace(fish.modules[0], length=0.04)
    bar = replace(fish.drag_areas[0], x=0.005)
    return replace(
        fish,
        modules=(tail, *fish.modules[1:]),
        drag_areas=(bar, *fish.drag_areas[1:]),
        caudal_fin=fin,
    )


def with_free_fin() -> lc.Robot:
    """The robot whose fin has its silhouette, but a free leading edge as well: a joint turns it, which stays still."""
    fish = lc.load_robot("tendon-fish")
    fin = fish.caudal_fin
    assert fin is not None
    return replace(fish, caudal_fin=replace(fin, joint=lc.robot.Joint()))


def without_bars() -> lc.Robot:
    """That robot without the five bars across its tail."""
    return replace(with_rectangle(), drag_areas=())


def swum(swim: Swim, water: lc.Water, robot: lc.Robot | str = "tendon-fish") -> lc.Trial:
    """The run."""
    period = 1.0 / swim.frequency
    return lc.swim(
        robot,
        gait(swim),
        N_CYCLES * period,
        environment=water,
        dt=period / 100.0,
        sample_interval=period / N_SAMPLES,
    )


def speed(swim: Swim, water: lc.Water) -> float:
    """Simulated, over the last three cycles [m/s]."""
    return steady_speed(swim, swum(swim, water))


def steady_speed(swim: Swim, trial: lc.Trial) -> float:
    """Speed of a run over its last three cycles [m/s]."""
    period = 1.0 / swim.frequency
    way = trial.center_of_mass[-1] - trial.center_of_mass[-1 - 3 * N_SAMPLES]
    return float(np.hypot(*way) / (3.0 * period))


def null_models(swim: Swim) -> Mapping[str, float]:
    """Speeds without hydrodynamics [m/s]; see `campaigns/amphibot.py` for where the numbers are from."""
    return {
        "stride of 0.6 body lengths": 0.6 * lc.load_robot("tendon-fish").length * swim.frequency,
        "Strouhal number 0.35": 2.0 * swim.tip * swim.frequency / 0.35,
    }


def reduced(asked: str, folder: Path) -> Swim:
    """A video's markers as a table's row."""
    seen = np.loadtxt(folder / f"markers_{asked}.csv", delimiter=",").reshape(-1, 9, 2) * (
        1.0,
        -1.0,
    )
    seen *= HEAD / np.linalg.norm(seen[:, 1] - seen[:, 0], axis=1).mean()
    time = np.arange(len(seen)) / RATE
    axis = (seen[:, 1] - seen[:, 0]) @ (1.0, 1j)
    axis /= np.abs(axis)
    tail = ((seen[:, 3:] - seen[:, :1]) @ (1.0, 1j) / axis[:, None]).imag  # beside the head's axis
    trials = 2.0 * np.pi * np.linspace(0.25, 2.4, 4000)
    left = [_harmonic(w, time, tail[:, -1])[1] for w in trials]
    w = float(trials[int(np.argmin(left))])
    waves = np.array([_harmonic(w, time, one)[0] for one in tail.T])
    phases = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False))
    angles = np.array([_bent(np.real(waves * one)) for one in phases])
    joints = 2.0 * np.mean(angles * np.conj(phases)[:, None], axis=0) / (waves[-1] / abs(waves[-1]))
    head = seen[:, :2].mean(axis=1)
    path = np.stack([np.polyval(np.polyfit(time, one, 3), time) for one in head.T], axis=1)
    along = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum() / time[-1])
    # Angles here grow from head to tail and to the left of a fish seen from behind: tail first they
    # turn the other way.
    return Swim(
        asked=float(asked.replace("_", ".")),
        frequency=w / 2.0 / np.pi,
        speed=along,
        tip=float(abs(waves[-1])),
        joints=tuple(-joints[::-1]),
    )


def _harmonic(w: float, time: np.ndarray, values: np.ndarray) -> tuple[complex, float]:
    """Amplitude and phase of the first harmonic, beside a mean and the second; and the sum of squares that is left."""
    columns = [
        np.ones_like(time),
        *(wave(k * w * time) for k in (1, 2) for wave in (np.cos, np.sin)),
    ]
    found = np.linalg.lstsq(np.stack(columns, axis=1), values, rcond=None)
    return complex(found[0][1], -found[0][2]), float(found[1][0])


def _bent(beside: np.ndarray) -> np.ndarray:
    """Angles of the joints, head first, whose markers are so far beside the head's axis [m]."""

    def missed(angle: np.ndarray) -> np.ndarray:
        lean = np.sin(np.cumsum(angle))
        joint = np.concatenate(([0.0], np.cumsum(np.diff(JOINTS) * lean[:-1])))
        place = np.append(joint, joint[-1]) + BEHIND * np.append(lean, lean[-1])
        return np.concatenate(((place - beside) / PLACE, np.diff(angle) / TURN, angle[:1] / 0.5))

    return least_squares(missed, np.zeros(JOINTS.size)).x


def record(folder: Path) -> None:
    """Write the table."""
    lines = [
        "# asked_hz,frequency_hz,speed_m_s,tip_m, then amplitude_deg,phase_deg of every joint, tail first"
    ]
    for one in (reduced(name, folder) for name in VIDEOS):
        joints = [
            cell for c in one.joints for cell in (np.degrees(abs(c)), np.degrees(np.angle(c)))
        ]
        lines.append(
            f"{one.asked:.2f},{one.frequency:.4f},{one.speed:.4f},{one.tip:.4f},"
            + ",".join(f"{x:.1f}" for x in joints)
        )
    notice = (
        "# Reduced from github.com/srl-ethz/fishsim, Data/Markers "
        "(MIT License, Copyright (c) 2026 Soft Robotics Lab)"
    )
    TABLE.write_text("\n".join([notice, *lines]) + "\n", encoding="utf-8")


def main() -> None:
    """The table, or its file."""
    options = argparse.ArgumentParser()
    options.add_argument("--markers", type=Path)
    if folder := options.parse_args().markers:
        record(folder)
        return
    rows = swims()
    print(" " * 34 + "".join(f"{one.frequency:>15.3f} Hz" for one in rows))
    print(f"{'measured [m/s]':34}" + "".join(f"{one.speed:>18.3f}" for one in rows))
    ways: dict[str, tuple[lc.Robot | str, dict[str, Any]]] = {
        "fin as body, no bars": (without_bars(), {"trailing_edge": "elongated", **AS_A_BODY}),
        "plates": (without_bars(), {"trailing_edge": "elongated"}),
        "plates and bars": (with_rectangle(), {"trailing_edge": "elongated"}),
        "law of a finite span": (with_rectangle(), {}),
        "silhouette": (with_free_fin(), {}),
        "textbook: one plate with the tail": ("tendon-fish", {}),
        "suction of at most 0.2": ("tendon-fish", {"edge_clip": 0.2}),
        "suction of at most 0.1": ("tendon-fish", {"edge_clip": 0.1}),
        "textbook, beta 0": ("tendon-fish", {"drag": lc.TotalSpeedDrag(beta=0.0)}),
        "textbook, beta 1": ("tendon-fish", {"drag": lc.TotalSpeedDrag(beta=1.0)}),
        "textbook, no shed edge": ("tendon-fish", {"trailing_edge": "none"}),
    }
    found: dict[str, list[float]] = {}
    for name, (robot, changes) in ways.items():
        trials = [swum(one, textbook(one, robot, **changes), robot) for one in rows]
        found[name] = [steady_speed(one, trial) for one, trial in zip(rows, trials, strict=True)]
        incidences = [f"{np.degrees(trial.edge_incidence):.0f} deg" for trial in trials]
        print(f"{f'incidence: {name}':34}" + "".join(f"{angle:>18}" for angle in incidences))
    found["paper-lateral"] = [speed(one, lc.load_water("paper-lateral")) for one in rows]
    for name in null_models(rows[0]):
        found[name] = [null_models(one)[name] for one in rows]
    for name, speeds in found.items():
        cells = [
            f"{v:.3f} ({100 * (v / one.speed - 1):+.0f} %)"
            for v, one in zip(speeds, rows, strict=True)
        ]
        print(f"{name:34}" + "".join(f"{cell:>18}" for cell in cells))


if __name__ == "__main__":
    main()
