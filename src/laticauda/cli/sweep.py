"""`laticauda sweep`: thousands to millions of trials, in a folder that a stopped sweep goes on from."""

import json
import logging
import math
import sys
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli import vary
from laticauda.cli.flags import File, Number, Switch, Text, Whole, Words, choice, default
from laticauda.cli.groups import Coefficients, EnvironmentFlags, GaitFlags, ModelFlags, RobotFlags, WaterChanges
from laticauda.cli.progress import trials_bar
from laticauda.cli.swim import COMPILING, DURATION
from laticauda.cli.tables import MISSING, aligned, number, read_in

if TYPE_CHECKING:
    from laticauda.scenarios import Scenario
    from laticauda.simulate import Parameter
    from laticauda.studies import Sweep

FOLDER = "sweep"
N_BEST = 5
BEST = ("forward-velocity", "steady-velocity", "mechanical-power", "net-power", "mean-power", "cost-of-transport")
SHOWN = ("forward_velocity", "mean_power", "cost_of_transport")


@dataclass(frozen=True, kw_only=True)
class PointFlags:
    """What changes from trial to trial; all else is fixed by the options below."""

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction, default("none")] = ()
    """LOW:HIGH:COUNT, or VALUE,VALUE,... of a number of robot, gait or water, with the unit in the name:
    amplitude-deg=10:50:100. Every combination is a trial."""
    samples: Annotated[Whole, default("none: a grid")] = None
    """Take this many points that fill the ranges NAME=LOW:HIGH evenly instead."""
    seed: Annotated[Whole, default("0")] = None
    """Of the samples; another one gives other points."""
    list: File = None
    """Take the points of this CSV file instead, with such names in its first line."""
    names: Switch = False
    """Print the names of what can be varied, and end."""


@dataclass(frozen=True, kw_only=True)
class WorkFlags:
    """How and where it is done."""

    duration: Annotated[Number, default(f"{DURATION:g}")] = None
    """Of every trial [s]."""
    threads: Annotated[Whole, default("one per core")] = None
    """How many trials run at once on this machine."""
    scheduler: Annotated[Text, tyro.conf.arg(metavar="ADDRESS"), default("none: on this machine")] = None
    """Run on the Dask cluster whose scheduler is there: tcp://host:8786."""


@dataclass(frozen=True, kw_only=True)
class ResultFlags:
    """What becomes of it."""

    output: Annotated[Text, tyro.conf.arg(metavar="DIR"), default(FOLDER)] = None
    """The folder of the results; a sweep that was stopped goes on there when the same command is run again."""
    best: Annotated[str | None, choice(*BEST), default(BEST[0])] = None
    """What the points in the table are the best in: the fastest, or those with the least power or cost."""
    json: Switch = False
    """Print one JSON object in SI units instead of the table."""


