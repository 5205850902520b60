import pytest

from laticauda.access import refusal


def headers(**said):
    found = {name.replace("_", "-"): [value] for name, value in said.items()}
    return lambda name: found.get(name, [])


@pytest.mark.parametrize("served", ["127.0.0.1", "::1", "localhost"])
@pytest.mark.parametrize("host", ["127.0.0.1:8080", "localhost:8080", "LOCALHOST", "[::1]:8080", "[::1]"])
def test_on_this_computer_its_own_names_are_answered(served, host):
    assert refusal(served, headers(Host=host)) == ""
    assert refusal(served, headers(Host=host, Origin=f"http://{host}")) == ""


@pytest.mark.parametrize("served", ["127.0.0.1", "0.0.0.0", "192.168.1.2", ""])
@pytest.mark.parametrize(
    "host",
    ["evil.example", "evil.example:8080", "127.0.0.1.evil.example", "localhost.evil.example:8080", "", "[::1", "a b"],
)
def test_a_name_that_somebody_lets_point_here_is_refused(served, host):
    assert refusal(served, headers(Host=host)) == f"This server is at {served}, and not at {host!r}."


def test_a_request_without_a_host_or_with_two_is_refused():
    for hosts in ([], ["127.0.0.1", "127.0.0.1"]):
        assert refusal("127.0.0.1", lambda name, hosts=hosts: hosts if name == "Host" else [])


def test_on_all_addresses_numbers_are_answered_and_on_one_that_one_alone():
    for host in ("10.0.0.7:8080", "[fe80::1]:80", "localhost:8080"):
        assert refusal("0.0.0.0", headers(Host=host)) == ""
        assert (refusal("192.168.1.2", headers(Host=host)) == "") is host.startswith("localhost")  # by a tunnel
    assert refusal("192.168.1.2", headers(Host="192.168.1.2:1")) == ""


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "http://127.0.0.1:8081", "https://127.0.0.1:8080", "null", "", "file://"]
)
def test_a_page_of_another_origin_is_refused_also_of_another_port(origin):
    found = refusal("127.0.0.1", headers(Host="127.0.0.1:8080", Origin=origin))
    assert found == f"This server answers its own pages, and none of {origin!r}."
