import math
from dataclasses import replace

import numpy as np
import pytest
from lab_parts import EXACT, Operator, make_tank

from laticauda import lateral_undulation
from laticauda.models.simulate import build_plant, swim
from laticauda.motion.gaits import Generator
from laticauda.robot import load_robot, load_water
from laticauda.robot.kinematics import center_of_mass as center_from_marker, link_angles
from laticauda.scenarios.interfaces import Start
from laticauda.tank.lab import Fault, LabSettings, NodeSettings, Tank, VirtualRobot
from laticauda.tank.protocol import Heartbeat, JointState, Loads, Sync
from laticauda.tank.protocol.meter import decode_displayed

QUICK = NodeSettings(startup_time=0.1, calibration_time=0.1)
GAIT = lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40)
)


def swum(operator, seconds):
    generator = Generator(n_links=10, ramp=0.0)
    state = generator.init(GAIT)
    heard = []
    for _ in range(round(seconds / 0.01)):
        angles = np.zeros(18)
        angles[::2] = generator.joints(state, GAIT)[0]
        heard += operator.cycle(angles)
        state = generator.step(state, GAIT, 0.01)
    return heard


def test_the_robot_swims_over_the_bus_as_it_swims_in_simulation(operator):
    operator.ready()
    begin = operator.tank.truth.center_of_mass
    swum(operator, 3.0)
    gone = np.linalg.norm(operator.tank.truth.center_of_mass - begin) / 3.0
    trial = swim(
        operator.tank.body.robot,
        GAIT,
        environment=load_water("paper-lateral"),
        joints="servo",
        duration=3.0,
    )
    assert gone == pytest.approx(trial.forward_velocity, rel=0.01)
    # Above idle: what the meter's supply gives, against what the servos take.
    taken = operator.tank.truth.electrical_work / 3.0
    assert taken == pytest.approx(trial.electrical_power, rel=0.02)


def test_the_same_calls_and_seed_give_the_same_frames():
    one, other, third = (
        Operator(make_tank(replace(LabSettings(seed=seed), nodes=QUICK))) for seed in (1, 1, 2)
    )
    heard = [swum(operator.ready(), 0.15) for operator in (one, other, third)]
    assert heard[0] == heard[1]
    assert heard[0] != heard[2]


def test_the_tail_and_the_joints_give_back_the_center_of_mass(operator):
    operator.ready()
    operator.tank.captured()
    swum(operator, 1.0)
    truth, tank = operator.tank.truth, operator.tank
    frame = tank.captured()[-1]
    assert frame.timestamp == pytest.approx(tank.time)
    (body,) = frame.bodies
    angle = math.atan2(body.rotation[1, 0], body.rotation[0, 0])
    robot = tank.body.plant.robot
    links = link_angles(truth.joint_angle[::2], angle=angle, link=0)
    found = center_from_marker(robot, body.position[:2], links, link=0)
    np.testing.assert_allclose(found, truth.center_of_mass[:2], atol=1e-9)
    assert np.mean(links) == pytest.approx(truth.heading, abs=1e-9)


def test_outside_the_cameras_volume_the_body_is_lost(operator):
    tank = operator.tank
    tank.carry(Start(center_of_mass=(0.0, 0.0)))
    tank.advance(0.1)
    assert all(body is not None for frame in tank.captured() for body in frame.bodies)
    tank.carry(Start(center_of_mass=(0.0, 2.8)))  # half of 5.45 m is 2.725 m
    tank.advance(0.1)
    assert all(body is None for frame in tank.captured() for body in frame.bodies)


def test_noise_is_what_the_settings_say():
    tank = make_tank(
        LabSettings(mocap=replace(LabSettings().mocap, reflection_share=0.0, lost_share=0.0))
    )
    tank.advance(4.0)
    frames = tank.captured()
    assert len(frames) == pytest.approx(396, abs=12)  # 1 % never come
    positions = np.array([frame.bodies[0].position for frame in frames])
    np.testing.assert_allclose(positions.std(axis=0), 0.001, rtol=0.15)
    yaw = [frame.bodies[0].rotation[1, 0] for frame in frames]
    assert np.std(yaw) == pytest.approx(0.00175, rel=0.15)


def test_reflections_are_rare_at_the_papers_depth_and_common_near_the_surface():
    def share(depth):
        exact = EXACT.mocap
        tank = make_tank(replace(EXACT, mocap=replace(exact, reflection_share=0.5)))
        tank.body.depth = depth
        tank.carry(Start())
        tank.advance(2.0)
        bodies = [frame.bodies[0] for frame in tank.captured()]
        return np.mean([body.residual > 1e-6 for body in bodies])

    assert share(0.15) < 0.02
    assert 0.3 < share(0.005) < 0.6


