"""`laticauda sweep`: thousands to millions of trials, in a folder that a stopped sweep goes on from."""

import json
import logging
import math
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from laticauda.cli import vary
from laticauda.cli.flags import File, Folder, Maybe, Words, read
from laticauda.cli.progress import trials_bar
from laticauda.cli.scene import Names, named, warn_of_compiling
from laticauda.cli.tables import MISSING, aligned, number, read_in
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import Parameter, parameters

if TYPE_CHECKING:
    from laticauda.studies import Sweep

N_BEST = 5
SHOWN = ("forward_velocity", "mean_power", "cost_of_transport")


@value
class Points:
    """What changes from trial to trial; all else is fixed by the options below."""

    vary: Annotated[tuple[Words, ...], tyro.conf.UseAppendAction] = option(
        "LOW:HIGH:COUNT, or VALUE,VALUE,... of a number of robot, gait or water, with the unit in the name: "
        "amplitude-deg=10:50:100. Every combination is a trial",
        default=(),
    )
    samples: int | None = quantity(
        "", "Take this many points that fill the ranges NAME=LOW:HIGH evenly instead", ge=1, default=None
    )
    seed: int | None = quantity("", "Of the samples; another one gives other points", ge=0, default=None)
    list: File = option("Take the points of this CSV file instead, with such names in its first line", default=None)
    names: bool = option("Print the names of what can be varied, and end", default=False)

    def chosen(self, known: dict[str, Parameter]) -> Any:
        """Which points are asked for.

        Args:
            known: What can be varied, by name.
        """
        words = [word for group in self.vary for word in group]
        if self.seed is not None and self.samples is None:
            raise BadArgument("seed", "must be given with --samples: a grid and a list have no chance in them")
        if self.list is not None:
            if words or self.samples is not None:
                raise BadArgument("list", "must not be given together with --vary or --samples")
            return vary.rows(self.list, known)
        if not words:
            raise BadArgument("vary", f"must be given, or --list: {vary.FORM}; --names lists what can be varied")
        if self.samples is not None:
            return vary.samples(words, known, self.samples, self.seed or 0)
        return vary.grid(words, known)


@value
class Work:
    """How and where it is done."""

    threads: int | None = quantity(
        "", "How many trials run at once on this machine; one per core if left out", ge=1, default=None
    )
    scheduler: Maybe = option("Run on the Dask cluster whose scheduler is there: tcp://host:8786", default=None)


@value
class Results:
    """What becomes of it."""

    output: Folder = option(
        "The folder of the results; a sweep that was stopped goes on there when the same command is run again",
        default="sweep",
    )
    best: Literal[
        "forward-velocity", "steady-velocity", "mechanical-power", "net-power", "mean-power", "cost-of-transport"
    ] = option(
        "What the points in the table are the best in: the fastest, or those with the least power or cost",
        default="forward-velocity",
    )
    json: bool = option("Print one JSON object in SI units instead of the table", default=False)


@value
class SweepCommand:
    """Run a trial at every point of a grid, a list or of samples, and print the best.

    For example: laticauda sweep --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50:20
    frequency-deg-s=50:150:20 normal-drag=1,1.75 --output sweep

    The results are one xarray Dataset in sweep/results.zarr. Stopped or killed, the same command goes on.
    """

    points: Points = option("What changes from trial to trial", default=Points())
    names: Names = option("What swims, how and where, by name", default=Names())
    scenario: Scenario = option("What the names stand for; every number can be changed")
    before: Any = option("What the names stand for, before single numbers were changed", default=None)
    work: Work = option("How and where it is done", default=Work())
    result: Results = option("What becomes of it", default=Results())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "SweepCommand":
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        names = Names.read(words, prog)
        found, _ = names.scenario(words)
        return read(cls, words, prog, cls(names=names, scenario=found, before=found))

    def __call__(self) -> int:
        """Run, print, and return the exit status."""
        scenario = named(self.scenario, self.before)
        if self.points.names:
            print(vary.listed(parameters(scenario)))
            return 0
        from laticauda.studies import Sweep, count_failed

        sweep = Sweep(scenario=scenario, points=self.points.chosen(parameters(scenario)))
        folder, reached = self.result.output, [0]
        try:
            self._run(sweep, folder, reached)
        except KeyboardInterrupt:
            print(
                f"laticauda: stopped; {reached[0]} of {sweep.n_trials} trials are stored in {folder}. Run the same "
                "command again to go on.",
                file=sys.stderr,
            )
            return 130
        n_failed = count_failed(folder)
        show = _as_json if self.result.json else _as_text
        print(show(sweep, folder, self.result.best.replace("-", "_"), n_failed))
        return 1 if n_failed == sweep.n_trials else 0

    def _run(self, sweep: "Sweep", folder: str, reached: "list[int]") -> None:
        """Do the work that is left; `reached` is the number of trials that are stored."""
        from laticauda.studies import run_sweep

        bar = trials_bar()

        def show(done: int, total: int) -> None:
            reached[0] = done
            bar(done, total)

        with _client(self.work.scheduler) as client:
            if client is None:
                warn_of_compiling(sweep.scenario)
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


def _as_json(sweep: "Sweep", folder: str, wanted: str, n_failed: int) -> str:
    """What was run, how many failed, and the best points."""
    from laticauda.studies import best

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
        **facts(sweep.scenario),
    }
    return json.dumps(found, indent=2, allow_nan=False)


def _as_text(sweep: "Sweep", folder: str, wanted: str, n_failed: int) -> str:
    """The best points as a table, and where the results are."""
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


def facts(scenario: Scenario) -> dict[str, Any]:
    """What all trials share, for JSON.

    Args:
        scenario: That.
    """
    from laticauda.studies.trials import attributes_of

    found = attributes_of(scenario)
    return {**found, "version": found.pop("laticauda")}


def _in_brackets(unit: str) -> str:
    return f" [{'-' if unit == '1' else unit}]"


def _status(sweep: "Sweep", n_failed: int) -> str:
    if n_failed == 0:
        return f"All {sweep.n_trials} trials reached their end."
    return f"{n_failed} of {sweep.n_trials} trials blew up; a smaller `dt` may help."
