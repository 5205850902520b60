"""What a trial has of a recording that was put together by hand, so that every number in it is known."""

import datetime
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    JointSample,
    KinematicEstimator,
    Learned,
    PoseSample,
    ReferenceSample,
)
from laticauda.robot import Joint
from laticauda.robot.kinematics import turn
from laticauda.scenarios import Experiment
from laticauda.tank.operate import Event, Header, OperationLog, PowerReading, trial_of
from laticauda.tank.operate.recording.to_trial import (
    estimates_of_run,
    find_idle_current,
    measure_electrical_work,
)
from laticauda.values.errors import TrialFileError

WATER = lc.load_water("paper-lateral")
FINNED = lc.load_robot("mamba-fin")
DRIVEN = replace(FINNED, caudal_fin=replace(FINNED.caudal_fin, joint=Joint()))
N = DRIVEN.n_joints
TIMES = [0.0, 0.1, 0.2, 0.3]


def log_of(robot: lc.Robot, *entries: object, **header: object) -> OperationLog:
    run = Header(run=Experiment(robot=robot, environment=WATER), **header)
    return OperationLog(
        path=Path("run.mcap"), header=run, version="", notes={}, entries=entries, lost=""
    )


def estimates(robot: lc.Robot, rate: float = 0.5) -> list[Estimate]:
    n = robot.planar().n_joints
    return [
        Estimate(
            time=time,
            status="tracking",
            age=0.0,
            center_of_mass=np.array([0.3 * time, 0.0]),
            center_of_mass_velocity=np.array([0.3, 0.0]),
            heading=0.0,
            heading_rate=0.0,
            link_angle=np.zeros(n + 1),
            joint_angle=np.full(n, rate * time),
            joint_rate=np.full(n, rate),
        )
        for time in TIMES
    ]


def joints(
    torque: float | None = 2.0, rate: float | None = 0.5, fin: float = 0.25
) -> list[JointSample]:
    found = []
    for time in TIMES:
        numbers = {"rate": rate, "torque": torque}
        arrays = {
            name: None if one is None else np.full(N + 1, one) for name, one in numbers.items()
        }
        found.append(JointSample(time=time, angle=np.append(np.full(N, 0.5 * time), fin), **arrays))
    return found


def test_what_a_driven_fin_does_are_signals_and_its_work_counts():
    references = [ReferenceSample(time=0.15, angle=np.append(np.full(N, 0.1), -0.4))]
    trial = trial_of(log_of(DRIVEN, *estimates(DRIVEN), *joints(), *references))
    for name, value in (("fin_angle_0", 0.25), ("fin_rate_0", 0.5), ("fin_torque", 2.0)):
        assert trial.signals[name].tolist() == [value] * 4
    assert trial.signals["fin_angle_ref"].tolist() == [0.0, 0.0, -0.4, -0.4]
    assert trial.joint_angle_ref[:, 0].tolist() == [0.0, 0.0, 0.1, 0.1]
    assert trial.joint_torque.shape == (4, N)
    alone = trial_of(log_of(DRIVEN, *estimates(DRIVEN), *(replace_fin(one) for one in joints())))
    assert alone.work[-1] == pytest.approx(N * 2.0 * 0.5 * 0.3)
    assert trial.work[-1] == pytest.approx((N + 1) * 2.0 * 0.5 * 0.3)
    assert "fin_angle_0" not in alone.signals and "fin_angle_ref" not in alone.signals


def test_a_trial_says_when_it_was_recorded_and_what_was_learned_last():
    learned = [
        Learned(time=time, value={"c_n": c_n}, deviation={"c_n": 0.5})
        for time, c_n in ((0.1, 7.0), (0.2, 8.0))
    ]
    log = log_of(FINNED, *estimates(FINNED), *learned)
    noon = datetime.datetime(2026, 7, 1, 12, tzinfo=datetime.UTC)
    trial = trial_of(replace(log, epoch=int(noon.timestamp()) * 10**9))
    assert datetime.datetime.fromisoformat(trial.created) == noon
    assert trial.settings["learned"] == "c n 8.0000 ± 0.9800"


