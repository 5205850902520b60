"""The planar and the spatial model are one robot: same paths and headings, a difference that falls with the step."""

from dataclasses import replace

import campaign_scripts
import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import PectoralFin, Tether, Thruster
from laticauda.scenarios import Scenario
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

campaign = campaign_scripts.campaign("parity")
parity, CASES = campaign.parity, campaign.CASES
STEPS = {"prescribed": (0.05, 0.025), "pd": (0.016, 0.008), "servo": (0.016, 0.008)}


@pytest.mark.parametrize("joints", STEPS)
@pytest.mark.parametrize("name", CASES)
def test_the_difference_is_small_and_falls_with_the_step(name: str, joints: str):
    coarse, fine = parity(CASES[name], joints, STEPS[joints], duration=4.0)
    assert fine.path < 3e-5
    assert fine.path < coarse.path / (10.0 if joints == "prescribed" else 1.4)
    assert fine.richardson is not None
    assert fine.richardson < 3e-5
    assert fine.heading < 1e-3


def test_the_stored_answer_is_within_what_the_campaign_asks_and_a_run_of_it_comes_out_again():
    stored = campaign.stored()
    assert {(one.joints, one.case) for one in stored} == {
        (joints, case) for joints in STEPS for case in CASES
    }
    finest = [one for one in stored if one.dt == 0.0005]
    assert (
        len(finest) == 15
        and max(one.path for one in finest) < 3e-3
        and max(one.richardson for one in finest) < 1e-3
    )
    (row,) = parity(CASES["turning"], "prescribed", (0.05,), reference_step=0.000125)
    kept = next(
        one for one in stored if (one.case, one.joints, one.dt) == ("turning", "prescribed", 0.05)
    )
    assert row.path == pytest.approx(kept.path, rel=0.01)
    assert row.heading == pytest.approx(kept.heading, rel=0.01)


FORMS = [
    {"added_mass_form": "kirchhoff", "tangential_added_mass": 0.2, "rotational": "strip"},
    {"added_mass_form": "classic"},
    {"drag": PolynomialDrag(quadratic=False)},
    {"drag": PolynomialDrag(linear=False), "depth": 0.2},
]


@pytest.mark.parametrize("changes", FORMS)
def test_every_form_of_the_water_agrees(changes: dict[str, object]):
    eel = CASES["eel-like"]
    water = replace(eel.environment, current=(0.05, 0.02), **changes)
    case = Scenario(robot=lc.load_robot("mamba-fin"), motion=eel.gait, environment=water)
    (row,) = parity(case, "prescribed", (0.0125,), duration=3.0)
    assert row.path < 1e-6
    assert row.heading < 1e-6


@pytest.mark.parametrize("name", ["viscous", "coulomb"])
def test_the_ground_agrees(name: str):
    case = replace(CASES["lateral"], environment=lc.load_ground(name))
    (row,) = parity(case, "prescribed", (0.0002,), duration=1.5, reference_step=0.0002)
    assert row.path < 1e-5


def driven(robot: lc.Robot, **actuator: float) -> lc.Robot:
    joints = tuple(replace(j, actuator=replace(j.actuator, **actuator)) for j in robot.joints)
    return replace(robot, joints=joints, active_power=12.0)


@pytest.mark.parametrize("joints", STEPS)
def test_friction_of_its_own_kind_tracking_and_electrical_power_agree(joints: str):
    fin = CASES["fin"]
    water = replace(fin.environment, drag=PolynomialDrag(sway_friction=1.5), friction_taper=-0.6)
    robot = driven(fin.robot, tracking=0.8, friction_torque=0.1, viscous_friction=0.05)
    gait = replace(fin.gait, offset=0.1)
    dt = 0.005 if joints == "prescribed" else 0.001
    planar, spatial = (
        lc.swim(robot, gait, 3.0, environment=water, joints=joints, dt=dt, model=model)
        for model in ("planar", "spatial")
    )
    length = np.linalg.norm(planar.center_of_mass[-1])
    np.testing.assert_allclose(
        spatial.center_of_mass[:, :2], planar.center_of_mass, atol=2e-4 * length
    )
    np.testing.assert_allclose(spatial.joint_angle_ref, planar.joint_angle_ref, atol=1e-9)
    assert spatial.electrical_power == pytest.approx(planar.electrical_power, rel=1e-3)
    assert planar.mean_power_kind == spatial.mean_power_kind == "electrical"
    plain = lc.swim(fin.robot, gait, 3.0, environment=fin.environment, joints=joints, dt=dt)
    assert np.linalg.norm(plain.center_of_mass[-1] - planar.center_of_mass[-1]) > 0.005


def test_what_moves_up_and_down_has_the_friction_of_what_moves_sideways():
    from laticauda.water import mujoco as water
    from laticauda.water.mujoco.elements import Element

    mujoco = pytest.importorskip("mujoco")
    forces: list[float] = []
    for v in ((0.3, 0.4, 0.0), (0.3, 0.0, 0.4), (0.3, 0.24, -0.32), (0.3, 0.0, 0.0)):
        spec = mujoco.MjSpec.from_string(
            "<mujoco><option gravity='0 0 0'/><worldbody><body name='b'><freejoint/>"
            "<geom size='.1'/></body></worldbody></mujoco>"
        )
        model = water.compile_spec(spec)
        law = PolynomialDrag(quadratic=False, reference_speed=0.5, sway_friction=0.7)
        element = Element(body="b", drag=(2.0, 0.0, 0.0), law=law)
        handle = water.attach(model, (element,))
        data = mujoco.MjData(model)
        data.qvel[:3] = v
        mujoco.mj_forward(model, data)
        forces.append(float(handle.forces(data)["drag"][0, 0]))
    np.testing.assert_allclose(
        forces, [*[-2.0 * 0.3 * (0.5 + 0.7 * 0.4)] * 3, -2.0 * 0.3 * 0.5], rtol=1e-12
    )


