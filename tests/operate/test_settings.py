import pytest

from laticauda.operate.settings import Connection


def test_what_is_typed_replaces_what_holds_otherwise():
    usual = Connection(mocap_body="last-module")
    found = usual.at(can="udp_multicast:239.1.2.3:4000", mocap="10.0.0.7:22225")
    assert (found.can_channel, found.can_port, found.mocap_host, found.mocap_port) == (
        "239.1.2.3",
        4000,
        "10.0.0.7",
        22225,
    )
    assert found.mocap_body == "last-module"
    assert usual.at() == usual


@pytest.mark.parametrize("text", ["10.0.0.7", ":22223", "here:there"])
def test_a_motion_capture_without_host_or_port_is_refused(text):
    with pytest.raises(ValueError, match=f"`mocap` must be HOST:PORT, got '{text}'"):
        Connection().at(mocap=text)
