from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identify.trials import DRAG, FINNED, FRICTION, MASS, ROBOT, WATER, gaits, speeds, within

import laticauda as lc
from laticauda.identify import Measurement, Unknown, fit, from_table1, from_trial
from laticauda.identify.local_search import minimize
from laticauda.robot import Tether
from laticauda.values.errors import SimulationFailed


@cache
def swum():
    return speeds(noise=0.002)


@pytest.fixture(scope="module")
def noisy():
    return fit(swum(), parameters=[FRICTION], n_starts=1)


def test_without_noise_the_truth_comes_back_exactly():
    found = fit(speeds(normal_drag=1.4), parameters=[FRICTION, DRAG], n_starts=2)
    assert found[FRICTION].value == pytest.approx(0.2, rel=1e-6)
    assert found[DRAG].value == pytest.approx(1.4, rel=1e-6)
    assert found.chi2 < 1e-9
    assert "2 of 2 starts reached this minimum" in found.status
    n_measurements = len(found.problem.measurements)
    assert repr(found) == f"<Fit to {n_measurements} measurements: {FRICTION} = 0.2, {DRAG} = 1.4>"


def test_a_search_that_comes_to_where_another_one_ended_ends_there_and_one_that_leads_elsewhere_goes_on(
    noisy,
):
    (end,) = noisy.searches
    start, seen = end.end + 0.5, []
    alone = minimize(noisy.problem, start, loss="linear", observe=lambda x, _: seen.append(x))
    n_alone = len(seen)
    found = minimize(
        noisy.problem,
        start,
        loss="linear",
        observe=lambda x, _: seen.append(x),
        earlier_searches=[end],
    )
    assert found.end is end.end and found.jacobian is end.jacobian and found.start is start
    assert len(seen) - n_alone < n_alone
    np.testing.assert_allclose(found.end, alone.end, atol=1e-5)
    for other in (replace(end, end=end.end + 0.1), replace(end, cost=end.cost + 1.0)):
        again = minimize(noisy.problem, start, loss="linear", earlier_searches=[other])
        np.testing.assert_array_equal(again.end, alone.end)


def test_an_interval_holds_the_truth_and_its_own_value(noisy):
    low, high = noisy[FRICTION].interval
    assert low < 0.2 < high and low < noisy[FRICTION].value < high
    assert noisy[FRICTION].sigma == pytest.approx((high - low) / 3.92, rel=0.01)
    assert noisy[FRICTION].unit == "" and noisy[FRICTION].note == ""


def test_twice_the_noise_makes_intervals_twice_as_wide(noisy):
    figures = [
        {"forward_velocity": (v, 2 * s)} for v, s in (m.figures["forward_velocity"] for m in swum())
    ]
    wider = fit(
        [replace(m, figures=f) for m, f in zip(swum(), figures, strict=True)],
        parameters=[FRICTION],
        n_starts=1,
    )
    assert wider[FRICTION].value == pytest.approx(noisy[FRICTION].value, rel=1e-7)
    assert wider[FRICTION].sigma == pytest.approx(2 * noisy[FRICTION].sigma, rel=1e-6)


def test_noise_that_is_estimated_does_not_depend_on_what_is_stated(noisy):
    figures = [
        {"forward_velocity": (v, 7 * s)} for v, s in (m.figures["forward_velocity"] for m in swum())
    ]
    stated = [replace(m, figures=f) for m, f in zip(swum(), figures, strict=True)]
    one, other = (
        fit(m, parameters=[FRICTION], n_starts=1, noise="estimated") for m in (swum(), stated)
    )
    assert one[FRICTION].sigma == pytest.approx(other[FRICTION].sigma, rel=1e-5)
    assert one.noise_factor == pytest.approx(7 * other.noise_factor, rel=1e-5)
    assert one[FRICTION].sigma == pytest.approx(one.noise_factor * noisy[FRICTION].sigma, rel=1e-5)


