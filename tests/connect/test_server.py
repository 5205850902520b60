import json
import socket
import time

import pytest
from cosim_client import Client
from patience import until

from laticauda.connect import MESSAGE_BYTES, Server
from laticauda.connect.server import ServerFailed


def test_every_client_has_a_world_of_its_own(connect):
    one, other = connect(), connect()
    one.ask("reset", robot="mamba")
    other.ask("reset", robot="mamba-fin")
    one.ask("step", duration=2.0)
    assert other.ask("get")["observation"]["time"] == 0.0
    assert one.ask("get")["observation"]["time"] == pytest.approx(2.0)


def test_a_hundred_megabytes_without_an_end_of_line_harm_nobody_else(connect, server):
    good, bad = connect(), connect()
    good.ask("reset")
    piece, sent = b"x" * (1 << 20), 0
    try:
        for _ in range(100):
            bad.wire.sendall(piece)
            sent += 1
            if sent % 10 == 0:
                assert "observation" in good.ask("step", duration=0.05)
    except OSError:
        pass  # it was let go before the end
    until(lambda: len(server._clients) == 1)
    assert "observation" in good.ask("step", duration=0.05)
    assert "observation" in connect().ask("reset")


def test_a_message_of_the_longest_length_is_read_and_a_longer_one_ends_the_connection(connect):
    client = connect()
    start, end = b'{"do": "reset", "id": "', b'"}'
    most = MESSAGE_BYTES - 1 - len(start) - len(end)
    assert len(client.line(start + b"a" * most + end)["id"]) == most
    reply = client.line(start + b"a" * (most + 1) + end)
    assert reply == {
        "error": f"A message must be {MESSAGE_BYTES} bytes or shorter; this one is longer. Good-bye."
    }
    assert client.is_let_go()


RUBBISH = (
    b"GET / HTTP/1.1",
    b"POST / HTTP/1.1",
    b"\x16\x03\x01\x02",
    b"\x00\xff\x00",
    b"[]",
    b"[" * 100_000,
    b'"do"',
)


@pytest.mark.parametrize("line", RUBBISH, ids=range(len(RUBBISH)))
def test_who_sends_what_is_no_json_object_is_hung_up_on_and_what_follows_is_not_done(
    connect, server, line
):
    good, bad = connect(), connect()
    good.ask("reset")
    bad.stream.write(line + b'\r\nHost: 127.0.0.1\r\n\r\n{"do": "run", "duration": 1}\n')
    bad.stream.flush()
    assert bad.heard()["error"].endswith("Good-bye.")
    assert bad.is_let_go()
    assert "observation" in good.ask("step", duration=0.05)


def test_a_request_that_is_refused_ends_nothing(connect):
    client = connect()
    for line in (b'{"do": "step"}', b'{"do": "step", "duration": NaN}', b"{}", b'{"do": "sing"}'):
        assert "error" in client.line(line)
    assert "observation" in client.ask("reset")


def test_a_client_that_dies_harms_nobody_and_makes_room(connect, server):
    good = connect()
    good.ask("reset")
    for half in (b'{"do": "re', b'{"do": "run", "duration": 3000}\n' * 3, b""):
        bad = connect()
        bad.stream.write(half)
        bad.stream.flush()
        # No good-bye: the other end gets a reset.
        bad.wire.setsockopt(
            socket.SOL_SOCKET, socket.SO_LINGER, b"\x01\x00\x00\x00\x00\x00\x00\x00"
        )
        bad.close()
        assert "observation" in good.ask("step", duration=0.05)
    until(lambda: len(server._clients) == 1)


def test_a_client_that_never_reads_holds_up_nobody(connect):
    good, bad = connect(), connect()
    good.ask("reset")
    bad.wire.settimeout(0.5)
    with pytest.raises(TimeoutError):
        while True:
            bad.wire.sendall(b'{"do": "run", "duration": 60, "series": ["joint_angle"]}\n' * 100)
    assert "observation" in good.ask("step", duration=0.05)


def test_requests_may_be_sent_ahead_and_are_answered_in_turn(connect):
    client = connect()
    client.stream.write(
        b'{"do":"reset","id":1}\r\n\n{"do":"step","duration":1,"id":2}\n{"do":"get","id":3}\n'
    )
    client.stream.flush()
    assert [client.heard()["id"] for _ in range(3)] == [1, 2, 3]


