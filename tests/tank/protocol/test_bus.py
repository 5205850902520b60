import gc
import re
import socket
import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import given, strategies as st
from patience import LONG, running

from laticauda.tank.protocol import (
    BusAddress,
    BusFailed,
    Sync,
    bus_address,
    from_frame,
    open_bus,
    to_frame,
)
from laticauda.tank.protocol.can import _local_socket
from laticauda.tank.protocol.layouts import LAYOUTS
from laticauda.tank.protocol.messages import REFERENCES_PER_FRAME


def test_a_virtual_bus_carries_frames():
    address = BusAddress(interface="virtual", channel="test_bus")
    with open_bus(address) as one, open_bus(address) as other:
        one.send(to_frame(Sync(counter=3)))
        assert from_frame(other.recv(1.0)) == Sync(counter=3)


def test_a_bus_beyond_this_computer_has_the_usual_socket_and_its_hops():
    address = bus_address("udp_multicast:239.74.163.9:43999", hops=1)
    try:
        bus = open_bus(address)
    except BusFailed as refusal:
        pytest.skip(f"no group can be joined on a network here: {refusal}")
    with bus:
        assert type(bus._multicast).__name__ == "GeneralPurposeUdpMulticastBus"
        assert bus._multicast.hop_limit == 1


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
        (
            "udp_multicast:127.0.0.1",
            "`channel` must be an IPv4 multicast group such as 239.74.163.2, got '127.0.0.1'.",
        ),
        (
            "udp_multicast:tank",
            "`channel` must be an IPv4 multicast group such as 239.74.163.2, got 'tank'.",
        ),
        ("udp_multicast:ff02::1", "`port` must be a whole number, got ':1'."),
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


def plain_bus(address):
    """As somebody else's program opens it."""
    import can

    return can.Bus(
        interface="udp_multicast", channel=address.channel, port=address.port, hop_limit=0
    )


def by_loopback(bus):
    """A bus that sends by loopback, as all do where the system's routes say so of the group."""
    bus._multicast._socket.setsockopt(
        socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1")
    )
    return bus


def test_frames_go_between_buses_of_one_computer_and_to_and_from_plain_python_can_by_loopback():
    address = bus_address("udp_multicast:239.74.163.99:43199")
    with open_bus(address) as one, open_bus(address) as other:
        one.send(to_frame(Sync(counter=7)))
        assert from_frame(other.recv(1.0)) == Sync(counter=7)
        with by_loopback(plain_bus(address)) as foreign:
            one.send(to_frame(Sync(counter=8)))
            assert from_frame(foreign.recv(1.0)) == Sync(counter=8)
            foreign.send(to_frame(Sync(counter=9)))
            found = [from_frame(frame) for frame in iter(lambda: other.recv(0.5), None)]
            assert found == [Sync(counter=8), Sync(counter=9)]


def garbage():
    """Datagrams that are no frame, some of which say that they hold gigabytes."""
    msgpack = pytest.importorskip("msgpack")
    good = {
        "arbitration_id": 5,
        "is_extended_id": False,
        "is_remote_frame": False,
        "is_error_frame": False,
        "channel": None,
        "dlc": 1,
        "data": b"1",
        "is_fd": False,
    }
    changes = [
        {"data": 2**40},
        {"data": 2**31, "dlc": 2**31},
        {"data": None},
        {"data": [1]},
        {"data": "1"},
        {"data": b"1" * 4000, "dlc": 4000},
        {"data": b"1" * 64, "dlc": 64},
        {"data": b"1" * 64, "dlc": 64, "is_fd": True},
        {"dlc": -1},
        {"dlc": 1000},
        {"arbitration_id": -1},
        {"arbitration_id": 1 << 40},
        {"arbitration_id": 5.5},
        {"arbitration_id": "5"},
        {"arbitration_id": True},
        {"no_such_field": 1},
    ]
    yield from (b"", b"\0", b"\xff" * 500, b"\x91" * 500, b"\xdd\xff\xff\xff\xff")
    yield from (msgpack.packb(content) for content in ({}, [1], None, 3, {"data": b"1"}))
    yield from (msgpack.packb({**good, **change}) for change in changes)


def test_datagrams_that_are_no_frame_are_not_heard_and_take_no_memory():
    address = bus_address("udp_multicast:239.74.163.99:43194")
    with open_bus(address) as one, open_bus(address) as other:
        for datagram in garbage():
            one._multicast.send(datagram)
        one.send(to_frame(Sync(counter=7)))
        tracemalloc.start()
        assert from_frame(other.recv(5.0)) == Sync(counter=7)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < 1 << 20


