"""From a recording to a trial with (4) and (5), and once more through estimator and controller."""

from dataclasses import replace

import numpy as np
import pytest
from tank.operate.tank import DRAWN, IDLE, ROOT, follower, record

import laticauda as lc
from laticauda.control.estimation import Estimate, Estimator, KinematicEstimator
from laticauda.motion.joints.laws import Servo
from laticauda.scenarios import Experiment
from laticauda.tank.operate import (
    Event,
    Header,
    PowerReading,
    read_operation,
    rerun_controller,
    rerun_estimator,
    trial_of,
)
from laticauda.tank.operate.recording.header import header_from_texts
from laticauda.tank.operate.recording.messages import content_of
from laticauda.trials.logs import load_trial
from laticauda.values.errors import TrialFileError
from laticauda.water.fluid.laws import FunctionDrag


def numbers(estimate):
    """All numbers of an estimate, to be compared bit for bit."""
    return np.hstack([one for one in content_of(estimate) if not isinstance(one, str)])


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "run.mcap"
    truth = record(path)
    return truth, read_operation(path), path


def test_the_trial_is_the_run_between_start_and_stop(recorded):
    truth, log, _ = recorded
    trial = trial_of(log)
    assert trial.time[0] == 0.0 and trial.duration == pytest.approx(1.5)
    assert trial.succeeded and trial.status == "The end of the tank."
    assert trial.gait == truth.gait and trial.environment == truth.environment
    at = slice(100, 251)
    assert np.abs(trial.center_of_mass - truth.center_of_mass[at]).max() < 0.03
    assert trial.joint_angle_ref == pytest.approx(truth.joint_angle_ref[at])
    assert np.abs(trial.joint_torque - truth.joint_torque[at]).mean() < 0.15  # the sensors' noise
    assert trial.not_measured == ()


def test_power_is_4_and_speed_is_5(recorded):
    _, log, _ = recorded
    trial = trial_of(log)
    assert trial.electrical_power == pytest.approx(35.0 * DRAWN - 35.0 * IDLE)
    moved = np.linalg.norm(trial.center_of_mass[-1] - trial.center_of_mass[0])
    assert trial.forward_velocity == pytest.approx(moved / trial.duration)


def test_without_averages_the_meters_readings_count(recorded):
    _, log, _ = recorded
    live = tuple(
        PowerReading(time=entry.time, current=entry.current)
        if isinstance(entry, PowerReading)
        else entry
        for entry in log.entries
    )
    assert trial_of(replace(log, entries=live)).electrical_power == pytest.approx(
        35.0 * (2.0 - IDLE)
    )
    without = tuple(entry for entry in log.entries if not isinstance(entry, PowerReading))
    assert trial_of(replace(log, entries=without)).electrical_work is None


def test_the_idle_current_is_the_robots_own_where_none_was_measured(recorded):
    _, log, _ = recorded
    trial = trial_of(replace(log, notes={}))
    assert trial.electrical_power == pytest.approx(35.0 * DRAWN - log.header.run.robot.idle_power)


def test_the_power_is_that_of_the_recordings_own_supply(recorded):
    _, log, _ = recorded
    at_24 = replace(log, header=replace(log.header, supply_voltage=24.0))
    assert trial_of(at_24).electrical_power == pytest.approx(24.0 * (DRAWN - IDLE))
    assert trial_of(at_24).settings["supply_voltage"] == 24.0
    unsaid = replace(log, header=replace(log.header, supply_voltage=None))
    with pytest.raises(TrialFileError, match="it holds power readings, but no `supply_voltage`"):
        trial_of(unsaid)


def test_the_same_estimator_gives_the_same_estimates_to_the_last_bit(recorded):
    _, log, _ = recorded
    again = rerun_estimator(log)
    before = [entry for entry in log.entries if type(entry).__name__ == "Estimate"]
    assert len(again) == len(before) > 200
    for one, two in zip(before, again, strict=True):
        assert np.array_equal(numbers(one), numbers(two))


def test_another_estimator_may_take_its_place(recorded):
    truth, log, _ = recorded
    estimates = rerun_estimator(log, KinematicEstimator(robot=truth.robot))
    trial = trial_of(log, estimates)
    assert np.abs(trial.center_of_mass - trial_of(log).center_of_mass).max() > 1e-3


def test_the_same_controller_gives_the_same_commands_to_the_last_bit(recorded):
    _, log, _ = recorded
    rerun = rerun_controller(log)
    assert len(rerun.recorded) == 31
    assert rerun.n_different == 0 and rerun.largest_difference == 0.0
    assert {decision.command.offset for decision in rerun.again} != {0.0}
    assert rerun_controller(log, estimates=rerun_estimator(log)).n_different == 0


