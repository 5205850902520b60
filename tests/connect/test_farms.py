"""An animat of FARMS becomes a robot, a network and a joint law; MuJoCo and FARMS's own equations confirm it.

The eel of data/farms was made up for these tests, once as SDF and once, by hand, as MJCF.
"""

import json
import math
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from campaign_scripts import campaign

import laticauda as lc
from laticauda.cli import main
from laticauda.connect import FarmsAnimat, load_farms
from laticauda.control import PhaseOscillators
from laticauda.motion.joints import Ekeberg, Servo
from laticauda.values import RobotFileError

EEL = Path(__file__).parent.parent / "data" / "farms" / "eel.sdf"
JOINTS = ["neck", "waist", "peduncle"]
"""Joints of the spine, head first as in FARMS."""
LAG = 0.9
"""Phase bias from joint to joint [rad]."""


def oscillator(name: str, amplitude_gain: float) -> dict[str, Any]:
    numbers: dict[str, Any] = {"name": name, "initial_phase": 1.0, "initial_amplitude": 0.0}
    for prefix, gain in (("frequency_", 1.5), ("amplitude_", amplitude_gain)):
        numbers |= {f"{prefix}gain": gain, f"{prefix}bias": 0.0}
        numbers |= {f"{prefix}low": 1, f"{prefix}high": 5}
        numbers |= {f"{prefix}saturation_low": 0, f"{prefix}saturation_high": 0}
    return numbers | {"rate": 8.0, "modular_phase": 0.0, "modular_amplitude": 0.0}


def coupling(pulled: str, pulling: str, bias: float) -> dict[str, Any]:
    return {"in": pulled, "out": pulling, "type": "OSC2OSC", "weight": 25.0, "phase_bias": bias}


def animat_table() -> dict[str, Any]:
    """Return an animat as FARMS describes it, whose amplitudes grow toward the tail."""
    sides = [f"osc_{i}_{side}" for i in range(3) for side in "LR"]
    couplings = [
        coupling(f"osc_{i}_{a}", f"osc_{i}_{b}", math.pi) for i in range(3) for a, b in ("LR", "RL")
    ]
    for i in range(2):
        for side in "LR":
            head, tail = f"osc_{i}_{side}", f"osc_{i + 1}_{side}"
            couplings += [coupling(tail, head, LAG), coupling(head, tail, math.tau - LAG)]
    motor = {
        "equation": "position_muscle",
        "control_types": ["position"],
        "limits_torque": [-4.0, 4.0],
        "gains": [6.0, 0.02, 0],
        "transform": {"gain": 1, "bias": 0},
        "offsets": {"gain": 0.05, "bias": 0, "low": 1, "high": 5},
    }
    muscle = {"alpha": 0.5, "beta": 1.5, "gamma": 0.2, "delta": 0.01, "epsilon": 0}
    return {
        "sdf": EEL.name,
        "morphology": {
            "n_joints_body": 3,
            "joints": [{"name": name} for name in [*JOINTS, "hip_left", "hip_right"]],
            "links": [
                {"name": name, "drag_coefficients": [[-0.2, -1.5, -1.8], [0, 0, 0]]}
                for name in ("skull", "trunk_1", "trunk_2", "tail")
            ],
        },
        "control": {
            "sensors": {"links": ["skull"], "contacts": ["tail"]},
            "motors": [{"joint_name": name} | motor for name in JOINTS],
            "muscles": [
                {"joint_name": name, "osc1": f"osc_{i}_L", "osc2": f"osc_{i}_R"} | muscle
                for i, name in enumerate(JOINTS)
            ],
            "network": {
                "drives": [{"name": side, "initial_value": 3.0} for side in ("left", "right")],
                "oscillators": [oscillator(name, 0.1 + 0.02 * int(name[4])) for name in sides],
                "osc2osc": couplings,
                "drive2osc": [
                    {"drive": {"L": "left", "R": "right"}[name[-1]], "oscillator": name}
                    for name in sides
                ],
                "drive2joint": [
                    {"drive0": "left", "drive1": "right", "joint": name} for name in JOINTS
                ],
            },
        },
    }


