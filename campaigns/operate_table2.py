"""The paper's Table 2, operated from end to end in the virtual tank: does it swim like the robot in the paper's tank?

Question: the twelve settings of `laticauda operate table2_series.toml`, with the identified robot
(`mamba-identified`) in the virtual tank without wires: every run is prepared, swum, stopped, recorded
and judged as on the robot, with noise of its own, and a robot that somebody put down 2 cm and 1 deg
off (standard deviations, an assumption). How far is its speed from the paper's measurement? Is it
accepted, does it come to its path, and does it stay there? Does the operator's twin follow? Beside
it the same trial simulated with nothing in between.

    python campaigns/operate_table2.py                # the table, from operate_table2.csv
    python campaigns/operate_table2.py --run          # what is missing in it, a minute of a core each
    python campaigns/operate_table2.py --run --repeats 3 --workers 2 --output out/table2
    python campaigns/operate_table2.py --page docs/how-to/operate.md  # writes the table into the page

The folder of `--output` keeps recordings and trials: what `laticauda identify` and `laticauda
replay` take. Nothing of the robot was fitted to Table 2, whose speeds no choice here looked at but
that of `offset_bandwidth`; see docs/how-to/operate.md.
"""

import argparse
import csv
import math
import sys
import tempfile
import zlib
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.paper import TABLE2
from laticauda.paper.measured import read_path_following_trials
from laticauda.tank.lab import LabSettings, Tank, VirtualRobot
from laticauda.tank.operate.session import Result, operate
from laticauda.tank.operate.settings import CaptureVolume, Operation, load_operation
from laticauda.trials import following

STORED = Path(__file__).with_suffix(".csv")
BEGIN = "<!-- begin of operate_table2 -->"
END = "<!-- end of operate_table2 -->"
PLACED = 0.02
"""How well somebody puts the robot down, an assumption [m]."""
TURNED = math.radians(1.0)
"""The same for its heading, an assumption [rad]."""
RATE = 100.0
"""Ticks per second [1/s]."""
OFFSET_BANDWIDTH = 50.0
"""Of the filter on the steering, as in the series [rad/s]."""
LARGEST_ERROR = 10.0
"""Mean error of the speeds that is asked for [%]."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One run, beside the measurement and the plain simulation; nan where there is no figure."""

    setting: str
    repeat: int
    accepted: int
    velocity: float
    """(5) as operated [m/s]."""
    measured_velocity: float
    simulated_velocity: float
    electrical_power: float
    """Above idle, as the meter of the tank tells it [W]."""
    simulated_power: float
    measured_power: float
    duration: float
    convergence_time: float
    """When the cycle mean came within 0.1 m for a cycle [s]."""
    last_cycles_error: float
    """Largest cycle mean over the last three cycles [m]."""
    stays: int
    """Whether it came, and is within 0.1 m over the last three cycles."""
    steady_error: float
    twin_alive: int
    """Whether the filter still had its twin at the end."""
    twin_joint_error: float
    """Root mean square of the twin's joint angles minus the true ones [deg]."""
    twin_velocity: float
    """Mean speed of the twin along its own heading [m/s]."""
    true_velocity: float
    """The same of the robot in the tank [m/s]."""
    position_error: float
    """Root mean square of the estimate's center of mass minus the true one [m]."""
    heading_error: float
    """The same for the heading [deg]."""
    reason: str


@dataclass
class Watch:
    """What the filter, its twin and the robot did, tick by tick of the run."""

    tank: Tank
    volume: CaptureVolume
    joints: list[np.ndarray]
    twins: list[float]
    truths: list[np.ndarray]
    errors: list[np.ndarray]
    alive: bool = False

    def __call__(self, state: Any, outputs: object) -> None:
        """Look, after a tick."""
        if state.phase != "running" or state.estimate is None:
            return
        truth, estimate = self.tank.truth, state.estimate
        center = self.volume.to_path(truth.center_of_mass)[:2]
        twin = state.estimator.latest.twin
        self.alive = twin is not None
        self.truths.append(np.array([truth.time, *center, truth.heading]))
        off = estimate.center_of_mass - center
        self.errors.append(np.array([*off, math.degrees(estimate.heading - truth.heading)]))
        if twin is not None:
            self.joints.append(np.degrees(twin.joint_angle - truth.joint_angle))
            along = np.array([math.cos(twin.heading), math.sin(twin.heading)])
            self.twins.append(float(twin.velocity @ along))

    def figures(self) -> dict[str, float]:
        """The figures of a row; nan without a run."""
        if not self.truths:
            names = (
                "twin_joint_error",
                "twin_velocity",
                "true_velocity",
                "position_error",
                "heading_error",
            )
            return {"twin_alive": 0, **dict.fromkeys(names, math.nan)}
        time, x, y, heading = np.array(self.truths).T
        middle = 0.5 * (heading[1:] + heading[:-1])
        way = np.diff(x) * np.cos(middle) + np.diff(y) * np.sin(middle)
        error = np.array(self.errors)
        return {
            "twin_alive": int(self.alive),
            "twin_joint_error": _root_mean_square(np.array(self.joints)),
            "twin_velocity": float(np.mean(self.twins)) if self.twins else math.nan,
            "true_velocity": float(np.sum(way) / (time[-1] - time[0])),
            "position_error": _root_mean_square(np.hypot(error[:, 0], error[:, 1])),
            "heading_error": _root_mean_square(error[:, 2]),
        }