def test_another_controller_decides_otherwise(recorded):
    _, log, _ = recorded
    other = replace(follower(), heading=replace(follower().heading, gain=0.5))
    rerun = rerun_controller(log, other)
    assert rerun.n_different > 20 and rerun.largest_difference > 1e-3


def test_signals_are_held_between_control_instants(recorded):
    _, log, _ = recorded
    trial = trial_of(log)
    error = trial.signals["cross_track_error"]
    assert (error[:5] == error[0]).all() and error[5] != error[4]


def test_a_run_without_an_end_is_a_failed_trial_that_says_so(recorded, tmp_path):
    _, log, path = recorded
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[: int(0.8 * path.stat().st_size)])
    part = read_operation(cut)
    trial = trial_of(part)
    assert not trial.succeeded and trial.time[-1] - trial.time[0] < 1.5
    faulty = tuple(
        Event(time=entry.time, kind="fault", message="A leak in module 3.")
        if isinstance(entry, Event) and entry.kind == "stop"
        else entry
        for entry in log.entries
    )
    failed = trial_of(replace(log, entries=faulty))
    assert not failed.succeeded and failed.status == "A leak in module 3."


def test_torques_that_nobody_measured_are_not_made_up(tmp_path):
    path = tmp_path / "bare.mcap"
    record(path, torque=False)
    trial = trial_of(read_operation(path))
    assert set(trial.not_measured) == {"joint_torque", "work"}
    trial.save(tmp_path / "bare.nc")
    assert load_trial(tmp_path / "bare.nc").equals(trial)


def test_a_recording_without_a_run_is_refused(recorded):
    _, log, _ = recorded
    with pytest.raises(
        TrialFileError, match=r"Cannot replay .*: it holds no run with at least two estimates\."
    ):
        trial_of(replace(log, entries=()))
    bare = replace(log, header=replace(log.header, estimator=None, controller=None))
    with pytest.raises(
        ValueError, match="`estimator` must be given: the recording holds none, got None"
    ):
        rerun_estimator(bare)
    with pytest.raises(
        ValueError, match="`controller` must be given: the recording holds none, got None"
    ):
        rerun_controller(bare)


TWIN = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"), joints="servo")


def test_a_recording_makes_the_same_twin_again_and_the_estimates_are_the_same_to_the_last_bit(
    tmp_path,
):
    path = tmp_path / "twin.mcap"
    record(path, estimator=Estimator(robot=TWIN.robot, plant=TWIN))
    log = read_operation(path)
    assert log.header.estimator == Estimator(robot=TWIN.robot)
    assert log.header.twin == Experiment(
        robot=TWIN.robot,
        environment=TWIN.environment,
        model=lc.Planar(joints=Servo(), dt=TWIN.dt, offset_bandwidth=10.0, ramp=0.0),
    )
    again = rerun_estimator(log, plant=lc.build_plant)
    assert len(again) > 200
    assert all(
        np.array_equal(numbers(one), numbers(two))
        for one, two in zip(log.of(Estimate), again, strict=True)
    )
    with pytest.raises(
        ValueError,
        match=r"`plant` must be `laticauda\.build_plant`, which rebuilds the recorded twin",
    ):
        rerun_estimator(log)


def test_a_recording_of_the_first_format_is_refused_with_what_to_do():
    with pytest.raises(
        ValueError, match=r"it has format 1, and this version of laticauda reads 4: read it with"
    ):
        read_operation(ROOT / "tests" / "data" / "recordings-0.1.0" / "twin.mcap")


def test_a_header_comes_back_from_its_texts_and_is_written_again_as_it_was():
    run = Experiment(robot=TWIN.robot, environment=TWIN.environment, notes={"rate": 100.0})
    header = Header(
        run=run, controller=follower(), estimator=Estimator(robot=TWIN.robot, plant=TWIN)
    )
    again = header_from_texts(header.texts())
    assert again == header
    assert again.texts() == header.texts()


def test_a_header_keeps_the_joint_law_and_one_of_before_has_servos():
    run = Experiment(robot=TWIN.robot, environment=TWIN.environment)
    law = lc.SpeedServo(speed_limit=0.7)
    texts = Header(run=run, joints=law).texts()
    assert header_from_texts(texts).joint_law == law
    assert Header(run=run).joint_law == Servo()
    del texts["joints"]  # as it was before
    assert header_from_texts(texts).joint_law == Servo()


def test_a_twin_whose_law_no_file_can_name_is_refused_at_the_start():
    water = replace(TWIN.environment, drag=FunctionDrag(function=lambda *_: (0.0, 0.0, 0.0)))
    twin = lc.build_plant(TWIN.robot, water, joints="servo")
    with pytest.raises(
        ValueError,
        match="`plant` must have a fluid law that is a class, and no scene, to be recorded",
    ):
        Header(
            run=Experiment(robot=TWIN.robot, environment=water),
            estimator=Estimator(robot=TWIN.robot, plant=twin),
        )
