"""A slice of campaigns/estimator.py: noise, lost frames, reflections, play and drop-outs, one run and one seed."""

import pytest
from tank.operate.tank import campaign

from laticauda.control.estimation import Estimator, KinematicEstimator


def test_the_filter_is_within_3_mm_and_a_third_of_a_degree_and_twice_as_good_as_kinematics():
    module = campaign()
    case = next(case for case in module.CASES if case.name == "straight, fast")
    trial = module.truth(case, 30.0)
    arrivals, dropped = module.sensed(trial, module.Sensors(), 0)
    spared, _ = module.sensed(trial, module.Sensors(outliers=0.0), 0)
    assert dropped.any()
    estimates, _ = module.estimated(
        Estimator(robot=trial.robot, backlash=module.BACKLASH), arrivals, trial.time
    )
    plain, _ = module.estimated(KinematicEstimator(robot=trial.robot), spared, trial.time)
    found, alone = module.errors(trial, estimates, dropped), module.errors(trial, plain, dropped)
    assert found.always[0] < 3.0 and found.always[1] < 0.3
    for name in ("always", "outside", "inside"):
        assert (2.0 * getattr(found, name) < getattr(alone, name)).all(), name


@pytest.mark.parametrize("name", ["twin", "twin, mixed, servo"])
def test_with_a_twin_it_is_so_in_path_following_too_and_a_wrong_twin_is_better_than_none(name):
    module = campaign()
    case = module.CASES[0]
    trial = module.truth(case, 18.0)
    arrivals, dropped = module.sensed(trial, module.Sensors(between=4.0), 0)
    found = []
    for plant in (module.TWINS[name].plant(case), None):
        estimator = Estimator(robot=trial.robot, backlash=module.BACKLASH, plant=plant)
        estimates, _ = module.estimated(estimator, arrivals, trial.time)
        found.append(module.errors(trial, estimates, dropped))
    beside, alone = found
    assert (beside.always < 0.8 * alone.always).all() and (beside.inside < 0.8 * alone.inside).all()
    if name == "twin":
        assert (
            beside.always[0] < 3.0 and beside.always[1] < 0.5
        )  # three times as many drop-outs as in the campaign
