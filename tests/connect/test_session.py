import json
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect import Session
from laticauda.connect.budget import Budget
from laticauda.connect.decoding import read_scenario
from laticauda.models.simulate import build_plant
from laticauda.motion.gaits.gait import FIRST_GAIT
from laticauda.robot import Current, Thruster
from laticauda.scenarios.interfaces import Command, Start
from laticauda.sensing import Compass, Net, Sonar
from laticauda.values.codec import decode, encode
from laticauda.water.fluid.laws import PolynomialDrag


@pytest.fixture
def ask():
    session = Session({"mine": lc.load_robot("chain", 5)})

    def ask(request, **fields):
        return json.loads(session.answer(json.dumps({"do": request, **fields}).encode()))

    return ask


def test_steps_are_those_of_the_plant_bit_for_bit(ask):
    ask("reset", robot="mamba-fin", joints="servo", center_of_mass=[1.0, 2.0], heading=0.3)
    body = build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"), joints="servo")
    state = body.init(Start(center_of_mass=(1.0, 2.0), heading=0.3), Command(gait=FIRST_GAIT))
    for offset in (0.0, 0.1, 0.2):
        state = body.step(state, Command(gait=FIRST_GAIT, offset=offset), 0.05)
        seen = ask("step", duration=0.05, offset=offset)["observation"]
        expected = body.observe(state)
        for field in fields(expected):
            value = getattr(expected, field.name)
            np.testing.assert_array_equal(seen[field.name], value, err_msg=field.name)


def test_a_run_has_the_figures_and_the_series_of_swim(ask):
    trial = lc.swim(lc.load_robot("mamba"), FIRST_GAIT, duration=10.0)
    reply = ask("run", duration=10.0, series=["time", "joint_torque", "electrical_work"])
    assert reply["figures"] == trial.summary()
    assert set(reply["series"]) == {"time", "joint_torque"}  # prescribed joints have no power model
    np.testing.assert_array_equal(reply["series"]["joint_torque"], trial.joint_torque)


def test_a_whole_run_tells_what_the_joints_carry_if_asked(ask):
    reply = ask("run", duration=2.0, series=["time", "joint_force", "water_force"])
    series = {name: np.array(values) for name, values in reply["series"].items()}
    n_samples = series["time"].size
    assert series["joint_force"].shape == (n_samples, 8, 3)
    assert series["water_force"].shape == (n_samples, 9, 3)


def test_gauges_of_a_world_tell_what_its_joints_carry(ask):
    gauge = {"kind": "strain-gauge", "joints": [3], "moment_noise": 0.0, "moment_zero_error": 0.0}
    ask("reset", joints="servo", sensors=[gauge])
    answer = ask("step", duration=1.0)
    moment_up = answer["observation"]["readings"]["load"]["values"][5]
    assert moment_up == pytest.approx(answer["joint_torque"][3], abs=1e-9)


def test_sensors_of_a_world_tell_what_they_tell_in_python(ask):
    places = [{"kind": "net", "name": "pen", "center": [4.0, 0.0], "radius": 1.6}]
    sensors = [{"kind": "sonar", "beams_deg": [-30, 0, 30]}, {"kind": "compass", "latency": 0.2}]
    begin = ask("reset", joints="servo", sensors=sensors, places=places)["observation"]
    assert begin["readings"]["compass"] == {"time": None, "values": [None], "is_new": False}
    for _ in range(4):
        seen = ask("step", duration=0.1)["observation"]
    trial = lc.swim(
        "mamba",
        lc.OpenLoop(command=Command(gait=FIRST_GAIT), interval=0.1),
        0.5,
        joints="servo",
        sensors=(Sonar(beams_deg=(-30, 0, 30)), Compass(latency=0.2)),
        places=(Net(name="pen", center=(4.0, 0.0), radius=1.6),),
    )
    assert seen["readings"]["compass"]["time"] == pytest.approx(0.2)
    assert seen["readings"]["compass"]["values"][0] == trial.signals["compass_heading"][-1]
    ranges = [trial.signals[f"sonar_range_{k}"][-1] for k in range(3)]
    without_nan = [None if np.isnan(distance) else distance for distance in ranges]
    assert seen["readings"]["sonar"]["values"] == without_nan
    assert ask("get")["observation"]["readings"] == seen["readings"]


