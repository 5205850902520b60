import math

import pytest

import laticauda as lc
from laticauda.studies import averaged_model

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
PLANT = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))


def test_the_averaged_model_swims_as_fast_as_the_gait_and_turns_to_the_side_of_its_offset():
    model = averaged_model(PLANT, GAIT)
    assert model.speed(GAIT.frequency, 0.0) == pytest.approx(
        lc.swim("mamba", GAIT).steady_velocity, rel=0.05
    )
    assert model.turning(GAIT.frequency, math.radians(10)) > 0.0


def test_frequencies_that_are_no_range_are_refused():
    with pytest.raises(
        ValueError, match="`frequency_limits` must be 0 < smallest < largest in rad/s, got 2 and 1"
    ):
        averaged_model(PLANT, GAIT, (2.0, 1.0))
    with pytest.raises(ValueError, match="`n_trials` must be a whole number >= 3, got 2"):
        averaged_model(PLANT, GAIT, n_trials=2)
