"""A fleet: runs of one kind side by side, whose controllers decide again and again.

Unlike the robots of a `School`, those of a fleet differ in all that runs of one kind may differ in,
and everything is logged. The rows of each robot stay in its lane from one call of the kernels to the
next, and the results are those of the same robot alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.samples import PlantState
from laticauda.models.planar import rows
from laticauda.models.planar.batch import (
    PATH_ROWS,
    WIDTH,
    Block,
    Run,
    aligned,
    block_of,
    columns_of,
)
from laticauda.models.planar.fleet_loads import FleetLoads, LoadsOfLanes
from laticauda.models.planar.load_log import LoadLog
from laticauda.scenarios import REFERENCES, Command, Decisions, Observation, Observations
from laticauda.sensing import senses_of

ROW_OF_COMMAND = {
    "amplitude": rows.AMPLITUDE,
    "frequency": rows.FREQUENCY,
    "phase_shift": rows.PHASE_SHIFT,
    "offset": rows.OFFSET,
}
"""Row of every number that arrays command."""
_GAIT_NUMBERS = sorted(ROW_OF_COMMAND.values())
_SEEN = slice(rows.TIME, rows.VY + 1)
"""Rows of what every controller sees: time, heading, position and their rates."""


class NeedsRunOfItsOwn(Exception):
    """A command that the lanes of a fleet cannot take, such as another recording."""


class _PausedGait(NamedTuple):
    """A robot whose joints hold references."""

    state: PlantState
    """Its state when references took the place of the gait."""
    command: Command
    """The first of these commands."""
    gait_numbers: np.ndarray
    """Rows of what arrays had commanded of the gait until then."""


class Fleet:
    """Robots side by side, with a log of all that they do.

    Args:
        runs: Runs of the same kind, see `batch.kinds_of`, with the same time step.
        n_samples: Number of samples of the log, after the first.
        with_joints: Whether to log everything that the kernels can log, including the joints.
        with_loads: Whether to log the loads as well, for which everything is logged.
    """

    def __init__(
        self,
        runs: Sequence[Run],
        n_samples: int,
        *,
        with_joints: bool,
        with_loads: bool = False,
    ) -> None:
        self.runs = runs
        self.n = len(runs)
        self.plant = runs[0].plant
        self._kernel = self.plant.kernels_of(WIDTH).run
        n_blocks = -(-self.n // WIDTH)
        columns = columns_of(runs)
        unused = np.repeat(columns[:, -1:], n_blocks * WIDTH - self.n, axis=1)
        in_blocks = np.concatenate((columns, unused), axis=1).reshape(-1, n_blocks, WIDTH)
        self._lanes = aligned((n_blocks, len(columns), WIDTH), float)
        self._lanes[:] = in_blocks.transpose(1, 0, 2)
        n_rows = PATH_ROWS
        logs_joints = with_joints or with_loads
        if logs_joints:
            n_rows = self.plant.layout.sample_size
        self._log = aligned((n_blocks, 1 + n_samples, n_rows, WIDTH), float)
        self._between_samples = aligned((2, n_rows, WIDTH), float)
        self._logs_joints = logs_joints
        self._load_logs: list[LoadLog] = []
        """Loads of every block of lanes; empty if they are not requested."""
        if with_loads:
            plants = [run.plant for run in runs]
            for first in range(0, self.n, WIDTH):
                self._load_logs.append(LoadLog(plants[first : first + WIDTH], WIDTH, 1 + n_samples))
        self._lane_is_well = np.full((n_blocks, WIDTH), True)
        self._blocks_that_swim = list(range(n_blocks))
        self._n_samples = np.full((n_blocks, WIDTH), 1 + n_samples)
        self._gaits = [run.command.gait for run in runs]
        """The gait that each robot swims, except for what arrays command."""
        self._is_gait_alone = [True] * self.n
        self._gait_offset = np.array([gait.offset for gait in self._gaits])
        self._acting: Decisions | None = None
        self._paused: dict[int, _PausedGait] = {}
        """Robots whose joints hold references instead of their gait."""
        self._senses = [senses_of(run.plant.settings, run.plant.environment) for run in runs]
        self._has_sensors = any(senses is not None for senses in self._senses)
        self._last_seen = self._read(_SEEN)

    @property
    def is_well(self) -> np.ndarray:
        """Whether each robot still swims."""
        return self._lane_is_well.ravel()[: self.n]

    @property
    def any_swims(self) -> bool:
        """Whether any robot still swims."""
        return bool(self._blocks_that_swim)

    def observe(self) -> Observations:
        """Return what controllers see of all robots now."""
        seen = self._read(_SEEN)
        is_well = self.is_well
        observe = self._observe_one
        if self._has_sensors:
            observe = self._sense_all(is_well).__getitem__
        if not is_well.all():
            now = np.max(seen[0])
            seen = np.where(is_well, seen, self._last_seen)
            seen[0] = now  # time goes on for a robot whose lane no longer runs
        self._last_seen = seen
        return _FleetObservations(
            self,
            time=seen[0],
            heading=seen[2],
            center_of_mass=seen[3:5].T,
            heading_rate=seen[5],
            center_of_mass_velocity=seen[6:8].T,
            is_well=is_well,
            observe=observe,
        )

    def command(self, decisions: Decisions) -> None:
        """Let all robots do something else from now on.

        Args:
            decisions: What each is to do, see `Decisions`; numbers are those that `check_decisions`
            returns.

        Raises:
            NeedsRunOfItsOwn: If a command switches between recordings, or sets effectors that lanes
                cannot follow.
        """
        if decisions is self._acting:
            return
        self._acting = decisions
        if isinstance(decisions, Mapping):
            if REFERENCES in decisions:
                self._command_references(decisions[REFERENCES])
            else:
                self._command_numbers(decisions)
            return
        for i, command in enumerate(decisions):
            if command is not None:
                self._command_one(i, command)

    def march(self, leg: "LoggedLeg") -> None:
        """Let all robots swim a leg, and log it.

        Args:
            leg: The leg.
        """
        sample_interval = leg.duration / leg.n_intervals
        every = self.plant.steps_in(sample_interval)
        dt = sample_interval / every
        n_steps = leg.n_intervals * every
        chain = self.plant.layout.chain
        is_implicit = self.plant.is_implicit
        is_in_log = leg.begins_at_sample and leg.ends_at_sample
        loads = self.loads
        has_first_sample = leg.first > 0
        resumes = is_implicit and has_first_sample
        # Joints at a control instant are logged as they were under the command before.
        keeps_sample = self._logs_joints and has_first_sample and not resumes
        if resumes:
            self._lanes[self._blocks_that_swim, rows.RESUMES] = 1.0
        for block in self._blocks_that_swim:
            log = self._log[block]
            samples = self._between_samples
            if is_in_log:
                samples = log[leg.first : leg.first + leg.n_intervals + 1]
            sample_before = samples[0].copy() if keeps_sample else samples[0]
            self._kernel(self._lanes[block], *chain, is_implicit, n_steps, dt, every, samples)
            if loads.is_wanted:  # at once, while the processor's cache holds the block
                loads.evaluate_forces(block)
            if self._load_logs:
                self._log_loads(block, samples, leg)
            if is_in_log:
                if keeps_sample:
                    samples[0] = sample_before
                continue
            if leg.first == 0 and leg.begins_at_sample:
                log[0] = samples[0]
            if leg.ends_at_sample:
                log[leg.first + 1] = samples[1]
        loads.is_current = loads.is_wanted
        self._note_failures(leg)

    def _log_loads(self, block: int, samples: np.ndarray, leg: "LoggedLeg") -> None:
        """Log the loads at the samples of a leg; at a control instant they are those under the command before."""
        load_log = self._load_logs[block]
        lanes = self._lanes[block]
        if leg.first == 0 and leg.begins_at_sample:
            load_log.add(lanes, samples[:1], 0)
        if leg.ends_at_sample:
            n_intervals = leg.n_intervals if leg.begins_at_sample else 1
            load_log.add(lanes, samples[1 : n_intervals + 1], leg.first + 1)

    def retire(self, has_ended: np.ndarray) -> None:
        """Let some robots swim no more; what they did is in the log.

        Args:
            has_ended: For every robot, whether it has come to its end.
        """
        lanes = np.full(self._lane_is_well.size, has_ended[-1])  # lanes without a robot as the last
        lanes[: self.n] = has_ended
        self._lane_is_well &= ~lanes.reshape(self._lane_is_well.shape)
        self._blocks_that_swim = np.flatnonzero(self._lane_is_well.any(axis=1)).tolist()

    def blocks(self, indices: np.ndarray) -> Iterator[Block]:
        """Yield the results of all robots, a few at a time.

        Args:
            indices: Index of each robot's run in its batch.
        """
        for block in range(len(self._lanes)):
            index = indices[block * WIDTH : (block + 1) * WIDTH]
            n = index.size
            yield block_of(
                index,
                self._log[block, :, :, :n],
                self._lanes[block, :, :n],
                self._n_samples[block, :n],
                self._load_logs[block].loads() if self._load_logs else None,
            )

    def read_joints(self, row: int) -> Float[np.ndarray, "n n_joints"]:
        """Return a number of every joint of the body, one row per robot.

        Args:
            row: Row of the joint's record.
        """
        in_lanes = self._lanes[:, self._rows_of_joints(row)]
        by_robot = in_lanes.transpose(0, 2, 1).copy()  # the lanes move on
        return by_robot.reshape(-1, in_lanes.shape[1])[: self.n]

    def samples_of(self, i: int) -> Float[np.ndarray, "n_samples n_rows"]:
        """Return the log of one robot.

        Args:
            i: Index of the robot.
        """
        block, lane = divmod(i, WIDTH)
        return self._log[block, :, :, lane]

    def state_of(self, i: int) -> PlantState:
        """Return the state of one robot, for its plant.

        Args:
            i: Index of the robot.
        """
        block, lane = divmod(i, WIDTH)
        return self.resume(i, self._lanes[block, self.plant.layout.state_rows, lane])

    def resume(self, i: int, values: np.ndarray) -> PlantState:
        """Return the state of one robot with its reference generator where it paused, if it did.

        Args:
            i: Index of the robot.
            values: The numbers of its state as the kernels left them; they are changed.
        """
        if i not in self._paused:
            return PlantState(values=values)
        paused = self._paused[i]
        return self.runs[i].plant.state_after(paused.state, paused.command, values)

    @cached_property
    def loads(self) -> LoadsOfLanes:
        """What evaluates the loads of all robots."""
        return LoadsOfLanes(self.runs, self._lanes)

    @property
    def blocks_that_swim(self) -> list[int]:
        """Blocks of lanes in which any robot still swims."""
        return self._blocks_that_swim

    def _read(self, part: slice) -> np.ndarray:
        """Return rows of all robots: one row per quantity, one column per robot."""
        numbers = self._lanes[:, part].transpose(1, 0, 2)
        return numbers.reshape(numbers.shape[0], -1)[:, : self.n].copy()  # the lanes move on

    def _observe_one(self, i: int) -> Observation:
        plant = self.runs[i].plant
        block, lane = divmod(i, WIDTH)
        rows_now = self._lanes[block, :, lane].copy()  # the lanes move on
        observation = plant.observe(self.state_of(i))
        observation.give_loads(partial(plant.loads_of_rows, rows_now))
        return observation

    def _sense_all(self, is_well: np.ndarray) -> list[Observation]:
        """Return the observations of all robots with what their sensors tell; those that failed sense nothing new."""
        observations: list[Observation] = []
        for i, senses in enumerate(self._senses):
            observation = self._observe_one(i)
            if senses is not None and is_well[i]:
                observation = observation.with_readings(senses.read(observation))
            observations.append(observation)
        return observations

    def _command_numbers(self, numbers: Mapping[str, np.ndarray]) -> None:
        """Write what arrays command of the gaits into the lanes."""
        for i in list(self._paused):
            gait_numbers = self._paused[i].gait_numbers
            self._command_one(i, Command(gait=self._gaits[i]))
            self._lanes[i // WIDTH, _GAIT_NUMBERS, i % WIDTH] = gait_numbers
        in_lanes = np.zeros(self._lanes.shape[0] * WIDTH)
        for name, values in numbers.items():
            in_lanes[: self.n] = values
            if name == "offset":
                in_lanes[: self.n] += self._gait_offset
            in_lanes[self.n :] = in_lanes[self.n - 1]
            self._lanes[:, ROW_OF_COMMAND[name]] = in_lanes.reshape(-1, WIDTH)

    def _command_references(self, references: Float[np.ndarray, "n n_driven"]) -> None:
        """Write the references of all joints into the lanes."""
        if not self.is_well.all():
            references = np.where(self.is_well[:, np.newaxis], references, 0.0)
        if len(self._paused) < self.n:
            for i in set(range(self.n)) - self._paused.keys():
                angles = tuple(references[i].tolist())
                self._command_one(i, Command(gait=self._gaits[i], references=angles))
        n_lanes = len(self._lanes) * WIDTH
        if self.n < n_lanes:
            unused = np.repeat(references[-1:], n_lanes - self.n, axis=0)
            references = np.concatenate((references, unused))
        by_block = references.reshape(len(self._lanes), WIDTH, -1).transpose(0, 2, 1)
        envelope = self._rows_of_joints(rows.ENVELOPE)
        of_body = self._lanes[:, envelope]
        n_held, n_joints = by_block.shape[1], of_body.shape[1]
        of_body[:, :n_held] = by_block[:, :n_joints]
        if n_held > n_joints:  # that of a driven fin comes last
            self._lanes[:, envelope.start - rows.BODY_ROWS] = by_block[:, n_joints]

    def _rows_of_joints(self, row: int) -> slice:
        """Return the rows of all lanes that hold a row of the joints of the body."""
        layout = self.plant.layout
        first = rows.HEADER_ROWS + (layout.tail_link + 1) * rows.BODY_ROWS + row
        end = rows.HEADER_ROWS + layout.n_bodies * rows.BODY_ROWS
        return slice(first, end, rows.BODY_ROWS)

    def _command_one(self, i: int, command: Command) -> None:
        """Write one robot's command into its lane."""
        block, lane = divmod(i, WIDTH)
        gait = command.gait
        is_gait_alone = (
            command.references is None
            and command.enabled is None
            and command.thrusts is None
            and command.deflections is None
            and command.pitch_offset == 0.0
        )
        if is_gait_alone and self._is_gait_alone[i] and gait is self._gaits[i]:
            self._lanes[block, rows.OFFSET, lane] = gait.offset + command.offset
            return
        if gait.recorded != self._gaits[i].recorded:
            raise NeedsRunOfItsOwn
        if command.references is not None and gait.recorded is not None:
            raise NeedsRunOfItsOwn
        sets_effectors = command.thrusts is not None or command.deflections is not None
        has_memory = self.runs[i].plant.effector_dynamics.has_memory
        # A log of a lane knows the effectors of the first command only.
        if sets_effectors and (has_memory or self._logs_joints):
            raise NeedsRunOfItsOwn
        state = self.state_of(i)
        if command.references is None:
            self._paused.pop(i, None)
        else:
            gait_numbers = self._lanes[block, _GAIT_NUMBERS, lane]
            if i in self._paused:
                gait_numbers = self._paused[i].gait_numbers
            self._paused[i] = _PausedGait(state, command, gait_numbers)
        # Lanes without a robot do as the last one.
        lanes = slice(lane, WIDTH if i == self.n - 1 else lane + 1)
        new_rows = self.runs[i].plant.rows(state, command)
        self._lanes[block, :, lanes] = new_rows[:, np.newaxis]
        self._gaits[i] = gait
        self._is_gait_alone[i] = is_gait_alone

    def _note_failures(self, leg: "LoggedLeg") -> None:
        """Note which robots' numbers left the finite range in a leg, and after how many samples."""
        n_written = self._lanes[:, rows.SAMPLES]
        is_short = n_written <= leg.n_intervals
        if not is_short.any():
            return
        fails = self._lane_is_well & is_short
        if fails.any():
            self._n_samples[fails] = leg.first + n_written[fails].astype(int)
            self._lane_is_well &= ~fails
            self._blocks_that_swim = np.flatnonzero(self._lane_is_well.any(axis=1)).tolist()


class LoggedLeg(NamedTuple):
    """Time during which no robot of a fleet gets a new command."""

    duration: float
    """Its duration [s]."""
    n_intervals: int
    """Number of samples, the one at its end included."""
    first: int
    """Index in the log of the sample at its begin, or of the last one before."""
    begins_at_sample: bool
    """Whether the log has a sample at its begin."""
    ends_at_sample: bool
    """Whether the log has a sample at its end."""


class _FleetObservations(Observations):
    """What controllers see of a fleet; the joints are read on first access."""

    def __init__(self, fleet: Fleet, **seen: Any) -> None:
        super().__init__(**seen)
        self._fleet = fleet

    @cached_property
    def joint_angle(self) -> np.ndarray:
        """phi [rad]."""
        return self._fleet.read_joints(rows.ANGLE)

    @cached_property
    def joint_rate(self) -> np.ndarray:
        """phi' [rad/s]."""
        return self._fleet.read_joints(rows.RATE)

    @cached_property
    def loads(self) -> FleetLoads:
        """What links and joints bear, one row per robot."""
        return FleetLoads(self._fleet.loads, list(self._fleet.blocks_that_swim))
