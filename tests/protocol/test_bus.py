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
        ("udp_multicast:239.1.2.3:0", "`port` must be a whole number >= 1, got 0."),
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


def test_frames_go_between_buses_of_one_computer_and_to_plain_python_can():
    import can

    address = bus_address("udp_multicast:239.74.163.99:43199")
    with open_bus(address) as one, open_bus(address) as other:
        one.send(to_frame(Sync(counter=7)))
        assert from_frame(other.recv(1.0)) == Sync(counter=7)
        plain = {"interface": "udp_multicast", "channel": address.channel, "port": address.port, "hop_limit": 0}
        with can.Bus(**plain) as foreign:
            one.send(to_frame(Sync(counter=8)))
            assert from_frame(foreign.recv(1.0)) == Sync(counter=8)
            foreign.send(to_frame(Sync(counter=9)))
            found = [from_frame(frame) for frame in iter(lambda: other.recv(0.5), None)]
            assert found == [Sync(counter=8), Sync(counter=9)]


def test_frames_of_other_computers_are_not_heard():
    address = bus_address("udp_multicast:239.74.163.99:43198")
    with open_bus(address) as bus:
        listen = bus._multicast.recv
        heard = (b"", ("192.0.2.1", 43198), 0.0)
        listen.__closure__[[c for c in listen.__code__.co_freevars].index("listen")].cell_contents = lambda t: heard
        assert listen(0.0) is None
