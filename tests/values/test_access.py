import pytest

from laticauda.values.access import VARIABLE, ServerAccess

TOKEN = "0123456789abcdef"


def refusal(served, headers, path="/", token=""):
    return ServerAccess(served, token).refusal(path, headers)


def headers(**said):
    found = {name.replace("_", "-"): [value] for name, value in said.items()}
    return lambda name: found.get(name, [])


@pytest.mark.parametrize("served", ["127.0.0.1", "::1", "localhost"])
@pytest.mark.parametrize(
    "host", ["127.0.0.1:8080", "localhost:8080", "LOCALHOST", "[::1]:8080", "[::1]"]
)
def test_on_this_computer_its_own_names_are_answered(served, host):
    assert refusal(served, headers(Host=host)) == ""
    assert refusal(served, headers(Host=host, Origin=f"http://{host}")) == ""


@pytest.mark.parametrize("served", ["127.0.0.1", "0.0.0.0", "192.168.1.2", ""])
@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "evil.example:8080",
        "127.0.0.1.evil.example",
        "localhost.evil.example:8080",
        "",
        "[::1",
        "a b",
    ],
)
def test_a_name_that_somebody_lets_point_here_is_refused(served, host):
    assert (
        refusal(served, headers(Host=host)) == f"This server is at {served}, and not at {host!r}."
    )


def test_a_request_without_a_host_or_with_two_is_refused():
    for hosts in ([], ["127.0.0.1", "127.0.0.1"]):
        assert refusal("127.0.0.1", lambda name, hosts=hosts: hosts if name == "Host" else [])


def test_on_all_addresses_numbers_are_answered_and_on_one_that_one_alone():
    for host in ("10.0.0.7:8080", "[fe80::1]:80", "localhost:8080"):
        assert refusal("0.0.0.0", headers(Host=host)) == ""
        assert (refusal("192.168.1.2", headers(Host=host)) == "") is host.startswith(
            "localhost"
        )  # by a tunnel
    assert refusal("192.168.1.2", headers(Host="192.168.1.2:1")) == ""


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "http://127.0.0.1:8081",
        "https://127.0.0.1:8080",
        "null",
        "",
        "file://",
    ],
)
def test_a_page_of_another_origin_is_refused_also_of_another_port(origin):
    found = refusal("127.0.0.1", headers(Host="127.0.0.1:8080", Origin=origin))
    assert found == f"This server answers only its own pages, none of {origin!r}."


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.2", "127.0.0.1.example"])
def test_where_other_computers_may_reach_it_there_is_a_token_another_one_each_time(host):
    one, other = ServerAccess.of(host), ServerAccess.of(host)
    assert len(one.token) >= 24 and one.token != other.token
    assert (
        one.token in one.url(80)
        and one.token not in repr(one) + one.warning
        and host in one.warning
    )
    assert one.admits(one.token)
    for said in (
        None,
        "",
        1,
        [],
        other.token,
        one.token[:-1],
        one.token + "a",
        "\udcff",
        one.token.swapcase(),
    ):
        assert not one.admits(said)


@pytest.mark.parametrize("host", ["", ".", "a\0b"])
def test_what_is_the_name_of_no_host_is_refused(host):
    with pytest.raises(ValueError, match="`host` must be the name or address of a host, got"):
        ServerAccess.of(host)


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1"])
def test_on_this_computer_there_is_none(host):
    door = ServerAccess.of(host)
    assert door.token == door.warning == "" and door.admits(None)


def test_pages_and_their_sockets_have_the_token_in_their_address():
    asked = headers(Host="10.0.0.7:80", Origin="http://10.0.0.7:80")
    for path in (f"/{TOKEN}", f"/{TOKEN}/", f"/{TOKEN}/?darkMode", f"/{TOKEN}/index.html"):
        assert refusal("0.0.0.0", asked, path, TOKEN) == ""
    for path in (
        "",
        "/",
        "*",
        "/?" + TOKEN,
        f"/a/{TOKEN}",
        f"/{TOKEN}a",
        "/%30" + TOKEN[1:],
        TOKEN[:-1],
    ):
        why = refusal("0.0.0.0", asked, path, TOKEN)
        assert why == "This server requires its token: open the complete address that it printed."
    evil = headers(Host="10.0.0.7:80", Origin="http://evil.example")
    assert "its own pages" in refusal("0.0.0.0", evil, f"/{TOKEN}/", TOKEN)


def test_a_token_of_the_environment_is_taken_on_this_computer_too(monkeypatch):
    monkeypatch.setenv(VARIABLE, TOKEN)
    assert ServerAccess.of("127.0.0.1").token == ServerAccess.of("0.0.0.0").token == TOKEN
    assert ServerAccess.of("::1").url(80) == f"http://[::1]:80/{TOKEN}/"


@pytest.mark.parametrize(
    "token", ["short", "a" * 15, "a/b" * 9, "with a space in it", "\u00e9" * 20]
)
def test_a_token_that_can_be_guessed_or_is_no_part_of_an_address_is_refused_and_not_shown(
    monkeypatch, token
):
    monkeypatch.setenv(VARIABLE, token)
    with pytest.raises(
        ValueError, match=r"^`LATICAUDA_TOKEN` must be 16 or more letters"
    ) as caught:
        ServerAccess.of("127.0.0.1")
    assert token not in str(caught.value)
