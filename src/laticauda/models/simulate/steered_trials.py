"""Trials of several scenarios with controllers, computed side by side: each with its log, as from `swim`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias, cast

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.models.dynamics.samples import Stretch
from laticauda.models.planar import Fleet, NeedsRunOfItsOwn, Run
from laticauda.models.simulate.batch_scenarios import runs_of
from laticauda.models.simulate.plants import build_plant
from laticauda.models.simulate.runner import run_scenario
from laticauda.models.simulate.steered import Sampling, split_into_fleets, swim_fleets
from laticauda.models.simulate.timeline import cut_duration
from laticauda.motion.gaits import Gait
from laticauda.scenarios import (
    Controller,
    Observation,
    Observations,
    OpenLoop,
    Planar,
    Scenario,
    Start,
    kind_of_controller,
)
from laticauda.sensing import Sensor, signals_of_readings
from laticauda.trials import REACHED_END, Trial
from laticauda.values import packaging

HasArrived: TypeAlias = Callable[[Observations, Int[np.ndarray, " n"]], Bool[np.ndarray, " n"]]
"""Says of robots, by what is seen of them and their scenarios' indices, which of them have come to an end."""


def swim_side_by_side(
    scenarios: Sequence[Scenario], has_arrived: HasArrived | None = None
) -> list[Trial]:
    """Return the trial of every scenario; planar ones with controllers are computed side by side.

    The trials are those of `swim`, up to rounding.

    Args:
        scenarios: The scenarios, all with the same duration and sample interval.
        has_arrived: Called at every control instant after the first: a run ends early where it returns
            True.
    """
    is_steered = [_is_planar_and_steered(scenario) for scenario in scenarios]
    side_by_side = [i for i in range(len(scenarios)) if is_steered[i]]
    trials: dict[int, Trial] = {}
    if side_by_side:
        trials = _swim_in_fleets(scenarios, side_by_side, has_arrived)
    for i, scenario in enumerate(scenarios):
        if i not in trials:
            trials[i] = _swim_alone(scenario, i, has_arrived)
    return [trials[i] for i in range(len(scenarios))]


def _is_planar_and_steered(scenario: Scenario) -> bool:
    """Return whether a scenario can be part of a fleet."""
    is_planar = isinstance(scenario.model, Planar) and isinstance(scenario.start, Start)
    return is_planar and not isinstance(scenario.motion, Gait | OpenLoop)


def _swim_in_fleets(
    scenarios: Sequence[Scenario], indices: Sequence[int], has_arrived: HasArrived | None
) -> dict[int, Trial]:
    """Return the trials of those that fleets can hold and that did not diverge, by index."""
    runs = runs_of([scenarios[i] for i in indices], steered=True)
    first = scenarios[indices[0]]
    trials: dict[int, Trial] = {}
    for places in _kinds_of_controllers(runs).values():
        controller = cast("Controller[Any]", runs[places[0]].controller)
        sampling = Sampling.of(controller, first.duration, first.sample_interval)
        members = _split_into_members(runs, places, first)
        places_in_order: list[int] = []
        for member in members:
            places_in_order += member
        members_in_order = [indices[place] for place in places_in_order]
        sensors = [scenarios[i].model.sensors for i in members_in_order]
        index = np.array(members_in_order)
        watch = _Watch(index, has_arrived, sensors)
        runs_of_fleets: list[list[Run]] = []
        for member in members:
            runs_of_fleets.append([runs[place] for place in member])
        try:
            fleets = swim_fleets(
                runs_of_fleets,
                first.duration,
                first.sample_interval,
                with_joints=True,
                watch=watch.look,
            )
        except NeedsRunOfItsOwn:
            continue
        signals = watch.signals_of_robots()
        robots: list[tuple[Fleet, int]] = []
        for fleet in fleets:
            robots += [(fleet, robot) for robot in range(fleet.n)]
        for column, (fleet, robot) in enumerate(robots):
            n_finished = int(watch.n_finished[column])
            if not fleet.is_well[robot] and n_finished == 0:
                continue
            n_intervals = n_finished or sampling.n_intervals
            i = int(index[column])
            signals_of_robot = {name: values[:, column] for name, values in signals.items()}
            signals_of_robot |= watch.signals_of_sensors(column)
            sampled_signals = _sample_signals(signals_of_robot, n_intervals, sampling)
            trials[i] = _trial_of(scenarios[i], fleet, robot, n_intervals, sampled_signals)
    return trials


def _kinds_of_controllers(runs: Sequence[Run]) -> dict[object, list[int]]:
    """Return the indices of runs whose controllers decide together."""
    kinds: dict[object, list[int]] = {}
    for place, run in enumerate(runs):
        controller = cast("Controller[Any]", run.controller)
        n_joints = run.plant.robot.n_joints
        kind = kind_of_controller(controller), controller.interval, n_joints
        kinds.setdefault(kind, []).append(place)
    return kinds


def _split_into_members(
    runs: Sequence[Run], places: Sequence[int], scenario: Scenario
) -> list[list[int]]:
    """Return the indices of the runs of every fleet, of those in `places`."""
    fleets = split_into_fleets(
        [runs[place] for place in places],
        scenario.duration,
        scenario.sample_interval,
        n_threads=1,
        with_joints=True,
    )
    members_of_fleets: list[list[int]] = []
    for members in fleets:
        members_of_fleets.append([places[int(member)] for member in members])
    return members_of_fleets