def test_two_sensors_of_one_name_are_refused_and_nothing_changes(ask):
    ask("reset")
    sensors = [{"kind": "compass"}, {"kind": "compass"}]
    reply = ask("reset", sensors=sensors)
    assert "must have different names, got `compass` twice" in reply["error"]
    assert ask("get")["observation"]["readings"] == {}


def test_what_a_message_leaves_out_stays_as_it_is(ask):
    ask("reset", gait={"amplitude": 0.2}, offset=0.1)
    command = ask("set", gait={"frequency": 3.0}, current=[0.1, 0.0])["command"]
    assert (command["gait"]["amplitude"], command["gait"]["frequency"], command["offset"]) == (
        0.2,
        3.0,
        0.1,
    )
    assert command["current"] == [0.1, 0.0]
    assert ask("get")["command"] == command


def test_joints_follow_references_from_outside_until_they_are_taken_back(ask):
    ask("reset", joints="servo")
    held = ask("step", duration=3.0, references=[0.1] * 8)
    assert held["joint_angle_ref"] == pytest.approx([0.1] * 8)
    assert held["observation"]["joint_angle"] == pytest.approx([0.1] * 8, abs=0.02)
    assert ask("step", duration=0.05, references=None)["joint_angle_ref"] != held["joint_angle_ref"]


def test_a_motor_that_is_off_follows_nothing(ask):
    ask("reset", joints="servo")
    angle = ask("step", duration=1.0, references=[0.3] * 8, enabled=[False] * 8)["observation"][
        "joint_angle"
    ]
    assert angle == pytest.approx([0.0] * 8, abs=1e-9)


def test_a_current_sweeps_the_robot_along_from_where_it_is(ask):
    ask("reset", gait={"amplitude": 0.0}, center_of_mass=[1.0, 0.0])
    assert ask("step", duration=1.0)["observation"]["center_of_mass"] == pytest.approx([1.0, 0.0])
    swept = ask("step", duration=60.0, current=[0.0, 0.1])["observation"]
    assert swept["time"] == pytest.approx(61.0)
    assert swept["center_of_mass_velocity"] == pytest.approx([0.0, 0.1], abs=2e-3)
    assert swept["center_of_mass"][1] > 4.0


def test_the_log_has_every_sample_once_and_can_be_read_from_a_moment_on(ask):
    ask("reset", sample_interval=0.1)
    for duration in (0.2, 0.05, 0.5):
        ask("step", duration=duration)
    times = [0.0, 0.1, 0.2, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75]
    assert ask("get", series="time")["series"]["time"] == pytest.approx(times)
    reply = ask("get", series=["time", "work"], since=0.5)
    assert reply["series"]["time"] == pytest.approx(times[-3:])
    assert np.shape(reply["series"]["work"]) == (3, 3)
    assert reply["dropped"] == 0


def test_a_log_that_is_too_long_loses_its_oldest_samples_and_says_how_many(ask, monkeypatch):
    monkeypatch.setattr("laticauda.connect.history.MOST_SAMPLES", 20)
    ask("reset")
    for _ in range(50):
        ask("step", duration=0.05)
    reply = ask("get", series=["time"])
    assert len(reply["series"]["time"]) + reply["dropped"] == 51
    assert reply["series"]["time"][-1] == pytest.approx(2.5)
    assert len(reply["series"]["time"]) <= 20


def budgeted(**room):
    session = Session(budget=Budget(**room).share_among(4))
    return lambda request, **fields: json.loads(
        session.answer(json.dumps({"do": request, **fields}).encode())
    )


def test_a_log_and_a_request_have_a_clients_part_of_the_numbers_of_all():
    ask = budgeted(max_logged=4 * 51 * 10)  # ten samples of nine links
    ask("reset")
    for _ in range(50):
        ask("step", duration=0.05)
    reply = ask("get", series=["time"])
    assert 5 <= len(reply["series"]["time"]) <= 10
    assert len(reply["series"]["time"]) + reply["dropped"] == 51
    for request in ("step", "run"):
        assert (
            "s at a `sample_interval` of 0.05 s for 9 links, got 2."
            in ask(request, duration=2.0)["error"]
        )


def test_an_answer_has_a_clients_part_of_the_numbers_of_all():
    ask = budgeted(max_answered=400)
    assert (
        ask("run", series=["time"])["error"]
        == "`series` must hold 100 numbers or fewer in one answer, got 601."
    )


