"""Which guidance law holds a line in which water, and what do waves cost?

Question: Mamba with its fin follows the x axis, from up to 0.5 m beside it and 30 deg off, in six
waters, with line of sight, integral line of sight, both with an observer of the current, and a
plan. How far off is it in the second half, what does a meter take, for how long is the steering at
its limit? And what does a meter with, against and across waves take, against still water?

    python campaigns/currents.py                  # the tables, from currents.csv
    python campaigns/currents.py --run --jobs 2   # all runs anew, some ten minutes of one core; writes currents.csv
    python campaigns/currents.py --figure docs/images/currents.png

Lateral undulation of 30 deg, 90 deg/s, 40 deg; prescribed joints. A seed is a start and a
realization of the water. The error is the root mean square of the cycle mean; a law holds the line
if that is below 0.1 m. Intervals are of the mean over seeds, 95 %, Student's t.
"""

import argparse
import csv
import itertools
import math
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import t as student

import laticauda as lc
from laticauda.control import CurrentObserver, ModelPredictive
from laticauda.studies import averaged_model
from laticauda.trials import following
from laticauda.water.fluid.eddies import KarmanStreet, Turbulence
from laticauda.water.fluid.flow import Flow

STORED = Path(__file__).with_suffix(".csv")
SEEDS = 20
"""Seeds of every water and law."""
DURATION = 90.0
"""Duration of a run [s]."""
HELD = 0.1
"""Error below which a law holds the line [m]."""
KINDS: dict[str, Any] = {"water": str, "law": str, "seed": int}
"""Kinds of columns; others are numbers."""
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
LEFT = math.pi / 2
"""Direction across the line [rad]."""

Water = Flow | tuple[float, float]


def shear() -> Water:
    """Across the line, from none at the origin to 0.06 m/s 10 m further."""
    from laticauda.water.fluid.uniform import LinearShear

    return LinearShear(direction=LEFT, across=-0.006)


def sea(seed: int) -> Water:
    """Short-crested waves across the line, of 6 m."""
    from laticauda.water.fluid.waves import Sea

    return Sea(
        significant_height=0.08,
        peak_period=2.0,
        direction=LEFT,
        spread=0.4,
        components=16,
        seed=seed,
    )


def regular(height: float, period: float, direction: float, phase: float) -> Water:
    """Waves of one period."""
    from laticauda.water.fluid.waves import Waves

    return Waves(height=height, period=period, direction=direction, phase=phase)


WATERS: dict[str, Callable[[np.random.Generator, int], Water]] = {
    "still": lambda chance, seed: (0.0, 0.0),
    "uniform": lambda chance, seed: (0.0, 0.05),
    "shear": lambda chance, seed: shear(),
    "waves": lambda chance, seed: sea(seed),
    # The line goes up the middle of the street.
    "street": lambda chance, seed: KarmanStreet(
        speed=0.05, direction=math.pi, diameter=0.5, x=14.0, phase=chance.uniform(-math.pi, math.pi)
    ),
    "turbulence": lambda chance, seed: Turbulence(
        intensity=0.03,
        largest=4.0,
        smallest=0.8,
        mean=(0.0, 0.03, 0.0),
        evolution=1.0,
        modes=24,
        seed=seed,
    ),
}
DIRECTIONS = {"with": 0.0, "across": LEFT, "against": math.pi}
PERIODS = (1.0, 2.0)
"""Periods of waves [s]; they are 1.56 m and 6.2 m long, the robot 1.7 m."""
OBSERVED = "LOS, observer"
"""The law in those waves."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run, its second half."""

    water: str
    law: str
    seed: int
    error: float
    """Root mean square of the cycle mean of the cross-track error [m]."""
    energy: float
    """Mechanical work of the joints per meter along the line; infinite where it goes nowhere [J/m]."""
    saturated: float
    """Share of the time with the offset at its limit [-]."""
    along: float
    """Speed along the line [m/s]."""
    missed: float
    """Root mean square of what the observer has for the current less what is so [m/s]; nan without one."""
    std: float
    """The same of what it says of itself [m/s]."""


@cache
def model() -> lc.control.AveragedModel:
    """How the gait moves the robot in still water."""
    return averaged_model(
        lc.build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral")), GAIT
    )


