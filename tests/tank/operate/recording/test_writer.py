import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
from control.estimation.swims import jammed, samples, swum
from patience import until

import laticauda as lc
from laticauda.control.estimation import KinematicEstimator, Learned, Learner, Learning
from laticauda.scenarios import Experiment
from laticauda.tank.operate import Event, Header, PowerReading, read_operation, rerun_learner
from laticauda.tank.operate.recording.writer import Writer
from laticauda.values.errors import StorageFailed

ROBOT = lc.load_robot("mamba")
GAIT = lc.lateral_undulation(amplitude=0.3, frequency=2.0, phase_shift=0.7)
HEADER = Header(
    run=Experiment(
        robot=ROBOT, gait=GAIT, environment=lc.load_water("paper-lateral"), notes={"rate": 50.0}
    ),
    estimator=KinematicEstimator(robot=ROBOT),
)


def readings(n: int) -> list[PowerReading]:
    return [PowerReading(time=0.01 * k, current=1.0 + 0.001 * k) for k in range(n)]


def test_what_is_kept_is_in_the_file_once_it_is_closed(tmp_path: Path):
    found = readings(2000)
    with Writer(tmp_path / "a.mcap", HEADER) as writer:
        for reading in found:
            writer.keep(reading.time, (reading,))
        assert not writer.trouble
    assert read_operation(tmp_path / "a.mcap").of(PowerReading) == found


def test_what_a_tick_left_waiting_is_handed_over_without_a_next_tick(tmp_path: Path):
    found = readings(20_000)  # far more than a pipe takes at once
    with Writer(tmp_path / "a.mcap", HEADER) as writer:
        writer.keep(0.0, (*found, Event(time=300.0, kind="phase", message="stopping -> done")))
        writer.flush()
        until(lambda: len(read_operation(tmp_path / "a.mcap").of(Event)) == 1)
        writer.keep(301.0, readings(1))
        assert not writer.trouble


def test_what_is_learnt_in_the_writers_program_is_in_the_file_and_told(tmp_path: Path):
    water = lc.load_water("paper-lateral")
    learner = Learner(
        settings=Learning(unknown=()),
        robot=ROBOT,
        plant=lc.build_plant(ROBOT, water, joints="servo"),
    )
    given = list(samples(jammed(swum((ROBOT, water, 10.5)), begin=6.0)))
    with Writer(tmp_path / "a.mcap", HEADER, learner=learner) as writer:
        for sample in given:
            writer.keep(sample.time, (sample,))
    (learned,) = read_operation(tmp_path / "a.mcap").of(Learned)
    assert learned.changes[0].startswith("Joint 4 is stuck")
    assert [event.kind for event in writer.news] == ["learned", "changed"]
    assert [event.message for event in writer.news] == [learned.line, *learned.changes]
    again = rerun_learner(read_operation(tmp_path / "a.mcap"), lc.build_plant, Learning(unknown=()))
    assert again == [learned]


def test_a_file_that_is_there_is_refused_at_the_start(tmp_path: Path):
    (tmp_path / "a.mcap").write_bytes(b"somebody's")
    with pytest.raises(StorageFailed, match=r"a\.mcap"):
        Writer(tmp_path / "a.mcap", HEADER)
    assert (tmp_path / "a.mcap").read_bytes() == b"somebody's"


def test_what_cannot_be_written_is_said_and_the_loop_goes_on(tmp_path: Path):
    with Writer(tmp_path / "a.mcap", HEADER) as writer:
        writer.keep(0.0, [None])  # type: ignore[list-item]
        until(lambda: writer.trouble)
        assert writer.trouble
        writer.keep(0.1, readings(1))


def test_a_writer_that_was_killed_is_said_and_the_loop_goes_on(tmp_path: Path):
    with Writer(tmp_path / "a.mcap", HEADER) as writer:
        os.kill(writer._process.pid, signal.SIGKILL)
        writer._process.wait()
        writer.keep(0.0, readings(1))
        assert writer.trouble == "the program that writes the recording has ended"
        writer.keep(0.1, readings(1))


def test_a_disk_that_stalls_does_not_hold_the_loop_up(tmp_path: Path, monkeypatch):
    monkeypatch.setattr("laticauda.tank.operate.recording.writer.MOST_WAITING", 1 << 20)
    event = Event(time=0.0, kind="state", message="x" * 1000)
    with Writer(tmp_path / "a.mcap", HEADER) as writer:
        os.kill(writer._process.pid, signal.SIGSTOP)
        for k in range(2000):
            writer.keep(0.01 * k, (event,))
        assert writer.trouble == "the disk cannot keep up with the recording"
        os.kill(writer._process.pid, signal.SIGCONT)
    assert len(read_operation(tmp_path / "a.mcap").of(Event)) > 900


def test_what_was_handed_over_before_the_loop_was_killed_is_in_the_file(tmp_path: Path):
    code = f"""
        import os, pathlib, signal, sys
        sys.path[:0] = {[str(Path(__file__).parents[k]) for k in (0, 3)]!r}
        from test_writer import HEADER, Writer, readings
        writer = Writer(pathlib.Path({str(tmp_path / "a.mcap")!r}), HEADER)
        for reading in readings(300):
            writer.keep(reading.time, (reading,))
        os.kill(os.getpid(), signal.SIGKILL)
    """
    assert (
        subprocess.run([sys.executable, "-c", textwrap.dedent(code)]).returncode == -signal.SIGKILL
    )
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        log = read_operation(tmp_path / "a.mcap")
        if not log.lost:
            break
        time.sleep(0.05)
    assert log.of(PowerReading) == readings(300)
