from dataclasses import replace

import numpy as np
import pytest
from identify.trials import FINNED, ROBOT, WATER, gaits, speeds, within

import laticauda as lc
from laticauda.identify import Measurement, from_trial
from laticauda.identify.interpolation import interpolated
from laticauda.identify.model import predict
from laticauda.identify.problem import make_problem
from laticauda.models.simulate import gradients

SERIES = {"center_of_mass": 0.01, "heading": 0.01}


def by_differences(put, values):
    """The Jacobian by central differences of the predictions."""
    columns = []
    for k, value in enumerate(values):
        step = 1e-5 * max(abs(value), 0.1)
        ends = [
            predict(put, values + sign * step * (np.arange(values.size) == k)).values
            for sign in (1, -1)
        ]
        columns.append((ends[0] - ends[1]) / (2 * step))
    return np.stack(columns, axis=1)


def check_jacobian(put, values, scale=1e-6):
    found = predict(put, values)
    expected = by_differences(put, values)
    np.testing.assert_array_equal(found.values, predict(put, values).values)
    np.testing.assert_allclose(
        found.jacobian, expected, atol=scale * np.abs(expected).max(axis=0).max()
    )


def test_the_jacobian_of_figures_and_series_is_that_of_differences():
    turning = [replace(gait, offset=0.05) for gait in gaits(2)]
    trials = [
        lc.swim(robot, gait, 4.0, environment=WATER)
        for robot, gait in zip((ROBOT, FINNED), turning, strict=True)
    ]
    measured = [
        from_trial(
            t,
            name=f"{i}",
            series=SERIES,
            figures={"x": 0.01, "y": 0.01, "heading": 0.1, "net_power": 1.0},
            every=7,
        )
        for i, t in enumerate(trials)
    ]
    names = [
        "water.tangential_friction",
        "water.current_y",
        "robot.caudal_fin.height",
        "measured.heading_offset",
        "measured.offset_x",
        "measured.offset_y",
        "start.heading",
        "1.start.x",
    ]
    put = make_problem(measured, names, dt=0.05)
    assert put.names[len(names) :] == (
        "0.start.x",
        "0.start.y",
        "1.start.y",
    )  # where they began is unknown, too
    check_jacobian(put, np.array([0.25, 0.02, 0.1, 0.1, 0.05, -0.03, 0.2, 0.1, 0.02, -0.1, 0.05]))
    assert not put.depends_on[0, 2] and put.depends_on[1, 2]
    assert not put.depends_on[0, 7] and put.depends_on[1, 7]


def test_many_unknowns_of_few_figures_are_differentiated_backward_to_the_same_jacobian(monkeypatch):
    turning = [replace(gait, offset=0.05) for gait in gaits(2)]
    figures = {"x": 0.01, "mean_power": 1.0}
    measured = [
        from_trial(lc.swim(FINNED, gait, duration, environment=WATER), name=name, figures=figures)
        for name, gait, duration in zip("ab", turning, (4.0, 6.0), strict=True)
    ]
    names = [
        "water.tangential_friction",
        "water.normal_drag",
        "water.added_mass",
        "water.added_inertia",
        "water.tangential_added_mass",
        "water.current_y",
        "robot.caudal_fin.height",
        "robot.module.mass",
        "robot.module.center",
        "robot.joint.damping",
        "start.heading",
        "measured.offset_x",
    ]
    put = make_problem(measured, names, dt=0.05)
    backward = predict(put, put.start).jacobian
    monkeypatch.setattr(gradients, "MOST_FORWARD", 1000)
    forward = predict(put, put.start).jacobian
    scale = np.abs(forward).max(axis=0)
    np.testing.assert_allclose(backward / scale, forward / scale, rtol=1e-10, atol=1e-12)
    assert np.any(backward != forward)  # by another way


def test_the_jacobian_of_joints_is_that_of_differences():
    trial = lc.swim(ROBOT, gaits(1)[0], 1.0, environment=WATER, joints="servo", dt=0.005)
    measured = [
        from_trial(trial, name="a", series={"joint_angle": 0.01, "joint_torque": 0.1}, every=3)
    ]
    put = make_problem(measured, ["robot.joint.actuator.servo_gain"], joints="servo", dt=0.005)
    check_jacobian(put, np.array([5.0]), scale=1e-4)


def test_what_is_predicted_of_a_trial_is_that_trial():
    trial = lc.swim(FINNED, gaits(1)[0], 6.0, environment=WATER, joints="pd")
    series = SERIES | {"joint_angle": 0.01, "joint_torque": 0.1}
    measured = from_trial(
        trial, name="a", series=series, figures={"forward_velocity": 0.01, "y": 0.01}
    )
    put = make_problem([measured], ["water.normal_drag"], joints="pd")
    np.testing.assert_allclose(predict(put, put.start).values, put.observed, atol=1e-9)


def test_trials_of_different_length_go_together():
    short, long = speeds(2, duration=4.0), speeds(2, duration=8.0)
    together = [*short, *(replace(m, name=f"long {m.name}") for m in long)]
    values = np.array([0.2])
    whole = predict(make_problem(together, ["water.tangential_friction"]), values)
    for members, at in ((short, slice(0, 2)), (long, slice(2, 4))):
        part = predict(make_problem(members, ["water.tangential_friction"]), values)
        np.testing.assert_allclose(whole.values[at], part.values, rtol=1e-12)
        np.testing.assert_allclose(whole.jacobian[at], part.jacobian, rtol=1e-10)


def test_a_run_that_diverges_is_named_and_has_no_predictions():
    good, bad = speeds(2)
    bad = within(bad, environment=replace(WATER, tangential_friction=1e6))
    found = predict(make_problem([good, bad], ["water.normal_drag"], dt=0.1), np.array([1.75]))
    assert list(found.failures) == ["trial 1"]
    assert np.isfinite(found.values[0]) and np.isnan(found.values[1])


def test_cubics_between_samples_are_exact():
    time = np.linspace(0.0, 2.0, 11)
    moments = np.array([0.0, 0.07, 0.9, 1.3, 1.99, 2.0])
    np.testing.assert_allclose(
        interpolated(time, time**3 - 2j * time, moments), moments**3 - 2j * moments, atol=1e-12
    )
    np.testing.assert_allclose(interpolated(time[:2], time[:2], np.array([0.1])), [0.1])


def test_the_twin_predicts_what_the_planar_model_does():
    gait = gaits(1)[0]
    measured = [
        Measurement(
            name="a",
            scenario=lc.build_scenario(ROBOT, gait, 1.0, environment=WATER),
            figures={"forward_velocity": (0.1, 0.01)},
            time=np.array([0.5, 0.9]),
            series={"heading": (np.zeros(2), 0.01)},
            free_start=False,
        )
    ]
    flat, deep = (
        make_problem(measured, ["water.normal_drag"], model=model)
        for model in ("planar", "spatial")
    )
    one, other = (predict(put, np.array([1.5])) for put in (flat, deep))
    np.testing.assert_allclose(one.values, other.values, rtol=0.02, atol=2e-3)
    np.testing.assert_allclose(one.jacobian, other.jacobian, rtol=0.1, atol=2e-3)


def test_no_two_names_may_say_the_same():
    measured = speeds(2)
    with pytest.raises(
        ValueError, match=r"`parameters` must list `water.normal_drag` once per measurement at most"
    ):
        make_problem(
            measured, ["lateral_undulation.water.normal_drag", "trial 0.water.normal_drag"]
        )
