import json

import pytest
from lab_parts import make_tank
from patience import complaints

from laticauda.cli import main
from laticauda.tank.lab import BODY, Lab
from laticauda.tank.protocol import bus_address


@pytest.fixture(scope="module")
def addresses():
    with Lab(make_tank(), bus=bus_address("virtual:cli-drivers"), port=0) as found:
        yield found


def test_all_drivers_are_listed(capsys):
    assert main(["drivers", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {kind: names[0] for kind, names in found.items()} == {
        "bus": "can",
        "mocap": "qtm",
        "meter": "fluke",
        "stop": "serial-line",
        "sensors": "udp-readings",
    }


def test_one_driver_alone_is_tried_and_what_comes_is_told_with_its_rate_and_age(addresses, capsys):
    mocap = f"{addresses.mocap_host}:{addresses.mocap_port}"
    assert (
        main(["drivers", "--mocap", f"qtm@{mocap}", "--body", BODY, "--duration", "0.6", "--json"])
        == 0
    )
    (row,) = json.loads(capsys.readouterr().out)["heard"]
    assert row["what"] == "body"
    assert row["rate [1/s]"] == pytest.approx(row["count"] / 0.6)
    assert row["age [s]"] >= 0.0
    assert row["last"].startswith("PoseSample(")
    assert main(["drivers", "--bus", "virtual:cli-drivers", "--duration", "0.6"]) == 0
    out = capsys.readouterr().out
    assert "JointState of node 1 " in out
    assert "Heartbeat of node 18 " in out


def test_a_driver_to_which_nothing_comes_fails_and_one_that_cannot_be_is_refused(capsys):
    assert main(["drivers", "--bus", "virtual:nobody-is-here", "--duration", "0.1"]) == 1
    assert "No data." in capsys.readouterr().err
    for words, message in (
        (["--mocap", "127.0.0.1:1"], "The motion capture at 127.0.0.1:1 cannot be reached"),
        (["--mocap", "cameras@127.0.0.1:1"], "--mocap must be one of `qtm`"),
        (["--stop", "/dev/nothing"], "The emergency-stop input at /dev/nothing cannot be read"),
        (
            ["--bus", "virtual:a", "--meter", "b"],
            "--meter must not be given with --bus: drivers are tried one at a",
        ),
    ):
        assert main(["drivers", *words]) == 2
        assert message in capsys.readouterr().err


def test_our_drivers_keep_the_contract(addresses, monkeypatch):
    mocap = f"qtm@{addresses.mocap_host}:{addresses.mocap_port}"
    for kind, device, how in (
        (
            "bus",
            "can@virtual:cli-drivers",
            {"absent": "socketcan:nocan9", "duration": 1.0, "moves": True},
        ),
        ("mocap", mocap, {"absent": "127.0.0.1:1", "body": BODY, "duration": 0.3}),
        ("meter", f"fluke@{addresses.meter}", {"absent": "/dev/nothing", "duration": 0.5}),
    ):
        assert complaints(monkeypatch, kind, device, **how) == (), kind
