"""One file for everything: what goes in comes out bit for bit, and a kill costs no more than the last moment."""

import signal
import subprocess
import sys
import textwrap
from dataclasses import replace

import numpy as np
import pytest
from patience import LONG, running
from tank.operate.tank import IDLE, ROOT, follower, record

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    JointSample,
    PoseSample,
    ReferenceSample,
    StateEstimator,
)
from laticauda.scenarios import Experiment
from laticauda.tank.operate import Event, Header, OperationRecorder, PowerReading, read_operation
from laticauda.tank.operate.recording.timing import Tick
from laticauda.trials.logs import Recorder, open_recording
from laticauda.values.errors import StorageFailed, TrialFileError

RUN = Experiment(robot=lc.load_robot("mamba"), environment=lc.load_water("paper-lateral"))


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    record(path)
    return path


def test_everything_has_its_topic(file):
    topics = open_recording(file).topics
    for name in ("pose", "joints", "references", "power"):
        assert f"/sample/{name}" in topics
    for name in (
        "/estimate",
        "/estimate/body",
        "/joint_states",
        "/mocap/body",
        "/command",
        "/events",
        "/can/sent",
    ):
        assert name in topics
    assert topics["/estimate/body"].kind == "geometry_msgs/PoseStamped"
    assert topics["/control/cross_track_error"].kind == "std_msgs/Float64"


def test_the_header_comes_back(file):
    log = read_operation(file)
    assert log.lost == "" and log.version == lc.__version__
    assert log.header.run.robot == lc.load_robot("mamba")
    assert log.header.controller == follower()
    assert log.header.operation == "kind = 'operation'\n"
    assert (
        log.header.estimator.backlash > 0.0 and log.header.estimator.robot == log.header.run.robot
    )
    assert log.notes["idle"] == {"current": repr(IDLE)}


def test_the_ticks_of_the_loop_come_back_as_its_timing(tmp_path):
    ticks = [Tick(0.01 * k, 0.01 * k + 1e-4, 0.01 * k + 0.003) for k in range(1, 50)]
    with OperationRecorder(
        tmp_path / "a.mcap", Header(run=replace(RUN, notes={"rate": 100.0}))
    ) as recorder:
        for tick in ticks:
            recorder.record(tick)
    timing = read_operation(tmp_path / "a.mcap").timing
    assert timing.interval == 0.01 and timing.missed == 0
    assert timing.times.tolist() == [[tick.due, tick.began, tick.sent] for tick in ticks]


def test_a_viewer_is_shown_the_joint_of_a_driven_fin(tmp_path):
    (tmp_path / "driven.toml").write_text(
        'kind = "robot"\nextends = "mamba-fin"\nname = "driven"\n[caudal_fin.joint]\n'
    )
    run = replace(RUN, robot=lc.load_robot(tmp_path / "driven.toml"))
    with OperationRecorder(tmp_path / "a.mcap", Header(run=run)) as recorder:
        recorder.record(JointSample(time=0.1, angle=np.append(np.zeros(8), 0.4)))
    (shown,) = open_recording(tmp_path / "a.mcap").messages("/joint_states")
    assert shown.content["name"][-1] == "fin_joint"
    assert shown.content["position"][-1] == 0.4