def write_animat(folder: Path, table: dict[str, Any]) -> Path:
    (folder / EEL.name).write_text(EEL.read_text())
    file = folder / "animat_config.yaml"
    file.write_text(yaml.dump(table, sort_keys=False))
    return file


@pytest.fixture
def table() -> dict[str, Any]:
    return animat_table()


@pytest.fixture(scope="module")
def animat(tmp_path_factory: pytest.TempPathFactory) -> FarmsAnimat:
    return load_farms(write_animat(tmp_path_factory.mktemp("animat"), animat_table()))


def network_of(animat: FarmsAnimat) -> PhaseOscillators:
    assert animat.network is not None
    return animat.network


# ---- morphology ----------------------------------------------------------------------------------


def test_masses_and_lengths_are_those_that_mujoco_finds_in_the_same_eel(animat: FarmsAnimat):
    model: Any = mujoco.MjModel.from_xml_path(str(EEL.with_suffix(".xml")))
    data: Any = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    legs = sum(model.body(name).mass[0] for name in ("leg_left", "leg_right"))
    whole = model.body_subtreemass[model.body("skull").id]
    assert animat.robot.mass == pytest.approx(whole - legs, rel=1e-6)
    anchors = [data.xanchor[model.joint(name).id] for name in JOINTS]
    between = [np.linalg.norm(a - b) for a, b in pairwise(anchors)]
    lengths = [module.length for module in animat.robot.modules]
    assert lengths[1:-1] == pytest.approx(between[::-1], rel=1e-9)
    nose, fin_end = 0.30 + 0.05 + 0.03 + 0.02, -0.02
    assert animat.robot.length == pytest.approx(nose - fin_end, rel=1e-9)


def test_sdf_and_mjcf_of_the_same_eel_are_the_same_robot():
    from_sdf = load_farms(EEL).robot
    from_mjcf = load_farms(EEL.with_suffix(".xml")).robot
    assert from_sdf.joints == from_mjcf.joints
    for ours, theirs in zip(from_sdf.modules, from_mjcf.modules, strict=True):
        for field in ("length", "mass", "center", "inertia"):
            assert getattr(ours, field) == pytest.approx(getattr(theirs, field), abs=1e-8), field
        assert ours.section.half_width == pytest.approx(theirs.section.half_width)
        assert ours.section.half_height == pytest.approx(theirs.section.half_height)


def test_modules_are_tail_first_and_carry_what_is_fixed_to_them(animat: FarmsAnimat):
    assert animat.links == ("tail", "trunk_2", "trunk_1", "skull")
    assert animat.joint_names == ("peduncle", "waist", "neck")
    assert [module.mass for module in animat.robot.modules] == pytest.approx(
        [0.06, 0.14, 0.19, 0.12]
    )
    limits = [joint.limit for joint in animat.robot.joints]
    assert limits == [1.0, 0.8, 0.9]
    assert animat.robot.joints[1].damping == 0.003
    skull = animat.robot.modules[-1].section
    assert (skull.half_width, skull.half_height, skull.shape) == pytest.approx(
        (0.02, 0.02, "ellipse")
    )
    trunk = animat.robot.modules[2].section
    assert (trunk.half_width, trunk.half_height, trunk.shape) == pytest.approx((0.025, 0.02, "box"))


def test_without_shapes_sections_follow_from_moments_of_inertia(tmp_path: Path):
    a, b, length, mass = 0.02, 0.03, 0.1, 0.25
    moments = {
        "ixx": mass * (a**2 + b**2) / 4,
        "iyy": mass * (a**2 / 4 + length**2 / 12),
        "izz": mass * (b**2 / 4 + length**2 / 12),
    }
    text = EEL.read_text()
    start, end = text.index('<link name="trunk_1">'), text.index('<link name="hinge_frame">')
    link = "<link name='trunk_1'><pose>0.25 0 0 0 0 0</pose><inertial><mass>0.25</mass><inertia>"
    link += "".join(f"<{name}>{moment}</{name}>" for name, moment in moments.items())
    link += "</inertia></inertial></link>"
    text = text[:start] + link + text[end:]
    text = text.replace(
        "<child>trunk_1</child>", "<child>trunk_1</child><pose>0.05 0 0 0 0 0</pose>"
    )
    file = tmp_path / "bare.sdf"
    file.write_text(text)
    section = load_farms(file).robot.modules[2].section
    assert (section.half_height, section.half_width) == pytest.approx((a, b))


