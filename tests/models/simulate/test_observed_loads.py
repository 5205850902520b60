"""What links and joints bear, as controllers see it: the same as in the log, for one robot and for many."""

from dataclasses import dataclass, field

import numpy as np
import pytest

import laticauda as lc
from laticauda.scenarios import Controller

GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
SERIES = ("joint_force", "joint_moment", "joint_torque", "water_force", "pressure_difference")


@dataclass(frozen=True)
class Notes(Controller[None]):
    """A controller that steers and notes all loads."""

    gait: lc.Gait = GAIT
    interval: float = 0.1
    offset: float = 0.1
    noted: list = field(default_factory=list, compare=False)

    def init(self):
        return None

    def step(self, state, observation):
        self.noted.append(observation.loads)
        return None, lc.Command(gait=GAIT, offset=self.offset)


def swim(robot="mamba", model="planar", **changes):
    notes = Notes()
    scenario = lc.build_scenario(robot, notes, 2.0, model=model, sample_interval=0.1, **changes)
    return lc.swim(scenario, link_forces=True), notes.noted


@pytest.mark.parametrize("model", ["planar", "spatial"])
@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_a_controller_sees_the_loads_of_the_log(model: str, joints: str):
    trial, noted = swim("mamba-fin", model, joints=joints)
    # A control instant is logged under the command before, like the torques of the joints.
    for name in SERIES:
        logged = getattr(trial, name)[1:-1]
        seen = np.array([getattr(loads, name) for loads in noted[1:]])
        scale = np.abs(logged).max()
        np.testing.assert_allclose(seen, logged, atol=1e-6 * scale, err_msg=name)


def test_loads_are_those_of_the_command_that_acted_until_now():
    trial, noted = swim(loop_delay=0.05)
    seen = np.array([loads.joint_moment for loads in noted[1:]])
    np.testing.assert_allclose(seen, trial.joint_moment[1:-1], atol=1e-8)


def test_robots_in_lanes_see_what_a_robot_alone_sees():
    trials = []
    for offset in (0.0, 0.1, -0.1):
        notes = Notes(offset=offset)
        scenario = lc.build_scenario("mamba-fin", notes, 1.0, sample_interval=0.1)
        lc.swim(scenario)
        trials.append((scenario, list(notes.noted)))
        notes.noted.clear()
    lc.swim_many([scenario for scenario, _ in trials])
    for scenario, alone in trials:
        among_others = scenario.motion.noted
        assert len(among_others) == len(alone) > 5
        for name in SERIES:
            expected = [getattr(loads, name) for loads in alone]
            seen = [getattr(loads, name) for loads in among_others]
            np.testing.assert_allclose(seen, expected, rtol=1e-9, atol=1e-9)


def test_an_observation_that_no_model_made_says_that_it_knows_no_loads():
    plant = lc.build_plant("mamba", "paper-lateral")
    seen = plant.observe(plant.init(lc.Start(), lc.Command(gait=GAIT)))
    with pytest.raises(ValueError, match="`loads` are known to models only"):
        _ = seen.loads
