"""Forces and moments in the joints: laws that they obey, in both models."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import Joint, PectoralFin, Tether, Thruster

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
ALONG, LEFT, UP = range(3)


def swim(robot, duration=3.0, **changes):
    return lc.swim(robot, GAIT, duration, link_forces=True, **changes)


def acceleration_of_links(trial):
    """Return the accelerations of the links' middles by differences, for equal links of uniform mass."""
    length = trial.robot.modules[0].length
    direction = np.stack((np.cos(trial.link_angle), np.sin(trial.link_angle)), axis=-1)
    half = 0.5 * length * direction
    steps = half[:, 1:] + half[:, :-1]
    relative = np.concatenate((np.zeros_like(half[:, :1]), np.cumsum(steps, axis=1)), axis=1)
    middle = relative - relative.mean(axis=1, keepdims=True) + trial.center_of_mass[:, np.newaxis]
    velocity = np.gradient(middle, trial.time, axis=0)
    return np.gradient(velocity, trial.time, axis=0)


def in_world(trial):
    """Return the joint forces of a planar trial in world axes."""
    angle = trial.link_angle[:, :-1]
    along, left, _ = np.moveaxis(trial.joint_force, 2, 0)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * along - s * left, s * along + c * left), axis=2)


def test_newton_s_law_holds_for_the_part_on_either_side_of_every_joint():
    trial = swim("mamba", sample_interval=0.002)
    mass = trial.robot.modules[0].mass
    water = sum(trial.link_force.values())
    needed = mass * acceleration_of_links(trial) - water
    from_tail = -np.cumsum(needed, axis=1)[:, :-1]
    from_head = np.cumsum(needed[:, ::-1], axis=1)[:, ::-1][:, 1:]
    late = slice(600, -5)  # past the ramp, without the ends of the differences
    force = in_world(trial)[late]
    scale = np.abs(force).max()
    assert scale > 5.0
    np.testing.assert_allclose(force, from_tail[late], atol=1e-4 * scale)
    np.testing.assert_allclose(force, from_head[late], atol=1e-4 * scale)


LOADED = replace(
    lc.load_robot("mamba-fin"),
    thrusters=(Thruster(link=3, thrust=2.0, angle=0.3, y=0.05),),
    pectoral_fins=(
        PectoralFin(link=7, area=0.01, lift_slope=3.0, stall_angle=0.3, deflection=0.2, y=0.06),
    ),
    tether=Tether(drag=2.0, force=(-0.5, 0.3)),
)
MAMBA_FIN = lc.load_robot("mamba-fin")
ELASTIC = replace(
    MAMBA_FIN,
    caudal_fin=replace(MAMBA_FIN.caudal_fin, n_hinges=3, flexural_rigidity=1.0),
)
WATER = lc.load_water("paper-lateral")
SHEDDING = replace(WATER, added_mass_form="kirchhoff", trailing_edge="elongated")
SWELL = replace(WATER, current=lc.load_current("swell"), added_mass_form="kirchhoff")
CURRENT = replace(WATER, current=(0.1, -0.05), added_mass_form="classic")
SWIMS = {
    "plain": (lc.load_robot("mamba"), WATER),
    "effectors": (LOADED, SHEDDING),
    "swell": (lc.load_robot("mamba-fin"), SWELL),
    "current": (lc.load_robot("mamba-fin"), CURRENT),
    "elastic fin": (ELASTIC, WATER),
}


IN_PLANE = {"joint_force": [ALONG, LEFT], "joint_moment": [UP], "water_force": [ALONG, LEFT]}


MODELS = ("planar", "spatial")
DRIVEN = ("pd", "servo", "speed-servo")


@pytest.mark.parametrize("joints", ["prescribed", *DRIVEN])
@pytest.mark.parametrize("name", SWIMS)
def test_both_models_say_the_same_at_their_default_steps(name, joints):
    robot, water = SWIMS[name]
    planar, spatial = (
        swim(robot, 2.0, environment=water, joints=joints, model=model) for model in MODELS
    )
    check_loads_agree(planar, spatial, share=1e-4, is_level=name != "swell")


