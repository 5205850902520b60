"""Our messages beside those of another implementation, which was made from the definitions of ROS 2."""

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="the DDS library is not installed: pip install cyclonedds")
pytest.importorskip(
    "rosbags", reason="the other implementation is not installed: pip install rosbags"
)

from rosbags import typesys

from laticauda_ros2 import messages

DISTRIBUTIONS = ("ROS2_HUMBLE", "ROS2_JAZZY", "ROS2_KILTED")
HEADER = messages.stamped(1_700_000_000.25, "tank")
OURS = {
    "geometry_msgs/msg/PoseStamped": messages.PoseStamped(
        header=HEADER,
        pose=messages.Pose(messages.Point(1.0, -2.0, 0.5), messages.Quaternion(0.1, 0.2, 0.3, 0.9)),
    ),
    "sensor_msgs/msg/JointState": messages.JointState(
        header=HEADER, name=["a", "joint_2"], position=[0.1, -0.2], velocity=[], effort=[1.0, 2.0]
    ),
    "std_msgs/msg/Float64MultiArray": messages.Float64MultiArray(
        layout=messages.Layout(dim=[messages.Dimension("x", 2, 2)], data_offset=0),
        data=[1.5, float("nan")],
    ),
    "nav_msgs/msg/Odometry": messages.Odometry(
        header=HEADER,
        child_frame_id="base_link",
        pose=messages.PoseWithCovariance(
            pose=messages.Pose(
                messages.Point(1.0, -2.0, 0.5), messages.Quaternion(0.0, 0.0, 0.6, 0.8)
            ),
            covariance=[float(number) for number in range(36)],
        ),
        twist=messages.TwistWithCovariance(
            twist=messages.Twist(
                linear=messages.Vector3(0.1, 0.2, 0.3), angular=messages.Vector3(0.4, 0.5, 0.6)
            ),
            covariance=[0.5] * 36,
        ),
    ),
    "sensor_msgs/msg/Imu": messages.Imu(
        header=HEADER,
        orientation=messages.Quaternion(0.0, 0.0, 0.6, 0.8),
        orientation_covariance=[float(number) for number in range(9)],
        angular_velocity=messages.Vector3(0.1, 0.2, 0.3),
        angular_velocity_covariance=[0.0] * 9,
        linear_acceleration=messages.Vector3(0.4, 0.5, 9.8),
        linear_acceleration_covariance=[0.0] * 9,
    ),
    "sensor_msgs/msg/FluidPressure": messages.FluidPressure(
        header=HEADER, fluid_pressure=101_325.5, variance=0.25
    ),
    "tf2_msgs/msg/TFMessage": messages.TFMessage(
        transforms=[
            messages.TransformStamped(
                header=HEADER,
                child_frame_id="base_link",
                transform=messages.Transform(
                    translation=messages.Vector3(1.0, 2.0, 3.0),
                    rotation=messages.Quaternion(0.0, 0.0, 0.6, 0.8),
                ),
            )
        ]
    ),
    "geometry_msgs/msg/Twist": messages.Twist(
        linear=messages.Vector3(0.1, 0.2, 0.3), angular=messages.Vector3(0.4, 0.5, 0.6)
    ),
    "rosgraph_msgs/msg/Clock": messages.clock(12.5),
    "std_msgs/msg/Empty": messages.Empty(structure_needs_at_least_one_member=0),
}
RANGE = {
    "header": HEADER,
    "radiation_type": 0,
    "field_of_view": 0.5,
    "min_range": 0.25,
    "max_range": 100.0,
    "range": 1.5,
}
RANGES = {
    "ROS2_HUMBLE": messages.RangeOfHumble(**RANGE),
    "ROS2_JAZZY": messages.Range(**RANGE, variance=0.125),
    "ROS2_KILTED": messages.Range(**RANGE, variance=0.125),
}
"""By distribution: that of Humble is shorter."""


def is_message(value) -> bool:
    return hasattr(value, "__idl_typename__")


def type_of_theirs(store, kind):
    """The type of the other implementation for a type of ours."""
    package, middle, _, name = kind.__idl_typename__.split("::")
    return store.types[f"{package}/{middle}/{name.removesuffix('_')}"]


def fields_of_theirs(kind) -> list[str]:
    """Names of the fields of a type of the other implementation, without constants."""
    names = kind.__dataclass_fields__
    return [name for name in names if name != "__msgtype__" and not name.isupper()]


def convert(store, ours):
    """The same message, of the other implementation."""
    kind = type_of_theirs(store, ours)
    values = [convert_value(store, getattr(ours, name)) for name in fields_of_theirs(kind)]
    return kind(*values)


def convert_value(store, value):
    if is_message(value):
        return convert(store, value)
    if not isinstance(value, list):
        return value
    if value and is_message(value[0]):
        return [convert(store, entry) for entry in value]
    if value and isinstance(value[0], str):
        return value
    return np.array(value, dtype=float)


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
@pytest.mark.parametrize("name", OURS)
def test_bytes_are_those_of_the_definitions_of_ros_2_both_ways(name, distribution):
    check_bytes(distribution, name, OURS[name])


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_a_range_has_a_variance_except_in_humble(distribution):
    check_bytes(distribution, "sensor_msgs/msg/Range", RANGES[distribution])


def check_bytes(distribution, name, ours):
    store = typesys.get_typestore(typesys.Stores[distribution])
    data = bytes(store.serialize_cdr(convert(store, ours), name))
    assert ours.serialize() == data
    assert type(ours).deserialize(data).serialize() == data


@pytest.mark.parametrize("distribution", DISTRIBUTIONS)
def test_fields_are_those_of_the_definitions_of_ros_2(distribution):
    store = typesys.get_typestore(typesys.Stores[distribution])
    other_range = messages.Range if distribution == "ROS2_HUMBLE" else messages.RangeOfHumble
    kinds = [value for value in vars(messages).values() if is_message(value)]
    assert len(kinds) == 24
    for kind in kinds:
        if kind is other_range:
            continue
        assert [*kind.__dataclass_fields__] == fields_of_theirs(type_of_theirs(store, kind))


def test_types_have_the_names_that_the_middleware_of_ros_2_gives_them():
    assert [message.__idl_typename__ for message in OURS.values()] == [
        "geometry_msgs::msg::dds_::PoseStamped_",
        "sensor_msgs::msg::dds_::JointState_",
        "std_msgs::msg::dds_::Float64MultiArray_",
        "nav_msgs::msg::dds_::Odometry_",
        "sensor_msgs::msg::dds_::Imu_",
        "sensor_msgs::msg::dds_::FluidPressure_",
        "tf2_msgs::msg::dds_::TFMessage_",
        "geometry_msgs::msg::dds_::Twist_",
        "rosgraph_msgs::msg::dds_::Clock_",
        "std_msgs::msg::dds_::Empty_",
    ]
    annotations = [message.__idl_annotations__ for message in OURS.values()]
    assert {annotation["extensibility"] for annotation in annotations} == {"final"}


def test_a_stamp_holds_seconds_and_nanoseconds():
    stamp = messages.stamped(2.9999999996).stamp
    assert (stamp.sec, stamp.nanosec) == (2, 999_999_999)
    assert (HEADER.stamp.sec, HEADER.stamp.nanosec) == (1_700_000_000, 250_000_000)
