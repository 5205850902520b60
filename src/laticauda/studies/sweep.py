"""Definition of a sweep: one scenario at thousands to millions of points, divided into regions."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.models.simulate import check_whole
from laticauda.models.simulate.numbers import list_parameters
from laticauda.studies import sampling
from laticauda.studies.point_trials import (
    check_ranges,
    check_scenario,
    definition_of,
    quantities_of,
)
from laticauda.studies.regions import Block, Regions, divide_regions
from laticauda.studies.sampling import Table
from laticauda.values import check_whole_number, option, value_class

REGION_TIME = 1.5
"""Time that a region is meant to take on one core [s]."""
PRESCRIBED_TRIAL_TIME = 0.35e-3
"""About what a trial of ten links and 30 s takes on one core if its joints are prescribed [s]."""
DRIVEN_TRIAL_TIME = 5e-3
"""About what it takes if its joints are driven [s]."""
LOADS_TIME = 1.5e-3
"""About what the loads of such a trial take besides [s]."""
SMALLEST_REGION = 64
"""Number of points in a region at least, if its size is chosen by the cost of a trial."""
LARGEST_REGION = 16384
"""Number of points in a region at most, if its size is chosen by the cost of a trial."""


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
    loads: bool = option(
        "Whether figures of what joints carry are stored, too: `laticauda.trials.LOAD_FIGURES`",
        default=False,
    )

    def __post_init__(self) -> None:
        """Check the fields against each other."""
        check_scenario(self.scenario)
        check_ranges(self.scenario, self.points.ranges)
        if not isinstance(self.points, sampling.Samples):
            parameters = list_parameters(self.scenario)
            for name in self.points.names:
                check_whole(parameters[name], self.points.values[name])

    @property
    def n_trials(self) -> int:
        """Number of trials."""
        return int(np.prod(self.points.shape, dtype=np.int64))

    def regions(self, size: int | None = None) -> Regions:
        """Divide the sweep into regions of about a second of work, in the order of the work and of the files.

        Args:
            size: Maximum number of points in a region; None chooses it from the cost of a trial.
        """
        if size is None:
            size = self.default_region_size()
        return divide_regions(self.points.shape, check_whole_number("region_size", size, 1))

    def default_region_size(self) -> int:
        """Return the number of trials that take about `REGION_TIME`."""
        scenario = self.scenario
        cost = DRIVEN_TRIAL_TIME
        if isinstance(scenario.model.joints, lc.Prescribed):
            cost = PRESCRIBED_TRIAL_TIME
        if self.loads:
            cost += LOADS_TIME
        trial_time = cost * scenario.duration / 30.0 * scenario.robot.n_links / 10.0
        return int(np.clip(REGION_TIME / trial_time, SMALLEST_REGION, LARGEST_REGION))

    def tables(self, blocks: Iterable[Block]) -> Iterator[Table]:
        """Return the points of some regions, one after the other.

        Args:
            blocks: Blocks of the regions, in ascending order.
        """
        parameters = list_parameters(self.scenario)
        counts = [name for name in self.points.names if parameters[name].is_whole]
        return self.points.tables(blocks, counts)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of all that is stored for every trial."""
        return quantities_of(loads=self.loads)

    def definition(self) -> dict[str, Any]:
        """Return everything that its results depend on, for a file."""
        definition = {**definition_of(self.scenario), "points": self.points.definition()}
        if self.loads:  # folders of older releases have none
            definition["loads"] = True
        return definition
