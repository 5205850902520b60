import os
import shutil
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control.estimation import Estimate, JointSample
from laticauda.robot import Joint
from laticauda.scenarios import Experiment
from laticauda.show.cockpit import Cockpit, Live
from laticauda.show.cockpit.feed import Feed
from laticauda.tank.operate import Event, Header, OperationRecorder

pytest.importorskip("viser")
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
ROBOT = lc.load_robot("mamba-modules")


@pytest.fixture
def cockpit():
    served = Cockpit(Live(lc.build_scenario(ROBOT, GAIT)), port=0)
    yield served
    served.close()


def shown(cockpit):
    for _ in range(5):
        cockpit.frame()
    return cockpit.operated._text.content


def estimate(x, time, robot=ROBOT):
    n = robot.planar().n_links
    return Estimate(
        time=time,
        status="tracking",
        age=0.0,
        center_of_mass=np.array([x, 1.0]),
        center_of_mass_velocity=np.zeros(2),
        heading=0.3,
        heading_rate=0.0,
        link_angle=np.full(n, 0.3),
        joint_angle=np.zeros(n - 1),
        joint_rate=np.zeros(n - 1),
        center_of_mass_std=0.0,
        heading_std=0.0,
    )


def recorder(path, robot=ROBOT):
    return OperationRecorder(
        path, Header(run=Experiment(robot=robot, environment=lc.load_water("paper-lateral")))
    )


def aged(path, seconds):
    """As if nothing had been written into it for so long."""
    then = time.time() - seconds
    os.utime(path, (then, then))


def test_the_operated_robot_is_drawn_where_its_growing_recording_has_it_and_the_simulated_one_makes_room(
    cockpit, tmp_path
):
    operated = cockpit.operated
    operated.watch(tmp_path)
    assert "There is no recording of an operation in" in shown(cockpit)
    with recorder(tmp_path / "a.mcap") as recording:
        assert shown(cockpit) == "**The robot has not been seen yet.**"
        for k in range(5):
            recording.record(estimate(2.0 + 0.2 * k, float(k)))
            recording.record(Event(time=float(k), kind="state", message=f"event {k}"))
            aged(tmp_path / "a.mcap", 1.0)  # the end of what is written is the present
            text = shown(cockpit)
        assert "speed over 5 s | **0.200 m/s**" in text
        assert "- event 3\n- event 4" in text
        assert "event 1" not in text
        tail = operated._body._frames[0].position
        assert tail[0] < 2.8 < operated._body._frames[-1].position[0] + 0.2
        assert not cockpit._scene._body._root.visible
        operated._alone.value = False
        shown(cockpit)
        assert cockpit._scene._body._root.visible


def test_a_driven_fin_is_drawn_as_its_module_says(cockpit, tmp_path):
    own = lc.load_robot("mamba-fin")
    robot = replace(own, caudal_fin=replace(own.caudal_fin, joint=Joint()))
    operated, turned = cockpit.operated, []
    operated.watch(tmp_path)
    with recorder(tmp_path / "fin.mcap", robot) as recording:
        for time_, angle in ((0.0, 0.0), (1.0, 0.4)):
            recording.record(
                JointSample(time=time_, angle=np.array([0.0] * robot.n_joints + [angle]))
            )
            recording.record(estimate(2.0, time_, robot))
            recording.record(Event(time=time_, kind="state", message="on disk"))
            text = shown(cockpit)
            w, _, _, z = operated._body._frames[-1].wxyz
            turned.append(2.0 * np.arctan2(z, w))
    assert turned[0] - turned[1] == pytest.approx(0.4)
    assert "| fin | **23 deg** |" in text


def test_a_recording_that_nobody_writes_any_more_is_said_and_the_next_one_in_the_folder_is_shown(
    cockpit, tmp_path
):
    cockpit.operated.watch(tmp_path)
    with recorder(tmp_path / "a-1.mcap") as recording:
        recording.record(estimate(2.0, 50.0))
    aged(tmp_path / "a-1.mcap", 12.0)
    text = shown(cockpit)
    assert "**2.00, 1.00 m**" in text
    assert text.endswith("**Nothing has been written for 12 s: the last position is shown.**")
    with recorder(tmp_path / "a-2.mcap") as recording:
        recording.record(estimate(5.0, 0.1))
    assert "**5.00, 1.00 m**" in shown(cockpit)


def test_the_picture_runs_steadily_half_a_second_behind(tmp_path, monkeypatch):
    path = tmp_path / "a.mcap"
    with recorder(path) as recording:
        for k in range(100):
            recording.record(estimate(0.01 * k, 0.01 * k))
    found = []
    for age in (0.0, 0.25, 0.5, 1.5):
        now = path.stat().st_mtime + age
        monkeypatch.setattr(
            "laticauda.show.cockpit.feed.time", SimpleNamespace(time=lambda now=now: now)
        )
        feed = Feed(path)
        assert feed.update() == ""
        found.append(feed.estimate.time)
    assert found == pytest.approx([0.49, 0.74, 0.99, 0.99], abs=0.03)


def test_of_a_long_recording_only_the_end_is_read(tmp_path):
    path = tmp_path / "a.mcap"
    with recorder(path) as recording:
        for k in range(2000):
            recording.record(estimate(0.0, 0.01 * k))
    feed = Feed(path)
    feed._read_entries()
    assert len(feed._estimates) == 501


def test_a_file_that_is_no_recording_is_said_in_one_sentence(tmp_path):
    (tmp_path / "a.mcap").write_bytes(b"no")
    assert "it is not an MCAP file" in Feed(tmp_path).update()
    assert "no such file" in Feed(tmp_path / "b.mcap").update().lower()


def test_a_recording_that_is_torn_in_the_middle_of_a_record_goes_on_when_the_rest_is_there(
    tmp_path,
):
    whole, growing = tmp_path / "whole.mcap", tmp_path / "growing.mcap"
    with recorder(whole) as recording:
        for k in range(300):
            recording.record(estimate(0.0, 0.01 * k))
    data = whole.read_bytes()
    shutil.copy(whole, growing)
    os.truncate(growing, len(data) // 2)
    feed = Feed(growing)
    feed._read_entries()
    before = len(feed._estimates)
    assert 0 < before < 300
    growing.write_bytes(data)
    feed._read_entries()
    assert [one.time for one in feed._estimates] == pytest.approx([0.01 * k for k in range(300)])
