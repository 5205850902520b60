"""Many robots in space side by side: each does what it does alone."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.spatial.school import School
from laticauda.scenarios.interfaces import Command, Start

pytest.importorskip("mujoco")
GAIT = lc.lateral_undulation(amplitude=0.52, frequency=1.57, phase_shift=0.7)
COMMAND = Command(gait=GAIT)
INTERVAL = 0.2
PLACES, CURRENTS = (
    np.array([[0.0, 0.3], [1.0, 0.0], [0.0, 0.0]]),
    np.array([[0.02, -0.03], [0.0, 0.0], [0.1, 0.0]]),
)


def plant(**changes):
    return lc.build_plant(
        lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"), model="spatial", **changes
    )


def placed(school: School) -> School:
    n = school.n
    school.place(
        np.arange(n), center_of_mass=PLACES[:n], heading=np.full(n, -0.4), current=CURRENTS[:n]
    )
    return school


@pytest.mark.parametrize(
    ("changes", "threads"), [({}, 1), ({"root": "free"}, 2), ({"joints": "pd"}, 3)]
)
def test_every_robot_does_in_its_current_what_it_does_alone_to_the_last_bit(
    changes: dict, threads: int
):
    school = placed(School(plant(**changes), COMMAND, 3, INTERVAL, threads=threads))
    told = np.random.default_rng(0).uniform(-0.3, 0.3, (4, 3))
    for offsets in told:
        school.tell({"offset": offsets, "frequency": 1.0 - offsets})
        school.march()
    school.close()
    assert school.is_well.all()
    for i in range(3):
        water = replace(lc.load_water("paper-lateral"), current=tuple(CURRENTS[i]))
        body = lc.build_plant(lc.load_robot("mamba-fin"), water, model="spatial", **changes)
        state = body.init(Start(center_of_mass=tuple(PLACES[i]), heading=-0.4), COMMAND)
        for offset in told[:, i].tolist():
            state = body.step(
                state, Command(gait=replace(GAIT, frequency=1.0 - offset, offset=offset)), INTERVAL
            )
        np.testing.assert_array_equal(school.state(i).values, state.values)
        seen, motion = body.observe(state), school.motion
        assert [motion.x[i], motion.y[i], motion.heading[i]] == [
            *seen.center_of_mass[:2],
            seen.heading,
        ]
        assert motion.observations[i].pitch == seen.pitch


def test_a_robot_that_begins_anew_or_diverges_disturbs_nobody():
    school, calm = (placed(School(plant(dt=0.05), COMMAND, 3, INTERVAL)) for _ in range(2))
    school.tell({"frequency": np.array([3000.0, GAIT.frequency, GAIT.frequency])})
    school.march()
    calm.march()
    assert school.is_well.tolist() == [False, True, True]
    assert np.isfinite(school.motion.x).all()
    school.place(
        np.array([0]), center_of_mass=PLACES[:1], heading=np.array([-0.4]), current=CURRENTS[:1]
    )
    assert (school.motion.time.tolist(), school.is_well.all()) == ([0.0, INTERVAL, INTERVAL], True)
    for name in ("x", "y", "heading", "work", "time"):
        np.testing.assert_array_equal(
            getattr(school.motion, name)[1:], getattr(calm.motion, name)[1:]
        )
    school.march()
    np.testing.assert_array_equal(school.state(0).values, calm.state(0).values)