@pytest.mark.parametrize("joints", DRIVEN)
@pytest.mark.parametrize("model", MODELS)
def test_loads_of_driven_joints_at_default_steps_are_those_of_small_steps(model, joints):
    dt = lc.build_plant(MAMBA_FIN, WATER, model=model, joints=joints).dt
    usual, exact = (
        swim(MAMBA_FIN, environment=WATER, joints=joints, model=model, dt=dt / divisor)
        for divisor in (1, 16)
    )
    for series in IN_PLANE:
        expected = getattr(exact, series)
        error = np.abs(getattr(usual, series) - expected) / np.abs(expected).max()
        # While joints at full torque catch up with the gait; a servo's duty is later at its limit, too.
        assert error.max() < 1e-3
        if joints != "servo":
            assert error[usual.time > 0.5].max() < 1e-4


def check_loads_agree(planar, spatial, *, share, is_level):
    for series, in_plane in IN_PLANE.items():
        expected = getattr(planar, series)[..., in_plane]
        scale = np.abs(expected).max()
        assert scale > 0.5
        values = getattr(spatial, series)
        np.testing.assert_allclose(values[..., in_plane], expected, atol=share * scale)
        if is_level:  # a swell pushes up and down; only the guide of module 0 holds against it
            out_of_plane = np.delete(values, in_plane, axis=2)
            np.testing.assert_allclose(out_of_plane, 0.0, atol=1e-9 * scale)


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_the_moment_about_a_joint_s_axis_is_the_torque_of_drive_and_skin(joints, model):
    robot = lc.load_robot("mamba")
    skin = Joint(stiffness=2.0, damping=0.1)
    soft = replace(
        robot, joints=tuple(replace(joint, stiffness=2.0, damping=0.1) for joint in robot.joints)
    )
    trial = swim(soft, joints=joints, model=model)
    torque = (
        trial.joint_torque - skin.stiffness * trial.joint_angle - skin.damping * trial.joint_rate
    )
    scale = np.abs(torque).max()
    np.testing.assert_allclose(trial.joint_moment[..., UP], torque, atol=1e-6 * scale)
    np.testing.assert_allclose(trial.joint_moment[..., [ALONG, LEFT]], 0.0, atol=1e-9 * scale)
    np.testing.assert_allclose(trial.joint_force[..., UP], 0.0, atol=1e-9)


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_in_space_yaw_and_pitch_joints_bear_the_torques_of_their_drives(joints):
    robot = lc.load_robot("mamba-modules")
    gait = replace(GAIT, pitch=lc.Wave(amplitude=0.2, frequency=2.0, phase_shift=0.5))
    trial = lc.swim(robot, gait, 2.0, model="spatial", joints=joints, link_forces=True)
    axes = {"yaw": UP, "pitch": LEFT}
    for i, joint in enumerate(robot.joints):
        about_axis = trial.joint_moment[:, i, axes[joint.axis]]
        np.testing.assert_allclose(about_axis, trial.joint_torque[:, i], atol=1e-5)
    assert np.abs(trial.joint_torque[:, 1::2]).max() > 0.5
    assert np.abs(trial.joint_moment[..., ALONG]).max() > 0.05  # the body is twisted, too


@pytest.mark.parametrize("kind", ["viscous", "coulomb"])
def test_friction_of_the_ground_loads_the_joints_in_both_models_alike(kind):
    ground = lc.load_ground(kind)
    planar, spatial = (
        swim("mamba", 1.5, environment=ground, model=model, dt=2e-4, sample_interval=0.05)
        for model in ("planar", "spatial")
    )
    scale = np.abs(planar.joint_force).max()
    np.testing.assert_allclose(spatial.joint_force, planar.joint_force, atol=1e-4 * scale)
    with pytest.raises(ValueError, match="`environment` must be a Water for a pressure"):
        _ = planar.pressure_difference


def test_a_thruster_at_the_tail_pushes_and_one_at_the_head_pulls():
    robot = lc.load_robot("mamba")
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.7)
    for link, is_positive in ((0, True), (robot.n_links - 1, False)):
        driven = replace(robot, thrusters=(Thruster(link=link, thrust=2.0),))
        trial = lc.swim(driven, still, 1.0, link_forces=True)
        along = trial.joint_force[-1, :, ALONG]
        assert np.all((along > 0.0) == is_positive)
        # All links need the same: the one behind the first joint has a ninth of all that moves.
        shares = np.arange(1, robot.n_links) / robot.n_links
        expected = 2.0 * (1.0 - shares) if is_positive else -2.0 * shares
        np.testing.assert_allclose(along, expected, rtol=1e-9)