def test_a_single_unknown_that_begins_at_a_range_end_of_zero_leaves_it():
    """Scipy's first step from almost 0 is almost 0 long, which it took for convergence."""
    pulled = replace(ROBOT, tether=Tether(drag=4.0))
    measured = speeds(3, duration=3.0, tangential_friction=WATER.tangential_friction)
    gaits_swum = [one.scenario.gait for one in measured]
    swims = lc.swim_many(pulled, gaits_swum, 3.0, environments=WATER)
    measured = [
        replace(one, figures={"forward_velocity": (float(speed), 0.002)})
        for one, speed in zip(measured, swims.forward_velocity, strict=True)
    ]
    drag = Unknown(name="robot.tether.drag", start=0.0, size=1.0)
    found = fit(measured, parameters=[drag], n_starts=1)
    assert found["robot.tether.drag"].value == pytest.approx(4.0, rel=1e-4)


def test_the_order_of_measurements_and_of_parameters_does_not_matter():
    one = fit(swum(), parameters=[FRICTION, "robot.tether.drag"], n_starts=1)
    other = fit(swum()[::-1], parameters=["robot.tether.drag", FRICTION], n_starts=1)
    for name in (FRICTION, "robot.tether.drag"):
        assert one[name].value == pytest.approx(other[name].value, rel=1e-5, abs=1e-9)
    assert one.chi2 == pytest.approx(other.chi2, rel=1e-7)


def test_the_same_measurements_twice_make_the_deviation_smaller_by_the_root_of_two(noisy):
    again = [replace(m, name=f"{m.name} again") for m in swum()]
    found = fit([*swum(), *again], parameters=[FRICTION], n_starts=1)
    assert found[FRICTION].value == pytest.approx(noisy[FRICTION].value, rel=1e-6)
    assert found[FRICTION].sigma == pytest.approx(noisy[FRICTION].sigma / np.sqrt(2.0), rel=1e-5)


def test_a_prior_alone_comes_back():
    blind = "robot.joint.stiffness"  # prescribed joints hold against the skin, whatever it pulls
    unknown = Unknown(
        name=blind, start=1.0, lower=0.0, upper=20.0, scale="linear", prior=(2.0, 0.3)
    )
    found = fit(speeds(3), parameters=[FRICTION, unknown], n_starts=1)
    assert found[blind].value == pytest.approx(2.0, rel=1e-6)
    assert found[blind].sigma == pytest.approx(0.3, rel=1e-6)
    assert "known from the prior rather than from the data" in found[blind].note


def test_a_prior_and_the_data_meet_by_their_weights(noisy):
    value, sigma = noisy[FRICTION].value, noisy[FRICTION].sigma
    found = fit(
        swum(), parameters=[Unknown(name=FRICTION, prior=(value + sigma, sigma))], n_starts=1
    )
    assert found[FRICTION].value == pytest.approx(value + 0.5 * sigma, abs=0.05 * sigma)
    assert found[FRICTION].sigma == pytest.approx(sigma / np.sqrt(2.0), rel=0.05)
    both = fit(
        swum(),
        parameters=[Unknown(name=FRICTION, prior=(value, sigma))],
        n_starts=1,
        noise="estimated",
    )
    assert both.noise_factor == pytest.approx(noisy.noise_factor, rel=0.1)


def test_the_common_scale_of_friction_drag_and_added_mass_is_reported_as_unseen():
    found = fit(speeds(10, duration=15.0), parameters=[FRICTION, DRAG, MASS], n_starts=1)
    assert not any(found[name].is_identified for name in (FRICTION, DRAG, MASS))
    assert found[DRAG].interval is None and found[DRAG].sigma is None
    assert found.table()[1]["value"] is None
    assert "the common scale of" in found[DRAG].note
    assert any(
        sentence.startswith("The data do not see about the common scale of")
        for sentence in found.warnings
    )
    assert found.status.startswith("0 of 3 parameters identified")


