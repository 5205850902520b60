"""The network of a FARMS animat as `PhaseOscillators`: two oscillators at every joint become one.

    theta_i' = omega_i + sum_j A_j w_ij sin(theta_j - theta_i - phi_ij),    A_i' = a_i (R_i - A_i)
    q = g (x_right - x_left) / 2,    x = A (1 + cos(theta))

With both sides in antiphase, q swings with the mean of both amplitudes about half their difference, and
a chain of pairs is a chain of single oscillators with the coupling A w.

Joints are tail first here, head first in the files; a wave that runs from head to tail has a positive
phase shift. Of a file whose root is the head, q turns the tail side of a joint about its axis; our angle
turns the head side to the left, and is -q if the axis points up.

References:
    farms_amphibious, github.com/farmsim: control/ode.pyx, control/position_muscle_cy.pyx.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from laticauda.connect.farms.bonds import ANGLES_ALIKE, find_bonds, mean_lag
from laticauda.connect.farms.entries import Entry
from laticauda.connect.farms.network_file import (
    Drives,
    NetworkFile,
    OscillatorPair,
    drives_of_joint,
    read_network,
    value_at_drive,
)
from laticauda.connect.farms.remarks import ALIKE, Remarks
from laticauda.control import Feedback, PhaseOscillators
from laticauda.motion import gaits

SAME_RATE = 4.0
"""Rate a of `PhaseOscillators` that settles after the same mean time as FARMS's a = 1: 4 / a = 1 / a_FARMS [-]."""
STRETCH = "STRETCH2FREQTEGOTAE"
"""Feedback of a joint's angle times the sine of the phase."""


@dataclass(frozen=True, kw_only=True)
class MovedJoint:
    """Joint of the spine with its oscillators."""

    name: str
    sense: float
    """1 if a positive angle of FARMS is a positive one of ours, else -1 [-]."""
    pair: OscillatorPair
    motor: Entry
    """Its entry among the motors; an empty one if there is none."""


def build_network(
    entry: Entry,
    joints: Sequence[MovedJoint],
    drives: Drives | None,
    remarks: Remarks,
) -> PhaseOscillators:
    """Return the network of the joints of the spine.

    Args:
        entry: Table `control.network` of the animat.
        joints: Joints of the spine, tail first.
        drives: Drives in place of those of the file; None: those.
        remarks: Remarks, to which is added what is not taken as it is.

    Raises:
        RobotFileError: If a number is missing.
    """
    pairs = [joint.pair for joint in joints]
    file = read_network(entry, pairs, drives)
    oscillators = [file.oscillator(pair.left) for pair in pairs]
    oscillators += [file.oscillator(pair.right) for pair in pairs]
    frequencies = [oscillator.frequency for oscillator in oscillators]
    rates = [oscillator.rate for oscillator in oscillators]
    bonds = find_bonds(file, pairs, remarks)
    whole_bonds = [bond for bond in bonds if bond.strength > 0.0]
    coupling = 0.0
    if whole_bonds:
        strengths = [bond.strength for bond in whole_bonds]
        coupling = remarks.add_mean("coupling", strengths, "1/s")
    amplitudes = np.array([_amplitude(file, joint) for joint in joints])
    sense = _sense_of_largest(amplitudes)
    gait = _build_gait(
        sense * amplitudes,
        offsets=[_offset(file, joint, drives) for joint in joints],
        frequency=remarks.add_mean("frequency", frequencies, "rad/s"),
        lag=mean_lag(whole_bonds, remarks),
        remarks=remarks,
    )
    _list_what_is_left(file, pairs, remarks)
    return PhaseOscillators(
        gait=gait,
        coupling=coupling,
        amplitude_rate=SAME_RATE * remarks.add_mean("rate", rates, "1/s"),
        feedback=_read_feedback(entry, joints, sense, remarks),
        cuts=tuple(joint for joint, bond in enumerate(bonds) if bond.strength == 0.0),
    )


def _build_gait(
    amplitudes: np.ndarray,
    *,
    offsets: Sequence[float],
    frequency: float,
    lag: float,
    remarks: Remarks,
) -> gaits.Gait:
    """Return the gait to which the network tends."""
    largest = float(amplitudes.max())
    if frequency == 0.0 or largest == 0.0:
        remarks.append("oscillators that stand still at this drive")
    envelope: gaits.Envelope = gaits.LateralUndulation()
    if largest > 0.0 and amplitudes.min() < (1.0 - ALIKE) * largest:
        shares: list[float] = (amplitudes / largest).tolist()
        envelope = gaits.Custom(values=tuple(shares))
    if max(offsets) - min(offsets) > ANGLES_ALIKE:
        remarks.append("offsets that differ from joint to joint: their mean is taken")
    return gaits.Gait(
        amplitude=largest,
        frequency=frequency,
        phase_shift=lag,
        offset=float(np.mean(offsets)),
        envelope=envelope,
    )


