"""The messages of ROS 2 that are used here, as its middleware sends them over DDS.

The message `pkg/msg/Kind` is the DDS type `pkg::msg::dds_::Kind_`, with the fields in the order of
its definition, final, in plain CDR.

References:
    `std_msgs`, `geometry_msgs` and `sensor_msgs`: the definitions of ROS 2 Humble to Jazzy, which agree.
    "Topic and Service name mapping to DDS", design.ros2.org.
"""

from typing import Any

from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, float32, float64, int32, sequence, uint8, uint32


def _type(name: str, /, **fields: Any) -> Any:
    package, _, kind = name.partition("/")
    return final(make_idl_struct(kind, f"{package}::msg::dds_::{kind}_", fields))


Time = _type("builtin_interfaces/Time", sec=int32, nanosec=uint32)
Header = _type("std_msgs/Header", stamp=Time, frame_id=str)

Point = _type("geometry_msgs/Point", x=float64, y=float64, z=float64)
Quaternion = _type("geometry_msgs/Quaternion", x=float64, y=float64, z=float64, w=float64)
Pose = _type("geometry_msgs/Pose", position=Point, orientation=Quaternion)
PoseStamped = _type("geometry_msgs/PoseStamped", header=Header, pose=Pose)

JointState = _type(
    "sensor_msgs/JointState",
    header=Header,
    name=sequence[str],
    position=sequence[float64],
    velocity=sequence[float64],
    effort=sequence[float64],
)
Dimension = _type("std_msgs/MultiArrayDimension", label=str, size=uint32, stride=uint32)
Layout = _type("std_msgs/MultiArrayLayout", dim=sequence[Dimension], data_offset=uint32)
Float64MultiArray = _type("std_msgs/Float64MultiArray", layout=Layout, data=sequence[float64])


Vector3 = _type("geometry_msgs/Vector3", x=float64, y=float64, z=float64)
Twist = _type("geometry_msgs/Twist", linear=Vector3, angular=Vector3)
TwistWithCovariance = _type(
    "geometry_msgs/TwistWithCovariance", twist=Twist, covariance=array[float64, 36]
)
PoseWithCovariance = _type(
    "geometry_msgs/PoseWithCovariance", pose=Pose, covariance=array[float64, 36]
)
Odometry = _type(
    "nav_msgs/Odometry",
    header=Header,
    child_frame_id=str,
    pose=PoseWithCovariance,
    twist=TwistWithCovariance,
)
Imu = _type(
    "sensor_msgs/Imu",
    header=Header,
    orientation=Quaternion,
    orientation_covariance=array[float64, 9],
    angular_velocity=Vector3,
    angular_velocity_covariance=array[float64, 9],
    linear_acceleration=Vector3,
    linear_acceleration_covariance=array[float64, 9],
)
FluidPressure = _type(
    "sensor_msgs/FluidPressure", header=Header, fluid_pressure=float64, variance=float64
)
_RANGE = {
    "header": Header,
    "radiation_type": uint8,
    "field_of_view": float32,
    "min_range": float32,
    "max_range": float32,
    "range": float32,
}
Range = _type("sensor_msgs/Range", **_RANGE, variance=float32)
RangeOfHumble = _type("sensor_msgs/Range", **_RANGE)
"""Humble's has no variance; those of Jazzy and Kilted have one."""
Transform = _type("geometry_msgs/Transform", translation=Vector3, rotation=Quaternion)
TransformStamped = _type(
    "geometry_msgs/TransformStamped", header=Header, child_frame_id=str, transform=Transform
)
TFMessage = _type("tf2_msgs/TFMessage", transforms=sequence[TransformStamped])
Clock = _type("rosgraph_msgs/Clock", clock=Time)
Empty = _type("std_msgs/Empty", structure_needs_at_least_one_member=uint8)


def numbers(values: Any) -> Any:
    """A `Float64MultiArray` of these values, as `ros2 topic pub` would make it."""
    return Float64MultiArray(
        layout=Layout(dim=[], data_offset=0), data=[float(value) for value in values]
    )


def stamped(time: float, frame: str = "") -> Any:
    """A `Header`.

    Args:
        time: Of its stamp [s].
        frame: Its `frame_id`.
    """
    sec, fraction = divmod(time, 1.0)
    nanosec = min(round(fraction * 1e9), 999_999_999)
    return Header(stamp=Time(sec=int(sec), nanosec=nanosec), frame_id=frame)


def clock(time: float) -> Any:
    """A `Clock`.

    Args:
        time: What it shows [s].
    """
    return Clock(clock=stamped(time).stamp)
