"""The paper's Table 2, operated from end to end in the virtual tank: is it what the simulation says?

Question: `laticauda operate table2_series.toml` with its twelve settings, each repeated, on the
virtual tank without wires: every run is prepared, swum, stopped and recorded as on the robot, with
noise of its own, and a robot that somebody put down 2 cm and 1 deg off (standard deviations, an
assumption). Beside it the paper's measurement, and the same trial simulated with servo joints and
nothing in between.

    python campaigns/operate_table2.py                    # 12 settings, 3 runs each
    python campaigns/operate_table2.py --repeats 2 --workers 2 --output out/table2

The folder holds what goes on from here: the trials are what `laticauda identify` takes,
`repeats.csv` what `laticauda reproduce --repeats` takes. A campaign that was stopped goes on where
it was.
"""

import argparse
import json
import math
import sys
import zlib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.paper import TABLE2
from laticauda.paper.measured import read_path_following_trials
from laticauda.tank.lab import LabSettings, Tank, VirtualRobot
from laticauda.tank.operate.series import Series, run_series
from laticauda.tank.operate.session import Result, operate
from laticauda.tank.operate.settings import Operation, load_operation
from laticauda.trials import following

PLACED, TURNED = (
    0.02,
    math.radians(1.0),
)  # how well somebody puts the robot down: an assumption [m], [rad]


def operated(operation: Operation, folder: Path) -> Result:
    """One run in a tank of its own; its name says which chance it has."""
    seed = zlib.crc32(operation.name.encode())
    chance = np.random.default_rng(seed)
    off = PLACED * chance.standard_normal(2)
    x, y = np.array(operation.start.position) + off
    heading = operation.start.heading + TURNED * float(chance.standard_normal())
    robot = operation.body()
    servos = lc.build_plant(robot, operation.pool(), joints="servo")
    world = VirtualRobot(
        robot, servos, lc.Start(center_of_mass=(float(x), float(y)), heading=heading)
    )
    twin = lc.build_plant(robot, operation.pool(), joints="servo")
    meter = "" if operation.supply_voltage is None else "stepped"
    operation = replace(operation, connection=replace(operation.connection, meter_address=meter))
    (folder / f"{operation.name}.mcap").unlink(
        missing_ok=True
    )  # of a run that was stopped or rejected
    return operate(
        operation, folder, tank=Tank(world, LabSettings(seed=seed)), twin=twin, frames=False
    )


def simulated(operation: Operation) -> lc.Trial:
    """The same controller on the same model, with servo joints and nothing in between."""
    body = lc.build_plant(
        operation.body(),
        operation.pool(),
        joints="servo",
        ramp=operation.ramp,
        offset_bandwidth=operation.offset_bandwidth,
    )
    start = lc.Start(center_of_mass=operation.start.position, heading=operation.start.heading)
    return lc.run(body, operation.controller(), operation.duration, start=start)


def setting(number: int, repeats: int, duration: float | None, folder: Path) -> Series:
    """All runs of one setting, in a folder of its own."""
    series = load_operation(TABLE2)
    what = series.trials[number]
    what = what if duration is None else replace(what, duration=duration)
    series = replace(series, name=what.name, repeats=repeats, trials=(what,))
    return run_series(series, folder / what.name, operated)


def row(number: int, repeats: int, duration: float | None, folder: Path) -> dict[str, object]:
    """One line of the table, and what was rejected."""
    series = setting(number, repeats, duration, folder)
    (done,) = series.settings
    pure = simulated(done.operation)
    names = (
        "forward_velocity",
        "electrical_power",
        "total_power",
        "convergence_time",
        "steady_error",
    )
    measured = read_path_following_trials()[number]
    return {
        "name": done.operation.name,
        "accepted": len(done.accepted),
        "rejected": [f"{one.name}: {one.reason}" for one in done.results if not one.accepted],
        "aftermath": [f"{one.name}: {one.aftermath}" for one in done.results if one.aftermath],
        **{name: done.figure(name) for name in names},
        "simulated_velocity": pure.forward_velocity,
        "simulated_power": pure.electrical_power,
        "simulated_error": following.summarize_following(pure)["steady_error"],
        "measured_velocity": measured.forward_velocity,
        "measured_power": measured.mean_power,
    }


