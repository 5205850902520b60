"""Samples and estimates as plain numbers and back, bit for bit: what a recording holds of them.

Everything that may be missing is nan; what is of variable length comes last, behind its length.
"""

import math
from collections.abc import Sequence
from dataclasses import fields
from typing import get_args

import numpy as np
from jaxtyping import Float

from laticauda.operate.estimate import Estimate, Status
from laticauda.operate.samples import JointSample, PoseSample, PowerReading, ReferenceSample

Numbers = Float[np.ndarray, " _"]
Recorded = PoseSample | JointSample | ReferenceSample | PowerReading

TOPICS: dict[type[Recorded], str] = {
    PoseSample: "/sample/pose",
    JointSample: "/sample/joints",
    ReferenceSample: "/sample/references",
    PowerReading: "/sample/power",
}
ESTIMATE = "/estimate"
LABELS = {
    "/sample/pose": "time, x, y, z, rotation row by row, residual",
    "/sample/joints": "time, n, n angles, n rates, n torques",
    "/sample/references": "time, frequency, angles",
    "/sample/power": "time, current, average, minimum, maximum, since",
    ESTIMATE: (
        "time, status, age, center of mass, its velocity, heading, heading rate, std of center of mass, "
        "std of heading, current, its std, n joints, n joint angles, n joint rates, n + 1 link angles"
    ),
}
"""What the numbers of a topic are, in their order; each in SI units."""

_STATUS = get_args(Status)
_POWER = tuple(item.name for item in fields(PowerReading))


def packed(sample: Recorded) -> Numbers:
    """A sample as numbers."""
    if isinstance(sample, PoseSample):
        rotation = np.full(9, math.nan) if sample.rotation is None else sample.rotation.ravel()
        return np.concatenate(([sample.time], sample.position, rotation, [sample.residual]))
    if isinstance(sample, JointSample):
        n = sample.angle.size
        missing = np.full(n, math.nan)
        rate = missing if sample.rate is None else sample.rate
        torque = missing if sample.torque is None else sample.torque
        return np.concatenate(([sample.time, n], sample.angle, rate, torque))
    if isinstance(sample, ReferenceSample):
        return np.concatenate(([sample.time, sample.frequency], sample.angle))
    values = [getattr(sample, name) for name in _POWER]
    return np.array([math.nan if value is None else value for value in values])


def unpacked(topic: str, numbers: Sequence[float] | Numbers) -> Recorded:
    """The sample again.

    Args:
        topic: Where it was recorded.
        numbers: As `packed` made them.

    Raises:
        ValueError: If they are too few, or no such sample.
    """
    data = np.asarray(numbers, dtype=np.float64)
    if topic == TOPICS[PoseSample]:
        _expect(topic, data, 14)
        rotation = data[4:13].reshape(3, 3)
        seen = None if np.isnan(rotation).all() else rotation
        return PoseSample(time=data[0], position=data[1:4], rotation=seen, residual=float(data[13]))
    if topic == TOPICS[JointSample]:
        n = int(data[1]) if data.size > 1 else 0
        _expect(topic, data, 2 + 3 * n)
        angle, rate, torque = data[2:].reshape(3, n)
        return JointSample(time=data[0], angle=angle, rate=_given(rate), torque=_given(torque))
    if topic == TOPICS[ReferenceSample]:
        _expect(topic, data[:2], 2)
        return ReferenceSample(time=data[0], frequency=data[1], angle=data[2:])
    _expect(topic, data, len(_POWER))
    values = {name: None if math.isnan(value) else float(value) for name, value in zip(_POWER, data, strict=True)}
    return PowerReading(**values)  # pyright: ignore[reportArgumentType]


def packed_estimate(estimate: Estimate) -> Numbers:
    """An estimate as numbers."""
    current = (math.nan, math.nan) if estimate.current is None else estimate.current
    n = estimate.joint_angle.size
    head = [estimate.time, _STATUS.index(estimate.status), estimate.age, *estimate.center_of_mass]
    head += [*estimate.center_of_mass_velocity, estimate.heading, estimate.heading_rate]
    head += [estimate.center_of_mass_std, estimate.heading_std, *current, estimate.current_std, n]
    return np.concatenate((head, estimate.joint_angle, estimate.joint_rate, estimate.link_angle))


def unpacked_estimate(numbers: Sequence[float] | Numbers) -> Estimate:
    """The estimate again.

    Args:
        numbers: As `packed_estimate` made them.

    Raises:
        ValueError: If they are too few, or no such estimate.
    """
    data = np.asarray(numbers, dtype=np.float64)
    n = int(data[14]) if data.size > 14 else 0
    _expect(ESTIMATE, data, 16 + 3 * n)
    joint = data[15 : 15 + 2 * n].reshape(2, n)
    return Estimate(
        time=float(data[0]),
        status=_STATUS[int(data[1])],
        age=float(data[2]),
        center_of_mass=data[3:5].copy(),
        center_of_mass_velocity=data[5:7].copy(),
        heading=float(data[7]),
        heading_rate=float(data[8]),
        center_of_mass_std=float(data[9]),
        heading_std=float(data[10]),
        current=None if np.isnan(data[11:13]).any() else data[11:13].copy(),
        current_std=float(data[13]),
        joint_angle=joint[0].copy(),
        joint_rate=joint[1].copy(),
        link_angle=data[15 + 2 * n :].copy(),
    )


def _given(values: Numbers) -> Numbers | None:
    """None where nothing was measured."""
    return None if np.isnan(values).all() else values


def _expect(topic: str, data: Numbers, size: int) -> None:
    if data.size != size:
        raise ValueError(f"`{topic}` must hold {size} numbers, got {data.size}.")