def _root_mean_square(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else math.nan


def built(operation: Operation) -> Any:
    """The robot of an operation in its water, with its joint law."""
    return lc.build_plant(operation.body(), operation.pool(), joints=operation.joint_law())


def operated(operation: Operation, folder: Path) -> Result:
    """One run in a tank of its own; its name says which chance it has."""
    return watched(operation, folder)[0]


def watched(operation: Operation, folder: Path) -> tuple[Result, Watch]:
    """One run, and what was seen of it."""
    seed = zlib.crc32(operation.name.encode())
    chance = np.random.default_rng(seed)
    off = PLACED * chance.standard_normal(2)
    x, y = operation.tank.to_tank(np.array([*(np.array(operation.start.position) + off), 0.0]))[:2]
    heading = operation.start.heading + TURNED * float(chance.standard_normal())
    start = lc.Start(center_of_mass=(float(x), float(y)), heading=heading)
    world = VirtualRobot(operation.body(), built(operation), start)
    meter = "" if operation.supply_voltage is None else "stepped"
    operation = replace(operation, connection=replace(operation.connection, meter_address=meter))
    for ending in ("mcap", "nc"):  # of a run that was stopped or rejected
        (folder / f"{operation.name}.{ending}").unlink(missing_ok=True)
    tank = Tank(world, LabSettings(seed=seed))
    watch = Watch(tank, operation.tank, [], [], [], [])
    result = operate(operation, folder, tank=tank, twin=built(operation), frames=False, show=watch)
    return result, watch


def simulated(operation: Operation, duration: float) -> lc.Trial:
    """The same controller on the same model for as long [s], with nothing in between."""
    body = lc.build_plant(
        operation.body(),
        operation.pool(),
        joints=operation.joint_law(),
        ramp=operation.ramp,
        offset_bandwidth=operation.offset_bandwidth,
    )
    start = lc.Start(center_of_mass=operation.start.position, heading=operation.start.heading)
    return lc.run(body, operation.controller(), duration, start=start)


def run(number: int, repeat: int, folder: Path | None, changes: dict[str, Any]) -> Row:
    """One run of one setting."""
    usual = {"rate": RATE, "offset_bandwidth": OFFSET_BANDWIDTH}
    operation = replace(load_operation(TABLE2).trials[number], **{**usual, **changes})
    measured = read_path_following_trials()[number]
    with tempfile.TemporaryDirectory() as temporary:
        kept = Path(temporary) if folder is None else folder
        named = replace(operation, name=f"{operation.name}-{repeat}")
        result, watch = watched(named, kept)
        figures: dict[str, Any] = dict.fromkeys(following.FIGURES)
        if result.trial is not None:
            figures = following.summarize_following(result.trial)
        summary = result.summary()
    plain = simulated(operation, float(summary.get("duration", operation.duration)))

    def number_of(name: str) -> float:
        value = {**figures, **summary}.get(name)
        return math.nan if value is None else float(value)

    return Row(
        setting=operation.name,
        repeat=repeat,
        accepted=int(result.accepted),
        velocity=number_of("forward_velocity"),
        measured_velocity=measured.forward_velocity,
        simulated_velocity=plain.forward_velocity,
        electrical_power=number_of("electrical_power"),
        simulated_power=plain.electrical_power,
        measured_power=measured.mean_power,
        duration=number_of("duration"),
        convergence_time=number_of("convergence_time"),
        last_cycles_error=number_of("last_cycles_error"),
        stays=int(following.stays(figures)),
        steady_error=number_of("steady_error"),
        **watch.figures(),
        reason=result.reason,
    )


def stored(path: Path = STORED) -> list[Row]:
    """The rows of the stored answer."""
    if not path.exists():
        return []
    kinds: dict[str, Any] = {field.name: field.type for field in fields(Row)}
    with path.open(newline="", encoding="utf-8") as file:
        return [
            Row(**{name: kinds[name](text) for name, text in row.items()})
            for row in csv.DictReader(file)
        ]


def kept(rows: list[Row], path: Path) -> None:
    """Write the rows, in the order of the settings; numbers have six digits."""
    names = [one.name for one in load_operation(TABLE2).trials]
    rows = sorted(rows, key=lambda one: (names.index(one.setting), one.repeat))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(Row)])
        for one in rows:
            values = asdict(one).values()
            writer.writerow([f"{v:.6g}" if isinstance(v, float) else v for v in values])


def error(row: Row) -> float:
    """Speed as operated against that measured [%]."""
    return 100.0 * (row.velocity / row.measured_velocity - 1.0)


