import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from laticauda.protocol import BusAddress, BusFailed, Sync, bus_address, from_frame, open_bus, to_frame


def test_a_virtual_bus_carries_frames():
    address = BusAddress(interface="virtual", channel="test_bus")
    with open_bus(address) as one, open_bus(address) as other:
        one.send(to_frame(Sync(counter=3)))
        assert from_frame(other.recv(1.0)) == Sync(counter=3)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("udp_multicast", "udp_multicast:239.74.163.2:43113"),
        ("udp_multicast:239.1.2.3:5000", "udp_multicast:239.1.2.3:5000"),
        ("virtual:tank", "virtual:tank"),
        ("socketcan", "socketcan:can0"),
    ],
)
def test_an_address_is_read_and_shown(text, shown):
    address = bus_address(text)
    assert str(address) == shown
    assert bus_address(shown) == address
    assert address.hops == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("usb", "`interface` must be one of `virtual`, `udp_multicast`, `socketcan`, got 'usb'"),
        ("udp_multicast:127.0.0.1", "`channel` must be an IPv4 multicast group such as 239.74.163.2, got '127.0.0.1'."),
        ("udp_multicast:239.1.2.3:x", "`port` must be a whole number, got 'x'."),
        ("udp_multicast:239.1.2.3:0", "`port` must be between 1 and 65535, got 0."),
    ],
)
def test_a_wrong_address_is_refused(text, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        bus_address(text)


@given(text=st.text())
def test_any_text_is_an_address_or_a_value_error(text):
    try:
        bus_address(text)
    except ValueError:
        pass


def test_a_bus_that_is_not_there_is_said():
    with pytest.raises(BusFailed, match="The CAN bus socketcan:nosuch0 cannot be opened: "):
        open_bus(BusAddress(interface="socketcan", channel="nosuch0"))