class _Watch:
    """What is kept of a fleet at every control instant.

    Args:
        index: Index of each robot's scenario.
        has_arrived: Says which robots have come to an end; None: none does.
        sensors: The sensors of each robot.
    """

    def __init__(
        self,
        index: np.ndarray,
        has_arrived: HasArrived | None,
        sensors: Sequence[Sequence[Sensor]],
    ) -> None:
        self._index = index
        self._has_arrived = has_arrived
        self._sensors = sensors
        self._readings: list[list[Mapping[str, float]]] = [[] for _ in sensors]
        """What the sensors of each robot told at every instant."""
        self.signals: list[Mapping[str, np.ndarray]] = []
        """Signals of the controllers at every instant."""
        self.n_finished = np.zeros(index.size, dtype=int)
        """Number of control intervals after which each robot had come to its end; 0: it has not."""

    def signals_of_robots(self) -> dict[str, Float[np.ndarray, "n_instants n"]]:
        """Return the signals by name: one row per instant, one column per robot."""
        names = self.signals[0]
        return {name: np.stack([signals[name] for signals in self.signals]) for name in names}

    def signals_of_sensors(self, robot: int) -> dict[str, Float[np.ndarray, " n_instants"]]:
        """Return what the sensors of a robot told at every instant, by the names that logs give it.

        Args:
            robot: Index of the robot in the fleet.
        """
        readings = self._readings[robot]
        if not readings:
            return {}
        return {name: np.array([reading[name] for reading in readings]) for name in readings[0]}

    def look(
        self, observations: Observations, signals: Mapping[str, np.ndarray]
    ) -> Bool[np.ndarray, " n"]:
        """Look at a control instant; return which robots have come to an end.

        Args:
            observations: What is seen of the robots.
            signals: Signals of their controllers.
        """
        n_before = len(self.signals)
        self.signals.append(signals)
        for robot, sensors in enumerate(self._sensors):
            if sensors and observations.is_well[robot]:
                readings = observations.of_robot(robot).readings
                self._readings[robot].append(signals_of_readings(sensors, readings))
        if self._has_arrived is None or n_before == 0:
            return self.n_finished > 0
        arrives = self._has_arrived(observations, self._index) & observations.is_well
        self.n_finished[arrives & (self.n_finished == 0)] = n_before
        return self.n_finished > 0


def _sample_signals(
    signals: Mapping[str, np.ndarray], n_intervals: int, sampling: Sampling
) -> dict[str, np.ndarray]:
    """Return the signals of one robot at every sample: those of the control instant before it, or at it.

    The very last sample has those of the instant before.
    """
    n_samples = 1 + n_intervals * sampling.samples_per_interval
    instants = np.arange(n_samples) // sampling.samples_per_interval
    instants = np.minimum(instants, n_intervals - 1)
    return {name: values[instants] for name, values in signals.items()}


def _trial_of(
    scenario: Scenario,
    fleet: Fleet,
    robot: int,
    n_intervals: int,
    signals: Mapping[str, np.ndarray],
) -> Trial:
    """Return the trial of one robot of a fleet, which ended after some control intervals."""
    run: Run = fleet.runs[robot]
    plant = run.plant
    interval = scenario.controller.interval
    sampling = Sampling.of(scenario.controller, scenario.duration, scenario.sample_interval)
    duration = scenario.duration
    if n_intervals < sampling.n_intervals:
        duration = cut_duration(duration, interval, n_intervals)
    n_samples = 1 + n_intervals * sampling.samples_per_interval
    samples = fleet.samples_of(robot)[:n_samples].copy()
    log = plant.log([Stretch(samples, run.command)])
    series = replace(log, signals={**signals, **log.signals})
    state = fleet.resume(robot, samples[-1, : plant.layout.state_size].copy())
    return Trial(
        **vars(series),
        scenario=replace(scenario, robot=plant.robot, model=plant.settings, duration=duration),
        version=packaging.__version__,
        status=REACHED_END,
        succeeded=True,
        state=plant.pack(state),
    )


def _swim_alone(scenario: Scenario, i: int, has_arrived: HasArrived | None) -> Trial:
    """Return the trial of a scenario that is computed by itself."""
    plant = build_plant(scenario)
    if has_arrived is None:
        return run_scenario(scenario, plant)
    index = np.array([i])

    def until(observation: Observation) -> bool:
        return bool(has_arrived(_observations_of(observation), index)[0])

    return run_scenario(scenario, plant, until=until)


def _observations_of(observation: Observation) -> Observations:
    """Return the observation of one robot as those of many."""
    return Observations(
        time=np.array([observation.time]),
        center_of_mass=np.array([observation.center_of_mass]),
        center_of_mass_velocity=np.array([observation.center_of_mass_velocity]),
        heading=np.array([observation.heading]),
        heading_rate=np.array([observation.heading_rate]),
        is_well=np.array([True]),
        observe=lambda _: observation,
    )
