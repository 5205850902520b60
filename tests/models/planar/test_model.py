from dataclasses import replace

import numpy as np
import pytest
from chains import laid_out

import laticauda as lc
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import (
    Actuator,
    CaudalFin,
    Ground,
    Joint,
    PectoralFin,
    Tether,
    load_robot,
    load_water,
)
from laticauda.values.errors import SimulationFailed
from laticauda.water.fluid.laws import CoulombFriction, FunctionDrag, PolynomialDrag

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
WATER = load_water("paper-lateral")


def distance(robot, duration=10.0, **choices):
    return float(
        np.linalg.norm(lc.swim(robot, GAIT, duration=duration, **choices).center_of_mass[-1])
    )


def test_a_fin_of_links_swims_like_a_folded_fin():
    robot = load_robot("mamba-fin")
    command, start = lc.Command(gait=GAIT), lc.Start()
    paths = []
    for fin_as_links in (False, True):
        plant = PlanarPlant(robot=robot, environment=WATER)
        vars(plant)["layout"] = laid_out(robot, WATER, fin_as_links)
        log = plant.march(plant.init(start, command), command, 5.0, 0.1, link_forces=True)[1]
        paths.append(
            (
                log.center_of_mass,
                log.joint_torque,
                log.link_force["drag"],
                log.link_force["added_mass"],
            )
        )
    for folded, links in zip(*paths, strict=True):
        np.testing.assert_allclose(links, folded, atol=1e-7)


def test_the_speed_is_converged_in_the_number_of_fin_strips():
    robot = load_robot("mamba-fin")
    fine = replace(robot, caudal_fin=replace(robot.caudal_fin, n_strips=32))
    assert distance(robot) == pytest.approx(distance(fine), rel=1e-3)


def test_the_fin_makes_the_robot_faster_as_measured():
    assert distance(load_robot("mamba-fin"), 30.0) > 1.2 * distance(load_robot("mamba"), 30.0)


def test_a_bigger_fin_takes_more_power():
    small = load_robot("mamba-fin")
    big = replace(small, caudal_fin=CaudalFin(length=0.5, height=0.18))
    assert lc.swim(big, GAIT).mechanical_power > lc.swim(small, GAIT).mechanical_power


def test_a_thruster_pushes_the_robot_along():
    pushed = lc.swim(load_robot("mamba-thruster"), GAIT)
    assert pushed.forward_velocity > lc.swim(load_robot("mamba"), GAIT).forward_velocity


def test_a_tether_slows_the_robot_down():
    robot = load_robot("mamba")
    assert distance(replace(robot, tether=Tether(drag=5.0))) < distance(robot)


def test_an_angled_pectoral_fin_steers_to_its_own_side_and_its_mirror_image_to_the_other():
    robot = load_robot("mamba")

    def steered(angle):
        fin = PectoralFin(
            link=8, x=0.0, y=0.0, angle=angle, area=0.02, lift_slope=3.0, stall_angle=0.3
        )
        return lc.swim(replace(robot, pectoral_fins=(fin,)), GAIT, duration=20.0).heading[-1]

    left, right, none = steered(0.3), steered(-0.3), steered(0.0)
    assert left > none > right


def test_drag_on_a_plate_beside_the_body_turns_the_robot_to_the_side_of_the_plate():
    """Along the chord there is only drag, which pulls back at the arm y: the moment is -y f_t."""
    robot, still = load_robot("mamba"), replace(GAIT, amplitude=0.0)

    def turned(y):
        fin = PectoralFin(
            link=5, y=y, area=0.02, lift_slope=0.0, stall_angle=0.3, parasitic_drag=1.0
        )
        plated = replace(robot, pectoral_fins=(fin,))
        return lc.swim(plated, still, duration=1.0, start=lc.Start(velocity=0.3)).heading[-1]

    assert turned(0.1) > 1e-4
    assert turned(-0.1) == pytest.approx(-turned(0.1), rel=1e-6)


def test_friction_that_grows_with_the_sideways_speed_slows_the_robot_down():
    robot = load_robot("mamba")
    with_sway = replace(WATER, drag=PolynomialDrag(sway_friction=1.0))
    assert distance(robot, environment=with_sway) < 0.95 * distance(robot)
    # Towed straight, nothing moves sideways.
    towed, gait = replace(robot, tether=Tether(force=(1.0, 0.0))), replace(GAIT, amplitude=0.0)
    plain, sway = (
        lc.swim(towed, gait, duration=5.0, environment=water) for water in (WATER, with_sway)
    )
    np.testing.assert_array_equal(sway.center_of_mass, plain.center_of_mass)


