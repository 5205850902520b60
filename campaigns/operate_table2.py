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
import itertools
import math
import sys
import tempfile
import zlib
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, NamedTuple

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
    twin_joint_errors: list[np.ndarray] = field(default_factory=list)
    """Of all joints [deg]."""
    twin_speeds: list[float] = field(default_factory=list)
    """Along the twin's heading [m/s]."""
    truths: list[np.ndarray] = field(default_factory=list)
    """Time, x, y and heading of the robot [s], [m], [rad]."""
    errors: list[np.ndarray] = field(default_factory=list)
    """Of the estimate's x, y and heading [m], [deg]."""
    is_twin_alive: bool = False

    def __call__(self, state: Any, outputs: object) -> None:
        """Look, after a tick."""
        if state.phase != "running" or state.estimate is None:
            return
        truth = self.tank.truth
        estimate = state.estimate
        center = self.volume.to_path(truth.center_of_mass)[:2]
        self.truths.append(np.array([truth.time, *center, truth.heading]))
        position_error = estimate.center_of_mass - center
        heading_error = math.degrees(estimate.heading - truth.heading)
        self.errors.append(np.array([*position_error, heading_error]))
        twin = state.estimator.latest.twin
        self.is_twin_alive = twin is not None
        if twin is not None:
            self.twin_joint_errors.append(np.degrees(twin.joint_angle - truth.joint_angle))
            ahead = np.array([math.cos(twin.heading), math.sin(twin.heading)])
            self.twin_speeds.append(float(twin.velocity @ ahead))

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
        mean_heading = 0.5 * (heading[1:] + heading[:-1])
        ways = np.diff(x) * np.cos(mean_heading) + np.diff(y) * np.sin(mean_heading)
        x_error, y_error, heading_error = np.array(self.errors).T
        twin_velocity = math.nan
        if self.twin_speeds:
            twin_velocity = float(np.mean(self.twin_speeds))
        return {
            "twin_alive": int(self.is_twin_alive),
            "twin_joint_error": _root_mean_square(np.array(self.twin_joint_errors)),
            "twin_velocity": twin_velocity,
            "true_velocity": float(np.sum(ways) / (time[-1] - time[0])),
            "position_error": _root_mean_square(np.hypot(x_error, y_error)),
            "heading_error": _root_mean_square(heading_error),
        }


def _root_mean_square(values: np.ndarray) -> float:
    if not values.size:
        return math.nan
    return float(np.sqrt(np.mean(values**2)))


def build_plant(operation: Operation) -> Any:
    """The robot of an operation in its water, with its joint law."""
    return lc.build_plant(operation.body(), operation.pool(), joints=operation.joint_law())


class WatchedRun(NamedTuple):
    """One run, and what was seen of it."""

    result: Result
    watch: Watch


def operate_in_tank(operation: Operation, folder: Path) -> Result:
    """One run in a tank of its own; its name says which chance it has."""
    return watch_run(operation, folder).result


def watch_run(operation: Operation, folder: Path) -> WatchedRun:
    """One run in a tank of its own, watched."""
    seed = zlib.crc32(operation.name.encode())
    start = put_down(operation, np.random.default_rng(seed))
    robot = VirtualRobot(operation.body(), build_plant(operation), start)
    meter = "stepped"
    if operation.supply_voltage is None:
        meter = ""
    operation = replace(operation, connection=replace(operation.connection, meter_address=meter))
    for ending in ("mcap", "nc"):  # of a run that was stopped or rejected
        (folder / f"{operation.name}.{ending}").unlink(missing_ok=True)
    tank = Tank(robot, LabSettings(seed=seed))
    watch = Watch(tank, operation.tank)
    twin = build_plant(operation)
    result = operate(operation, folder, tank=tank, twin=twin, frames=False, show=watch)
    return WatchedRun(result, watch)


def put_down(operation: Operation, chance: np.random.Generator) -> lc.Start:
    """Where somebody puts the robot down in the tank."""
    x, y = np.array(operation.start.position) + PLACED * chance.standard_normal(2)
    x, y, _ = operation.tank.to_tank(np.array([x, y, 0.0]))
    heading = operation.start.heading + TURNED * float(chance.standard_normal())
    return lc.Start(center_of_mass=(float(x), float(y)), heading=heading)


def simulate(operation: Operation, duration: float) -> lc.Trial:
    """The same controller on the same model for as long [s], with nothing in between."""
    plant = lc.build_plant(
        operation.body(),
        operation.pool(),
        joints=operation.joint_law(),
        ramp=operation.ramp,
        offset_bandwidth=operation.offset_bandwidth,
    )
    start = lc.Start(center_of_mass=operation.start.position, heading=operation.start.heading)
    return lc.run(plant, operation.controller(), duration, start=start)


def run(number: int, repeat: int, folder: Path | None, changes: dict[str, Any]) -> Row:
    """One run of one setting."""
    settings = {"rate": RATE, "offset_bandwidth": OFFSET_BANDWIDTH, **changes}
    operation = replace(load_operation(TABLE2).trials[number], **settings)
    measured = read_path_following_trials()[number]
    with tempfile.TemporaryDirectory() as temporary:
        if folder is None:
            folder = Path(temporary)
        repeated = replace(operation, name=f"{operation.name}-{repeat}")
        result, watch = watch_run(repeated, folder)
        figures: dict[str, Any] = dict.fromkeys(following.FIGURES)
        if result.trial is not None:
            figures = following.summarize_following(result.trial)
        summary = result.summary()
    plain = simulate(operation, float(summary.get("duration", operation.duration)))

    def number_of(name: str) -> float:
        value = {**figures, **summary}.get(name)
        if value is None:
            return math.nan
        return float(value)

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
    with path.open(newline="", encoding="utf-8") as file:
        return [read_row(cells) for cells in csv.DictReader(file)]


