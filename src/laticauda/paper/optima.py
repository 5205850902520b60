"""Gaits that others found optimal in simulation, swum again: speed and power against what they published.

Such rows come in a file of `load_repeats`' columns, of the robot without its fin; P_avg_W is then the net mechanical
power. The conventions of `run_optima` are those that reproduce the optimum gaits of Mamba (docs: What to trust).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument
from laticauda.gaits import Anguilliform, EelLike, Envelope
from laticauda.paper.repeats import Repeat
from laticauda.robot import load_robot, load_water
from laticauda.simulate import swim_many


@dataclass(frozen=True, kw_only=True, eq=False)
class Optima:
    """The optima of one kind of gait: as published, and as they swim here."""

    gait: str
    """What tables call it."""
    published: Float[np.ndarray, "2 n"]
    """Forward velocity (5) [m/s], and mean net power of the joints [W]."""
    simulated: Float[np.ndarray, "2 n"]
    """The same here."""

    @property
    def errors(self) -> Float[np.ndarray, "2 n"]:
        """Of velocity and power [%]."""
        return 100.0 * (self.simulated / self.published - 1.0)


def run_optima(rows: Sequence[Repeat], envelope: Envelope | None = None) -> tuple[Optima, ...]:
    """Swim published optima in one batch: ten links, textbook coefficients, `classic` added mass, pd joints, 30 s.

    Args:
        rows: Gait, velocity and power of every optimum.
        envelope: Of the eel-like ones; None takes `Anguilliform`.

    Returns:
        One entry per kind of gait.

    Raises:
        ValueError: If a row has a fin or no power.
    """
    if any(row.has_fin or row.power is None for row in rows):
        raise BadArgument("rows", "must be without fin and each have a power")
    eel = envelope or Anguilliform()
    gaits = [replace(row.gait, envelope=eel) if isinstance(row.gait.envelope, EelLike) else row.gait for row in rows]
    water = replace(load_water("published-2015"), name="optima", normal_drag=2.0, added_mass_form="classic")
    swum = swim_many(load_robot("mamba", n_links=10), gaits, 30.0, environments=water, joints="pd")
    simulated = np.array([swum.forward_velocity, swum.net_power])
    published = np.array([[row.velocity[0], row.power[0] if row.power else np.nan] for row in rows]).T
    kinds = np.array([gait.words for gait in gaits])
    return tuple(
        Optima(gait=str(kind), published=published[:, kinds == kind], simulated=simulated[:, kinds == kind])
        for kind in dict.fromkeys(kinds)
    )