def test_tether_pectoral_fins_and_trailing_edge_agree():
    robot = replace(
        CASES["fin"].robot,
        tether=Tether(drag=3.0, force=(-0.4, 0.2)),
        pectoral_fins=(
            PectoralFin(
                link=7,
                area=0.01,
                lift_slope=2.0,
                stall_angle=0.3,
                y=0.08,
                angle=0.2,
                parasitic_drag=0.02,
            ),
            PectoralFin(link=7, area=0.01, lift_slope=2.0, stall_angle=0.3, y=-0.08, angle=-0.1),
        ),
    )
    water = replace(
        CASES["fin"].environment,
        added_mass_form="kirchhoff",
        trailing_edge="elongated",
        current=(0.05, 0.02),
    )
    case = replace(CASES["fin"], robot=robot, environment=water)
    (row,) = parity(case, "prescribed", (0.00625,), duration=3.0, reference_step=0.001)
    assert (
        row.path < 5e-5
    )  # the wake's force jumps where u changes its sign: both models lose their order there
    bare = replace(case, robot=CASES["fin"].robot)
    paths = [
        lc.swim(c.robot, c.gait, 3.0, environment=c.environment).center_of_mass[-1]
        for c in (case, bare)
    ]
    assert np.linalg.norm(paths[0] - paths[1]) > 0.005  # it is not that they do nothing


@pytest.mark.parametrize("name", ["lateral", "fin"])
def test_the_law_of_the_total_speed_and_the_edge_of_the_tail_or_the_fin_agree(name: str):
    water = replace(
        CASES[name].environment,
        added_mass_form="kirchhoff",
        rotational="strip",
        current=(0.05, 0.02),
        added_mass=1.4,
    )
    shed = replace(water, trailing_edge="elongated", drag=TotalSpeedDrag())
    (row,) = parity(replace(CASES[name], environment=shed), "prescribed", (0.00625,), duration=3.0)
    assert row.path < 1e-4  # the jump of the wake's force again
    robot, gait = CASES[name].robot, CASES[name].gait
    waters = shed, replace(shed, trailing_edge="none"), replace(shed, drag=water.drag)
    ours, no_edge, other_law = (
        lc.swim(robot, gait, 3.0, environment=w).center_of_mass[-1] for w in waters
    )
    assert np.linalg.norm(ours - no_edge) > 0.005
    assert np.linalg.norm(ours - other_law) > 0.005


def test_thrusters_and_skin_agree():
    robot = CASES["lateral"].robot
    robot = replace(
        robot,
        joints=tuple(replace(j, stiffness=2.0, damping=0.3) for j in robot.joints),
        thrusters=(
            Thruster(link=0, thrust=2.0, angle=0.3, x=-0.05, y=0.02),
            Thruster(link=3, thrust=-1.0),
        ),
    )
    case = replace(CASES["lateral"], robot=robot)
    (prescribed,) = parity(case, "prescribed", (0.0125,), duration=3.0)
    (servo,) = parity(case, "servo", (0.001,), duration=3.0)
    assert prescribed.path < 1e-6
    assert servo.path < 1e-4


@pytest.mark.parametrize("joints", STEPS)
def test_forces_on_links_agree(joints: str):
    case = CASES["fin"]
    robot = replace(case.robot, thrusters=(Thruster(link=2, thrust=1.0, angle=0.3),))
    planar, spatial = (
        lc.swim(
            robot,
            case.gait,
            1.0,
            environment=case.environment,
            joints=joints,
            dt=2e-4,
            model=model,
            link_forces=True,
        )
        for model in ("planar", "spatial")
    )
    for name in ("drag", "added_mass", "effector"):
        expected = planar.link_force[name]
        scale = np.max(np.abs(expected))
        assert scale > 0.1
        np.testing.assert_allclose(spatial.link_force[name][..., :2], expected, atol=1e-3 * scale)
        np.testing.assert_allclose(spatial.link_force[name][..., 2], 0.0, atol=1e-9)


@pytest.mark.parametrize("joints", STEPS)
def test_torques_work_and_power_agree(joints: str):
    case = CASES["fin"]
    dt = 0.005 if joints == "prescribed" else 0.001
    trials = [
        lc.swim(
            case.robot,
            case.gait,
            3.0,
            environment=case.environment,
            joints=joints,
            dt=dt,
            model=model,
        )
        for model in ("planar", "spatial")
    ]
    planar, spatial = trials
    scale = np.max(np.abs(planar.joint_torque))
    np.testing.assert_allclose(spatial.joint_torque, planar.joint_torque, atol=2e-3 * scale)
    np.testing.assert_allclose(spatial.work[-1], planar.work[-1], rtol=1e-3)
    np.testing.assert_allclose(spatial.joint_angle, planar.joint_angle, atol=1e-4)
    np.testing.assert_allclose(
        spatial.center_of_mass_velocity[:, :2], planar.center_of_mass_velocity, atol=1e-4
    )
    np.testing.assert_allclose(spatial.heading_rate, planar.heading_rate, atol=1e-3)
    if joints == "servo":
        assert spatial.electrical_power == pytest.approx(planar.electrical_power, rel=1e-3)