@pytest.mark.parametrize("ending", ["obj", "stl"])
def test_meshes_say_how_far_head_and_tail_reach(tmp_path: Path, ending: str):
    vertices = np.array([[0.0, 0.5, 0.0], [0.0, -0.5, 0.0], [1.3, 0.0, 0.2]])
    mesh = tmp_path / f"skull.{ending}"
    if ending == "obj":
        lines = [f"v {' '.join(map(str, vertex))}" for vertex in vertices.tolist()]
        mesh.write_text("# a skull\n" + "\n".join(lines) + "\nf 1 2 3\n")
    else:
        triangle = np.vstack([np.zeros(3), vertices]).astype("<f4").tobytes() + b"\0\0"
        mesh.write_bytes(bytes(80) + (1).to_bytes(4, "little") + triangle)
    text = EEL.read_text()
    start, end = text.index('<collision name="skull_shape">'), text.index("</link>")
    uri = f"<mesh><uri>{mesh.name}</uri><scale>0.1 0.1 0.1</scale></mesh>"
    shape = f"<collision name='skull_shape'><geometry>{uri}</geometry></collision>"
    file = tmp_path / "eel.sdf"
    file.write_text(text[:start] + shape + text[end:])
    assert load_farms(file).robot.modules[-1].length == pytest.approx(0.13)
    mesh.unlink()
    animat = load_farms(file)
    assert animat.robot.modules[-1].length == pytest.approx(2 * 0.04)
    assert f"mesh {mesh.name}: no OBJ or binary STL file that can be read" in animat.left_out


# ---- network -------------------------------------------------------------------------------------


def integrate_farms(table: dict[str, Any], duration: float, dt: float) -> np.ndarray:
    """Return the joint angles that FARMS's own equations command, tail first, at every step [rad]."""
    network = table["control"]["network"]
    names = [one["name"] for one in network["oscillators"]]
    drive = network["drives"][0]["initial_value"]
    omega = np.array([one["frequency_gain"] * drive for one in network["oscillators"]])
    nominal = np.array([one["amplitude_gain"] * drive for one in network["oscillators"]])
    theta = np.random.default_rng(4).uniform(0.0, math.tau, len(names))
    amplitude = np.zeros(len(names))
    pulled = [names.index(one["in"]) for one in network["osc2osc"]]
    pulling = [names.index(one["out"]) for one in network["osc2osc"]]
    weight = np.array([one["weight"] for one in network["osc2osc"]])
    bias = np.array([one["phase_bias"] for one in network["osc2osc"]])
    angles: list[np.ndarray] = []
    for _ in range(round(duration / dt)):
        rate = omega.copy()
        pull = amplitude[pulling] * weight * np.sin(theta[pulling] - theta[pulled] - bias)
        np.add.at(rate, pulled, pull)
        theta = theta + dt * rate
        amplitude = amplitude + dt * 8.0 * (nominal - amplitude)
        output = amplitude * (1.0 + np.cos(theta))
        angles.append(-0.5 * (output[1::2] - output[0::2])[::-1])
    return np.array(angles)


def amplitudes_and_phases(angles: np.ndarray, times: np.ndarray, frequency: float) -> np.ndarray:
    """Return the complex amplitude of every joint at a frequency."""
    return 2.0 * np.mean(angles * np.exp(-1j * frequency * times)[:, None], axis=0)


def test_swum_network_has_the_lags_and_amplitudes_of_farms_own_equations(
    animat: FarmsAnimat, table: dict[str, Any]
):
    network = network_of(animat)
    assert network.gait.frequency == pytest.approx(4.5)
    period, dt = math.tau / 4.5, 1e-3
    farms = integrate_farms(table, 6.0 * period, dt)
    n_period = round(period / dt)
    times = dt * np.arange(n_period)
    expected = amplitudes_and_phases(farms[-n_period:], times, 4.5)
    trial = lc.swim(animat.robot, network, 6.0 * period, joints=animat.joints)
    phases = np.array([trial.signals[f"phase_{i}"][-1] for i in range(3)])
    lags = np.degrees(np.diff(phases)) % 360.0
    assert lags == pytest.approx([math.degrees(LAG)] * 2, abs=1.0)
    assert np.degrees(np.diff(np.unwrap(np.angle(expected)))) == pytest.approx(lags, abs=1.0)
    own = [network.gait.amplitude * share for share in network.gait.envelope.joints(4)]
    assert own == pytest.approx(np.abs(expected), rel=0.01)
    assert own == pytest.approx([0.42, 0.36, 0.30])
    assert network.coupling == pytest.approx(25.0 * np.mean([0.42, 0.36, 0.36, 0.30]))
    assert trial.forward_velocity > 0.0


