"""AmphiBot's run 1: a real robot that nobody fitted, simulated from its measured joint angles.

The joints do what they did (`amphibot-1`, prescribed), the water is the textbook's, and nothing is
fitted. What comes out stands beside what two cameras saw, and beside models without hydrodynamics,
with numbers from the literature.

python campaigns/amphibot.py
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.models.simulate import figure_intervals, widen_by_textbook_error
from laticauda.robot import textbook_of
from laticauda.robot.files import PRESETS
from laticauda.trials.markers import Track, marker_distance, marker_places

LINK = 0.0965  # m
ALONG = (
    [0.6245]
    + [at for k in range(6, 1, -1) for at in (k * LINK, k * LINK - 0.0545)]
    + [LINK, LINK - 0.053]
)
"""Of the 13 LEDs, head first: distance from the tail end along the straight body [m]."""
FREQUENCY = 1.347  # Hz, from the LEDs
SPANS = {
    "swim 1": (2.2, 4.5, 0.607),
    "swim 2": (5.7, 7.7, 0.613),
    "glide 1": (8.4, 9.4, 0.193),
    "glide 2": (9.4, 10.4, 0.116),
}
"""Begin and end [s], and speed [m/s]: of the LEDs' mean (swims, a camera each), of the LEDs along the body (glides)."""
STARTED = (0.422, 2.423)
"""The first frame, and that 2 s later, of the same camera [s]."""
COAST = 0.024
"""Drag coefficient of the wetted surface of fish that coast (McHenry and Lauder, J. Exp. Biol. 208, 2005, p. 2289)."""
STROUHAL = 0.35
"""Upper end of where animals are said to swim (Eloy, J. R. Soc. Interface 9, 2012, p. 30)."""
STRIDE = 0.6
"""Body lengths per cycle, which a species keeps at all speeds (Videler and Wardle 1991, abstract); the number is from
memory of fish, and not read."""


def textbook(**changes: Any) -> lc.Water:
    """Coefficients from tables for its shape, none of them fitted to this robot; `changes` are fields of the water."""
    return replace(textbook_of(lc.load_robot("amphibot")), **changes)


def swum(water: lc.Water, **changes: Any) -> lc.Trial:
    """The run: 13 s from straight and at rest; `changes` are those of `laticauda.swim`."""
    gait = lc.recorded_gait(lc.load_joint_angles("amphibot-1"))
    return lc.swim(
        "amphibot",
        gait,
        13.0,
        environment=water,
        **{"dt": 0.005, "sample_interval": 0.02, **changes},
    )


def track() -> Track:
    """What the cameras saw."""
    return Track.read(PRESETS / "tracks" / "amphibot-1.csv")


def steady(time: np.ndarray, place: np.ndarray, begin: float, end: float) -> float:
    """Mean speed of a place [m/s]: the slope of a line with two harmonics of the gait."""
    now = (time >= begin) & (time <= end)
    t, w = time[now], 2.0 * math.pi * FREQUENCY
    columns = [np.ones_like(t), t, *(wave(k * w * t) for k in (1, 2) for wave in (np.sin, np.cos))]
    return float(
        np.hypot(*np.linalg.lstsq(np.stack(columns, axis=1), place[now], rcond=None)[0][1])
    )


def along_body(time: np.ndarray, markers: np.ndarray, begin: float, end: float) -> float:
    """Mean speed of markers, head first, along the line through them [m/s]."""
    now = (time >= begin) & (time <= end)
    line = -np.gradient(markers, axis=1)
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    return float(np.sum(np.gradient(markers, time, axis=0) * line, axis=-1)[now].mean())


def came(time: np.ndarray, middle: np.ndarray) -> float:
    """How far the LEDs' mean came in the start [m]."""
    begin, end = (np.array([np.interp(t, time, one) for one in middle.T]) for t in STARTED)
    return float(np.hypot(*(end - begin)))