def tracking(robot, share):
    return replace(
        robot,
        joints=tuple(
            replace(j, actuator=replace(j.actuator, tracking=share)) for j in robot.joints
        ),
    )


def test_prescribed_joints_do_their_share_of_the_oscillation_and_all_of_the_offset():
    gait = replace(GAIT, offset=0.1)
    trial = lc.swim(tracking(load_robot("mamba"), 0.8), gait)
    whole, less = (
        lc.swim(load_robot("mamba"), g)
        for g in (gait, replace(gait, amplitude=0.8 * gait.amplitude))
    )
    np.testing.assert_allclose(trial.joint_angle, less.joint_angle, atol=1e-12)
    np.testing.assert_allclose(trial.center_of_mass, less.center_of_mass, atol=1e-9)
    np.testing.assert_allclose(trial.joint_angle_ref, whole.joint_angle_ref, atol=1e-12)


@pytest.mark.parametrize("joints", ["pd", "servo"])
def test_driven_joints_do_not_look_at_the_share(joints):
    robot = load_robot("mamba")
    trials = [
        lc.swim(tracking(robot, share), GAIT, duration=2.0, joints=joints) for share in (1.0, 0.5)
    ]
    np.testing.assert_array_equal(trials[1].center_of_mass, trials[0].center_of_mass)
    np.testing.assert_array_equal(trials[1].joint_angle_ref, trials[0].joint_angle_ref)


@pytest.mark.parametrize("joints", ["prescribed", "pd", "servo"])
def test_every_joint_law_has_an_electrical_power_that_is_what_its_motors_draw_and_the_electronics(
    joints,
):
    robot = load_robot("mamba-fin")
    plain = lc.swim(robot, GAIT, duration=4.0, joints=joints, sample_interval=0.01)
    motors, both = (
        lc.swim(
            replace(robot, active_power=power),
            GAIT,
            duration=4.0,
            joints=joints,
            sample_interval=0.01,
        )
        for power in (0.0, 25.0)
    )
    assert plain.mean_power_kind == ("electrical" if joints == "servo" else "mechanical")
    np.testing.assert_array_equal(motors.center_of_mass, plain.center_of_mass)
    assert motors.mean_power_kind == "electrical"
    assert both.mean_power - motors.mean_power == pytest.approx(25.0, rel=1e-12)
    assert motors.electrical_power >= motors.positive_power > 0.0
    if joints == "servo":
        np.testing.assert_array_equal(motors.electrical_work, plain.electrical_work)
    power = np.zeros(motors.time.size)
    servo = robot.joints[0].actuator
    for torque, rate in zip(motors.joint_torque.T, motors.joint_rate.T, strict=True):
        current = torque / servo.stall_torque
        power += 34.04 * np.maximum((current + rate / servo.no_load_speed) * current, 0.0)
    assert motors.electrical_work[-1] == pytest.approx(np.trapezoid(power, motors.time), rel=0.01)


def test_a_batch_of_robots_with_and_without_a_power_model_has_the_powers_of_single_runs():
    robot = load_robot("mamba")
    robots = [robot, replace(robot, active_power=10.0), replace(robot, active_power=0.0), robot]
    found = lc.swim_many(robots, GAIT, 3.0).mean_power
    np.testing.assert_allclose(
        found, [lc.swim(one, GAIT, duration=3.0).mean_power for one in robots], rtol=1e-10
    )


def test_near_the_surface_the_added_mass_is_larger_and_the_speed_changes_a_little():
    near = distance(load_robot("mamba"), environment=replace(WATER, depth=0.1))
    assert near == pytest.approx(distance(load_robot("mamba")), rel=0.1)
    assert near != distance(load_robot("mamba"))


def test_a_current_carries_the_robot_along():
    still = lc.swim(load_robot("mamba"), GAIT, duration=30.0).center_of_mass[-1]
    carried = lc.swim(
        load_robot("mamba"), GAIT, duration=30.0, environment=replace(WATER, current=(0.0, 0.05))
    )
    assert carried.center_of_mass[-1, 1] == pytest.approx(still[1] + 1.5, abs=0.15)


