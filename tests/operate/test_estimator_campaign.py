"""A slice of campaigns/estimator.py: noise, lost frames, reflections, play and drop-outs, one run and one seed."""

from operate.tank import campaign

from laticauda.operate import Estimator, KinematicEstimator


def test_the_filter_is_within_3_mm_and_a_third_of_a_degree_and_twice_as_good_as_kinematics():
    module = campaign()
    case = next(case for case in module.CASES if case.name == "straight, fast")
    trial = module.truth(case, 30.0)
    arrivals, dropped = module.sensed(trial, module.Sensors(), 0)
    spared, _ = module.sensed(trial, module.Sensors(outliers=0.0), 0)
    assert dropped.any()
    estimates, _ = module.estimated(Estimator(robot=trial.robot, backlash=module.BACKLASH), arrivals, trial.time)
    plain, _ = module.estimated(KinematicEstimator(robot=trial.robot), spared, trial.time)
    found, alone = module.errors(trial, estimates, dropped), module.errors(trial, plain, dropped)
    assert found.always[0] < 3.0 and found.always[1] < 0.3
    for name in ("always", "outside", "inside"):
        assert (2.0 * getattr(found, name) < getattr(alone, name)).all(), name
