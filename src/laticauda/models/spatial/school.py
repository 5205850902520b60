"""Several robots in space: a school that shares a few MuJoCo models, one per thread, or all robots in one model."""

# pyright: reportPrivateUsage=false

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, cast

import numpy as np

from laticauda.models.dynamics import school
from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.dynamics.samples import PlantState, Stretch
from laticauda.models.dynamics.school import Currents
from laticauda.models.spatial import rows
from laticauda.models.spatial.model import NO_STEP, SpatialPlant
from laticauda.models.spatial.surroundings import check_free
from laticauda.models.spatial.twin import KernelInputs, Twin
from laticauda.motion.gaits import WaveState
from laticauda.robot import has_power_model
from laticauda.scenarios import Command, Observation, Start
from laticauda.values import BadArgument

WAVE = [
    rows.PHASE + WaveState._fields.index(name)
    for name in ("phase", "amplitude", "frequency", "phase_shift", "offset")
]
"""Rows of a state that a `Motion` has of the gait, in its order."""
ELECTRICAL_WORK = rows.WORK_ABSOLUTE + 3


class School(school.School[SpatialPlant]):
    """Robots in space, whose runs release the interpreter lock. Arguments are those of the base class."""

    usual_threads = school.usable_cores()

    def _allocate(self, n_threads: int) -> Sequence[range]:
        plant = self.plant
        n_plants = min(n_threads, self.n)
        plants: list[SpatialPlant] = [plant] + [replace(plant) for _ in range(1, n_plants)]
        self._plants: list[SpatialPlant] = [plants[i % n_plants] for i in range(self.n)]
        self._states = [plant.init(Start(), self.command)] * self.n
        self._work_row = rows.WORK_ABSOLUTE
        if has_power_model(plant.robot, plant.joints):
            self._work_row = ELECTRICAL_WORK
        return [range(first, self.n, n_plants) for first in range(n_plants)]

    def state(self, index: int) -> PlantState:
        """Return the state of one robot, for `SpatialPlant`."""
        return self._states[index]

    def _restart(
        self,
        indices: np.ndarray,
        center_of_mass: np.ndarray,
        heading: np.ndarray,
        currents: Currents,
    ) -> None:
        for k, i in enumerate(map(int, indices)):
            start = Start(
                center_of_mass=tuple(center_of_mass[k].tolist()), heading=float(heading[k])
            )
            self._plants[i] = self._plants[i].in_current(cast(Any, currents[k]))
            self._states[i] = self._plants[i].init(start, self.command)

    def commands_of(self, gaits: np.ndarray) -> list[Command]:
        """Return the command of each robot.

        Args:
            gaits: Gait parameters, one row each and one column per robot; their offset includes
                that of steering.
        """
        commands: list[Command] = []
        for parameters in gaits.T.tolist():
            named_parameters = dict(zip(school.GAIT_PARAMETERS, parameters, strict=True))
            gait = replace(self.command.gait, **named_parameters)
            commands.append(replace(self.command, gait=gait, offset=0.0))
        return commands

    def _swim(self, gaits: np.ndarray, duration: float) -> np.ndarray:
        commands = self.commands_of(gaits)
        is_well = self._is_well.copy()

        def march_share(share: range) -> None:
            for i in share:
                march = self._plants[i].march(self._states[i], commands[i], duration, duration)
                self._states[i] = march.state
                is_well[i] &= march.failure is None

        self._apply_to_shares(march_share)
        return is_well

    def _read_motion(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        columns: list[np.ndarray] = []
        observations: list[Observation] = []
        for plant, state in zip(self._plants, self._states, strict=True):
            observation = plant.observe(state)
            column = [
                observation.time,
                *observation.center_of_mass[:2],
                *observation.center_of_mass_velocity[:2],
                observation.heading,
                observation.heading_rate,
                *state.values[WAVE],
                state.values[self._work_row],
            ]
            columns.append(np.array(column))
            observations.append(observation)
        return np.stack(columns, axis=1), tuple(observations)


class JointAdvance(NamedTuple):
    """Several robots after a number of time steps in one scene."""

    states: list[PlantState]
    """State of each robot at the end, or at the start if the run diverged."""
    stretches: list[Stretch]
    """Samples of each robot, up to the failure if the run diverged."""
    failure: str | None
    """What went wrong, in a sentence; None if nothing did."""


class Together:
    """The plants of several robots in one scene, advanced together; see `Twin` for their names in its model.

    Args:
        plants: One plant per robot, with the robot's own settings and the same scene for all.
    """

    def __init__(self, plants: Sequence[SpatialPlant]) -> None:
        for i, plant in enumerate(plants):
            if plant.effector_dynamics.has_memory:
                rule = "must have no driven effector with a rise time, or a fin with a dead band,"
                raise BadArgument(f"scenarios[{i}].robot", f"{rule} in one scene with others")
        self.plants = plants
        first = plants[0]
        self._neighbors = [(plant.robot, plant.settings) for plant in plants[1:]]
        self.twin = Twin(first.robot, first.environment, first.settings, self._neighbors)

    @cached_property
    def _sensing_twin(self) -> Twin:
        """The twin with sensors of what joints carry, which others do without."""
        first = self.plants[0]
        return Twin(
            first.robot, first.environment, first.settings, self._neighbors, senses_loads=True
        )

    def check(self, states: Sequence[PlantState]) -> None:
        """Raise a ValueError if robots penetrate one another, or another object, in the initial states."""
        data = self.twin.data([state.values for state in states])
        check_free(self.twin.model, data, self.twin.order.tolist())

    def march(
        self,
        states: Sequence[PlantState],
        commands: Sequence[Command],
        duration: float,
        sample_interval: float,
        *,
        link_forces: bool = False,
    ) -> JointAdvance:
        """Advance by many steps at once; see `Plant.advance`.

        Args:
            states: Initial state of each robot.
            commands: One command per robot, held throughout.
            duration: Duration [s].
            sample_interval: Interval between two samples of the logs [s].
            link_forces: Whether to keep the force on every link, and what every joint carries, too.
        """
        n_intervals = max(1, round(duration / sample_interval))
        every = max(plant.steps_in(duration / n_intervals) for plant in self.plants)
        dt = duration / n_intervals / every
        vectors = self._start_vectors(states, commands)
        inputs = [plant._inputs(command) for plant, command in self._pair_with(commands)]
        samples = self.twin.run(
            vectors,
            inputs,
            steps=n_intervals * every,
            dt=dt,
            every=every,
            environment=self.plants[0].environment,
        )
        first_columns = self.twin.places[1:-1, rows.FIRST_COLUMN]
        samples_of_robots = np.split(samples, first_columns, axis=1)
        stretches = [
            Stretch(part, command)
            for command, part in zip(commands, samples_of_robots, strict=True)
        ]
        if len(samples) <= n_intervals:
            time = states[0].values[rows.TIME] + len(samples) * duration / n_intervals
            failure = self.plants[0].describe_divergence(time)
            return JointAdvance(list(states), stretches, failure)
        ends: list[PlantState] = []
        for (plant, command), state, end in zip(
            self._pair_with(commands), states, vectors, strict=True
        ):
            ends.append(plant.state_after(state, command, end))
        if link_forces:
            first_vectors = self._start_vectors(states, commands)
            loads = self._compute_loads(first_vectors, inputs, len(samples), every, dt)
            stretches = [
                stretch._replace(loads=loads_of_robot)
                for stretch, loads_of_robot in zip(stretches, loads, strict=True)
            ]
        return JointAdvance(ends, stretches, failure=None)

    def _start_vectors(
        self, states: Sequence[PlantState], commands: Sequence[Command]
    ) -> list[np.ndarray]:
        """Return the state vector of each robot with which a march begins."""
        vectors: list[np.ndarray] = []
        for (plant, command), state in zip(self._pair_with(commands), states, strict=True):
            vectors.append(plant._start_values(state, command))
        return vectors

    def _compute_loads(
        self,
        vectors: list[np.ndarray],
        inputs: list[KernelInputs],
        n_samples: int,
        every: int,
        dt: float,
    ) -> list[SampledLoads]:
        """Return the loads of each robot, by repeating the march and evaluating them at each sample.

        Args:
            vectors: State vectors at its begin; they are changed.
            inputs: What each robot is to do.
            n_samples: Number of samples.
            every: Number of steps between two of them.
            dt: The step [s].
        """
        environment = self.plants[0].environment
        loads = [
            SampledLoads.zeros(n_samples=n_samples, n_links=plant.robot.n_links, n_axes=3)
            for plant in self.plants
        ]
        sensing = self._sensing_twin
        for sample in range(n_samples):
            if sample > 0:
                self.twin.run(
                    vectors, inputs, steps=every, dt=dt, every=every, environment=environment
                )
            vectors_now = [vector.copy() for vector in vectors]
            sensing.run(vectors_now, inputs, steps=0, dt=NO_STEP, every=1, environment=environment)
            for robot, loads_of_robot in enumerate(loads):
                forces = sensing.forces(robot)
                sensing.loads(forces, robot).write(loads_of_robot, sample, forces)
        return loads

    def _pair_with(self, commands: Sequence[Command]) -> list[tuple[SpatialPlant, Command]]:
        """Return the plants, each with its command."""
        return list(zip(self.plants, commands, strict=True))
