import pytest
from identify.trials import FINNED, FRICTION, ROBOT, WATER, speeds, within

import laticauda as lc
from laticauda.identify import Unknown, fit

TRACKING = "robot.joint.actuator.tracking"


@pytest.fixture(scope="module")
def found():
    wanted = [FRICTION, TRACKING, "lateral_undulation.robot.tether.drag"]
    return fit(speeds(5, duration=4.0), parameters=wanted, n_starts=1, threads=1)


def test_a_parameter_file_says_what_was_identified(found, tmp_path):
    kept = found.parameters("tank", "in the tank")
    kept.save(tmp_path / "tank.toml")
    again = lc.load_parameters(tmp_path / "tank.toml")
    assert again == kept
    assert kept.joints == "prescribed"
    assert kept.water("eel_like").tangential_friction == found[FRICTION].value
    assert kept.changes == {"actuator": {"tracking": found[TRACKING].value}}
    drag = found.values["lateral_undulation.robot.tether.drag"]
    assert kept.own_changes["lateral_undulation"]["tether"]["drag"] == drag
    assert "eel_like" not in kept.own_changes


def test_a_trial_with_the_parameter_file_is_what_the_fit_predicts(found):
    kept, measurement = found.parameters("tank", "in the tank"), found.problem.measurements[0]
    kind = measurement.scenario.gait.kind
    trial = lc.swim(
        kept.robot(ROBOT, kind), measurement.scenario.gait, 4.0, environment=kept.water(kind)
    )
    assert trial.forward_velocity == pytest.approx(found.predictions[0], rel=1e-9)
    assert found.robot(ROBOT, kind) == kept.robot(ROBOT, kind)
    assert found.water(WATER, kind).tangential_friction == found[FRICTION].value


def test_what_a_parameter_file_cannot_say_is_refused_but_a_robot_can_have_it():
    other = fit(speeds(2, duration=4.0), parameters=["robot.module.mass"], n_starts=1, threads=1)
    with pytest.raises(ValueError, match=r"a parameter file can hold, got `robot.module.mass`"):
        other.parameters("tank", "in the tank")
    assert other.robot(FINNED, "eel_like").modules[0].mass == other["robot.module.mass"].value
    assert other.beyond_parameter_file == ("robot.module.mass",)


def test_what_a_robot_does_not_have_is_left_out():
    fin = Unknown(name="robot.caudal_fin.normal_drag", start=1.5)
    measured = [within(m, robot=FINNED) for m in speeds(2, duration=4.0)]
    with_fin = fit(measured, parameters=[fin], n_starts=1, threads=1)
    assert with_fin.robot(ROBOT, "eel_like") == ROBOT
    assert with_fin.robot(FINNED, "eel_like").caudal_fin.normal_drag == with_fin[fin.name].value
