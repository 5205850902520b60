import json
import signal
import sys
from itertools import islice
from subprocess import PIPE

import pytest
from patience import LONG, running

from laticauda import load_trial
from laticauda.cli import main
from laticauda.tank.protocol import JointState, Sync, bus_address, from_frame, open_bus, to_frame

PROGRAM = [
    sys.executable,
    "-c",
    "import sys; from laticauda.cli import main; sys.exit(main())",
    "lab",
]
BUS = "udp_multicast:239.74.163.97:43196"


def test_the_lab_says_where_it_is_serves_obeys_a_line_and_ends_with_ctrl_c(tmp_path):
    words = [
        *PROGRAM,
        "--json",
        "--bus",
        BUS,
        "--port",
        "0",
        "--speed",
        "4",
        "--save",
        str(tmp_path / "truth.nc"),
    ]
    with running(words, stdin=PIPE, stdout=PIPE, stderr=PIPE) as lab:
        assert lab.stdout is not None and lab.stdin is not None and lab.stderr is not None
        told = json.loads(lab.stdout.readline())
        assert (told["bus"], told["nodes"], told["qtm"][:10]) == (BUS, 18, "127.0.0.1:")
        with open_bus(bus_address(BUS)) as bus:
            for _ in range(100):
                bus.send(to_frame(Sync(counter=1)))
                heard = islice(iter(lambda: bus.recv(0.05), None), 200)  # heartbeats never end
                found = [from_frame(frame) for frame in heard]
                if any(isinstance(message, JointState) for message in found):
                    break
            else:
                pytest.fail("no node answered")
        lab.stdin.write("carry 1 2 90\n")
        lab.stdin.flush()
        while "the robot lies straight at 1 2 m, heading 90 deg" not in (
            line := lab.stderr.readline()
        ):
            assert line
        lab.send_signal(signal.SIGINT)
        assert lab.wait(LONG) == 0
    trial = load_trial(tmp_path / "truth.nc")
    assert trial.center_of_mass[0] == pytest.approx([1.0, 2.0])


def test_a_lab_with_an_end_ends(capsys):
    words = [
        "lab",
        "--bus",
        "udp_multicast:239.74.163.96:43195",
        "--port",
        "0",
        "--duration",
        "0.3",
    ]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert out.startswith("bus udp_multicast:239.74.163.96:43195 | qtm 127.0.0.1:")
    assert out.endswith("| nodes 18 (this computer only)\n")


def test_whoever_opens_the_lab_to_others_is_warned(capsys):
    words = [
        "lab",
        "--bus",
        "udp_multicast:239.74.163.95:43194",
        "--hops",
        "1",
        "--host",
        "0.0.0.0",
        "--port",
        "0",
    ]
    assert main([*words, "--duration", "0.1"]) == 0
    captured = capsys.readouterr()
    assert (
        "Anyone who reaches 0.0.0.0 can read the cameras: the protocol has no passwords."
        in captured.err
    )
    assert "can move the robot: a CAN bus has no passwords." in captured.err
    assert "this computer only" not in captured.out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["--bus", "virtual:x"],
            "--bus must be udp_multicast or socketcan, which other processes reach, got virtual:x.",
        ),
        (["--port", "70000"], "--port must be between 0 and 65535, got 70000."),
        (["--speed", "0"], "--speed must be > 0, got 0"),
        (["--position", "1"], "Missing value for argument '--position'. Expected 2 values."),
        (["--faults", "nowhere.toml"], "nowhere.toml: no such file"),
        (["--bus", "socketcan:nosuch0"], "The CAN bus socketcan:nosuch0 cannot be opened: "),
    ],
)
def test_bad_input_is_said_in_the_words_of_the_command_line(words, message, capsys):
    assert main(["lab", "--port", "0", *words] if "--port" not in words else ["lab", *words]) == 2
    assert message in capsys.readouterr().err
