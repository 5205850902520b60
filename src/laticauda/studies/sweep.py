"""Definition of a sweep: one scenario at thousands to millions of points, divided into regions computed in one go.

Also its trials: which values the numbers of a scenario may take, and the results.
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
from laticauda.errors import BadArgument, check_instance, check_whole_number
from laticauda.quantities import option, quantity, value_class
from laticauda.simulate.batch_figures import Block, Run, joint_peaks
from laticauda.simulate.batch_run import run_batch
from laticauda.simulate.batch_scenarios import runs_of
from laticauda.simulate.numbers import (
    UNITS,
    change_parameters,
    check_whole,
    described,
    list_parameters,
    look_up,
    of_figure,
)
from laticauda.simulate.runner import silent
from laticauda.studies import sampling
from laticauda.studies.sampling import Table
from laticauda.trial.feasibility import NEEDS

Column = Shaped[np.ndarray, " n_points"]
Progress = Callable[[int, int], None]
"""Called periodically with the number of runs done and the total."""

FIGURES = (*(name for name in UNITS if name not in ("positive_power", "x", "y", "heading")), *NEEDS)
"""Figures kept for every trial."""
QUANTITIES = (*FIGURES, "succeeded")
"""Quantities kept for every trial."""
LABELS = {
    name: f"{name.replace('_', ' ')} [{getattr(lc.Trial, name).unit or '-'}]" for name in FIGURES
}
"""The figures in words, with their units, as shown in tables and on axes."""
# For these, the smallest is best; for the others, the largest.
COSTS = ("mechanical_power", "net_power", "mean_power", "cost_of_transport")
_ROOTS = {"robot": "robot", "gait": "motion", "water": "environment", "ground": "environment"}
# More corners than this are not worth the time: the ends of every range are tried in any case.
MOST_CORNERS = 256
# Target time of a region on one core, and approximate time there of a trial of ten links and 30 s
# [s].
REGION_TIME = 1.5
TRIAL_TIME, DRIVEN_TIME = 0.35e-3, 5e-3
LEAST_SIZE, MOST_SIZE = 64, 16384


# ---- trials --------------------------------------------------------------------------------------


def check_scenario(scenario: lc.Scenario) -> None:
    """Reject a scenario that cannot be changed point by point.

    Raises:
        ValueError: If it is not a scenario, or not of the planar model.
    """
    check_instance("scenario", scenario, lc.Scenario)
    check_instance("scenario.model", scenario.model, lc.Planar)


def definition_of(scenario: lc.Scenario) -> dict[str, Any]:
    """Return everything of a scenario that the results depend on, for a file."""
    plain = codec.encode(scenario, lc.Scenario)
    plain["robot"].pop("description", None)
    return {"laticauda": packaging.__version__, **plain}


def attributes_of(scenario: lc.Scenario) -> dict[str, Any]:
    """Return the attributes that describe the scenario of stored results."""
    return {
        "Conventions": "CF-1.11",
        "history": f"made by laticauda {packaging.__version__}",  # no date, so that the same sweep gives the same bits
        "robot": scenario.robot.name,
        "gait": scenario.gait.kind,
        "environment": scenario.environment.name,
        "duration": scenario.duration,
        "joints": extensions.name_of(type(scenario.model.joints)),
        "laticauda": packaging.__version__,
    }


def labels_of(scenario: lc.Scenario) -> dict[str, dict[str, str]]:
    """Return the attributes of every stored parameter and quantity by name: description and unit."""
    known = {
        name: described(one.phrase, one.unit) for name, one in list_parameters(scenario).items()
    }
    return known | {name: of_figure(name) for name in QUANTITIES}


def check_ranges(
    scenario: lc.Scenario, ranges: Mapping[str, tuple[float, float]], argument: str = "points"
) -> None:
    """Reject ranges that cannot be swept, before any work is done.

    The ends of all ranges are tried, alone and together: fields have bounds, and some fields bound
    others.

    Args:
        scenario: What all trials share.
        ranges: Smallest and largest value of each parameter.
        argument: Name of the argument that they come from, for messages.

    Raises:
        ValueError: If there is no such parameter, or a value is out of its range; the message has
            its name.
    """
    known = list_parameters(scenario)
    for name, ends in ranges.items():
        parameter = look_up(name, known, argument)
        check_whole(parameter, np.array(ends))
    corners: Iterable[tuple[float, ...]] = itertools.product(*ranges.values())
    if 2 ** len(ranges) > MOST_CORNERS:
        corners = zip(*ranges.values(), strict=True)
    for corner in corners:
        values = dict(zip(ranges, corner, strict=True))
        try:
            other = change_parameters(scenario, values)
            other.gait.joint_envelope(lc.build_plant(other).robot.planar().n_links)
        except ValueError as error:
            listed = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            reason = str(error).replace("`", "")  # these are no arguments of the caller
            rule = f"must be within the bounds of the parameters, got {listed}: {reason.removesuffix('.')}"
            raise BadArgument(argument, rule) from error


def swim_points(
    scenario: lc.Scenario, names: tuple[str, ...], table: Table, threads: int | None = None
) -> dict[str, Column]:
    """Simulate the trials of some points.

    Args:
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
        threads: Number of threads; None uses all cores available to this process.

    Returns:
        One value per point of every quantity in `QUANTITIES`; nan where a run diverged, or where
        there is none.
    """
    runs = runs_of(scenarios_at(scenario, names, table))
    joints = {name: np.full(len(runs), np.nan) for name in NEEDS}

    def look(mine: Sequence[Run], block: Block) -> None:
        for name, values in joint_peaks(mine, block).items():
            joints[name][block.index] = values

    interval = scenario.sample_interval
    found = run_batch(
        runs,
        scenario.duration,
        interval,
        threads=threads,
        progress=silent,
        observe=look,
        with_joints=True,
    )
    kept = {
        name: np.where(found.succeeded & np.isfinite(values), values, np.nan)
        for name, values in joints.items()
    }
    return {
        **{name: found.figures[name] for name in FIGURES if name not in kept},
        **kept,
        "succeeded": found.succeeded,
    }


def scenarios_at(scenario: lc.Scenario, names: tuple[str, ...], table: Table) -> list[lc.Scenario]:
    """Return the scenario of every point; equal robots, gaits and environments are one object, created once.

    Args:
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
    """
    roots = {
        root: [i for i, name in enumerate(names) if name.split(".")[0] == root] for root in _ROOTS
    }
    made: dict[tuple[str, tuple[float, ...]], Any] = {}

    def part(root: str, row: tuple[float, ...]) -> Any:
        own = tuple(row[i] for i in roots[root])
        if (root, own) not in made:
            values = dict(zip((names[i] for i in roots[root]), own, strict=True))
            made[root, own] = getattr(change_parameters(scenario, values), _ROOTS[root])
        return made[root, own]

    used = [root for root in _ROOTS if roots[root]]
    rows = map(tuple, table.tolist())
    return [replace(scenario, **{_ROOTS[root]: part(root, row) for root in used}) for row in rows]


# ---- sweeps --------------------------------------------------------------------------------------


@value_class
class Sweep:
    """A scenario to sweep, and the points at which its numbers change.

    Raises:
        ValueError: If a field is out of its range, a parameter does not exist (the message has the
            nearest names), or a value is out of the parameter's range.

    Example:
        >>> import laticauda as lc
        >>> from laticauda.studies import Grid
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> sweep = Sweep(
        ...     scenario=lc.build_scenario("mamba", gait),
        ...     points=Grid(values={"gait.amplitude": [0.3, 0.5], "water.normal_drag": [1.0, 1.5, 2.0]}),
        ... )
        >>> sweep.n_trials
        6
    """

    scenario: lc.Scenario = option("Scenario shared by all trials; of the planar model")
    points: sampling.Points = option("Points of the sweep: `Grid`, `Rows` or `Samples`")

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        check_scenario(self.scenario)
        check_ranges(self.scenario, self.points.ranges)
        if not isinstance(self.points, sampling.Samples):
            known = list_parameters(self.scenario)
            for name in self.points.names:
                check_whole(known[name], self.points.values[name])

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(np.prod(self.points.shape, dtype=np.int64))

    def regions(self, size: int | None = None) -> "Regions":
        """Divide the sweep into regions of about a second of work, in the order of the work and of the files.

        Args:
            size: Maximum number of points in a region; None chooses it from the cost of a trial.
        """
        if size is None:
            s = self.scenario
            cost = TRIAL_TIME if isinstance(s.model.joints, lc.Prescribed) else DRIVEN_TIME
            trial = cost * s.duration / 30.0 * s.robot.n_links / 10.0
            size = int(np.clip(REGION_TIME / trial, LEAST_SIZE, MOST_SIZE))
        return divide_regions(self.points.shape, check_whole_number("region_size", size, 1))

    def tables(self, blocks: Iterable[tuple[slice, ...]]) -> Iterator[Table]:
        """Return the points of some regions, one after the other.

        Args:
            blocks: Blocks of the regions, in ascending order.
        """
        known = list_parameters(self.scenario)
        return self.points.tables(
            blocks, [name for name in self.points.names if known[name].is_whole]
        )

    def definition(self) -> dict[str, Any]:
        """Return everything that its results depend on, for a file."""
        return {**definition_of(self.scenario), "points": self.points.definition()}


@value_class
class Regions:
    """All regions of a sweep; they are the chunks of its stored arrays."""

    shape: tuple[int, ...] = quantity("", "Shape of the sweep's points", ge=1)
    block: tuple[int, ...] = quantity(
        "", "Size of a region; those at the far ends may be smaller", ge=1
    )

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of regions along each dimension."""
        return tuple(-(-n // size) for n, size in zip(self.shape, self.block, strict=True))

    @property
    def count(self) -> int:
        """Number of regions."""
        return math.prod(self.grid)

    def at(self, index: int) -> sampling.Block:
        """Return the block of one region.

        Args:
            index: Index of the region, with the last dimension varying fastest.
        """
        places = np.unravel_index(index, self.grid)
        return tuple(
            slice(int(place) * size, min((int(place) + 1) * size, n))
            for place, size, n in zip(places, self.block, self.shape, strict=True)
        )

    def n_points(self, index: int) -> int:
        """Return the number of points in a region.

        Args:
            index: Index of the region.
        """
        return math.prod(block_shape(self.at(index)))


def block_shape(block: sampling.Block) -> tuple[int, ...]:
    """Return the shape of a block."""
    return tuple(part.stop - part.start for part in block)


def divide_regions(shape: tuple[int, ...], size: int) -> Regions:
    """Form regions of about `size` points: whole along the last dimensions, nearly equal pieces along the others.

    Args:
        shape: Shape of the sweep's points.
        size: Maximum number of points in a region.
    """
    room = size
    block: list[int] = []
    for n in reversed(shape):
        most = max(1, min(n, room))
        length = -(-n // -(-n // most))
        block.append(length)
        room //= length
    return Regions(shape=shape, block=tuple(reversed(block)))
