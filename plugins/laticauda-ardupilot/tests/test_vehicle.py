"""A scenario that servo outputs step: its bits, its axes, its sensors."""

import json
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.spatial.scene import Pegs
from laticauda.robot import Thruster
from laticauda.scenarios import Controller, Resumed, load_scenario
from laticauda.sensing import Sonar, Wall
from laticauda.values import BadArgument
from laticauda_ardupilot import Battery, Mixing, Vehicle, load_mixing
from laticauda_ardupilot.attitude import euler_angles
from laticauda_ardupilot.channels import Amplitude, Frequency, Offset, Thrust
from laticauda_ardupilot.mixing import FILES
from laticauda_ardupilot.packets import NO_RETURN, write_sensor_line
from laticauda_ardupilot.schedules import Schedule

RATE = 400
N_FRAMES = 512
"""A power of two: the duration of a run of so many frames divides into them without rounding."""
GAIT = lc.lateral_undulation(amplitude=0.3, frequency=2.0, phase_shift=0.7)
STEERED = Mixing(
    channels=(
        Amplitude(servo=1, at_min=0.1, at_trim=0.3, at_max=0.6),
        Frequency(servo=2, at_min=1.0, at_trim=2.0, at_max=4.0),
        Offset(servo=3, at_min=0.4, at_max=-0.4),
    )
)


@dataclass(frozen=True)
class Played(Controller[int]):
    """Plays commands, one per frame."""

    commands: tuple[lc.Command, ...]
    gait: lc.Gait = GAIT
    interval: float = 1.0 / RATE

    def init(self):
        return 0

    def step(self, state, observation):
        return state + 1, self.commands[state]


