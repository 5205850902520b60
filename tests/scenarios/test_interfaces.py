"""References and switches from outside: what a robot on a bus needs, and what both bodies do with them."""

import math
import tomllib
from dataclasses import fields, replace

import numpy as np
import pytest

import laticauda as lc
from laticauda import Wave, build_scenario, eel_like, load_robot
from laticauda.control.following import Following
from laticauda.control.offset_steps import OffsetSteps
from laticauda.models.simulate import build_plant
from laticauda.motion.gaits import Generator
from laticauda.robot import Joint, load_water
from laticauda.scenarios import run_from_table, run_to_toml, unknown_in
from laticauda.scenarios.interfaces import (
    Command,
    Controller,
    Observation,
    OpenLoop,
    Resumed,
    Start,
)
from laticauda.sensing import HeadMotion

GAIT = eel_like(
    amplitude=math.radians(30),
    frequency=math.radians(120),
    phase_shift=math.radians(40),
    offset=0.2,
)
MODELS = ("planar", "spatial")


def body(model: str, joints: str = "servo"):
    return build_plant(load_robot("mamba"), load_water("paper-eel"), model=model, joints=joints)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("joints", ["servo", "pd"])
def test_joints_go_to_the_references_that_are_given(model, joints):
    plant_ = body(model, joints)
    references = tuple(0.1 * math.sin(k) for k in range(8))
    state = plant_.init(Start(), Command(gait=GAIT))
    state, log, failure = plant_.march(state, Command(gait=GAIT, references=references), 3.0, 0.5)
    assert failure is None
    np.testing.assert_array_equal(log.joint_angle_ref[1:], np.tile(references, (6, 1)))
    np.testing.assert_allclose(log.joint_angle[-1], references, atol=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_the_generator_from_outside_swims_as_the_one_inside(model):
    plant_ = body(model)
    inside = plant_.init(Start(), Command(gait=GAIT))
    outside, generator, step = inside, Generator(n_links=9, ramp=0.0), 0.01
    thought = generator.init(GAIT)
    for _ in range(100):
        inside = plant_.step(inside, Command(gait=GAIT), step)
        thought = generator.step(thought, GAIT, step)
        angles = generator.joints(thought, GAIT)[0]
        outside = plant_.step(outside, Command(gait=GAIT, references=tuple(angles)), step)
    one, other = plant_.observe(inside), plant_.observe(outside)
    # References that are held for 10 ms are on average 5 ms late or early.
    np.testing.assert_allclose(other.joint_angle, one.joint_angle, atol=0.02)
    np.testing.assert_allclose(other.center_of_mass, one.center_of_mass, atol=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_the_generator_goes_on_where_it_stood(model):
    plant_ = body(model)
    begin = plant_.step(plant_.init(Start(), Command(gait=GAIT)), Command(gait=GAIT), 0.5)
    after = plant_.step(begin, Command(gait=GAIT, references=(0.0,) * 8), 0.1)
    changed = np.flatnonzero(after.values != begin.values)
    # Time, pose and work, and what belongs to the joints, but no row of the generator.
    generator = range(8, 17) if model == "planar" else {*range(2, 11), *range(15, 24)}
    assert changed.size > 0
    assert not set(changed) & set(generator)


@pytest.mark.parametrize("model", MODELS)
def test_joints_that_are_off_do_no_work_and_draw_nothing(model):
    plant_ = body(model)
    command = Command(gait=GAIT, references=(0.5,) * 8, enabled=(False,) * 8)
    _, log, _ = plant_.march(plant_.init(Start(), command), command, 1.0, 0.1)
    assert np.all(log.joint_torque == 0.0)
    assert log.electrical_work[-1] == 0.0


@pytest.mark.parametrize("model", MODELS)
def test_one_joint_that_is_off_leaves_the_others_on(model):
    plant_ = body(model)
    command = Command(gait=GAIT, references=(0.3,) * 8, enabled=(True, True, False, *[True] * 5))
    _, log, _ = plant_.march(plant_.init(Start(), command), command, 1.0, 0.1)
    assert np.all(log.joint_torque[:, 2] == 0.0)
    assert np.all(np.abs(np.delete(log.joint_angle[-1], 2) - 0.3) < 0.05)


@pytest.mark.parametrize("model", MODELS)
def test_what_does_not_fit_is_refused(model):
    plant_ = body(model)
    state = plant_.init(Start(), Command(gait=GAIT))
    with pytest.raises(
        ValueError, match=r"`references` must have one entry per joint, 8 of them, got 3\."
    ):
        plant_.step(state, Command(gait=GAIT, references=(0.0,) * 3), 0.01)
    with pytest.raises(
        ValueError, match=r"`references\[1\]` must be a finite number in rad, got nan\."
    ):
        plant_.step(state, Command(gait=GAIT, references=(0.0, math.nan, *[0.0] * 6)), 0.01)
    with pytest.raises(
        ValueError, match=r"`enabled` must have one entry per joint, 8 of them, got 1\."
    ):
        plant_.step(state, Command(gait=GAIT, enabled=(True,)), 0.01)
    stiff = body(model, "prescribed")
    with pytest.raises(ValueError, match="`references` must be None for prescribed joints"):
        stiff.step(
            stiff.init(Start(), Command(gait=GAIT)), Command(gait=GAIT, references=(0.0,) * 8), 0.01
        )


def driven_fin_body(model: str):
    robot = load_robot("mamba-fin")
    assert robot.caudal_fin is not None
    driven = replace(robot, caudal_fin=replace(robot.caudal_fin, joint=Joint()))
    return build_plant(driven, load_water("paper-eel"), model=model, joints="servo")


@pytest.mark.parametrize("model", MODELS)
def test_a_driven_fin_goes_to_one_more_reference_and_by_the_gait_without_it(model):
    plant_, wave = driven_fin_body(model), Wave(amplitude=0.5, frequency=2.0)
    gait = replace(GAIT, fin=wave)
    begin = plant_.init(Start(), Command(gait=gait))
    by_gait = plant_.march(begin, Command(gait=gait, references=(0.1,) * 8), 2.0, 0.5)[1]
    held, log, failure = plant_.march(
        begin, Command(gait=gait, references=(*(0.1,) * 8, -0.4)), 2.0, 0.5
    )
    assert failure is None
    assert np.ptp(by_gait.signals["fin_angle_ref"]) > 0.5
    np.testing.assert_array_equal(log.signals["fin_angle_ref"][1:], -0.4)
    assert log.signals["fin_angle_0"][-1] == pytest.approx(-0.4, abs=0.02)
    np.testing.assert_allclose(log.joint_angle[-1], 0.1, atol=0.02)
    for wave_rows in plant_.generator:  # they stand where they stood
        np.testing.assert_array_equal(held.values[wave_rows], begin.values[wave_rows])


@pytest.mark.parametrize("model", MODELS)
def test_the_motor_of_a_driven_fin_is_switched_off_by_one_more_entry(model):
    plant_ = driven_fin_body(model)
    command = Command(gait=GAIT, references=(0.2,) * 9, enabled=(*(True,) * 8, False))
    _, log, _ = plant_.march(plant_.init(Start(), command), command, 1.0, 0.1)
    weak = np.abs(log.signals["fin_torque"]).max()
    on = replace(command, enabled=(True,) * 8)
    _, log, _ = plant_.march(plant_.init(Start(), on), on, 1.0, 0.1)
    assert weak < 0.1 * np.abs(log.signals["fin_torque"]).max()
    with pytest.raises(
        ValueError, match="one entry per joint, 8 of them, or one more for the fin, got 10"
    ):
        plant_.step(plant_.init(Start(), on), replace(on, references=(0.0,) * 10), 0.01)


@pytest.mark.parametrize("model", MODELS)
def test_an_observation_has_the_robots_motion_and_nothing_of_the_water(model):
    still = body(model)
    state = still.step(still.init(Start(), Command(gait=GAIT)), Command(gait=GAIT), 0.5)
    moving = replace(still, environment=replace(still.environment, current=(0.3, -0.2)))
    one, other = (each.observe(each.unpack(still.pack(state))) for each in (still, moving))
    for name in [*(field.name for field in fields(Observation)), "head"]:
        first, second = getattr(one, name), getattr(other, name)
        for part, same_part in zip(_parts(first), _parts(second), strict=True):
            np.testing.assert_array_equal(part, same_part, err_msg=name)


def _parts(value):
    if isinstance(value, HeadMotion):
        return value
    return (value,)


def test_a_state_to_go_on_from_is_arrays_by_name():
    with pytest.raises(ValueError, match="`state` must be of class Mapping, got ndarray"):
        Resumed(state=np.zeros(3))


class Holds(Controller[None]):
    """A controller of the user's own, whose fields nobody has declared."""

    gait = GAIT

    def init(self) -> None:
        return None

    def step(self, state: None, observation: Observation) -> tuple[None, Command]:
        return None, Command(gait=GAIT)


@pytest.mark.parametrize("interval", [1e-9, 0.0, -1.0, math.nan, None, "0.05"])
def test_controllers_whose_instants_cannot_follow_one_another_are_refused(interval):
    controller = Holds()
    controller.interval = interval
    with pytest.raises(ValueError, match=r"`motion.interval` must be .* s, between two control"):
        build_scenario("mamba", controller, 1.0, joints="servo")


def test_a_controller_without_an_interval_is_refused():
    with pytest.raises(ValueError, match=r"`motion.interval` must be a number in s, .* got None"):
        build_scenario("mamba", Holds(), 1.0, joints="servo")


@pytest.mark.parametrize(
    "build",
    [
        lambda interval: OpenLoop(command=Command(gait=GAIT), interval=interval),
        lambda interval: OffsetSteps(gait=GAIT, interval=interval),
        lambda interval: Following(interval=interval),
    ],
)
def test_every_controller_of_the_package_has_the_same_shortest_interval(build):
    with pytest.raises(ValueError, match=r"`interval` must be >= 0.0001 s, got 1e-09"):
        build(1e-9)
    assert build(1e-4).interval == 1e-4


@pytest.mark.parametrize("many", [False, True])
def test_a_step_that_returns_a_command_alone_is_named(many):
    class Forgets(Holds):
        interval = 0.05

        def step(self, state, observation):
            return Command(gait=GAIT)

    scenario = build_scenario("mamba", Forgets(), 1.0, joints="servo")
    with pytest.raises(ValueError, match=r"`motion.step` must return two things, .* got Command"):
        if many:
            lc.swim_many([scenario])
        lc.swim(scenario)


def test_a_controller_without_a_first_state_says_which_method_it_lacks():
    class Bare(Controller[None]):
        gait = GAIT
        interval = 0.05

    with pytest.raises(NotImplementedError, match="controller Bare must have a method `init`"):
        lc.swim(build_scenario("mamba", Bare(), 1.0, joints="servo"))


def test_a_scenario_keeps_a_controller_that_is_not_defined_here():
    table = tomllib.loads(run_to_toml(build_scenario("mamba", OffsetSteps(gait=GAIT), 1.0)))
    table["controller"]["kind"] = "somewhere:Elses"
    scenario = run_from_table(table)
    assert [unknown.kind for unknown in unknown_in(scenario)] == ["somewhere:Elses"]
