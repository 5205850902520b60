import json
import signal
import socket
import sys
import urllib.request
from subprocess import PIPE

import pytest
from patience import LONG, running

from laticauda.cli import main

pytest.importorskip("viser")


def started(*words):
    command = [
        sys.executable,
        "-c",
        "import sys; from laticauda.cli import main; sys.exit(main())",
        "cockpit",
    ]
    return running([*command, "--port", "0", *words], stdout=PIPE, stderr=PIPE)


def ended(process):
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=LONG)


def test_it_prints_one_line_with_its_address_and_serves_a_page_there():
    with started("--json") as process:
        address = json.loads(process.stdout.readline())["address"]
        assert address.startswith("http://127.0.0.1:")
        with urllib.request.urlopen(address, timeout=LONG) as answer:
            assert b"<html" in answer.read()
        out, err = ended(process)
    assert process.returncode == 0
    assert out == ""
    assert "Warning" not in err


def test_another_host_is_warned_of():
    with started("--host", "0.0.0.0") as process:
        assert process.stdout.readline().startswith("http://0.0.0.0:")
        assert "Anyone who reaches 0.0.0.0 and has the token is served" in ended(process)[1]


def test_a_port_that_is_taken_is_said(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert main(["cockpit", "--port", str(port)]) == 2
    assert (
        f"Cannot serve the cockpit at 127.0.0.1:{port}: address already in use"
        in capsys.readouterr().err
    )


def test_a_port_that_cannot_be_is_refused(capsys):
    assert main(["cockpit", "--port", "70000"]) == 2
    assert "must be between 0 and 65535, got 70000" in capsys.readouterr().err


def test_a_recording_that_is_not_there_yet_is_waited_for_and_the_page_is_served(tmp_path):
    with started("--operated", tmp_path) as process:
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        ended(process)
    assert process.returncode == 0


def test_what_cannot_be_loaded_is_said_before_a_page_is_served(capsys):
    assert main(["cockpit", "--port", "0", "--load", "nothing.nc"]) == 2
    said = capsys.readouterr()
    assert "Cannot load nothing.nc: there is no such file." in said.err
    assert "http" not in said.out