def test_more_drive_on_the_left_bends_and_turns_to_the_left(tmp_path: Path, table: dict[str, Any]):
    file = write_animat(tmp_path, table)
    faster = network_of(load_farms(file, drive=4.0))
    assert faster.gait.frequency == pytest.approx(6.0)
    assert faster.gait.offset == 0.0
    turning = load_farms(file, drive=(4.0, 3.0))
    by_sides = 0.5 * (0.10 + 0.12 + 0.14) / 3.0
    assert network_of(turning).gait.offset == pytest.approx(by_sides + 0.05)
    trial = lc.swim(turning.robot, network_of(turning), 3.0, joints=turning.joints)
    assert trial.heading[-1] > 0.2


def test_stretch_is_felt_if_all_oscillators_feel_their_own_joint(
    tmp_path: Path, table: dict[str, Any]
):
    table["control"]["network"]["joint2osc"] = [
        {"in": f"osc_{i}_{side}", "out": name, "type": "STRETCH2FREQTEGOTAE", "weight": weight}
        for i, name in enumerate(JOINTS)
        for side, weight in (("L", -2.0), ("R", 2.0))
    ]
    animat = load_farms(write_animat(tmp_path, table))
    assert network_of(animat).feedback.stretch == pytest.approx(-2.0)
    assert not any("joint2osc" in remark for remark in animat.left_out)


def test_a_missing_coupling_is_a_cut(tmp_path: Path, table: dict[str, Any]):
    network = table["control"]["network"]
    network["osc2osc"] = [
        one for one in network["osc2osc"] if "osc_0" not in one["in"] + one["out"]
    ]
    assert network_of(load_farms(write_animat(tmp_path, table))).cuts == (1,)


def test_files_of_2023_count_drives_instead_of_naming_them(tmp_path: Path, table: dict[str, Any]):
    network = table["control"]["network"]
    network["drive2osc"] = [0, 1, 0, 1, 0, 1]
    network["drive2joint"] = [[0, 1]] * 3
    for one in network["oscillators"]:
        for prefix in ("frequency_", "amplitude_"):
            del one[f"{prefix}saturation_low"], one[f"{prefix}saturation_high"]
            one[f"{prefix}saturation"] = 0
    network["drives"][1]["initial_value"] = 2.0
    assert network_of(load_farms(write_animat(tmp_path, table))).gait.frequency == pytest.approx(
        1.5 * 2.5
    )


# ---- motors, muscles, drag -----------------------------------------------------------------------


def test_position_motors_are_servos_of_the_same_stiffness_damping_and_limit(animat: FarmsAnimat):
    assert animat.joints == Servo()
    actuator = animat.robot.joints[0].actuator
    assert actuator.servo_gain * actuator.stall_torque == pytest.approx(6.0)
    assert actuator.stall_torque / actuator.no_load_speed == pytest.approx(0.02)
    assert actuator.stall_torque == 4.0
    assert not actuator.stated


