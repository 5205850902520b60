import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from robot.strategies import robots

import laticauda as lc
from laticauda.models.spatial import mjcf
from laticauda.models.spatial.mjcf import write_mjcf
from laticauda.models.spatial.urdf import build_urdf, write_urdf

mujoco = pytest.importorskip("mujoco")

WATER = lc.load_water("paper-lateral")
PRESETS = ["mamba", "mamba-fin", "mamba-modules-fin", "mamba-thruster"]
BOX = """v 0 -.05 -.05
v 0 .05 -.05
v 0 0 .05
v .18 0 0
f 1 2 3
f 1 4 2
f 2 4 3
f 3 4 1
"""


def masses_and_axes(model):
    """Total mass, and the axis of every joint in the world with the model's root upright."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    axes = {
        model.joint(i).name: data.joint(i).xaxis.copy()
        for i in range(model.njnt)
        if "joint" in model.joint(i).name
    }
    return float(model.body_subtreemass[0]), axes


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("kind", ["mjcf", "urdf"])
def test_a_file_opens_in_plain_mujoco_with_the_robots_mass_and_axes(preset, kind, tmp_path):
    robot = lc.load_robot(preset)
    file = tmp_path / f"robot.{kind}"
    if kind == "mjcf":
        write_mjcf(file, robot, WATER, scene="tank", actuators="servo")
    else:
        write_urdf(file, robot)
    model = mujoco.MjModel.from_xml_path(str(file))
    mass, axes = masses_and_axes(model)
    expected_mass, expected = masses_and_axes(mjcf.build_spec(robot, WATER).compile())
    assert mass == pytest.approx(expected_mass) == pytest.approx(robot.mass)
    assert axes.keys() == expected.keys() == {f"joint_{i}" for i in range(robot.n_joints)}
    for name, axis in expected.items():
        np.testing.assert_allclose(axes[name], axis, atol=1e-9)


def test_an_mjcf_file_is_the_model_that_it_was_made_of(tmp_path):
    robot = lc.load_robot("mamba-modules-fin")
    write_mjcf(tmp_path / "robot.xml", robot, WATER, actuators="servo")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    original = mjcf.build_spec(robot, WATER, actuators="servo").compile()
    for name in (
        "body_mass",
        "body_inertia",
        "body_ipos",
        "jnt_range",
        "dof_damping",
        "actuator_gainprm",
        "geom_rgba",
    ):
        np.testing.assert_allclose(
            getattr(model, name), getattr(original, name), rtol=1e-5, atol=1e-9, err_msg=name
        )
    assert model.nsensor == original.nsensor and model.nsite == original.nsite


@pytest.mark.parametrize("preset", PRESETS)
def test_a_urdf_file_opens_in_a_reader_of_urdf(preset):
    reader = pytest.importorskip("urdf_parser_py.urdf")
    robot = lc.load_robot(preset)
    found = reader.URDF.from_xml_string(build_urdf(robot))
    assert found.get_root() == "module_0"
    assert sum(link.inertial.mass for link in found.links if link.inertial) == pytest.approx(
        robot.mass
    )
    driven = [joint for joint in found.joints if joint.type == "revolute"]
    assert [joint.name for joint in driven] == [f"joint_{i}" for i in range(robot.n_joints)]
    for joint, original in zip(driven, robot.joints, strict=True):
        assert tuple(joint.axis) == {"yaw": (0, 0, 1), "pitch": (0, 1, 0)}[original.axis]
        assert joint.limit.upper == pytest.approx(original.limit)
        assert joint.limit.effort == original.actuator.stall_torque
    assert found.get_chain("module_0", f"module_{robot.n_links - 1}", links=False) == [
        joint.name for joint in driven
    ]


@pytest.mark.parametrize("preset", PRESETS)
def test_ros2_control_is_told_of_every_driven_joint_what_it_takes_and_says(preset):
    robot = lc.load_robot(preset)
    root = ET.fromstring(build_urdf(robot))
    (control,) = root.iter("ros2_control")
    assert (control.get("type"), control.findtext("hardware/plugin")) == (
        "system",
        "mock_components/GenericSystem",
    )
    joints = control.findall("joint")
    assert len(joints) == len(robot.driven_joints)
    for joint, driven in zip(joints, robot.driven_joints, strict=True):
        assert [one.get("name") for one in joint.findall("state_interface")] == [
            "position",
            "velocity",
            "effort",
        ]
        (told,) = joint.findall("command_interface")
        assert told.get("name") == "position"
        limits = {one.get("name"): float(one.text) for one in told}
        assert limits == {"min": pytest.approx(-driven.limit), "max": pytest.approx(driven.limit)}
        assert root.find(f"joint[@name='{joint.get('name')}']").get("type") == "revolute"


@given(robots())
@settings(max_examples=25)
def test_in_any_posture_a_urdf_robot_is_where_the_mjcf_robot_is(robot):
    """Bodies, their centers of mass and their inertia (whose axes MuJoCo sorts when it reads URDF)."""
    models = (
        mujoco.MjModel.from_xml_string(build_urdf(robot)),
        mjcf.build_spec(robot, WATER, visuals=False).compile(),
    )
    found = []
    for model in models:
        data = mujoco.MjData(model)
        for i, joint in enumerate(robot.joints):
            data.joint(f"joint_{i}").qpos[:] = math.sin(i + 1.0) * joint.limit
        pieces = robot.caudal_fin.pieces if robot.caudal_fin else ()
        fin = ["caudal_fin", *(f"caudal_fin_{k}" for k in range(1, len(pieces)))] if pieces else []
        joints = [f"fin_hinge_{k}" for k in range(1, len(pieces))]
        for k, name in enumerate(
            [*joints, "fin_joint"] if pieces and robot.caudal_fin.joint else joints
        ):
            data.joint(name).qpos[:] = 0.3 * math.cos(k)
        mujoco.mj_kinematics(model, data)
        names = [f"module_{i}" for i in range(robot.n_links)] + fin
        base = data.body("module_0").xpos
        places = [(data.body(name).xpos - base, data.body(name).xipos - base) for name in names]
        found.append((np.array(places), np.array([model.body(name).inertia for name in names])))
    np.testing.assert_allclose(found[0][0], found[1][0], atol=1e-7)
    np.testing.assert_allclose(np.sort(found[0][1]), np.sort(found[1][1]), rtol=1e-6, atol=1e-12)


@given(robots())
@settings(max_examples=25)
def test_any_robot_can_be_written_and_read_back(robot):
    text = build_urdf(robot)
    assert ET.fromstring(text).get("name") == robot.name
    assert mujoco.MjModel.from_xml_string(text).body_subtreemass[0] == pytest.approx(robot.mass)
    model = mjcf.build_spec(robot, WATER)
    model.compile()
    assert mujoco.MjModel.from_xml_string(model.to_xml()).body_subtreemass[0] == pytest.approx(
        robot.mass, rel=1e-5
    )


@pytest.mark.parametrize("kind", ["mjcf", "urdf"])
def test_meshes_are_copied_beside_the_file_and_the_folder_can_be_moved(kind, tmp_path):
    robot = lc.load_robot("mamba")
    source = tmp_path / "source"
    source.mkdir()
    (source / "link.obj").write_text(BOX)
    (source / "head.obj").write_text(BOX)
    meshes = [source / "link.obj"] * 8 + [source / "head.obj"]
    first = tmp_path / "first"
    first.mkdir()
    if kind == "mjcf":
        write_mjcf(first / "robot.xml", robot, WATER, meshes=meshes)
    else:
        write_urdf(first / "robot.xml", robot, meshes=meshes)
    for file in source.iterdir():
        file.unlink()
    moved = first.rename(tmp_path / "second")
    assert sorted(file.name for file in (moved / "robot_meshes").iterdir()) == [
        "0_link.obj",
        "1_head.obj",
    ]
    model = mujoco.MjModel.from_xml_path(str(moved / "robot.xml"))
    assert model.nmesh == 2
    assert str(tmp_path) not in (moved / "robot.xml").read_text()


def test_meshes_must_be_one_per_module():
    with pytest.raises(
        ValueError, match=r"`meshes` must be one file per module \(9\) or none, got 2\."
    ):
        build_urdf(lc.load_robot("mamba"), ["a.stl", "b.stl"])
