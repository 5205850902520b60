import json
import signal
import sys
from itertools import islice
from subprocess import PIPE

import pytest
from patience import LONG, running

from laticauda import load_trial
from laticauda.cli import main
from laticauda.cli.lab import Lab
from laticauda.robot import load_parameters, load_robot, load_water
from laticauda.tank.protocol import JointState, Sync, bus_address, from_frame, open_bus, to_frame
from laticauda.values import name_of

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
        assert (told["bus"], told["nodes"], told["qtm"][:10]) == (BUS, 8, "127.0.0.1:")
        assert told["robot"] == "mamba-fin as mamba-identified"
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
    assert out.endswith("| robot mamba-fin as mamba-identified | nodes 8 (this computer only)\n")


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
        (
            ["--parameters", "mamba-identified", "--water", "paper-eel"],
            "--parameters must not be given with --water: both define the water",
        ),
        (["--parameters", "nowhere"], "nowhere"),
        (["--gait", "galop"], "--gait must be one of"),
        (["--bus", "socketcan:nosuch0"], "The CAN bus socketcan:nosuch0 cannot be opened: "),
    ],
)
def test_bad_input_is_said_in_the_words_of_the_command_line(words, message, capsys):
    assert main(["lab", "--port", "0", *words] if "--port" not in words else ["lab", *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "parameters", "law"),
    [
        ([], "mamba-identified", "speed-servo"),
        (["--robot", "mamba"], "mamba-identified", "speed-servo"),
        (["--robot", "mamba-modules"], None, "servo"),
        (["--water", "paper-eel"], None, "servo"),
        (["--joints", "servo"], None, "servo"),
        (["--normal-drag", "1.5"], None, "servo"),
        (["--current", "0.05", "0"], "mamba-identified", "speed-servo"),
        (["--robot", "mamba", "--parameters", "mamba-textbook"], "mamba-textbook", "speed-servo"),
        (["--parameters", "paper"], "paper", "servo"),
        (["--parameters", "mamba-identified", "--joints", "servo"], "mamba-identified", "servo"),
    ],
)
def test_mamba_swims_as_identified_unless_something_else_is_chosen(words, parameters, law):
    command = Lab.read(words, "laticauda lab")
    assert command.body.parameters == parameters
    assert name_of(type(command.servos)) == law


def test_parameters_are_those_of_the_kind_of_gait():
    eel = Lab.read(["--parameters", "paper", "--gait", "eel-like"], "laticauda lab")
    lateral = Lab.read(["--parameters", "paper"], "laticauda lab")
    assert eel.coefficients.tangential_friction == load_water("paper-eel").tangential_friction
    assert (
        lateral.coefficients.tangential_friction == load_water("paper-lateral").tangential_friction
    )


def test_the_robot_in_the_tank_has_the_numbers_of_the_parameters():
    tank = Lab.read([], "laticauda lab")._tank()
    parameters = load_parameters("mamba-identified")
    assert tank.body.robot == parameters.robot(load_robot("mamba-fin"), "lateral_undulation")
    assert tank.body.plant.environment == parameters.every_gait
    assert tank.body.plant.settings.joints == parameters.joints


def test_a_mission_says_itself_what_swims(capsys):
    assert main(["lab", "--mission", "tank-inspection", "--robot", "mamba"]) == 2
    message = "--robot must not be given with --mission, which says it itself"
    assert message in " ".join(capsys.readouterr().err.split())


def test_the_robot_of_a_mission_has_its_sensors_with_seeds_of_their_own():
    command = Lab.read(["--mission", "tank-inspection", "--seed", "3"], "laticauda lab")
    tank = command._tank()
    assert set(tank.body.sensor_columns) >= {"sonar", "compass", "beacon"}
    assert {sensor.seed for sensor in tank.body.plant.settings.sensors} == {3}
    assert tank.body.start.center_of_mass == (1.0, 1.0)