def test_a_parameter_without_effect_is_called_so():
    found = fit(speeds(4), parameters=[FRICTION, "robot.joint.actuator.stall_torque"], n_starts=1)
    assert found["robot.joint.actuator.stall_torque"].note == "has no effect on what was measured"
    assert found[FRICTION].is_identified
    assert found[FRICTION].value == pytest.approx(0.2, rel=1e-6)


def test_a_series_identifies_what_speeds_do_not():
    water = replace(WATER, normal_drag=1.4, current=(0.02, -0.01))
    trials = [lc.swim(ROBOT, gait, 8.0, environment=water) for gait in gaits(2)]
    series = {"center_of_mass": 0.002, "heading": 0.005}
    measured = [
        from_trial(trial, name=f"{i}", series=series, every=10) for i, trial in enumerate(trials)
    ]
    measured = [within(m, environment=WATER) for m in measured]
    names = [
        DRAG,
        MASS,
        "water.current_x",
        "water.current_y",
        "measured.heading_offset",
        "0.start.heading",
    ]
    found = fit(measured, parameters=names, n_starts=1)
    for name, truth in zip(names, (1.4, 1.5, 0.02, -0.01, 0.0, 0.0), strict=True):
        assert found[name].value == pytest.approx(truth, rel=1e-5, abs=1e-7), name
        assert found[name].is_identified


def test_the_tracked_point_and_where_it_began_are_found():
    trial = lc.swim(
        ROBOT,
        replace(gaits(1)[0], offset=0.05),
        8.0,
        environment=WATER,
        start=lc.Start(heading=0.3),
    )
    ahead = 0.2 * np.stack((np.cos(trial.heading), np.sin(trial.heading)), axis=1)
    moved = replace(trial, center_of_mass=trial.center_of_mass + ahead)
    measured = from_trial(moved, name="a", series={"center_of_mass": 0.002}, every=10)
    measured = within(measured, start=lc.Start(heading=0.2))
    names = ["measured.offset_x", "measured.offset_y", "start.heading", "start.x"]
    found = fit([measured], parameters=names, n_starts=1)
    for name, truth in zip(names, (0.2, 0.0, 0.1, 0.0), strict=True):
        assert found[name].value == pytest.approx(truth, abs=1e-4), name


def test_servos_are_identified_from_joint_angles():
    asked = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    trial = lc.swim(ROBOT, asked, 3.0, environment=WATER, joints="servo", dt=0.005)
    name = "robot.joint.actuator.servo_gain"
    series = {"joint_angle": 0.01, "joint_torque": 0.05}
    found = fit(
        [from_trial(trial, name="a", series=series, every=2)],
        parameters=[Unknown(name=name, start=8.0)],
        joints="servo",
        dt=0.005,
        n_starts=1,
    )
    assert found[name].value == pytest.approx(5.7, rel=1e-5)


def test_power_has_an_offset_of_its_meter():
    water = replace(WATER, tangential_friction=0.2)
    many = lc.swim_many(ROBOT, gaits(4), 8.0, environments=water)
    measured = [
        Measurement(
            name=f"{i}",
            scenario=lc.build_scenario(ROBOT, gait, 8.0, environment=WATER),
            figures={
                "mean_power": (many.mean_power[i] + 5.0, 0.1),
                "forward_velocity": (many.forward_velocity[i], 1e-3),
            },
        )
        for i, gait in enumerate(gaits(4))
    ]
    found = fit(measured, parameters=[FRICTION, "measured.power_offset"], n_starts=1)
    assert found["measured.power_offset"].value == pytest.approx(5.0, rel=1e-6)


