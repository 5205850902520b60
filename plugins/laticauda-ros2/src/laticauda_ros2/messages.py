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
from cyclonedds.idl.types import float64, int32, sequence, uint32


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


def numbers(values: Any) -> Any:
    """A `Float64MultiArray` of these values, as `ros2 topic pub` would make it."""
    return Float64MultiArray(
        layout=Layout(dim=[], data_offset=0), data=[float(one) for one in values]
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