def replace_fin(sample: JointSample) -> JointSample:
    """The same of a fin that says nothing."""
    return JointSample(
        time=sample.time, angle=sample.angle[:N], rate=sample.rate[:N], torque=sample.torque[:N]
    )


def test_of_a_fin_that_reports_no_rate_or_torque_the_angle_is_there_and_no_work():
    trial = trial_of(log_of(DRIVEN, *estimates(DRIVEN), *joints(torque=None, rate=None)))
    assert trial.signals["fin_angle_0"].tolist() == [0.25] * 4
    assert not {"fin_rate_0", "fin_torque"} & trial.signals.keys()
    assert set(trial.not_measured) >= {"work", "joint_torque", "joint_angle_ref"}
    without_rate = trial_of(log_of(DRIVEN, *estimates(DRIVEN), *joints(rate=None)))
    assert without_rate.work[-1] == pytest.approx(
        N * 2.0 * 0.5 * 0.3
    )  # the joints' rates are the estimator's


def test_a_joint_whose_torque_nobody_knows_has_none_and_gaps_are_straight():
    samples = joints()
    torque = np.full((4, N + 1), 2.0)
    torque[:, 1], torque[1, 2], torque[2, 2] = np.nan, np.nan, 8.0
    gappy = [replace(one, torque=row) for one, row in zip(samples, torque, strict=True)]
    trial = trial_of(log_of(DRIVEN, *estimates(DRIVEN), *gappy))
    assert trial.joint_torque[:, 1].tolist() == [0.0] * 4
    assert trial.joint_torque[:, 2] == pytest.approx([2.0, 5.0, 8.0, 2.0])


def test_in_space_a_trial_has_depth_pitch_and_all_joints():
    robot = lc.load_robot("mamba-modules")
    estimator = KinematicEstimator(robot=robot, in_space=True)
    state, entries = estimator.init(), []
    for time in TIMES:
        sample = JointSample(
            time=time, angle=np.full(robot.n_joints, 0.01), torque=np.full(robot.n_joints, 0.5)
        )
        frame = PoseSample(
            time=time, position=np.array([time, 0.0, -0.4]), rotation=turn("pitch", 0.2)
        )
        state = estimator.step(estimator.step(state, sample), frame)
        entries += [sample, frame, estimator.estimate(state)]
    trial = trial_of(log_of(robot, *entries))
    assert trial.center_of_mass.shape == (4, 3) and trial.joint_torque.shape == (4, robot.n_joints)
    assert trial.joint_torque.tolist() == [[0.5] * robot.n_joints] * 4
    assert trial.signals["pitch"] == pytest.approx([entries[2].pitch] * 4)
    assert abs(trial.signals["pitch"][0]) > 0.1


def readings(average: bool, since: tuple[float, ...] = (0.0, 0.0, 0.0)) -> list[PowerReading]:
    """The charge by the averages is that of 3 A, by the readings of 2, 4 and 2 A."""
    return [
        PowerReading(
            time=time,
            current=now,
            average=3.0 if average else None,
            since=begun if average else None,
        )
        for time, now, begun in zip((0.0, 1.0, 2.0), (2.0, 4.0, 2.0), since, strict=True)
    ]


@pytest.mark.parametrize(
    ("found", "charge"),
    [
        (readings(average=True), 6.0),
        (readings(average=False), 6.0),
        (readings(average=True, since=(0.0, 0.0, 1.5)), 6.0),  # it began anew in between
        ([replace(one, current=1.0) for one in readings(average=True, since=(0.0, 0.0, 1.5))], 4.0),
        ([replace(one, since=None) for one in readings(average=True)], 6.0),
    ],
)
def test_the_charge_is_that_of_the_averages_where_one_record_goes_on_else_of_the_readings(
    found, charge
):
    log = replace(log_of(FINNED, *found, supply_voltage=10.0), notes={"idle": {"current": "0.5"}})
    work, told = measure_electrical_work(log, np.array([0.0, 2.0]))
    assert work == pytest.approx([0.0, 10.0 * charge - 10.0 * 0.5 * 2.0])
    assert told == {"supply_voltage": 10.0, "idle_current": 0.5}


