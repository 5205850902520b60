"""Faults that no device reports: of the robot, of the water, and of what the cameras take for the robot."""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from laticauda.models.dynamics import Plant
from laticauda.robot import Water, turn
from laticauda.tank.lab.faults import Fault, Faults
from laticauda.tank.lab.instruments import Cameras
from laticauda.tank.lab.virtual_robot import VirtualRobot
from laticauda.tank.protocol import BodyPose, MocapFrame
from laticauda.values import BadArgument

OF_PLANT = ("weak_servo", "lost_fin", "moving_water")
SLIP_TIME = 0.3  # time in which a horn slips under load [s]


def check(fault: Fault, plant: Plant[Any]) -> None:
    """Reject a fault that cannot happen to this robot in this environment.

    Args:
        fault: Fault that is to happen.
        plant: The robot in its water.

    Raises:
        ValueError: If it cannot happen.
    """
    fin = plant.robot.caudal_fin
    if fault.kind == "lost_fin" and fin is not None and (plant.robot.fin_joints or fin.n_hinges):
        raise BadArgument(
            "kind",
            "must not be `lost_fin`: only a fin without hinges or joints of its own can come off",
        )
    water = plant.environment
    if fault.kind == "moving_water" and (not isinstance(water, Water) or water.flow is not None):
        raise BadArgument(
            "kind", "must not be `moving_water` on land, or in water with a flow law of its own"
        )


def plant_with_faults(body: VirtualRobot, built: Plant[Any], faults: Faults) -> Plant[Any]:
    """Return a plant with the present faults; its state stays the same, and what is lost was at rest.

    Args:
        body: Robot whose modules the plant's joints are.
        built: Plant without faults.
        faults: Faults that are present.
    """
    robot, water = built.robot, built.environment
    joints = list(robot.joints)
    for k, i in enumerate(body.driven[: robot.n_joints].tolist()):
        weak = faults.on("weak_servo", i + 1)
        if weak is not None:
            drive = replace(
                joints[k].actuator, stall_torque=weak.share * joints[k].actuator.stall_torque
            )
            joints[k] = replace(joints[k], actuator=drive)
    moving = faults.on("moving_water")
    if moving is not None and isinstance(water, Water):
        x, y, z = water.uniform
        more = moving.speed * math.cos(moving.towards), moving.speed * math.sin(moving.towards)
        water = replace(water, current=(x + more[0], y + more[1], z))
    fin = None if faults.on("lost_fin") else robot.caudal_fin
    return replace(
        built, robot=replace(robot, joints=tuple(joints), caudal_fin=fin), environment=water
    )


class CameraErrors:
    """What cameras report instead of what they see.

    Args:
        cameras: Cameras whose noise another body also has.
        random: Source of that noise.
    """

    def __init__(self, cameras: Cameras, random: np.random.Generator) -> None:
        self._noise, self._random = cameras.settings.position_noise, random
        self._seen: BodyPose | None = None

    def instead(self, frame: MocapFrame, faults: Faults, time: float) -> MocapFrame:
        """Return the frame that is reported.

        Args:
            frame: Frame that is seen.
            faults: Faults that are present.
            time: Time on the lab's clock [s].
        """
        (body,) = frame.bodies
        drift, slip = faults.on("clock_drift"), faults.on("marker_slip")
        if drift is not None:
            frame = replace(frame, timestamp=frame.timestamp + drift.share * (time - drift.time))
        if body is not None and slip is not None:
            body = replace(body, rotation=body.rotation @ turn("yaw", slip.angle))
        if faults.on("wrong_body") is None:
            self._seen = None
        elif body is not None:  # the other body lies where the robot's was
            self._seen = self._seen or body
            noise = self._noise * self._random.standard_normal(3)
            body = replace(body, position=self._seen.position + noise, rotation=self._seen.rotation)
        return replace(frame, bodies=(body,))
