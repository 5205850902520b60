import json
import re
import signal
import socket
import sys
from subprocess import PIPE

import pytest
from patience import LONG, running

from laticauda.cli import main

PROGRAM = [
    sys.executable,
    "-c",
    "import sys; from laticauda.cli import main; sys.exit(main())",
    "serve",
]
EEL = 'kind = "robot"\nextends = "mamba"\nname = "eel"\n'


def serving(*words):
    return running([*PROGRAM, "--port", "0", *words], stdout=PIPE, stderr=PIPE)


def test_the_server_says_where_it_is_serves_and_ends_well_with_ctrl_c(tmp_path):
    (tmp_path / "eel.toml").write_text(EEL)
    with serving("--json", "--robots", str(tmp_path / "eel.toml")) as server:
        told = json.loads(server.stdout.readline())
        assert (told["host"], told["protocol"]) == ("127.0.0.1", 1)
        with socket.create_connection((told["host"], told["port"]), timeout=LONG) as wire:
            stream = wire.makefile("rwb")
            stream.write(b'{"do": "reset", "robot": "eel"}\n')
            stream.flush()
            assert json.loads(stream.readline())["robot"] == "eel"
            server.send_signal(signal.SIGINT)  # with a client that is still there
            assert server.wait(LONG) == 0
        assert server.stderr.read().endswith("stopped.\n")


def test_whoever_opens_the_server_to_others_is_warned():
    with serving("--host", "0.0.0.0") as server:
        line = server.stdout.readline()
        assert re.fullmatch(
            r"tcp 0\.0\.0\.0:\d+ \(token [\w-]{24}\) \| protocol 1 \| clients .*\n", line
        )
        server.send_signal(signal.SIGINT)
        assert server.wait(LONG) == 0
        told = server.stderr.read()
        assert (
            "Anyone who reaches 0.0.0.0 and has the token is served; nothing is encrypted" in told
        )
        assert line.split()[3].rstrip(")") not in told


def test_the_schema_of_the_messages_is_printed_and_nobody_is_served(capsys):
    assert main(["serve", "--schema"]) == 0
    assert json.loads(capsys.readouterr().out)["$defs"]["step"]["properties"]["do"] == {
        "const": "step"
    }


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--port", "70000"], "--port must be between 0 and 65535, got 70000."),
        (["--max-clients", "0"], "--max-clients must be a whole number >= 1, got 0."),
        (["--robots", "nofile.toml"], "nofile.toml: no such file"),
        (
            ["--robots", "folder/mamba.toml"],
            "--robots must have unique names, got folder/mamba.toml",
        ),
        (["--host", "nowhere.invalid"], "The server cannot listen at nowhere.invalid:5055: "),
    ],
)
def test_bad_input_is_said_in_the_words_of_the_command_line(words, message, capsys):
    assert main(["serve", *words]) == 2
    assert message in capsys.readouterr().err