def _amplitude(file: NetworkFile, joint: MovedJoint) -> float:
    """Return the amplitude of a joint; negative if it turns against ours [rad]."""
    left = file.oscillator(joint.pair.left)
    right = file.oscillator(joint.pair.right)
    gain = joint.motor.inner("transform").number("gain", 1.0)
    return joint.sense * gain * 0.5 * (left.amplitude + right.amplitude)


def _sense_of_largest(amplitudes: np.ndarray) -> float:
    """Return -1 if the largest amplitude is negative, else 1: which way all begin makes no difference."""
    if -amplitudes.min() > amplitudes.max():
        return -1.0
    return 1.0


# ---- offsets -------------------------------------------------------------------------------------


def _offset(
    file: NetworkFile,
    joint: MovedJoint,
    drives: Drives | None,
) -> float:
    """Return the bend of a joint about which it swings [rad]."""
    left = file.oscillator(joint.pair.left)
    right = file.oscillator(joint.pair.right)
    transform = joint.motor.inner("transform")
    by_sides = 0.5 * (right.amplitude - left.amplitude)
    by_drives = _offset_by_drives(file.entry, joint, drives)
    gain = transform.number("gain", 1.0)
    angle = gain * (by_sides + by_drives)
    return joint.sense * (angle + transform.number("bias", 0.0))


def _offset_by_drives(
    entry: Entry,
    joint: MovedJoint,
    drives: Drives | None,
) -> float:
    """Return the offset that the two drives of a joint ask for [rad]."""
    offsets = joint.motor.inner("offsets")
    gain = offsets.number("gain", 0.0)
    bias = offsets.number("bias", 0.0)
    if drives is None:
        drives = drives_of_joint(entry, joint.name)
    if drives is None or (gain == 0.0 and bias == 0.0):
        return 0.0
    low = offsets.number("low", 0.0)
    high = offsets.number("high", 0.0)
    if low <= drives.middle <= high:
        return gain * (drives.right - drives.left) + bias
    return value_at_drive(offsets, "", drives.middle)


# ---- feedback ------------------------------------------------------------------------------------


def _read_feedback(
    entry: Entry,
    joints: Sequence[MovedJoint],
    sense: float,
    remarks: Remarks,
) -> Feedback:
    """Return the stretch that oscillators feel of their own joint, if all feel it alike."""
    gains: list[float] = []
    n_refused = 0
    for table in entry.items("joint2osc"):
        gain = _gain_of_stretch(table, joints, sense)
        if gain is None:
            n_refused += 1
        else:
            gains.append(gain)
    is_felt_by_all = len(gains) == 2 * len(joints)
    if is_felt_by_all and np.ptp(gains) <= ALIKE * abs(gains[0]):
        remarks.add_count(n_refused, "further couplings `joint2osc`: stretch felt in other ways")
        return Feedback(stretch=float(np.mean(gains)))
    n_refused += len(gains)
    remarks.add_count(n_refused, "couplings `joint2osc`: stretch felt in other ways")
    return Feedback()


def _gain_of_stretch(
    table: Entry,
    joints: Sequence[MovedJoint],
    sense: float,
) -> float | None:
    """Return how strongly an oscillator feels the angle of its own joint [1/(rad s)]; None for other feedback."""
    oscillator = table.text("in")
    joint_name = table.text("out")
    weight = table.number("weight")
    if table.text("type") != STRETCH:
        return None
    for joint in joints:
        if joint.name != joint_name:
            continue
        gain = joint.sense * sense * weight
        if oscillator == joint.pair.left:
            return gain
        if oscillator == joint.pair.right:
            return -gain
    return None


# ---- what is left --------------------------------------------------------------------------------


def _list_what_is_left(
    file: NetworkFile,
    pairs: Sequence[OscillatorPair],
    remarks: Remarks,
) -> None:
    """Add what the network has and `PhaseOscillators` have not."""
    entry = file.entry
    n_limbs = len(file.oscillators) - 2 * len(pairs)
    remarks.add_count(n_limbs, "oscillators that move no joint of the spine")
    remarks.add_count(entry.count("contact2osc"), "couplings `contact2osc`: contacts felt")
    remarks.add_count(entry.count("xfrc2osc"), "couplings `xfrc2osc`: forces felt")
    if any(table.has("initial_phase") for table in entry.items("oscillators")):
        remarks.append("initial phases and amplitudes of the oscillators")
    for key in ("modular_amplitude", "attractor_amplitude"):
        if any(table.number(key, 0.0) for table in entry.items("oscillators")):
            remarks.append(f"`{key}` of the oscillators")
    if entry.text("drive_loader", "") or entry.text("drive_config", ""):
        remarks.append("drives that change with time: their first values are taken")
