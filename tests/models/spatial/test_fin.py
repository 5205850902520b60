"""The fin that bends and the fin that is driven, in MuJoCo: accelerations and swims are those in the plane."""

import math
from dataclasses import replace

import campaign_scripts
import numpy as np
import pytest
from chains import kernels, random_robot, random_water
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.layout import build_layout
from laticauda.models.spatial import rows as spatial_rows
from laticauda.robot import CaudalFin, Joint
from laticauda.scenarios import limit_case

mujoco = pytest.importorskip("mujoco")

campaign = campaign_scripts.campaign("parity")
parity, FIN = campaign.parity, campaign.CASES["fin"]
WAVE = lc.Wave(amplitude=0.4, frequency=2.5, phase=1.0, offset=0.1)


def case(**changes):
    robot = replace(FIN.robot, caudal_fin=replace(FIN.robot.caudal_fin, **changes))
    gait = replace(FIN.gait, fin=WAVE) if "joint" in changes else FIN.gait
    return replace(FIN, robot=robot, motion=gait)


CASES = {
    "elastic": case(n_hinges=3, flexural_rigidity=2.0, bending_damping=0.05),
    "driven": case(joint=Joint(stiffness=0.5, damping=0.1)),
    "both": case(joint=Joint(), n_hinges=2, flexural_rigidity=0.5, opening="closed"),
}


@settings(max_examples=15, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 6),
    st.booleans(),
    st.sampled_from(["relative", "kirchhoff", "classic"]),
)
def test_accelerations_are_the_planar_ones_in_any_state(seed, n_hinges, driven, form):
    rng = np.random.default_rng(seed)
    fin = CaudalFin(
        opening=str(rng.choice(["open", "closed"])),
        n_hinges=n_hinges,
        flexural_rigidity=float(rng.uniform(0.1, 10.0)),
        bending_damping=float(rng.uniform(0.0, 0.5)),
        joint=Joint() if driven else None,
    )
    robot = replace(random_robot(rng, 4), caudal_fin=fin)
    water = random_water(rng, form)
    a = build_layout(robot, water)
    S = a.template.copy()
    body = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(
        -1, rows.BODY_ROWS
    )
    is_free = a.law != rows.LOCKED
    angle, rate = rng.uniform(-1.5, 1.5, is_free.sum()), rng.uniform(-3.0, 3.0, is_free.sum())
    body[is_free, rows.ANGLE], body[is_free, rows.RATE] = angle, rate
    body[:, rows.TOTAL_TORQUE] = (
        -body[:, rows.STIFFNESS] * body[:, rows.ANGLE] - body[:, rows.DAMPING] * body[:, rows.RATE]
    )
    kernels().evaluate(
        S, a.n_bodies, a.first_strip, a.first_plate, is_free, a.tail_link, a.has_extras
    )
    expected = body[is_free, rows.ACCELERATION]

    with limit_case():  # the fin may be longer than the robot
        plant = lc.build_plant(
            robot, water, model="spatial", root="planar", gravity=False, dt=0.001
        )
    model = plant.model
    data = mujoco.MjData(model)
    own = is_free.sum() - 3
    # There the joints of the body come first, and those of the fin follow from its root on.
    data.qpos[3:], data.qvel[3:] = (
        np.append(values[own:], values[:own][::-1]) for values in (angle, rate)
    )
    # The same place and motion of the whole: the planar state is at rest and straight ahead as a
    # mean.
    tail_shares = np.arange(3, 0, -1) / 4.0
    data.qpos[2] = -tail_shares @ angle[own:]
    data.qvel[2] = -tail_shares @ rate[own:]
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    data.qvel[:2] = -data.subtree_linvel[1][:2]
    mujoco.mj_forward(model, data)
    found = np.append(data.qacc[3:][3:][::-1], data.qacc[3:6])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("joints", ["prescribed", "pd", "servo"])
@pytest.mark.parametrize("name", CASES)
def test_the_difference_is_small_and_falls_with_the_step(name, joints):
    explicit = name == "driven" and joints == "prescribed"
    steps = (
        (0.05, 0.025) if explicit else (0.005, 0.0025) if joints == "prescribed" else (0.004, 0.002)
    )
    coarse, fine = parity(CASES[name], joints, steps, duration=4.0)
    assert fine.path < (1e-4 if joints == "prescribed" else 3e-3)
    assert fine.path < coarse.path / (10.0 if explicit else 2.5)
    assert fine.heading < 1e-3


@pytest.mark.parametrize("name", CASES)
def test_ten_seconds_of_swimming_agree_at_the_default_steps(name):
    both = CASES[name]
    planar, spatial = (
        lc.swim(both.robot, both.gait, 10.0, environment=both.environment, model=model)
        for model in ("planar", "spatial")
    )
    assert spatial.forward_velocity == pytest.approx(planar.forward_velocity, rel=2e-4)
    np.testing.assert_allclose(spatial.work[-1], planar.work[-1], rtol=2e-3)
    np.testing.assert_allclose(spatial.fin_angle, planar.fin_angle, atol=2e-3)
    assert set(planar.signals) <= set(spatial.signals)
    for signal in planar.signals:
        scale = np.abs(planar.signals[signal]).max()
        np.testing.assert_allclose(
            spatial.signals[signal], planar.signals[signal], atol=2e-2 * scale
        )


def test_forces_on_links_agree_with_a_bent_fin():
    both = CASES["elastic"]
    settings = {"environment": both.environment, "dt": 5e-4, "link_forces": True}
    planar, spatial = (
        lc.swim(both.robot, both.gait, 1.0, model=model, **settings)
        for model in ("planar", "spatial")
    )
    for name in ("drag", "added_mass"):
        expected = planar.link_force[name]
        np.testing.assert_allclose(
            spatial.link_force[name][..., :2], expected, atol=2e-3 * np.abs(expected).max()
        )