def test_frames_go_between_processes():
    script = """
import sys
from laticauda.tank.protocol import Sync, bus_address, from_frame, open_bus, to_frame
with open_bus(bus_address(sys.argv[1])) as bus:
    print(flush=True)
    bus.send(to_frame(Sync(counter=from_frame(bus.recv(60.0)).counter + 1)))
"""
    text = "udp_multicast:239.74.163.99:43195"
    words = [sys.executable, "-c", script, text]
    with running(words, stdout=subprocess.PIPE) as process, open_bus(bus_address(text)) as bus:
        process.stdout.readline()
        bus.send(to_frame(Sync(counter=1)))
        assert [from_frame(bus.recv(LONG)) for _ in range(2)] == [Sync(counter=1), Sync(counter=2)]
        assert process.wait(LONG) == 0


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_the_group_is_joined_by_loopback_alone_and_no_address_of_a_network_is_bound():
    with open_bus(bus_address("udp_multicast:239.74.163.97:43197")) as bus:
        joined, device = [], ""
        for line in Path("/proc/self/net/igmp").read_text().splitlines()[1:]:
            device = line.split()[1] if line[0].isdigit() else device
            joined += [device] if line.split()[0] == "61A34AEF" else []
        assert joined == ["lo"]
        assert bus._multicast._socket.getsockname() == ("239.74.163.97", 43197)


def test_frames_that_come_by_a_network_are_not_heard():
    address = bus_address("udp_multicast:239.74.163.99:43198")
    try:
        foreign = plain_bus(address)
        foreign.send(to_frame(Sync(counter=1)))
    except Exception as error:
        pytest.skip(f"there is no network here: {error}")
    with foreign, open_bus(address) as bus:
        for counter in range(3):
            foreign.send(to_frame(Sync(counter=counter)))  # looped back by the network's interface
        assert bus.recv(0.3) is None


def test_where_loopback_cannot_be_joined_there_is_no_bus(monkeypatch):
    import can.interfaces.udp_multicast.bus as plain

    def refused(*_):
        raise OSError(19, "No such device")

    monkeypatch.setattr("laticauda.tank.protocol.can._local_socket", refused)
    monkeypatch.setattr(plain.GeneralPurposeUdpMulticastBus, "send", refused)
    with pytest.raises(
        BusFailed, match=r"The CAN bus udp_multicast:239.74.163.2:43113 cannot be opened: "
    ):
        open_bus(bus_address("udp_multicast"))


@pytest.mark.parametrize("system", ["linux", "darwin"])
def test_a_system_without_all_options_has_a_bus_within_the_computer_too(monkeypatch, system):
    monkeypatch.delattr(socket, "SO_REUSEPORT", raising=False)
    monkeypatch.setattr(sys, "platform", system)
    address = bus_address("udp_multicast:239.74.163.99:43194")
    with open_bus(address) as one, open_bus(address) as other:
        one.send(to_frame(Sync(counter=5)))
        assert from_frame(other.recv(1.0)) == Sync(counter=5)


def test_a_group_that_cannot_be_joined_leaves_no_socket_open():
    with pytest.raises(OSError, match=r"Cannot assign requested address|Invalid argument"):
        _local_socket("203.0.113.9", 43193)
    gc.collect()  # an open one would be warned of, and warnings are errors


def frame_bits(n_bytes):
    """The longest that a frame can be on the wire, with the pause of 3 bits behind it (Davis and others 2007, (1))."""
    return 8 * n_bytes + 47 + (34 + 8 * n_bytes - 1) // 4


def stuffed(bits):
    """Bits on the wire after stuffing: after five equal ones comes one of the other kind, which counts for the next."""
    wire, run, last = 0, 0, None
    for bit in bits:
        wire += 1
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            wire += 1
            last, run = 1 - bit, 1
    return wire


@given(n=st.integers(0, 8), data=st.data())
def test_no_frame_is_longer_than_the_bound(n, data):
    bits = data.draw(st.lists(st.integers(0, 1), min_size=34 + 8 * n, max_size=34 + 8 * n))
    assert stuffed(bits) + 13 <= frame_bits(
        n
    )  # CRC delimiter, acknowledgment, end of frame, pause: 13 bits


def test_the_bound_is_reached():
    for n in range(9):
        worst = [0] * 5 + [1 - (k // 4) % 2 for k in range(34 + 8 * n - 5)]
        assert stuffed(worst) + 13 == frame_bits(n)


def test_davis_gives_eight_bytes_135_bits():
    assert [frame_bits(n) for n in (0, 8)] == [55, 135]  # 55 + 10 s


@pytest.mark.parametrize(("n_nodes", "share"), [(18, 0.432), (19, 0.452)])
def test_eighteen_modules_at_100_hz_fit_and_a_driven_fin_beside_them(n_nodes, share):
    frames = {"": 1, "node": n_nodes, "group": -(-n_nodes // REFERENCES_PER_FRAME)}
    rates = dict.fromkeys(("References", "Sync", "JointState"), 100.0)
    rates |= {"Loads": 20.0, "Acceleration": 20.0, "Heartbeat": 10.0}
    kinds = {one.kind.__name__: one for one in LAYOUTS}
    shares = {
        name: frames[kinds[name].number] * frame_bits(kinds[name].length) * rates[name] / 1e6
        for name in rates
    }
    assert sum(shares.values()) == pytest.approx(share, abs=0.001)
    by_priority = sorted(rates, key=lambda name: kinds[name].identifier)
    assert by_priority[:3] == ["References", "Sync", "JointState"]
    longest = frame_bits(8) / 1e6
    assert longest + 0.01 * sum(shares[name] for name in by_priority[:3]) < 0.005  # half a period