def test_each_gait_may_have_its_own_water_and_a_special_name_wins():
    eel = [
        lc.eel_like(amplitude=g.amplitude, frequency=g.frequency, phase_shift=g.phase_shift)
        for g in gaits(3)
    ]
    asked = [*gaits(3), *eel]
    waters = [
        replace(WATER, tangential_friction=0.2 if g.kind == "lateral_undulation" else 0.1)
        for g in asked
    ]
    robots = [ROBOT, FINNED] * 3
    many = lc.swim_many(robots, asked, 8.0, environments=waters)
    measured = [
        Measurement(
            name=f"{i}",
            scenario=lc.build_scenario(r, g, 8.0, environment=WATER),
            figures={"forward_velocity": (v, 1e-3)},
        )
        for i, (g, r, v) in enumerate(zip(asked, robots, many.forward_velocity, strict=True))
    ]
    found = fit(measured, parameters=[FRICTION, f"eel_like.{FRICTION}"], n_starts=1)
    assert found[FRICTION].value == pytest.approx(0.2, rel=1e-6)
    assert found[f"eel_like.{FRICTION}"].value == pytest.approx(0.1, rel=1e-6)
    kept = found.parameters("tank", "in the tank")
    assert kept.joints == "prescribed"
    assert kept.water("eel_like").tangential_friction == pytest.approx(0.1, rel=1e-6)
    assert kept.water("custom").tangential_friction == pytest.approx(0.2, rel=1e-6)


def test_one_module_may_have_its_own_number():
    robot = lc.load_robot("mamba")
    modules = list(robot.modules)
    modules[3] = replace(modules[3], tangential_friction=1.0)
    many = lc.swim_many(replace(robot, modules=tuple(modules)), gaits(4), 8.0, environments=WATER)
    measured = [
        Measurement(
            name=f"{i}",
            scenario=lc.build_scenario(robot, g, 8.0, environment=WATER),
            figures={"forward_velocity": (v, 1e-4)},
        )
        for i, (g, v) in enumerate(zip(gaits(4), many.forward_velocity, strict=True))
    ]
    found = fit(measured, robot, parameters=["robot.module[3].tangential_friction"], n_starts=1)
    assert found["robot.module[3].tangential_friction"].value == pytest.approx(1.0, rel=1e-5)
    changed = found.robot(robot, "lateral_undulation")
    assert changed.modules[3].tangential_friction == pytest.approx(1.0, rel=1e-5)
    assert changed.modules[2].tangential_friction is None


def test_outliers_count_less_with_a_robust_loss():
    bad = replace(swum()[2], figures={"forward_velocity": (0.4, 0.002)})
    spoiled = [*swum()[:2], bad, *swum()[3:]]
    plain, robust = (
        fit(spoiled, parameters=[FRICTION], n_starts=1, loss=loss, rivals=False)
        for loss in ("linear", "cauchy")
    )
    assert abs(robust[FRICTION].value - 0.2) < 0.01 < abs(plain[FRICTION].value - 0.2)


def test_residuals_are_listed_by_measurement(noisy):
    rows = noisy.residuals
    assert [row["measurement"] for row in rows] == [m.name for m in swum()]
    assert sum(row["in standard deviations [-]"] ** 2 for row in rows) == pytest.approx(noisy.chi2)
    assert rows[0]["group"] == "lateral undulation, without fin" and rows[0]["unit"] == "m/s"
    assert 0.0 < noisy.percentage_error() < 10.0
    with pytest.raises(
        ValueError, match=r"`figure` must be one that was measured \(forward_velocity\), got 'x'"
    ):
        noisy.percentage_error("x")


def test_a_bound_that_holds_the_value_back_is_named():
    found = fit(swum(), parameters=[Unknown(name=FRICTION, lower=0.25, upper=0.4)], n_starts=1)
    assert found[FRICTION].value == pytest.approx(0.25)
    assert "at the lower end of its range" in found[FRICTION].note


def test_gaits_that_are_all_the_same_are_warned_of():
    same = [replace(swum()[0], name=f"{i}") for i in range(3)]
    found = fit(same, parameters=[FRICTION], n_starts=1)
    assert any(
        words.startswith("All measurements are of the same gait") for words in found.warnings
    )


def refused(match, measurements=None, parameters=(FRICTION,), **settings):
    with pytest.raises(ValueError, match=match):
        fit(swum() if measurements is None else measurements, parameters=parameters, **settings)