def figures(trial: lc.Trial) -> dict[str, float]:
    """What a run gives: the speeds of SPANS [m/s], and how far it came in the start [m]."""
    markers = marker_places(trial, ALONG)
    middle = markers.mean(axis=1)
    found = {
        name: steady(trial.time, middle, a, b)
        if name.startswith("swim")
        else along_body(trial.time, markers, a, b)
        for name, (a, b, _) in SPANS.items()
    }
    return {**found, "start": came(trial.time, middle)}


def measured() -> dict[str, float]:
    """The same of the real robot."""
    seen = track()
    return {
        **{name: speed for name, (_, _, speed) in SPANS.items()},
        "start": came(seen.time, seen.place.mean(axis=1)),
    }


def stated_intervals(trial: lc.Trial) -> dict[str, tuple[float, float]]:
    """Between what the figures lie, by what is known of the coefficients and by what the model missed such motion."""
    kinds = {"swim": "swimming", "glide": "gliding", "start": "starting"}
    return {
        name: widen_by_textbook_error(one, kinds[name.split()[0]])
        for name, one in figure_intervals(trial, figures=figures).items()
    }


def null_models() -> dict[str, dict[str, float]]:
    """The same, as far as models without hydrodynamics go."""
    robot, tail = lc.load_robot("amphibot"), 2.0 * 0.092  # m, from side to side, of the last LED
    a, b = robot.modules[0].section.half_height, robot.modules[0].section.half_width
    decay = 0.5 * 1000.0 * COAST * math.pi * robot.length * (a + b) / robot.mass  # 1/m
    stop, speed = (
        8.03,
        SPANS["swim 2"][2],
    )  # the glide begins with the speed of the swim, and no wave

    def come(t: float) -> float:
        return math.log1p(speed * decay * (t - stop)) / decay

    coast = {
        name: (come(b) - come(a)) / (b - a)
        for name, (a, b, _) in SPANS.items()
        if name.startswith("glide")
    }
    swims = [name for name in SPANS if name.startswith("swim")]
    return {
        f"stride of {STRIDE} body lengths": dict.fromkeys(swims, STRIDE * robot.length * FREQUENCY),
        f"Strouhal number {STROUHAL}": dict.fromkeys(swims, tail * FREQUENCY / STROUHAL),
        f"quadratic coast, C = {COAST}": coast,
    }


def row(words: str, found: Mapping[str, float], real: Mapping[str, float]) -> str:
    """A line of the table: values, and by how many percent they miss."""
    cells = [
        f"{found[name]:.3f} ({100 * (found[name] / real[name] - 1):+4.0f} %)"
        if name in found
        else ""
        for name in real
    ]
    return f"{words:34}" + "".join(f"{cell:>16}" for cell in cells)


def main() -> None:
    """The table."""
    real, seen = measured(), track()
    print(" " * 34 + "".join(f"{name:>16}" for name in real))
    print(f"{'measured [m/s, m]':34}" + "".join(f"{one:>16.3f}" for one in real.values()))
    bare = {"textbook, no shed edge": textbook(trailing_edge="none")}
    waters = {
        f"textbook, beta {beta}": textbook(drag=lc.TotalSpeedDrag(beta=beta))
        for beta in (0.5, 0.0, 1.0)
    }
    for name, water in {**waters, **bare, "paper-lateral": lc.load_water("paper-lateral")}.items():
        trial = swum(water)
        time, gap = marker_distance(trial, seen, ALONG, fitted=(0.4, 1.1))
        print(
            row(name, figures(trial), real),
            f"  LEDs {1000 * np.interp(4.5, time, gap):.0f} mm apart at 4.5 s",
        )
    for name, found in null_models().items():
        print(row(name, found, real))
    trial = swum(textbook())
    ranges = {
        "coefficients in their intervals": figure_intervals(trial, figures=figures),
        "stated": stated_intervals(trial),
    }
    for words, found in ranges.items():
        print(
            f"{words:34}"
            + "".join(f"{f'{low:.3f} to {high:.3f}':>16}" for low, high in found.values())
        )


if __name__ == "__main__":
    main()
