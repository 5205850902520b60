"""AmphiBot's run 1: a real robot that nobody fitted, simulated from its measured joint angles.

The joints do what they did (`amphibot-1`, prescribed), the water is the textbook's, and nothing is
fitted. What comes out stands beside what two cameras saw, and beside models without hydrodynamics,
with numbers from the literature.

python campaigns/amphibot.py
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.models.simulate import figure_intervals, widen_by_textbook_error
from laticauda.robot import textbook_of
from laticauda.robot.files import PRESETS
from laticauda.trials.markers import Track, marker_distance, marker_places

LINK = 0.0965
"""Length of a link [m]."""


def _led_positions() -> list[float]:
    positions = [0.6245]
    for k in range(6, 1, -1):
        positions += [k * LINK, k * LINK - 0.0545]
    return [*positions, LINK, LINK - 0.053]


ALONG = _led_positions()
"""Of the 13 LEDs, head first: distance from the tail end along the straight body [m]."""
FREQUENCY = 1.347
"""Frequency of the gait, from the LEDs [Hz]."""


class Span(NamedTuple):
    """A part of the run."""

    begin: float
    """[s]."""
    end: float
    """[s]."""
    speed: float
    """Of the LEDs' mean (swims, a camera each), of the LEDs along the body (glides) [m/s]."""


SPANS = {
    "swim 1": Span(2.2, 4.5, 0.607),
    "swim 2": Span(5.7, 7.7, 0.613),
    "glide 1": Span(8.4, 9.4, 0.193),
    "glide 2": Span(9.4, 10.4, 0.116),
}
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
    is_inside = (time >= begin) & (time <= end)
    t = time[is_inside]
    phase = 2.0 * math.pi * FREQUENCY * t
    columns = [np.ones_like(t), t]
    columns += [np.sin(phase), np.cos(phase), np.sin(2 * phase), np.cos(2 * phase)]
    matrix = np.stack(columns, axis=1)
    (_, velocity, *_), *_ = np.linalg.lstsq(matrix, place[is_inside], rcond=None)
    return float(np.hypot(*velocity))


def along_body(time: np.ndarray, markers: np.ndarray, begin: float, end: float) -> float:
    """Mean speed of markers, head first, along the line through them [m/s]."""
    is_inside = (time >= begin) & (time <= end)
    line = -np.gradient(markers, axis=1)
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    velocity = np.gradient(markers, time, axis=0)
    speed = np.sum(velocity * line, axis=-1)
    return float(speed[is_inside].mean())


def distance_in_start(time: np.ndarray, middle: np.ndarray) -> float:
    """How far the LEDs' mean came in the start [m]."""
    x, y = (np.interp(STARTED, time, values) for values in middle.T)
    return float(np.hypot(x[1] - x[0], y[1] - y[0]))


def figures(trial: lc.Trial) -> dict[str, float]:
    """What a run gives: the speeds of SPANS [m/s], and how far it came in the start [m]."""
    markers = marker_places(trial, ALONG)
    middle = markers.mean(axis=1)
    values: dict[str, float] = {}
    for name, span in SPANS.items():
        if name.startswith("swim"):
            values[name] = steady(trial.time, middle, span.begin, span.end)
        else:
            values[name] = along_body(trial.time, markers, span.begin, span.end)
    values["start"] = distance_in_start(trial.time, middle)
    return values


def measured() -> dict[str, float]:
    """The same of the real robot."""
    values = {name: span.speed for name, span in SPANS.items()}
    seen = track()
    values["start"] = distance_in_start(seen.time, seen.place.mean(axis=1))
    return values


def stated_intervals(trial: lc.Trial) -> dict[str, tuple[float, float]]:
    """Between what the figures lie, by what is known of the coefficients and by what the model missed such motion."""
    kinds = {"swim": "swimming", "glide": "gliding", "start": "starting"}
    intervals: dict[str, tuple[float, float]] = {}
    for name, interval in figure_intervals(trial, figures=figures).items():
        motion, *_ = name.split()
        intervals[name] = widen_by_textbook_error(interval, kinds[motion])
    return intervals


def null_models() -> dict[str, dict[str, float]]:
    """The same, as far as models without hydrodynamics go."""
    robot = lc.load_robot("amphibot")
    tail_swing = 2.0 * 0.092  # of the last LED, from side to side [m]
    swims = [name for name in SPANS if name.startswith("swim")]
    by_stride = STRIDE * robot.length * FREQUENCY
    by_strouhal_number = tail_swing * FREQUENCY / STROUHAL
    return {
        f"stride of {STRIDE} body lengths": dict.fromkeys(swims, by_stride),
        f"Strouhal number {STROUHAL}": dict.fromkeys(swims, by_strouhal_number),
        f"quadratic coast, C = {COAST}": quadratic_coast(robot),
    }


def quadratic_coast(robot: lc.Robot) -> dict[str, float]:
    """Speeds of the glides if drag is quadratic; they begin with the speed of the swim, and no wave."""
    section = robot.modules[0].section
    wetted_surface = math.pi * robot.length * (section.half_height + section.half_width)
    decay = 0.5 * 1000.0 * COAST * wetted_surface / robot.mass  # [1/m]
    begin = 8.03
    speed = SPANS["swim 2"].speed

    def distance(time: float) -> float:
        return math.log1p(speed * decay * (time - begin)) / decay

    speeds: dict[str, float] = {}
    for name, span in SPANS.items():
        if name.startswith("glide"):
            way = distance(span.end) - distance(span.begin)
            speeds[name] = way / (span.end - span.begin)
    return speeds


def row(title: str, values: Mapping[str, float], real: Mapping[str, float]) -> str:
    """A line of the table: values, and by how many percent they miss."""
    cells: list[str] = []
    for name, real_value in real.items():
        cell = ""
        if name in values:
            error = 100 * (values[name] / real_value - 1)
            cell = f"{values[name]:.3f} ({error:+4.0f} %)"
        cells.append(cell)
    return f"{title:34}" + "".join(f"{cell:>16}" for cell in cells)


def main() -> None:
    """The table."""
    real = measured()
    seen = track()
    print(" " * 34 + "".join(f"{name:>16}" for name in real))
    print(f"{'measured [m/s, m]':34}" + "".join(f"{value:>16.3f}" for value in real.values()))
    waters = {
        "textbook, beta 0.5": textbook(drag=lc.TotalSpeedDrag(beta=0.5)),
        "textbook, beta 0.0": textbook(drag=lc.TotalSpeedDrag(beta=0.0)),
        "textbook, beta 1.0": textbook(drag=lc.TotalSpeedDrag(beta=1.0)),
        "textbook, no shed edge": textbook(trailing_edge="none"),
        "paper-lateral": lc.load_water("paper-lateral"),
    }
    for name, water in waters.items():
        trial = swum(water)
        time, gap = marker_distance(trial, seen, ALONG, fitted=(0.4, 1.1))
        millimeters = 1000 * np.interp(4.5, time, gap)
        print(row(name, figures(trial), real), f"  LEDs {millimeters:.0f} mm apart at 4.5 s")
    for name, values in null_models().items():
        print(row(name, values, real))
    trial = swum(textbook())
    intervals_of_figures = {
        "coefficients in their intervals": figure_intervals(trial, figures=figures),
        "stated": stated_intervals(trial),
    }
    for title, intervals in intervals_of_figures.items():
        cells = [f"{low:.3f} to {high:.3f}" for low, high in intervals.values()]
        print(f"{title:34}" + "".join(f"{cell:>16}" for cell in cells))


if __name__ == "__main__":
    main()