def test_bad_input_is_refused_by_name():
    refused(
        r"must hold at least 3 numbers for 3 unknowns without a prior, got 2",
        swum()[:2],
        [FRICTION, DRAG, MASS],
    )
    refused(
        r"at least 2 numbers for 1 unknowns .* and the noise, got 1", swum()[:1], noise="estimated"
    )
    refused(
        r"`measurements` must have different names, got `trial 0` twice", [swum()[0], swum()[0]]
    )
    refused(r"`measurements` must hold at least one Measurement", [])
    refused(
        r"`trial 0` is of robot `mamba-modules`",
        [within(swum()[0], robot=lc.load_robot("mamba-modules"))],
        robot=ROBOT,
    )
    refused(
        r"got 'water.friction'; the nearest are .*`water.tangential_friction`",
        parameters=["water.friction"],
    )
    refused(
        r"got 'measured.heading'; the nearest are .*`measured.heading_offset`",
        parameters=["measured.heading"],
    )
    refused(
        r"numbers for `eel_like`|got 'eel_like.water.normal_drag'",
        parameters=["eel_like.water.normal_drag"],
    )
    refused(
        r"must not be of the gait, which was commanded.*`gait.amplitude\[4\]`, `gait.phase\[2\]`",
        parameters=["gait.amplitude"],
    )
    refused(
        r"items of `gait.amplitude` count from 0|must name numbers of the measurements'",
        parameters=["gait.amplitude[8]"],
    )
    refused(r"got `robot.n_links`, a count", parameters=["robot.n_links"])
    refused(
        r"`parameters` must name every number once, got `water.normal_drag` 2 times",
        parameters=[DRAG, DRAG],
    )
    refused(r"`parameters` must be a list of names, got .water.normal_drag", parameters=DRAG)
    refused(r"`parameters` must hold at least one number", parameters=[])
    refused(
        r"must leave measurements for `water.normal_drag`",
        parameters=[DRAG, f"lateral_undulation.{DRAG}"],
    )
    refused(r"`noise` must be one of", noise="loud")
    refused(r"`n_starts` must be a whole number >= 1", n_starts=0)
    refused(r"`joints` must be one of", joints="rubber")


def test_a_figure_that_a_trial_does_not_have_is_refused():
    short = [replace(m, figures={"steady_velocity": (0.1, 0.01)}) for m in speeds(2, duration=3.0)]
    refused(
        r"`figures` of `trial 0` must be ones that its simulation yields, got steady_velocity",
        short,
    )


def test_a_measurement_that_diverges_in_simulation_is_named():
    wild = [within(m, environment=replace(WATER, tangential_friction=1e6)) for m in swum()[:2]]
    with pytest.raises(
        SimulationFailed, match=r"`trial 0` cannot be simulated at any start .*diverged at t ="
    ):
        fit(wild, parameters=[DRAG], n_starts=1, dt=0.1)


def test_table_1_gives_one_friction_for_both_gaits():
    found = fit(from_table1(), parameters=[FRICTION], noise="estimated", n_starts=1, rivals=False)
    assert found[FRICTION].is_identified
    assert len(found.residuals) == 20
    assert {row["group"] for row in found.residuals} == {
        f"{gait}, {fin} fin"
        for gait in ("lateral undulation", "eel-like motion")
        for fin in ("with", "without")
    }


def test_noise_in_mm_is_said_when_it_is_fitted_and_a_measurement_may_hold_any():
    (first, *_) = swum()
    time = np.linspace(0.0, 1.0, 5)
    path = replace(first, time=time, series={"center_of_mass": (np.zeros((5, 2)), 5.0)})
    sentence = r"sigma of center_of_mass of 5 m hides all motion; did you mean 0.005 \(5 mm\)\?"
    with pytest.warns(lc.ImplausibleWarning, match=sentence):
        fit([path], parameters=[FRICTION], n_starts=1)
