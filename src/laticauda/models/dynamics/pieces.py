"""Marches of robots whose effectors take time: in pieces, in which each does what it does on average."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from laticauda.models.dynamics.effector_dynamics import EffectorDynamics
from laticauda.models.dynamics.sampled_loads import join_loads
from laticauda.models.dynamics.samples import Advance, Grid, PlantState, Stretch, join_samples
from laticauda.scenarios import Command

if TYPE_CHECKING:
    from laticauda.models.dynamics.plant import Plant


class _Piece(NamedTuple):
    """A piece of a march."""

    grid: Grid
    """Its steps."""
    n_finished: int
    """Number of intervals between samples that are over at its end."""


def advance_in_pieces(
    plant: "Plant[Any]", state: PlantState, command: Command, grid: Grid, *, link_forces: bool
) -> Advance:
    """Advance a plant whose effectors have a memory; see `Plant.advance`.

    Args:
        plant: The plant.
        state: Its state.
        command: Command, held throughout.
        grid: The steps.
        link_forces: Whether to keep the loads.
    """
    dynamics = plant.effector_dynamics
    targets = dynamics.targets_of(command)
    values = targets if state.effectors is None else np.array(state.effectors)
    now = state
    stretches: list[Stretch] = []
    n_left = grid.n_intervals
    while n_left > 0:
        is_settled = dynamics.are_settled(values, targets)
        for piece in _next_pieces(grid, dynamics, n_left, is_settled=is_settled):
            duration = piece.grid.n_intervals * piece.grid.n_steps * grid.dt
            mean, end = dynamics.move(values, targets, duration)
            advance = plant.advance_on_grid(
                now, dynamics.in_effect(command, mean), piece.grid, link_forces=link_forces
            )
            stretch = _with_effectors(advance.stretch, command, values, end)
            if not stretches:
                stretches.append(stretch.at(slice(None, 1)))
            if piece.n_finished > 0:
                stretches.append(stretch)
            if advance.failure is not None:
                return Advance(state, _join(stretches), advance.failure)
            now = advance.state
            values = end
            n_left -= piece.n_finished
    end_state = PlantState(values=now.values, effectors=tuple(values.tolist()))
    return Advance(end_state, _join(stretches), None)


def _next_pieces(
    grid: Grid, dynamics: EffectorDynamics, n_left: int, *, is_settled: bool
) -> list[_Piece]:
    """Return the pieces of the next interval between samples, or all that is left in one if no effector moves."""
    if is_settled:
        return [_Piece(Grid(n_left, grid.n_steps, grid.dt), n_finished=n_left)]
    most_steps = max(1, int(min(dynamics.longest_piece / grid.dt, grid.n_steps)))
    pieces: list[_Piece] = []
    n_steps_left = grid.n_steps
    while n_steps_left > most_steps:
        pieces.append(_Piece(Grid(1, most_steps, grid.dt), n_finished=0))
        n_steps_left -= most_steps
    pieces.append(_Piece(Grid(1, n_steps_left, grid.dt), n_finished=1))
    return pieces


def _with_effectors(
    stretch: Stretch, command: Command, begin: np.ndarray, end: np.ndarray
) -> Stretch:
    """Return a stretch under its whole command, with what the effectors did at its samples."""
    effectors = np.repeat(end[np.newaxis], len(stretch.samples), axis=0)
    effectors[0] = begin
    return stretch._replace(command=command, effectors=effectors)


def _join(stretches: list[Stretch]) -> Stretch:
    """Return consecutive stretches as one."""
    parts = [stretches[0].effectors]
    parts += [stretch.effectors for stretch in stretches[1:]]
    effectors = [part[min(number, 1) :] for number, part in enumerate(parts) if part is not None]
    return Stretch(
        samples=join_samples(stretches),
        command=stretches[0].command,
        loads=join_loads(stretch.loads for stretch in stretches),
        effectors=np.concatenate(effectors),
    )