def test_at_rest_the_meter_shows_the_idle_current_and_accelerometers_show_gravity(operator):
    operator.ready(enable=False)
    operator.tank.advance(1.0)
    power = operator.tank.electronics.supply_current * operator.tank.electronics.voltage
    assert power == pytest.approx(41.3)  # the paper's 35 V x 1.18 A
    assert operator.tank.meter.reading.live == pytest.approx(1.18, abs=0.02)
    from laticauda.tank.protocol import Acceleration

    found = [m for m in operator.heard() if isinstance(m, Acceleration)][-18:]
    assert {(m.along, m.left, round(m.up, 6)) for m in found} == {(0.0, 0.0, 9.81)}


def test_the_meter_keeps_minimum_average_and_maximum(operator):
    operator.ready()
    assert operator.tank.answer("press minmax") == b"0\r"
    swum(operator, 2.0)
    reading = decode_displayed(operator.tank.answer("QDDA").split(b"\r")[1].decode())
    assert 1.18 < reading.minimum < reading.average < reading.maximum
    assert reading.duration == pytest.approx(2.0, abs=0.02)
    # Both instruments tell of the same work.
    taken = operator.tank.truth.electrical_work / 2.0 + 41.3
    assert reading.average * operator.tank.electronics.voltage == pytest.approx(taken, rel=0.1)


def test_a_dead_module_is_silent_and_limp_and_starts_up_anew(operator, straight):
    operator.ready()
    operator.cycle(straight, 5)
    operator.tank.inject(Fault(kind="dead_module", node=9, time=operator.tank.time, duration=1.0))
    operator.cycle(straight, 2)
    heard = operator.cycle(straight, 50)
    assert 9 not in {m.node for m in heard}
    operator.cycle(straight, 50)
    assert operator.states[8] == "STARTUP"


def test_a_node_that_is_off_the_bus_stops_by_itself_and_tells_of_it_later(operator, straight):
    operator.ready()
    operator.cycle(straight, 5)
    operator.tank.inject(Fault(kind="bus_off", node=4, time=operator.tank.time, duration=1.5))
    heard = operator.cycle(straight, 140)
    assert 4 not in {m.node for m in heard[100:]}
    assert operator.states[3] == "LIMP"
    heard = operator.cycle(straight, 30)
    assert any(m.bus_errors for m in heard if isinstance(m, Heartbeat) and m.node == 4)


def test_lost_and_corrupted_frames_are_as_many_as_asked_for(operator, straight):
    operator.ready()
    operator.tank.inject(Fault(kind="frame_loss", share=0.3, time=operator.tank.time))
    operator.cycle(straight)
    answers = sum(isinstance(m, JointState) for m in operator.cycle(straight, 80))
    assert answers / (80 * 18) == pytest.approx(
        0.7**2, abs=0.06
    )  # the sync may be lost, and the answer
    operator.tank.faults.clear()
    operator.tank.inject(Fault(kind="frame_corruption", share=1.0, time=operator.tank.time))
    operator.cycle(straight)
    operator.cycle(straight, 20)


def test_a_late_computer_is_heard_late(operator, straight):
    operator.ready()
    operator.tank.inject(Fault(kind="late_computer", delay=0.1, time=operator.tank.time))
    operator.tank.advance(0.02)
    operator.heard()
    assert not [m for m in operator.tell(Sync(counter=1)) if isinstance(m, JointState)]
    operator.tank.advance(0.08)
    assert not [m for m in operator.heard() if isinstance(m, JointState)]
    operator.tank.advance(0.04)
    assert [m for m in operator.heard() if isinstance(m, JointState)]


def test_cameras_and_meter_can_fail(operator):
    tank = operator.tank
    tank.advance(0.5)
    tank.captured()
    tank.inject(Fault(kind="mocap_silent", duration=1.0))
    tank.inject(Fault(kind="meter_silent", duration=1.0))
    tank.advance(0.2)
    tank.captured()
    tank.advance(0.1)
    assert (tank.captured(), tank.answer("QM")) == ([], b"")
    tank.faults.clear()
    tank.inject(Fault(kind="body_lost"))
    tank.advance(0.1)
    frames = tank.captured()
    assert len(frames) > 5
    assert all(frame.bodies == (None,) for frame in frames[2:])
    assert tank.answer("QM").startswith(b"0\r")


def test_a_sync_is_answered_with_what_is_so_at_that_moment(operator, straight):
    operator.ready()
    straight[4] = 1.0
    operator.cycle(straight, 10)
    time = operator.tank.time
    (first,) = [
        m for m in operator.tell(Sync(counter=1)) if isinstance(m, JointState) and m.node == 5
    ]
    (later,) = [
        m
        for m in operator.tell(Sync(counter=2), time + 0.005)
        if isinstance(m, JointState) and m.node == 5
    ]
    assert later.angle - first.angle == pytest.approx(0.005 * first.rate, rel=0.2)
    assert operator.tank.time == pytest.approx(time + 0.005)