def table(rows: list[Row]) -> str:
    """As it stands in docs/how-to/operate.md."""
    lines = [
        "| setting | v operated [m/s] | measured | error | simulated | within 0.1 m after [s] "
        "| p_y in the last 3 cycles [m] | twin's joints [deg] |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for one in rows:
        name = (
            one.setting.replace("lateral-undulation", "lateral")
            .replace("-fin", ", fin")
            .replace("-case-", ", ")
        )
        if len({row.repeat for row in rows}) > 1:
            name += f", run {one.repeat}"
        cells = (
            name + ("" if one.accepted else " (rejected)"),
            f"{one.velocity:.4f}",
            f"{one.measured_velocity:.4f}",
            f"{error(one):+.1f} %",
            f"{one.simulated_velocity:.4f}",
            f"{one.convergence_time:.0f}",
            f"{one.last_cycles_error:.3f}",
            f"{one.twin_joint_error:.2f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def summary(rows: list[Row]) -> str:
    """What the table says, in one sentence a line."""
    n = len(rows)
    mean = float(np.mean([abs(error(one)) for one in rows]))
    against_model = [one.electrical_power / one.simulated_power for one in rows]
    with_fin, without_fin = (
        [
            one.electrical_power / one.measured_power
            for one in rows
            if ("-fin-" in one.setting) == has_fin
        ]
        for has_fin in (True, False)
    )
    away = [abs(one.twin_velocity / one.true_velocity - 1.0) for one in rows if one.twin_alive]
    return "\n".join(
        (
            f"speed: mean error {mean:.1f} % (asked for: at most {LARGEST_ERROR:g} %)",
            f"accepted: {sum(one.accepted for one in rows)} of {n}",
            f"came to their path and stayed over the last three cycles: {sum(one.stays for one in rows)} of {n}",
            f"twins that were there at the end: {sum(one.twin_alive for one in rows)} of {n}; "
            f"their speed is off by up to {100.0 * max(away, default=math.nan):.1f} %",
            f"electrical power above idle: {_range_of(against_model)} against the plain simulation; "
            f"against measured {_range_of(with_fin)} with the fin, {_range_of(without_fin)} without",
            *(
                f"rejected: {one.setting}-{one.repeat}: {one.reason}"
                for one in rows
                if not one.accepted
            ),
        )
    )


def _range_of(ratios: list[float]) -> str:
    """Ratios to something, as percentages above it."""
    if not ratios:
        return "nothing"
    return f"{100.0 * (min(ratios) - 1.0):+.0f} to {100.0 * (max(ratios) - 1.0):+.0f} %"


def written(page: Path, rows: list[Row]) -> None:
    """Replace what stands between the marks of a page."""
    text = page.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    inside = f"\n\n{table(rows)}\n\n```text\n{summary(rows)}\n```\n\n"
    page.write_text(f"{before}{BEGIN}{inside}{END}{after}", encoding="utf-8")


def main() -> int:
    """Run what is asked for, and print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--run", action="store_true", help="run what the answer lacks")
    parser.add_argument("--repeats", type=int, default=1)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--settings", type=int, nargs="*", help="their numbers, 0 to 11")
    parser.add_argument("--answer", type=Path, default=STORED)
    parser.add_argument("--output", type=Path, help="folder for recordings and trials; else none")
    parser.add_argument("--offset-bandwidth", type=float, help="instead of the default [rad/s]")
    parser.add_argument("--duration", type=float, help="of every run [s]; the file's otherwise")
    parser.add_argument("--page", type=Path, help="page in which the table is to be replaced")
    options = parser.parse_args()
    rows = stored(options.answer)
    if options.run:
        if options.output is not None:
            options.output.mkdir(parents=True, exist_ok=True)
        changes = {
            name: value
            for name in ("offset_bandwidth", "duration")
            if (value := getattr(options, name)) is not None
        }
        names = [one.name for one in load_operation(TABLE2).trials]
        done = {(one.setting, one.repeat) for one in rows}
        numbers = options.settings if options.settings is not None else range(len(names))
        jobs = [(n, k) for k in range(1, options.repeats + 1) for n in numbers]
        with ProcessPoolExecutor(options.workers) as pool:
            waiting = [
                pool.submit(run, n, k, options.output, changes)
                for n, k in jobs
                if (names[n], k) not in done
            ]
            for one in waiting:
                rows.append(one.result())
                kept(rows, options.answer)
                print(
                    table(rows[-1:]).splitlines()[-1], rows[-1].reason, file=sys.stderr, flush=True
                )
    rows = stored(options.answer)
    if not rows:
        parser.error("there is no answer yet: --run")
    print(table(rows), summary(rows), sep="\n\n")
    if options.page is not None:
        written(options.page, rows)
    mean = float(np.mean([abs(error(one)) for one in rows]))
    is_met = all(one.accepted and one.stays and one.twin_alive for one in rows)
    return 0 if is_met and mean <= LARGEST_ERROR else 1


if __name__ == "__main__":
    sys.exit(main())