def test_what_is_large_waits_for_its_turn_and_what_is_small_does_not():
    budget = Budget().share_among(4)
    session, answers = Session(budget=budget), []

    def ask(**fields):
        answers.append(json.loads(session.answer(json.dumps(fields).encode())))

    ask(do="reset")
    large = threading.Thread(target=ask, kwargs={"do": "step", "duration": 200.0})
    with budget.lock:
        ask(do="step", duration=0.1)
        large.start()
        large.join(0.3)
        assert large.is_alive() and len(answers) == 2
    large.join(30.0)
    assert answers[-1]["observation"]["time"] == pytest.approx(200.1)


def test_a_current_of_one_kind_too_many_is_refused_and_changes_nothing(monkeypatch):
    monkeypatch.setattr("laticauda.connect.budget.MOST_KINDS", 0)
    ask = budgeted()
    before = ask("reset")
    for request in ("reset", "set"):
        assert ask(request, current="vortex")["error"].startswith(
            "`current` must be of a kind that this server has"
        )
    assert ask("get")["observation"] == before["observation"]


def test_parameters_bring_their_water_their_robot_and_their_joint_law(ask):
    parameters = lc.load_parameters("mamba-identified")
    about = ask("reset", parameters="mamba-identified", gait={"kind": "eel-like"})
    assert about["settings"]["joints"] == "speed-servo"
    figures = ask("run", duration=5.0, parameters="mamba-identified", gait={"kind": "eel-like"})[
        "figures"
    ]
    assert figures["environment"] == parameters.water("eel_like").name


def test_a_robot_of_the_servers_own_and_another_number_of_links(ask):
    assert ask("reset", robot="mine")["n_links"] == 5
    assert ask("reset", robot="mine", n_links=7)["n_links"] == 7
    assert ask("reset", robot="chain", n_links=3)["n_joints"] == 2


def test_one_number_is_as_good_as_an_array_of_one(ask):
    ask("reset", robot="chain", n_links=2, joints="pd")
    assert ask("step", duration=0.01, references=0.1, enabled=True)[
        "joint_angle_ref"
    ] == pytest.approx([0.1])


def test_the_spatial_model_steps_and_keeps_its_place_when_the_current_changes(ask):
    pytest.importorskip("mujoco")
    ask("reset", model="spatial", center_of_mass=[1.0, 2.0])
    before = ask("step", duration=0.1)["observation"]
    after = ask("step", duration=0.01, current=[0.1, 0.0])["observation"]
    assert after["center_of_mass"] == pytest.approx(before["center_of_mass"], abs=2e-3)
    assert after["time"] == pytest.approx(0.11)


def test_spatial_worlds_move_at_the_same_time_and_each_as_if_alone():
    pytest.importorskip("mujoco")

    def places(offset):
        session = Session()
        session.answer(json.dumps({"do": "reset", "model": "spatial", "offset": offset}).encode())
        step = json.dumps({"do": "step", "duration": 0.3}).encode()
        return [json.loads(session.answer(step))["observation"]["center_of_mass"] for _ in range(5)]

    offsets = (0.0, 0.1, 0.2)
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(places, offsets)) == [places(offset) for offset in offsets]


def test_a_world_in_space_starts_at_depth_and_drifts_upward(ask):
    pytest.importorskip("mujoco")
    ask("reset", model="spatial", root="free", gait={"amplitude": 0.0}, depth=2.0, pitch=0.1)
    risen = ask("step", duration=5.0, current=[0.0, 0.0, 0.1])["observation"]
    assert risen["center_of_mass_velocity"][2] > 0.02
    assert "`start.depth` must" in ask("reset", depth=2.0)["error"]


def test_thrusters_do_what_a_message_says_until_it_is_taken_back():
    thruster = Thruster(link=0, thrust=0.0, max_thrust=3.0)
    session = Session({"pushed": replace(lc.load_robot("chain", 3), thrusters=(thruster,))})

    def speed(**fields):
        answer = json.loads(
            session.answer(json.dumps({"do": "step", "duration": 4.0, **fields}).encode())
        )
        return answer["observation"]["center_of_mass_velocity"][0]

    session.answer(
        json.dumps({"do": "reset", "robot": "pushed", "gait": {"amplitude": 0.0}}).encode()
    )
    assert speed() == pytest.approx(0.0, abs=1e-9)
    fast = speed(thrusts=2.0)
    assert fast > 0.1
    assert speed(thrusts=[]) < fast