def gathered(folder: Path) -> None:
    """One table of repeats of all settings, as one series would have written it."""
    parts = [
        path.read_text(encoding="utf-8").splitlines()
        for path in sorted(folder.glob("*/repeats.csv"))
    ]
    lines = [parts[0][0], *(line for part in parts for line in part[1:])]
    (folder / "repeats.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


def table(rows: list[dict[str, object]]) -> str:
    """As it stands in docs/how-to/operate.md: speeds and errors, then powers."""
    speeds = [
        "| setting | v operated [m/s] | simulated | difference | measured | p_y operated [m] | simulated |",
        "|---|---|---|---|---|---|---|",
    ]
    powers = [
        "| setting | P above idle, operated [W] | simulated | measured | P total [W] |",
        "|---|---|---|---|---|",
    ]
    for one in rows:
        velocity, error = one["forward_velocity"], one["simulated_error"]
        name = (
            str(one["name"])
            .replace("lateral-undulation", "lateral")
            .replace("-fin", ", fin")
            .replace("-case-", ", ")
        )
        away = (
            ""
            if velocity is None
            else f"{100 * (velocity[0] / one['simulated_velocity'] - 1):+.1f} %"
        )
        swum = (
            shown(velocity, 4),
            f"{one['simulated_velocity']:.4f}",
            away,
            f"{one['measured_velocity']:.4f}",
        )
        beside = (shown(one["steady_error"], 3), "-" if error is None else f"{error:.3f}")
        drawn = (
            shown(one["electrical_power"], 1),
            f"{one['simulated_power']:.1f}",
            f"{one['measured_power']:.1f}",
        )
        speeds.append(f"| {' | '.join((name, *swum, *beside))} |")
        powers.append(f"| {' | '.join((name, *drawn, shown(one['total_power'], 1)))} |")
    said = [f"{one['name']}: {one['accepted']} runs accepted" for one in rows]
    said += [f"rejected: {text}" for one in rows for text in one["rejected"]]
    said += [text for one in rows for text in one["aftermath"]]
    return "\n".join([*speeds, "", *powers, "", *said])


def shown(figure, digits: int) -> str:
    if figure is None:
        return "-"
    mean, deviation = figure
    return f"{mean:.{digits}f}" + ("" if deviation is None else f" ± {deviation:.{digits}f}")


def main() -> int:
    """Run, print, and write table.json beside the trials."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--duration", type=float, help="of every run [s]; the file's otherwise")
    parser.add_argument(
        "--settings", type=int, nargs="*", help="their numbers, 0 to 11; all otherwise"
    )
    parser.add_argument("--output", type=Path, default=Path("out/table2"))
    options = parser.parse_args()
    numbers = options.settings or range(len(load_operation(TABLE2).trials))
    rows: list[dict[str, object]] = []
    with ProcessPoolExecutor(options.workers) as pool:
        waiting = [
            pool.submit(row, n, options.repeats, options.duration, options.output) for n in numbers
        ]
        for one in waiting:
            rows.append(one.result())
            print(
                f"{rows[-1]['name']}: {rows[-1]['accepted']} accepted", file=sys.stderr, flush=True
            )
    gathered(options.output)
    (options.output / "table.json").write_text(json.dumps(rows, indent=1), encoding="utf-8")
    print(table(rows))
    away = [
        abs(one["forward_velocity"][0] / one["simulated_velocity"] - 1)
        for one in rows
        if one["forward_velocity"]
    ]
    print(f"velocities differ from the simulation's by up to {100 * max(away):.1f} %")
    return 0 if all(one["accepted"] >= options.repeats for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
