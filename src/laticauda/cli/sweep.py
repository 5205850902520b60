"""`laticauda sweep`: thousands to millions of trials, in a folder that a stopped sweep goes on from."""

from typing import Annotated, Any, Literal

import tyro

from laticauda.cli import vary
from laticauda.cli.command import Outcome
from laticauda.cli.flags import File, Folder, Words
from laticauda.cli.progress import stored_trials
from laticauda.cli.scene import warn_of_compiling
from laticauda.cli.vary import Known, Study
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario
from laticauda.studies import Samples, Sweep, best, count_failed, run_sweep
from laticauda.studies.cluster import connected
from laticauda.studies.sampling import Points

N_BEST = 5
SHOWN = ("forward_velocity", "mean_power", "cost_of_transport", "utilization")


@value
class SweepCommand(Study):
    """Run a trial at every point of a grid, a list or of samples, and print the best.

    For example: laticauda sweep --robot mamba --gait lateral-undulation --vary amplitude-deg=10:50:20
    frequency-deg-s=50:150:20 normal-drag=1,1.75 --output sweep

    The results are one xarray Dataset in sweep/results.zarr. Stopped or killed, the same command goes on.
    """

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
    scheduler: str | None = option("Run on the Dask cluster whose scheduler is there: tcp://host:8786", default=None)
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

    def studied(self, scenario: Scenario, known: Known) -> Outcome:
        """Run all trials that are not stored yet."""
        sweep = Sweep(scenario=scenario, points=self._points(known))
        with stored_trials(self.output) as show, connected(self.scheduler) as client:
            if client is None:
                warn_of_compiling(scenario.environment, scenario.model)
            run_sweep(sweep, self.output, progress=show, client=client, threads=self.threads)
        n_trials, n_failed = sweep.n_trials, count_failed(self.output)
        status = f"All {n_trials} trials reached their end."
        if n_failed:
            status = f"{n_failed} of {n_trials} trials blew up; a smaller `dt` may help."
        figure = self.best.replace("-", "_")
        points = best(self.output, figure, N_BEST)
        facts: dict[str, Any] = {
            "status": status,
            "n_trials": n_trials,
            "n_failed": n_failed,
            "best_in": figure,
            "best": [vary.point_facts(point) for point in points],
            "output": self.output,
            **vary.shared_facts(scenario),
        }
        table = vary.points_table(scenario, sweep.points.names, [*SHOWN, figure], points)
        title = f"{status} The best in {figure.replace('_', ' ')}:"
        text = f"{title}\n\n{table}\n\nAll results: {self.output}/results.zarr (xarray.open_zarr)"
        return Outcome(facts=facts, text=text, succeeded=n_failed < n_trials)

    def _points(self, known: Known) -> Points:
        """Which points are asked for."""
        words = [word for group in self.vary for word in group]
        if self.seed is not None and self.samples is None:
            raise BadArgument("seed", "must be given with --samples: a grid and a list have no chance in them")
        if self.list is not None:
            if words or self.samples is not None:
                raise BadArgument("list", "must not be given together with --vary or --samples")
            return vary.rows(self.list, known)
        if not words:
            raise BadArgument("vary", f"must be given, or --list: {vary.FORM}; --names lists what can be varied")
        if self.samples is None:
            return vary.grid(words, known)
        ranges = vary.ranges(words, known, vary.SAMPLES_FORM)
        return Samples(ranges=ranges, n_points=self.samples, seed=self.seed or 0)
