"""How single joints move, identified: a joint that swings less than it was told, and two that lag."""

from dataclasses import replace

import numpy as np
import pytest
from identify.trials import gaits

import laticauda as lc
from laticauda.identify import Measurement, fit
from laticauda.identify.model import predict
from laticauda.identify.problem import make_problem
from laticauda.models.simulate.numbers import change_parameters

TRUTH = {"gait.amplitude[4]": 0.35, "gait.phase[2:4]": -0.2}
GAITS = [replace(gait, amplitude=0.5) for gait in gaits(4)]
SCENARIOS = [lc.build_scenario("mamba", gait, 6.0) for gait in GAITS]


@pytest.fixture(scope="module")
def measurements():
    """Speeds and powers of robots of which three joints do not move as they were told."""
    swims = lc.swim_many([change_parameters(scenario, TRUTH) for scenario in SCENARIOS])
    return [
        Measurement(
            name=f"trial {i}",
            scenario=scenario,
            figures={
                "forward_velocity": (float(swims.forward_velocity[i]), 0.001),
                "mean_power": (float(swims.mean_power[i]), 0.1),
            },
        )
        for i, scenario in enumerate(SCENARIOS)
    ]


def test_how_single_joints_move_is_identified(measurements):
    found = fit(measurements, parameters=list(TRUTH), n_starts=1)
    for name, value in TRUTH.items():
        assert found.values[name] == pytest.approx(value, abs=1e-4), name


def test_slopes_to_single_joints_of_the_gait_are_differences(measurements):
    problem = make_problem(measurements[:1], [*TRUTH, "robot.taper.mass.head"])
    values = np.array([*TRUTH.values(), 0.9])
    jacobian = predict(problem, values).jacobian
    for k in range(values.size):
        step = 1e-4 * (np.arange(values.size) == k)
        ends = [predict(problem, values + sign * step).values for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / 2e-4
        np.testing.assert_allclose(jacobian[:, k], slope, rtol=1e-6, atol=1e-6 * abs(slope).max())
