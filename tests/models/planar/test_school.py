import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.school import School
from laticauda.robot import ground_names
from laticauda.scenarios.interfaces import Command, Start

GAIT = lc.lateral_undulation(amplitude=0.52, frequency=1.57, phase_shift=0.7)
COMMAND = Command(gait=GAIT)
INTERVAL = 0.2


def plant(joints="prescribed", current=(0.0, 0.0), **changes):
    water = replace(lc.load_water("paper-lateral"), current=current)
    return lc.build_plant(lc.load_robot("mamba-fin"), water, joints=joints, **changes)


def placed(school: School, y=0.0, heading=0.0, current=(0.0, 0.0)) -> School:
    n = school.n
    school.place(
        np.arange(n),
        center_of_mass=np.stack((np.zeros(n), np.broadcast_to(y, n)), axis=1),
        heading=np.broadcast_to(heading, n).astype(float),
        current=np.broadcast_to(current, (n, 2)).astype(float),
    )
    return school


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
@pytest.mark.parametrize("n", [1, 3, 11])
def test_every_robot_does_what_the_plant_does_alone_to_the_last_bit(joints: str, n: int):
    body = plant(joints, current=(0.02, -0.03))
    school = placed(
        School(plant(joints), COMMAND, n, INTERVAL), y=0.3, heading=-0.4, current=(0.02, -0.03)
    )
    state = body.init(Start(center_of_mass=(0.0, 0.3), heading=-0.4), COMMAND)
    for offset in np.random.default_rng(0).uniform(-0.3, 0.3, 10):
        school.tell({"offset": np.full(n, offset)})
        school.march()
        state = body.step(state, Command(gait=GAIT, offset=float(offset)), INTERVAL)
    for lane in (0, n - 1):
        np.testing.assert_array_equal(school.state(lane).values, state.values)
        seen, other = school.observe(lane), body.observe(state)
        assert (seen.time, seen.heading) == (other.time, other.heading)
        np.testing.assert_array_equal(seen.link_angle, other.link_angle)


def test_a_robot_is_placed_in_a_flow_of_the_parts_of_the_plants_only():
    gusts = replace(lc.load_current("turbulence"), modes=6)
    school = School(plant(current=gusts), COMMAND, 2, INTERVAL)
    place = {"center_of_mass": np.zeros((1, 2)), "heading": np.zeros(1)}
    school.place(np.array([1]), current=[replace(gusts, seed=4)], **place)
    for other in (replace(gusts, modes=7), lc.load_current("vortex"), (0.1, 0.0)):
        with pytest.raises(
            ValueError, match="`current` must have the same parts as the plant's current"
        ):
            school.place(np.array([1]), current=[other], **place)


@settings(max_examples=10)
@given(st.integers(1, 20), st.integers(1, 3), st.integers(0, 2**32 - 1))
def test_neighbors_and_threads_change_nothing(n: int, threads: int, seed: int):
    rng = np.random.default_rng(seed)
    start, offset = rng.uniform(-1.0, 1.0, 20), rng.uniform(-0.3, 0.3, (3, 20))
    ends = []
    for count, share in ((20, 1), (n, threads)):
        school = placed(School(plant(), COMMAND, count, INTERVAL, threads=share), y=start[:count])
        for each in offset:
            school.tell({"offset": each[:count]})
            school.march()
        ends.append(
            np.stack((school.motion.x, school.motion.y, school.motion.heading, school.motion.work))
        )
        school.close()
    np.testing.assert_array_equal(ends[0][:, :n], ends[1])


def test_the_gait_is_told_as_well_as_the_offset():
    school, body = School(plant(), COMMAND, 2, INTERVAL), plant()
    state = body.init(Start(), COMMAND)
    faster = replace(GAIT, amplitude=0.3, frequency=2.2, phase_shift=0.5)
    names = ("amplitude", "frequency", "phase_shift")
    for _ in range(5):
        school.tell({name: np.full(2, getattr(faster, name)) for name in names})
        school.march()
        state = body.step(state, Command(gait=faster), INTERVAL)
    np.testing.assert_array_equal(school.state(1).values, state.values)
    assert school.motion.frequency[1] > 2.0


def test_a_robot_that_begins_anew_leaves_no_trace_and_disturbs_nobody():
    school, calm = (placed(School(plant(), COMMAND, 10, INTERVAL), y=0.1) for _ in range(2))
    school.march()
    calm.march()
    school.place(
        np.array([4]),
        center_of_mass=np.array([[1.0, 2.0]]),
        heading=np.array([0.5]),
        current=np.array([[0.1, 0.0]]),
    )
    assert school.motion.time[4] == 0.0
    assert (school.motion.x[4], school.motion.y[4], school.motion.heading[4]) == (1.0, 2.0, 0.5)
    assert school.motion.work[4] == 0.0
    others = np.arange(10) != 4
    for name in ("x", "y", "heading", "work", "time"):
        np.testing.assert_array_equal(
            getattr(school.motion, name)[others], getattr(calm.motion, name)[others]
        )


def test_a_robot_that_diverges_is_said_to_and_harms_no_other():
    body = plant("servo", dt=0.05)
    school = School(body, COMMAND, 9, INTERVAL)
    calm = School(body, COMMAND, 9, INTERVAL)
    school._lanes[0, :, 3] *= 1e200  # nothing that can be asked for does it
    for _ in range(3):
        school.march()
        calm.march()
    np.testing.assert_array_equal(np.flatnonzero(~school.is_well), [3])
    others = np.arange(9) != 3
    np.testing.assert_array_equal(school.motion.x[others], calm.motion.x[others])
    assert np.isfinite(school.motion.x).all()
    assert np.isfinite(school.motion.work).all()
    placed(school)
    assert school.is_well.all()


def test_the_work_is_electrical_where_the_robot_has_a_power_model():
    for joints, index in (("prescribed", 0), ("servo", 3)):
        body = plant(joints)
        school, state = School(body, COMMAND, 2, INTERVAL), body.init(Start(), COMMAND)
        school.march()
        state = body.step(state, COMMAND, INTERVAL)
        work = state.values[rows.WORK_ABSOLUTE - rows.TIME + index]
        assert work > 0.0
        assert school.motion.work[0] == work


def test_what_was_handed_out_does_not_change_later():
    school = School(plant(), COMMAND, 2, INTERVAL)
    before = school.motion
    kept = before.time.copy()
    school.march()
    np.testing.assert_array_equal(before.time, kept)
    with pytest.raises(ValueError, match="read-only"):
        school.motion.x[0] = 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"n": 0}, "`n` must be a whole number >= 1, got 0"),
        ({"interval": -0.1}, "`interval` must be > 0 s, got -0.1"),
        ({"threads": 0}, "`threads` must be a whole number >= 1, got 0"),
    ],
)
def test_arguments_out_of_range_are_refused(changes: dict, message: str):
    arguments = {"plant": plant(), "command": COMMAND, "n": 2, "interval": math.pi / 20} | changes
    with pytest.raises(ValueError, match=message):
        School(**arguments)


def test_robots_on_the_ground_are_refused():
    body = lc.build_plant(lc.load_robot("mamba"), lc.load_ground(ground_names()[0]))
    with pytest.raises(ValueError, match="`plant` must swim in water, got one on the ground"):
        School(body, COMMAND, 1, INTERVAL)