def test_one_client_too_many_is_told_to_come_back(connect, server):
    clients = [connect() for _ in range(server.max_clients)]
    for client in clients:
        client.ask("reset")
    late = connect()
    assert late.heard() == {
        "error": "The server already has 6 clients, its maximum; try again later."
    }
    assert late.is_let_go()
    clients[0].close()
    until(lambda: len(server._clients) == 5)
    assert "observation" in connect().ask("reset")


def test_a_long_run_of_one_client_does_not_stop_the_others(connect):
    busy, good = connect(), connect()
    good.ask("reset")
    busy.stream.write(b'{"do":"run","duration":4000,"joints":"servo","sample_interval":1}\n')
    busy.stream.flush()
    # Were the runs one after the other, the answers to these would wait for the long one's.
    for _ in range(5):
        assert "observation" in good.ask("step", duration=0.05)
    busy.wire.settimeout(0.0)
    with pytest.raises(BlockingIOError):
        busy.wire.recv(1)


def test_beyond_this_computer_the_first_message_has_the_token_or_nothing_is_done():
    with Server("0.0.0.0", 0) as server:
        for line in (
            b'{"do": "reset"}',
            b'{"do": "reset", "token": "a"}',
            b'{"token": null',
            b"{}",
            b'{"token": 1}',
        ):
            stranger = Client(server.port)
            reply = stranger.line(line + b'\n{"do": "run"}')
            assert reply == {
                "error": "The first message must hold the `token` that the server printed. Good-bye."
            }
            assert stranger.is_let_go()
            stranger.close()
        known = Client(server.port)
        assert "observation" in known.ask("reset", token=server.access.token)
        assert "observation" in known.ask("step", duration=0.05)
        known.close()


def test_who_does_not_show_the_token_is_let_go_however_busy(monkeypatch):
    monkeypatch.setattr("laticauda.connect.server.GREETING_TIMEOUT", 0.2)
    with Server("0.0.0.0", 0, max_clients=1) as server:
        stranger = Client(server.port)
        stranger.stream.write(b"\n \n{")
        stranger.stream.flush()
        assert stranger.is_let_go()
        stranger.close()
        until(lambda: not server._clients)
        known = Client(server.port)
        assert "observation" in known.ask("reset", token=server.access.token)
        time.sleep(0.4)
        assert "observation" in known.ask("step", duration=0.05)
        known.close()


def test_silent_strangers_keep_out_nobody_who_has_the_token(monkeypatch):
    monkeypatch.setattr("laticauda.connect.server.MOST_STRANGERS", 4)
    with Server("0.0.0.0", 0, max_clients=2) as server:
        token = server.access.token
        strangers = [Client(server.port) for _ in range(9)]
        first, second = Client(server.port), Client(server.port)
        for known in (first, second):
            assert "observation" in known.ask("reset", token=token)
        assert all(stranger.is_let_go() for stranger in strangers[:5])
        until(lambda: len(server._strangers) <= 4)
        third = Client(server.port)
        reply = third.ask("reset", token=token)
        assert reply["error"].startswith("The server already has 2 clients, its maximum; try again")
        assert third.is_let_go()
        for client in (*strangers, first, second, third):
            client.close()


def test_a_port_that_is_taken_is_said():
    with (
        Server(port=0) as server,
        pytest.raises(ServerFailed, match=f"cannot listen at 127.0.0.1:{server.port}: "),
    ):
        Server(port=server.port).open()


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"port": 70000}, "`port` must be between 0 and 65535, got 70000."),
        ({"host": 1}, "`host` must be a text, got 1."),
        ({"max_clients": 0}, "`max_clients` must be a whole number >= 1, got 0."),
    ],
)
def test_bad_settings_are_refused(settings, message):
    with pytest.raises(ValueError) as caught:
        Server(**settings)
    assert str(caught.value) == message


def test_answers_are_single_lines_of_json_without_nan(connect):
    client = connect()
    client.stream.write(b'{"do":"run","duration":5,"series":["time"]}\n')
    client.stream.flush()
    line = client.stream.readline()
    assert b"NaN" not in line and line.count(b"\n") == 1
    assert len(json.loads(line)["series"]["time"]) == 101
