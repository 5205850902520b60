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
import math
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import t as student

import laticauda as lc
from laticauda.control import CurrentObserver, ModelPredictive
from laticauda.studies import averaged_model
from laticauda.trials import following
from laticauda.water.fluid.eddies import KarmanStreet, Turbulence
from laticauda.water.fluid.flow import Flow

STORED = Path(__file__).with_suffix(".csv")
SEEDS, DURATION = 20, 90.0  # [-], [s]
HELD = 0.1  # m
KINDS: dict[str, Any] = {"water": str, "law": str, "seed": int}  # of columns; others are numbers
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
LEFT = math.pi / 2  # across the line

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
PERIODS = (1.0, 2.0)  # of waves [s]; they are 1.56 m and 6.2 m long, the robot 1.7 m
OBSERVED = "LOS, observer"  # the law in those


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

    def sight(sigma: float, observer: CurrentObserver | None = None) -> lc.PathFollowing:
        law = lc.IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=sigma)
        turns = lc.HeadingController(gain=0.25, max_offset=math.radians(20.0))
        return lc.PathFollowing(
            gait=GAIT, path=lc.StraightLine(), guidance=law, heading=turns, observer=observer
        )

    plan = ModelPredictive(
        gait=GAIT, path=lc.StraightLine(), model=model(), speed=model().speed(GAIT.frequency, 0.0)
    )
    # Beside an observer the integral has the rest to take alone: a sixth of its gain.
    return {
        "LOS": sight(0.0),
        "ILOS": sight(0.12),
        OBSERVED: sight(0.0, observer),
        "ILOS, observer": sight(0.02, observer),
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
        _, way, period = water.split()
        phase = chance.uniform(-math.pi, math.pi)
        current = regular(0.08, float(period), DIRECTIONS[way], phase)
    moving = replace(lc.load_water("paper-lateral"), current=current)
    body = lc.build_plant(lc.load_robot("mamba-fin"), moving, offset_bandwidth=10.0)
    trial = lc.run(body, laws()[law], duration, start=start)
    assert trial.period is not None
    signals, late = trial.signals, trial.time >= 0.5 * duration
    middle, error = following.mean_error(trial.time, signals["cross_track_error"], trial.period)
    missed, std = math.nan, math.nan
    along = float(signals["along_track_distance"][-1] - signals["along_track_distance"][late][0])
    if "drift_x" in signals:
        drift, sure = (
            np.stack([signals[f"drift_{axis}{end}"][late] for axis in "xy"], axis=1)
            for end in ("", "_std")
        )
        true = moving.velocity(trial.center_of_mass[late], trial.time[late])
        missed, std = (
            float(np.sqrt(np.mean(np.sum(one**2, axis=1)))) for one in (drift - true, sure)
        )
    return Run(
        water=water,
        law=law,
        seed=seed,
        error=float(np.sqrt(np.mean(error[middle >= 0.5 * duration] ** 2))),
        energy=float(np.ptp(trial.work[late, 0])) / along if along > 0.0 else math.inf,
        saturated=float(np.mean(signals["is_saturated"][late])),
        along=along / (0.5 * duration),
        missed=missed,
        std=std,
    )


def cases() -> list[tuple[str, str, int]]:
    """All runs; those in one water one after the other, for its kernel."""
    waves = [f"waves {way} {period:g}" for period in PERIODS for way in DIRECTIONS]
    return [(water, law, seed) for water in WATERS for law in laws() for seed in range(SEEDS)] + [
        (water, OBSERVED, seed) for water in waves for seed in range(SEEDS // 2)
    ]


def stored() -> list[Run]:
    """The answer."""
    with STORED.open(encoding="utf-8") as file:
        rows = csv.DictReader(file)
        return [
            Run(**{name: KINDS.get(name, float)(text) for name, text in row.items()})
            for row in rows
        ]


def interval(values: Iterable[float]) -> tuple[float, float]:
    """Mean over seeds and half of its interval, 95 %."""
    found = np.array([*values])
    half = student.ppf(0.975, found.size - 1) * found.std(ddof=1) / math.sqrt(found.size)
    return float(found.mean()), float(half)


def shown(values: Iterable[float], scale: float, digits: int) -> str:
    """Of a cell."""
    mean, half = interval(values)
    return f"{scale * mean:.{digits}f} ± {scale * half:.{digits}f}" if math.isfinite(mean) else "-"


def tables(runs: list[Run]) -> str:
    """As they stand in docs/theory/moving-water.md."""
    heads = (
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
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for water in WATERS:
        for law in dict.fromkeys(one.law for one in runs if one.water == water):
            these = [one for one in runs if (one.water, one.law) == (water, law)]
            held = sum(one.error < HELD and one.along > 0.0 for one in these)
            cells = [
                water,
                law,
                f"{held} of {len(these)}",
                shown((one.error for one in these), 1e3, 0),
            ]
            cells += [
                shown((one.energy for one in these), 1.0, 1),
                shown((one.along for one in these), 1.0, 3),
            ]
            cells += [shown((one.saturated for one in these), 100.0, 1)]
            cells += [
                shown((getattr(one, name) for one in these), 1e3, 0) for name in ("missed", "std")
            ]
            lines.append(f"| {' | '.join(cells)} |")
    lines += [
        "",
        "| waves | J/m | against still water | m/s | error [mm] |",
        "|---|---|---|---|---|",
    ]
    still = {one.seed: one for one in runs if (one.water, one.law) == ("still", OBSERVED)}
    for water in dict.fromkeys(one.water for one in runs if one.water not in WATERS):
        these = [one for one in runs if one.water == water]
        more = [
            100.0 * (one.energy / still[one.seed].energy - 1.0) for one in these
        ]  # from the same start
        cells = [f"{water.removeprefix('waves ')} s", shown((one.energy for one in these), 1.0, 1)]
        cells += [f"{shown(more, 1.0, 1)} %", shown((one.along for one in these), 1.0, 3)]
        lines.append(f"| {' | '.join([*cells, shown((one.error for one in these), 1e3, 0)])} |")
    return "\n".join(lines)


def figure(runs: list[Run], path: str) -> None:
    """The error of every run, by water and law."""
    from laticauda.show.figures import save_figure, style

    drawn = style.new_figure(style.DOUBLE_COLUMN, 0.45 * style.DOUBLE_COLUMN)
    ax, names = drawn.subplots(), [*dict.fromkeys(one.law for one in runs)]
    for k, law in enumerate(names):
        chosen = [one for one in runs if one.law == law and one.water in WATERS]
        place = [
            [*WATERS].index(one.water) + 0.16 * (k - 2) + 0.004 * (one.seed - 9.5) for one in chosen
        ]
        ax.plot(place, [max(one.error, 1e-4) for one in chosen], ".", markersize=3, label=law)
    ax.axhline(HELD, color=style.INK, linewidth=0.6, linestyle=":")
    ax.set_yscale("log")
    ax.set_xticks(range(len(WATERS)), list(WATERS))
    style.style_axes(ax, xlabel="", ylabel="cross-track error [m]")
    style.add_legend(ax, loc="lower right", ncols=2)
    save_figure(drawn, path)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--figure")
    options = parser.parse_args()
    if options.run:
        with ProcessPoolExecutor(options.jobs) as pool:
            found = list(pool.map(run, *zip(*cases(), strict=True), chunksize=10))
        with STORED.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(asdict(found[0]))
            for one in found:
                writer.writerow(
                    [f"{x:.5g}" if isinstance(x, float) else x for x in asdict(one).values()]
                )
    print(tables(stored()))
    if options.figure:
        figure(stored(), options.figure)


if __name__ == "__main__":
    main()