@pytest.mark.parametrize(
    ("silent_at", "start", "is_known"),
    [
        (None, 1.0, True),
        (1.5, 1.0, False),  # during the run
        (0.5, 0.6, False),  # before the run, and not back at its start
        (0.5, 1.0, True),  # before the run, and back at its start
        (2.5, 1.0, True),  # after the run
    ],
)
def test_a_run_has_no_electrical_work_if_its_meter_was_silent(silent_at, start, is_known):
    events = [
        Event(time=time, kind=kind, message="") for time, kind in ((start, "start"), (2.0, "stop"))
    ]
    if silent_at is not None:
        lost = {"event": "lost_meter"}
        events.append(Event(time=silent_at, kind="state", message="silent", data=lost))
    log = log_of(FINNED, *readings(average=False), *events, supply_voltage=10.0)
    work, parameters = measure_electrical_work(log, np.array([start, 2.0]))
    assert (work is not None) == is_known
    assert parameters["supply_voltage"] == 10.0


def test_one_reading_is_no_work_and_a_noted_current_is_not_negative():
    log = log_of(FINNED, readings(average=True)[0], supply_voltage=10.0)
    assert measure_electrical_work(log, np.array(TIMES)) == (None, {})
    assert find_idle_current(log, 10.0) == FINNED.idle_power / 10.0
    with pytest.raises(ValueError, match=r"`idle current` must be >= 0 A, got -1"):
        find_idle_current(replace(log, notes={"idle": {"current": "-1"}}), 10.0)


def test_the_run_is_what_lies_between_its_last_start_and_the_stop_behind_it_each_moment_once():
    found = estimates(FINNED)
    events = [
        Event(time=time, kind=kind, message="")
        for time, kind in ((0.0, "start"), (0.1, "start"), (0.05, "stop"))
    ]
    assert [one.time for one in estimates_of_run(log_of(FINNED, *found, *events))] == [
        0.1,
        0.2,
        0.3,
    ]
    ended = log_of(FINNED, *found, *events, Event(time=0.2, kind="stop", message=""))
    assert [one.time for one in estimates_of_run(ended)] == [0.1, 0.2]
    assert [
        one.time for one in estimates_of_run(ended, [found[1], found[1], found[2], found[1]])
    ] == [
        0.1,
        0.2,
    ]
    cut = replace(log_of(FINNED, found[0]), lost="The file is not whole.")
    with pytest.raises(
        TrialFileError,
        match=r"no run with at least two estimates\. The file is not whole\.",
    ):
        estimates_of_run(cut)


def test_a_run_that_was_rejected_says_why_and_one_without_an_end_has_none():
    found = estimates(FINNED)
    verdict = Event(
        time=9.0,
        kind="verdict",
        message="The run failed a check: a joint.",
        data={"accepted": False},
    )
    stop = Event(time=0.3, kind="stop", message="The end of the tank.", data={"succeeded": True})
    for entries, succeeded, status in (
        ((stop,), True, "The end of the tank."),
        ((stop, verdict), False, "The run failed a check: a joint."),
        ((stop, replace(verdict, data={"accepted": True})), True, "The end of the tank."),
        ((replace(stop, data={"succeeded": False}),), False, "The end of the tank."),
        ((replace(stop, data={}),), True, "The end of the tank."),
        ((replace(stop, kind="fault"),), False, "The end of the tank."),
        ((), False, "The recording ends before the run does."),
    ):
        trial = trial_of(log_of(FINNED, *found, *entries))
        assert (trial.succeeded, trial.status) == (succeeded, status)
    assert not trial_of(replace(log_of(FINNED, *found, stop), lost="Something.")).succeeded
    assert math.isclose(trial.time[-1] - trial.time[0], 0.3)
