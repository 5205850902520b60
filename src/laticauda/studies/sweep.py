"""What a sweep is: one scenario at thousands to millions of points, cut into regions that are done in one go.

And its trials: which points of a scenario's numbers there may be, and what they come to.
"""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Shaped

import laticauda as lc
from laticauda import codec, extensions, packaging
from laticauda.errors import BadArgument, instance, whole
from laticauda.quantities import option, quantity, value
from laticauda.simulate.batch_figures import Block, Run, joint_peaks
from laticauda.simulate.many import collected, runs_of
from laticauda.simulate.numbers import UNITS, changed, check_whole, described, look_up, of_figure, parameters
from laticauda.simulate.runner import silent
from laticauda.studies import sampling
from laticauda.studies.sampling import Table
from laticauda.trial.feasibility import NEEDS

Column = Shaped[np.ndarray, " n_points"]
Progress = Callable[[int, int], None]
"""Called now and then with the number of runs done, and of all."""

FIGURES = (*(name for name in UNITS if name not in ("positive_power", "x", "y", "heading")), *NEEDS)
"""Those that are kept of every trial."""
QUANTITIES = (*FIGURES, "succeeded")
"""What is kept of every trial."""
LABELS = {name: f"{name.replace('_', ' ')} [{getattr(lc.Trial, name).unit or '-'}]" for name in FIGURES}
"""The figures in words, with the unit, as tables and axes have it."""
# Of these the least is the best, of the others the greatest.
COSTS = ("mechanical_power", "net_power", "mean_power", "cost_of_transport")
_ROOTS = {"robot": "robot", "gait": "motion", "water": "environment", "ground": "environment"}
# More corners than this are not worth the time: every range's ends are tried in any case.
MOST_CORNERS = 256
# What a region should take on one core, and what a trial of ten links and 30 s takes there, roughly [s].
REGION_TIME = 1.5
TRIAL_TIME, DRIVEN_TIME = 0.35e-3, 5e-3
LEAST_SIZE, MOST_SIZE = 64, 16384


# ---- trials ----------------------------------------------------------------------------------------------------------


def check_scenario(scenario: lc.Scenario) -> None:
    """Refuse a scenario that cannot be changed point by point.

    Raises:
        ValueError: If it is none, or is not of the planar model.
    """
    instance("scenario", scenario, lc.Scenario)
    instance("scenario.model", scenario.model, lc.Planar)


def definition_of(scenario: lc.Scenario) -> dict[str, Any]:
    """All of a scenario that the results depend on, for a file."""
    plain = codec.encode(scenario, lc.Scenario)
    plain["robot"].pop("description", None)
    return {"laticauda": packaging.__version__, **plain}


def attributes_of(scenario: lc.Scenario) -> dict[str, Any]:
    """What stands beside stored results about the scenario they are of."""
    return {
        "Conventions": "CF-1.11",
        "history": f"made by laticauda {packaging.__version__}",  # without a date: the same sweep has the same bits
        "robot": scenario.robot.name,
        "gait": scenario.gait.kind,
        "environment": scenario.environment.name,
        "duration": scenario.duration,
        "joints": extensions.name_of(type(scenario.model.joints)),
        "laticauda": packaging.__version__,
    }


def labels_of(scenario: lc.Scenario) -> dict[str, dict[str, str]]:
    """What stands beside every stored parameter and quantity, by name: what it is, and its unit."""
    known = {name: described(one.phrase, one.unit) for name, one in parameters(scenario).items()}
    return known | {name: of_figure(name) for name in QUANTITIES}


def check_ranges(scenario: lc.Scenario, ranges: Mapping[str, tuple[float, float]], argument: str = "points") -> None:
    """Refuse what cannot be swept, before any work is done.

    The ends of all ranges are tried, alone and together: fields have bounds, and some are bounds of others.

    Args:
        scenario: What all trials share.
        ranges: Least and greatest value by parameter.
        argument: Where they are from, for messages.

    Raises:
        ValueError: If there is no such parameter, or a value is out of its range; the message has its name.
    """
    known = parameters(scenario)
    for name, ends in ranges.items():
        parameter = look_up(name, known, argument)
        check_whole(parameter, np.array(ends))
    corners: Iterable[tuple[float, ...]] = itertools.product(*ranges.values())
    if 2 ** len(ranges) > MOST_CORNERS:
        corners = zip(*ranges.values(), strict=True)
    for corner in corners:
        values = dict(zip(ranges, corner, strict=True))
        try:
            other = changed(scenario, values)
            other.gait.joint_envelope(lc.plant(other).robot.planar().n_links)
        except ValueError as error:
            listed = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            reason = str(error).replace("`", "")  # these are no arguments of the caller
            rule = f"must be within the bounds of what is swept, got {listed}: {reason.removesuffix('.')}"
            raise BadArgument(argument, rule) from error


def swim_points(
    scenario: lc.Scenario, names: tuple[str, ...], table: Table, threads: int | None = None
) -> dict[str, Column]:
    """Let the robots of some points swim.

    Args:
        scenario: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
        threads: How many to compute with; None takes all cores that this process may use.

    Returns:
        A value per point of every quantity in `QUANTITIES`; nan where a run blew up, or where there is none.
    """
    runs = runs_of(scenarios_at(scenario, names, table))
    joints = {name: np.full(len(runs), np.nan) for name in NEEDS}

    def look(mine: Sequence[Run], block: Block) -> None:
        for name, values in joint_peaks(mine, block).items():
            joints[name][block.index] = values

    interval = scenario.sample_interval
    found = collected(runs, scenario.duration, interval, threads, silent, look=look, with_joints=True)
    kept = {name: np.where(found.succeeded & np.isfinite(values), values, np.nan) for name, values in joints.items()}
    return {**{name: found.figures[name] for name in FIGURES if name not in kept}, **kept, "succeeded": found.succeeded}


