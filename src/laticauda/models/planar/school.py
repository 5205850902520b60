"""A school of planar robots: lanes as in `laticauda.models.planar.batch`, but kept in place between intervals."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np

from laticauda.models.dynamics import school
from laticauda.models.dynamics.samples import PlantState
from laticauda.models.dynamics.school import Currents
from laticauda.models.planar import rows
from laticauda.models.planar.batch import COMMAND, WIDTH, aligned
from laticauda.models.planar.layout import flow_rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.planar.sample_format import column_of
from laticauda.robot import Water, has_power_model
from laticauda.scenarios import Observation, Start
from laticauda.values import BadArgument

STATE = slice(rows.TIME, rows.TIME + rows.LOG_STATE)
"""Rows of the state in the header."""
OBSERVED_ROWS = (
    rows.TIME,
    rows.X,
    rows.Y,
    rows.VX,
    rows.VY,
    rows.HEADING,
    rows.HEADING_RATE,
    rows.PHASE,
    rows.AMPLITUDE_NOW,
    rows.FREQUENCY_NOW,
    rows.PHASE_SHIFT_NOW,
    rows.OFFSET_NOW,
)
"""Rows in the order of the fields of `Motion`; the work comes last."""


class School(school.School[PlanarPlant]):
    """Planar robots in lanes, with the arguments of the base; more threads pay off from about a thousand robots."""

    usual_threads = 1

    def _allocate(self, n_threads: int) -> Sequence[np.ndarray]:
        plant = self.plant
        n = self.n
        # One robot is faster in a one-lane kernel, with identical results; not so with a flow,
        # whose formulas use other sines there, so that the results agree only to rounding.
        self._width = 1 if n == 1 and not plant.flow.kinds else WIDTH
        n_blocks = -(-n // self._width)
        self._start = plant.rows(plant.init(Start(), self.command), self.command)
        self._lanes = aligned((n_blocks, self._start.size, self._width), float)
        self._lanes[:] = self._start[:, np.newaxis]
        work = rows.WORK_ABSOLUTE
        if has_power_model(plant.robot, plant.joints):
            work = rows.WORK_ELECTRICAL
        self._observed = [column_of(row) for row in (*OBSERVED_ROWS, work)]
        self._kernel: Any = plant.kernels_of(self._width).run
        self._shape = plant.layout.chain
        return np.array_split(np.arange(n_blocks), min(n_threads, n_blocks))

    def state(self, index: int) -> PlantState:
        """Return the state of one robot, for `PlanarPlant`."""
        block, lane = divmod(index, self._width)
        return PlantState(values=self._lanes[block, self.plant.layout.state_rows, lane])

    def _restart(
        self,
        indices: np.ndarray,
        center_of_mass: np.ndarray,
        heading: np.ndarray,
        currents: Currents,
    ) -> None:
        blocks, lanes = np.divmod(indices, self._width)
        x, y = center_of_mass.T
        self._lanes[blocks, :, lanes] = self._start
        self._lanes[blocks, rows.X, lanes] = x
        self._lanes[blocks, rows.Y, lanes] = y
        self._lanes[blocks, rows.HEADING, lanes] = heading
        for block, lane, robot_current in zip(blocks, lanes, currents, strict=True):
            water = replace(cast(Water, self.plant.environment), current=robot_current)
            self._write_current(self._lanes[block, :, lane], water)

    def _write_current(self, S: np.ndarray, water: Water) -> None:
        """Write the motion of the water into the rows of one robot."""
        flow = flow_rows(water)
        plant_flow = self.plant.flow
        if flow.parts != plant_flow.parts or flow.counts != plant_flow.counts:
            raise BadArgument(
                "current",
                "must have the same parts as the plant's current; only numbers may differ",
            )
        S[rows.CURRENT_X], S[rows.CURRENT_Y] = water.uniform[:2]
        first = int(S[rows.FLOW])
        S[first:][: flow.numbers.size] = flow.numbers

    def _swim(self, gaits: np.ndarray, duration: float) -> np.ndarray:
        n_lanes = self._lanes.shape[0] * self._width
        commands_of_lanes = np.empty((len(gaits), n_lanes))
        commands_of_lanes[:, : self.n] = gaits
        commands_of_lanes[:, self.n :] = self._first[:, np.newaxis]  # of lanes without a robot
        in_blocks = commands_of_lanes.reshape(len(gaits), -1, self._width)
        self._lanes[:, COMMAND] = in_blocks.transpose(1, 0, 2)
        n_steps = self.plant.steps_in(duration)
        dt = duration / n_steps
        self._apply_to_shares(lambda blocks: self._run(blocks, n_steps, dt))
        well = self._of_each(self._lanes[:, rows.WELL : rows.WELL + 1])[0]
        return well > 0.0

    def _run(self, blocks: np.ndarray, n_steps: int, dt: float) -> None:
        # The kernel's log is not used: the lanes hold all that is needed.
        log = np.empty((2, 1, self._width))
        for block in blocks:
            lanes = self._lanes[block] if self._width > 1 else self._lanes[block, :, 0]
            self._kernel(lanes, *self._shape, self.plant.is_implicit, n_steps, dt, n_steps, log)

    def _read_motion(self) -> tuple[np.ndarray, tuple[Observation, ...]]:
        return self._of_each(self._lanes[:, STATE])[self._observed], ()

    def _of_each(self, part: np.ndarray) -> np.ndarray:
        """Return the rows of all blocks with one row per quantity and one column per robot."""
        return part.transpose(1, 0, 2).reshape(part.shape[1], -1)[:, : self.n]
