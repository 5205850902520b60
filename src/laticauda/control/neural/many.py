"""Networks of many robots, stepped side by side by the formulas of one."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, cast

import numpy as np
from jaxtyping import Float

from laticauda.control.neural.network import ROUNDING, Drive, NeuralGait
from laticauda.motion.gaits import Gait
from laticauda.scenarios import (
    REFERENCES,
    STEERED,
    Command,
    Controller,
    Observations,
    VectorController,
    check_decisions,
    is_vectorized,
    kind_of_controller,
    vectorize,
)

OF_EACH = ("gait", "cuts", "seed", "steering")
"""Fields of a network that each network keeps for itself; the formulas do not see them."""
FORMULAS = (
    "advance",
    "begin",
    "drive",
    "first_phases",
    "initial_phases",
    "is_coupled",
    "move",
    "natural_shares",
    "rates",
    "references",
    "watch",
)
"""Methods that a class whose networks are stepped by arrays must not change without saying that it is."""


def vectorize_networks(networks: Sequence[NeuralGait[Any]]) -> VectorController | None:
    """Return one object that steps many networks by arrays; None if they must be called one by one.

    Args:
        networks: The networks, one for each robot, of one class.
    """
    if not is_vectorized(type(networks[0]), *FORMULAS) or not _are_steered_alike(networks):
        return None
    stacked = stack_networks(networks)
    if stacked is None:
        return None
    return VectorNetworks(stacked)


def _are_steered_alike(networks: Sequence[NeuralGait[Any]]) -> bool:
    """Return whether the controllers that steer networks decide together."""
    kinds: set[object] = set()
    for network in networks:
        steering = network.steering
        if steering is None:
            kinds.add(None)
        else:
            kinds.add((kind_of_controller(steering), steering.interval))
    return len(kinds) == 1


def stack_networks(networks: Sequence[NeuralGait[Any]]) -> NeuralGait[Any] | None:
    """Return a network that stands for many; None if they differ in more than numbers.

    Args:
        networks: The networks, of one class.
    """
    stacked = _stack_values(networks, unstacked=OF_EACH)
    if stacked is not None:
        vars(stacked)["members"] = tuple(networks)
    return stacked


def _stack_values(values: Sequence[Any], unstacked: Sequence[str] = ()) -> Any:
    """Return a value whose numbers are columns with one row per value; None if they differ in more than numbers."""
    class_of_values: type[Any] = values[0].__class__
    stacked: Any = object.__new__(class_of_values)
    for field in fields(class_of_values):
        contents = [getattr(value, field.name) for value in values]
        content = contents[0]
        if field.name in unstacked:
            pass
        elif type(content) is float:
            content = np.array(contents)[:, np.newaxis]
        elif is_dataclass(content):
            content = _stack_values(contents)
            if content is None:
                return None
        elif contents.count(content) < len(contents):
            return None
        vars(stacked)[field.name] = content
    return stacked


class VectorNetworks(VectorController):
    """Steps many networks, and steers them by the controllers that each has for it.

    Args:
        network: One network that stands for all.
    """

    def __init__(self, network: NeuralGait[Any]) -> None:
        self._network = network
        self._neurons: Any = None
        self._time = 0.0
        """Time of the last instant [s]."""
        self._drives: Drives | None = None
        self._steering: Any = None
        self._steered_at = -math.inf
        """Time at which they were steered last [s]."""
        first_steering = network.members[0].steering
        if first_steering is not None:
            self._steering = vectorize([_steering_of(member) for member in network.members])
            self._steering_interval = first_steering.interval

    def step(self, observations: Observations) -> dict[str, np.ndarray]:
        """Return the references of all joints of all robots [rad].

        Args:
            observations: Current observations of the robots.
        """
        n_joints = observations.joint_angle.shape[1]
        if self._drives is None:
            self._drives = Drives(self._network.members, n_joints)
        time = float(observations.time.max())
        self._steer(self._drives, observations, time)
        drive = self._drives.drive
        if self._neurons is None:
            self._neurons = self._network.begin(drive)
        elapsed = time - self._time
        if elapsed > 0.0:
            self._neurons = self._network.advance(self._neurons, drive, observations, elapsed)
        self._time = time
        self.signals = cast("Mapping[str, np.ndarray]", self._network.watch(self._neurons))
        return {REFERENCES: self._network.references(self._neurons, drive)}

    def _steer(self, drives: "Drives", observations: Observations, time: float) -> None:
        """Ask the controllers that steer, if it is their turn."""
        if self._steering is None or time < self._steered_at + self._steering_interval - ROUNDING:
            return
        self._steered_at = time
        decisions = self._steering.step(observations)
        if isinstance(decisions, Mapping):
            checked = check_decisions(cast("Mapping[str, Any]", decisions), observations.is_well)
            drives.take_numbers(checked)
        else:
            drives.take_commands(decisions)


def _steering_of(network: NeuralGait[Any]) -> Controller[Any]:
    return cast("Controller[Any]", network.steering)


class Drives:
    """What many networks are asked for from above.

    Args:
        networks: The networks.
        n_joints: Number of joints of each robot.
    """

    def __init__(self, networks: Sequence[NeuralGait[Any]], n_joints: int) -> None:
        self._n_joints = n_joints
        self._gaits: list[Gait | None] = [None] * len(networks)
        self._envelope = np.zeros((len(networks), n_joints))
        self._numbers = {name: np.zeros((len(networks), 1)) for name in STEERED}
        self._shares = np.stack([network.natural_shares(n_joints) for network in networks])
        for i, network in enumerate(networks):
            gait = network.gait
            if network.steering is not None:
                gait = network.steering.gait
            self._take_gait(i, gait)
        self._own_offset = self._numbers["offset"].copy()
        self.drive = self._compute_drive()
        """What is asked of all of them now."""

    def take_numbers(self, numbers: Mapping[str, Float[np.ndarray, " n"]]) -> None:
        """Ask for other numbers of the gaits.

        Args:
            numbers: Numbers by name of `STEERED`.
        """
        for name in STEERED:
            if name in numbers:
                self._numbers[name] = numbers[name][:, np.newaxis]
        if "offset" in numbers:
            self._numbers["offset"] = self._own_offset + self._numbers["offset"]
        self.drive = self._compute_drive()

    def take_commands(self, commands: Sequence[Command | None]) -> None:
        """Ask every network for what a command says.

        Args:
            commands: The command for each; None: as before.
        """
        for i, command in enumerate(commands):
            if command is not None:
                self._take_gait(i, command.gait)
                self._numbers["offset"][i] += command.offset
        self.drive = self._compute_drive()

    def _take_gait(self, i: int, gait: Gait) -> None:
        """Take the numbers of a gait for network `i`."""
        for name, numbers in self._numbers.items():
            numbers[i] = getattr(gait, name)
        if gait is not self._gaits[i]:
            self._envelope[i] = gait.envelope.joints(self._n_joints + 1)
            self._gaits[i] = gait

    def _compute_drive(self) -> Drive:
        """Return what the numbers now ask for."""
        return Drive(
            amplitude=self._numbers["amplitude"] * self._envelope,
            frequency=self._numbers["frequency"] * self._shares,
            phase_shift=self._numbers["phase_shift"],
            offset=self._numbers["offset"].copy(),
        )
