"""The recording's file: what a sink keeps, what cannot be read, and what runs again."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from control.estimation.swims import jammed, samples, swum

import laticauda as lc
from laticauda.control.estimation import (
    Estimate,
    KinematicEstimator,
    Learned,
    Learner,
    Learning,
    ReferenceSample,
)
from laticauda.scenarios import Experiment
from laticauda.scenarios.interfaces import Command, Controller
from laticauda.tank.operate import (
    Decision,
    Event,
    Header,
    OperationLog,
    OperationRecorder,
    PowerReading,
    read_operation,
    rerun_controller,
    rerun_estimator,
    rerun_learner,
)
from laticauda.tank.operate.drivers.can import Frame
from laticauda.tank.operate.recording.header import header_from_texts
from laticauda.tank.operate.recording.recorder import Sink
from laticauda.trials.logs import Recorder, open_recording
from laticauda.values.errors import TrialFileError

ROBOT = lc.load_robot("mamba")
HEADER = Header(run=Experiment(robot=ROBOT, environment=lc.load_water("paper-lateral")))
GAIT = lc.lateral_undulation(amplitude=0.3, frequency=2.0, phase_shift=0.7)
FRAME = Frame(0.1, 0x181, b"\x01", is_ours=False, message=None)
READING = PowerReading(time=0.2, current=1.5)


@pytest.mark.parametrize("frames", [True, False])
def test_a_sink_keeps_frames_if_it_is_to_and_notes_what_was_found_before_the_run(
    tmp_path: Path, frames
):
    events = [
        Event(time=0.3, kind="idle_current", message="It draws this.", data={"current": 1.25}),
        Event(time=0.4, kind="settling", message="It stands here.", data={"heading": 0.5}),
        Event(time=0.5, kind="settling", message="", data={}),
        Event(time=0.6, kind="state", message="", data={"key": "q"}),
    ]
    with OperationRecorder(tmp_path / "a.mcap", HEADER) as recorder:
        sink = Sink(recorder, frames=frames)
        sink.keep(0.7, (FRAME, READING, *events))
        assert sink.trouble == ""
    log = read_operation(tmp_path / "a.mcap")
    assert log.entries == (READING, *events)
    assert log.notes == {"idle": {"current": "1.25"}, "initial": {"heading": "0.5"}}
    assert ("/can/received" in open_recording(tmp_path / "a.mcap").topics) == frames


def test_after_an_error_a_sink_says_it_and_keeps_nothing_more(tmp_path: Path):
    with OperationRecorder(tmp_path / "a.mcap", HEADER) as recorder:
        sink = Sink(recorder)
        sink.keep(0.1, (READING, None))  # type: ignore[arg-type]
        assert sink.trouble
        said = sink.trouble
        sink.keep(0.2, (replace(READING, time=0.3),))
        assert sink.trouble == said
    assert read_operation(tmp_path / "a.mcap").entries == (READING,)


class Silent(OperationRecorder):
    def record(self, entry, *, received=None):
        raise OSError


def test_an_error_without_words_is_named(tmp_path: Path):
    with Silent(tmp_path / "a.mcap", HEADER) as recorder:
        sink = Sink(recorder)
        sink.keep(0.1, (READING,))
        assert sink.trouble == "OSError"


def test_a_sink_keeps_what_is_learnt_behind_the_sample_that_taught_it_and_tells_it(tmp_path: Path):
    water, settings = lc.load_water("paper-lateral"), Learning(unknown=())
    learner = Learner(
        settings=settings, robot=ROBOT, plant=lc.build_plant(ROBOT, water, joints="servo")
    )
    with OperationRecorder(tmp_path / "a.mcap", replace(HEADER, learning=settings)) as recorder:
        sink = Sink(recorder, learner=learner)
        for sample in samples(jammed(swum((ROBOT, water, 10.5)), begin=6.0)):
            sink.keep(sample.time, (READING, sample))
    log = read_operation(tmp_path / "a.mcap")
    (at,) = [k for k, entry in enumerate(log.entries) if isinstance(entry, Learned)]
    before, learned, changed = log.entries[at - 1 : at + 2]
    assert isinstance(before, ReferenceSample)
    assert before.time > learned.time + 0.3
    assert (changed.kind, changed.message) == ("changed", learned.changes[0])
    assert changed.time == pytest.approx(before.time)
    assert [(event.kind, event.message) for event in sink.news] == [
        ("learned", learned.line),
        ("changed", changed.message),
    ]
    assert rerun_learner(log, lc.build_plant) == [learned]
    assert rerun_learner(log, lc.build_plant, replace(settings, stuck=0.95))[0].time < learned.time


class Failing(Learner):
    def init(self):
        return None

    def step(self, state, sample):
        raise ZeroDivisionError("a slip")


def test_a_learner_that_fails_ends_no_recording_and_is_said_there_too(tmp_path: Path):
    wrong = Failing(
        robot=ROBOT, plant=lc.build_plant(ROBOT, lc.load_water("paper-lateral"), joints="servo")
    )
    samples = [ReferenceSample(time=0.1 * k, angle=np.zeros(8)) for k in range(3)]
    with OperationRecorder(tmp_path / "a.mcap", HEADER) as recorder:
        sink = Sink(recorder, learner=wrong)
        for sample in samples:
            sink.keep(sample.time, (sample, READING))
        assert sink.trouble == ""
        (said,) = sink.news
    assert (said.kind, said.message) == ("changed", "Learning has stopped: a slip")
    found = read_operation(tmp_path / "a.mcap").entries
    kinds = [type(entry).__name__ for entry in found]
    assert kinds == [
        "ReferenceSample",
        "Event",
        "PowerReading",
        *["ReferenceSample", "PowerReading"] * 2,
    ]
    assert found[1] == said


def test_what_was_learnt_comes_back_bit_for_bit_and_older_recordings_say_nothing_of_it(
    tmp_path: Path,
):
    names = ("normal_drag", "current_x")
    told = {"deviation": dict.fromkeys(names, 0.1), "changes": ("The fin is gone.", "It is.")}
    learned = Learned(time=1.25, value=dict.fromkeys(names, 1.0 / 3.0), **told)
    header = replace(HEADER, learning=Learning(unknown=("added_mass",), window=30.0))
    with OperationRecorder(tmp_path / "a.mcap", header) as recorder:
        recorder.record(learned)
        recorder.record(replace(learned, changes=()))
    log = read_operation(tmp_path / "a.mcap")
    assert log.entries == (learned, replace(learned, changes=()))
    assert log.header == header
    assert "/learned/current_x" in open_recording(tmp_path / "a.mcap").topics
    older = {name: text for name, text in HEADER.texts().items() if name != "learning"}
    assert header_from_texts(older).learning is None


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"supply_voltage": None}, r"Cannot load .*a\.mcap: it has no `supply_voltage`\."),
        ({"supply_voltage": "[1"}, r"Cannot load .*a\.mcap: Expecting ',' delimiter"),
        (
            {"supply_voltage": "-3.0"},
            r"Cannot load .*a\.mcap: .*`supply_voltage` must be > 0 V, got -3",
        ),
        (
            {"format": "5"},
            r"it has format 5, and this version of laticauda reads 4: read it with laticauda",
        ),
    ],
)
def test_a_header_with_something_wrong_in_it_is_refused_in_one_sentence(
    tmp_path: Path, change, says
):
    texts = {name: text for name, text in (HEADER.texts() | change).items() if text is not None}
    with Recorder(tmp_path / "a.mcap") as recorder:
        recorder.metadata("operation", texts)
    with pytest.raises(TrialFileError, match=says):
        read_operation(tmp_path / "a.mcap")


class Plain(Controller[int]):
    """No value: two of them are never equal."""

    def init(self) -> int:
        return 0

    def step(self, state: int, observation: object) -> tuple[int, object]:
        return state, Command(gait=GAIT)


class Wrong(Plain):
    def step(self, state: int, observation: object) -> tuple[int, object]:
        return state, "left"


def test_a_controller_that_is_no_value_cannot_be_recorded():
    with pytest.raises(ValueError, match=r"`controller` must be a dataclass, got Plain\."):
        replace(HEADER, controller=Plain())


def estimate(time: float) -> Estimate:
    return Estimate(
        time=time,
        status="tracking",
        age=0.0,
        center_of_mass=np.zeros(2),
        center_of_mass_velocity=np.zeros(2),
        heading=0.0,
        heading_rate=0.0,
        link_angle=np.zeros(9),
        joint_angle=np.zeros(8),
        joint_rate=np.zeros(8),
    )


def log_of(*entries: object) -> OperationLog:
    return OperationLog(
        path=Path("a.mcap"), header=HEADER, version="", notes={}, entries=entries, lost=""
    )


def decision(time: float, offset: float) -> Decision:
    return Decision(time=time, command=Command(gait=GAIT, offset=offset), signals={})


def test_a_controller_runs_again_on_the_estimates_of_its_instants_in_the_run():
    start, stop = (
        Event(time=0.5, kind="start", message=""),
        Event(time=2.5, kind="stop", message=""),
    )
    decisions = [decision(0.0, 0.9), decision(1.0, 0.2), decision(2.0, -0.3), decision(3.0, 0.9)]
    log = log_of(start, estimate(1.0), estimate(2.0), *decisions, stop)
    rerun = rerun_controller(log, Plain())
    assert [one.time for one in rerun.recorded] == [one.time for one in rerun.again] == [1.0, 2.0]
    assert rerun.n_different == 2 and rerun.largest_difference == 0.3
    with pytest.raises(
        ValueError, match=r"`estimates` must have one at every control instant, got none at 2\.0 s"
    ):
        rerun_controller(log, Plain(), [estimate(1.0)])
    with pytest.raises(ValueError, match="`command` must be of class Command, got str"):
        rerun_controller(log, Wrong())
    assert rerun_controller(log_of(), Plain()).largest_difference == 0.0


def test_where_an_estimator_knows_nothing_yet_there_is_no_estimate():
    assert rerun_estimator(log_of(estimate(1.0), READING), KinematicEstimator(robot=ROBOT)) == []
