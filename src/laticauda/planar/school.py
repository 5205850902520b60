"""A school: equal robots side by side, each told anew what to do whenever a control interval is over.

The lanes are those of `laticauda.planar.batch`, but they stay in place between intervals. A lane may begin anew at any
time, with a start and a current of its own, and a lane whose numbers leave all bounds harms no other one. A robot's
numbers are those of the same robot alone (`PlanarPlant.step`), whatever its neighbors do.
"""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, fields
from itertools import repeat
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.dynamics.plant import PlantState
from laticauda.errors import BadArgument, positive, whole
from laticauda.interfaces import Command, Observation, Start
from laticauda.planar import rows
from laticauda.planar.batch import WIDTH, aligned
from laticauda.planar.model import PlanarPlant
from laticauda.robot import Water, has_power_model

CLOSE = 1e-9  # [s]: two moments that are one
STATE = slice(rows.TIME, rows.TIME + rows.LOG_STATE)
COMMAND = slice(rows.AMPLITUDE, rows.OFFSET + 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """How all robots of a school move at one moment; world axes, one entry per robot."""

    time: Float[np.ndarray, " n"] = field(metadata={"row": rows.TIME})
    """Since its start [s]."""
    x: Float[np.ndarray, " n"] = field(metadata={"row": rows.X})
    """Of the center of mass [m]."""
    y: Float[np.ndarray, " n"] = field(metadata={"row": rows.Y})
    """The same [m]."""
    velocity_x: Float[np.ndarray, " n"] = field(metadata={"row": rows.VX})
    """Of the center of mass, over ground [m/s]."""
    velocity_y: Float[np.ndarray, " n"] = field(metadata={"row": rows.VY})
    """The same [m/s]."""
    heading: Float[np.ndarray, " n"] = field(metadata={"row": rows.HEADING})
    """Mean link angle (6), unwrapped, with the gait's ripple [rad]."""
    heading_rate: Float[np.ndarray, " n"] = field(metadata={"row": rows.HEADING_RATE})
    """[rad/s]."""
    phase: Float[np.ndarray, " n"] = field(metadata={"row": rows.PHASE})
    """Of the gait at the tail-most joint, unwrapped [rad]."""
    amplitude: Float[np.ndarray, " n"] = field(metadata={"row": rows.AMPLITUDE_NOW})
    """alpha as the reference generator has it by now, without the smooth start [rad]."""
    frequency: Float[np.ndarray, " n"] = field(metadata={"row": rows.FREQUENCY_NOW})
    """omega, the same [rad/s]."""
    phase_shift: Float[np.ndarray, " n"] = field(metadata={"row": rows.PHASE_SHIFT_NOW})
    """delta, the same [rad]."""
    offset: Float[np.ndarray, " n"] = field(metadata={"row": rows.OFFSET_NOW})
    """phi_0, the same [rad]."""
    work: Float[np.ndarray, " n"] = field(metadata={"row": rows.WORK_ABSOLUTE})
    """What `mean_power` counts, since its start: electrical where the robot has a power model, else mechanical [J]."""


_NAMES = tuple(part.name for part in fields(Motion))
_ROWS = np.array([part.metadata["row"] for part in fields(Motion)]) - rows.TIME
_COMMANDS = {
    "amplitude": rows.AMPLITUDE,
    "frequency": rows.FREQUENCY,
    "phase_shift": rows.PHASE_SHIFT,
    "offset": rows.OFFSET,
}


class School:
    """Robots of one plant in lanes that stay.

    Args:
        plant: What each of them is; it swims in water.
        command: What they are asked for until they are told otherwise, and where their generators begin.
        n: How many.
        interval: From one command to the next [s].
        threads: The lanes are shared out among as many. More than one pays from some thousand robots on, on cores that
            have nothing else to do.

    Raises:
        ValueError: If an argument is out of its range.
    """

    def __init__(self, plant: PlanarPlant, command: Command, n: int, interval: float, *, threads: int = 1) -> None:
        if not isinstance(plant.environment, Water):
            raise BadArgument("plant", "must swim in water, got one on the ground")
        self.plant, self.n = plant, whole("n", n, 1)
        self.interval = positive("interval", interval, "s")
        # One robot is faster in a kernel of one lane, and does the same in it.
        self._width = 1 if n == 1 else WIDTH
        n_blocks = -(-n // self._width)
        self._first = plant.rows(plant.init(Start(), command), command)
        self._lanes = aligned((n_blocks, self._first.size, self._width), float)
        self._lanes[:] = self._first[:, np.newaxis]
        self._well = np.full(n, True)
        n_threads = min(whole("threads", threads, 1), n_blocks)
        self._shares = np.array_split(np.arange(n_blocks), n_threads)
        self._workers = ThreadPoolExecutor(n_threads) if n_threads > 1 else None
        has_power = has_power_model(plant.robot, plant.joints)
        self._wanted = _ROWS.copy()
        self._wanted[-1] = (rows.WORK_ELECTRICAL if has_power else rows.WORK_ABSOLUTE) - rows.TIME
        kernel: Any = plant.kernels_of(self._width).run
        self._kernel, self._shape = kernel, plant.layout.chain
        # What was told last stands last in line; what acts until the delay is over, before what acts from then on.
        late, part = divmod(plant.settings.loop_delay + CLOSE, self.interval)
        cut = [part - CLOSE] if part > 2.0 * CLOSE else []
        self._line = [self._lanes[:, COMMAND].copy() for _ in range(int(late) + 1 + len(cut))]
        self._parts = [*cut, self.interval - sum(cut)]
        self._seen = self._look()
        self._motion = self._named()

    @property
    def motion(self) -> Motion:
        """How they move; of one that failed, the last that made sense."""
        return self._motion

    @property
    def is_well(self) -> Bool[np.ndarray, " n"]:
        """Whether the numbers of each robot are still within all bounds."""
        return self._well.copy()

    def place(
        self,
        which: Int[np.ndarray, " n_placed"],
        *,
        center_of_mass: Float[np.ndarray, "n_placed 2"],
        heading: Float[np.ndarray, " n_placed"],
        current: Float[np.ndarray, "n_placed 2"],
    ) -> None:
        """Let some of them begin anew: straight, at rest, their generators at the first command.

        Args:
            which: Their numbers.
            center_of_mass: Where [m].
            heading: [rad].
            current: Of the water around each, in world axes [m/s].
        """
        block, lane = np.divmod(which, self._width)
        self._lanes[block, :, lane] = self._first
        for told in self._line:
            told[block, :, lane] = self._first[COMMAND]
        for row, values in (
            (rows.X, center_of_mass[:, 0]),
            (rows.Y, center_of_mass[:, 1]),
            (rows.HEADING, heading),
            (rows.CURRENT_X, current[:, 0]),
            (rows.CURRENT_Y, current[:, 1]),
        ):
            self._lanes[block, row, lane] = values
        self._well[which] = True
        self._keep_seen()

    def tell(self, command: Mapping[str, Float[np.ndarray, " n"]]) -> None:
        """Ask every robot for something else from now on, or from when the plant's `loop_delay` is over.

        Args:
            command: Any of amplitude [rad], frequency [rad/s], phase_shift [rad] and offset [rad]; the last is the
                gait's own and what steering adds.
        """
        for name, values in command.items():
            every = np.full(self._lanes.shape[0] * self._width, self._first[_COMMANDS[name]])
            every[: self.n] = values
            self._line[-1][:, _COMMANDS[name] - COMMAND.start] = every.reshape(-1, self._width)

    def march(self) -> None:
        """Let one interval go by."""
        for duration, told in zip(self._parts, self._line, strict=False):
            self._lanes[:, COMMAND] = told
            self._swim_for(duration)
        self._line = [*self._line[1:], self._line[-1].copy()]
        self._well &= self._of_each(self._lanes[:, rows.WELL : rows.WELL + 1])[0] > 0.0
        self._keep_seen()

    def state(self, which: int) -> PlantState:
        """The state of one of them, for `PlanarPlant`."""
        block, lane = divmod(which, self._width)
        values = self._lanes[block, :, lane]
        n_bodies = self.plant.layout.n_bodies
        body = values[rows.HEADER_ROWS : rows.HEADER_ROWS + n_bodies * rows.BODY_ROWS].reshape(-1, rows.BODY_ROWS)
        return PlantState(values=np.concatenate((values[STATE], body[1:, rows.ANGLE], body[1:, rows.RATE])))

    def observe(self, which: int) -> Observation:
        """What can be seen of one of them."""
        return self.plant.observe(self.state(which))

    def close(self) -> None:
        """Let its threads go."""
        if self._workers is not None:
            self._workers.shutdown()

    def _swim_for(self, duration: float) -> None:
        """All lanes, for so long [s]."""
        steps = self.plant.steps_in(duration)
        how = (self.plant.is_implicit, steps, duration / steps, steps)
        if self._workers is None:
            self._swim(self._shares[0], how)
        else:
            list(self._workers.map(self._swim, self._shares, repeat(how)))

    def _swim(self, blocks: np.ndarray, how: tuple[bool, int, float, int]) -> None:
        sample = np.empty((2, 1, self._width))  # the kernel's log; the lanes themselves say all that is needed
        for block in blocks:
            lanes = self._lanes[block] if self._width > 1 else self._lanes[block, :, 0]
            self._kernel(lanes, *self._shape, *how, sample)

    def _keep_seen(self) -> None:
        self._seen = np.where(self._well, self._look(), self._seen)
        self._motion = self._named()

    def _named(self) -> Motion:
        self._seen.flags.writeable = False  # it is handed out
        return Motion(**dict(zip(_NAMES, self._seen, strict=True)))

    def _look(self) -> np.ndarray:
        return self._of_each(self._lanes[:, STATE])[self._wanted]

    def _of_each(self, part: np.ndarray) -> np.ndarray:
        """Rows of all blocks as one row per quantity, one column per robot."""
        return part.transpose(1, 0, 2).reshape(part.shape[1], -1)[:, : self.n]