def test_a_viewer_is_shown_a_single_marker_without_a_turn(tmp_path):
    with OperationRecorder(tmp_path / "a.mcap", Header(run=RUN)) as recorder:
        recorder.record(PoseSample(time=0.1, position=np.array([0.1, 0.2, 0.3])))
    (shown,) = open_recording(tmp_path / "a.mcap").messages("/mocap/body")
    assert shown.content["pose"]["position"] == {"x": 0.1, "y": 0.2, "z": 0.3}
    assert shown.content["pose"]["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}


def test_samples_come_back_bit_for_bit_in_the_order_of_their_arrival(tmp_path):
    samples = [
        JointSample(time=0.1, angle=np.full(8, 1.0 / 3.0), rate=np.arange(8.0), torque=None),
        PoseSample(
            time=0.05, position=np.array([0.1, 0.2, 0.3]), rotation=np.eye(3), residual=1e-3
        ),
        PoseSample(time=0.06, position=np.full(3, np.nan)),
        ReferenceSample(time=0.11, angle=np.arange(8) / 7.0, frequency=2.2),
        PowerReading(time=0.12, current=1.5, average=1.4, since=0.02),
        PowerReading(time=0.13, current=1.5),
    ]
    with OperationRecorder(tmp_path / "a.mcap", Header(run=RUN)) as recorder:
        for sample in samples:
            recorder.record(sample, received=0.2)
    found = read_operation(tmp_path / "a.mcap").entries
    assert [type(entry) for entry in found] == [type(sample) for sample in samples]
    for one, two in zip(samples, found, strict=True):
        for name in type(one).__dataclass_fields__:
            before, after = getattr(one, name), getattr(two, name)
            assert (
                np.array_equal(before, after, equal_nan=True)
                if isinstance(before, np.ndarray)
                else before == after
            )


def test_an_older_file_is_never_replaced(file):
    header = Header(run=RUN)
    before = file.read_bytes()
    with pytest.raises(
        StorageFailed, match=r"Cannot write .*run\.mcap: file exists; name another place\."
    ):
        OperationRecorder(file, header)
    assert file.read_bytes() == before


def test_what_is_no_operation_is_refused_in_one_sentence(tmp_path):
    other = tmp_path / "other.mcap"
    with Recorder(other) as recorder:
        recorder.scalar("/a", 0.0, 1.0)
    with pytest.raises(
        TrialFileError, match="it is not a recording of an operation, or its beginning is missing"
    ):
        read_operation(other)
    rubbish = tmp_path / "rubbish.mcap"
    rubbish.write_bytes(b"nothing of the kind" * 20)
    with pytest.raises(TrialFileError, match="it is not an MCAP file"):
        read_operation(rubbish)
    with pytest.raises(TrialFileError, match="no such file"):
        read_operation(tmp_path / "none.mcap")


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_a_file_that_ends_in_the_middle_has_all_that_came_before(file, tmp_path, share):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(file.read_bytes()[: int(share * file.stat().st_size)])
    whole, part = read_operation(file), read_operation(cut)
    assert "cut.mcap is not intact" in part.lost
    assert len(part.entries) < len(whole.entries)
    times = [entry.time for entry in part.of(Estimate)]
    assert times == [entry.time for entry in whole.of(Estimate)][: len(times)]


CHILD = textwrap.dedent(
    """
    import sys
    import laticauda as lc
    from laticauda.tank.operate import Event, Header, OperationRecorder, PowerReading
    from laticauda.scenarios import Experiment

    header = Header(run=Experiment(robot=lc.load_robot("mamba"), environment=lc.load_water("paper-lateral")))
    recorder = OperationRecorder(sys.argv[1], header)
    for k in range(1, 10**6):
        recorder.record(PowerReading(time=0.01 * k, current=float(k)))
        if k % 100 == 0:
            print(k, flush=True)
            sys.stdin.readline()
    """
)


def test_a_program_that_is_killed_loses_no_more_than_the_open_chunk(tmp_path):
    path = tmp_path / "killed.mcap"
    command = [sys.executable, "-c", CHILD, str(path)]
    with running(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT) as process:
        for expected in (100, 200, 300):
            assert process.stdout.readline() == f"{expected}\n"
            if expected < 300:
                process.stdin.write("\n")
                process.stdin.flush()
        process.send_signal(signal.SIGKILL)
        assert process.wait(LONG) == -signal.SIGKILL
        process.stdin.close()
    log = read_operation(path)
    assert "is not intact" in log.lost
    currents = [reading.current for reading in log.of(PowerReading)]
    assert currents == [float(k) for k in range(1, len(currents) + 1)]
    assert 300 - len(currents) <= 51  # half a second of them


def test_what_comes_before_an_event_is_on_disk(tmp_path):
    path = tmp_path / "open.mcap"
    header = Header(run=RUN)
    with OperationRecorder(path, header) as recorder:
        recorder.record(PowerReading(time=0.0, current=1.0))
        recorder.record(
            Event(time=0.1, kind="fault", message="Water in module 3.", data={"node": 3})
        )
        log = read_operation(path)
        assert [type(entry) for entry in log.entries] == [PowerReading, Event]
        assert log.entries[1].message == "Water in module 3." and log.entries[1].data == {"node": 3}
        assert next(iter(open_recording(path).messages("/events"))).content["level"] == 40


def test_settings_that_nobody_knows_are_refused():
    with pytest.raises(
        ValueError, match="`controller` must be of class Controller or NoneType, got object"
    ):
        Header(run=RUN, controller=object())
    with pytest.raises(
        ValueError, match="`estimator` must be of class Estimator or KinematicEstimator or NoneType"
    ):
        Header(run=RUN, estimator=StateEstimator(robot=RUN.robot))
