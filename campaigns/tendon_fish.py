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
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

import laticauda as lc
from laticauda.robot import CaudalFin, textbook_water

TABLE = Path(__file__).with_suffix(".csv")
VIDEOS = ("0_50", "0_75", "1_00", "1_25", "1_75")
"""By the frequency that the motor was asked for [Hz]. In those at 1.5, 2 and 2.25 Hz the tracker lost markers."""
RATE = 60.0
"""Frames per second, as the source's own script has it."""
HEAD = 0.142
"""Distance between the first two markers, which is the scale [m]."""
NOSE = 0.077
"""Distance of the first marker from the origin of the source's lengths [m]."""
JOINTS = np.array([0.285, 0.3145, 0.3455, 0.376, 0.401])
"""Places of the joints, from that origin [m]."""
BEHIND = np.array([0.0145, 0.015, 0.016, 0.0145, 0.0105, 0.073])
"""Distances of the tail's markers behind their joints [m]."""
PLACE = 0.005
"""How well markers are seen [m]."""
TURN = 0.12
"""By how much neighboring joints differ [rad]: without, their angles alternate."""
N_CYCLES = 12
"""Cycles of a run."""
N_SAMPLES = 24
"""Samples of a cycle."""


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
        lines = [line for line in file if not line.startswith("#")]
    return [read_swim(cells) for cells in csv.reader(lines)]


def read_swim(cells: Sequence[str]) -> Swim:
    """A row of the table."""
    asked, frequency, speed, tip, *joints = map(float, cells)
    amplitudes = np.radians(joints[::2])
    phases = np.radians(joints[1::2])
    return Swim(
        asked=asked,
        frequency=frequency,
        speed=speed,
        tip=tip,
        joints=tuple(amplitudes * np.exp(1j * phases)),
    )


def gait(swim: Swim) -> lc.Gait:
    """Its joints over some cycles, from straight."""
    time = np.arange(N_CYCLES * N_SAMPLES + 1) / N_SAMPLES / swim.frequency
    phase = 2.0 * np.pi * swim.frequency * time
    growth = -np.expm1(-phase / 2.0 / np.pi)
    angle = np.real(np.outer(swim.joints, np.exp(1j * phase))) * growth
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


def run(swim: Swim, water: lc.Water, robot: lc.Robot | str = "tendon-fish") -> lc.Trial:
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
    return steady_speed(swim, run(swim, water))


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


def reduce_markers(asked: str, folder: Path) -> Swim:
    """A video's markers as a table's row."""
    pixels = np.loadtxt(folder / f"markers_{asked}.csv", delimiter=",").reshape(-1, 9, 2)
    markers = pixels @ (1.0, -1j)  # places as complex numbers; a picture's y goes down
    markers *= HEAD / np.abs(markers[:, 1] - markers[:, 0]).mean()
    time = np.arange(len(markers)) / RATE
    axis = markers[:, 1] - markers[:, 0]
    axis /= np.abs(axis)
    beside_axis = ((markers[:, 3:] - markers[:, :1]) / axis[:, None]).imag
    frequency = _frequency_of(time, beside_axis[:, -1])
    waves = np.array([_harmonic(frequency, time, values).wave for values in beside_axis.T])
    head = markers[:, :2].mean(axis=1)
    # Angles here grow from head to tail and to the left of a fish seen from behind: tail first they
    # turn the other way.
    joints = -_joint_waves(waves)[::-1]
    return Swim(
        asked=float(asked.replace("_", ".")),
        frequency=frequency / 2.0 / np.pi,
        speed=_speed_along_path(time, head),
        tip=float(abs(waves[-1])),
        joints=tuple(joints),
    )


def _frequency_of(time: np.ndarray, values: np.ndarray) -> float:
    """The angular frequency whose harmonics leave least of the values [rad/s]."""
    frequencies = 2.0 * np.pi * np.linspace(0.25, 2.4, 4000)
    remainders = [_harmonic(frequency, time, values).remainder for frequency in frequencies]
    return float(frequencies[int(np.argmin(remainders))])


def _joint_waves(waves: np.ndarray) -> np.ndarray:
    """Amplitude and phase of the joints, head first, from those of the markers; phases are the tip's."""
    phases = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False))
    angles = np.array([_bent(np.real(waves * phase)) for phase in phases])
    first_harmonic = 2.0 * np.mean(angles * np.conj(phases)[:, None], axis=0)
    phase_of_tip = waves[-1] / abs(waves[-1])
    return first_harmonic / phase_of_tip


