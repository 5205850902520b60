"""A slice of campaigns/estimator.py: noise, lost frames, reflections, play and drop-outs, one run and one seed."""

import pytest
from tank.operate.tank import campaign

from laticauda.control.estimation import Estimator, KinematicEstimator


def test_the_filter_is_within_3_mm_and_a_third_of_a_degree_and_twice_as_good_as_kinematics():
    module = campaign()
    case = next(case for case in module.CASES if case.name == "straight, fast")
    trial = module.truth(case, 30.0)
    arrivals, dropped = module.sense(trial, module.Sensors(), 0)
    spared, _ = module.sense(trial, module.Sensors(outliers=0.0), 0)
    assert dropped.any()
    estimates, _ = module.estimate(
        Estimator(robot=trial.robot, backlash=module.BACKLASH), arrivals, trial.time
    )
    plain, _ = module.estimate(KinematicEstimator(robot=trial.robot), spared, trial.time)
    of_filter = module.errors(trial, estimates, dropped)
    of_kinematics = module.errors(trial, plain, dropped)
    millimeters, degrees = of_filter.always
    assert millimeters < 3.0
    assert degrees < 0.3
    for name in ("always", "outside", "inside"):
        assert (2.0 * getattr(of_filter, name) < getattr(of_kinematics, name)).all(), name


@pytest.mark.parametrize("name", ["twin", "twin, mixed, servo"])
def test_with_a_twin_it_is_so_in_path_following_too_and_a_wrong_twin_is_better_than_none(name):
    module = campaign()
    case = module.CASES[0]
    trial = module.truth(case, 18.0)
    arrivals, dropped = module.sense(trial, module.Sensors(between=4.0), 0)

    def errors_beside(plant):
        estimator = Estimator(robot=trial.robot, backlash=module.BACKLASH, plant=plant)
        estimates, _ = module.estimate(estimator, arrivals, trial.time)
        return module.errors(trial, estimates, dropped)

    with_twin = errors_beside(module.TWINS[name].plant(case))
    alone = errors_beside(None)
    assert (with_twin.always < 0.8 * alone.always).all()
    assert (with_twin.inside < 0.8 * alone.inside).all()
    if name == "twin":  # three times as many drop-outs as in the campaign
        millimeters, degrees = with_twin.always
        assert millimeters < 3.0
        assert degrees < 0.5