@pytest.mark.parametrize("joints", ["prescribed", "pd", "servo"])
@pytest.mark.parametrize("friction", ["viscous", "coulomb"])
def test_the_same_robot_crawls_on_the_ground(joints, friction):
    ground = lc.load_ground(friction)
    trial = lc.swim(load_robot("mamba"), GAIT, duration=5.0, environment=ground, joints=joints)
    assert trial.succeeded
    assert trial.center_of_mass[-1, 0] > 0.05


def test_without_anisotropy_dry_friction_does_not_propel():
    same = Ground(name="same", friction=CoulombFriction(), tangential=0.3, normal=0.3)
    assert distance(load_robot("mamba"), environment=same) < 0.2 * distance(
        load_robot("mamba"), environment=lc.load_ground("coulomb")
    )


def test_the_elongated_trailing_edge_changes_the_speed_with_a_fin():
    kirchhoff = replace(WATER, added_mass_form="kirchhoff")
    elongated = replace(kirchhoff, trailing_edge="elongated")
    robot = load_robot("mamba-fin")
    assert distance(robot, environment=elongated) != pytest.approx(
        distance(robot, environment=kirchhoff), rel=1e-3
    )


def test_kirchhoff_is_slower_than_relative_by_the_percentages_of_the_literature():
    kirchhoff = replace(WATER, added_mass_form="kirchhoff")
    ratio = distance(load_robot("mamba"), 30.0, environment=kirchhoff) / distance(
        load_robot("mamba"), 30.0
    )
    assert 0.975 < ratio < 1.005
    eel = replace(load_water("paper-eel"), added_mass_form="kirchhoff")
    gait = lc.eel_like(
        amplitude=np.deg2rad(50), frequency=np.deg2rad(110), phase_shift=np.deg2rad(40)
    )
    slow, usual = (
        lc.swim(load_robot("mamba"), gait, environment=eel),
        lc.swim(load_robot("mamba"), gait),
    )
    assert 0.86 < slow.forward_velocity / usual.forward_velocity < 0.94


def test_an_observation_of_a_state_is_the_sample_of_the_log():
    plant = lc.build_plant(load_robot("mamba-modules"), WATER)
    command = lc.Command(gait=GAIT)
    state, log, failure = plant.march(plant.init(lc.Start(heading=0.3), command), command, 2.0, 0.5)
    seen = plant.observe(state)
    assert failure is None
    assert seen.time == 2.0
    assert seen.link_angle.mean() == pytest.approx(
        seen.heading, abs=0.03
    )  # links of two lengths count the same
    np.testing.assert_array_equal(seen.link_angle, log.link_angle[-1])
    np.testing.assert_array_equal(plant.step(state, command, 0.1).values[0], 2.1)


def test_a_steering_offset_turns_left_and_can_change_while_swimming():
    plant = lc.build_plant(load_robot("mamba"), WATER)
    straight, left = lc.Command(gait=GAIT), lc.Command(gait=GAIT, offset=np.deg2rad(5))
    state = plant.march(plant.init(lc.Start(), straight), straight, 5.0, 0.1)[0]
    kept = plant.march(state, straight, 10.0, 0.1)[1]
    turned = plant.march(state, left, 10.0, 0.1)[1]
    assert turned.heading[-1] > kept.heading[-1] + 0.3
    np.testing.assert_array_equal(turned.joint_angle[0], kept.joint_angle[0])
    assert np.abs(np.diff(turned.joint_rate, axis=0)).max() < 1.0


@pytest.mark.usefixtures("limit_case")
def test_absurd_gains_end_as_a_failed_trial_that_says_when_and_what_to_try():
    wild = Joint(actuator=Actuator(proportional_gain=0.0, derivative_gain=0.0))
    robot = load_robot("mamba")
    robot = replace(robot, joints=(wild,) * robot.n_joints)
    gait = lc.Gait(amplitude=3.0, frequency=300.0, phase_shift=0.7)
    trial = lc.swim(robot, gait, joints="pd")
    assert not trial.succeeded
    assert "The run diverged at t = " in trial.status
    assert (
        "; try a smaller `dt`, or lower `proportional_gain` and `derivative_gain`." in trial.status
    )
    assert np.all(np.isfinite(trial.center_of_mass))
    with pytest.raises(SimulationFailed, match="The run diverged at t = "):
        lc.swim(robot, gait, joints="pd", throw=True)
    with pytest.raises(
        ValueError, match="`trial` must have run to its end and hold its final state"
    ):
        lc.resume(lc.build_plant(robot, WATER, joints="pd"), trial, 1.0)


