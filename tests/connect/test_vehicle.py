"""A robot that another program steps and sees as one body."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect.vehicle import Vehicle, count_ranges
from laticauda.connect.vehicle_motion import mean_rotation, rotation_vector
from laticauda.scenarios import Command, Resumed
from laticauda.sensing import Altimeter, Sonar, Wall
from laticauda.values import BadArgument

GAIT = lc.lateral_undulation(amplitude=0.4, frequency=4.0, phase_shift=0.7)
INTERVAL = 0.01
WALL = Wall(name="wall", begin=(4.0, -3.0), end=(4.0, 3.0))


def scenario_in(kind, /, **changes):
    scenario = lc.build_scenario("mamba", GAIT, model=kind, joints="servo")
    return replace(scenario, **changes)


def turned_by(vector):
    """Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


@pytest.mark.parametrize("of_head", [False, True])
@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_inertial_measurements_sum_up_to_attitude_and_velocity(model, of_head):
    vehicle = Vehicle(scenario_in(model), of_head=of_head)
    command = Command(gait=GAIT, offset=0.2)
    steps = [vehicle.step(command, INTERVAL) for _ in range(100)]
    begin = steps[9].motion
    rotation, velocity = begin.rotation, begin.velocity
    for step in steps[10:]:
        rotation = rotation @ turned_by(step.inertial.angular_velocity * INTERVAL)
        felt = rotation @ step.inertial.specific_force - [0.0, 0.0, 9.80665]
        velocity = velocity + felt * INTERVAL
    end = steps[-1].motion
    assert rotation == pytest.approx(end.rotation, abs=1e-9)
    assert velocity == pytest.approx(end.velocity, abs=1e-9)
    assert end.time == pytest.approx(1.0)


def test_the_head_is_half_a_body_ahead_of_a_straight_robot():
    start = lc.Start(center_of_mass=(1.0, 2.0), heading=math.pi / 2)
    still = replace(GAIT, amplitude=0.0)
    for model in ("planar", "spatial"):
        scenario = scenario_in(model, start=start, motion=still)
        body = Vehicle(scenario).step(Command(gait=still), 1e-6).motion
        head = Vehicle(scenario, of_head=True).step(Command(gait=still), 1e-6).motion
        robot = scenario.robot
        ahead = 0.5 * robot.length - robot.modules[-1].half_length
        assert head.position[:2] == pytest.approx([1.0, 2.0 + ahead], abs=1e-5)
        assert body.position[:2] == pytest.approx([1.0, 2.0], abs=1e-5)
        assert body.rotation[:, 0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-5)
        assert body.tail_end[:2] == pytest.approx([1.0, 2.0 - 0.5 * robot.length], abs=1e-5)
        assert body.tail_rotation[:, 0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-5)


def test_a_step_tells_the_power_of_joints_and_electronics():
    robot = replace(lc.load_robot("mamba"), electronics_power=40.0)
    still = replace(GAIT, amplitude=0.0)
    resting = Vehicle(scenario_in("planar", robot=robot, motion=still))
    assert resting.step(Command(gait=still), 0.1).power == pytest.approx(40.0, abs=0.1)
    swimming = Vehicle(scenario_in("planar", robot=robot))
    power = [swimming.step(Command(gait=GAIT), 0.1).power for _ in range(20)][-1]
    assert power > 42.0


def test_a_reset_begins_again():
    vehicle = Vehicle(scenario_in("planar"))
    first = [vehicle.step(Command(gait=GAIT), INTERVAL).motion.position for _ in range(5)]
    vehicle.reset()
    again = [vehicle.step(Command(gait=GAIT), INTERVAL).motion.position for _ in range(5)]
    assert np.array_equal(first, again)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_sonar_and_altimeter_tell_distances_at_their_rate_and_rays_come_first(model):
    sonar = Sonar(beams=(0.0, math.pi / 2), rate=10.0, noise=0.0)
    scenario = scenario_in(model, motion=replace(GAIT, amplitude=0.0))
    settings = {"sensors": (sonar, Altimeter(noise=0.0)), "places": (WALL,)}
    if model == "spatial":
        settings["rays"] = (0.0,)
    vehicle = Vehicle(replace(scenario, model=replace(scenario.model, **settings)))
    still = Command(gait=replace(GAIT, amplitude=0.0))
    steps = [vehicle.step(still, INTERVAL) for _ in range(15)]
    ranges = steps[-1].ranges
    ahead = 4.0 - 0.5 * scenario.robot.length
    assert count_ranges(vehicle.scenario.model) == len(ranges)
    assert ranges[-3:] == pytest.approx((ahead, math.inf, math.inf), abs=0.1)
    if model == "spatial":
        assert ranges[0] == pytest.approx(ranges[1], abs=1e-3)
    news = [step.readings["sonar"].is_new for step in steps]
    assert sum(news) == 2
    vehicle.reset()
    assert vehicle.step(still, INTERVAL).readings["sonar"].is_new


def test_a_record_is_a_trial_of_the_run_since_the_last_reset(tmp_path):
    vehicle = Vehicle(scenario_in("planar"))
    assert vehicle.record.trial() is None
    vehicle.step(Command(gait=GAIT), INTERVAL)
    vehicle.reset()
    for _ in range(200):
        step = vehicle.step(Command(gait=GAIT), INTERVAL)
    vehicle.record.trial().save(tmp_path / "run.nc")
    trial = lc.load_trial(tmp_path / "run.nc")
    assert trial.time == pytest.approx(np.arange(0.0, 2.01, 0.05))
    assert trial.joint_angle[-1] == pytest.approx(step.log.joint_angle[-1])
    assert trial.status == "Stepped by another program."
    assert trial.forward_velocity > 0.0


def test_a_rotation_vector_is_the_inverse_of_rodrigues_also_for_tiny_turns():
    for size in (1e-10, 1e-3, 1.0, 3.0):
        vector = size * np.array([0.6, -0.64, 0.48])
        assert rotation_vector(turned_by(vector)) == pytest.approx(vector, rel=1e-6)
    assert rotation_vector(np.eye(3)) == pytest.approx(np.zeros(3))


def test_the_body_as_a_whole_points_where_its_modules_point_on_average():
    bent = np.stack([turned_by(np.array([0.0, 0.0, angle])) for angle in (-0.4, 0.1, 0.6)])
    assert mean_rotation(bent) == pytest.approx(turned_by(np.array([0.0, 0.0, 0.1])))


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"model": lc.Planar(joints=lc.Servo(), loop_delay=0.1)}, "loop_delay.*must be 0.*0.1 s"),
        ({"start": Resumed(state={"planar": (0.0,)})}, "start.*must be a start at rest"),
    ],
)
def test_scenarios_that_cannot_be_stepped_from_outside_are_refused(change, rule):
    with pytest.raises(BadArgument, match=rule):
        Vehicle(scenario_in("planar", **change))
