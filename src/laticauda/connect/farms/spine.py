"""The spine in a morphology: segments from head to tail, the hinges that bend them, and what hangs on it.

Joints of the spine that are not driven are held at 0, and so are those that end in a link without
mass. What is fixed to a segment belongs to it; legs, wheels and other limbs are left out.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from laticauda.connect.farms.bodies import (
    WEIGHTLESS,
    Body,
    Hinge,
    Morphology,
    Vector,
    is_parallel,
    normalize,
)

UPRIGHT = 0.3
"""Largest share of an axis along the body: beyond, a joint twists it [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spine:
    """Segments and hinges, head first."""

    segments: Sequence[Sequence[Body]]
    """Bodies that move as one."""
    hinges: Sequence[Hinge]
    """Hinge i bends segments i and i + 1."""
    tailward: Sequence[bool]
    """Whether a hinge turns its tail side, as it does in a file whose root is the head."""
    forward: Vector
    """Unit vector from tail to head."""
    up: Vector
    """Unit vector about which yaw joints turn."""
    limbs: Sequence[Body]
    """Bodies that are left out."""
    locked: Sequence[str]
    """Names of joints in the spine that are held at 0."""

    @property
    def left(self) -> Vector:
        """Unit vector to the left."""
        return np.cross(self.up, self.forward)


def find_spine(
    morphology: Morphology,
    driven: Collection[str] | None,
    head: str | None = None,
) -> Spine:
    """Return the spine of a morphology.

    Args:
        morphology: The bodies.
        driven: Names of the joints of the spine; None: all hinges from head to tail.
        head: Name of the head's body; None: the root.

    Raises:
        ValueError: If there is no such spine.
    """
    bodies = morphology.bodies
    first = head or morphology.root.name
    if first not in bodies:
        raise ValueError(
            f"it has no link `{first}` for the head; its links are {', '.join(bodies)}"
        )
    path = _find_path(morphology, first, driven)
    chain = _Chain.along(path, bodies, driven)
    if not chain.hinges:
        raise ValueError(f"no hinge bends it between `{path[0]}` and `{path[-1]}`")
    _add_fixed_bodies(morphology, chain.segments)
    segment_of = _segments_by_body(chain.segments)
    limbs = [body for name, body in bodies.items() if name not in segment_of]
    forward = _find_forward(chain.segments, chain.hinges)
    return Spine(
        segments=chain.segments,
        hinges=chain.hinges,
        tailward=chain.tailward,
        forward=forward,
        up=_find_up(chain.hinges, forward),
        limbs=limbs,
        locked=chain.locked,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Chain:
    """Bodies from head to tail, cut into segments; see `Spine` for what its fields mean."""

    segments: list[list[Body]]
    hinges: list[Hinge]
    tailward: list[bool]
    locked: list[str]

    @classmethod
    def along(
        cls,
        path: Sequence[str],
        bodies: Mapping[str, Body],
        driven: Collection[str] | None,
    ) -> "_Chain":
        """Return the chain of the bodies on a path, head first."""
        head = bodies[path[0]]
        chain = cls(segments=[[head]], hinges=[], tailward=[], locked=[])
        for front, rear in pairwise(path):
            is_tailward = bodies[rear].parent == front
            child = bodies[front]
            if is_tailward:
                child = bodies[rear]
            hinge = child.hinge
            is_driven = hinge is not None and (driven is None or hinge.name in driven)
            if hinge is not None and is_driven and bodies[rear].mass > WEIGHTLESS:
                chain.hinges.append(hinge)
                chain.tailward.append(is_tailward)
                chain.segments.append([bodies[rear]])
                continue
            chain.segments[-1].append(bodies[rear])
            if hinge is not None:
                chain.locked.append(hinge.name)
        return chain


def _find_path(
    morphology: Morphology,
    first: str,
    driven: Collection[str] | None,
) -> list[str]:
    """Return the names of the bodies from the head to the tail.

    The tail lies behind as many driven joints as possible; if it is not known which are driven, behind as
    many as possible that are parallel.
    """
    bodies = morphology.bodies
    neighbors: dict[str, list[str]] = {name: [] for name in bodies}
    for name, body in bodies.items():
        if body.parent is not None:
            neighbors[name].append(body.parent)
            neighbors[body.parent].append(name)
    paths: dict[str, list[str]] = {first: [first]}
    queue = [first]
    for name in queue:  # grows meanwhile
        for neighbor in neighbors[name]:
            if neighbor not in paths:
                paths[neighbor] = [*paths[name], neighbor]
                queue.append(neighbor)
    hinges_to = {name: _hinges_between(path, bodies) for name, path in paths.items()}
    n_bending = {name: _count_bending(hinges, driven) for name, hinges in hinges_to.items()}
    most = max(n_bending.values())
    tails = [name for name in paths if n_bending[name] == most]
    tail = min(tails, key=lambda name: len(paths[name]))
    if driven is not None and most < len(driven):
        raise ValueError(
            f"its joints {', '.join(driven)} do not lie on one path from `{first}`; `head` must be the "
            "link of the head"
        )
    return paths[tail]


def _hinges_between(path: Sequence[str], bodies: Mapping[str, Body]) -> list[Hinge]:
    """Return the hinges between the bodies of a path."""
    on_path = set(path)
    hinges: list[Hinge] = []
    for name in path:
        body = bodies[name]
        if body.hinge is not None and body.parent in on_path:
            hinges.append(body.hinge)
    return hinges


def _count_bending(hinges: Sequence[Hinge], driven: Collection[str] | None) -> int:
    """Return how many hinges are driven; if that is not known, how many at most are parallel."""
    if driven is not None:
        return sum(hinge.name in driven for hinge in hinges)
    if not hinges:
        return 0
    counts: list[int] = []
    for hinge in hinges:
        counts.append(sum(is_parallel(hinge.axis, neighbor.axis) for neighbor in hinges))
    return max(counts)


def _add_fixed_bodies(morphology: Morphology, segments: Sequence[list[Body]]) -> None:
    """Add to every segment what is fixed to it."""
    segment_of = _segments_by_body(segments)
    for name, body in morphology.bodies.items():  # parents come first
        segment = segment_of.get(body.parent or "")
        if segment is None or name in segment_of or body.hinge is not None:
            continue
        segment.append(body)
        segment_of[name] = segment


def _segments_by_body(segments: Sequence[list[Body]]) -> dict[str, list[Body]]:
    """Return the segment of every body of the spine, by the body's name."""
    segment_of: dict[str, list[Body]] = {}
    for segment in segments:
        for body in segment:
            segment_of[body.name] = segment
    return segment_of


def _find_forward(segments: Sequence[Sequence[Body]], hinges: Sequence[Hinge]) -> Vector:
    """Return the direction from tail to head: that of the joints, or of the two masses at one joint."""
    direction = hinges[0].anchor - hinges[-1].anchor
    if len(hinges) == 1:
        direction = _heaviest(segments[0]).center - _heaviest(segments[-1]).center
    if not np.any(direction):
        raise ValueError("its head and its tail are at one place")
    return normalize(direction)


def _heaviest(bodies: Sequence[Body]) -> Body:
    """Return the body of largest mass."""
    return max(bodies, key=lambda body: body.mass)


def _find_up(hinges: Sequence[Hinge], forward: Vector) -> Vector:
    """Return the direction about which yaw joints turn: of all axes, the one most along z, and up."""
    for hinge in hinges:
        if abs(float(hinge.axis @ forward)) > UPRIGHT:
            raise ValueError(
                f"its joint `{hinge.name}` twists the spine; yaw and pitch joints swim"
            )
    axis = max((hinge.axis for hinge in hinges), key=lambda axis: abs(float(axis[2])))
    axis = normalize(axis - float(axis @ forward) * forward)
    if axis[2] < -UPRIGHT:
        return -axis
    return axis
