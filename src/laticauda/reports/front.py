"""What an optimization leaves for its readers: the front as files, and as a figure with its gaits."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laticauda.simulate import swim_many
from laticauda.studies import GAIT_WORDS, Front, efficiency_settings
from laticauda.studies.trials import QUANTITIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.figures.front import FrontLine

N_MARKS = 5
SYMBOLS = {"gait.amplitude": "$\\alpha$", "gait.frequency": "$\\omega$", "gait.phase_shift": "$\\delta$"}
PER_LINE = 3  # numbers in a line below a body


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
    """The fronts, and some of their gaits beside the paper's for this robot and kind of gait.

    Args:
        fronts: One or two with the same two objectives.
    """
    from laticauda.figures.front import front_sheet

    problem = fronts[0].problem
    first, last = problem.objectives
    trials = sum(front.n_trials for front in fronts)
    return front_sheet(
        [_line(front) for front in fronts],
        f"{_words(first).capitalize()} against {_words(last)}: robot {problem.robot.name}",
        f"{len(problem.names)} parameters free, {trials} trials of {problem.duration:g} s",
        xlabel=_label(last),
        ylabel=_label(first),
    )


def _line(front: Front) -> "FrontLine":
    from laticauda.figures.front import FrontLine, Mark

    y, x = (front.figures[name] for name in front.problem.objectives)
    marks: list[Mark] = []
    # The slowest end is left out: nobody swims there, and all fronts meet there.
    for i in map(int, front.spread(N_MARKS + 1)[1:]):
        robot, gait, _ = front.things(i)
        marks.append(Mark(x=float(x[i]), y=float(y[i]), text=_numbers(front, i), robot=robot, gait=gait))
    words = GAIT_WORDS.get(front.problem.gait.kind, "custom gait")
    return FrontLine(
        label=words,
        x=x,
        y=y,
        marks=tuple(marks),
        others=paper_points(front),
        others_label="the paper's gaits, simulated alike",
    )


def paper_points(front: Front) -> np.ndarray:
    """What the paper's gaits of this kind come to with this robot, a row each: last objective, first one.

    Args:
        front: What `optimize` returned.
    """
    problem = front.problem
    groups = efficiency_settings().groups
    gaits = [
        gait
        for group in groups
        if (group.gait, group.robot) == (problem.gait.kind, problem.robot.name)
        for gait in group.cases
    ]
    if not gaits:
        return np.empty((0, 2))
    swims = swim_many(
        problem.robot,
        gaits,
        problem.duration,
        environments=problem.where,
        joints=problem.joints,
        dt=problem.dt,
        offset_bandwidth=problem.offset_bandwidth,
        ramp=problem.ramp,
    )
    first, last = problem.objectives
    points = np.stack((getattr(swims, last), getattr(swims, first)), axis=1)
    return points[np.isfinite(points).all(axis=1)]


def _numbers(front: Front, i: int) -> str:
    """What the parameters of a point are, in a line or two."""
    known = front.problem.known()
    words: list[str] = []
    for name, value in zip(front.problem.names, front.values[i], strict=True):
        angle, unit = known[name].unit.startswith("rad"), known[name].unit
        number = f"{math.degrees(value):.0f}°{unit.removeprefix('rad')}" if angle else f"{value:.3g}"
        number = number if angle or not unit else f"{number} {unit}"
        words.append(f"{SYMBOLS.get(name, name.rsplit('.', 1)[-1].replace('_', ' '))} = {number}")
    lines = [words[k : k + PER_LINE] for k in range(0, len(words), PER_LINE)]
    return "\n".join(", ".join(line) for line in lines)


def _words(name: str) -> str:
    return name.replace("_", " ")


def _label(name: str) -> str:
    unit = QUANTITIES[name][0]
    return f"{_words(name)} [{'-' if unit == '1' else unit}]"