@dataclass(frozen=True, kw_only=True)
class SweepCommand:
    """Run a trial at every point of a grid, a list or of samples, and print the best.

    For example: laticauda sweep --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50:20
    frequency-deg-s=50:150:20 normal-drag=1,1.75 --output sweep

    The results are one xarray Dataset in sweep/results.zarr. Stopped or killed, the same command goes on.
    """

    points: PointFlags = field(default_factory=PointFlags)
    robot: RobotFlags = field(default_factory=RobotFlags)
    gait: GaitFlags = field(default_factory=GaitFlags)
    environment: EnvironmentFlags = field(default_factory=EnvironmentFlags)
    coefficients: Coefficients = field(default_factory=WaterChanges)
    """Replace what the chosen water has."""
    model: ModelFlags = field(default_factory=ModelFlags)
    work: WorkFlags = field(default_factory=WorkFlags)
    result: ResultFlags = field(default_factory=ResultFlags)

    def __call__(self) -> int:
        """Run, print, and return the exit status."""
        from laticauda.simulate import parameters

        scenario = self._scenario()
        known = parameters(scenario)
        if self.points.names:
            print(vary.listed(known))
            return 0
        from laticauda.studies import Sweep, count_failed

        sweep = Sweep(scenario=scenario, points=self._points(known))
        folder = FOLDER if self.result.output is None else self.result.output
        reached = [0]
        try:
            self._run(sweep, folder, reached)
        except KeyboardInterrupt:
            print(
                f"laticauda: stopped; {reached[0]} of {sweep.n_trials} trials are stored in {folder}. Run the same "
                "command again to go on.",
                file=sys.stderr,
            )
            return 130
        except ValueError as error:
            raise ValueError(str(error).replace("`folder`", "--output")) from error
        n_failed = count_failed(folder)
        wanted = (self.result.best or BEST[0]).replace("-", "_")
        print(
            _as_json(sweep, folder, wanted, n_failed) if self.result.json else _as_text(sweep, folder, wanted, n_failed)
        )
        return 1 if n_failed == sweep.n_trials else 0

    def _scenario(self) -> "Scenario":
        """What all trials share."""
        from laticauda.scenarios import scenario

        gait = self.gait.chosen()
        environment, _ = self.environment.chosen(gait, self.coefficients)
        settings: dict[str, Any] = self.environment.model_settings(self.model)
        duration = DURATION if self.work.duration is None else self.work.duration
        robot = self.environment.equipped(self.robot.chosen(), gait)
        return scenario(robot, gait, duration, environment=environment, **settings)

    def _points(self, known: "dict[str, Parameter]") -> Any:
        """Which points are asked for."""
        flags = self.points
        words = [word for group in flags.vary for word in group]
        if flags.seed is not None and flags.samples is None:
            raise ValueError("`seed` must be given with `samples`: a grid and a list have no chance in them.")
        if flags.list is not None:
            if words or flags.samples is not None:
                raise ValueError("`list` must not be given together with `vary` or `samples`.")
            return vary.rows(flags.list, known)
        if not words:
            raise ValueError(f"`vary` must be given, or `list`: {vary.FORM}; `names` lists what can be varied.")
        if flags.samples is not None:
            return vary.samples(words, known, flags.samples, flags.seed or 0)
        return vary.grid(words, known)

    def _run(self, sweep: "Sweep", folder: str, reached: list[int]) -> None:
        """Do the work that is left; `reached` is the number of trials that are stored."""
        from laticauda.studies import run_sweep

        bar = trials_bar()

        def show(done: int, total: int) -> None:
            reached[0] = done
            bar(done, total)

        with _client(self.work.scheduler) as client:
            if client is None:
                _warn_of_compiling(sweep)
            run_sweep(sweep, folder, progress=show, client=client, threads=self.work.threads)


@contextmanager
def _client(address: str | None) -> Generator[Any]:
    """The cluster at an address; None for none."""
    if address is None:
        yield None
        return
    from laticauda.studies.cluster import connect

    # What it logs about a scheduler that has gone is long, and said by our own error.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    client = connect(address)
    try:
        yield client
    finally:
        client.close(timeout=2)


def _warn_of_compiling(sweep: "Sweep") -> None:
    from laticauda.simulate import needs_compiling

    if needs_compiling(sweep.scenario.environment):
        print(COMPILING, file=sys.stderr, flush=True)


def _as_json(sweep: "Sweep", folder: str, wanted: str, n_failed: int) -> str:
    """What was run, how many failed, and the best points."""
    from laticauda.studies import best
    from laticauda.studies.trials import attributes_of

    about = attributes_of(sweep.scenario)
    version = about.pop("laticauda")
    points = [
        {name: value if value == value else None for name, value in x.items()} for x in best(folder, wanted, N_BEST)
    ]
    found = {
        "status": _status(sweep, n_failed),
        "n_trials": sweep.n_trials,
        "n_failed": n_failed,
        "best_in": wanted,
        "best": points,
        "output": folder,
        **about,
        "version": version,
    }
    return json.dumps(found, indent=2, allow_nan=False)


def _as_text(sweep: "Sweep", folder: str, wanted: str, n_failed: int) -> str:
    """The best points as a table, and where the results are."""
    from laticauda.simulate import parameters
    from laticauda.studies import best
    from laticauda.studies.trials import QUANTITIES

    known = parameters(sweep.scenario)
    columns = [known[name] for name in sweep.points.names]
    figures = list(dict.fromkeys([*SHOWN, wanted]))
    head = [vary.spelled(parameter) for parameter in columns]
    head += [f"{name.replace('_', ' ')}{_in_brackets(QUANTITIES[name][0])}" for name in figures]
    rows = [head]
    for point in best(folder, wanted, N_BEST):
        cells = [read_in(point[parameter.name], parameter.unit)[0] for parameter in columns]
        rows.append(cells + [MISSING if math.isnan(point[name]) else number(point[name]) for name in figures])
    title = f"{_status(sweep, n_failed)} The best in {wanted.replace('_', ' ')}:"
    return (
        f"{title}\n\n{aligned(rows, right=range(len(head)))}\n\nAll results: {folder}/results.zarr (xarray.open_zarr)"
    )


def _in_brackets(unit: str) -> str:
    return f" [{'-' if unit == '1' else unit}]"


def _status(sweep: "Sweep", n_failed: int) -> str:
    if n_failed == 0:
        return f"All {sweep.n_trials} trials reached their end."
    return f"{n_failed} of {sweep.n_trials} trials blew up; a smaller `dt` may help."
