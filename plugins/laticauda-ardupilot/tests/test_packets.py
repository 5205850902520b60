"""Both messages, byte by byte as ArduPilot's readme has them."""

import json
import math
import struct

import numpy as np
import pytest

from laticauda_ardupilot.emulator import NotUnderstood, find_numbers, read_answer
from laticauda_ardupilot.packets import (
    NO_RETURN,
    SensorReading,
    ServoPacket,
    read_servo_packet,
    write_sensor_line,
    write_servo_packet,
)

READING = SensorReading(
    time=2500.0025,
    gyro=np.array([1e-7, -0.2, 0.3]),
    acceleration=np.array([0.0, 0.1, -9.80665]),
    position=np.array([1.0, -2.0, 3.0]),
    velocity=np.array([0.1, 0.2, -0.3]),
    attitude=np.array([0.01, 0.02, 0.03]),
    quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
    ranges=(1.5, math.inf),
    voltage=41.5,
    current=1.25,
)


@pytest.mark.parametrize(("magic", "n_channels"), [(18458, 16), (29569, 32)])
def test_a_servo_packet_is_little_endian_and_its_magic_says_how_many_channels(magic, n_channels):
    pwm = tuple(range(1100, 1100 + n_channels))
    data = struct.pack(f"<HHI{n_channels}H", magic, 400, 70000, *pwm)
    packet = read_servo_packet(data)
    assert packet == ServoPacket(frame_rate=400, frame_count=70000, pwm=pwm)
    assert write_servo_packet(packet) == data


def test_an_answer_is_one_line_of_json_between_line_feeds_without_blanks():
    data = write_sensor_line(READING)
    assert data.startswith(
        b'\n{"timestamp":2500.0025,"imu":{"gyro":[1e-07,-0.2,0.3],"accel_body":['
    )
    assert data.endswith(b"}\n")
    assert b" " not in data
    message = json.loads(data)
    assert message["battery"] == {"voltage": 41.5, "current": 1.25}
    assert message["rng_1"] == 1.5
    assert message["rng_2"] == NO_RETURN  # ArduPilot reads no infinity


def test_the_double_finds_numbers_behind_the_text_of_their_key_as_the_real_parser_does():
    numbers = read_answer(write_sensor_line(READING))
    assert numbers["accel_body"] == [0.0, 0.1, -9.80665]
    assert numbers["velocity"] == [0.1, 0.2, -0.3]
    assert numbers["rng_1"] == [1.5]
    assert numbers["voltage"] == [41.5]
    assert find_numbers('{"position": [1,2,3]}', "position") is None  # a blank is not understood


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"{}", "must stand between line feeds"),
        (b"\n{}\n", "did not find the key timestamp"),
        (write_sensor_line(READING).replace(b"gyro", b"gyros"), "did not find the key gyro"),
        (
            write_sensor_line(READING).replace(b"attitude", b"x").replace(b"quaternion", b"y"),
            "did not find the key attitude or quaternion",
        ),
    ],
)
def test_an_answer_that_lacks_something_stops_the_double_as_it_stops_ardupilot(data, why):
    with pytest.raises(NotUnderstood, match=why):
        read_answer(data)