def read_row(cells: dict[str, str]) -> Row:
    values: dict[str, Any] = {}
    for column in fields(Row):
        kind: Any = column.type
        values[column.name] = kind(cells[column.name])
    return Row(**values)


def write_rows(rows: list[Row], path: Path) -> None:
    """Write the rows, in the order of the settings; numbers have six digits."""
    names = [trial.name for trial in load_operation(TABLE2).trials]
    rows = sorted(rows, key=lambda row: (names.index(row.setting), row.repeat))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([column.name for column in fields(Row)])
        for row in rows:
            values = asdict(row).values()
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
    has_repeats = len({row.repeat for row in rows}) > 1
    for row in rows:
        cells = (
            title_of(row, has_repeats),
            f"{row.velocity:.4f}",
            f"{row.measured_velocity:.4f}",
            f"{error(row):+.1f} %",
            f"{row.simulated_velocity:.4f}",
            f"{row.convergence_time:.0f}",
            f"{row.last_cycles_error:.3f}",
            f"{row.twin_joint_error:.2f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def title_of(row: Row, has_repeats: bool) -> str:
    title = row.setting.replace("lateral-undulation", "lateral")
    title = title.replace("-fin", ", fin").replace("-case-", ", ")
    if has_repeats:
        title += f", run {row.repeat}"
    if not row.accepted:
        title += " (rejected)"
    return title


def mean_error(rows: list[Row]) -> float:
    """Mean of the speeds' absolute errors [%]."""
    return float(np.mean([abs(error(row)) for row in rows]))


def summary(rows: list[Row]) -> str:
    """What the table says, in one sentence a line."""
    n = len(rows)
    n_accepted = sum(row.accepted for row in rows)
    n_staying = sum(row.stays for row in rows)
    n_twins = sum(row.twin_alive for row in rows)
    errors_of_twins = [
        abs(row.twin_velocity / row.true_velocity - 1.0) for row in rows if row.twin_alive
    ]
    largest_error = 100.0 * max(errors_of_twins, default=math.nan)
    to_simulated = [row.electrical_power / row.simulated_power for row in rows]
    to_measured_with_fin: list[float] = []
    to_measured_without_fin: list[float] = []
    for row in rows:
        ratio = row.electrical_power / row.measured_power
        if "-fin-" in row.setting:
            to_measured_with_fin.append(ratio)
        else:
            to_measured_without_fin.append(ratio)
    lines = [
        f"speed: mean error {mean_error(rows):.1f} % (asked for: at most {LARGEST_ERROR:g} %)",
        f"accepted: {n_accepted} of {n}",
        f"came to their path and stayed over the last three cycles: {n_staying} of {n}",
        f"twins that were there at the end: {n_twins} of {n}; "
        f"their speed is off by up to {largest_error:.1f} %",
        f"electrical power above idle: {_range_of(to_simulated)} against the plain simulation; "
        f"against measured {_range_of(to_measured_with_fin)} with the fin, "
        f"{_range_of(to_measured_without_fin)} without",
    ]
    for row in rows:
        if not row.accepted:
            lines.append(f"rejected: {row.setting}-{row.repeat}: {row.reason}")
    return "\n".join(lines)


def _range_of(ratios: list[float]) -> str:
    """Ratios to something, as percentages above it."""
    if not ratios:
        return "nothing"
    return f"{100.0 * (min(ratios) - 1.0):+.0f} to {100.0 * (max(ratios) - 1.0):+.0f} %"


def write_page(page: Path, rows: list[Row]) -> None:
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
    if options.run:
        run_missing(options)
    rows = stored(options.answer)
    if not rows:
        parser.error("there is no answer yet: --run")
    print(table(rows), summary(rows), sep="\n\n")
    if options.page is not None:
        write_page(options.page, rows)
    is_met = all(row.accepted and row.stays and row.twin_alive for row in rows)
    return 0 if is_met and mean_error(rows) <= LARGEST_ERROR else 1


def run_missing(options: argparse.Namespace) -> None:
    """Run what the answer lacks, and store it after every run."""
    if options.output is not None:
        options.output.mkdir(parents=True, exist_ok=True)
    changes: dict[str, Any] = {}
    if options.offset_bandwidth is not None:
        changes["offset_bandwidth"] = options.offset_bandwidth
    if options.duration is not None:
        changes["duration"] = options.duration
    rows = stored(options.answer)
    finished = {(row.setting, row.repeat) for row in rows}
    names = [trial.name for trial in load_operation(TABLE2).trials]
    numbers = options.settings
    if numbers is None:
        numbers = range(len(names))
    with ProcessPoolExecutor(options.workers) as pool:
        waiting: list[Future[Row]] = []
        for repeat, number in itertools.product(range(1, options.repeats + 1), numbers):
            if (names[number], repeat) not in finished:
                waiting.append(pool.submit(run, number, repeat, options.output, changes))
        for future in waiting:
            row = future.result()
            rows.append(row)
            write_rows(rows, options.answer)
            *_, line = table([row]).splitlines()
            print(line, row.reason, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
