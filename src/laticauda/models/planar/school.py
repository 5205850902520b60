"""A school of planar robots: lanes as in `laticauda.models.planar.batch`, but kept in place between intervals."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from laticauda.models.dynamics import school
from laticauda.models.dynamics.plant import PlantState
from laticauda.models.dynamics.school import Currents
from laticauda.models.planar import rows
from laticauda.models.planar.batch import COMMAND, WIDTH, aligned
from laticauda.models.planar.layout import flow_rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import Water, has_power_model
from laticauda.scenarios.interfaces import Observation, Start
from laticauda.values.errors import BadArgument

STATE = slice(rows.TIME, rows.TIME + rows.LOG_STATE)
NOW = (rows.AMPLITUDE_NOW, rows.FREQUENCY_NOW, rows.PHASE_SHIFT_NOW, rows.OFFSET_NOW)
# In the order of the fields of `Motion`; the work comes last.
SEEN = (
    rows.TIME,
    rows.X,
    rows.Y,
    rows.VX,
    rows.VY,
    rows.HEADING,
    rows.HEADING_RATE,
    rows.PHASE,
    *NOW,
)


class School(school.School[PlanarPlant]):
    """Planar robots in lanes, with the arguments of the base; more threads pay off from about a thousand robots."""

    usual_threads = 1

    def _begin(self, threads: int) -> Sequence[np.ndarray]:
        plant, n = self.plant, self.n
        # One robot is faster in a one-lane kernel, with identical results; not so with a flow,
        # whose formulas use other sines there, so that the results agree only to rounding.
        self._width = 1 if n == 1 and not plant.flow.kinds else WIDTH
        n_blocks = -(-n // self._width)
        self._start = plant.rows(plant.init(Start(), self.command), self.command)
        self._lanes = aligned((n_blocks, self._start.size, self._width), float)
        self._lanes[:] = self._start[:, np.newaxis]
        work = (
            rows.WORK_ELECTRICAL
            if has_power_model(plant.robot, plant.joints)
            else rows.WORK_ABSOLUTE
        )
        self._seen = np.array((*SEEN, work)) - rows.TIME
        kernel: Any = plant.kernels_of(self._width).run
        self._kernel, self._shape = kernel, plant.layout.chain
        return np.array_split(np.arange(n_blocks), min(threads, n_blocks))

    def state(self, which: int) -> PlantState:
        """Return the state of one robot, for `PlanarPlant`."""
        block, lane = divmod(which, self._width)
        values = self._lanes[block, :, lane]
        n_bodies = self.plant.layout.n_bodies
        body = values[rows.HEADER_ROWS : rows.HEADER_ROWS + n_bodies * rows.BODY_ROWS].reshape(
            -1, rows.BODY_ROWS
        )
        return PlantState(
            values=np.concatenate((values[STATE], body[1:, rows.ANGLE], body[1:, rows.RATE]))
        )

    def _place(
        self, which: np.ndarray, center_of_mass: np.ndarray, heading: np.ndarray, current: Currents
    ) -> None:
        block, lane = np.divmod(which, self._width)
        self._lanes[block, :, lane] = self._start
        self._lanes[block, rows.X, lane], self._lanes[block, rows.Y, lane] = center_of_mass.T
        self._lanes[block, rows.HEADING, lane] = heading
        water, own = cast(Water, self.plant.environment), self.plant.flow
        for here, there, one in zip(block, lane, current, strict=True):
            now, S = replace(water, current=one), self._lanes[here, :, there]
            flow = flow_rows(now)
            if (flow.parts, flow.counts) != (own.parts, own.counts):
                raise BadArgument(
                    "current",
                    "must have the same parts as the plant's current; only numbers may differ",
                )
            S[rows.CURRENT_X], S[rows.CURRENT_Y] = now.uniform[:2]
            S[int(S[rows.FLOW]) :][: flow.numbers.size] = flow.numbers

    def _swim(self, told: np.ndarray, duration: float) -> np.ndarray:
        every = np.empty((len(told), self._lanes.shape[0] * self._width))
        every[:, : self.n], every[:, self.n :] = told, self._first[:, np.newaxis]
        self._lanes[:, COMMAND] = every.reshape(len(told), -1, self._width).transpose(1, 0, 2)
        steps = self.plant.steps_in(duration)
        how = (self.plant.is_implicit, steps, duration / steps, steps)
        self._on_threads(lambda blocks: self._run(blocks, how))
        return self._of_each(self._lanes[:, rows.WELL : rows.WELL + 1])[0] > 0.0

    def _run(self, blocks: np.ndarray, how: tuple[bool, int, float, int]) -> None:
        sample = np.empty(
            (2, 1, self._width)
        )  # the kernel's log; unused, because the lanes hold all that is needed
        for block in blocks:
            lanes = self._lanes[block] if self._width > 1 else self._lanes[block, :, 0]
            self._kernel(lanes, *self._shape, *how, sample)

    def _look(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        return self._of_each(self._lanes[:, STATE])[self._seen], ()

    def _of_each(self, part: np.ndarray) -> np.ndarray:
        """Return the rows of all blocks with one row per quantity and one column per robot."""
        return part.transpose(1, 0, 2).reshape(part.shape[1], -1)[:, : self.n]