def scenarios_at(scenario: lc.Scenario, names: tuple[str, ...], table: Table) -> list[lc.Scenario]:
    """The scenario of every point; equal robots, gaits and environments are one object, made once.

    Args:
        scenario: What all trials share.
        names: Of the parameters, a column of the table each.
        table: The points, a row each.
    """
    roots = {root: [i for i, name in enumerate(names) if name.split(".")[0] == root] for root in _ROOTS}
    made: dict[tuple[str, tuple[float, ...]], Any] = {}

    def part(root: str, row: tuple[float, ...]) -> Any:
        own = tuple(row[i] for i in roots[root])
        if (root, own) not in made:
            values = dict(zip((names[i] for i in roots[root]), own, strict=True))
            made[root, own] = getattr(changed(scenario, values), _ROOTS[root])
        return made[root, own]

    used = [root for root in _ROOTS if roots[root]]
    rows = map(tuple, table.tolist())
    return [replace(scenario, **{_ROOTS[root]: part(root, row) for root in used}) for row in rows]


# ---- sweeps ----------------------------------------------------------------------------------------------------------


@value
class Sweep:
    """What to sweep: a scenario, and the points that change numbers of it.

    Raises:
        ValueError: If a field is out of its range, a parameter does not exist (the message has the nearest names), or
            a value is out of the parameter's range.

    Example:
        >>> import laticauda as lc
        >>> from laticauda.studies import Grid
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> sweep = Sweep(
        ...     scenario=lc.scenario("mamba", gait),
        ...     points=Grid(values={"gait.amplitude": [0.3, 0.5], "water.normal_drag": [1.0, 1.5, 2.0]}),
        ... )
        >>> sweep.n_trials
        6
    """

    scenario: lc.Scenario = option("What all trials share; by the planar model")
    points: sampling.Points = option("Which points: `Grid`, `Rows` or `Samples`")

    def __post_init__(self) -> None:
        """Check what goes together."""
        check_scenario(self.scenario)
        check_ranges(self.scenario, self.points.ranges)
        if not isinstance(self.points, sampling.Samples):
            known = parameters(self.scenario)
            for name in self.points.names:
                check_whole(known[name], self.points.values[name])

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(np.prod(self.points.shape, dtype=np.int64))

    def regions(self, size: int | None = None) -> "Regions":
        """The sweep in pieces of about a second of work: the order of the work and of the files.

        Args:
            size: Greatest number of points in a region; None takes one by what a trial costs.
        """
        if size is None:
            s = self.scenario
            cost = TRIAL_TIME if isinstance(s.model.joints, lc.Prescribed) else DRIVEN_TIME
            trial = cost * s.duration / 30.0 * s.robot.n_links / 10.0
            size = int(np.clip(REGION_TIME / trial, LEAST_SIZE, MOST_SIZE))
        return cut(self.points.shape, whole("region_size", size, 1))

    def tables(self, blocks: Iterable[tuple[slice, ...]]) -> Iterator[Table]:
        """The points of some regions, one after the other.

        Args:
            blocks: In rising order.
        """
        known = parameters(self.scenario)
        return self.points.tables(blocks, [name for name in self.points.names if known[name].is_whole])

    def definition(self) -> dict[str, Any]:
        """All that its results depend on, for a file."""
        return {**definition_of(self.scenario), "points": self.points.definition()}


@value
class Regions:
    """All regions of a sweep; they are the chunks of its stored arrays."""

    shape: tuple[int, ...] = quantity("", "Shape of the sweep's points", ge=1)
    block: tuple[int, ...] = quantity("", "Size of a region; those at the far ends may be smaller", ge=1)

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of regions along every dimension."""
        return tuple(-(-n // size) for n, size in zip(self.shape, self.block, strict=True))

    @property
    def count(self) -> int:
        """Number of regions."""
        return math.prod(self.grid)

    def at(self, index: int) -> sampling.Block:
        """The block of one region.

        Args:
            index: Its number, the last dimension counting fastest.
        """
        places = np.unravel_index(index, self.grid)
        return tuple(
            slice(int(place) * size, min((int(place) + 1) * size, n))
            for place, size, n in zip(places, self.block, self.shape, strict=True)
        )

    def n_points(self, index: int) -> int:
        """Number of points in a region.

        Args:
            index: Its number.
        """
        return math.prod(extent(self.at(index)))


def extent(block: sampling.Block) -> tuple[int, ...]:
    """The shape of a block."""
    return tuple(part.stop - part.start for part in block)


def cut(shape: tuple[int, ...], size: int) -> Regions:
    """Regions of about `size` points: whole along the last dimensions, nearly equal pieces along the others.

    Args:
        shape: Of the sweep's points.
        size: Greatest number of points in a region.
    """
    room = size
    block: list[int] = []
    for n in reversed(shape):
        most = max(1, min(n, room))
        length = -(-n // -(-n // most))
        block.append(length)
        room //= length
    return Regions(shape=shape, block=tuple(reversed(block)))