def test_a_heavy_head_hangs_on_its_joint_by_its_weight_in_water():
    """The robot is straight and at rest, and begins to sink and tilt as one stiff body."""
    robot = lc.load_robot("mamba-modules")
    heavy = replace(robot.modules[-1], mass=robot.modules[-1].mass + 0.5)
    robot = replace(robot, modules=(*robot.modules[:-1], heavy))
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.7)
    trial = lc.swim(robot, still, 0.1, model="spatial", ballast_depth=0.0, link_forces=True)
    plant = lc.build_plant(trial.scenario)
    elements = plant._twin.elements_of_robots
    mass = np.array([module.mass for module in robot.modules])
    length = np.array([module.length for module in robot.modules])
    bodies = [plant.model.body(f"module_{i}") for i in range(robot.n_links)]
    inertia = np.array([body.inertia[1] for body in bodies])
    inertia += [element.added_inertia[1] for element in elements]
    moving = mass + [element.added_mass[2] for element in elements]
    displaced = trial.environment.density * np.array([element.volume for element in elements])
    lift = (displaced - mass) * -plant.model.opt.gravity[2]
    middle = np.cumsum(length) - 0.5 * length
    coupling = np.sum(moving * middle)
    turning = np.sum(moving * middle**2 + inertia)
    matrix = np.array([[np.sum(moving), coupling], [coupling, turning]])
    rise, tilt = np.linalg.solve(matrix, [np.sum(lift), np.sum(lift * middle)])
    needed = moving * (rise + tilt * middle) - lift
    force = np.cumsum(needed[::-1])[::-1][1:]
    assert force[-1] > 3.0
    np.testing.assert_allclose(trial.joint_force[0, :, UP], force, atol=1e-6 * force[-1])
    # The moment that the tail side exerts lifts the head: about the left, down is positive.
    ends = np.cumsum(length)[:-1]
    ahead = middle[np.newaxis] > ends[:, np.newaxis]
    lever = middle[np.newaxis] - ends[:, np.newaxis]
    moment = -np.sum(ahead * (needed * lever + inertia * tilt), axis=1)
    np.testing.assert_allclose(trial.joint_moment[0, :, LEFT], moment, atol=1e-6)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_the_pressure_difference_pushes_every_link_as_the_water_does(model):
    trial = swim("mamba-fin", model=model)
    module = trial.robot.modules[1]
    side = 2.0 * module.section.half_height * module.length
    water = trial.link_force["drag"] + trial.link_force["added_mass"]
    angle = trial.link_angle
    to_left = np.cos(angle) * water[..., 1] - np.sin(angle) * water[..., 0]
    pushed = trial.pressure_difference
    np.testing.assert_allclose(pushed[:, 1:] * side, to_left[:, 1:], atol=1e-9)
    fin = trial.robot.caudal_fin
    with_fin = side + fin.height * (fin.length - fin.opening_length)
    np.testing.assert_allclose(pushed[:, 0] * with_fin, to_left[:, 0], atol=1e-9)


def test_a_trial_without_loads_says_how_to_get_them():
    trial = lc.swim("mamba", GAIT, 1.0)
    assert trial.joint_force is None
    with pytest.raises(ValueError, match="swim it again with `link_forces=True`"):
        _ = trial.pressure_difference


@pytest.mark.parametrize("n_links", [1, 9])
@pytest.mark.parametrize("ending", ["nc", "mcap", "parquet", "mat"])
def test_loads_follow_a_trial_into_its_files(tmp_path, ending, n_links):
    trial = swim(lc.load_robot("chain", n_links), 1.0)
    path = tmp_path / f"run.{ending}"
    trial.save(path)
    assert lc.load_trial(path).equals(trial)


def test_loads_follow_a_trial_into_tables_and_into_its_continuation(tmp_path):
    trial = swim("mamba", 1.0)
    trial.save(tmp_path / "run.csv")
    header = (tmp_path / "run.csv").read_text().splitlines()[0]
    assert "joint_force_0_along [N]" in header
    assert "joint_moment_7_up [N m]" in header
    assert "water_force_8_left [N]" in header
    second = lc.resume(lc.build_plant(trial.scenario), trial, 1.0, link_forces=True)
    whole = lc.joined(trial, second)
    assert whole.joint_moment.shape == (whole.time.size, 8, 3)
    silent = lc.resume(lc.build_plant(trial.scenario), trial, 1.0)
    with pytest.raises(ValueError, match="must log the same as `first`"):
        lc.joined(trial, silent)