def by_function(function):
    return replace(WATER, drag=FunctionDrag(function=function))


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"duration": 0.0}, "`duration` must be > 0 s, got 0.0."),
        ({"duration": float("nan")}, "`duration` must be a finite number in s, got nan."),
        ({"duration": float("inf")}, "`duration` must be a finite number in s, got inf."),
        ({"duration": 1e9}, "`duration` must be between 0 and 1e+06 s, got 1000000000.0."),
        ({"duration": "long"}, "`duration` must be a number in s, got 'long'."),
        ({"sample_interval": -0.1}, "`sample_interval` must be > 0 s, got -0.1."),
        ({"dt": 0.0}, "`dt` must be between 1e-07 and 1000 s, got 0.0."),
        (
            {"duration": 2e5},
            "`duration` must be <= 100000 s at a `sample_interval` of 0.05 s, got 200000",
        ),
        (
            {"environment": replace(WATER, normal_drag=1e12)},
            "`environment` must let a link glide for at least 1e-07 s",
        ),
        ({"ramp": -1.0}, "`ramp` must be >= 0 s, got -1.0."),
        ({"offset_bandwidth": 0.0}, "`offset_bandwidth` must be > 0 1/s, got 0.0."),
        ({"joints": "servos"}, "`joints` must be one of"),
        ({"model": "special"}, "`model` must be"),
        ({"environment": by_function(3)}, "`function` must be a plain Python function, got 3"),
        (
            {"environment": by_function(lambda v: v)},
            "`<lambda>` must have a formula that Numba can compile: ",
        ),
        (
            {"environment": by_function(lambda a, b, c, d, e: a.nothing)},
            "must have a formula that Numba can compile: ",
        ),
        (
            {"environment": by_function(lambda a, b, c, d, e: a)},
            "`<lambda>` must return three finite numbers",
        ),
        ({"environment": "paper-eels"}, "there is no water preset named `paper-eels`"),
        ({"environment": 3}, "`environment` must be of class Water or Ground, got int."),
        ({"environment": replace(WATER, depth=0.05)}, "`depth` must be > 0.055 m"),
    ],
)
def test_a_bad_argument_is_refused_with_its_rule(choices, message):
    with pytest.raises(ValueError) as refused:
        lc.swim(load_robot("mamba"), GAIT, **{"duration": 1.0, **choices})
    assert message in str(refused.value)


def test_a_gait_for_another_number_of_joints_is_refused():
    gait = lc.custom_gait(envelope=[1.0, 0.5], amplitude=0.5, frequency=2.0, phase_shift=0.7)
    with pytest.raises(ValueError, match="`envelope` must have one value per joint"):
        lc.swim(load_robot("mamba"), gait)


def test_a_state_of_another_robot_is_refused():
    short = lc.swim(load_robot("mamba", n_links=5), GAIT, duration=1.0)
    with pytest.raises(ValueError, match="`state` must be that of a planar run of 9 links"):
        lc.resume(lc.build_plant(load_robot("mamba"), WATER), short, 1.0)


def test_a_start_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match=r"`heading` must be a finite number in rad, got nan\."):
        lc.Start(heading=float("nan"))


def test_a_name_is_a_preset_of_a_robot_and_a_gait_needs_more():
    assert lc.swim("mamba", GAIT, 1.0).robot == load_robot("mamba")
    with pytest.raises(ValueError, match="there is no robot preset named `mambo`"):
        lc.swim("mambo", GAIT)
    with pytest.raises(ValueError, match="`gait` by name needs its numbers, too"):
        lc.swim(load_robot("mamba"), "eel_like")


@pytest.mark.usefixtures("limit_case")
def test_a_run_that_cannot_even_start_is_a_failed_trial_too():
    water = replace(WATER)
    object.__setattr__(water, "current", (1e300, 0.0))  # nothing that can be asked for does it
    trial = lc.swim(load_robot("mamba"), GAIT, environment=water)
    assert not trial.succeeded
    assert trial.status.startswith("The run diverged at t = 0 s")
    assert trial.time.size == 1


def test_a_start_beyond_the_digits_of_a_number_is_refused():
    with pytest.raises(
        ValueError, match=r"`heading` must be between -100000 and 100000 rad, got 1e\+300"
    ):
        lc.Start(heading=1e300)


def test_the_plant_of_a_trial_is_made_again():
    trial = lc.swim(
        load_robot("mamba-modules"), GAIT, duration=1.0, joints="pd", dt=0.001, offset_bandwidth=4.0
    )
    assert lc.build_plant(trial.scenario).settings == trial.scenario.model