def laws() -> dict[str, Any]:
    """The controllers, by name."""
    observer = CurrentObserver(model=model())

    def line_of_sight(
        integral_gain: float, observer: CurrentObserver | None = None
    ) -> lc.PathFollowing:
        return lc.PathFollowing(
            gait=GAIT,
            path=lc.StraightLine(),
            guidance=lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=integral_gain),
            heading=lc.HeadingController(gain=0.25, max_offset=math.radians(20.0)),
            observer=observer,
        )

    plan = ModelPredictive(
        gait=GAIT, path=lc.StraightLine(), model=model(), speed=model().speed(GAIT.frequency, 0.0)
    )
    # Beside an observer the integral has the rest to take alone: a sixth of its gain.
    return {
        "LOS": line_of_sight(0.0),
        "ILOS": line_of_sight(0.12),
        OBSERVED: line_of_sight(0.0, observer),
        "ILOS, observer": line_of_sight(0.02, observer),
        "MPC": plan,
    }


def run(water: str, law: str, seed: int, duration: float = DURATION) -> Run:
    """One run; waters beside those of `WATERS` are `waves <direction> <period>`."""
    chance = np.random.default_rng(seed)
    start = lc.Start(
        center_of_mass=(0.0, chance.uniform(-0.5, 0.5)),
        heading=math.radians(chance.uniform(-30.0, 30.0)),
    )
    if water in WATERS:
        current = WATERS[water](chance, seed)
    else:
        _, direction, period = water.split()
        phase = chance.uniform(-math.pi, math.pi)
        current = regular(0.08, float(period), DIRECTIONS[direction], phase)
    moving_water = replace(lc.load_water("paper-lateral"), current=current)
    plant = lc.build_plant(lc.load_robot("mamba-fin"), moving_water, offset_bandwidth=10.0)
    trial = lc.run(plant, laws()[law], duration, start=start)
    assert trial.period is not None
    signals = trial.signals
    is_late = trial.time >= 0.5 * duration
    time, error = following.mean_error(trial.time, signals["cross_track_error"], trial.period)
    distances = signals["along_track_distance"]
    distance = float(distances[-1] - distances[is_late][0])
    energy = math.inf
    if distance > 0.0:
        energy = float(np.ptp(trial.work[is_late, 0])) / distance
    missed, std = math.nan, math.nan
    if "drift_x" in signals:
        drift = vectors_of(signals, "drift_{}")[is_late]
        true_drift = moving_water.velocity(trial.center_of_mass[is_late], trial.time[is_late])
        missed = root_mean_square(drift - true_drift)
        std = root_mean_square(vectors_of(signals, "drift_{}_std")[is_late])
    return Run(
        water=water,
        law=law,
        seed=seed,
        error=float(np.sqrt(np.mean(error[time >= 0.5 * duration] ** 2))),
        energy=energy,
        saturated=float(np.mean(signals["is_saturated"][is_late])),
        along=distance / (0.5 * duration),
        missed=missed,
        std=std,
    )


def vectors_of(signals: Any, name: str) -> np.ndarray:
    """Vectors in rows, from signals of their components."""
    return np.stack([signals[name.format(axis)] for axis in "xy"], axis=1)


def root_mean_square(vectors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))


class Case(NamedTuple):
    """Arguments of `run`."""

    water: str
    law: str
    seed: int