def pulses(n, seed=0):
    """Pulses of an unsteady pilot: new ones every ten frames."""
    rng = np.random.default_rng(seed)
    widths = rng.integers(1100, 1901, size=(n // 10 + 1, 3)).tolist()
    return [(*widths[k // 10], *[0] * 13) for k in range(n)]


def planar():
    return lc.build_scenario("mamba", GAIT, environment="paper-lateral", joints="servo")


@pytest.mark.parametrize("which", ["planar", "prescribed", "eel"])
def test_a_run_is_that_of_swim_under_the_same_commands_bit_for_bit(which):
    scenario, mixing = planar(), STEERED
    if which == "prescribed":
        scenario = replace(scenario, model=lc.Planar())
    if which == "eel":
        scenario, mixing = load_scenario(FILES / "eel.toml"), load_mixing("eel")
    vehicle = Vehicle(scenario, mixing)
    commands, times, places = [], [], []
    for pwm in pulses(N_FRAMES):
        vehicle.step(pwm, 1 / RATE)
        commands.append(vehicle.command)
        observation = vehicle.robot.plant.observe(vehicle.robot.state)
        times.append(observation.time)
        places.append(observation.center_of_mass)
    played = replace(
        scenario,
        motion=Played(tuple(commands), gait=scenario.gait),
        duration=N_FRAMES / RATE,
        sample_interval=1 / RATE,
    )
    trial = lc.swim(played)
    assert np.array_equal(trial.time[1:], times)
    assert np.array_equal(trial.center_of_mass[1:], places)
    for name, values in vehicle.robot.plant.pack(vehicle.robot.state).items():
        assert np.array_equal(trial.state[name], values), name
    assert np.ptp(places, axis=0).max() > 1e-3


@pytest.mark.parametrize("seed", range(5))
def test_a_bad_network_leaves_the_run_that_its_frames_make_bit_for_bit(seed):
    wave = Amplitude(servo=1, pwm_min=1000, pwm_trim=1000, pwm_max=1060, at_max=0.5)
    mixing = Mixing(channels=(wave,))
    vehicle = Vehicle(planar(), mixing)
    schedule = Schedule(seed, n_frames=60, robot=vehicle).run()
    steps = schedule.vehicle
    undisturbed = Vehicle(planar(), mixing)
    for pulse, duration in zip(steps.pulses, steps.durations, strict=True):
        undisturbed.step((pulse, *[0] * 15), duration)
    assert np.array_equal(vehicle.robot.state.values, undisturbed.robot.state.values)
    assert undisturbed.robot.state.values.any()


def test_a_reset_begins_the_same_run_again():
    vehicle = Vehicle(planar(), replace(STEERED, battery=Battery()))
    first = [vehicle.step(pwm, 1 / RATE) for pwm in pulses(40)]
    vehicle.reset()
    again = [vehicle.step(pwm, 1 / RATE) for pwm in pulses(40)]
    for one, other in zip(first, again, strict=True):
        assert one.time == other.time
        assert np.array_equal(one.position, other.position)
        assert np.array_equal(one.acceleration, other.acceleration)
        assert one.voltage == other.voltage


def test_axes_are_north_east_down_and_a_turn_to_the_right_is_positive():
    scenario = replace(planar(), start=lc.Start(center_of_mass=(3.0, 2.0), heading=0.5))
    vehicle = Vehicle(scenario, STEERED)
    at_rest = vehicle.step((1500,) * 16, 1e-6)
    assert at_rest.position == pytest.approx([3.0, -2.0, 0.0], abs=1e-6)
    assert at_rest.attitude == pytest.approx([0.0, 0.0, -0.5], abs=1e-6)
    assert at_rest.acceleration[2] == pytest.approx(-9.80665)
    right = (1900, 1900, 1900, *[0] * 13)
    for _ in range(6 * RATE // 4):
        reading = vehicle.step(right, 4 / RATE)
    assert reading.attitude[2] > -0.3


@pytest.mark.parametrize("attitude", ["body", "head"])
def test_gyroscopes_and_accelerometers_sum_up_to_attitude_and_velocity(attitude):
    vehicle = Vehicle(
        load_scenario(FILES / "eel.toml"), replace(load_mixing("eel"), attitude=attitude)
    )
    readings = [vehicle.step((1800, 1700, 1600, *[0] * 13), 1 / RATE) for _ in range(RATE)]
    begin = 40
    rotation = rotation_of(readings[begin].quaternion)
    velocity = readings[begin].velocity.copy()
    for reading in readings[begin + 1 :]:
        rotation = rotation @ turned_by(reading.gyro / RATE)
        velocity += (rotation @ reading.acceleration + [0.0, 0.0, 9.80665]) / RATE
    assert rotation == pytest.approx(rotation_of(readings[-1].quaternion), abs=1e-9)
    assert velocity == pytest.approx(readings[-1].velocity, abs=1e-9)
    assert euler_angles(rotation) == pytest.approx(readings[-1].attitude, abs=1e-9)
    moved = readings[-1].position - readings[begin].position
    mean_velocity = np.mean([reading.velocity for reading in readings[begin + 1 :]], axis=0)
    assert moved == pytest.approx(mean_velocity * (len(readings) - begin - 1) / RATE, abs=2e-4)


def rotation_of(quaternion):
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def turned_by(vector):
    """Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def test_depth_is_counted_from_the_surface_of_the_scene_and_rays_are_rangefinders():
    scenario = load_scenario(FILES / "eel.toml")
    scene = Pegs()
    model = replace(scenario.model, scene=scene, rays=(0.0, math.pi / 2))
    vehicle = Vehicle(
        replace(scenario, model=model, start=lc.Start(center_of_mass=(-3.0, 0.0), depth=0.5)),
        load_mixing("eel"),
    )
    reading = vehicle.step((1500,) * 16, 1e-4)
    assert reading.position[2] == pytest.approx(
        0.52, abs=1e-3
    )  # the ballast is 2 cm below the axis
    ranges = vehicle.robot.plant.observe(vehicle.robot.state).ranges
    assert reading.ranges == tuple(ranges.tolist())


def test_sonar_gives_rangefinders_in_the_plane_too():
    sonar = Sonar(beams=(0.0, math.pi / 2), noise=0.0)
    wall = Wall(name="wall", begin=(3.0, -2.0), end=(3.0, 2.0))
    scenario = planar()
    model = replace(scenario.model, sensors=(sonar,), places=(wall,))
    vehicle = Vehicle(replace(scenario, model=model), STEERED)
    reading = vehicle.step((1500,) * 16, 1 / RATE)
    ahead, left = reading.ranges
    assert ahead == pytest.approx(3.0 - 0.5 * scenario.robot.length, abs=0.1)
    assert left == math.inf
    message = json.loads(write_sensor_line(reading))
    assert message["rng_1"] == ahead
    assert message["rng_2"] == NO_RETURN


def test_the_battery_sees_electronics_and_joints():
    robot = replace(lc.load_robot("mamba"), electronics_power=42.0)
    battery = Battery(full_voltage=42.0, empty_voltage=40.0, resistance=0.0)
    vehicle = Vehicle(replace(planar(), robot=robot), replace(STEERED, battery=battery))
    still = Vehicle(
        replace(planar(), robot=robot, motion=replace(GAIT, amplitude=0.0)),
        Mixing(channels=(), battery=battery),
    )
    for _ in range(RATE):
        swimming = vehicle.step((1900, 1900, 1500, *[0] * 13), 1 / RATE)
        resting = still.step((0,) * 16, 1 / RATE)
    assert resting.current == pytest.approx(1.0, rel=1e-3)
    assert swimming.current > 1.05


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (
            {"model": lc.Planar(joints=lc.Servo(), loop_delay=0.1)},
            "loop_delay.*must be 0.*got 0.1 s",
        ),
        (
            {"model": lc.Spatial(rays=(0.0,) * 7)},
            "model.*must measure 6 distances or fewer, .* together are 7",
        ),
        ({"start": Resumed(state={"planar": (0.0,)})}, "start.*must be a start at rest"),
    ],
)
def test_scenarios_that_an_autopilot_cannot_drive_are_refused(change, rule):
    with pytest.raises(BadArgument, match=rule):
        Vehicle(replace(planar(), **change), STEERED)


def test_thrusters_push_also_in_the_plane():
    robot = replace(
        lc.load_robot("mamba"), thrusters=[Thruster(link=4, thrust=0.0, max_thrust=5.0)]
    )
    mixing = Mixing(channels=(Thrust(servo=1, at_min=-5.0, at_max=5.0),))
    scenario = replace(planar(), robot=robot, motion=replace(GAIT, amplitude=0.0))
    vehicle = Vehicle(scenario, mixing)
    for _ in range(100):
        reading = vehicle.step((1900, *[0] * 15), 0.02)
    assert reading.velocity[0] > 0.05