def test_a_current_may_be_a_flow_as_a_table_or_by_the_name_of_a_preset(ask):
    gusts = replace(lc.load_current("turbulence"), modes=6)
    assert "error" not in ask("reset", robot="mamba", current=encode(gusts, Current))
    assert decode(Current, ask("get")["command"]["current"]) == gusts
    ask("step", duration=0.5)
    other = {"kind": "turbulence", "modes": 6, "mean": [0.2, 0, 0], "seed": 9}
    assert ask("set", current=other)["command"]["current"]["seed"] == 9
    seen = ask("step", duration=0.5)["observation"]
    water, state = lc.load_water("paper-lateral"), None
    for flow in (gusts, decode(Current, other)):
        body = build_plant(lc.load_robot("mamba"), replace(water, current=flow))
        state = body.step(
            state or body.init(Start(), Command(gait=FIRST_GAIT)), Command(gait=FIRST_GAIT), 0.5
        )
    assert seen["center_of_mass"] == body.observe(state).center_of_mass.tolist()
    assert sum(name.startswith("current") for name in seen) == 0
    named = read_scenario({"robot": "mamba", "current": "vortex"}, {})
    assert named.environment == replace(water, current=lc.load_current("vortex"))


@pytest.mark.usefixtures("limit_case")
def test_a_robot_that_flies_apart_says_so_until_it_is_reset(ask):
    ask(
        "reset",
        joints="pd",
        dt=0.5,
        coefficients={"normal_drag": 50.0, "tangential_friction": 50.0},
    )
    assert "diverged at t = " in ask("step", duration=50.0)["error"]
    assert ask("step", duration=0.1)["error"].endswith("`reset` starts again.")
    assert "error" not in ask("reset")
    assert "error" not in ask("step", duration=0.1)


@pytest.mark.parametrize(
    ("request_", "fields", "message"),
    [
        ("stop", {}, "`do` must be one of `reset`, `step`, `set`, `get`, `run`, got 'stop'"),
        ("get", {"protocol": 2}, "`protocol` must be 1, the server's version, got 2."),
        ("step", {}, "`duration` must be a number in s, got None."),
        ("step", {"duration": 0}, "`duration` must be > 0 s, got 0."),
        (
            "step",
            {"duration": 1e4},
            "`duration` must be <= 5000 s at a `sample_interval` of 0.05 s for 9 links, got 10000.",
        ),
        ("step", {"duration": 1, "ofset": 1}, "`ofset` is not known; did you mean `offset`?"),
        ("step", {"duration": 1, "offset": "x"}, "`offset` must be a number in rad, got 'x'."),
        (
            "step",
            {"duration": 1, "references": [0.1]},
            "`references` must be None for prescribed joints",
        ),
        ("set", {"references": [0.1]}, "`references` must be None for prescribed joints"),
        ("set", {"enabled": [1]}, "`enabled[0]` must be true or false, got 1."),
        (
            "set",
            {"current": [0.1]},
            "`current` must be two or three numbers in m/s or a Flow, got 1 of them.",
        ),
        ("set", {"current": "vortx"}, "got 'vortx'; did you mean `vortex`?"),
        ("set", {"current": "../mine.toml"}, "`current` must be one of "),
        (
            "set",
            {"current": {"kind": "sum", "flows": [{"source": "/etc/x.nc"}]}},
            "`current` must not name a file: ",
        ),
        (
            "reset",
            {"coefficients": {"current": {"source": "x.nc"}}},
            "`current` must not name a file: ",
        ),
        ("set", {"current": {"kind": "vortex"}}, "`current.kind` must be one of "),
        (
            "set",
            {"current": {"kind": "turbulence", "modes": 0}},
            "`current.modes` must be a whole number >= 1, got 0",
        ),
        (
            "run",
            {"current": {"kind": "turbulence", "modes": 1000}, "dt": 1e-4},
            "in a current of 1000 parts",
        ),
        ("set", {"gait": 3}, "`gait` must be a table, got 3."),
        (
            "set",
            {"gait": {"amplitude": -1}},
            "`gait.amplitude` must be between 0 and 3.14159 rad, got -1.",
        ),
        (
            "set",
            {"gait": {"amplitud": 1}},
            "`gait.amplitud` is not known; did you mean `amplitude`?",
        ),
        (
            "set",
            {"gait": {"fin": {"amplitude": 0.1}}},
            "`gait.fin` must be None unless the fin is driven",
        ),
        ("get", {"series": ["joint_torqe"]}, "`series` must be one of `time`, `center_of_mass`"),
        ("get", {"series": [1]}, "`series` must be an array of names, got [1]."),
        ("run", {"series": ["robot"]}, "`series` must be one of `time`, `center_of_mass`"),
        ("run", {"dt": 1e-7}, "in one request for 9 links and steps of 1e-07 s, got 30."),
        ("reset", {"robot": "/etc/passwd"}, "`robot` must be one of `amphibot`, `chain`, `mamba`"),
        ("reset", {"water": "../secret.toml"}, "`water` must be one of "),
        (
            "reset",
            {"robot": "chain", "n_links": 10**6},
            "`n_links` must be between 1 and 200, got 1000000.",
        ),
        ("reset", {"coefficients": {"drag": 1}}, "`drag` must be a table, got 1"),
        ("reset", {"coefficients": {"normal_drag": -1}}, "`normal_drag` must be >= 0, got -1."),
        (
            "reset",
            {"parameters": "mamba-identified", "water": "paper-eel"},
            "`parameters` must not be given with",
        ),
        ("reset", {"ground": "viscous", "current": [0, 1]}, "`ground` must not be given with"),
        (
            "reset",
            {"center_of_mass": [1, 2, 3]},
            "`center_of_mass` must be two numbers in m, got 3 of them.",
        ),
        (
            "reset",
            {"joints": "servos"},
            "`joints` must be one of `prescribed`, `pd`, `servo`, `ekeberg`, `hill`, `speed-servo`, got 'servos'",
        ),
    ],
)
def test_what_is_wrong_is_said_and_changes_nothing(ask, request_, fields, message):
    ask("reset")
    before = ask("get")
    assert message in ask(request_, **fields)["error"]
    assert ask("get") == before