def cases() -> list[Case]:
    """All runs; those in one water one after the other, for its kernel."""
    cases_of_waters = itertools.product(WATERS, laws(), range(SEEDS))
    waves = [
        f"waves {direction} {period:g}"
        for period, direction in itertools.product(PERIODS, DIRECTIONS)
    ]
    cases_of_waves = itertools.product(waves, [OBSERVED], range(SEEDS // 2))
    return [Case(*case) for case in (*cases_of_waters, *cases_of_waves)]


def stored() -> list[Run]:
    """The answer."""
    with STORED.open(encoding="utf-8") as file:
        return [read_run(row) for row in csv.DictReader(file)]


def read_run(row: dict[str, str]) -> Run:
    values: dict[str, Any] = {}
    for name, text in row.items():
        kind = KINDS.get(name, float)
        values[name] = kind(text)
    return Run(**values)


def describe_mean(values: Sequence[float], scale: float, digits: int) -> str:
    """Mean over seeds and half of its interval, 95 %, in a unit of which there are `scale` in one of the values."""
    mean = float(np.mean(values))
    if not math.isfinite(mean):
        return "-"
    n = len(values)
    half = float(student.ppf(0.975, n - 1) * np.std(values, ddof=1) / math.sqrt(n))
    return f"{scale * mean:.{digits}f} ± {scale * half:.{digits}f}"


HEADS = (
    "water",
    "law",
    "held",
    "error [mm]",
    "J/m",
    "m/s",
    "saturated [%]",
    "current missed by [mm/s]",
    "it says",
)
HEADS_OF_WAVES = ("waves", "J/m", "against still water", "m/s", "error [mm]")


def tables(runs: list[Run]) -> str:
    """As they stand in docs/theory/moving-water.md."""
    lines = [f"| {' | '.join(HEADS)} |", "|---" * len(HEADS) + "|"]
    for water in WATERS:
        laws_in_water = dict.fromkeys(run.law for run in runs if run.water == water)
        for law in laws_in_water:
            runs_of_law = [run for run in runs if (run.water, run.law) == (water, law)]
            lines.append(f"| {' | '.join(cells_of_law(runs_of_law))} |")
    lines += ["", f"| {' | '.join(HEADS_OF_WAVES)} |", "|---" * len(HEADS_OF_WAVES) + "|"]
    runs_in_still_water = {
        run.seed: run for run in runs if (run.water, run.law) == ("still", OBSERVED)
    }
    for water in dict.fromkeys(run.water for run in runs if run.water not in WATERS):
        runs_in_waves = [run for run in runs if run.water == water]
        lines.append(f"| {' | '.join(cells_of_waves(runs_in_waves, runs_in_still_water))} |")
    return "\n".join(lines)


def cells_of_law(runs: list[Run]) -> list[str]:
    """Cells of a law in a water."""
    n_held = sum(run.error < HELD and run.along > 0.0 for run in runs)
    return [
        runs[0].water,
        runs[0].law,
        f"{n_held} of {len(runs)}",
        describe_mean([run.error for run in runs], 1e3, 0),
        describe_mean([run.energy for run in runs], 1.0, 1),
        describe_mean([run.along for run in runs], 1.0, 3),
        describe_mean([run.saturated for run in runs], 100.0, 1),
        describe_mean([run.missed for run in runs], 1e3, 0),
        describe_mean([run.std for run in runs], 1e3, 0),
    ]


def cells_of_waves(runs: list[Run], runs_in_still_water: dict[int, Run]) -> list[str]:
    """Cells of waves, beside the runs from the same starts in still water."""
    more_energy = [
        100.0 * (run.energy / runs_in_still_water[run.seed].energy - 1.0) for run in runs
    ]
    return [
        f"{runs[0].water.removeprefix('waves ')} s",
        describe_mean([run.energy for run in runs], 1.0, 1),
        f"{describe_mean(more_energy, 1.0, 1)} %",
        describe_mean([run.along for run in runs], 1.0, 3),
        describe_mean([run.error for run in runs], 1e3, 0),
    ]


def figure(runs: list[Run], path: str) -> None:
    """The error of every run, by water and law."""
    from laticauda.show.figures import save_figure, style

    drawn = style.new_figure(style.DOUBLE_COLUMN, 0.45 * style.DOUBLE_COLUMN)
    ax = drawn.subplots()
    waters = list(WATERS)
    for k, law in enumerate(dict.fromkeys(run.law for run in runs)):
        runs_of_law = [run for run in runs if run.law == law and run.water in WATERS]
        places: list[float] = []
        for run_of_law in runs_of_law:
            beside_others = 0.16 * (k - 2) + 0.004 * (run_of_law.seed - 9.5)
            places.append(waters.index(run_of_law.water) + beside_others)
        errors = [max(run_of_law.error, 1e-4) for run_of_law in runs_of_law]
        ax.plot(places, errors, ".", markersize=3, label=law)
    ax.axhline(HELD, color=style.INK, linewidth=0.6, linestyle=":")
    ax.set_yscale("log")
    ax.set_xticks(range(len(waters)), waters)
    style.style_axes(ax, xlabel="", ylabel="cross-track error [m]")
    style.add_legend(ax, loc="lower right", ncols=2)
    save_figure(drawn, path)


def write_runs(runs: list[Run]) -> None:
    with STORED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(asdict(runs[0]))
        for finished in runs:
            values = asdict(finished).values()
            writer.writerow([f"{x:.5g}" if isinstance(x, float) else x for x in values])


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--figure")
    options = parser.parse_args()
    if options.run:
        waters, names_of_laws, seeds = zip(*cases(), strict=True)
        with ProcessPoolExecutor(options.jobs) as pool:
            runs = list(pool.map(run, waters, names_of_laws, seeds, chunksize=10))
        write_runs(runs)
    print(tables(stored()))
    if options.figure:
        figure(stored(), options.figure)


if __name__ == "__main__":
    main()
