import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from robot.strategies import robots

import laticauda as lc
from laticauda.models.spatial import mjcf
from laticauda.models.spatial.bodies import moments_of_inertia
from laticauda.motion.joints import servo
from laticauda.motion.joints.laws import Drive
from laticauda.robot import Joint, Module, PectoralFin, Section, Thruster, kinematics
from laticauda.values.errors import MissingExtra

mujoco = pytest.importorskip("mujoco")

WATER = lc.load_water("paper-lateral")
PRESETS = ["mamba", "mamba-fin", "mamba-modules", "mamba-modules-fin", "mamba-thruster", "chain"]


def compiled(robot, environment=WATER, **options):
    model = mjcf.build_spec(robot, environment, **options).compile()
    return model, mujoco.MjData(model)


def set_joints(data, values):
    for i, value in enumerate(values):
        data.joint(f"joint_{i}").qpos[:] = value


def random_pose(model, data, joint_angle, seed=0):
    """Put a planar model somewhere with these joint angles, moving; returns the root's angle."""
    rng = np.random.default_rng(seed)
    set_joints(data, joint_angle)
    for name in ("root_x", "root_y", "root_yaw"):
        data.joint(name).qpos[:] = rng.uniform(-2.0, 2.0)
    data.qvel[:] = rng.uniform(-1.0, 1.0, model.nv)
    mujoco.mj_forward(model, data)
    return float(data.joint("root_yaw").qpos[0])


# ---- what it weighs ------------------------------------------------------------------------------


@given(robots())
@settings(max_examples=25)
def test_mass_and_place_of_the_center_of_mass_are_the_robots(robot):
    model, data = compiled(robot, visuals=False)
    mujoco.mj_forward(model, data)
    assert model.body_subtreemass[0] == pytest.approx(robot.mass)
    straight = np.zeros(robot.n_links)
    as_planar = replace(robot, joints=[replace(joint, axis="yaw") for joint in robot.joints])
    tail = kinematics.Posture(as_planar, np.zeros(2), straight).link_ends[0]
    np.testing.assert_allclose(data.subtree_com[1][:2], -tail, atol=1e-12)


@pytest.mark.parametrize("preset", PRESETS)
def test_head_and_tail_are_as_far_apart_as_the_robot_is_long(preset):
    robot = lc.load_robot(preset)
    model, data = compiled(robot)
    mujoco.mj_forward(model, data)
    neck = np.linalg.norm(
        data.body(f"module_{robot.n_links - 1}").xpos - data.body("module_0").xpos
    )
    assert neck + robot.modules[-1].length == pytest.approx(robot.length)
    assert model.njnt == robot.n_joints + 1


@given(robots(), st.data())
@settings(max_examples=25)
def test_kinetic_energy_is_that_of_the_planar_chain(robot, draw):
    """For any pose and any rates: so every entry of the inertia matrix is the planar chain's."""
    robot = robot.planar()
    model, data = compiled(robot, root="planar", visuals=False)
    limit = [0.9 * joint.limit for joint in robot.joints]
    phi = np.array([draw.draw(st.floats(-most, most)) for most in limit])
    theta = kinematics.link_angles(phi, angle=random_pose(model, data, phi), link=0)
    joint_rate = np.array([float(data.joint(f"joint_{i}").qvel[0]) for i in range(robot.n_joints)])
    theta_rate = kinematics.link_angles(
        joint_rate, angle=float(data.joint("root_yaw").qvel[0]), link=0
    )

    normal = np.stack((-np.sin(theta), np.cos(theta)), axis=1)
    steps = (
        np.array([module.length for module in robot.modules])[:, None]
        * normal
        * theta_rate[:, None]
    )
    tail = np.array([data.joint("root_x").qvel[0], data.joint("root_y").qvel[0]])
    ends = tail + np.vstack((np.zeros(2), np.cumsum(steps, axis=0)))
    energy = 0.0
    for i, module in enumerate(robot.modules):
        velocity = ends[i] + (module.half_length + module.center) * normal[i] * theta_rate[i]
        energy += (
            0.5 * module.mass * velocity @ velocity
            + 0.5 * module.moment_of_inertia * theta_rate[i] ** 2
        )
    if robot.caudal_fin is not None:
        angle, rate, root = theta[0], theta_rate[0], tail
        for k, piece in enumerate(robot.caudal_fin.pieces):
            name = (
                f"fin_hinge_{k}" if piece.hinge else "fin_joint" if robot.caudal_fin.joint else None
            )
            if name is not None:
                angle -= float(data.joint(name).qpos[0])
                rate -= float(data.joint(name).qvel[0])
            across = np.array([-math.sin(angle), math.cos(angle)]) * piece.length * rate
            velocity = root - 0.5 * across
            energy += 0.5 * piece.mass * (velocity @ velocity + piece.length**2 / 12.0 * rate**2)
            root = root - across

    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    assert 0.5 * data.qvel @ inertia @ data.qvel == pytest.approx(energy)


