"""What the node tells of a step, as messages of ROS 2.

Axes are those of REP 103, which are laticauda's: x forward, y left, z up.
"""

import math
from typing import Any

import numpy as np

from laticauda.connect.vehicle import VehicleStep
from laticauda.connect.vehicle_motion import FELT_AT_REST, VehicleMotion
from laticauda.robot import Robot
from laticauda.values import to_quaternion
from laticauda_ros2 import messages

WORLD = "odom"
"""Frame that does not move."""
BODY = "base_link"
"""Frame of the robot as a whole."""
ROOT = "module_0"
"""Frame of the tail module, the root of the robot's URDF."""
SURFACE_PRESSURE = 101_325.0
"""Pressure at the surface [Pa]."""
ULTRASOUND = 0
"""`Range.ULTRASOUND`."""
LARGEST_RANGE = 100.0
"""Largest distance that a rangefinder tells; beyond it, infinity [m]."""
UNKNOWN = [0.0] * 36
"""Covariance that nobody states."""
UNKNOWN_3 = [0.0] * 9


def _vector(values: np.ndarray) -> Any:
    x, y, z = values.tolist()
    return messages.Vector3(x=x, y=y, z=z)


def _quaternion(rotation: np.ndarray) -> Any:
    w, x, y, z = to_quaternion(rotation)
    return messages.Quaternion(x=float(x), y=float(y), z=float(z), w=float(w))


def odometry(step: VehicleStep) -> Any:
    """`Odometry`: the pose in the world, and the velocities in the axes of the body.

    Args:
        step: The step.
    """
    motion = step.motion
    x, y, z = motion.position.tolist()
    pose = messages.Pose(
        position=messages.Point(x=x, y=y, z=z), orientation=_quaternion(motion.rotation)
    )
    twist = messages.Twist(
        linear=_vector(motion.rotation.T @ motion.velocity),
        angular=_vector(step.inertial.angular_velocity),
    )
    return messages.Odometry(
        header=messages.stamped(motion.time, WORLD),
        child_frame_id=BODY,
        pose=messages.PoseWithCovariance(pose=pose, covariance=UNKNOWN),
        twist=messages.TwistWithCovariance(twist=twist, covariance=UNKNOWN),
    )


def transforms(motion: VehicleMotion) -> Any:
    """`TFMessage`: from the world to the body, and to the root of the robot's URDF.

    Args:
        motion: The motion.
    """
    poses = {
        BODY: (motion.position, motion.rotation),
        ROOT: (motion.tail_end, motion.tail_rotation),
    }
    stamped = [
        messages.TransformStamped(
            header=messages.stamped(motion.time, WORLD),
            child_frame_id=frame,
            transform=messages.Transform(
                translation=_vector(position), rotation=_quaternion(rotation)
            ),
        )
        for frame, (position, rotation) in poses.items()
    ]
    return messages.TFMessage(transforms=stamped)


def imu(step: VehicleStep) -> Any:
    """`Imu`, in the body's axes.

    Args:
        step: The step.
    """
    return messages.Imu(
        header=messages.stamped(step.motion.time, BODY),
        orientation=_quaternion(step.motion.rotation),
        orientation_covariance=UNKNOWN_3,
        angular_velocity=_vector(step.inertial.angular_velocity),
        angular_velocity_covariance=UNKNOWN_3,
        linear_acceleration=_vector(step.inertial.specific_force),
        linear_acceleration_covariance=UNKNOWN_3,
    )


def joint_states(step: VehicleStep, names: list[str]) -> Any:
    """`JointState` of the joints between links.

    Args:
        step: The step.
        names: Names of the joints, tail first.
    """
    return messages.JointState(
        header=messages.stamped(step.motion.time),
        name=names,
        position=step.log.joint_angle[-1].tolist(),
        velocity=step.log.joint_rate[-1].tolist(),
        effort=step.log.joint_torque[-1].tolist(),
    )


def pressure(step: VehicleStep, density: float) -> Any:
    """`FluidPressure` at the depth of the body.

    Args:
        step: The step.
        density: Of the water [kg/m^3].
    """
    depth = -float(step.motion.position[2])
    return messages.FluidPressure(
        header=messages.stamped(step.motion.time, BODY),
        fluid_pressure=SURFACE_PRESSURE + density * float(FELT_AT_REST[2]) * depth,
        variance=0.0,
    )


def distance(step: VehicleStep, robot: Robot, number: int, *, has_variance: bool) -> Any:
    """`Range` of one rangefinder of the head.

    Args:
        step: The step.
        robot: The robot.
        number: Its number.
        has_variance: Whether the message has a variance, as from Iron on.
    """
    measured = step.ranges[number]
    if measured > LARGEST_RANGE:
        measured = math.inf
    fields: dict[str, Any] = {
        "header": messages.stamped(step.motion.time, head_frame(robot)),
        "radiation_type": ULTRASOUND,
        "field_of_view": 0.0,
        "min_range": 0.0,
        "max_range": LARGEST_RANGE,
        "range": measured,
    }
    if has_variance:
        return messages.Range(**fields, variance=0.0)
    return messages.RangeOfHumble(**fields)


def joint_names(robot: Robot) -> list[str]:
    """Return the names of the joints, as in the robot's URDF.

    Args:
        robot: The robot.
    """
    return [f"joint_{number}" for number in range(robot.n_joints)]


def head_frame(robot: Robot) -> str:
    """Return the frame of the head, as in the robot's URDF.

    Args:
        robot: The robot.
    """
    return f"module_{robot.n_links - 1}"