def test_a_run_goes_on_where_it_ended():
    both = CASES["both"]
    settings = {"environment": both.environment, "model": "spatial"}
    whole = lc.swim(both.robot, both.gait, 2.0, **settings)
    first = lc.swim(both.robot, both.gait, 1.0, **settings)
    rest = lc.resume(lc.build_plant(both.robot, both.environment, model="spatial"), first, 1.0)
    np.testing.assert_array_equal(lc.joined(first, rest).fin_angle, whole.fin_angle)


def test_a_free_root_with_weight_carries_an_elastic_fin():
    both = CASES["elastic"]
    settings = {"environment": both.environment, "model": "spatial", "root": "free"}
    bent, rigid = (lc.swim(robot, both.gait, 4.0, **settings) for robot in (both.robot, FIN.robot))
    assert bent.succeeded
    assert np.abs(bent.fin_angle).max() > 0.05
    np.testing.assert_allclose(
        bent.center_of_mass[:, 2], rigid.center_of_mass[:, 2], atol=0.01
    )  # both float up


@pytest.mark.parametrize("robot", [FIN.robot, CASES["elastic"].robot])
def test_a_robot_with_a_fin_lies_on_dry_ground(robot):
    still = replace(FIN.gait, amplitude=0.0)
    trial = lc.swim(
        robot, still, 1.0, environment=lc.load_ground("coulomb"), model="spatial", root="free"
    )
    assert trial.succeeded
    assert np.ptp(trial.center_of_mass[:, 2]) < 0.01


def test_an_actuator_turns_a_driven_fin_the_way_the_body_bends():
    from laticauda.models.spatial import mjcf

    robot = CASES["both"].robot
    model = mjcf.build_spec(robot, FIN.environment, actuators="servo", root="planar").compile()
    data = mujoco.MjData(model)
    data.joint("fin_joint").qpos[:] = 0.3
    mujoco.mj_forward(model, data)
    edge = data.body("caudal_fin_2").xmat.reshape(3, 3)[:, 0]
    assert math.atan2(edge[1], edge[0]) == pytest.approx(
        -0.3
    )  # what is behind the hinge turns right
    assert data.sensor("fin_angle").data[0] == pytest.approx(0.3)
    assert model.actuator("fin_servo").forcerange[1] == robot.caudal_fin.joint.actuator.stall_torque
    assert model.joint("fin_hinge_1").stiffness[0] == pytest.approx(
        robot.caudal_fin.hinges[0].stiffness
    )


SPANNED = replace(
    lc.load_water("paper-lateral"),
    added_mass_form="kirchhoff",
    rotational="strip",
    trailing_edge="finite-span",
)
SWIM = lc.eel_like(amplitude=0.4, frequency=2.0, phase_shift=0.7)


def broad_robot(**changes):
    robot = lc.load_robot("mamba-fin")
    fin = replace(robot.caudal_fin, length=0.12, height=0.2, opening_length=0.0, **changes)
    return replace(robot, caudal_fin=fin)


@pytest.mark.parametrize(("joints", "bound"), [("prescribed", 1e-5), ("servo", 1e-4)])
@pytest.mark.parametrize("fin", ["rigid", "driven"])
def test_the_edge_of_a_finite_span_swims_in_space_as_in_the_plane(joints, bound, fin):
    robot, gait = broad_robot(), SWIM
    if fin == "driven":
        robot = broad_robot(joint=lc.robot.Joint())
        gait = replace(SWIM, fin=lc.Wave(amplitude=0.3, frequency=2.0))
    ends = []
    for model in ("planar", "spatial"):
        settings = {"root": "planar"} if model == "spatial" else {}
        trial = lc.swim(
            robot, gait, 4.0, environment=SPANNED, joints=joints, dt=0.001, model=model, **settings
        )
        ends.append(trial.center_of_mass[-1, :2])
    assert np.linalg.norm(ends[0] - ends[1]) < bound * np.linalg.norm(ends[0])


def test_a_forked_fin_swims_in_space_as_in_the_plane():
    corners = ((0.0, 0.0), (0.0, 0.02), (0.08, 0.1), (0.12, 0.1), (0.06, 0.0))
    ends = []
    for model in ("planar", "spatial"):
        settings = {"root": "planar"} if model == "spatial" else {}
        trial = lc.swim(
            broad_robot(silhouette=corners),
            SWIM,
            4.0,
            environment=SPANNED,
            dt=0.001,
            model=model,
            **settings,
        )
        ends.append(trial.center_of_mass[-1, :2])
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-5 * np.linalg.norm(ends[0])


def test_a_run_with_an_edge_of_finite_span_is_resumed_in_space_to_the_last_bit():
    plant = lc.build_plant(broad_robot(), SPANNED, model="spatial")
    command = lc.Command(gait=SWIM)
    start = plant.init(lc.Start(velocity=0.1), command)
    whole = plant.march(start, command, 0.4, 0.1)
    half = plant.march(start, command, 0.2, 0.1)
    rest = plant.march(plant.unpack(plant.pack(half.state)), command, 0.2, 0.1)
    assert abs(whole.state.values[spatial_rows.EDGE_MEMORY]) > 1e-3
    assert np.array_equal(rest.state.values, whole.state.values)


def test_a_mujoco_model_of_ones_own_gets_no_edge_whose_state_it_would_not_advance():
    from laticauda.models.spatial import robot_elements

    with pytest.raises(
        ValueError,
        match=r"`trailing_edge` must be `elongated` or `none` for elements in a MuJoCo model of one's own",
    ):
        robot_elements(lc.load_robot("mamba-fin"), SPANNED)
