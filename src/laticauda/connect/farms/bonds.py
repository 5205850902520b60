"""Couplings of a network between neighboring joints, as strength and lag of a chain.

The oscillators of one side pull each other: with a weight w, an amplitude A of the one that pulls, and a
phase bias by which it leads. Four such couplings, two sides in two directions, make a bond of full strength.
"""

import cmath
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from laticauda.connect.farms.network_file import Coupling, NetworkFile, OscillatorPair
from laticauda.connect.farms.remarks import ALIKE, Remarks
from laticauda.values import wrap_to_pi

COUPLINGS_OF_A_BOND = 4
"""Couplings of a bond of full strength: two sides in two directions."""
ANGLES_ALIKE = math.radians(1.0)
"""Difference up to which angles are one [rad]."""


class Bond(NamedTuple):
    """Coupling of a joint to the next one toward the head."""

    strength: float
    """A w, mean of both sides and directions [1/s]."""
    lag: float
    """Lead of the joint nearer to the head [rad]."""


def find_bonds(
    file: NetworkFile,
    pairs: Sequence[OscillatorPair],
    remarks: Remarks,
) -> list[Bond]:
    """Return the bond of every joint but the last to the next one toward the head.

    Args:
        file: The network.
        pairs: Oscillators of the joints, tail first.
        remarks: Remarks, to which are added couplings that are no bond.
    """
    bonds = [
        _find_bond(
            file=file,
            rear=rear,
            front=front,
            remarks=remarks,
        )
        for rear, front in pairwise(pairs)
    ]
    _list_other_couplings(file, pairs, remarks)
    return bonds


def _find_bond(
    file: NetworkFile,
    rear: OscillatorPair,
    front: OscillatorPair,
    remarks: Remarks,
) -> Bond:
    """Return the bond of two neighboring joints."""
    strength = 0.0
    lead = 0j
    for coupling in file.couplings:
        sign = _direction(coupling, rear, front)
        if sign == 0:
            continue
        pull = coupling.weight * file.oscillator(coupling.pulling).amplitude
        strength += pull
        lead += cmath.rect(pull, sign * coupling.bias)
    if strength <= 0.0:
        return Bond(strength=0.0, lag=0.0)
    if abs(lead) < (1.0 - ALIKE) * strength:
        joints = f"`{front.left}` and `{rear.left}`"
        remarks.append(f"phase biases between {joints} that disagree: their mean is taken")
    return Bond(strength=strength / COUPLINGS_OF_A_BOND, lag=cmath.phase(lead))


def _direction(
    coupling: Coupling,
    rear: OscillatorPair,
    front: OscillatorPair,
) -> int:
    """Return 1 if the front joint pulls the rear one on the same side, -1 for the reverse, 0 if neither."""
    ends = (coupling.pulled, coupling.pulling)
    if ends in ((rear.left, front.left), (rear.right, front.right)):
        return 1
    if ends in ((front.left, rear.left), (front.right, rear.right)):
        return -1
    return 0


def mean_lag(bonds: Sequence[Bond], remarks: Remarks) -> float:
    """Return the lead of a joint over the next one toward the tail, of the whole body [rad].

    Args:
        bonds: Bonds that are not cut.
        remarks: Remarks, to which is added if lags differ.
    """
    if not bonds:
        return 0.0
    mean = cmath.phase(sum(cmath.rect(1.0, bond.lag) for bond in bonds))
    if any(_distance(bond.lag, mean) > ANGLES_ALIKE for bond in bonds):
        remarks.append("phase biases that differ along the body: their mean is taken")
    return mean


def _list_other_couplings(
    file: NetworkFile,
    pairs: Sequence[OscillatorPair],
    remarks: Remarks,
) -> None:
    """Add couplings that are no part of a bond."""
    places: dict[str, int] = {}
    left_names: set[str] = set()
    for place, pair in enumerate(pairs):
        places[pair.left] = place
        places[pair.right] = place
        left_names.add(pair.left)
    n_long = 0
    n_in_phase = 0
    for coupling in file.couplings:
        pulled = places.get(coupling.pulled)
        pulling = places.get(coupling.pulling)
        if pulled is None or pulling is None or coupling.weight == 0.0:
            continue
        is_across = (coupling.pulled in left_names) != (coupling.pulling in left_names)
        if pulled == pulling:
            n_in_phase += _distance(coupling.bias, math.pi) > ANGLES_ALIKE
        elif abs(pulled - pulling) > 1 or is_across:
            n_long += 1
    remarks.add_count(n_long, "couplings beyond the next joint of the same side")
    remarks.add_count(
        n_in_phase, "couplings of left and right that are not in antiphase: taken as such"
    )


def _distance(first: float, second: float) -> float:
    """Return how far two angles are apart, from 0 to pi [rad]."""
    return abs(wrap_to_pi(first - second))
