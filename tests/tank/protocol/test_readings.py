"""Datagrams of the robot's own sensors."""

import math

import pytest

from laticauda.tank.protocol.readings import (
    MOST_SENSORS,
    SensorList,
    SentReading,
    decode_datagram,
    encode_list,
    encode_reading,
)

READING = SentReading(
    session="a1", sensor="sonar", number=7, time=1.25, values=(0.1 + 0.2, math.nan, -3.0)
)


def test_a_reading_comes_back_to_the_last_digit_and_nothing_stays_nothing():
    back = decode_datagram(encode_reading(READING))
    assert isinstance(back, SentReading)
    assert (back.session, back.sensor, back.number, back.time) == ("a1", "sonar", 7, 1.25)
    assert back.values[0] == 0.1 + 0.2
    assert math.isnan(back.values[1])
    assert back.values[2] == -3.0


def test_a_list_of_sensors_comes_back():
    sensors = SensorList(session="a1", columns={"compass": ("heading",), "contact": ("n", "link")})
    assert decode_datagram(encode_list(sensors)) == sensors


@pytest.mark.parametrize(
    "datagram",
    [
        b"",
        b"\xff\x00",
        b"[]",
        b"{}",
        b"[" * 5000,
        b'{"session":1,"sensors":{}}',
        b'{"session":"a","sensors":[]}',
        b'{"session":"a","sensors":{"compass":"heading"}}',
        b'{"session":"a","sensors":{"compass":[1]}}',
        b'{"session":"a","sensor":"compass","number":-1,"time":1,"values":[]}',
        b'{"session":"a","sensor":"compass","number":true,"time":1,"values":[]}',
        b'{"session":"a","sensor":"compass","number":1,"time":NaN,"values":[]}',
        b'{"session":"a","sensor":"compass","number":1,"time":1,"values":["1"]}',
        b'{"session":"a","sensor":"compass","number":1,"time":1,"values":[1' + b"0" * 400 + b"]}",
        b'{"session":"a","sensor":["compass"],"number":1,"time":1,"values":[]}',
        b'{"session":"a","sensor":"compass","number":1,"time":1}',
    ],
)
def test_anything_else_is_nothing(datagram):
    assert decode_datagram(datagram) is None


def test_a_list_of_very_many_sensors_is_nothing():
    columns = {f"sensor_{k}": ("value",) for k in range(MOST_SENSORS + 1)}
    assert decode_datagram(encode_list(SensorList(session="a", columns=columns))) is None
