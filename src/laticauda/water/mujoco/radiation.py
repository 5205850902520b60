"""Damping by the waves that a floating body makes, for elements that were fitted to shapes.

The table holds dampings of boxes of uniform density that float half submerged, at the resonance of
each motion, computed with boundary elements (campaigns/radiation.py). A piece counts as the box with
its waterplane and volume, floating alone, upright as in the reference pose.
"""

import functools
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import load_mujoco
from laticauda.water.mujoco.bodies import element_pose
from laticauda.water.mujoco.elements import Element

GRAVITY = 9.81
"""Standard gravity [m/s^2]."""
ROUND_SIDE = math.sqrt(math.pi) / 2.0
"""Side of the square with the area of a circle, over its diameter [-]."""


class _Waterplane(NamedTuple):
    """The waterplane of a piece that floats half submerged, as a rectangle."""

    up: int
    """Number of its axis that is the most upright."""
    long: int
    """Number of its axis along the longer side."""
    short: int
    """Number of its axis along the shorter side."""
    length: float
    """The longer side [m]."""
    width: float
    """The shorter side [m]."""


class _Shares(NamedTuple):
    """Dampings without dimension."""

    heave: float
    """Over rho g^(1/2) V^(5/6) [-]."""
    roll: float
    """About the longer side, over rho g^(1/2) V^(3/2) [-]."""
    pitch: float
    """About the shorter side, likewise [-]."""


def with_radiation(
    model: Any, elements: Iterable[Element], *, density: float = 1000.0
) -> tuple[Element, ...]:
    """Return elements with the damping by the waves that they make at the surface.

    Args:
        model: A `mujoco.MjModel`.
        elements: Elements that were fitted to shapes.
        density: Density rho of the water [kg/m^3].
    """
    mujoco = load_mujoco()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return tuple(
        _add_radiation(element, element_pose(model, data, element).axes, density)
        for element in elements
    )


def _add_radiation(element: Element, axes: np.ndarray, density: float) -> Element:
    if element.volume == 0.0:
        return element
    plane = _waterplane_of(element, axes)
    submerged = 0.5 * element.volume
    draft = submerged / (plane.length * plane.width)
    shares = _interpolate(plane.width / plane.length, draft / plane.width)
    scale = density * math.sqrt(GRAVITY)
    torque = np.zeros(3)
    torque[plane.long] = shares.roll * scale * submerged**1.5
    torque[plane.short] = shares.pitch * scale * submerged**1.5
    return replace(
        element,
        heave_damping=shares.heave * scale * submerged ** (5.0 / 6.0),
        tilt_damping=(torque[0], torque[1], torque[2]),
    )


def _waterplane_of(element: Element, axes: np.ndarray) -> _Waterplane:
    """Return the waterplane of an element whose axes are the columns of a matrix."""
    sides = 2.0 * np.array(element.half_size)
    up = int(np.argmax(np.abs(axes[2])))
    is_round = element.shape == "ellipsoid" or (element.shape == "cylinder" and up == 0)
    if is_round:
        sides = ROUND_SIDE * sides
    level_axes = [axis for axis in range(3) if axis != up]
    long = max(level_axes, key=lambda axis: sides[axis])
    short = sum(level_axes) - long
    return _Waterplane(
        up=up, long=long, short=short, length=float(sides[long]), width=float(sides[short])
    )


class _Table(NamedTuple):
    """Shares of boxes on a grid of proportions."""

    widths: np.ndarray
    """Width over length, (M,) [-]."""
    drafts: np.ndarray
    """Draft over width, (N,) [-]."""
    shares: np.ndarray
    """(M, N, 3) [-]."""


@functools.cache
def _table() -> _Table:
    file = Path(__file__).with_name("radiation_box.csv")
    table = np.loadtxt(file, delimiter=",", skiprows=1, encoding="utf-8")
    widths = np.unique(table[:, 0])
    drafts = np.unique(table[:, 1])
    shares = table[:, 2:].reshape(len(widths), len(drafts), 3)
    return _Table(widths=widths, drafts=drafts, shares=shares)


def _interpolate(width: float, draft: float) -> _Shares:
    """Interpolate linearly in both proportions; beyond the table, as at its edge."""
    table = _table()
    values: list[float] = []
    n_widths, _, n_motions = table.shares.shape
    for motion in range(n_motions):
        at_draft = [
            float(np.interp(draft, table.drafts, table.shares[index, :, motion]))
            for index in range(n_widths)
        ]
        values.append(float(np.interp(width, table.widths, at_draft)))
    return _Shares(*values)