@pytest.mark.parametrize("request_", ["step", "set", "get"])
def test_a_world_must_be_there_first(ask, request_):
    fields = {"duration": 1.0} if request_ == "step" else {}
    assert ask(request_, **fields)["error"].startswith("`reset` must come before this request")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (b"hello", "A message must be one line of JSON; it is not: Expecting value"),
        (b"\xff\xfe", "got bytes that are not text."),
        (b"[1, 2]", "A message must be a JSON object with the field `do`, got list."),
        (
            b"[" * 500_000,
            "A message must be one line of JSON, got brackets that are nested too deeply.",
        ),
        (b'{"do": "get", "id": NaN}', "A message must hold finite numbers only, got NaN."),
        (b'{"do": "get", "id": 1e999}', "A message must hold finite numbers only, got 1e999."),
        (b'{"do": "get", "id": ' + b"9" * 10_000 + b"}", "Exceeds the limit"),
        (b'{"do": ["get"]}', "`do` must be one of"),
    ],
)
def test_rubbish_is_answered(line, message):
    reply = json.loads(Session().answer(line))
    assert message in reply["error"]


def test_an_answer_repeats_the_requests_id_also_with_an_error(ask):
    assert ask("reset", id="a")["id"] == "a"
    assert ask("step", id=7)["id"] == 7


def test_an_answer_that_would_be_too_long_is_refused(monkeypatch):
    monkeypatch.setattr("laticauda.connect.budget.MOST_NUMBERS", 100)
    reply = Session().answer(b'{"do": "run", "series": ["time"]}')
    assert b"`series` must hold 100 numbers or fewer in one answer, got 601." in reply


def test_numbers_of_the_drag_law_may_be_given_one_by_one_also_under_their_older_names():
    law = PolynomialDrag(reference_speed=0.7)
    for given in ({"reference_speed": 0.7}, {"drag": {"reference_speed": 0.7}}):
        scenario = read_scenario({"water": "paper-lateral", "coefficients": given}, {})
        assert scenario.environment == replace(lc.load_water("paper-lateral"), drag=law)


@pytest.mark.parametrize(
    ("gait", "rule"),
    [
        (
            {"kind": 3},
            "`gait.envelope.kind` must be one of `lateral-undulation`, `eel-like`, `anguilliform`, `custom`, got '3'.",
        ),
        ({"envelope": 0.1}, "`gait.envelope` must be a table, got 0.1."),
    ],
)
def test_a_gait_that_is_none_is_refused_by_name(ask, gait, rule):
    ask("reset")
    assert ask("step", duration=0.1, gait=gait)["error"] == rule