def test_ekeberg_muscles_give_the_torque_of_farms_averaged_over_a_cycle(
    tmp_path: Path, table: dict[str, Any]
):
    for motor in table["control"]["motors"]:
        motor["equation"] = "ekeberg_muscle"
    animat = load_farms(write_animat(tmp_path, table))
    law = animat.joints
    assert isinstance(law, Ekeberg)
    amplitude, angle, rate = 0.36, 0.2, 0.5
    drive: Any = type(
        "Drive", (), {"proportional_gain": 1.0, "servo_gain": 1.0, "stall_torque": 1.0}
    )
    theta = np.linspace(0.0, math.tau, 400, endpoint=False)
    ours = [law(angle, rate, amplitude * math.cos(phase), 0, 0, drive)[0] for phase in theta]
    left, right = amplitude * (1 + np.cos(theta)), amplitude * (1 - np.cos(theta))
    farms = 0.5 * (left - right) - 1.5 * (left + right + 0.2) * angle - 0.01 * rate
    assert np.mean(ours) == pytest.approx(np.mean(farms), rel=1e-4)
    swing = np.mean(np.array(ours) * np.cos(theta)), np.mean(farms * np.cos(theta))
    assert swing[0] == pytest.approx(swing[1], rel=1e-6)


def test_drag_of_links_is_that_of_farms_in_its_water(animat: FarmsAnimat):
    from laticauda.robot import link_coefficients

    assert animat.robot_with_drag is not None
    assert animat.water is not None
    coefficients = link_coefficients(animat.robot_with_drag, animat.water)
    assert coefficients.c_t == pytest.approx([0.2] * 4)
    assert coefficients.c_n == pytest.approx([1.5] * 4)
    assert coefficients.mu_n == pytest.approx([0.0] * 4)


def test_a_motor_without_limit_is_a_servo_that_never_saturates(
    tmp_path: Path, table: dict[str, Any]
):
    table["control"]["motors"][0]["limits_torque"] = [-math.inf, math.inf]
    actuator = load_farms(write_animat(tmp_path, table)).robot.joints[-1].actuator
    assert actuator.stall_torque == pytest.approx(6.0 * math.pi)
    assert actuator.servo_gain == pytest.approx(1.0 / math.pi)


# ---- the AmphiBot example of FARMS ---------------------------------------------------------------


def test_amphibot_of_farms_swims_here_as_by_its_own_equations_and_as_its_page_says():
    figures = {figure.name: figure for figure in campaign("farms_amphibot").read_table()}
    for name in ("mass [kg]", "length [m]"):
        assert figures[name].laticauda == pytest.approx(figures[name].second_opinion, rel=1e-3)
    for name in ("lag, least [deg]", "lag, largest [deg]"):
        assert figures[name].laticauda == pytest.approx(figures[name].second_opinion, abs=1.0)
    for name in ("speed after 4 s [m/s]", "way in 4 s, begun as a wave [m]"):
        assert figures[name].laticauda == pytest.approx(figures[name].second_opinion, rel=0.02)
    head = figures["way of the head in 4 s, begun by the file [m]"]
    assert head.second_opinion == pytest.approx(0.56, rel=0.03)


# ---- what is not taken, and what is wrong --------------------------------------------------------


def test_everything_that_is_not_taken_is_said(animat: FarmsAnimat):
    assert animat.left_out == (
        "coupling that differs along the body, 8.25 to 9.75 1/s: its mean is taken",
        "initial phases and amplitudes of the oscillators",
        "limits of joint `waist`, -1.2 and 0.8 rad: the smaller one applies to both sides",
        "limbs of 0.03 kg: leg_left, leg_right",
        "joints of the spine that are held: nod",
        "2 sensors",
        "friction, contacts and buoyancy of links",
    )


def test_objects_of_python_in_a_file_are_data_and_nothing_runs(
    tmp_path: Path, table: dict[str, Any]
):
    file = write_animat(tmp_path, table)
    marker = tmp_path / "ran"
    tag = "!!python/object/apply:os.system"
    file.write_text(f"{file.read_text()}spawn: {tag}\n- touch {marker}\n")
    assert load_farms(file).robot.n_links == 4
    assert not marker.exists()


def remove_sdf(table: dict[str, Any]) -> None:
    table["sdf"] = "gone.sdf"


def break_number(table: dict[str, Any]) -> None:
    table["control"]["network"]["oscillators"][2]["amplitude_gain"] = "much"


def lose_oscillator(table: dict[str, Any]) -> None:
    del table["control"]["network"]["oscillators"][0]


def unknown_drive(table: dict[str, Any]) -> None:
    table["control"]["network"]["drive2osc"][0]["drive"] = "middle"


