"""Batches that carry derivatives: the figures of runs, and how they change with a number of each run.

The runs themselves are differentiated exactly: the kernels compute with a complex step
(`laticauda.compiling.duals`). How a number enters the rows that the kernels read is differentiated
in `laticauda.models.simulate.row_derivatives`.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from operator import is_
from typing import NamedTuple

import numpy as np

from laticauda.models.planar import batch, model
from laticauda.models.simulate import batch_run, runner
from laticauda.models.simulate.row_derivatives import (
    CENTRAL,
    LINEAR,
    Number as Number,
    RowDerivative,
    differentiate_rows,
    differentiate_wave,
)
from laticauda.trials import metrics


def compute_slopes(
    runs: Sequence[batch.Run],
    numbers: Sequence[Number],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: runner.Progress = runner.silent,
    observe: batch_run.BlockObserver = runner.silent,
    with_joints: bool = False,
) -> batch_run.BatchResult:
    """Compute figures and their derivatives, run i by number i, as complex numbers (see `models.planar.batch`).

    Args:
        runs: Runs from `laticauda.models.simulate.batch_scenarios.runs_of`; their time steps remain unchanged.
        numbers: The number with respect to which each run is differentiated.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        observe: Called once per block, in the computing threads, before the next block overwrites
            its log; all numbers there are complex, see `laticauda.models.planar.batch`.
        with_joints: Whether the log that `observe` receives includes the motion of the joints.

    Raises:
        ValueError: If a number cannot change to either side, or another argument is out of its
            range.
    """
    derived_runs: list[batch.Run] = []
    weights = np.empty(len(runs), dtype=complex)
    shared = SharedWork()
    for i, (run, number) in enumerate(zip(runs, numbers, strict=True)):
        derivative = shared.derivative_of(run, number)
        plant = run.plant
        if derivative.needs_extras and not plant.layout.has_extras:
            plant = shared.plant_with_extras(plant)
        derived_runs.append(replace(run, plant=plant, slope=derivative.rows))
        weights[i] = shared.weight_of(plant) + 1j * batch.STEP * derivative.weight
    result = batch_run.run_batch(
        derived_runs,
        duration,
        sample_interval,
        threads=threads,
        progress=progress,
        weights=weights,
        observe=observe,
        with_joints=with_joints,
    )
    undefined = complex(math.nan, math.nan)
    figures = {
        name: np.where(np.isnan(values), undefined, values)
        for name, values in result.figures.items()
    }
    return replace(result, figures=figures)


class _DerivativeKey(NamedTuple):
    """What decides how a number of the plant enters the rows of a run.

    The waves of the gait and the offsets do not: they are rows of their own.
    """

    plant: int
    """`id` of the plant."""
    number: str
    """Name of the number; "" for all numbers."""
    recording: int
    """`id` of the recorded motion, whose knots are rows; that of None without one."""
    references: tuple[float, ...] | None
    """Held references of the joints, see `Command`."""
    enabled: tuple[bool, ...] | None
    """Motors that are on, see `Command`."""
    thrusts: tuple[float, ...] | None
    """Commanded thrusts, see `Command`."""
    deflections: tuple[float, ...] | None
    """Commanded deflections, see `Command`."""

    @classmethod
    def of(cls, run: batch.Run, number: str = "") -> "_DerivativeKey":
        """Return that of a run and the name of a number."""
        command = run.command
        return cls(
            plant=id(run.plant),
            number=number,
            recording=id(command.gait.recorded),
            references=command.references,
            enabled=command.enabled,
            thrusts=command.thrusts,
            deflections=command.deflections,
        )


class _KeptList(NamedTuple):
    """Derivatives to several numbers, and of what they are."""

    key: _DerivativeKey
    """What decides about them apart from the numbers."""
    numbers: Sequence[Number]
    """The numbers."""
    derivatives: tuple[RowDerivative, ...]
    """How each enters the runs."""

    def is_of(self, numbers: Sequence[Number]) -> bool:
        """Return whether some numbers are the very objects of these derivatives."""
        return len(numbers) == len(self.numbers) and all(map(is_, numbers, self.numbers))


class SharedWork:
    """What runs of a batch have in common for their derivatives, computed once.

    Runs share a derivative if they have the same plant object, as `runs_of` gives to all scenarios
    that share robot, environment and model. The plants are compared by identity and must therefore
    live as long as this object: the runs hold them.
    """

    def __init__(self) -> None:
        self._derivatives: dict[_DerivativeKey, RowDerivative] = {}
        self._last_list: _KeptList | None = None
        """The derivatives that were asked for last: those of the next run are mostly the same."""
        self._weights: dict[int, float] = {}
        """Weights of robots, by the plant."""
        self._plants: dict[int, model.PlanarPlant] = {}
        """Plants with extras, by the plant without."""

    def derivatives_of(
        self, run: batch.Run, numbers: Sequence[Number]
    ) -> tuple[RowDerivative, ...]:
        """Return how several numbers enter a run; the same object if the run before has them in common.

        Args:
            run: The run.
            numbers: Numbers of its scenario.

        Raises:
            ValueError: If one of them cannot change to either side.
        """
        key = _DerivativeKey.of(run)
        last = self._last_list
        if last is not None and last.key == key and last.is_of(numbers):
            return last.derivatives
        derivatives = tuple(self.derivative_of(run, number) for number in numbers)
        self._last_list = _KeptList(key=key, numbers=numbers, derivatives=derivatives)
        return derivatives

    def derivative_of(self, run: batch.Run, number: Number) -> RowDerivative:
        """Return how a number enters a run.

        Args:
            run: The run.
            number: A number of its scenario.

        Raises:
            ValueError: If the number cannot change to either side.
        """
        if number.wave_parameter is not None and run.command.references is None:
            return differentiate_wave(run, number.wave_parameter)
        key = _DerivativeKey.of(run, number.name)
        if key in self._derivatives:
            return self._derivatives[key]
        if number.is_of_motion:
            return differentiate_rows(run, number, LINEAR)
        derivative = differentiate_rows(run, number, CENTRAL)
        self._derivatives[key] = derivative  # it is the same for all gaits
        return derivative

    def weight_of(self, plant: model.PlanarPlant) -> float:
        """Return the weight of a plant's robot, see `carried_weight` [N].

        Args:
            plant: The plant.
        """
        if id(plant) not in self._weights:
            self._weights[id(plant)] = metrics.carried_weight(plant.robot, plant.environment)
        return self._weights[id(plant)]

    def plant_with_extras(self, plant: model.PlanarPlant) -> model.PlanarPlant:
        """Return a plant with kernels that also compute loads that are 0 now, but whose derivatives are not.

        Args:
            plant: Plant with kernels that compute no such loads.
        """
        if id(plant) not in self._plants:
            self._plants[id(plant)] = _with_extras(plant)
        return self._plants[id(plant)]


def _with_extras(plant: model.PlanarPlant) -> model.PlanarPlant:
    """Return a copy of a plant whose cached property `layout` already has a value: one with extras."""
    copy = replace(plant)
    vars(copy)["layout"] = replace(plant.layout, has_extras=True)
    return copy
