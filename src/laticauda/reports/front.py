"""What an optimization leaves for its readers: the front as files, and as a figure with its gaits."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laticauda.simulate import swim_many
from laticauda.simulate.numbers import parameters, place
from laticauda.studies import Front
from laticauda.studies.trials import QUANTITIES
from laticauda.trial import MeasuredTrial, all_measured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.figures.front import FrontLine

N_MARKS = 5
SYMBOLS = {"amplitude": "$\\alpha$", "frequency": "$\\omega$", "phase shift": "$\\delta$", "n links": "$n$"}
MOST = 34  # characters in a line below a body


def write_front(front: Front, folder: str | Path) -> list[Path]:
    """Write front.csv and front.nc.

    Args:
        front: What `optimize` returned.
        folder: An existing one.

    Returns:
        The files.
    """
    files = [Path(folder, "front.csv"), Path(folder, "front.nc")]
    front.write_csv(files[0])
    front.write_netcdf(files[1])
    return files


def write_front_figure(fronts: Sequence[Front], folder: str | Path) -> list[Path]:
    """Write front.png and front.pdf; nothing if there is no front between two objectives.

    Args:
        fronts: One or two with the same two objectives; those without points are left out.
        folder: An existing one.

    Returns:
        The files.
    """
    from laticauda.figures import save_figure

    drawn = [front for front in fronts if len(front) > 1]
    if not drawn:
        return []
    files = [Path(folder, "front.png"), Path(folder, "front.pdf")]
    save_figure(front_figure(drawn), *files)
    return files


def front_figure(fronts: Sequence[Front]) -> "Figure":
    """The fronts, and some of their gaits beside the measured ones for this robot and kind of gait.

    Args:
        fronts: One or two with the same two objectives.
    """
    from laticauda.figures.front import front_sheet

    sought = fronts[0].optimization
    first, last = sought.objectives
    trials = sum(front.n_trials for front in fronts)
    return front_sheet(
        [_line(front) for front in fronts],
        f"{_words(first).capitalize()} against {_words(last)}: robot {sought.scenario.robot.name}",
        f"{len(sought.names)} parameters free, {trials} trials of {sought.scenario.duration:g} s, {_waters(fronts)}",
        xlabel=_label(last),
        ylabel=_label(first),
    )


def _waters(fronts: Sequence[Front]) -> str:
    names = list(dict.fromkeys(front.optimization.scenario.environment.name for front in fronts))
    word = place(fronts[0].optimization.scenario.environment)
    return f"{word} {names[0]}" if len(names) == 1 else f"each gait with its own {word}: {' and '.join(names)}"


def _line(front: Front) -> "FrontLine":
    from laticauda.figures.front import FrontLine, Mark

    y, x = (front.figures[name] for name in front.optimization.objectives)
    marks: list[Mark] = []
    # The slowest end is left out: nobody swims there, and all fronts meet there.
    for i in front.spread(N_MARKS + 1)[1:]:
        swims, text = front.scenario(i), _numbers(front, i)
        marks.append(Mark(x=float(x[i]), y=float(y[i]), text=text, robot=swims.robot, gait=swims.gait))
    words = front.optimization.scenario.gait.words
    sources = " and ".join(dict.fromkeys(trial.source for trial in _measured(front)))
    return FrontLine(
        label=words,
        x=x,
        y=y,
        marks=tuple(marks),
        others=measured_points(front),
        others_label=f"{sources}'s gaits, simulated alike",
    )


def measured_points(front: Front) -> np.ndarray:
    """What the measured gaits of this kind come to with this robot, a row each: last objective, first one.

    Args:
        front: What `optimize` returned.
    """
    base = front.optimization.scenario
    gaits = [trial.gait for trial in _measured(front)]
    if not gaits:
        return np.empty((0, 2))
    swims = swim_many([replace(base, motion=gait) for gait in gaits])
    first, last = front.optimization.objectives
    points = np.stack((getattr(swims, last), getattr(swims, first)), axis=1)
    return points[np.isfinite(points).all(axis=1)]


def _measured(front: Front) -> list[MeasuredTrial]:
    """The published trials of this robot with this kind of gait."""
    base = front.optimization.scenario
    wanted = base.gait.kind, base.robot.name
    return [trial for one in all_measured() for trial in one.trials() if (trial.gait.kind, trial.robot) == wanted]


def _numbers(front: Front, i: int) -> str:
    """What the parameters of a point are, in a line or more."""
    known = parameters(front.optimization.scenario)
    words: list[tuple[str, str]] = []
    for name, value in zip(front.optimization.names, front.values[i], strict=True):
        unit, angle = known[name].unit, known[name].unit.startswith("rad")
        number = f"{math.degrees(value):.0f}°{unit.removeprefix('rad')}" if angle else f"{value:.3g} {unit}".strip()
        words.append((_words(name.split(".", 1)[1]).replace(".", " ").removeprefix("caudal "), number))
    lines: list[str] = []
    room = 0
    for word, number in sorted(words, key=lambda pair: pair[0] not in SYMBOLS):
        length = len(f"{'x' if word in SYMBOLS else word} = {number}, ")
        if length > room:
            lines.append("")
            room = MOST
        room -= length
        lines[-1] += f"{', ' if lines[-1] else ''}{SYMBOLS.get(word, word)} = {number}"
    return "\n".join(lines)


def _words(name: str) -> str:
    return name.replace("_", " ")


def _label(name: str) -> str:
    unit = QUANTITIES[name][0]
    return f"{_words(name)} [{'-' if unit == '1' else unit}]"