@given(st.floats(1e-9, 10.0), st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_moments_of_inertia_are_those_of_a_possible_body(vertical, across, above):
    about_x, about_y, about_z = moments_of_inertia(vertical, across, above)
    assert about_z == vertical
    assert (
        min(about_x + about_y - about_z, about_y + about_z - about_x, about_z + about_x - about_y)
        >= -1e-12
    )


def test_a_long_cylinder_has_the_moments_of_a_cylinder():
    mass, length, a, b = 0.77, 0.9, 0.055, 0.05
    solid = mass * (length**2 / 12.0 + b**2 / 4.0)
    found = moments_of_inertia(solid, mass * b**2 / 4.0, mass * a**2 / 4.0)
    assert found == pytest.approx(
        (mass * (a**2 + b**2) / 4.0, mass * (length**2 / 12.0 + a**2 / 4.0), solid)
    )


# ---- where everything is -------------------------------------------------------------------------


@given(robots(), st.data())
@settings(max_examples=25)
def test_modules_are_where_kinematics_says(robot, draw):
    robot = robot.planar()
    model, data = compiled(robot, root="planar", visuals=False)
    phi = np.array([draw.draw(st.floats(-joint.limit, joint.limit)) for joint in robot.joints])
    theta = kinematics.link_angles(phi, angle=random_pose(model, data, phi), link=0)
    center = data.subtree_com[1][:2]
    bend = np.zeros(0)
    if robot.caudal_fin is not None:
        first = 0 if robot.caudal_fin.joint else 1
        names = [
            f"fin_hinge_{k}" if k else "fin_joint"
            for k in range(first, robot.caudal_fin.n_hinges + 1)
        ]
        for k, name in enumerate(names):
            data.joint(name).qpos[:] = 0.3 * math.cos(k)
        mujoco.mj_forward(model, data)
        center = data.subtree_com[1][:2]
        bend = np.array([0.3 * math.cos(k) for k in range(len(names))])
        hinges = [
            f"caudal_fin_{k}" if k else "caudal_fin"
            for k in range(robot.caudal_fin.n_hinges, -1, -1)
        ]
        line = kinematics.Posture(robot, center, theta, fin_angle=bend).fin_line
        np.testing.assert_allclose(
            line[1:], [data.body(name).xpos[:2] for name in hinges], atol=1e-9
        )
    found = np.array([data.body(f"module_{i}").xpos[:2] for i in range(robot.n_links)])
    posture = kinematics.Posture(robot, center, theta, bend)
    np.testing.assert_allclose(found, posture.link_ends[:-1], atol=1e-9)
    middles = np.array([data.site(f"module_{i}_center").xpos[:2] for i in range(robot.n_links)])
    np.testing.assert_allclose(middles, posture.link_centers, atol=1e-9)


def test_a_positive_yaw_angle_turns_the_head_left_and_a_positive_pitch_angle_turns_it_down():
    robot = lc.load_robot("mamba-modules")
    assert [joint.axis for joint in robot.joints[:2]] == ["yaw", "pitch"]
    for i, (axis, sign) in {0: (1, 1.0), 1: (2, -1.0)}.items():
        model, data = compiled(robot)
        data.joint(f"joint_{i}").qpos[:] = 0.3
        mujoco.mj_forward(model, data)
        forward = data.body(f"module_{i + 1}").xmat.reshape(3, 3)[:, 0]
        assert forward[0] == pytest.approx(math.cos(0.3))
        assert forward[axis] == pytest.approx(sign * math.sin(0.3))


def test_an_offset_on_all_joints_bends_the_body_to_the_left():
    robot = lc.load_robot("mamba")
    model, data = compiled(robot, root="planar")
    set_joints(data, [0.1] * robot.n_joints)
    mujoco.mj_forward(model, data)
    forward = data.body("module_8").xmat.reshape(3, 3)[:, 0]
    assert math.atan2(forward[1], forward[0]) == pytest.approx(0.8)


def test_the_fin_is_fixed_behind_the_tail():
    model, data = compiled(lc.load_robot("mamba-modules-fin"))
    data.joint("joint_0").qpos[:] = 1.0
    mujoco.mj_forward(model, data)
    fin = data.body("caudal_fin")
    np.testing.assert_allclose(fin.xpos, data.body("module_0").xpos)
    assert model.body("caudal_fin").parentid[0] == model.body("module_0").id
    assert fin.xipos[0] == pytest.approx(-0.25)
    bare, _ = compiled(lc.load_robot("mamba"))
    assert "caudal_fin" not in {bare.body(i).name for i in range(bare.nbody)}


def test_effectors_are_sites_with_their_own_axes():
    robot = replace(
        lc.load_robot("mamba"),
        thrusters=(Thruster(link=0, thrust=1.0, angle=0.5, x=-0.05, y=0.02),),
        pectoral_fins=(
            PectoralFin(link=8, area=0.01, lift_slope=3.0, stall_angle=0.4, angle=-0.2),
        ),
    )
    model, data = compiled(robot)
    mujoco.mj_forward(model, data)
    thruster, fin = data.site("thruster_0"), data.site("pectoral_fin_0")
    np.testing.assert_allclose(thruster.xpos, [0.04, 0.02, -0.5])
    np.testing.assert_allclose(
        thruster.xmat.reshape(3, 3)[:, 0], [math.cos(0.5), math.sin(0.5), 0.0]
    )
    np.testing.assert_allclose(
        fin.xmat.reshape(3, 3)[:, 0], [math.cos(0.2), -math.sin(0.2), 0.0], atol=1e-12
    )


# ---- joints, servos and sensors ------------------------------------------------------------------


def test_joints_have_the_robots_limits_and_its_skin():
    robot = lc.load_robot("mamba")
    robot = replace(
        robot, joints=[Joint(limit=0.1 * (i + 1), stiffness=i, damping=0.5) for i in range(8)]
    )
    model, _ = compiled(robot)
    for i in range(8):
        joint = model.joint(f"joint_{i}")
        np.testing.assert_allclose(joint.range, [-0.1 * (i + 1), 0.1 * (i + 1)])
        assert joint.stiffness[0] == i and joint.damping[0] == 0.5


@given(st.floats(-1.0, 1.0), st.floats(-6.0, 6.0), st.floats(-1.0, 1.0))
@settings(max_examples=25)
def test_the_servo_has_the_torque_of_the_servo_law(angle, rate, reference):
    robot = lc.load_robot("mamba")
    motor = robot.joints[0].actuator
    drive = Drive(0.0, 0.0, motor.servo_gain, motor.stall_torque, motor.no_load_speed, 0.0, 0.0)
    model, data = compiled(robot, actuators="servo")
    data.joint("joint_3").qpos[:], data.joint("joint_3").qvel[:] = angle, rate
    data.actuator("servo_3").ctrl[:] = reference
    mujoco.mj_forward(model, data)
    at = model.joint("joint_3").dofadr[0]
    expected, *_ = servo(angle, rate, reference, drive)
    assert data.qfrc_actuator[at] + data.qfrc_damper[at] == pytest.approx(expected, abs=1e-12)


def test_sensors_read_what_they_are_called():
    model, data = compiled(lc.load_robot("mamba-modules"))
    data.joint("joint_5").qpos[:], data.joint("joint_5").qvel[:] = 0.3, -2.0
    model.opt.gravity[:] = 0.0, 0.0, -9.0
    mujoco.mj_forward(model, data)
    assert data.sensor("joint_angle_5").data == pytest.approx(0.3)
    assert data.sensor("joint_rate_5").data == pytest.approx(-2.0)
    names = {model.sensor(i).name for i in range(model.nsensor)}
    for kind, first, last in (
        ("joint_angle", 0, 17),
        ("acceleration", 0, 18),
        ("force", 1, 18),
        ("torque", 1, 18),
    ):
        assert {f"{kind}_{i}" for i in range(first, last + 1)} == {
            n for n in names if n.startswith(f"{kind}_")
        }


def test_the_force_sensor_carries_what_hangs_on_it():
    robot = replace(lc.load_robot("mamba"), joints=[Joint(stiffness=1e6)] * 8)
    model, data = compiled(robot, root="planar")
    mujoco.mj_forward(model, data)
    assert data.sensor("force_4").data[2] == pytest.approx(5 * 0.8 * 9.81)
    assert compiled(robot, sensors=False)[0].nsensor == 0


# ---- the place -----------------------------------------------------------------------------------


def test_the_robot_starts_in_the_waters_depth_or_on_the_ground():
    robot = lc.load_robot("mamba")
    for environment, height in (
        (WATER, -mjcf.DEPTH),
        (replace(WATER, depth=0.2), -0.2),
        (lc.load_ground("coulomb"), 0.055),
    ):
        model, data = compiled(robot, environment)
        mujoco.mj_forward(model, data)
        assert data.body("module_0").xpos[2] == pytest.approx(height)


def test_a_robot_let_go_rests_on_the_floor_of_the_tank():
    model, data = compiled(lc.load_robot("mamba-fin"), scene="tank")
    for _ in range(1500):
        mujoco.mj_step(model, data)
    lowest = min(data.body(f"module_{i}").xipos[2] for i in range(9))
    assert lowest == pytest.approx(-1.5 + 0.05, abs=0.012)
    assert not any(warning.number for warning in data.warning)


def test_a_robot_on_the_shore_lies_on_it_and_the_ramp_leads_from_it_to_the_floor():
    model, data = compiled(lc.load_robot("mamba-fin"), scene="shore")
    mujoco.mj_forward(model, data)
    assert data.body("module_0").xpos[2] == pytest.approx(0.10 + 0.055)
    for _ in range(500):
        mujoco.mj_step(model, data)
    heights = [data.body(f"module_{i}").xpos[2] for i in range(9)]
    np.testing.assert_allclose(heights, 0.155, atol=2e-3)

    seen = np.zeros(1, dtype=np.int32)
    surface = {}
    for x in (0.0, 2.4, 2.6, 6.0, 9.9, 12.0):
        distance = mujoco.mj_ray(
            model, data, np.array([x, 1.0, 2.0]), np.array([0.0, 0.0, -1.0]), None, 1, -1, seen
        )
        names = model.geom(int(seen[0])).name
        if names == "water":
            start = np.array([x, 1.0, -1e-6])
            distance = 2.0 + mujoco.mj_ray(
                model, data, start, np.array([0.0, 0.0, -1.0]), None, 1, -1, seen
            )
        surface[x] = 2.0 - distance
    assert surface[0.0] == surface[2.4] == pytest.approx(0.10)
    slope = math.tan(math.radians(12.0))
    assert surface[2.6] == pytest.approx(0.10 - 0.1 * slope, abs=1e-5)
    assert surface[6.0] == pytest.approx(0.10 - 3.5 * slope, abs=1e-5)
    assert surface[12.0] == pytest.approx(-1.5, abs=1e-5)


def test_places_that_exclude_each_other_are_refused():
    for scene in ("shore", "tank"):
        with pytest.raises(
            ValueError,
            match=f"`scene` must not be `{scene}` without water, got the ground `coulomb`",
        ):
            mjcf.build_spec(lc.load_robot("mamba"), lc.load_ground("coulomb"), scene=scene)


def test_modules_do_not_touch_each_other():
    robot = lc.load_robot("mamba-modules")
    model, data = compiled(robot)
    set_joints(data, [1.5] * 18)
    mujoco.mj_forward(model, data)
    assert data.ncon == 0


# ---- files, doors, bad input ---------------------------------------------------------------------


def test_a_mesh_per_module_is_seen_and_touched(tmp_path):
    file = tmp_path / "box.obj"
    corners = [(x, y, z) for x in (0.0, 0.18) for y in (-0.05, 0.05) for z in (-0.05, 0.05)]
    sides = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {side}" for side in sides]
    file.write_text("\n".join(lines) + "\n")
    model, data = compiled(lc.load_robot("mamba"), lc.load_ground("coulomb"), meshes=[file] * 9)
    mujoco.mj_forward(model, data)
    assert model.nmesh == 1
    assert {model.geom(i).contype[0] for i in range(model.ngeom)} == {0, 1}
    np.testing.assert_allclose(data.geom("module_0_hull").xpos, [0.09, 0.0, 0.055], atol=1e-12)


def test_bad_arguments_are_refused_by_name():
    robot = lc.load_robot("mamba")
    with pytest.raises(ValueError, match=r"`root` must be one of `free`, `planar`, got 'fixed'"):
        mjcf.build_spec(robot, WATER, root="fixed")
    with pytest.raises(ValueError, match=r"`actuators` must be one of `none`, `servo`"):
        mjcf.build_spec(robot, WATER, actuators="pd")
    with pytest.raises(ValueError, match=r"`scene` must be one of `pegs`, .*, got 'hill'"):
        mjcf.build_spec(robot, WATER, scene="hill")
    with pytest.raises(
        ValueError, match=r"`meshes` must be one file per module \(9\) or none, got 1"
    ):
        mjcf.build_spec(robot, WATER, meshes=["a.stl"])
    with pytest.raises(
        ValueError, match=r"`meshes` must be existing .stl or .obj files, got a.stl"
    ):
        mjcf.build_spec(robot, WATER, meshes=["a.stl"] * 9)
    with pytest.raises(ValueError, match="`robot` must be of class Robot, got str"):
        mjcf.build_spec("mamba", WATER)
    with pytest.raises(ValueError, match=r"`depth` must be > 0.055 m"):
        mjcf.build_spec(robot, replace(WATER, depth=0.01))


def test_without_mujoco_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(
        MissingExtra, match=r'The 3D model needs MuJoCo; run `pip install .*\[spatial\]"`'
    ):
        mjcf.build_spec(lc.load_robot("mamba"), WATER)


def test_the_module_can_be_imported_without_loading_mujoco():
    code = "import sys, laticauda.models.spatial.mjcf; sys.exit('mujoco' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.usefixtures("limit_case")
def test_one_module_alone_is_a_model_too():
    robot = lc.Robot(
        name="one",
        modules=[Module(length=0.1, mass=1.0, section=Section(half_height=0.05, half_width=0.05))],
    )
    model, _ = compiled(robot, actuators="servo")
    assert (model.nq, model.nu) == (7, 0)


def test_the_file_is_the_robot_that_was_simulated_ballast_included(tmp_path):
    robot, water = lc.load_robot("mamba-modules-fin"), lc.load_water("paper-lateral")
    mjcf.write_mjcf(tmp_path / "robot.xml", robot, water)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "robot.xml"))
    twin = lc.build_plant(robot, water, model="spatial").model
    own = [i for i in range(1, twin.nbody) if twin.body_rootid[i] == twin.body("module_0").id]
    same = [model.body(twin.body(i).name).id for i in own]
    assert twin.body_ipos[own][0, 2] == -0.005
    for name in ("mass", "ipos", "inertia", "pos"):
        np.testing.assert_allclose(
            getattr(model, f"body_{name}")[same], getattr(twin, f"body_{name}")[own], rtol=1e-5
        )  # six digits are written
    np.testing.assert_allclose(model.qpos0, twin.qpos0)
    without = mjcf.build_spec(robot, water, ballast_depth=0.0).compile()
    assert not without.body_ipos[:, 2].any()