def _speed_along_path(time: np.ndarray, head: np.ndarray) -> float:
    """Mean speed along a smooth path of the head [m/s]."""
    x = np.polyval(np.polyfit(time, head.real, 3), time)
    y = np.polyval(np.polyfit(time, head.imag, 3), time)
    length = np.hypot(np.diff(x), np.diff(y)).sum()
    return float(length / time[-1])


class Harmonic(NamedTuple):
    """The first harmonic of values over time."""

    wave: complex
    """Its amplitude and phase."""
    remainder: float
    """Sum of squares that is left beside it, a mean and the second harmonic."""


def _harmonic(frequency: float, time: np.ndarray, values: np.ndarray) -> Harmonic:
    """Fit a mean and two harmonics of an angular frequency [rad/s]."""
    phase = frequency * time
    columns = [
        np.ones_like(time),
        np.cos(phase),
        np.sin(phase),
        np.cos(2 * phase),
        np.sin(2 * phase),
    ]
    numbers, remainders, *_ = np.linalg.lstsq(np.stack(columns, axis=1), values, rcond=None)
    return Harmonic(complex(numbers[1], -numbers[2]), float(remainders[0]))


def _bent(beside: np.ndarray) -> np.ndarray:
    """Angles of the joints, head first, whose markers are so far beside the head's axis [m]."""

    def residuals(angle: np.ndarray) -> np.ndarray:
        lean = np.sin(np.cumsum(angle))
        joint = np.concatenate(([0.0], np.cumsum(np.diff(JOINTS) * lean[:-1])))
        marker = np.append(joint, joint[-1]) + BEHIND * np.append(lean, lean[-1])
        return np.concatenate(((marker - beside) / PLACE, np.diff(angle) / TURN, angle[:1] / 0.5))

    return least_squares(residuals, np.zeros(JOINTS.size)).x


def record(folder: Path) -> None:
    """Write the table."""
    lines = [
        "# Reduced from github.com/srl-ethz/fishsim, Data/Markers "
        "(MIT License, Copyright (c) 2026 Soft Robotics Lab)",
        "# asked_hz,frequency_hz,speed_m_s,tip_m, then amplitude_deg,phase_deg of every joint, tail first",
    ]
    for video in VIDEOS:
        swim = reduce_markers(video, folder)
        cells = [f"{swim.asked:.2f}", f"{swim.frequency:.4f}", f"{swim.speed:.4f}"]
        cells.append(f"{swim.tip:.4f}")
        for wave in swim.joints:
            cells += [f"{np.degrees(abs(wave)):.1f}", f"{np.degrees(np.angle(wave)):.1f}"]
        lines.append(",".join(cells))
    TABLE.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """The table, or its file."""
    options = argparse.ArgumentParser()
    options.add_argument("--markers", type=Path)
    folder = options.parse_args().markers
    if folder:
        record(folder)
    else:
        print_table(swims())


def print_table(measured: Sequence[Swim]) -> None:
    print(" " * 34 + "".join(f"{swim.frequency:>15.3f} Hz" for swim in measured))
    print(f"{'measured [m/s]':34}" + "".join(f"{swim.speed:>18.3f}" for swim in measured))
    models: dict[str, tuple[lc.Robot | str, dict[str, Any]]] = {
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
    speeds: dict[str, list[float]] = {}
    for name, (robot, changes) in models.items():
        trials = [run(swim, textbook(swim, robot, **changes), robot) for swim in measured]
        speeds[name] = [
            steady_speed(swim, trial) for swim, trial in zip(measured, trials, strict=True)
        ]
        incidences = [f"{np.degrees(trial.edge_incidence):.0f} deg" for trial in trials]
        print(f"{f'incidence: {name}':34}" + "".join(f"{angle:>18}" for angle in incidences))
    paper_water = lc.load_water("paper-lateral")
    speeds["paper-lateral"] = [speed(swim, paper_water) for swim in measured]
    for name in null_models(measured[0]):
        speeds[name] = [null_models(swim)[name] for swim in measured]
    for name, speeds_of_model in speeds.items():
        cells: list[str] = []
        for simulated, swim in zip(speeds_of_model, measured, strict=True):
            error = 100 * (simulated / swim.speed - 1)
            cells.append(f"{simulated:.3f} ({error:+.0f} %)")
        print(f"{name:34}" + "".join(f"{cell:>18}" for cell in cells))


if __name__ == "__main__":
    main()