def test_a_spatial_world_does_the_same():
    operator = Operator(make_tank(model="spatial")).ready()
    begin = operator.tank.truth.center_of_mass
    heard = swum(operator, 1.0)
    truth = operator.tank.truth
    assert np.linalg.norm(truth.center_of_mass - begin) > 0.01
    frame = operator.tank.captured()[-1]
    np.testing.assert_allclose(frame.bodies[0].position, truth.modules.position[0])
    answers = [m for m in heard if isinstance(m, JointState)][-18:]
    np.testing.assert_allclose([m.angle for m in answers], truth.joint_angle, atol=0.05)
    assert all(len(m.force) == 3 for m in heard if isinstance(m, Loads))


def test_the_truth_is_a_trial(operator):
    operator.ready()
    swum(operator, 1.0)
    trial = operator.tank.body.trial("0")
    assert trial.time[-1] == pytest.approx(operator.tank.time, abs=0.06)
    np.testing.assert_allclose(
        trial.center_of_mass[-1], operator.tank.truth.center_of_mass[:2], atol=0.02
    )


def test_modules_draw_their_share_of_the_active_power_while_their_motors_are_on():
    robot = replace(load_robot("mamba"), active_power=80.0)
    plant = build_plant(robot, load_water("paper-lateral"), joints="servo")
    world = VirtualRobot(robot, plant)
    still = np.zeros(robot.n_joints)
    on = np.arange(robot.n_joints) < robot.n_joints // 2
    nothing_on = np.zeros(robot.n_joints, dtype=bool)
    world.advance(still, nothing_on, 1.0)
    assert world.truth.electrical_work == pytest.approx(0.0, abs=1e-6)
    world.advance(still, nothing_on, 1.0, jammed=on)  # held by what jams them
    assert world.truth.electrical_work == pytest.approx(0.0, abs=1e-6)
    world.advance(still, on, 1.0)
    assert world.truth.electrical_work == pytest.approx(40.0)
    world.carry(Start(center_of_mass=(1.0, 0.0)))
    world.advance(still, on | True, 1.0)
    assert world.truth.electrical_work == pytest.approx(120.0)
    assert world.trial("0").electrical_power == pytest.approx(80.0)


def test_only_robots_with_servos_and_no_more_joints_than_nodes_fit():
    robot, water = load_robot("mamba"), load_water("paper-lateral")
    with pytest.raises(
        ValueError, match=r"`plant` must have `servo` or `speed-servo` joints, got 'prescribed'\."
    ):
        VirtualRobot(robot, build_plant(robot, water))
    many = load_robot("mamba", 21)
    with pytest.raises(
        ValueError, match=r"`robot` must have 1 to 19 joints, a driven fin's included, got 20\."
    ):
        Tank(VirtualRobot(many, build_plant(many, water, joints="servo")))
    with pytest.raises(
        ValueError, match="`plant` must have the 18 joints of the robot, or its 9 yaw joints, got 8"
    ):
        VirtualRobot(load_robot("mamba-modules"), build_plant(robot, water, joints="servo"))


class Recorded(VirtualRobot):
    """Keeps what it did, or does what another one did."""

    def __init__(self, current, done=None):
        robot, water = (
            load_robot("mamba-modules"),
            replace(load_water("paper-lateral"), current=current),
        )
        super().__init__(robot, build_plant(robot, water, joints="servo"))
        self.done, self.again = [], iter(done or ())

    def advance(self, references, on, dt, *, jammed=None):
        self.truth = next(self.again, None) or self._swum(references, on, dt, jammed=jammed)
        self.done.append(self.truth)

    def _swum(self, references, on, dt, *, jammed):
        super().advance(references, on, dt, jammed=jammed)
        return self.truth


def without_forces(messages):
    return [replace(m, force=None) if isinstance(m, Loads) else m for m in messages]


def test_what_modules_and_cameras_say_is_what_the_robot_does_and_nothing_of_the_water():
    moving = Recorded((0.08, -0.05))
    tanks = [Tank(moving, EXACT)]
    heard = [swum(Operator(tanks[0]).ready(), 0.5)]
    assert np.hypot(*moving.truth.center_of_mass[:2]) > 0.01  # carried along
    tanks.append(Tank(Recorded((0.0, 0.0), moving.done), EXACT))
    heard.append(swum(Operator(tanks[1]).ready(), 0.5))
    # Forces of the force/torque sensors are what the water does to such a motion.
    assert without_forces(heard[0]) == without_forces(heard[1])
    one, other = (
        [
            (frame.timestamp, *frame.bodies[0].position, *frame.bodies[0].rotation.flat)
            for frame in tank.captured()
        ]
        for tank in tanks
    )
    assert one == other
    assert tanks[0].answer("QDDA") == tanks[1].answer("QDDA")


def test_the_water_goes_on_when_the_robot_is_carried():
    body = Recorded((0.1, 0.0))
    tank = Tank(body, EXACT)
    tank.advance(1.0)
    tank.carry(Start(center_of_mass=(2.0, 0.0)))
    assert body.truth.time == pytest.approx(1.0, abs=1e-5)
    tank.advance(0.5)
    assert body.truth.time == pytest.approx(1.5, abs=1e-5)
    assert body.trial("0").time[0] == pytest.approx(1.0, abs=1e-5)