def leg_as_spine(table: dict[str, Any]) -> None:
    table["morphology"]["joints"][2]["name"] = "hip_left"


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (remove_sdf, "`sdf` names gone.sdf, which is not there; give the file as `morphology`"),
        (
            break_number,
            "`control.network.oscillators[2].amplitude_gain` must be a finite number, got 'much'",
        ),
        (lose_oscillator, "`control.network.oscillators` must have `osc_0_L`, which moves a joint"),
        (
            unknown_drive,
            "`control.network.drive2osc[0].drive` must be one of the drives, got `middle`",
        ),
        (
            leg_as_spine,
            "its joints neck, waist, hip_left do not lie on one path from `skull`; "
            "`head` must be the link of the head",
        ),
    ],
)
def test_a_wrong_animat_is_refused_with_its_place(
    tmp_path: Path, table: dict[str, Any], spoil: Any, message: str
):
    spoil(table)
    with pytest.raises(RobotFileError) as refusal:
        load_farms(write_animat(tmp_path, table))
    file, sentence = str(refusal.value).split(": ", maxsplit=1)
    assert Path(file).parent == tmp_path
    assert sentence == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<sdf><model", "is not XML: unclosed token: line 1, column 5"),
        ("<urdf/>", "must be an SDF file with a model, but is <urdf>"),
        ("<sdf><model name='m'/></sdf>", "its model has no links"),
        (
            "<sdf><model><link name='a'><pose>0 0</pose></link></model></sdf>",
            "<pose> of `a` must hold 6 numbers, got '0 0'",
        ),
        (
            "<sdf><model><link name='a'/><joint name='j' type='fixed'><parent>a</parent>"
            "<child>b</child></joint></model></sdf>",
            "joint `j` names `b`, which is no link",
        ),
        (
            "<sdf><model><link name='a'><inertial><inertia><ixx>inf</ixx></inertia></inertial>"
            "</link></model></sdf>",
            "moments of inertia must be finite",
        ),
        ("<sdf><model><link name='a'/></model></sdf>", "no hinge bends it between `a` and `a`"),
    ],
)
def test_a_wrong_sdf_file_is_refused_with_one_sentence(tmp_path: Path, text: str, message: str):
    file = tmp_path / "wrong.sdf"
    file.write_text(text)
    with pytest.raises(RobotFileError) as refusal:
        load_farms(file)
    assert str(refusal.value) == f"{file}: {message}"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"drive": (1.0, 2.0, 3.0)}, "`drive` must be one number, or (left, right), got"),
        ({"drive": math.nan}, "`drive` must be a finite number, got nan"),
        ({"morphology": EEL}, "`morphology` must not be given with eel.sdf, which is one itself"),
        ({"head": "snout"}, "it has no link `snout` for the head; its links are skull, trunk_1"),
    ],
)
def test_a_wrong_argument_is_refused_by_its_name(arguments: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=re.escape(message)):
        load_farms(EEL, **arguments)


def test_a_file_of_another_kind_is_refused(tmp_path: Path):
    with pytest.raises(
        RobotFileError, match=r"must be an animat of FARMS, a file that ends in \.yaml"
    ):
        load_farms(tmp_path / "robot.toml")


# ---- the shell -----------------------------------------------------------------------------------


def test_shell_writes_a_robot_file_and_says_what_was_not_taken(
    tmp_path: Path, table: dict[str, Any], capsys: pytest.CaptureFixture[str]
):
    file = write_animat(tmp_path, table)
    robot_file = tmp_path / "eel.toml"
    assert main(["import", "farms", str(file), "--output", str(robot_file)]) == 0
    printed = capsys.readouterr().out
    assert "joints, tail first: peduncle, waist, neck" in printed
    assert "- limbs of 0.03 kg: leg_left, leg_right" in printed
    assert lc.load_robot(robot_file) == load_farms(file).robot


def test_shell_prints_facts_for_programs(
    tmp_path: Path, table: dict[str, Any], capsys: pytest.CaptureFixture[str]
):
    file = write_animat(tmp_path, table)
    assert main(["import", "farms", str(file), "--drive", "2", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["network"]["gait"]["frequency"] == pytest.approx(3.0)
    assert facts["network"]["kind"] == "phase-oscillators"
    assert len(facts["left_out"]) == 7
