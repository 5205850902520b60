"""The virtual tank with a robot, cameras or water that go wrong without a word of any device: for `accepted.py`.

These belong among the faults of `laticauda lab`; until there is room for them they stand here.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from laticauda.kinematics import turn
from laticauda.lab import LabSettings, Tank, VirtualRobot

SLIP_TIME = 0.3  # in which a horn slips on its shaft, under load; the motor's own sensor shows nothing of it [s]


@dataclass(frozen=True)
class Quiet:
    """One of them, from a moment on."""

    kind: str
    """weak_servo, slipped_zero, lost_fin, wrong_body, clock_drift, marker_slip or moving_water."""
    time: float
    """By the tank's clock [s]."""
    node: int = 4
    """The module, where it is one's."""
    size: float = 0.0
    """Share of the torque that is left, angle [rad], share by which the clock runs fast, or speed [m/s]."""
    towards: float = 0.0
    """Where the water moves to [rad]."""


class FaultyTank(Tank):
    """The tank; what its `quiet` says happens."""

    def __init__(self, body: VirtualRobot, settings: LabSettings) -> None:
        self.quiet: Quiet | None = None
        self._built, self._seen, self._slipped, self._is_altered = body.plant, None, 0.0, False
        super().__init__(body, settings)

    def _tick(self) -> None:
        fault = self.quiet
        if fault is None or self.time < fault.time:
            return super()._tick()
        if fault.kind == "slipped_zero":
            slipped = self._slipped + (fault.size - self._slipped) * (1.0 - math.exp(-self.settings.step / SLIP_TIME))
            self.electronics.zero_error[fault.node - 1] -= slipped - self._slipped
            self._slipped = slipped
        if not self._is_altered:
            self._is_altered = True
            self.body.plant = self._altered(fault)
        before = len(self._captured)
        super()._tick()
        self._captured[before:] = [self._mistaken(fault, frame) for frame in self._captured[before:]]
        return None

    def _altered(self, fault: Quiet):
        """Another robot in other water, with the same state; the small mass of a fin that is lost is at rest."""
        robot, water = self._built.robot, self._built.environment
        if fault.kind == "weak_servo":
            joints = list(robot.joints)
            weak = joints[fault.node - 1].actuator
            weak = replace(weak, stall_torque=fault.size * weak.stall_torque)
            joints[fault.node - 1] = replace(joints[fault.node - 1], actuator=weak)
            robot = replace(robot, joints=tuple(joints))
        elif fault.kind == "lost_fin":
            robot = replace(robot, caudal_fin=None)
        elif fault.kind == "moving_water":
            moved = fault.size * np.array([math.cos(fault.towards), math.sin(fault.towards)])
            water = replace(water, current=tuple((np.array(water.current[:2]) + moved).tolist()))
        return replace(self._built, robot=robot, environment=water)

    def _mistaken(self, fault: Quiet, frame):
        """What the cameras say instead."""
        (body,) = frame.bodies
        if fault.kind == "clock_drift":
            frame = replace(frame, timestamp=frame.timestamp + fault.size * (self.time - fault.time))
        if body is not None and fault.kind == "marker_slip":
            body = replace(body, rotation=body.rotation @ turn("yaw", fault.size))
        if body is not None and fault.kind == "wrong_body":  # it lies where the robot's was; the noise is this one's
            self._seen = self._seen or body
            noise = self.cameras.settings.position_noise * self._wire.standard_normal(3)
            body = replace(body, position=self._seen.position + noise, rotation=self._seen.rotation)
        return replace(frame, bodies=(body,))
